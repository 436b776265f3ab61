//! Learns which pieces of free space are passages: `learn_spaces OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...`.
//!
//! Pieces lie between the doorways and openings that the built-in model of gates finds. Maps of more than MAX_CELLS cells are left out.
//! Prints how many examples there are.
#![allow(clippy::print_stdout, reason = "what a program tells")]

mod training_maps;

use std::fs;

use placegraph::doorways::{DoorwayConfig, Marked, mark};
use placegraph::model::Model;
use placegraph::progress::Silent;
use placegraph::spaces::{Measurements, SpaceConfig, pieces_between};
use placegraph::training::{SpaceExamples, learn_spaces, space_examples};
use training_maps::{Arguments, Outcome, TrainingMap};

fn main() -> Outcome<()> {
    let arguments = Arguments::read()?;
    let model = Model::builtin();
    let examples = arguments.examples(&model, |map| examples(map, &model))?;
    let known = || examples.iter().flat_map(|map| map.is_passage.iter().flatten());
    println!(
        "{} maps, {} pieces, {} passages",
        arguments.n_maps(),
        known().count(),
        known().filter(|&&is| is).count()
    );
    let Arguments { out, rounds, sources, .. } = arguments;
    fs::write(out, learn_spaces(examples, rounds, sources, &Silent)?.to_json())?;
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
