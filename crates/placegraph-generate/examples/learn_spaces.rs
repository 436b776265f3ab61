//! Learns which pieces of free space are passages: `learn_spaces OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...`.
//!
//! Pieces lie between the doorways and openings that the built-in model of gates finds. Maps of more than MAX_CELLS cells are left out.
//! Prints how many examples there are.
#![allow(clippy::print_stdout, reason = "what a program tells")]

mod training_maps;

use std::path::PathBuf;
use std::{env, fs};

use placegraph::doorways::{DoorwayConfig, Marked, mark};
use placegraph::model::Model;
use placegraph::progress::Silent;
use placegraph::spaces::{Measurements, SpaceConfig, pieces_between};
use placegraph::training::{SpaceExamples, learn_spaces, space_examples};
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
    let examples: Vec<SpaceExamples> = maps.par_iter().map(of_map).collect::<Outcome<_>>()?;
    let known = || examples.iter().flat_map(|map| map.is_passage.iter().flatten());
    println!(
        "{} maps, {} pieces, {} passages",
        maps.len(),
        known().count(),
        known().filter(|&&is| is).count()
    );
    let sources = folders.iter().map(|folder| source(folder)).collect();
    fs::write(out, learn_spaces(examples, rounds.parse()?, sources, &Silent)?.to_json())?;
    Ok(())
}

fn examples(map: &TrainingMap, model: &Model) -> SpaceExamples {
    let TrainingMap { space, fields, labeling, labels, .. } = map;
    let (fields, label_set) = (fields.each_ref(), &model.label_set);
    let Marked { labeling, cuts } = mark(space, fields, labeling, label_set, &DoorwayConfig::default(), None);
    let pieces = pieces_between(space, &labeling, &cuts, label_set);
    let measured = Measurements::of(space, &pieces, fields, label_set, &SpaceConfig::default());
    space_examples(space, &pieces, measured, labels, label_set)
}
