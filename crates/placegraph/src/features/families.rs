//! The table of feature families: one row per formula of appendices A and B, and of the author's program.
//!
//! **Deviations** from the appendices, each in the row concerned: relations of beams are folded to min/max
//! (A11, A12, A15), kurtosis keeps its 3 (A16), B10 is stored on a logarithmic scale, B11 has the book's form,
//! B13 has the square root of the perimeter.

/// How a value changes when all ranges are multiplied by s (Sect. 4.8.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Not at all.
    Invariant,
    /// By a factor of s to this power.
    Power(f64),
    /// The quantity behind it by a factor of s to this power; the value is stored in decades and gains
    /// power · log10 s, towards its sign, while it is far from 0.
    Decades(f64),
    /// By no law: the formula has a length of fixed size.
    FixedLength,
}

/// What a family measures; the engine computes exactly these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    MeanDifference,
    SdDifference,
    MeanClippedDifference,
    SdClippedDifference,
    MeanLength,
    SdLength,
    Gaps,
    BeamsOnLines,
    MinimaDistance,
    MinimaAngle,
    MeanRelation,
    SdRelation,
    MeanNormalizedLength,
    SdNormalizedLength,
    RelativeGaps,
    Kurtosis,
    Area,
    Perimeter,
    AreaOverPerimeter,
    MeanRadius,
    SdRadius,
    Fourier,
    MajorAxis,
    MinorAxis,
    AxisRatio,
    Moment,
    Compactness,
    Eccentricity,
    FormFactor,
    Circularity,
    NormalizedCircularity,
    MeanNormalizedRadius,
    SdNormalizedRadius,
    DescriptorMajorAxis,
    DescriptorMinorAxis,
    DescriptorAxisRatio,
    GapFraction,
    RelativeGapFraction,
}

/// The parameter values of a family: `i / divisor` for i in `first..=last`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    pub(super) first: u16,
    pub(super) last: u16,
    pub(super) divisor: u16,
}

/// One row of the table. Symbols of the formulas are bound in `docs/features.md`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Family {
    pub(super) measure: Measure,
    /// Set and number in the book's appendices, or empty.
    pub(super) book: &'static str,
    /// Name in the author's program, or a name of our own that does not look like one (`f` and a number), or empty.
    pub(super) code: &'static str,
    pub(super) parameters: Option<Parameters>,
    pub(super) description: &'static str,
    pub(super) formula: &'static str,
    pub(super) unit: &'static str,
    pub(super) scale: Scale,
    pub(super) mirror_invariant: bool,
}

const CLIPS: Parameters = steps(1, 10, 1);
const GAPS: Parameters = steps(1, 20, 2);
const RELATIONS: Parameters = steps(1, 10, 10);
/// Largest harmonic of B6.
pub(super) const MAX_HARMONIC: usize = 100;

const fn steps(first: u16, last: u16, divisor: u16) -> Parameters {
    Parameters { first, last, divisor }
}

/// A family with one member that mirroring does not change.
const fn row(
    measure: Measure,
    book: &'static str,
    code: &'static str,
    unit: &'static str,
    scale: Scale,
    description: &'static str,
    formula: &'static str,
) -> Family {
    let (parameters, mirror_invariant) = (None, true);
    Family { measure, book, code, parameters, description, formula, unit, scale, mirror_invariant }
}

impl Family {
    const fn with(mut self, parameters: Parameters) -> Self {
        self.parameters = Some(parameters);
        self
    }

    const fn mirror_dependent(mut self) -> Self {
        self.mirror_invariant = false;
        self
    }
}

use Measure as M;
use Scale::{Decades, FixedLength, Invariant, Power};

/// All families: set A, set B, then what only the author's program has.
#[rustfmt::skip]
pub(super) const FAMILIES: &[Family] = &[
    row(M::MeanDifference, "A1", "f2", "m", Power(1.0),
        "mean difference of consecutive beams", "mean(Δ_i)"),
    row(M::SdDifference, "A2", "f2_sd", "m", Power(1.0),
        "standard deviation of the difference of consecutive beams", "sd(Δ_i)"),
    row(M::MeanClippedDifference, "A3", "f3", "m", FixedLength,
        "mean difference of consecutive beams cut at x meters", "mean(|c_i - c_{i+1}|), c_i = min(d_i, x)").with(CLIPS),
    row(M::SdClippedDifference, "A4", "", "m", FixedLength,
        "standard deviation of the difference of consecutive beams cut at x meters", "sd(|c_i - c_{i+1}|), c_i = min(d_i, x)").with(CLIPS),
    row(M::MeanLength, "A5", "f8", "m", Power(1.0),
        "mean beam length", "mean(d_i)"),
    row(M::SdLength, "A6", "f8_sd", "m", Power(1.0),
        "standard deviation of the beam length", "sd(d_i)"),
    row(M::Gaps, "A7", "f14", "beams", FixedLength,
        "number of gaps: consecutive beams that differ by more than g meters", "#{i : Δ_i > g}").with(GAPS),
    row(M::BeamsOnLines, "A8", "f15", "beams", FixedLength,
        "number of beams below 6 m that end on straight lines (split and merge)", "see above").mirror_dependent(),
    row(M::MinimaDistance, "A9", "f25", "m", Power(1.0),
        "distance between the end points of the two deepest local minima with a prominence of 0.1 m; 0 if there are fewer", "|v_m1 - v_m2|"),
    row(M::MinimaAngle, "A10", "f26", "deg", Invariant,
        "angle between the two minima of A9", "min(k, n - k) 360 / n, k = |m1 - m2|"),
    row(M::MeanRelation, "A11", "f27", "1", Invariant,
        "mean relation of consecutive beams, the shorter over the longer", "mean(ρ_i)"),
    row(M::SdRelation, "A12", "f27_sd", "1", Invariant,
        "standard deviation of the relation of consecutive beams", "sd(ρ_i)"),
    row(M::MeanNormalizedLength, "A13", "f28", "1", Invariant,
        "mean beam length over the longest", "mean(d_i) / max(d_i)"),
    row(M::SdNormalizedLength, "A14", "f28_sd", "1", Invariant,
        "standard deviation of the beam length over the longest", "sd(d_i) / max(d_i)"),
    row(M::RelativeGaps, "A15", "f30", "beams", Invariant,
        "number of relative gaps: consecutive beams whose relation is below q", "#{i : ρ_i < q}").with(RELATIONS),
    row(M::Kurtosis, "A16", "f32", "1", Invariant,
        "kurtosis of the beam lengths, without subtracting 3; 0 if all are equal", "mean((d_i - mean(d))^4) / sd(d)^4"),
    row(M::Area, "B1", "f5", "m2", Power(2.0),
        "area of the polygon", "A"),
    row(M::Perimeter, "B2", "f6", "m", Power(1.0),
        "perimeter of the polygon", "P"),
    row(M::AreaOverPerimeter, "B3", "f7", "m", Power(1.0),
        "area over perimeter", "A / P"),
    row(M::MeanRadius, "B4", "f9", "m", Power(1.0),
        "mean distance of the vertices from the centroid of the polygon", "mean(R_i)"),
    row(M::SdRadius, "B5", "f9_sd", "m", Power(1.0),
        "standard deviation of that distance", "sd(R_i)"),
    row(M::Fourier, "B6", "f16", "1", Invariant,
        "magnitude of the k-th Fourier descriptor of the boundary", "|c_k| / |c_1|").with(steps(2, MAX_HARMONIC as u16, 1)),
    row(M::MajorAxis, "B7", "f17", "m", Power(1.0),
        "major semi-axis of the Fourier ellipse", "Ma = |c_1| + |c_-1|"),
    row(M::MinorAxis, "B8", "f18", "m", Power(1.0),
        "minor semi-axis of the Fourier ellipse", "Mi = ||c_1| - |c_-1||"),
    row(M::AxisRatio, "B9", "f19", "1", Invariant,
        "ratio of the axes", "Mi / Ma"),
    moment(1, 2.0, "η20 + η02"),
    moment(2, 4.0, "(η20 - η02)^2 + 4 η11^2"),
    moment(3, 6.0, "(η30 - 3 η12)^2 + (3 η21 - η03)^2"),
    moment(4, 6.0, "(η30 + η12)^2 + (η21 + η03)^2"),
    moment(5, 12.0, "(η30 - 3 η12)(η30 + η12)[(η30 + η12)^2 - 3 (η21 + η03)^2] + (3 η21 - η03)(η21 + η03)[3 (η30 + η12)^2 - (η21 + η03)^2]"),
    moment(6, 8.0, "(η20 - η02)[(η30 + η12)^2 - (η21 + η03)^2] + 4 η11 (η30 + η12)(η21 + η03)"),
    moment(7, 12.0, "(3 η21 - η03)(η30 + η12)[(η30 + η12)^2 - 3 (η21 + η03)^2] + (3 η12 - η30)(η21 + η03)[3 (η30 + η12)^2 - (η21 + η03)^2]").mirror_dependent(),
    row(M::Compactness, "B11", "f22", "1", Invariant,
        "compactness, in the book's form; the program's n^2 / (μ20 + μ02) is a function of B10(1)", "A / (μ20 + μ02)"),
    row(M::Eccentricity, "B12", "f23", "1", Invariant,
        "eccentricity", "sqrt((μ20 - μ02)^2 + 4 μ11^2) / (μ20 + μ02)"),
    row(M::FormFactor, "B13", "f24", "m^1.5", Power(1.5),
        "form factor", "4 π A / sqrt(P)"),
    row(M::Circularity, "B14", "", "1", Invariant,
        "circularity, 4 π for a circle", "P^2 / A"),
    row(M::NormalizedCircularity, "B15", "f31", "1", Invariant,
        "normalized circularity, 1 for a circle", "4 π A / P^2"),
    row(M::MeanNormalizedRadius, "B16", "f29", "1", Invariant,
        "mean distance of the vertices from the centroid over the largest", "mean(R_i) / max(R_i)"),
    row(M::SdNormalizedRadius, "B17", "f29_sd", "1", Invariant,
        "standard deviation of that distance over the largest", "sd(R_i) / max(R_i)"),
    row(M::DescriptorMajorAxis, "", "f17_2", "1", Invariant,
        "major axis of the ellipse of the descriptors", "1 + q, q = |c_-1| / |c_1|"),
    row(M::DescriptorMinorAxis, "", "f18_2", "1", Invariant,
        "minor axis of the ellipse of the descriptors", "|1 - q|"),
    row(M::DescriptorAxisRatio, "", "f19_2", "1", Invariant,
        "ratio of those axes, the same as B9", "|1 - q| / (1 + q)"),
    row(M::GapFraction, "", "f33", "1", FixedLength,
        "fraction of gaps over g meters", "A7(g) / (n - 1)").with(GAPS),
    row(M::RelativeGapFraction, "", "f34", "1", Invariant,
        "fraction of relative gaps below q", "A15(q) / (n - 1)").with(RELATIONS),
];

/// The row of the invariant φ with this number, which grows with the given power of the scale.
const fn moment(number: u16, power: f64, formula: &'static str) -> Family {
    let description = "moment invariant φ of the vertices, stored as sign(φ) log10(1 + |φ| / 1e-40)";
    row(M::Moment, "B10", "f21", "decades", Decades(power), description, formula)
        .with(steps(number, number, 1))
}
