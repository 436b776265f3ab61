//! `placegraph evaluate`: a label image against the truth.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::eval::{CellScores, Confusion, RoomScores, room_scores};
use placegraph::grid::{CellGraph, Grid, Occupancy};
use placegraph::import::{self, LabelCell, LabelCoding};
use placegraph::labels::{Label, LabelSet};
use placegraph::regions::{DiagonalSteps, Region, RegionId, RegionMap};
use serde::Serialize;

use super::Outcome;
use crate::args::{CropArg, EvaluateArgs};
use crate::model::NamedModel;
use crate::output::{print, print_json};
use crate::read;

/// Largest image that is judged.
const MAX_PIXELS: u64 = 400_000_000;

#[derive(Serialize)]
struct Report {
    cells: CellScores,
    #[serde(skip_serializing_if = "Option::is_none")]
    rooms: Option<RoomScores>,
}

/// Compares, prints, and checks the accuracy asked for.
pub(crate) fn run(args: &EvaluateArgs) -> Result<Outcome> {
    let label_set = match &args.model {
        Some(path) => NamedModel::load(Some(path))?.model.label_set,
        None => LabelSet::default(),
    };
    let predicted = labels(&args.prediction, None, &label_set)?;
    let size = (predicted.width(), predicted.height());
    let mut truth = labels(&args.labels, Some(size), &label_set)?;
    if let Some(crop) = args.crop {
        keep_only(crop, &mut truth)?;
    }
    let confusion = Confusion::count(&predicted, &truth, &label_set);
    let rooms = match (&args.rooms, &args.regions) {
        (Some(rooms), Some(regions)) => {
            let mut rooms = ids(rooms, size)?;
            if let Some(crop) = args.crop {
                keep_only(crop, &mut rooms)?;
            }
            let (graph, regions) = region_map(&ids(regions, size)?, &predicted, &label_set);
            Some(room_scores(&graph, &regions, &label_set, &rooms))
        }
        _ => None,
    };
    let report = Report { cells: confusion.scores(&label_set), rooms };
    if args.json {
        print_json(&report)?;
    } else {
        print(&format!("{}\n", report.cells))?;
        if let Some(rooms) = &report.rooms {
            print(&format!("{rooms}\n"))?;
        }
    }
    let enough =
        args.min_accuracy.is_none_or(|least| report.cells.accuracy.is_some_and(|found| found >= least));
    Ok(if enough { Outcome::Done } else { Outcome::CheckFailed })
}

/// The labels in the image at `path`; `size` of the map if it is known.
fn labels(path: &Path, size: Option<(u32, u32)>, label_set: &LabelSet) -> Result<Grid<Option<Label>>> {
    let bytes = read::image(path, MAX_PIXELS)?;
    let in_file = || format!("in {}", path.display());
    let size = size.map_or_else(|| import::image_size(&bytes, MAX_PIXELS), Ok).with_context(in_file)?;
    let cells = import::read_labels(&bytes, size, &LabelCoding::of(label_set)).with_context(in_file)?;
    Ok(cells.map(|cell| match cell {
        LabelCell::Class(label) => Some(*label),
        LabelCell::None | LabelCell::Ignore => None,
    }))
}

fn ids(path: &Path, size: (u32, u32)) -> Result<Grid<u32>> {
    let bytes = read::image(path, MAX_PIXELS)?;
    let ids = import::read_rooms(&bytes, size).with_context(|| format!("in {}", path.display()))?;
    Ok(ids.map(|&id| id.into()))
}

/// Empties everything outside of `crop`.
fn keep_only<T: Default>(crop: CropArg, grid: &mut Grid<T>) -> Result<()> {
    let (width, height) = (grid.width(), grid.height());
    ensure!(
        crop.x1 <= width && crop.y1 <= height,
        "expected a crop inside {width} x {height} pixels, found {crop:?}"
    );
    let cells: Vec<_> = grid.cells().collect();
    for cell in cells {
        let row = height - 1 - cell.y;
        if !((crop.x0..crop.x1).contains(&cell.x) && (crop.y0..crop.y1).contains(&row)) {
            grid[cell] = T::default();
        }
    }
    Ok(())
}

/// Regions as their image has them, each with the label that most of its cells have in `predicted`.
fn region_map(
    ids: &Grid<u32>,
    predicted: &Grid<Option<Label>>,
    label_set: &LabelSet,
) -> (CellGraph, RegionMap) {
    let graph = CellGraph::new(&ids.map(|&id| if id == 0 { Occupancy::Unknown } else { Occupancy::Free }));
    let n_regions = ids.values().iter().copied().max().unwrap_or(0) as usize;
    let mut votes = vec![vec![0u32; label_set.len()]; n_regions];
    let mut n_cells = vec![0; n_regions];
    let mut region_of = Vec::with_capacity(graph.n_nodes());
    for &cell in graph.cells() {
        let region = ids[cell] as usize - 1;
        region_of.push(RegionId(region as u32));
        n_cells[region] += 1;
        if let Some(label) = predicted[cell] {
            votes[region][label.index()] += 1;
        }
    }
    let label = |votes: &Vec<u32>| {
        let most = votes.iter().max().copied().unwrap_or(0);
        Label(votes.iter().position(|&n| n == most).unwrap_or(0) as u8)
    };
    let regions =
        votes.iter().map(label).zip(n_cells).map(|(label, n_cells)| Region { label, n_cells }).collect();
    (graph, RegionMap { region_of, regions, diagonal: DiagonalSteps::default() })
}
