//! The learning curve: how well held-out cells are labeled by models that saw less. Cost: a run of boosting for every fold and share.

use std::collections::BTreeSet;

use super::validate::{best_order, held_out, orders};
use super::{Dataset, TrainConfig, Validation};
use crate::progress::{Progress, Stage};

/// Shares of the labeled places that smaller models see.
const SHARES: [f64; 2] = [0.25, 0.5];

/// The accuracy of models that saw a share of the labeled places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The share, 1 for all.
    pub share: f64,
    /// Share of the held-out cells that is labeled right, in the best order.
    pub accuracy: f64,
}

/// The curve from a quarter of the places to all of them. A place is a square block of a map; blocks are left out in an order that
/// depends on nothing but their numbers. Shares with which a class would have no example are left out.
pub(super) fn learning_curve(
    data: &Dataset,
    block_of: &[u32],
    validation: &Validation,
    config: &TrainConfig,
    progress: &dyn Progress,
) -> Vec<CurvePoint> {
    progress.begin(Stage::Validate);
    let blocks: BTreeSet<u32> = block_of.iter().copied().collect();
    let mut shuffled: Vec<u32> = blocks.into_iter().collect();
    // Knuth's multiplicative hash: neighboring blocks do not stay together.
    shuffled.sort_by_key(|&block| (block.wrapping_mul(2_654_435_761), block));
    let mut curve = Vec::new();
    for share in SHARES {
        let n = (share * shuffled.len() as f64).round() as usize;
        let taken: BTreeSet<u32> = shuffled[..n].iter().copied().collect();
        let is_seen = |row: u32| taken.contains(&block_of[row as usize]);
        let rounds = [validation.n_rounds];
        let Some(found) = held_out(data, &rounds, config, &is_seen, progress) else { continue };
        if found.n_folds < validation.n_folds {
            continue;
        }
        let orders = orders(&found.scores[0], &found.labels, data, validation.temperature, config);
        curve.push(CurvePoint { share, accuracy: best_order(&orders).accuracy });
    }
    curve.push(CurvePoint { share: 1.0, accuracy: best_order(&validation.orders).accuracy });
    curve
}
