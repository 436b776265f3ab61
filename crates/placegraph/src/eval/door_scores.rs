//! The rates of counted doors.

use std::fmt;

use serde::Serialize;

use super::doors::{DoorCounts, DoorTally};
use super::metrics::Percent;
use crate::labels::{Label, LabelSet, ratio};

/// Rates of a group of doors; `None` where a rate would be 0/0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DoorRates {
    /// True doors.
    pub n_true: u64,
    /// True doors that were found.
    pub n_found: u64,
    /// Found among true doors.
    pub recall: Option<f64>,
    /// Predicted doors.
    pub n_predicted: u64,
    /// Predicted doors that are right.
    pub n_right: u64,
    /// Right among predicted doors.
    pub precision: Option<f64>,
}

/// The rates of a group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoorGroup {
    /// What the doors of the group have in common.
    pub name: String,
    /// Their rates.
    #[serde(flatten)]
    pub rates: DoorRates,
}

/// All measures over doors; groups without doors are omitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DoorScores {
    /// The rates over all doors.
    #[serde(flatten)]
    pub all: DoorRates,
    /// The rates by clear width.
    pub by_width: Vec<DoorGroup>,
    /// The rates by the classes on both sides.
    pub by_sides: Vec<DoorGroup>,
}

impl From<&DoorTally> for DoorRates {
    fn from(tally: &DoorTally) -> Self {
        let DoorTally { n_true, n_found, n_predicted, n_right } = *tally;
        let (recall, precision) = (ratio(n_found, n_true), ratio(n_right, n_predicted));
        Self { n_true, n_found, recall, n_predicted, n_right, precision }
    }
}

impl DoorCounts {
    /// The measures that follow from the counts.
    pub fn scores(&self, label_set: &LabelSet) -> DoorScores {
        let group = |name: String, tally: &DoorTally| {
            (*tally != DoorTally::default()).then(|| DoorGroup { name, rates: tally.into() })
        };
        let class = |label: Option<Label>| label.map_or("none", |label| &label_set.class(label).name);
        let by_width = Self::width_names().into_iter().zip(&self.by_width);
        let by_sides = self.by_sides.iter().map(|(&[a, b], tally)| {
            // Sides without a class come last.
            let (first, second) = if a.is_none() { (b, a) } else { (a, b) };
            (format!("{} / {}", class(first), class(second)), tally)
        });
        DoorScores {
            all: (&self.all).into(),
            by_width: by_width.filter_map(|(name, tally)| group(name, tally)).collect(),
            by_sides: by_sides.filter_map(|(name, tally)| group(name, tally)).collect(),
        }
    }
}

impl fmt::Display for DoorScores {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let groups = self.by_width.iter().chain(&self.by_sides);
        let longest = groups.clone().map(|group| group.name.chars().count()).max().unwrap_or(0);
        let width = longest.max("all".len());
        let header = ["true", "found", "recall", "predicted", "right", "precision"];
        writeln!(f, "{:width$}{}", "doors", header.map(|name| format!("{name:>11}")).concat())?;
        let all = DoorGroup { name: "all".to_owned(), rates: self.all };
        for DoorGroup { name, rates } in [&all].into_iter().chain(groups) {
            let DoorRates { n_true, n_found, recall, n_predicted, n_right, precision } = rates;
            let (recall, precision) = (Percent(*recall), Percent(*precision));
            write!(f, "{name:width$}{n_true:>11}{n_found:>11}{recall:>11}")?;
            writeln!(f, "{n_predicted:>11}{n_right:>11}{precision:>11}")?;
        }
        Ok(())
    }
}
