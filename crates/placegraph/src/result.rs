//! The files of a labeled map and its options: one list of each for every program that writes them.

mod options;

use std::time::Duration;

use crate::export::{
    Export, ExportError, FileRecord, Format, Georeference, MapInfo, MaskSettings, ModelInfo, RasterError,
    SkippedFormat, TopologyDocument, TopologyError, label_png, labels_yaml, overview_png, probability_npy,
    raster_yaml, region_png,
};
use crate::grid::{Grid, Occupancy, OccupancyGrid};
use crate::import::{Finding, LoadedMap, Severity, has_memory};
use crate::labels::LabelSet;
use crate::model::Model;
use crate::pipeline::{self, Analysis, Frames};
use crate::topology::PlaceId;
use crate::topology::reach::{self, GraphCheck, Robot};

pub use options::{InputHashes, ResultOptions, export_word, is_export, is_previous};

/// Name of the document in the folder of a result.
pub const DOCUMENT: &str = "topology.json";

/// Files by name, in the order in which they are written.
pub type Files = Vec<(String, Vec<u8>)>;

/// A map that was read, and what labeling it gave.
#[derive(Clone, Copy, Debug)]
pub struct LabeledMap<'a> {
    /// The map.
    pub map: &'a LoadedMap,
    /// The classes of the model.
    pub classes: &'a LabelSet,
    /// What the pipeline found. Its smoothed field may be empty if no file of the result shows it.
    pub analysis: &'a Analysis,
}

/// What the files of a result depend on besides the labeled map.
#[derive(Clone, Copy, Debug)]
pub struct ResultContents<'a> {
    /// Whether the label images of the stages before the last are written too.
    pub stages: bool,
    /// Whether the distributions of all cells are written.
    pub probabilities: bool,
    /// The formats, each once.
    pub formats: &'a [&'static Format],
    /// Values of the masks.
    pub masks: &'a MaskSettings,
    /// Where the map stands on Earth.
    pub georeference: Option<Georeference>,
    /// The time since 1970 that files with a date bear.
    pub written: Duration,
}

/// Why a result has no files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultError {
    /// A label image cannot hold the map.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// The mask settings do not fit the map.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The document cannot be written.
    #[error(transparent)]
    Document(#[from] TopologyError),
    /// The system has less memory than labeling takes.
    #[error("not enough memory: labeling {n_free} free cells needs {n_bytes} bytes")]
    Memory {
        /// Free cells of the map.
        n_free: u64,
        /// Bytes that labeling takes at most.
        n_bytes: u64,
    },
    /// The system has less memory than drawing and writing the places takes.
    #[error("not enough memory: drawing {n_places} places needs {n_bytes} bytes")]
    DrawingMemory {
        /// Places of the map.
        n_places: u64,
        /// Bytes that their files take at most.
        n_bytes: u64,
    },
    /// More places than there are numbers.
    #[error(
        "expected a map of at most {} places, which is what region images can number, found {n_places} at least; label parts of \
         the map one by one, or clean it if these are specks",
        PlaceId::MAX.0
    )]
    TooManyPlaces {
        /// Places of the map, or the least number that it can have.
        n_places: u64,
    },
}

/// What a run takes besides the map and what grows with it.
const BASE_BYTES: u64 = 64 << 20;

/// Refuses, before it is labeled, a map whose result does not fit into memory, or has more places than can be numbered:
/// parts that nothing joins are places, but for small ones where the labels `are_corrected`.
///
/// # Errors
/// If the system has less memory than labeling takes, or the map has more than 65 535 parts that will be places.
pub fn check_size(map: &LoadedMap, model: &Model, are_corrected: bool) -> Result<(), ResultError> {
    let n_cells = map.grid.cells.values().len() as u64;
    let n_free = map.grid.count(Occupancy::Free) as u64;
    let enough = |n_parts, n_places| {
        let grown = pipeline::memory_bytes(n_cells, n_free, model.label_set.len(), n_parts, n_places);
        let n_bytes = BASE_BYTES + grown;
        if has_memory(n_bytes) { Ok(()) } else { Err(ResultError::Memory { n_free, n_bytes }) }
    };
    // The parts are counted only where the rest has room.
    enough(0, 0)?;
    let min_island_m2 = if are_corrected { model.thresholds.min_island_m2 } else { 0.0 };
    let (n_parts, n_places) = pipeline::parts(&map.grid, min_island_m2);
    check_n_places(n_places)?;
    enough(n_parts, n_places)
}

fn check_n_places(n_places: u64) -> Result<(), ResultError> {
    if n_places <= u64::from(PlaceId::MAX.0) { Ok(()) } else { Err(ResultError::TooManyPlaces { n_places }) }
}

impl LabeledMap<'_> {
    /// The map with the walls and openings that edits drew.
    pub fn grid(&self) -> &OccupancyGrid {
        self.analysis.drawn.as_ref().unwrap_or(&self.map.grid)
    }

    /// The document of the result, which has neither options nor files yet. `findings` are those of the map, `edits` is
    /// the name of the edit file as a reader shall see it.
    pub fn document(
        &self,
        model: ModelInfo,
        findings: &[Finding],
        robot: &Robot,
        edits: &str,
    ) -> TopologyDocument {
        let Self { map, classes, analysis } = self;
        let info = MapInfo::of(&map.grid, &map.name, &map.hash);
        let mut document = TopologyDocument::new(info, Some(model), classes, &analysis.topology);
        let outcomes = analysis.edit_outcomes.iter().zip(1..);
        let unapplied = outcomes.filter_map(|(outcome, n)| {
            let reason = outcome.as_ref().err()?;
            Some(format!("edit {n} of {edits} does not apply: {reason}"))
        });
        let frames = analysis.frames.as_ref().and_then(Frames::disagreement);
        let unmet: Vec<String> = unapplied.chain(frames).collect();
        let errors = findings.iter().filter(|finding| finding.severity() == Severity::Error);
        document.errors = errors.map(ToString::to_string).chain(unmet.iter().cloned()).collect();
        document.findings = findings.iter().map(ToString::to_string).chain(unmet).collect();
        document.findings.extend(reach::remarks(&analysis.topology, robot));
        document.graph = Some(GraphCheck::of(&analysis.topology, robot.radius_m));
        document
    }

    /// All files of the result, the document last, which lists the others. A format that cannot hold the map is skipped, and
    /// listed as such.
    ///
    /// # Errors
    /// If a label image cannot hold the map, drawing it takes more memory than there is, the masks name what the map does not
    /// have, or the document cannot be written.
    pub fn files(
        &self,
        document: &mut TopologyDocument,
        contents: &ResultContents<'_>,
    ) -> Result<Files, ResultError> {
        let (grid, analysis) = (self.grid(), self.analysis);
        // There may be many more places than the parts that were counted before.
        let n_places = analysis.topology.places.len() as u64;
        check_n_places(n_places)?;
        let n_bytes = pipeline::memory_bytes(0, 0, self.classes.len(), 0, n_places);
        if !has_memory(n_bytes) {
            return Err(ResultError::DrawingMemory { n_places, n_bytes });
        }
        let (graph, frame) = (&analysis.space.graph, &grid.frame);
        let mut files = Files::new();
        let mut add = |name: &str, bytes: Vec<u8>| files.push((name.to_owned(), bytes));
        if contents.stages {
            add("labels.1-classified.png", label_png(graph, &analysis.classified));
            add("labels.2-smoothed.png", label_png(graph, &analysis.smoothed.most_likely()));
        }
        if contents.probabilities {
            add("probabilities.npy", probability_npy(graph, &analysis.smoothed));
        }
        let (overview, (labels, regions)) = rayon::join(
            || {
                let Analysis { labeling, topology, .. } = analysis;
                overview_png(grid, labeling, self.classes, topology, &self.map.name)
            },
            || {
                rayon::join(
                    || label_png(graph, &analysis.labeling),
                    || region_png(graph, &analysis.regions, &analysis.place_ids),
                )
            },
        );
        add("labels.png", labels);
        add("labels.yaml", labels_yaml("labels.png", frame, self.classes).into_bytes());
        add("regions.png", regions?);
        add("regions.yaml", raster_yaml("regions.png", frame).into_bytes());
        add("overview.png", overview);
        files.extend(exported(document, contents, Some(self))?);
        seal(document, &mut files, Vec::new())?;
        Ok(files)
    }

    /// Gives `export` what a document does not hold.
    pub fn add_cells<'a>(&'a self, export: &mut Export<'a>) {
        export.occupancy = Some(&self.grid().cells);
        export.probability = Some(self.probability());
    }

    /// The probability of the most likely class of every cell after smoothing, 0 where there is none.
    pub fn probability(&self) -> Grid<f32> {
        let (graph, field) = (&self.analysis.space.graph, &self.analysis.smoothed);
        let mut grid = Grid::filled(graph.width(), graph.height(), 0.0);
        for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
            grid[cell] = field.row(node).iter().copied().fold(0.0, f32::max);
        }
        grid
    }
}

/// The files of all formats. A format that cannot hold the map is listed in the document as skipped. Formats that show cells need
/// `labeled`.
///
/// # Errors
/// If the masks name what the map does not have.
pub fn exported(
    document: &mut TopologyDocument,
    contents: &ResultContents<'_>,
    labeled: Option<&LabeledMap<'_>>,
) -> Result<Files, ResultError> {
    let (mut files, mut skipped) = (Files::new(), Vec::new());
    let mut export = Export::new(document, contents.masks)?;
    export.written = contents.written;
    export.georeference = contents.georeference;
    if let Some(labeled) = labeled
        && contents.formats.iter().any(|format| format.needs_cells)
    {
        labeled.add_cells(&mut export);
    }
    for format in contents.formats {
        match format.write(&export, &format.usual_name(&document.map.name)) {
            Ok(written) => files.extend(written),
            Err(error) => {
                skipped.push(SkippedFormat { format: format.name.to_owned(), reason: error.to_string() });
            }
        }
    }
    document.skipped.extend(skipped);
    Ok(files)
}

/// Adds the document to `files`, which it lists behind those that are `kept`.
///
/// # Errors
/// If the document cannot be written.
pub fn seal(
    document: &mut TopologyDocument,
    files: &mut Files,
    kept: Vec<FileRecord>,
) -> Result<(), TopologyError> {
    document.files = kept;
    document.files.extend(files.iter().map(|(name, bytes)| FileRecord::of(name, bytes)));
    document.seal()?;
    files.push((DOCUMENT.to_owned(), document.to_json()?.into_bytes()));
    Ok(())
}
