//! The evidence of a node for every label that it may take.

use super::SpaceConfig;
use crate::labels::Label;

/// What speaks for the labels of a node.
pub(super) struct Evidence<'a> {
    pub(super) candidates: &'a [Label],
    pub(super) config: &'a SpaceConfig,
    /// Of a node, against an edge of the graph.
    pub(super) scale: f64,
}

impl Evidence<'_> {
    /// Appends the evidence of a node for every candidate: the scaled logarithm of its share among them, and for the label that is
    /// held on to that of its odds.
    pub(super) fn append(&self, row: &[f32], held: Option<Label>, out: &mut Vec<f64>) {
        let total: f64 = self.candidates.iter().map(|label| row[label.index()] as f64).sum();
        let least = self.config.least_probability;
        let share = |label: &Label| row[label.index()] as f64 / total.max(f64::MIN_POSITIVE);
        let bounded = |label| share(label).clamp(least, 1.0 - least);
        let first = out.len();
        out.extend(self.candidates.iter().map(|label| self.scale * bounded(label).ln()));
        if let Some(position) = held.and_then(|held| self.candidates.iter().position(|&label| label == held))
        {
            out[first + position] += self.scale * self.config.held_odds.ln();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORRIDOR: Label = Label(0);
    const ROOM: Label = Label(1);

    #[test]
    fn evidence_is_the_scaled_logarithm_of_the_share_among_places() {
        let config = SpaceConfig { evidence_per_m: 2.0, ..SpaceConfig::default() };
        let evidence = Evidence { candidates: &[CORRIDOR, ROOM], config: &config, scale: 0.5 };
        let of = |row: &[f32]| {
            let mut found = Vec::new();
            evidence.append(row, None, &mut found);
            found
        };
        let found = of(&[0.1, 0.3, 0.6]);
        assert!((found[0] - 0.5 * 0.25_f64.ln()).abs() < 1e-7, "{found:?}");
        assert!((found[1] - 0.5 * 0.75_f64.ln()).abs() < 1e-7, "{found:?}");
        assert!((of(&[0.0, 1.0, 0.0])[0] - 0.5 * 0.1_f64.ln()).abs() < 1e-7);
        assert!(of(&[0.0, 0.0, 1.0]).iter().all(|value| value.is_finite()));
    }
}
