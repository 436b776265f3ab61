//! The quadratic program of the cutting-plane learner: ½‖w‖² + C ξ under the planes found so far, ξ ≥ 0 and w_e ≥ 0.
//!
//! Solved by a primal-dual interior-point method (Mehrotra 1992): there are few weights, and planes of one learner are
//! so alike that methods which look at one or two planes at a time take hundreds of thousands of steps. The weights
//! are then read off the dual, max Σ a_c b_c − ½‖Π(Σ a_c g_c)‖² over a ≥ 0, Σ a ≤ C, where Π sets negative edge
//! weights to zero, so that bound and violation hold whatever the rounding. Cost: planes × weights² per step, some 20
//! steps.

/// A cutting plane: a labeling demands ξ ≥ `loss` − w · `gradient`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    /// (ψ(ŷ) − ψ(y)) / N, node part then edge part.
    pub(super) gradient: Vec<f64>,
    /// ℓ(y) / N.
    pub(super) loss: f64,
}

/// The planes found so far.
#[derive(Clone, Debug)]
pub(super) struct WorkingSet {
    pub(super) planes: Vec<Plane>,
    n_weights: usize,
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

/// The program is solved to this share of the objective.
const TOLERANCE: f64 = 1e-9;
/// Steps after which the best solution so far is taken; the bound shows how good it is.
const MAX_STEPS: usize = 60;
/// How far towards the border of the feasible region a step may go.
const STEP_FRACTION: f64 = 0.995;

impl WorkingSet {
    pub(super) fn new(n_weights: usize, first_edge_weight: usize) -> Self {
        Self { planes: Vec::new(), n_weights, first_edge_weight }
    }

    pub(super) fn solve(&self, cost: f64) -> Optimum {
        let n_planes = self.planes.len();
        let n_edge_weights = self.n_weights - self.first_edge_weight;
        let n_constraints = n_planes + n_edge_weights + 1;
        let mut point = Point {
            x: vec![0.0; self.n_weights + 1],
            slack: vec![1.0; n_constraints],
            multiplier: vec![cost / (n_planes + 1) as f64; n_constraints],
        };
        let mut best = self.read(&point, cost);
        for _ in 0..MAX_STEPS {
            let objective = 0.5 * dot(&best.weights, &best.weights) + cost * best.slack;
            if objective - best.bound <= TOLERANCE * objective {
                break;
            }
            let Some(next) = self.step(&point, cost) else { break };
            point = next;
            let found = self.read(&point, cost);
            let gap = |o: &Optimum| 0.5 * dot(&o.weights, &o.weights) + cost * o.slack - o.bound;
            if gap(&found) < gap(&best) {
                best = found;
            }
        }
        best
    }

    /// Weights, violation and bound from the multipliers of the planes, made feasible.
    fn read(&self, point: &Point, cost: f64) -> Optimum {
        let of_planes = &point.multiplier[..self.planes.len()];
        let scale = cost / of_planes.iter().sum::<f64>().max(cost);
        let mut weights = vec![0.0; self.n_weights];
        let mut bound = 0.0;
        for (plane, a) in self.planes.iter().zip(of_planes) {
            weights.iter_mut().zip(&plane.gradient).for_each(|(w, g)| *w += scale * a * g);
            bound += scale * a * plane.loss;
        }
        weights[self.first_edge_weight..].iter_mut().for_each(|w| *w = w.max(0.0));
        bound -= 0.5 * dot(&weights, &weights);
        let violation = |plane: &Plane| plane.loss - dot(&plane.gradient, &weights);
        let slack = self.planes.iter().map(violation).fold(0.0, f64::max);
        Optimum { weights, slack, bound }
    }

    /// A x of all constraints A x ≥ b: planes, edge weights, ξ. The last entry of x is ξ.
    fn constraints(&self, x: &[f64]) -> Vec<f64> {
        let (weights, xi) = (&x[..self.n_weights], x[self.n_weights]);
        let planes = self.planes.iter().map(|plane| dot(&plane.gradient, weights) + xi);
        planes.chain(x[self.first_edge_weight..].iter().copied()).collect()
    }

    /// Aᵀ z.
    fn transposed(&self, z: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.n_weights + 1];
        let (of_planes, of_signs) = z.split_at(self.planes.len());
        for (plane, z) in self.planes.iter().zip(of_planes) {
            sum.iter_mut().zip(&plane.gradient).for_each(|(s, g)| *s += z * g);
            sum[self.n_weights] += z;
        }
        sum[self.first_edge_weight..].iter_mut().zip(of_signs).for_each(|(s, z)| *s += z);
        sum
    }

    /// Q + Aᵀ diag(d) A, whose lower triangle is filled.
    fn normal_matrix(&self, d: &[f64]) -> Vec<Vec<f64>> {
        let n = self.n_weights + 1;
        let mut matrix = vec![vec![0.0; n]; n];
        for (plane, d) in self.planes.iter().zip(d) {
            for i in 0..self.n_weights {
                let scaled = d * plane.gradient[i];
                matrix[i][..=i].iter_mut().zip(&plane.gradient).for_each(|(m, g)| *m += scaled * g);
                matrix[self.n_weights][i] += scaled;
            }
            matrix[self.n_weights][self.n_weights] += d;
        }
        for (i, row) in matrix.iter_mut().enumerate().take(self.n_weights) {
            row[i] += 1.0;
        }
        for (i, d) in (self.first_edge_weight..n).zip(&d[self.planes.len()..]) {
            matrix[i][i] += d;
        }
        matrix
    }

    /// One predictor-corrector step, or `None` where rounding allows no further one.
    fn step(&self, point: &Point, cost: f64) -> Option<Point> {
        let Point { x, slack, multiplier } = point;
        let n_constraints = slack.len();
        let losses = self.planes.iter().map(|plane| plane.loss).chain(std::iter::repeat(0.0));
        let primal: Vec<f64> =
            self.constraints(x).iter().zip(slack).zip(losses).map(|((ax, s), b)| ax - s - b).collect();
        let mut dual: Vec<f64> = x.iter().zip(self.transposed(multiplier)).map(|(x, az)| x - az).collect();
        dual[self.n_weights] += cost - x[self.n_weights];
        let ratio: Vec<f64> = multiplier.iter().zip(slack).map(|(z, s)| z / s).collect();
        let factor = cholesky(self.normal_matrix(&ratio))?;
        // Newton's step towards s z = target.
        let newton = |target: &dyn Fn(usize) -> f64| -> Point {
            let wish: Vec<f64> = (0..n_constraints)
                .map(|c| target(c) / slack[c] - multiplier[c] - ratio[c] * primal[c])
                .collect();
            let right: Vec<f64> = self.transposed(&wish).iter().zip(&dual).map(|(a, d)| a - d).collect();
            let dx = solve_factored(&factor, right);
            let ds: Vec<f64> = self.constraints(&dx).iter().zip(&primal).map(|(a, r)| a + r).collect();
            let dz =
                (0..n_constraints).map(|c| target(c) / slack[c] - multiplier[c] - ratio[c] * ds[c]).collect();
            Point { x: dx, slack: ds, multiplier: dz }
        };
        let mean = dot(slack, multiplier) / n_constraints as f64;
        let predictor = newton(&|_| 0.0);
        let after = point.moved(&predictor, point.longest_step(&predictor));
        let centering = (dot(&after.slack, &after.multiplier) / n_constraints as f64 / mean).powi(3);
        let corrector = newton(&|c| centering * mean - predictor.slack[c] * predictor.multiplier[c]);
        let next = point.moved(&corrector, STEP_FRACTION * point.longest_step(&corrector));
        next.x.iter().chain(&next.multiplier).all(|v| v.is_finite()).then_some(next)
    }
}

/// Variables (weights and ξ), slacks of the constraints, and their multipliers; or a step of all of them.
#[derive(Clone, Debug)]
struct Point {
    x: Vec<f64>,
    slack: Vec<f64>,
    multiplier: Vec<f64>,
}

impl Point {
    fn moved(&self, step: &Self, length: f64) -> Self {
        let moved = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + length * b).collect();
        Self {
            x: moved(&self.x, &step.x),
            slack: moved(&self.slack, &step.slack),
            multiplier: moved(&self.multiplier, &step.multiplier),
        }
    }

    /// The largest length up to 1 after which no slack or multiplier is negative.
    fn longest_step(&self, step: &Self) -> f64 {
        let values = self.slack.iter().chain(&self.multiplier);
        let steps = step.slack.iter().chain(&step.multiplier);
        values
            .zip(steps)
            .fold(1.0, |length: f64, (v, dv)| if *dv < 0.0 { length.min(-v / dv) } else { length })
    }
}

/// Lower triangular factor of a symmetric matrix given by its lower triangle; `None` if it is not positive definite.
fn cholesky(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    for i in 0..matrix.len() {
        for j in 0..=i {
            let sum = matrix[i][j] - dot(&matrix[i][..j], &matrix[j][..j]);
            if i == j && sum <= 0.0 {
                return None;
            }
            matrix[i][j] = if i == j { sum.sqrt() } else { sum / matrix[j][j] };
        }
    }
    Some(matrix)
}

/// Solves L Lᵀ x = `right`.
fn solve_factored(factor: &[Vec<f64>], mut right: Vec<f64>) -> Vec<f64> {
    for i in 0..factor.len() {
        right[i] = (right[i] - dot(&factor[i][..i], &right[..i])) / factor[i][i];
    }
    for i in (0..factor.len()).rev() {
        right[i] /= factor[i][i];
        let value = right[i];
        right[..i].iter_mut().zip(&factor[i]).for_each(|(r, l)| *r -= value * l);
    }
    right
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_plane_is_the_support_vector_machine_of_one_example() {
        // min ½w² + C max(0, 1 − 2 w): w = min(½, 2 C).
        for (cost, expected) in [(0.1, 0.2), (1.0, 0.5)] {
            let mut set = WorkingSet::new(1, 1);
            set.planes.push(Plane { gradient: vec![2.0], loss: 1.0 });
            let optimum = set.solve(cost);
            assert!((optimum.weights[0] - expected).abs() < 1e-8);
            let objective = 0.5 * expected * expected + cost * (1.0 - 2.0 * expected).max(0.0);
            assert!((optimum.bound - objective).abs() < 1e-8);
        }
    }

    #[test]
    fn edge_weights_stay_at_zero_where_a_plane_pulls_them_below() {
        let mut set = WorkingSet::new(2, 1);
        set.planes.push(Plane { gradient: vec![1.0, -3.0], loss: 1.0 });
        let optimum = set.solve(10.0);
        assert!((optimum.weights[0] - 1.0).abs() < 1e-6);
        assert!(optimum.weights[1].abs() < 1e-12);
    }

    #[test]
    fn without_planes_all_weights_are_zero() {
        let optimum = WorkingSet::new(3, 2).solve(5.0);
        assert_eq!(optimum.weights, [0.0; 3]);
        assert!(optimum.slack.abs() + optimum.bound.abs() < 1e-12);
    }
}
