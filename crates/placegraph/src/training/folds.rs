//! Folds for cross-validation: square blocks of the maps, dealt out so that every fold has its share of every class.
//!
//! Neighboring cells see nearly the same scan, so cells held out one by one would be as good as trained on. Whole
//! blocks are held out instead. Blocks are dealt out greedily, those with most of the rarest classes first, each to the
//! fold that lacks its classes most: deterministic, and every fold has all classes where enough blocks hold them.

/// The fold of each block, given the blocks' numbers of cells of each class.
///
/// Ties go to the block of lower number and to the fold with fewer cells, then to the fold of lower number.
pub fn assign_folds(blocks: &[Vec<usize>], n_folds: usize) -> Vec<usize> {
    let n_labels = blocks.first().map_or(0, Vec::len);
    let totals: Vec<f64> =
        (0..n_labels).map(|k| blocks.iter().map(|block| block[k]).sum::<usize>().max(1) as f64).collect();
    // Shares of the classes, so that a rare class weighs as much as a frequent one.
    let shares = |block: &[usize]| -> Vec<f64> {
        block.iter().zip(&totals).map(|(&n, total)| n as f64 / total).collect()
    };
    let mut largest_first: Vec<(f64, usize)> =
        blocks.iter().enumerate().map(|(b, block)| (shares(block).iter().sum(), b)).collect();
    largest_first.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut filled = vec![vec![0.0; n_labels]; n_folds];
    let mut fold_of = vec![0; blocks.len()];
    for (_, block) in largest_first {
        let shares = shares(&blocks[block]);
        let excess =
            |fold: &[f64]| -> f64 { fold.iter().zip(&shares).map(|(have, share)| have * share).sum() };
        let fullness = |fold: &[f64]| -> f64 { fold.iter().sum() };
        let fold = (0..n_folds).min_by(|&a, &b| {
            let (a, b) = (&filled[a], &filled[b]);
            excess(a).total_cmp(&excess(b)).then(fullness(a).total_cmp(&fullness(b)))
        });
        fold_of[block] = fold.unwrap_or(0);
        filled[fold_of[block]].iter_mut().zip(&shares).for_each(|(have, share)| *have += share);
    }
    fold_of
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fold_gets_its_share_of_the_rare_class() {
        // Six blocks; the second class stands in four of them.
        let blocks = [[100, 0], [100, 4], [90, 0], [80, 4], [100, 4], [100, 4]].map(Vec::from);
        let folds = assign_folds(&blocks, 2);
        for fold in 0..2 {
            let rare: usize = (0..6).filter(|&b| folds[b] == fold).map(|b| blocks[b][1]).sum();
            let frequent: usize = (0..6).filter(|&b| folds[b] == fold).map(|b| blocks[b][0]).sum();
            assert_eq!(rare, 8, "{folds:?}");
            assert!((280..=290).contains(&frequent), "{folds:?}");
        }
    }
}
