//! What the programs that learn take: OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...
//!
//! They learn from maps, make ROUNDS rounds, and write their model to OUT. Maps of more than MAX_CELLS cells are left out.
//!
//! FOLDER holds maps as `placegraph generate` writes them: NAME/map.yaml, labels.png, rooms.png. Of these, by name, the first
//! is taken, and every EVERY-th after it. The resolution of the first that is taken is multiplied by the first of SCALES (as
//! 1,0.8,1.35), that of the next by the next, over and over.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use placegraph::grid::{FreeSpace, Grid, MapFrame};
use placegraph::import::{
    LabelCell, LabelCoding, ReadOptions, image_size, load_map, read_labels, read_rooms,
};
use placegraph::labels::{Label, LabelField};
use placegraph::model::Model;
use placegraph::pipeline::{Smoothed, classify, smooth};
use placegraph::progress::Silent;
use rayon::prelude::*;

pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// A map, labeled by a model and as it was drawn.
#[allow(dead_code, reason = "each example needs another part")]
pub(crate) struct TrainingMap {
    pub(crate) space: FreeSpace,
    /// The distributions by single scans and smoothed.
    pub(crate) fields: [LabelField; 2],
    /// The most probable labels, smoothed.
    pub(crate) labeling: Vec<Label>,
    pub(crate) labels: Grid<Option<Label>>,
    pub(crate) rooms: Grid<u16>,
}

/// The arguments of a program that learns.
pub(crate) struct Arguments {
    /// Where the model goes.
    pub(crate) out: PathBuf,
    pub(crate) rounds: usize,
    /// Each map's folder and scale.
    maps: Vec<(PathBuf, f64)>,
    /// What the model's record says of the maps.
    pub(crate) sources: Vec<String>,
}

impl Arguments {
    /// Reads the command line.
    pub(crate) fn read() -> Outcome<Self> {
        let arguments: Vec<String> = env::args().skip(1).collect();
        let [out, rounds, max_cells, folders @ ..] = arguments.as_slice() else {
            return Err("expected OUT ROUNDS MAX_CELLS FOLDER:EVERY:SCALES...".into());
        };
        let max_cells = max_cells.parse()?;
        let maps = folders.iter().map(|folder| maps_of(folder, max_cells)).collect::<Outcome<Vec<_>>>()?;
        Ok(Self {
            out: out.into(),
            rounds: rounds.parse()?,
            maps: maps.concat(),
            sources: folders.iter().map(|folder| source(folder)).collect(),
        })
    }

    pub(crate) fn n_maps(&self) -> usize {
        self.maps.len()
    }

    /// What `examples_of` makes of every map, labeled by `model`.
    pub(crate) fn examples<T: Send>(
        &self,
        model: &Model,
        examples_of: impl Fn(&TrainingMap) -> T + Sync,
    ) -> Outcome<Vec<T>> {
        let of_map =
            |(folder, scale): &(PathBuf, f64)| Ok(examples_of(&TrainingMap::load(folder, *scale, model)?));
        self.maps.par_iter().map(of_map).collect()
    }
}

/// The maps of at most `max_cells` cells that FOLDER:EVERY:SCALES takes, each with its scale.
fn maps_of(argument: &str, max_cells: u64) -> Outcome<Vec<(PathBuf, f64)>> {
    let mut parts = argument.rsplitn(3, ':');
    let (Some(scales), Some(every), Some(folder)) = (parts.next(), parts.next(), parts.next()) else {
        return Err(format!("expected FOLDER:EVERY:SCALES, found {argument:?}").into());
    };
    let scales = scales.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut all: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    all.retain(|map| map.join("map.yaml").exists());
    all.sort();
    let mut maps = Vec::new();
    for (map, scale) in all.into_iter().step_by(every.parse()?).zip(scales.into_iter().cycle()) {
        if n_cells(&map)? <= max_cells {
            maps.push((map, scale));
        }
    }
    Ok(maps)
}

/// What the model's record says of FOLDER:EVERY:SCALES: the last two parts of the path.
fn source(argument: &str) -> String {
    let names: Vec<&str> = argument.rsplitn(3, '/').take(2).collect();
    names.into_iter().rev().collect::<Vec<_>>().join("/")
}

/// Number of cells of the map in `folder`.
fn n_cells(folder: &Path) -> Outcome<u64> {
    let (width, height) = image_size(&fs::read(folder.join("labels.png"))?, u64::MAX)?;
    Ok(u64::from(width) * u64::from(height))
}

impl TrainingMap {
    /// The map in `folder`, whose cells are taken for `scale` times as large as they are.
    fn load(folder: &Path, scale: f64, model: &Model) -> Outcome<Self> {
        let mut map = load_map(&folder.join("map.yaml"), &ReadOptions::default())?.grid;
        map.frame = MapFrame::new(map.frame.resolution_m() * scale, map.frame.map_from_grid())?;
        let space = FreeSpace::of(&map);
        let classified = classify(&map, &space, model, &Silent);
        let Smoothed { classified, smoothed, labeling } = smooth(&space, classified, model);
        let size = (map.cells.width(), map.cells.height());
        let coding = LabelCoding::of(&model.label_set);
        let labels = read_labels(&fs::read(folder.join("labels.png"))?, size, &coding)?;
        let labels = labels.map(|cell| match cell {
            LabelCell::Class(label) => Some(*label),
            LabelCell::None | LabelCell::Ignore => None,
        });
        let rooms = read_rooms(&fs::read(folder.join("rooms.png"))?, size)?;
        Ok(Self { space, fields: [classified, smoothed], labeling, labels, rooms })
    }
}
