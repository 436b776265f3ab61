//! Learns what a gate is: `learn_gates OUT ROUNDS SCALES FOLDER...`.
//!
//! Every folder holds maps as `placegraph generate` writes them: NAME/map.yaml, labels.png, rooms.png. `SCALES` are factors of the
//! resolution with which every map is read, as 0.75,1,1.4. Prints how many examples there are.
#![allow(clippy::print_stdout, reason = "what a program tells")]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use placegraph::doorways::{DoorwayConfig, gates};
use placegraph::grid::{FreeSpace, MapFrame};
use placegraph::import::{LabelCell, LabelCoding, ReadOptions, load_map, read_labels, read_rooms};
use placegraph::model::Model;
use placegraph::pipeline::{Smoothed, classify, smooth};
use placegraph::progress::Silent;
use placegraph::training::{GateExample, gate_examples, learn_gates};
use rayon::prelude::*;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [out, rounds, scales, folders @ ..] = arguments.as_slice() else {
        return Err("expected OUT ROUNDS SCALES FOLDER...".into());
    };
    let scales = scales.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let model = Model::builtin();
    let mut maps: Vec<PathBuf> = Vec::new();
    for folder in folders {
        let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
        maps.extend(entries.iter().map(fs::DirEntry::path).filter(|map| map.join("map.yaml").exists()));
    }
    maps.sort();
    let of_map = |map: &PathBuf| {
        scales
            .iter()
            .map(|&scale| examples(map, scale, &model))
            .collect::<Outcome<Vec<_>>>()
            .map(|all| all.concat())
    };
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
    let sources = folders.iter().map(|folder| {
        let name = Path::new(folder).file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    });
    let learned = learn_gates(&examples, rounds.parse()?, sources.collect(), &Silent)?;
    fs::write(out, learned.to_json())?;
    Ok(())
}

/// The examples of the map in `folder`, whose cells are taken for `scale` times as large as they are.
fn examples(folder: &Path, scale: f64, model: &Model) -> Outcome<Vec<GateExample>> {
    let mut map = load_map(&folder.join("map.yaml"), &ReadOptions::default())?.grid;
    map.frame = MapFrame::new(map.frame.resolution_m() * scale, map.frame.map_from_grid())?;
    let space = FreeSpace::of(&map);
    let classified = classify(&map, &space, model, &Silent);
    let Smoothed { classified, smoothed, .. } = smooth(&space, classified, model);
    let config = DoorwayConfig::default();
    let gates = gates(&space, [&classified, &smoothed], &model.label_set, &config);
    let size = (map.cells.width(), map.cells.height());
    let coding = LabelCoding::of(&model.label_set);
    let labels = read_labels(&fs::read(folder.join("labels.png"))?, size, &coding)?;
    let labels = labels.map(|cell| match cell {
        LabelCell::Class(label) => Some(*label),
        LabelCell::None | LabelCell::Ignore => None,
    });
    let rooms = read_rooms(&fs::read(folder.join("rooms.png"))?, size)?;
    Ok(gate_examples(&space, &gates, &labels, Some(&rooms), &model.label_set, &config))
}
