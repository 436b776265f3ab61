//! The groups of features to compute for the requested columns.

use super::FeatureId;
use super::beams;
use super::families::Measure as M;
use super::fourier::{Harmonics, fourier};
use super::lines::lines;
use super::minima::{Found, minima};
use super::moments::{Along, moments};
use super::polygon::{self, Directions, Outline};
use super::values::Values;
use crate::scan::lanes::{Singles, ZERO};
use crate::scan::{Instructions, N_BEAMS, Ranges};

/// Features that share their work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    Differences,
    Lengths,
    Lines,
    Minima,
    Relations,
    Areas,
    Radii,
    Moments,
    Fourier,
}

impl Group {
    fn of(measure: M) -> Self {
        match measure {
            M::MeanDifference
            | M::SdDifference
            | M::MeanClippedDifference
            | M::SdClippedDifference
            | M::Gaps
            | M::GapFraction => Self::Differences,
            M::MeanLength | M::SdLength | M::MeanNormalizedLength | M::SdNormalizedLength | M::Kurtosis => {
                Self::Lengths
            }
            M::BeamsOnLines => Self::Lines,
            M::MinimaDistance | M::MinimaAngle => Self::Minima,
            M::MeanRelation | M::SdRelation | M::RelativeGaps | M::RelativeGapFraction => Self::Relations,
            M::Area
            | M::Perimeter
            | M::AreaOverPerimeter
            | M::FormFactor
            | M::Circularity
            | M::NormalizedCircularity => Self::Areas,
            M::MeanRadius | M::SdRadius | M::MeanNormalizedRadius | M::SdNormalizedRadius => Self::Radii,
            M::Moment | M::Compactness | M::Eccentricity => Self::Moments,
            M::Fourier
            | M::MajorAxis
            | M::MinorAxis
            | M::AxisRatio
            | M::DescriptorMajorAxis
            | M::DescriptorMinorAxis
            | M::DescriptorAxisRatio => Self::Fourier,
        }
    }

    fn is_polygon(self) -> bool {
        matches!(self, Self::Areas | Self::Radii | Self::Moments | Self::Fourier)
    }
}

/// What features are worked out in, from group to group of cells: cleared by those who need it clear.
pub(super) struct Buffers {
    edges: [Singles; N_BEAMS],
    radii: [Singles; N_BEAMS],
    found: Found,
}

impl Buffers {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { edges: [ZERO; N_BEAMS], radii: [ZERO; N_BEAMS], found: Found::NONE })
    }
}

/// The groups that a list of features needs, and constants for computing them.
pub(super) struct Plan {
    groups: Vec<Group>,
    differences: beams::Differences,
    harmonics: Harmonics,
    directions: Directions,
    along: Along,
}

impl Plan {
    pub(super) fn new(columns: &[FeatureId]) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        let mut harmonics = Vec::new();
        let mut differences = beams::Differences::default();
        for feature in columns.iter().map(|id| id.feature()) {
            let group = Group::of(feature.measure);
            if !groups.contains(&group) {
                groups.push(group);
            }
            match (feature.measure, feature.parameter) {
                (M::MeanClippedDifference | M::SdClippedDifference, _) => differences.clipped = true,
                (M::Gaps | M::GapFraction, _) => differences.gaps = true,
                (M::Fourier, Some(k)) => harmonics.push(k as usize),
                _ => {}
            }
        }
        Self {
            groups,
            differences,
            harmonics: Harmonics::new(harmonics),
            directions: Directions::new(),
            along: Along::new(),
        }
    }

    /// Computes the features of the cells with ranges `d`.
    pub(super) fn measure(
        &self,
        d: &Ranges,
        instructions: Instructions,
        buffers: &mut Buffers,
        values: &mut Values,
    ) {
        let lanes = instructions.lanes();
        instructions.run(
            #[inline(always)]
            || self.measure_inlined(d, lanes, buffers, values),
        );
    }

    #[inline(always)]
    fn measure_inlined(&self, d: &Ranges, lanes: usize, buffers: &mut Buffers, values: &mut Values) {
        let Buffers { edges, radii, found } = buffers;
        let is_polygon = self.groups.iter().any(|group| group.is_polygon());
        let outline = if is_polygon { Some(Outline::new(d, edges)) } else { None };
        for group in &self.groups {
            match (group, &outline) {
                (Group::Differences, _) => beams::differences(d, self.differences, values),
                (Group::Lengths, _) => beams::lengths(d, values),
                (Group::Lines, _) => lines(d, &self.along, values),
                (Group::Minima, _) => minima(d, &self.along, found, values),
                (Group::Relations, _) => beams::relations(d, values),
                (Group::Areas, Some(outline)) => polygon::areas(outline, values),
                (Group::Radii, Some(outline)) => {
                    polygon::radii(d, &self.directions, outline, radii, values);
                }
                (Group::Moments, Some(outline)) => {
                    moments(d, &self.along, outline, values);
                }
                (Group::Fourier, Some(outline)) => {
                    fourier(d, &self.directions, outline, &self.harmonics, lanes, values);
                }
                (Group::Areas | Group::Radii | Group::Moments | Group::Fourier, None) => {}
            }
        }
    }
}
