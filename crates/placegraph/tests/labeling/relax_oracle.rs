//! Relaxation against the plain formulas, and its invariances.

use placegraph::grid::{CellGraph, Grid, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelField};
use placegraph::relax::{Compatibility, RelaxConfig, relax};
use placegraph_testkit::relax as oracle;
use proptest::prelude::*;

fn steps(iterations: u32) -> RelaxConfig {
    RelaxConfig { iterations, ..RelaxConfig::default() }
}

fn close(field: &LabelField, expected: &[Vec<f64>], bound: f64) -> Result<(), String> {
    for (node, row) in expected.iter().enumerate() {
        for (k, p) in row.iter().enumerate() {
            if (f64::from(field.row(node)[k]) - p).abs() > bound {
                return Err(format!("node {node}: {:?} is not {row:?}", field.row(node)));
            }
        }
    }
    Ok(())
}

/// Two cells side by side: each has the other and seven walls around it.
#[test]
fn eq_4_6_and_4_7_by_hand() {
    let map = OccupancyGrid::from_ascii(1.0, "..");
    let graph = CellGraph::new(&map.cells);
    let rows = vec![vec![0.5, -0.5, 0.2], vec![-0.25, 0.25, -0.4], vec![0.0; 3]];
    let r = Compatibility::from_rows(rows).unwrap();
    let initial = LabelField::from_rows(2, vec![0.75, 0.25, 0.5, 0.5]);
    // Left: q(0) = (0.5 · 0.5 − 0.5 · 0.5 + 7 · 0.2) / 8 = 0.175, q(1) = (−0.125 + 0.125 − 2.8) / 8 = −0.35.
    // Right: q(0) = (0.375 − 0.125 + 1.4) / 8 = 0.20625, q(1) = (−0.1875 + 0.0625 − 2.8) / 8 = −0.365625.
    let left = [0.75 * 1.175, 0.25 * 0.65];
    let right = [0.5 * 1.20625, 0.5 * 0.634_375];
    let expected = [left, right].map(|[a, b]| vec![a / (a + b), b / (a + b)]);
    let relaxed = relax(&graph, &initial, &r, &steps(1));
    close(&relaxed.field, &expected, 1e-6).unwrap();
    let largest = expected[1][0] - 0.5;
    assert_eq!(relaxed.iterations, 1);
    assert!((f64::from(relaxed.last_change) - largest).abs() < 1e-6, "{}", relaxed.last_change);
}

#[test]
fn a_cell_whose_neighbors_rule_out_every_label_keeps_its_own() {
    let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, ".").cells);
    let r = Compatibility::from_rows(vec![vec![-1.0; 3]; 3]).unwrap();
    let initial = LabelField::from_rows(2, vec![0.25, 0.75]);
    assert_eq!(relax(&graph, &initial, &r, &steps(5)).field, initial);
}

#[test]
fn a_map_without_free_cells_stays_empty() {
    let graph = CellGraph::new(&OccupancyGrid::from_ascii(1.0, "#?").cells);
    let r = Compatibility::from_rows(vec![vec![0.5; 3]; 3]).unwrap();
    let relaxed = relax(&graph, &LabelField::from_rows(2, Vec::new()), &r, &RelaxConfig::default());
    assert_eq!(relaxed.field.n_nodes(), 0);
}

/// A map with its field and compatibilities, wider and higher than the blocks that the implementation works in.
fn problem(n_labels: usize) -> impl Strategy<Value = (Grid<Occupancy>, LabelField, Compatibility)> {
    let kind = prop_oneof![6 => Just(Occupancy::Free), 1 => Just(Occupancy::Occupied), 1 => Just(Occupancy::Unknown)];
    let cells = (1u32..40, 1u32..80).prop_flat_map(move |(width, height)| {
        let n = (width * height) as usize;
        proptest::collection::vec(kind.clone(), n)
            .prop_map(move |values| Grid::from_rows(width, height, values))
    });
    let n = n_labels + 1;
    let rows = proptest::collection::vec(proptest::collection::vec(-0.999f64..1.0, n), n);
    (cells, rows, any::<u32>()).prop_map(move |(map, rows, seed)| {
        let n_nodes = CellGraph::new(&map).n_nodes();
        (map, noise(n_nodes, n_labels, seed), Compatibility::from_rows(rows).unwrap())
    })
}

/// Distributions from a small congruential generator.
fn noise(n_nodes: usize, n_labels: usize, seed: u32) -> LabelField {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0 + 1e-6
    };
    let mut values = Vec::new();
    for _ in 0..n_nodes {
        let row: Vec<f32> = (0..n_labels).map(|_| next()).collect();
        let sum: f32 = row.iter().sum();
        values.extend(row.iter().map(|p| p / sum));
    }
    LabelField::from_rows(n_labels, values)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Differences of single steps add up where two labels are nearly even, so the bound grows with the steps.
    #[test]
    fn the_difference_from_f64_is_bounded((map, initial, r) in (2usize..=5).prop_flat_map(problem)) {
        let graph = CellGraph::new(&map);
        for (iterations, bound) in [(1, 2e-6), (5, 2e-5), (20, 5e-3)] {
            let found = relax(&graph, &initial, &r, &steps(iterations)).field;
            close(&found, &oracle::relax(&graph, &initial, &r, iterations), bound)
                .map_err(TestCaseError::fail)?;
        }
    }

    /// However the map is cut into bands and the iterations into passes.
    #[test]
    fn the_plain_twin_gives_the_same_bits((map, initial, r) in (2usize..=5).prop_flat_map(problem)) {
        let graph = CellGraph::new(&map);
        for iterations in [1, 7, 50] {
            let found = relax(&graph, &initial, &r, &steps(iterations)).field;
            prop_assert_eq!(found, oracle::relax_in_f32(&graph, &initial, &r, iterations));
        }
    }

    #[test]
    fn zero_compatibilities_change_nothing((map, initial, _) in problem(3)) {
        let graph = CellGraph::new(&map);
        let r = Compatibility::from_rows(vec![vec![0.0; 4]; 4]).unwrap();
        let found = relax(&graph, &initial, &r, &steps(10)).field;
        for (a, b) in found.values().iter().zip(initial.values()) {
            prop_assert!((a - b).abs() < 2e-6);
        }
    }

    #[test]
    fn permuting_the_classes_permutes_the_result((map, initial, r) in problem(3)) {
        let graph = CellGraph::new(&map);
        let turn = [1, 2, 0, 3];
        let back = |k: usize| turn.iter().position(|&t| t == k).unwrap();
        let label = |k: usize| Label(k as u8);
        let rows = (0..4).map(|k| (0..4).map(|j| r.r(label(back(k)), label(back(j)))).collect()).collect();
        let values = (0..graph.n_nodes()).flat_map(|node| (0..3).map(move |k| (node, k)));
        let turned = LabelField::from_rows(3, values.map(|(node, k)| initial.row(node)[back(k)]).collect());
        let plain = relax(&graph, &initial, &r, &steps(5)).field;
        let turned = relax(&graph, &turned, &Compatibility::from_rows(rows).unwrap(), &steps(5)).field;
        for node in 0..graph.n_nodes() {
            for k in 0..3 {
                prop_assert!((plain.row(node)[k] - turned.row(node)[turn[k]]).abs() < 2e-5);
            }
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits((map, initial, r) in problem(3)) {
        let graph = CellGraph::new(&map);
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| relax(&graph, &initial, &r, &steps(20)))
        };
        prop_assert_eq!(with_threads(1), with_threads(3));
    }

    /// Unknown cells around the map are what was outside before.
    #[test]
    fn a_margin_of_unknown_cells_changes_nothing((map, initial, r) in problem(3)) {
        let (width, height) = (map.width() + 9, map.height() + 40);
        let mut padded = Grid::filled(width, height, Occupancy::Unknown);
        for cell in map.cells() {
            padded[placegraph::grid::Cell::new(cell.x + 5, cell.y + 33)] = map[cell];
        }
        let plain = relax(&CellGraph::new(&map), &initial, &r, &steps(6));
        prop_assert_eq!(relax(&CellGraph::new(&padded), &initial, &r, &steps(6)), plain);
    }
}

/// Wider than a tile, higher than a band, and more iterations than a pass makes.
#[test]
fn a_large_map_has_the_bits_of_the_plain_twin() {
    let mut map = Grid::filled(1590, 150, Occupancy::Free);
    for (index, value) in map.values_mut().iter_mut().enumerate() {
        if (index * 7919) % 13 == 0 || index % 1590 / 40 == 13 {
            *value = Occupancy::Occupied;
        }
    }
    let graph = CellGraph::new(&map);
    let initial = noise(graph.n_nodes(), 3, 5);
    let row = |k: usize| (0..4).map(|other| if k == other { 0.4 } else { -0.1 * k as f64 }).collect();
    let r = Compatibility::from_rows((0..4).map(row).collect()).unwrap();
    for iterations in [9, 10, 23] {
        let found = relax(&graph, &initial, &r, &steps(iterations));
        let before = oracle::relax_in_f32(&graph, &initial, &r, iterations - 1);
        let expected = oracle::relax_in_f32(&graph, &before, &r, 1);
        assert!(found.field == expected, "{iterations} iterations");
        let changes = expected.values().iter().zip(before.values()).map(|(a, b)| (a - b).abs());
        assert_eq!(found.last_change.to_bits(), changes.fold(0.0, f32::max).to_bits());
    }
}

#[test]
fn patience_stops_when_labels_stay() {
    let map = Grid::filled(20, 20, Occupancy::Free);
    let graph = CellGraph::new(&map);
    let initial = LabelField::from_rows(2, [0.75, 0.25].repeat(400));
    let rows = vec![vec![0.5, -0.5, 0.0], vec![-0.5, 0.5, 0.0], vec![0.0; 3]];
    let config = RelaxConfig { iterations: 50, patience: Some(5) };
    let relaxed = relax(&graph, &initial, &Compatibility::from_rows(rows).unwrap(), &config);
    assert_eq!(relaxed.iterations, 5);
}
