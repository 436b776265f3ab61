//! The weak and the strong classifier: decision stump, weighted vote, confidence (Eqs. 4.1 to 4.4).

use crate::features::FeatureId;

/// The side of its threshold on which a stump answers yes: the sign p of Eq. (4.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Polarity {
    /// p = +1: yes where the value lies below the threshold.
    Below,
    /// p = −1: yes where the value lies above the threshold.
    Above,
}

/// A weak classifier that uses one feature (Eq. 4.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecisionStump {
    /// The feature f.
    pub feature: FeatureId,
    /// The threshold θ, in the unit of the feature.
    pub threshold: f32,
    /// The polarity p.
    pub polarity: Polarity,
}

impl DecisionStump {
    /// Whether h = +1 for `value` of the stump's feature. A value equal to the threshold gives −1.
    pub fn says_yes(&self, value: f32) -> bool {
        // Eq. (4.1): p f(x) < p θ.
        match self.polarity {
            Polarity::Below => value < self.threshold,
            Polarity::Above => value > self.threshold,
        }
    }
}

/// A stump with its vote.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedStump {
    /// The stump h.
    pub stump: DecisionStump,
    /// Its vote α, finite and not negative.
    pub alpha: f64,
}

/// A strong classifier: the weighted vote of its stumps (Fig. 4.2).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrongClassifier {
    /// The stumps in the order in which boosting chose them; its first t are the classifier of t rounds.
    pub stumps: Vec<WeightedStump>,
}

impl StrongClassifier {
    /// Score F(x) = Σ α h(x) of one example, whose features `value_of` returns.
    ///
    /// This is the plain formula; [`super::CompiledClassifiers`] evaluates many cells at once.
    pub fn score(&self, value_of: impl Fn(FeatureId) -> f32) -> f64 {
        let vote = |w: &WeightedStump| {
            if w.stump.says_yes(value_of(w.stump.feature)) { w.alpha } else { -w.alpha }
        };
        self.stumps.iter().map(vote).sum()
    }

    /// The classifier as it was after `n_rounds` rounds.
    pub fn truncated(&self, n_rounds: usize) -> Self {
        Self { stumps: self.stumps.iter().take(n_rounds).copied().collect() }
    }
}

/// Confidences (C⁺, C⁻) of a yes and of a no for score F at a temperature, Eqs. (4.2) and (4.3); they sum to 1, Eq. (4.4).
///
/// **Deviation**: the chapter's confidence is that of temperature 1. Boosting drives |F| up until nearly every
/// confidence is 0 or 1, and relaxation cannot revive a label of probability 0; dividing F by a temperature
/// fitted on held-out cells makes the confidences honest (Platt 1999).
pub fn confidence(score: f64, temperature: f64) -> (f64, f64) {
    // Eq. (4.2) as 1 / (1 + e^(−2F)): the printed quotient overflows for |F| > 700.
    let e = libm::exp(-2.0 * (score / temperature).abs());
    let (likely, unlikely) = (1.0 / (1.0 + e), e / (1.0 + e));
    if score >= 0.0 { (likely, unlikely) } else { (unlikely, likely) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stump(polarity: Polarity) -> DecisionStump {
        DecisionStump { feature: FeatureId(0), threshold: 2.0, polarity }
    }

    #[test]
    fn eq_4_1_is_strict_on_both_sides() {
        let says = |polarity| [1.0, 2.0, 3.0].map(|value| stump(polarity).says_yes(value));
        assert_eq!(says(Polarity::Below), [true, false, false]);
        assert_eq!(says(Polarity::Above), [false, false, true]);
    }

    #[test]
    fn fig_4_2_score_is_the_weighted_vote() {
        let vote = |polarity, alpha| WeightedStump { stump: stump(polarity), alpha };
        let classifier =
            StrongClassifier { stumps: vec![vote(Polarity::Below, 0.75), vote(Polarity::Above, 0.25)] };
        assert!((classifier.score(|_| 1.0) - 0.5).abs() < 1e-15);
        assert!((classifier.score(|_| 2.0) + 1.0).abs() < 1e-15);
        assert!((classifier.truncated(1).score(|_| 3.0) + 0.75).abs() < 1e-15);
    }

    #[test]
    fn eq_4_2_to_4_4_by_hand_and_far_out() {
        // e^F / (e^-F + e^F) with F = ln 2 is 2 / (1/2 + 2) = 4/5.
        let (yes, no) = confidence(2f64.ln(), 1.0);
        assert!((yes - 0.8).abs() < 1e-15 && (no - 0.2).abs() < 1e-15);
        // Twice the score at twice the temperature is the same.
        assert!((confidence(2.0 * 2f64.ln(), 2.0).0 - 0.8).abs() < 1e-15);
        assert_eq!(confidence(-1000.0, 1.0), (0.0, 1.0));
        assert_eq!(confidence(0.0, 1.0), (0.5, 0.5));
    }
}
