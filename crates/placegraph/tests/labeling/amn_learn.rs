//! The cutting-plane learner against an interior-point solver that knows every labeling.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use placegraph::amn::learn::{Ended, LabeledGraph, LearnConfig, Learner, Loss};
use placegraph::amn::model::{Weights, sufficient_statistics};
use placegraph::cuts::expand;
use placegraph::grid::{CellGraph, Connectivity};
use placegraph::labels::{Label, Labeling};
use placegraph_testkit::networks::{labelings, open_floor, uniform};

/// min ½‖w‖² + C ξ, g · w + ξ ≥ b for every labeling, ξ ≥ 0, w_e ≥ 0.
fn objective_by_quadratic_program(example: &LabeledGraph<'_>, n_labels: usize, cost: f64, loss: Loss) -> f64 {
    let n = example.labels.len() as f64;
    let flat_statistics = |y: &[Label]| {
        let Weights { node, edge } =
            sufficient_statistics(example.graph, example.features, y, n_labels, Connectivity::Eight);
        (node.len(), [node, edge].concat())
    };
    let (n_node, truth) = flat_statistics(example.labels);
    let class_size = |label: Label| example.labels.iter().filter(|&&y| y == label).count() as f64;
    let loss_at = |label: Label| match loss {
        Loss::Hamming => 1.0,
        Loss::Balanced => n / (n_labels as f64 * class_size(label)),
        Loss::Root => (n / (n_labels as f64 * class_size(label))).sqrt(),
    };
    // Clarabel wants A x + s = b, s ≥ 0.
    let (mut rows, mut right): (Vec<Vec<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
    for y in labelings(example.graph.n_nodes(), n_labels) {
        let (_, found) = flat_statistics(&y);
        let gradient = truth.iter().zip(&found).map(|(truth, found)| -(truth - found) / n);
        rows.push(gradient.chain([-1.0]).collect());
        let wrong = example.labels.iter().zip(&y).filter(|(a, b)| a != b);
        right.push(-wrong.map(|(&truth, _)| loss_at(truth)).sum::<f64>() / n);
    }
    let n_weights = truth.len();
    for i in n_node..=n_weights {
        rows.push((0..=n_weights).map(|j| if i == j { -1.0 } else { 0.0 }).collect());
        right.push(0.0);
    }
    let diagonal = |i: usize, j: usize| if i == j && i < n_weights { 1.0 } else { 0.0 };
    let quadratic: Vec<Vec<f64>> =
        (0..=n_weights).map(|i| (0..=n_weights).map(|j| diagonal(i, j)).collect()).collect();
    let linear: Vec<f64> = (0..=n_weights).map(|i| if i == n_weights { cost } else { 0.0 }).collect();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(rows.len())];
    let (p, a) = (CscMatrix::from(&quadratic), CscMatrix::from(&rows));
    let mut solver = DefaultSolver::new(&p, &linear, &a, &right, &cones, settings).unwrap();
    solver.solve();
    assert_eq!(solver.solution.status, SolverStatus::Solved);
    solver.solution.obj_val
}

/// Labels in vertical stripes, two noisy features.
fn striped_map(width: u32, height: u32, n_labels: usize, seed: u64) -> (CellGraph, Vec<f32>, Labeling) {
    let graph = open_floor(width, height);
    let labels: Labeling =
        graph.cells().iter().map(|cell| Label((cell.x as usize * n_labels / width as usize) as u8)).collect();
    let noise = |i: usize| 1.6 * (uniform(seed << 20 | i as u64) - 0.5);
    let row = |(i, label): (usize, &Label)| [(label.0 as f64 + noise(2 * i)) as f32, noise(2 * i + 1) as f32];
    let features = labels.iter().enumerate().flat_map(row).collect();
    (graph, features, labels)
}

#[test]
fn objective_equals_that_of_a_quadratic_program() {
    for seed in 0..6 {
        let n_labels = 2 + seed as usize % 2;
        let (width, height) = if n_labels == 2 { (4, 2) } else { (3, 2) };
        let (graph, features, labels) = striped_map(width, height, n_labels, seed);
        let example = LabeledGraph { graph: &graph, features: &features, labels: &labels };
        for loss in [Loss::Hamming, Loss::Balanced, Loss::Root] {
            let config = LearnConfig { loss, tolerance: 1e-7, ..LearnConfig::default() };
            let mut learner = Learner::new(&[example], n_labels, &config);
            for cost in [0.1, 1.0, 10.0, 100.0] {
                let learned = learner.fit(cost);
                let expected = objective_by_quadratic_program(&example, n_labels, cost, loss);
                let difference = (learned.objective - expected).abs() / expected.max(1.0);
                assert!(difference <= 1e-4, "{} not {expected}, C {cost}, seed {seed}", learned.objective);
                assert_eq!(learned.ended, Ended::Converged);
                let gap = learned.objective - learned.bound;
                assert!((0.0..=1e-5 * cost.max(1.0)).contains(&gap), "gap {gap}, C {cost}, seed {seed}");
                assert!(learned.weights.edge.iter().all(|&weight| weight >= 0.0));
            }
        }
    }
}

#[test]
fn too_few_planes_are_told() {
    let (graph, features, labels) = striped_map(12, 8, 3, 1);
    let example = LabeledGraph { graph: &graph, features: &features, labels: &labels };
    let config = LearnConfig { max_planes: 3, ..LearnConfig::default() };
    let learned = Learner::new(&[example], 3, &config).fit(100.0);
    assert_eq!((learned.ended, learned.n_planes), (Ended::PlaneLimit, 3));
    assert!(learned.objective - learned.bound > 0.01);
}

#[test]
fn neighbors_correct_noise() {
    let (graph, features, labels) = striped_map(30, 20, 3, 3);
    let example = LabeledGraph { graph: &graph, features: &features, labels: &labels };
    let learned = Learner::new(&[example], 3, &LearnConfig::default()).fit(100.0);
    let potentials = learned.weights.potentials(&features, Connectivity::Eight);
    let wrong = |found: &[Label]| found.iter().zip(&labels).filter(|(a, b)| a != b).count();
    let alone = wrong(&potentials.best_alone());
    let together = wrong(&expand(&graph, &potentials, &potentials.best_alone()));
    assert!(alone > 50 && together < 6, "{alone} cells wrong alone, {together} together");
}
