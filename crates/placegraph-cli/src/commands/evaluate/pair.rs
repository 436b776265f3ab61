//! One label image against the truth.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::eval::{CellScores, Confusion, DoorCounts, DoorScores, RoomScores, room_scores};
use placegraph::grid::{CellGraph, Grid, MapFrame, Occupancy};
use placegraph::import::{self, LabelTarget};
use placegraph::labels::{Label, LabelSet};
use placegraph::regions::{DiagonalSteps, Region, RegionId, RegionMap};
use serde::Serialize;

use crate::args::CropArg;
use crate::classes::{self, Classes};
use crate::read;

/// Largest image that is judged.
const MAX_PIXELS: u64 = 400_000_000;

/// What is judged, and how.
pub(super) struct Pair<'a> {
    pub(super) prediction: &'a Path,
    pub(super) labels: &'a Path,
    /// True rooms and found regions.
    pub(super) rooms: Option<(&'a Path, &'a Path)>,
    pub(super) crop: Option<CropArg>,
    /// Meters per pixel, for doors.
    pub(super) resolution_m: Option<f64>,
    /// Where the pixels are, for true labels in meters.
    pub(super) frame: Option<MapFrame>,
}

/// What was counted on one map.
pub(super) struct Judged {
    pub(super) cells: Confusion,
    pub(super) doors: Option<DoorCounts>,
    pub(super) rooms: Option<RoomScores>,
}

/// All measures of one map, or of several together.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) cells: CellScores,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) doors: Option<DoorScores>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rooms: Option<RoomScores>,
}

impl Judged {
    pub(super) fn report(&self, label_set: &LabelSet) -> Report {
        Report {
            cells: self.cells.scores(label_set),
            doors: self.doors.as_ref().map(|doors| doors.scores(label_set)),
            rooms: self.rooms.clone(),
        }
    }
}

impl Pair<'_> {
    /// Reads the images and compares them.
    pub(super) fn judge(&self, classes: &Classes) -> Result<Judged> {
        let Classes { label_set, coding } = classes;
        let bytes = read::image(self.prediction, MAX_PIXELS)?;
        let in_file = || format!("in {}", self.prediction.display());
        let size = import::image_size(&bytes, MAX_PIXELS).with_context(in_file)?;
        let name = self.labels.file_stem().unwrap_or_default().to_string_lossy();
        let target = LabelTarget { name: &name, size, frame: self.frame, coding };
        // A result says by itself how it is written; the truth may be painted in other colors.
        let own = Classes::beside(self.prediction)?.filter(|own| own.names().eq(classes.names()));
        let own_coding = own.as_ref().map_or(coding, |own| &own.coding);
        let predicted = import::read_labels(&bytes, size, own_coding).with_context(in_file)?;
        let predicted = predicted.map(|cell| cell.class());
        let mut truth = classes::labels(self.labels, MAX_PIXELS, &target)?.map(|cell| cell.class());
        if let Some(crop) = self.crop {
            keep_only(crop, &mut truth)?;
        }
        let rooms = match self.rooms {
            Some((rooms, regions)) => {
                let mut rooms = ids(rooms, size)?;
                if let Some(crop) = self.crop {
                    keep_only(crop, &mut rooms)?;
                }
                let (graph, regions) = region_map(&ids(regions, size)?, &predicted, label_set);
                Some(room_scores(&graph, &regions, label_set, &rooms))
            }
            None => None,
        };
        let doors = |resolution_m| DoorCounts::count(&predicted, &truth, label_set, resolution_m);
        Ok(Judged {
            cells: Confusion::count(&predicted, &truth, label_set),
            doors: self.resolution_m.map(doors),
            rooms,
        })
    }
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
        "expected a crop inside {width} x {height} pixels, found {crop}"
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
