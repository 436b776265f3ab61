//! The features of a group of cells, at the positions of the registry.

use std::sync::LazyLock;

use super::families::Measure;
use super::registry::registry;
use crate::scan::lanes::{Lanes, Singles};

/// For every measure, the position in the registry of its first feature.
static FIRST: LazyLock<Vec<usize>> = LazyLock::new(|| {
    let n_measures = registry().iter().map(|feature| feature.measure as usize + 1).max().unwrap_or(0);
    let first_of = |measure| registry().iter().position(|feature| feature.measure as usize == measure);
    (0..n_measures).map(|measure| first_of(measure).unwrap_or(usize::MAX)).collect()
});

/// One value per feature of the registry and cell of a group; those not asked for hold anything.
pub(super) struct Values {
    lanes: Vec<Singles>,
    first: &'static [usize],
}

impl Values {
    pub(super) fn new() -> Self {
        Self { lanes: vec![Lanes::all(0.0); registry().len()], first: &FIRST }
    }

    /// Stores the only feature of a family.
    #[inline(always)]
    pub(super) fn set(&mut self, measure: Measure, value: Singles) {
        self.set_member(measure, 0, value);
    }

    /// Stores the feature of the family's parameter number `member`.
    #[inline(always)]
    pub(super) fn set_member(&mut self, measure: Measure, member: usize, value: Singles) {
        self.lanes[self.first[measure as usize] + member] = value;
    }

    /// The values of the feature at `position` of the registry.
    #[inline(always)]
    pub(super) fn at(&self, position: usize) -> &Singles {
        &self.lanes[position]
    }
}
