//! Boosting against the plain formulas, and its invariances.

use placegraph::boost::{
    CompiledClassifiers, DecisionList, Scores, StrongClassifier, adaboost, search_order, table_scores,
};
use placegraph::features::{FeatureId, FeatureTable};
use placegraph::labels::Label;
use placegraph::progress::Silent;
use placegraph_testkit::boost::{
    edge, largest_edge, largest_edge_by_sorting, sorted_columns, weights_of_rounds,
};
use proptest::prelude::*;

fn boost(table: &FeatureTable, labels: &[Label], n_labels: usize, rounds: usize) -> Vec<StrongClassifier> {
    let rows: Vec<u32> = (0..labels.len() as u32).collect();
    adaboost(table, &rows, labels, n_labels, rounds, &Silent).unwrap()
}

/// Tables of few different values, so that ties and equal neighbors abound; every class occurs.
fn examples(n_labels: u8) -> impl Strategy<Value = (FeatureTable, Vec<Label>)> {
    (usize::from(n_labels)..24, 1usize..5).prop_flat_map(move |(n, columns)| {
        let values = proptest::collection::vec((-3i8..4).prop_map(f32::from), n * columns);
        let labels = proptest::collection::vec(0..n_labels, n);
        (values, labels).prop_map(move |(values, mut labels)| {
            (0..n_labels).for_each(|k| labels[usize::from(k)] = k);
            let columns = (0..columns as u16).map(FeatureId).collect();
            (FeatureTable::from_columns(columns, n, values), labels.into_iter().map(Label).collect())
        })
    })
}

proptest! {
    #[test]
    fn every_round_takes_the_best_of_all_stumps((table, labels) in examples(3)) {
        for (k, classifier) in boost(&table, &labels, 3, 6).iter().enumerate() {
            let positive: Vec<bool> = labels.iter().map(|label| label.index() == k).collect();
            let weights = weights_of_rounds(&table, classifier, &positive);
            for (w, weights) in classifier.stumps.iter().zip(&weights) {
                let r = edge(&table, &w.stump, &positive, weights);
                let best = largest_edge(&table, &positive, weights);
                prop_assert!((r - best).abs() < 1e-9, "{r} {best}");
                let alpha = 0.5 * ((1.0 + r + 1e-7) / (1.0 - r + 1e-7)).ln();
                prop_assert!((w.alpha - alpha).abs() < 1e-3 * alpha.max(1e-3), "{} {alpha}", w.alpha);
            }
            if classifier.stumps.len() < 6 {
                let last = &weights[classifier.stumps.len()];
                let perfect = classifier.stumps.last().is_some_and(|w| w.alpha > 7.0);
                prop_assert!(perfect || largest_edge(&table, &positive, last) < 1e-8);
            }
        }
    }

    #[test]
    fn permuting_the_classes_permutes_the_classifiers((table, labels) in examples(5)) {
        let turned: Vec<Label> = labels.iter().map(|label| Label((label.0 + 2) % 5)).collect();
        let (plain, turned) = (boost(&table, &labels, 5, 4), boost(&table, &turned, 5, 4));
        for k in 0..5 {
            prop_assert_eq!(&plain[k], &turned[(k + 2) % 5]);
        }
    }

    #[test]
    fn scores_are_the_sum_within_rounding((table, labels) in examples(3)) {
        let classifiers = boost(&table, &labels, 3, 20);
        let rows: Vec<u32> = (0..table.n_rows() as u32).rev().collect();
        let scores = table_scores(&table, &rows, &CompiledClassifiers::new(&classifiers));
        for (example, &row) in rows.iter().enumerate() {
            for (k, classifier) in classifiers.iter().enumerate() {
                let plain = classifier.score(|id| table.values_of(id).unwrap()[row as usize]);
                let votes: f64 = classifier.stumps.iter().map(|w| w.alpha).sum();
                let bound = votes * (classifier.stumps.len() + 1) as f64 * f64::from(f32::EPSILON);
                prop_assert!((f64::from(scores.row(example)[k]) - plain).abs() <= bound);
            }
        }
    }

    #[test]
    fn lists_are_distributions_and_permute_with_their_classes(
        scores in proptest::collection::vec(-40.0f32..40.0, 4),
        temperature in 0.5f64..16.0,
    ) {
        let list = |order: [u8; 4]| DecisionList {
            order: order.map(Label).to_vec(),
            classifiers: Vec::new(),
            temperature,
        };
        let p = list([2, 0, 3, 1]).probabilities(&scores);
        prop_assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12 && p[..4].iter().all(|&p| p > 0.9e-6));
        let turned = [scores[3], scores[0], scores[1], scores[2]];
        let q = list([3, 1, 0, 2]).probabilities(&turned);
        for k in 0..4 {
            prop_assert!((p[k] - q[(k + 1) % 4]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_order_search_labels_as_the_list_does(
        scores in proptest::collection::vec((-8i8..8).prop_map(|v| f32::from(v) / 2.0), 4 * 9),
        labels in proptest::collection::vec((0u8..4).prop_map(Label), 9),
    ) {
        let scores = Scores::from_rows(4, scores);
        let found = search_order(&scores, &labels, &[1; 4], 2.0);
        prop_assert_eq!(found.len(), 24);
        for order in found {
            let list = DecisionList { order: order.order, classifiers: Vec::new(), temperature: 2.0 };
            let mut confusion = [[0usize; 4]; 4];
            for (called, truth) in list.classify(&scores).most_likely().iter().zip(&labels) {
                confusion[truth.index()][called.index()] += 1;
            }
            let right: usize = (0..4).map(|k| confusion[k][k]).sum();
            prop_assert!((order.accuracy - right as f64 / 9.0).abs() < 1e-12);
            let f1 = |k: usize| {
                let called: usize = confusion.iter().map(|row| row[k]).sum();
                2.0 * confusion[k][k] as f64 / (called + confusion[k].iter().sum::<usize>()) as f64
            };
            let present: Vec<usize> = (0..4).filter(|&k| confusion[k].iter().sum::<usize>() > 0).collect();
            let macro_f1 = present.iter().map(|&k| f1(k)).sum::<f64>() / present.len() as f64;
            prop_assert!((order.macro_f1 - macro_f1).abs() < 1e-12);
        }
    }
}

/// Columns of many values, of few values, of one frequent value and many rare ones, and a copy: every way in which bins
/// can lie. Six classes do not fit the four lanes of a pass.
#[test]
fn the_best_stump_is_found_inside_bins_too() {
    let n = 6000;
    let noise = |seed: usize, row: usize| {
        let x = (row as u64 * 6 + seed as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        ((x ^ x >> 29).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40) as f32 / 16_777_216.0
    };
    let column = |c: usize, row: usize| match c {
        0 | 5 => noise(0, row),
        1 => (noise(1, row) * 9.0).floor(),
        2 => (noise(2, row) - 0.8).max(0.0),
        3 => noise(3, row) + noise(0, row),
        _ => -noise(4, row) * noise(2, row),
    };
    let values = (0..6).flat_map(|c| (0..n).map(move |row| column(c, row))).collect();
    let table = FeatureTable::from_columns((0..6).map(FeatureId).collect(), n, values);
    let sum = |row: usize| noise(0, row) + noise(2, row) + 0.2 * noise(5, row);
    let labels: Vec<Label> = (0..n).map(|row| Label((sum(row) * 2.7) as u8)).collect();
    let sorted = sorted_columns(&table);
    for (k, classifier) in boost(&table, &labels, 6, 30).iter().enumerate() {
        let positive: Vec<bool> = labels.iter().map(|label| label.index() == k).collect();
        for (w, weights) in classifier.stumps.iter().zip(weights_of_rounds(&table, classifier, &positive)) {
            let r = edge(&table, &w.stump, &positive, &weights);
            let best = largest_edge_by_sorting(&table, &sorted, &positive, &weights);
            assert!((r - best).abs() < 1e-9, "class {k}: {r} {best}");
        }
    }
}

#[test]
fn any_number_of_threads_learns_the_same_bits() {
    let n = 5000;
    let wave = |column: usize, row: usize| ((row * (column * 37 + 11)) as f32 * 0.37).sin();
    let values = (0..12).flat_map(|column| (0..n).map(move |row| wave(column, row))).collect();
    let table = FeatureTable::from_columns((0..12).map(FeatureId).collect(), n, values);
    let labels: Vec<Label> = (0..n).map(|row| Label((wave(3, row) + wave(7, row) > 0.2) as u8)).collect();
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| boost(&table, &labels, 2, 20))
    };
    let (one, four) = (with_threads(1), with_threads(4));
    assert_eq!(one, four);
    assert_eq!(one[0].stumps.len(), 20);
}

/// The order table of eight classes is complete, and a perfect classifier scores 1 in every order.
#[test]
fn eight_classes_have_40320_orders() {
    let labels: Vec<Label> = (0..64).map(|example| Label(example % 8)).collect();
    let score = |example: usize, k: usize| if example % 8 == k { 10.0 } else { -10.0 };
    let values = (0..64).flat_map(|example| (0..8).map(move |k| score(example, k))).collect();
    let found = search_order(&Scores::from_rows(8, values), &labels, &[1; 8], 1.0);
    assert_eq!(found.len(), 40320);
    assert!(found.iter().all(|order| order.accuracy > 0.999));
    assert!(found.windows(2).all(|pair| pair[0].order < pair[1].order));
}
