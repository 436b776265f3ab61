//! The files of a result, as the program writes them for the same map, edits and formats.

use placegraph::export::{
    Export, FileRecord, Format, MapInfo, MaskSettings, ModelInfo, SkippedFormat, TopologyDocument, label_png,
    overview_png, raster_yaml, region_png,
};
use placegraph::grid::{Grid, OccupancyGrid};
use placegraph::import::{LoadedMap, Severity, check};
use placegraph::model::{Model, sha256_hex};
use placegraph::pipeline::Analysis;
use placegraph::topology::reach::{self, GraphCheck, Robot};

use crate::session::in_words;

/// What a result is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ResultOf<'a> {
    pub(crate) map: &'a LoadedMap,
    pub(crate) resolution_m: Option<f64>,
    pub(crate) model: &'a Model,
    pub(crate) analysis: &'a Analysis,
    /// The text of the edit file; empty without one.
    pub(crate) edits_toml: &'a str,
}

/// Files by name.
pub(crate) type Files = Vec<(String, Vec<u8>)>;

impl ResultOf<'_> {
    /// The document, before it lists files.
    pub(crate) fn document(&self, formats: &[&Format]) -> TopologyDocument {
        let Self { map, model, analysis, .. } = self;
        let info = MapInfo::of(&map.grid, &map.name, &map.hash);
        let model_info = ModelInfo { name: "default".to_owned(), hash: model.hash() };
        let mut document =
            TopologyDocument::new(info, Some(model_info), &model.label_set, &analysis.topology);
        let options = &mut document.program.options;
        options.extend(self.resolution_m.map(|resolution| format!("--resolution {resolution}")));
        options.extend(formats.iter().map(|format| format!("--export {}", format.name)));
        if !self.edits_toml.is_empty() {
            options.push(format!("--edits sha256:{}", sha256_hex(self.edits_toml.as_bytes())));
        }
        let unapplied = self.unapplied_edits();
        let findings = check(map).findings;
        let errors = findings.iter().filter(|finding| finding.severity() == Severity::Error);
        document.errors = errors.map(ToString::to_string).chain(unapplied.iter().cloned()).collect();
        document.findings = findings.iter().map(ToString::to_string).chain(unapplied).collect();
        let robot = Robot::default();
        document.graph = Some(GraphCheck::of(&analysis.topology, robot.radius_m));
        document.findings.extend(reach::remarks(&analysis.topology, &robot));
        document
    }

    /// The map, with the walls and openings that edits drew.
    pub(crate) fn grid(&self) -> &OccupancyGrid {
        self.analysis.drawn.as_ref().unwrap_or(&self.map.grid)
    }

    fn unapplied_edits(&self) -> Vec<String> {
        let outcomes = self.analysis.edit_outcomes.iter().enumerate();
        let unapplied = outcomes.filter_map(|(index, outcome)| Some((index + 1, outcome.as_ref().err()?)));
        unapplied.map(|(n, reason)| format!("edit {n} of edits.toml does not apply: {reason}")).collect()
    }

    /// All files, and the document that lists them.
    pub(crate) fn files(&self, formats: &[&Format]) -> Result<(TopologyDocument, Files), String> {
        let Self { map, model, analysis, .. } = self;
        let grid = self.grid();
        let (graph, frame) = (&analysis.space.graph, &grid.frame);
        let mut files: Files = vec![
            ("labels.png".to_owned(), label_png(graph, &analysis.labeling)),
            ("labels.yaml".to_owned(), raster_yaml("labels.png", frame).into_bytes()),
            (
                "regions.png".to_owned(),
                region_png(graph, &analysis.regions, &analysis.place_ids).map_err(in_words)?,
            ),
            ("regions.yaml".to_owned(), raster_yaml("regions.png", frame).into_bytes()),
            (
                "overview.png".to_owned(),
                overview_png(grid, &analysis.labeling, &model.label_set, &analysis.topology, &map.name),
            ),
        ];
        let mut document = self.document(formats);
        let masks = MaskSettings::default();
        let mut export = Export::new(&document, &masks).map_err(in_words)?;
        export.occupancy = Some(&grid.cells);
        export.probability = Some(probabilities(analysis));
        let mut skipped = Vec::new();
        for format in formats {
            match format.write(&export, &format.usual_name(&document.map.name)) {
                Ok(exported) => files.extend(exported),
                Err(error) => {
                    skipped.push(SkippedFormat { format: format.name.to_owned(), reason: error.to_string() });
                }
            }
        }
        document.skipped = skipped;
        document.files = files.iter().map(|(name, bytes)| FileRecord::of(name, bytes)).collect();
        document.seal().map_err(in_words)?;
        files.push(("topology.json".to_owned(), document.to_json().map_err(in_words)?.into_bytes()));
        Ok((document, files))
    }
}

/// The probability of the most likely class of every cell, 0 where there is none.
pub(crate) fn probabilities(analysis: &Analysis) -> Grid<f32> {
    let graph = &analysis.space.graph;
    let mut grid = Grid::filled(graph.width(), graph.height(), 0.0);
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        grid[cell] = analysis.smoothed.row(node).iter().copied().fold(0.0, f32::max);
    }
    grid
}
