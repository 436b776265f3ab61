//! The model file: the same bits after a round trip, and nothing read that is not exactly a model.

use placegraph::amn::{IamnModel, Standardization, model::Weights};
use placegraph::boost::{
    CompiledClassifiers, DecisionList, DecisionStump, Polarity, Scores, StrongClassifier, WeightedStump,
    table_scores,
};
use placegraph::features::{self, FeatureTable};
use placegraph::grid::{Connectivity, FreeSpace, OccupancyGrid};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::model::{BoostedModel, Method, Model, ModelError, NetworkModel, TrainingRecord};
use placegraph::pipeline;
use placegraph::progress::Silent;
use placegraph::regions::Thresholds;
use placegraph::relax::{Compatibility, RelaxConfig};
use placegraph::scan::ScanConfig;
use proptest::prelude::*;
use serde_json::{Value, json};

/// A model with `n_stumps` stumps a class and numbers that need all their digits.
fn model(n_stumps: usize) -> Model {
    let features = features::all();
    let stump = |class: usize, round: usize| {
        let number = (class * 1000 + round + 1) as f64;
        WeightedStump {
            stump: DecisionStump {
                feature: features[(class * 7 + round * 3) % features.len()],
                threshold: (number.sqrt() / 3.0) as f32,
                polarity: if round.is_multiple_of(2) { Polarity::Below } else { Polarity::Above },
            },
            alpha: 1.0 / number.cbrt(),
        }
    };
    let classifier =
        |class| StrongClassifier { stumps: (0..n_stumps).map(|round| stump(class, round)).collect() };
    let rows = (0..4).map(|k| (0..4).map(|j| f64::from(k * 4 + j) / 17.0 - 0.3).collect()).collect();
    Model {
        label_set: LabelSet::default(),
        scan: ScanConfig::default(),
        method: Method::Boosted(BoostedModel {
            list: DecisionList {
                order: [1, 0, 2].map(Label).to_vec(),
                classifiers: (0..3).map(classifier).collect(),
                temperature: 1.1,
            },
            relaxation: RelaxConfig::default(),
            compatibility: Compatibility::from_rows(rows).unwrap(),
        }),
        doorways: vec![WeightedStump {
            stump: DecisionStump {
                feature: placegraph::features::FeatureId(2),
                threshold: 0.5,
                polarity: Polarity::Above,
            },
            alpha: 0.25,
        }],
        thresholds: Thresholds::default(),
        record: TrainingRecord {
            resolution_m: 0.05,
            settings: serde_json::from_value(json!({ "n": 3 })).unwrap(),
            ..TrainingRecord::default()
        },
    }
}

fn classify(model: &Model) -> Vec<f32> {
    let Method::Boosted(boosted) = &model.method else { panic!("a boosted model") };
    let columns = boosted.list.columns();
    let values = (0..columns.len() * 50).map(|i| (i as f32 * 0.71).sin() * 20.0).collect();
    let table = FeatureTable::from_columns(columns, 50, values);
    let rows: Vec<u32> = (0..50).collect();
    let scores: Scores = table_scores(&table, &rows, &CompiledClassifiers::new(&boosted.list.classifiers));
    boosted.list.classify(&scores).values().to_vec()
}

#[test]
fn a_saved_model_classifies_with_the_same_bits() {
    let saved = model(60);
    let bytes = saved.to_json();
    let read = Model::from_json(&bytes).unwrap();
    assert_eq!(read, saved);
    assert_eq!(read.to_json(), bytes);
    assert_eq!(read.hash(), saved.hash());
    assert_eq!(read.hash().len(), 64);
    let bits = |model: &Model| classify(model).into_iter().map(f32::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(&read), bits(&saved));
}

#[test]
fn another_model_has_another_hash() {
    assert_ne!(model(3).hash(), model(4).hash());
}

#[test]
fn three_times_400_stumps_take_less_than_100_kb() {
    let n = model(400).to_json().len();
    assert!(n < 100_000, "{n}");
}

/// A network with five exemplars of two features, alone or on top of the list of [`model`].
fn network(n_stumps: Option<usize>) -> Model {
    let boosted = model(n_stumps.unwrap_or(1));
    let Method::Boosted(BoostedModel { list, .. }) = boosted.method else { panic!("a boosted model") };
    let list = n_stumps.map(|_| list);
    let n_features = 3 + if list.is_some() { 6 } else { 0 };
    let number = |i: usize| ((i + 1) as f64).sqrt() / 3.0 - 1.0;
    let network = IamnModel {
        standardization: Standardization {
            features: vec![features::all()[9], features::all()[2]],
            mean: vec![0.1, -7.3],
            deviation: vec![1.7, 0.3],
        },
        n_neighbors: 1,
        exemplars: (0..10).map(|i| number(i) as f32).collect(),
        exemplar_labels: [0, 0, 1, 2, 2].map(Label).to_vec(),
        weights: Weights { node: (0..3 * (n_features + 1)).map(number).collect(), edge: vec![0.3, 0.2, 0.0] },
        connectivity: Connectivity::Eight,
        temperature: 1.3,
    };
    Model { method: Method::Iamn(NetworkModel { list, network }), ..boosted }
}

#[test]
fn a_saved_network_labels_with_the_same_bits() {
    let map = OccupancyGrid::from_ascii(0.5, "########\n#...#..#\n#......#\n#...#..#\n########");
    let space = FreeSpace::of(&map);
    for saved in [network(None), network(Some(5))] {
        let bytes = saved.to_json();
        let read = Model::from_json(&bytes).unwrap();
        assert_eq!(read, saved);
        assert_eq!(read.to_json(), bytes);
        let bits = |model: &Model| {
            let found = pipeline::smooth(&space, pipeline::classify(&map, &space, model, &Silent), model);
            let bits = |field: &LabelField| field.values().iter().map(|p| p.to_bits()).collect::<Vec<_>>();
            (bits(&found.classified), bits(&found.smoothed), found.labeling)
        };
        assert_eq!(bits(&read), bits(&saved));
    }
}

/// The error that reading gives after `path` in the file was set to `value`.
fn spoiled(path: &str, value: Value) -> ModelError {
    spoil(&model(3), path, value)
}

fn spoil(model: &Model, path: &str, value: Value) -> ModelError {
    let mut file: Value = serde_json::from_slice(&model.to_json()).unwrap();
    *file.pointer_mut(path).unwrap_or_else(|| panic!("{path} in the file")) = value;
    Model::from_json(file.to_string().as_bytes()).unwrap_err()
}

#[test]
fn what_is_not_exactly_a_model_is_refused() {
    use ModelError as E;
    let boosted = |rest: &str| format!("/method/boosted/{rest}");
    assert!(matches!(spoiled("/format", json!("other")), E::Format { found } if found == "other"));
    assert!(matches!(spoiled("/version", json!(2)), E::Version { found: 2 }));
    assert!(matches!(spoiled("/version", json!(u64::MAX)), E::Version { .. }));
    assert!(matches!(spoiled("/scan", json!({ "range_max_m": 80.0 })), E::Json { .. }));
    assert!(matches!(spoiled("/scan/range_max_m", json!(-1.0)), E::Value { field: "range_max_m", .. }));
    assert!(matches!(spoiled("/scan/range_scale", json!(0)), E::Value { field: "range_scale", .. }));
    assert!(matches!(spoiled("/thresholds/min_place_m2", json!(-1)), E::Value { .. }));
    assert!(matches!(spoiled("/record/resolution_m", json!(0)), E::Value { field: "resolution_m", .. }));
    assert!(matches!(spoiled("/label_set/2/name", json!("room")), E::Json { .. }));
    assert!(matches!(spoiled("/method", json!({ "unheard": {} })), E::Json { .. }));

    let error = spoiled(&boosted("features/0"), json!("A99"));
    assert_eq!(
        error.to_string(),
        "the model uses the feature \"A99\", which this version of placegraph does not have"
    );
    let first = serde_json::from_slice::<Value>(&model(3).to_json()).unwrap();
    let first = first.pointer("/method/boosted/features/0").unwrap().clone();
    assert!(matches!(spoiled(&boosted("features/1"), first), E::Twice { of: "features", .. }));
    assert!(matches!(spoiled(&boosted("order/0"), json!("kitchen")), E::Class { name } if name == "kitchen"));
    assert!(matches!(spoiled(&boosted("order/0"), json!("doorway")), E::Twice { .. }));
    assert!(matches!(spoiled(&boosted("order"), json!(["room"])), E::Count { expected: 3, found: 1, .. }));
    assert!(matches!(spoiled(&boosted("classifiers"), json!([])), E::Count { expected: 3, found: 0, .. }));
    let square = json!([[0, 0, 0], [0, 0, 0], [0, 0, 0]]);
    assert!(matches!(spoiled(&boosted("compatibility"), square), E::Count { expected: 3, found: 2, .. }));
    assert!(matches!(spoiled(&boosted("compatibility/0/0"), json!(1.5)), E::Json { .. }));
    assert!(matches!(spoiled(&boosted("compatibility/0/0"), json!(null)), E::Json { .. }));
    assert!(matches!(spoiled(&boosted("temperature"), json!(0.0)), E::Value { field: "temperature", .. }));
    assert!(matches!(spoiled(&boosted("relaxation/iterations"), json!(4_000_000_000u32)), E::Value { .. }));
    assert!(matches!(spoiled(&boosted("classifiers/1/2/1"), json!(1e300)), E::Json { .. } | E::Value { .. }));
    for (at, value) in [(0, json!(1000)), (2, json!(0)), (3, json!(-0.5))] {
        let path = boosted(&format!("classifiers/1/2/{at}"));
        assert!(matches!(spoiled(&path, value), E::Value { .. }), "{path}");
        assert!(matches!(spoiled(&path, json!(null)), E::Json { .. }), "{path}");
    }
}

#[test]
fn what_is_not_exactly_a_network_is_refused() {
    use ModelError as E;
    let refused = |field: &str, value: Value, words: &str| {
        let error = spoil(&network(None), &format!("/method/iamn/network/{field}"), value);
        assert!(error.to_string().contains(words), "{field}: {error}");
    };
    let name = &features::all()[9].feature().name;
    refused("features/1", json!(name), "each once in features");
    refused("features/1", json!("A99"), "the feature \"A99\"");
    refused("features", json!([]), "at least one");
    refused("n_neighbors", json!(0), "1 to 1000");
    refused("n_neighbors", json!(2), "values in weights.node");
    refused("n_adjacent", json!(6), "4 or 8");
    refused("temperature", json!(0.0), "from 1e-12 to 1e12 in temperature");
    refused("mean", json!([0.0]), "expected 2 values in mean, found 1");
    refused("deviation/0", json!(0.0), "from 1e-8 to 1e8 in deviation");
    refused("weights/edge/0", json!(-0.1), "from 0 to 1e12 in weights.edge");
    refused("weights/node/0", json!(1e300), "up to 1e12 in weights.node");
    refused("weights/edge", json!([0.1]), "expected 3 values in weights.edge, found 1");
    refused("weights/node", json!([0.1]), "expected 12 values in weights.node, found 1");
    refused("exemplars/0", json!("*"), "base64 of 32-bit numbers");
    refused("exemplars/0", json!("AAAA"), "base64 of 32-bit numbers");
    // Two infinite numbers; then one number where rows have two.
    refused("exemplars/0", json!("AACAfwAAgH8="), "base64 of 32-bit numbers");
    refused("exemplars/0", json!("AACAPw=="), "expected 2 values in exemplars, found 1");
    refused("exemplars", json!([""]), "2 to 8 classes");

    let list = "/method/iamn/list";
    assert!(matches!(spoil(&network(Some(2)), list, json!(null)), E::Count { expected: 0, found: 6, .. }));
    let error = spoil(&network(Some(2)), &format!("{list}/temperature"), json!(0.0));
    assert!(matches!(error, E::Value { field: "temperature", .. }));
    let error = spoil(&network(Some(2)), &format!("{list}/order/0"), json!("kitchen"));
    assert!(matches!(error, E::Class { .. }));
    let two = json!([{ "name": "a", "role": "place", "color": [1, 2, 3] }, { "name": "b", "role": "passage", "color": [3, 2, 1] }]);
    assert!(matches!(spoil(&network(None), "/label_set", two), E::Count { expected: 2, found: 3, .. }));
}

#[test]
fn unknown_fields_and_broken_bytes_are_refused() {
    let text = String::from_utf8(model(3).to_json()).unwrap();
    let extra = text.replacen("\"scan\"", "\"more\":1,\"scan\"", 1);
    assert!(matches!(Model::from_json(extra.as_bytes()), Err(ModelError::Json { .. })));
    let not_finite = text.replacen("1.1", "NaN", 1);
    assert!(matches!(Model::from_json(not_finite.as_bytes()), Err(ModelError::Json { .. })));
    let too_big = text.replacen("1.1", "1e999", 1);
    assert!(matches!(Model::from_json(too_big.as_bytes()), Err(ModelError::Json { .. })));
    for bytes in [&b""[..], b"[]", b"{}", &text.as_bytes()[..text.len() / 2]] {
        assert!(matches!(Model::from_json(bytes), Err(ModelError::Json { .. })));
    }
    let deep = "[".repeat(1_000_000);
    assert!(matches!(Model::from_json(deep.as_bytes()), Err(ModelError::Json { .. })));
    let large = vec![b' '; placegraph::model::MAX_BYTES + 1];
    assert!(matches!(Model::from_json(&large), Err(ModelError::TooLarge { .. })));
}

proptest! {
    /// Any change of bytes is read as a model or refused, and what is read can be written.
    #[test]
    fn damaged_files_never_panic(at in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4)) {
        for mut bytes in [model(3).to_json(), network(None).to_json(), network(Some(2)).to_json()] {
            for &(index, byte) in &at {
                let index = index.index(bytes.len());
                bytes[index] = byte;
            }
            if let Ok(read) = Model::from_json(&bytes) {
                prop_assert_eq!(Model::from_json(&read.to_json()).unwrap(), read);
            }
        }
    }
}
