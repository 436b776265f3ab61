//! The quadratic program of the cutting-plane learner: ½‖w‖² + C ξ under the planes found so far, w_e ≥ 0.
//!
//! Solved in its dual, max Σ a_c b_c − ½‖Π(Σ a_c g_c)‖² over a ≥ 0, Σ a = C, by moving mass between two planes at a
//! time; Π sets negative edge weights to zero. Cost: planes × weights per step, some thousand steps.

/// A cutting plane: every labeling demands ξ ≥ `loss` − w · `gradient`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    /// (ψ(ŷ) − ψ(y)) / N, node part then edge part.
    pub(super) gradient: Vec<f64>,
    /// ℓ(y) / N.
    pub(super) loss: f64,
}

/// The planes, and how much mass the last solution gave them.
#[derive(Clone, Debug)]
pub(super) struct WorkingSet {
    /// The first plane is ξ ≥ 0.
    planes: Vec<Plane>,
    mass: Vec<f64>,
    /// Weights from here on are not negative.
    first_edge_weight: usize,
}

/// Where the working set is solved.
#[derive(Clone, Debug)]
pub(super) struct Optimum {
    pub(super) weights: Vec<f64>,
    /// ξ: the largest violation among the planes, at least 0.
    pub(super) slack: f64,
    /// Value of the dual: no weights do better, even under more planes.
    pub(super) bound: f64,
}

/// The dual is solved to this share of the objective.
const TOLERANCE: f64 = 1e-9;
/// Steps after which the solution is taken as it is.
const MAX_STEPS: usize = 200_000;

impl WorkingSet {
    pub(super) fn new(n_weights: usize, first_edge_weight: usize) -> Self {
        let no_violation = Plane { gradient: vec![0.0; n_weights], loss: 0.0 };
        Self { planes: vec![no_violation], mass: vec![1.0], first_edge_weight }
    }

    pub(super) fn n_planes(&self) -> usize {
        self.planes.len() - 1
    }

    pub(super) fn add(&mut self, plane: Plane) {
        self.planes.push(plane);
        self.mass.push(0.0);
    }

    pub(super) fn solve(&mut self, cost: f64) -> Optimum {
        // The masses of another cost are a good start.
        let scale = cost / self.mass.iter().sum::<f64>();
        self.mass.iter_mut().for_each(|mass| *mass *= scale);
        let mut sum = self.weighted_sum();
        for step in 1..=MAX_STEPS {
            let weights = self.project(&sum);
            let violations: Vec<f64> =
                self.planes.iter().map(|p| p.loss - dot(&p.gradient, &weights)).collect();
            let to = arg_max(&violations);
            // The duality gap: C max − Σ a_c violation_c.
            let gap: f64 = self.mass.iter().zip(&violations).map(|(a, v)| a * (violations[to] - v)).sum();
            let objective = 0.5 * dot(&weights, &weights) + cost * violations[to];
            if gap <= TOLERANCE * objective.max(TOLERANCE) || step == MAX_STEPS {
                return Optimum { weights, slack: violations[to], bound: objective - gap };
            }
            let from = self.best_giver(to, &violations);
            let amount = self.best_amount(&sum, from, to);
            self.mass[to] += amount;
            self.mass[from] -= amount;
            if step % 1000 == 0 {
                sum = self.weighted_sum();
            } else {
                for (i, s) in sum.iter_mut().enumerate() {
                    *s += amount * (self.planes[to].gradient[i] - self.planes[from].gradient[i]);
                }
            }
        }
        unreachable!("the last step returns")
    }

    /// Σ a_c g_c.
    fn weighted_sum(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.planes[0].gradient.len()];
        for (plane, mass) in self.planes.iter().zip(&self.mass) {
            sum.iter_mut().zip(&plane.gradient).for_each(|(s, g)| *s += mass * g);
        }
        sum
    }

    /// Π.
    fn project(&self, sum: &[f64]) -> Vec<f64> {
        let clipped = |(i, &s): (usize, &f64)| if i < self.first_edge_weight { s } else { s.max(0.0) };
        sum.iter().enumerate().map(clipped).collect()
    }

    /// The plane with mass from which a move to `to` promises most, by the slope and curvature of the dual.
    fn best_giver(&self, to: usize, violations: &[f64]) -> usize {
        let promise = |from: usize| {
            let slope = violations[to] - violations[from];
            let curvature: f64 = self.planes[to]
                .gradient
                .iter()
                .zip(&self.planes[from].gradient)
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            if self.mass[from] > 0.0 { slope * slope / curvature.max(f64::MIN_POSITIVE) } else { -1.0 }
        };
        let promises: Vec<f64> = (0..self.planes.len()).map(promise).collect();
        arg_max(&promises)
    }

    /// The exact maximum of the dual along a move of mass: its slope falls and is linear between the amounts at
    /// which an edge weight reaches zero.
    fn best_amount(&self, sum: &[f64], from: usize, to: usize) -> f64 {
        let most = self.mass[from];
        let along: Vec<f64> =
            self.planes[to].gradient.iter().zip(&self.planes[from].gradient).map(|(a, b)| a - b).collect();
        let slope = |amount: f64| {
            let moved: Vec<f64> = sum.iter().zip(&along).map(|(s, d)| s + amount * d).collect();
            self.planes[to].loss - self.planes[from].loss - dot(&along, &self.project(&moved))
        };
        let mut knots: Vec<f64> = (self.first_edge_weight..sum.len())
            .map(|i| -sum[i] / along[i])
            .filter(|&knot| knot > 0.0 && knot < most)
            .collect();
        knots.push(most);
        knots.sort_by(f64::total_cmp);
        let (mut left, mut left_slope) = (0.0, slope(0.0));
        for right in knots {
            let right_slope = slope(right);
            if right_slope <= 0.0 {
                return left
                    + (right - left) * left_slope / (left_slope - right_slope).max(f64::MIN_POSITIVE);
            }
            (left, left_slope) = (right, right_slope);
        }
        most
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Position of the first largest value.
fn arg_max(values: &[f64]) -> usize {
    (1..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_plane_is_the_support_vector_machine_of_one_example() {
        // min ½w² + C max(0, 1 − 2 w): w = min(½, 2 C).
        for (cost, expected) in [(0.1, 0.2), (1.0, 0.5)] {
            let mut set = WorkingSet::new(1, 1);
            set.add(Plane { gradient: vec![2.0], loss: 1.0 });
            let optimum = set.solve(cost);
            assert!((optimum.weights[0] - expected).abs() < 1e-8);
            let objective = 0.5 * expected * expected + cost * (1.0 - 2.0 * expected).max(0.0);
            assert!((optimum.bound - objective).abs() < 1e-8);
        }
    }

    #[test]
    fn edge_weights_stay_at_zero_where_a_plane_pulls_them_below() {
        let mut set = WorkingSet::new(2, 1);
        set.add(Plane { gradient: vec![1.0, -3.0], loss: 1.0 });
        let optimum = set.solve(10.0);
        assert!((optimum.weights[0] - 1.0).abs() < 1e-6);
        assert!(optimum.weights[1].abs() < 1e-12);
    }
}
