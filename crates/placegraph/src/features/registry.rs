//! The registry of features: one table drives files, documentation, the engine's plan and the property tests.

use std::sync::LazyLock;

use super::FeatureId;
use super::families::{FAMILIES, Family, Measure, Scale};

/// One feature: a function of a scan with 360 ranges in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Its position in the registry.
    pub id: FeatureId,
    /// The name in files: the number in the book if there is one (`A1`, `A3(2)`, `B6(12)`), else the name in the
    /// author's program (`f33(0.5)`, `f17_2`).
    pub name: String,
    /// Set and number in appendices A and B of the book.
    pub book: Option<&'static str>,
    /// Name in the author's program.
    pub code: Option<&'static str>,
    /// The parameter in parentheses.
    pub parameter: Option<f64>,
    /// What it measures.
    pub description: &'static str,
    /// Its formula, in the symbols of `docs/features.md`.
    pub formula: &'static str,
    /// Unit of the value.
    pub unit: &'static str,
    /// How scaling changes it.
    pub scale: Scale,
    /// Whether turning the robot (a cyclic shift of the beams) leaves it unchanged.
    pub rotation_invariant: bool,
    /// Whether mirroring the building leaves it unchanged.
    pub mirror_invariant: bool,
    pub(super) measure: Measure,
}

static REGISTRY: LazyLock<Vec<Feature>> = LazyLock::new(|| {
    let members = FAMILIES.iter().flat_map(|family| members(family).map(move |member| (family, member)));
    members.enumerate().map(|(id, (family, parameter))| feature(id, family, parameter)).collect()
});

/// The parameters of `family`, or one `None` for a family of one.
fn members(family: &Family) -> impl Iterator<Item = Option<f64>> + use<> {
    let range = family.parameters.map_or(0..=0, |steps| steps.first..=steps.last);
    let divisor = family.parameters.map(|steps| f64::from(steps.divisor));
    range.map(move |step| divisor.map(|divisor| f64::from(step) / divisor))
}

fn feature(id: usize, family: &'static Family, parameter: Option<f64>) -> Feature {
    let stem = if family.book.is_empty() { family.code } else { family.book };
    Feature {
        id: FeatureId(id as u16),
        name: parameter.map_or_else(|| stem.to_owned(), |value| format!("{stem}({value})")),
        book: Some(family.book).filter(|name| !name.is_empty()),
        code: Some(family.code).filter(|name| !name.is_empty()),
        parameter,
        description: family.description,
        formula: family.formula,
        unit: family.unit,
        scale: family.scale,
        rotation_invariant: true,
        mirror_invariant: family.mirror_invariant,
        measure: family.measure,
    }
}

/// All features, in the order of their [`FeatureId`]s.
pub fn registry() -> &'static [Feature] {
    &REGISTRY
}

impl Feature {
    /// Description of the measure, with the value of its parameter in place of the letter.
    pub fn described(&self) -> String {
        let Some(value) = self.parameter else { return self.description.to_owned() };
        let stands_for = |word: &str| match word {
            "x" | "g" | "q" => Some(value.to_string()),
            "k-th" => Some(format!("{value}{}", ordinal_end(value))),
            _ => None,
        };
        let words =
            self.description.split(' ').map(|word| stands_for(word).unwrap_or_else(|| word.to_owned()));
        words.collect::<Vec<_>>().join(" ")
    }
}

/// The ending of an ordinal number: 2nd, 3rd, 4th.
fn ordinal_end(value: f64) -> &'static str {
    match (value as u64 % 10, value as u64 % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    }
}

impl FeatureId {
    /// The feature called `name` in files.
    ///
    /// # Examples
    /// ```
    /// use placegraph::features::FeatureId;
    ///
    /// let gaps = FeatureId::from_name("A7(0.5)").unwrap();
    /// assert_eq!(gaps.feature().unit, "beams");
    /// assert_eq!(FeatureId::from_name("A99"), None);
    /// ```
    pub fn from_name(name: &str) -> Option<Self> {
        registry().iter().find(|feature| feature.name == name).map(|feature| feature.id)
    }

    /// The registry's entry.
    ///
    /// # Panics
    /// If the registry has no such position.
    pub fn feature(self) -> &'static Feature {
        &registry()[usize::from(self.0)]
    }
}

/// Every feature of the registry: the union of [`freiburg203`] and [`chapter183`].
pub fn all() -> Vec<FeatureId> {
    select(|_| true)
}

/// The 203 features of the author's program, which the chapter's experiments count.
pub fn freiburg203() -> Vec<FeatureId> {
    select(in_freiburg203)
}

/// The 183 features that have a number in appendices A and B of the book.
pub fn chapter183() -> Vec<FeatureId> {
    select(|feature| feature.book.is_some())
}

/// The 152 features of Sect. 3.4, with which Table 4.1 compares: those of [`freiburg203`] that existed before
/// the relations and normalized measures were added.
pub fn old152() -> Vec<FeatureId> {
    select(|feature| in_freiburg203(feature) && !is_added(feature))
}

/// The 120 features that cost least: all but A8, which looks at one scan at a time, and B6 beyond the harmonics that the
/// sums for B7 to B9 give as well. They take about half the time of all; the program's own model uses them.
pub fn lean120() -> Vec<FeatureId> {
    let is_high = |feature: &Feature| feature.parameter.is_some_and(|k| k > LEAN_HARMONIC);
    select(|feature| match feature.measure {
        Measure::BeamsOnLines => false,
        Measure::Fourier => !is_high(feature),
        _ => feature.book.is_some() || is_of_author(feature),
    })
}

/// Largest harmonic of [`lean120`].
const LEAN_HARMONIC: f64 = 5.0;

fn select(wanted: impl Fn(&Feature) -> bool) -> Vec<FeatureId> {
    registry().iter().filter(|feature| wanted(feature)).map(|feature| feature.id).collect()
}

fn in_freiburg203(feature: &Feature) -> bool {
    is_of_author(feature) && !matches!(feature.measure, Measure::BeamsOnLines | Measure::FormFactor)
}

/// Whether the author's program has the feature: it calls them f1, f2 and so on.
fn is_of_author(feature: &Feature) -> bool {
    let number = feature.code.and_then(|code| code.strip_prefix('f'));
    number.is_some_and(|number| number.starts_with(|digit: char| digit.is_ascii_digit()))
}

/// Whether the author's program calls the feature f27 to f34, or ends its name in `_2`.
fn is_added(feature: &Feature) -> bool {
    let code = feature.code.unwrap_or_default();
    let number = code.trim_start_matches('f').split('_').next().and_then(|digits| digits.parse().ok());
    code.ends_with("_2") || number.is_some_and(|number: u32| (27..=34).contains(&number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sets_have_the_published_sizes() {
        assert_eq!(freiburg203().len(), 203);
        assert_eq!(chapter183().len(), 183);
        assert_eq!(old152().len(), 152);
        assert_eq!(lean120().len(), 120);
        assert!(all().len() >= 216, "features may join them");
    }

    #[test]
    fn descriptions_are_unique_but_for_the_moments() {
        let mut described: Vec<String> = registry().iter().map(Feature::described).collect();
        let text = |name| FeatureId::from_name(name).unwrap().feature().described();
        assert_eq!(text("A3(10)"), "mean difference of consecutive beams cut at 10 meters");
        assert_eq!(text("A7(0.5)"), "number of gaps: consecutive beams that differ by more than 0.5 meters");
        assert_eq!(text("B6(2)"), "magnitude of the 2nd Fourier descriptor of the boundary");
        assert_eq!(
            [1, 2, 3, 4, 11, 12, 13, 21, 22, 23].map(|n| ordinal_end(f64::from(n))),
            ["st", "nd", "rd", "th", "th", "th", "th", "st", "nd", "rd"]
        );
        described.retain(|text| !text.starts_with("moment invariant"));
        let n = described.len();
        described.sort();
        described.dedup();
        // The standard deviation of two distances is called alike in B5 and B17 but for "over the largest".
        assert_eq!(described.len(), n);
    }

    #[test]
    fn names_are_unique_and_lead_back() {
        for feature in registry() {
            assert_eq!(FeatureId::from_name(&feature.name), Some(feature.id));
            assert_eq!(feature.id.feature(), feature);
        }
    }

    #[test]
    fn parameters_are_written_as_in_the_book() {
        for name in ["A1", "A3(2)", "A7(0.5)", "A15(0.3)", "B6(100)", "B10(3)", "f17_2", "f33(0.5)"] {
            assert!(FeatureId::from_name(name).is_some(), "{name}");
        }
    }
}
