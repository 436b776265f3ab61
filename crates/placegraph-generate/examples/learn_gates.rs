//! Learns what a gate is: `learn_gates OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...`.
//!
//! Maps of more than MAX_CELLS cells are left out. Prints how many examples there are.
#![allow(clippy::print_stdout, reason = "what a program tells")]

mod training_maps;

use std::path::PathBuf;
use std::{env, fs};

use placegraph::doorways::{DoorwayConfig, gates};
use placegraph::model::Model;
use placegraph::progress::Silent;
use placegraph::training::{GateExample, gate_examples, learn_gates};
use rayon::prelude::*;
use training_maps::{Outcome, TrainingMap, maps_of, source};

fn main() -> Outcome<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [out, rounds, max_cells, folders @ ..] = arguments.as_slice() else {
        return Err("expected OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...".into());
    };
    let max_cells = max_cells.parse()?;
    let model = Model::builtin();
    let maps = folders.iter().map(|folder| maps_of(folder, max_cells)).collect::<Outcome<Vec<_>>>()?.concat();
    let of_map = |map: &(PathBuf, f64)| Ok(examples(&TrainingMap::load(&map.0, map.1, &model)?, &model));
    let examples: Vec<Vec<GateExample>> = maps.par_iter().map(of_map).collect::<Outcome<_>>()?;
    let count =
        |is: fn(&GateExample) -> bool| examples.iter().flatten().filter(|example| is(example)).count();
    println!(
        "{} maps, {} gates, {} doorways, {} openings",
        maps.len(),
        count(|_| true),
        count(|example| example.is_doorway == Some(true)),
        count(|example| example.is_doorway != Some(true) && example.parts == Some(true)),
    );
    let sources = folders.iter().map(|folder| source(folder)).collect();
    fs::write(out, learn_gates(&examples, rounds.parse()?, sources, &Silent)?.to_json())?;
    Ok(())
}

fn examples(map: &TrainingMap, model: &Model) -> Vec<GateExample> {
    let config = DoorwayConfig::default();
    let gates = gates(&map.space, map.fields.each_ref(), &model.label_set, &config);
    gate_examples(&map.space, &gates, &map.labels, Some(&map.rooms), &model.label_set, &config)
}
