//! Two methods on the same maps: is the difference more than chance?
//!
//! Wilcoxon's signed-rank test, two-sided and exact: differences of 0 are left out, the absolute values of the others are ranked
//! (equal ones share the mean of their ranks), and the sum of the ranks of the positive ones is compared with that under all
//! choices of signs. Exact also with ties; no normal approximation. Cost: n · n².
//!
//! F. Wilcoxon, "Individual comparisons by ranking methods", Biometrics Bulletin 1 (1945).

use serde::Serialize;

/// A measure of two methods on the same maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairedTest {
    /// Maps on which both have the measure.
    pub n_pairs: usize,
    /// Maps on which the first has more.
    pub n_more: usize,
    /// Maps on which the first has less.
    pub n_less: usize,
    /// Mean of first minus second.
    pub mean_difference: f64,
    /// Probability of a rank sum at least as far from its mean if signs were chance; 1 where all are equal.
    pub p_value: f64,
}

impl PairedTest {
    /// Compares pairs of values (first, second); `None` without pairs.
    pub fn of(pairs: &[(f64, f64)]) -> Option<Self> {
        let differences: Vec<f64> = pairs.iter().map(|(first, second)| first - second).collect();
        let n_pairs = differences.len();
        (n_pairs > 0).then(|| Self {
            n_pairs,
            n_more: differences.iter().filter(|&&d| d > 0.0).count(),
            n_less: differences.iter().filter(|&&d| d < 0.0).count(),
            mean_difference: differences.iter().sum::<f64>() / n_pairs as f64,
            p_value: signed_rank(differences),
        })
    }
}

/// The two-sided p-value of Wilcoxon's signed-rank test.
fn signed_rank(mut differences: Vec<f64>) -> f64 {
    differences.retain(|&d| d.abs() > 0.0);
    differences.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    // Twice the ranks, which are whole or half.
    let mut ranks: Vec<(usize, bool)> = Vec::with_capacity(differences.len());
    for tied in differences.chunk_by(|a, b| a.abs().total_cmp(&b.abs()).is_eq()) {
        let (first, last) = (ranks.len() + 1, ranks.len() + tied.len());
        ranks.extend(tied.iter().map(|&d| (first + last, d > 0.0)));
    }
    let found: usize = ranks.iter().filter(|(_, is_positive)| *is_positive).map(|(rank, _)| rank).sum();
    let largest: usize = ranks.iter().map(|(rank, _)| rank).sum();
    // The probability of every sum: each rank is added or not.
    let mut chance = vec![0.0; largest + 1];
    chance[0] = 1.0;
    for (rank, _) in &ranks {
        for sum in (0..=largest).rev() {
            let with = if sum >= *rank { chance[sum - rank] } else { 0.0 };
            chance[sum] = 0.5 * (chance[sum] + with);
        }
    }
    let (low, high): (f64, f64) = (chance[..=found].iter().sum(), chance[found..].iter().sum());
    (2.0 * low.min(high)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(differences: &[f64]) -> f64 {
        signed_rank(differences.to_vec())
    }

    #[test]
    fn worked_by_hand() {
        // All five of one sign: 2 of 32 choices of signs are as far out.
        assert!((p(&[1.0, 2.0, 3.0, 4.0, 5.0]) - 2.0 / 32.0).abs() < 1e-12);
        // Ranks 1 2 3 4, the 2 negative: a sum of 8 of 10. Sums from 8: 8 (134), 9 (234), 10; three of 16, twice.
        assert!((p(&[0.1, -0.2, 0.3, 0.4]) - 6.0 / 16.0).abs() < 1e-12);
        // Three ties share the rank 2: 4 of 6; four of eight choices reach it.
        assert!((p(&[1.0, 1.0, -1.0]) - 1.0).abs() < 1e-12);
        // Zeros are left out.
        assert!((p(&[0.0, 1.0, 2.0, 0.0]) - 2.0 / 4.0).abs() < 1e-12);
        assert!((p(&[]) - 1.0).abs() < 1e-12 && (p(&[0.0]) - 1.0).abs() < 1e-12);
        let test = PairedTest::of(&[(0.9, 0.8), (0.7, 0.7), (0.5, 0.6)]).unwrap();
        assert_eq!((test.n_pairs, test.n_more, test.n_less), (3, 1, 1));
        assert!(test.mean_difference.abs() < 1e-12 && PairedTest::of(&[]).is_none());
    }

    /// All choices of signs, one by one.
    fn by_enumeration(differences: &[f64]) -> f64 {
        let n = differences.len();
        let rank = |i: usize| {
            let below = differences.iter().filter(|d| d.abs() < differences[i].abs()).count() as f64;
            let equal = differences.iter().filter(|d| d.abs() <= differences[i].abs()).count() as f64 - below;
            below + f64::midpoint(equal, 1.0)
        };
        let sum = |signs: usize| (0..n).filter(|i| signs >> i & 1 == 1).map(rank).sum::<f64>();
        let found: f64 = (0..n).filter(|&i| differences[i] > 0.0).map(rank).sum();
        let share = |is: &dyn Fn(f64) -> bool| {
            (0..1usize << n).filter(|&signs| is(sum(signs))).count() as f64 / (1usize << n) as f64
        };
        (2.0 * share(&|s| s <= found).min(share(&|s| s >= found))).min(1.0)
    }

    #[test]
    fn sums_by_sums_are_all_choices_of_signs() {
        let cases: [&[f64]; 4] = [
            &[0.3, -0.1, 0.2, 0.2, 0.5, -0.5, 0.7],
            &[-1.0, 2.0, -3.0, 4.0, 5.0, 6.0, -7.0, 8.0, 9.0, 10.0],
            &[1.0, 1.0, 1.0, 2.0, 2.0, -2.0, 3.0, -3.0],
            &[-4.0, -3.0, -2.0, -1.0],
        ];
        for case in cases {
            assert!((p(case) - by_enumeration(case)).abs() < 1e-12, "{case:?}");
        }
    }
}
