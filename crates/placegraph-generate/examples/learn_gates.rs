//! Learns what a gate is: `learn_gates OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...`.
//!
//! Maps of more than MAX_CELLS cells are left out. Prints how many examples there are.
#![allow(clippy::print_stdout, reason = "what a program tells")]

mod training_maps;

use std::fs;

use placegraph::doorways::{DoorwayConfig, gates};
use placegraph::model::Model;
use placegraph::progress::Silent;
use placegraph::training::{GateExample, gate_examples, learn_gates};
use training_maps::{Arguments, Outcome, TrainingMap};

fn main() -> Outcome<()> {
    let arguments = Arguments::read()?;
    let model = Model::builtin();
    let examples = arguments.examples(&model, |map| examples(map, &model))?;
    let count =
        |is: fn(&GateExample) -> bool| examples.iter().flatten().filter(|example| is(example)).count();
    println!(
        "{} maps, {} gates, {} doorways, {} openings",
        arguments.n_maps(),
        count(|_| true),
        count(|example| example.is_doorway == Some(true)),
        count(|example| example.is_doorway != Some(true) && example.parts == Some(true)),
    );
    let Arguments { out, rounds, sources, .. } = arguments;
    fs::write(out, learn_gates(&examples, rounds, sources, &Silent)?.to_json())?;
    Ok(())
}

fn examples(map: &TrainingMap, model: &Model) -> Vec<GateExample> {
    let config = DoorwayConfig::default();
    let gates = gates(&map.space, map.fields.each_ref(), &model.label_set, &config);
    gate_examples(&map.space, &gates, &map.labels, Some(&map.rooms), &model.label_set, &config)
}
