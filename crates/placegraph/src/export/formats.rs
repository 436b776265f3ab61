//! The formats of other programs as one table: names, help, files and writers.

mod dot;
mod graphml;
mod segments;
mod tmap2;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use super::stamp::{stamp, with_stamp};
use super::{
    ExportError, Georeference, MaskFiles, MaskSettings, MaskSheet, RecordingInput, ReportInput, RmfBuilding,
    TopologyDocument, keepout_mask, nav2_filters, nav2_route, recording, regions_geojson, regions_svg,
    report_html, rmf_background, rmf_building, rmf_nav_graph, speed_mask, vector_shapes, zone_mask,
};
use crate::grid::{FrameError, Grid, GridShape, Occupancy};
use crate::topology::TopologicalMap;

pub use dot::dot;
pub use graphml::graphml;
pub use segments::{segments_json, valetudo_json};
pub use tmap2::{TmapInfo, tmap2};

/// A format for results.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// The name that users type.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// The programs that read it.
    pub consumer: &'static str,
    /// Usual name of its main file, in which [`MAP`] stands for the name of the map.
    pub file: &'static str,
    /// Endings of the files that go with the main one, in place of its `.yaml`.
    pub companions: &'static [&'static str],
    /// Whether the format shows the map's cells, which a document does not hold.
    pub needs_cells: bool,
    write: Writer,
}

/// Makes the contents of the files that are called as given, in that order.
type Writer = fn(&Export<'_>, &[String]) -> Result<Vec<Vec<u8>>, ExportError>;

/// Stands for the name of the map in [`Format::file`].
pub const MAP: &str = "{map}";

/// A format with a single file.
const fn one(
    name: &'static str,
    doc: &'static str,
    consumer: &'static str,
    file: &'static str,
    write: Writer,
) -> Format {
    Format { name, doc, consumer, file, companions: &[], needs_cells: false, write }
}

/// A format with a picture next to its file.
const fn with_picture(
    name: &'static str,
    doc: &'static str,
    consumer: &'static str,
    file: &'static str,
    write: Writer,
) -> Format {
    Format { companions: &[".png"], ..one(name, doc, consumer, file, write) }
}

/// A mask: a map file, its image and the parameters of its servers.
const fn mask(name: &'static str, doc: &'static str, file: &'static str, write: Writer) -> Format {
    let companions = &[".png", "_params.yaml"];
    Format { companions, ..one(name, doc, "Nav2 costmap filters", file, write) }
}

/// Every format, in the order of the documentation.
pub const FORMATS: &[Format] = &[
    one("nav2", "Route graph of Navigation 2", "Nav2 route server", "route_graph.geojson", |export, _| {
        Ok(vec![nav2_route(&export.map, export.frame_id())?])
    }),
    mask("nav2-keepout", "Keep-out mask of Navigation 2", "keepout.yaml", |export, names| {
        keepout_mask(&export.map, &export.sheet(names), &export.masks.keepout).map(mask_files)
    }),
    mask("nav2-speed", "Speed mask of Navigation 2", "speed.yaml", |export, names| {
        let limits = export.masks.speed(&export.document.classes);
        speed_mask(&export.map, &export.sheet(names), &limits).map(mask_files)
    }),
    mask("nav2-zones", "Zone mask of Navigation 2", "zones.yaml", |export, names| {
        zone_mask(&export.map, &export.sheet(names), export.masks.zones).map(mask_files)
    }),
    Format {
        companions: &[
            ".launch.py",
            "_keepout.yaml",
            "_keepout.png",
            "_speed.yaml",
            "_speed.png",
            "_zones.yaml",
            "_zones.png",
        ],
        ..one(
            "nav2-filters",
            "All masks of Navigation 2 with one parameter file and a launch file",
            "Nav2 costmap filters",
            "nav2_filters.yaml",
            |export, names| {
                let sheets = [2, 4, 6].map(|first| export.sheet(&names[first..]));
                let limits = export.masks.speed(&export.document.classes);
                let masks = export.masks;
                let files = nav2_filters(&export.map, &sheets, &masks.keepout, &limits, masks.zones)?;
                let rasters = files.masks.into_iter().flat_map(|mask| [mask.map, mask.image]);
                Ok([files.parameters, files.launch].into_iter().chain(rasters).collect())
            },
        )
    },
    one(
        "nav2-shapes",
        "Shapes of Navigation 2's vector-object server",
        "Nav2 vector-object server",
        "shapes.yaml",
        |export, _| {
            let keepout = &export.masks.keepout;
            Ok(vec![vector_shapes(&export.map, &export.shape, export.frame_id(), keepout)?])
        },
    ),
    one("rmf", "Navigation graph of Open-RMF", "Open-RMF fleet adapters", "nav_graph.yaml", |export, _| {
        Ok(vec![rmf_nav_graph(&export.rmf_building(""))?])
    }),
    with_picture(
        "rmf-building",
        "Building file of Open-RMF's traffic editor",
        "Open-RMF traffic editor",
        "{map}.building.yaml",
        |export, names| {
            let building = rmf_building(&export.rmf_building(&names[1]))?;
            Ok(vec![building, rmf_background(&export.map, &export.shape)?])
        },
    ),
    one(
        "tmap2",
        "Topological map of LCAS",
        "LCAS topological navigation",
        "{map}.tmap2.yaml",
        |export, _| Ok(vec![tmap2(&export.map, &export.tmap_info())?]),
    ),
    one("graphml", "GraphML", "NetworkX, Gephi, yEd", "graph.graphml", |export, _| {
        Ok(vec![graphml(&export.map, &export.shape, export.frame_id())?])
    }),
    one("dot", "Graphviz", "Graphviz", "graph.dot", |export, _| {
        Ok(vec![dot(&export.map, &export.document.classes).into_bytes()])
    }),
    one("geojson", "Outlines as GeoJSON", "QGIS, GeoPandas", "regions.geojson", |export, _| {
        Ok(vec![regions_geojson(&export.map, export.frame_id(), export.georeference.as_ref())?])
    }),
    one("svg", "A drawing", "any drawing program", "regions.svg", |export, _| {
        Ok(vec![regions_svg(&export.map, &export.document.classes, &export.shape).into_bytes()])
    }),
    one(
        "segments",
        "Rooms as vacuum segments for Home Assistant",
        "Home Assistant vacuum integrations",
        "segments.json",
        |export, _| Ok(vec![segments_json(&export.map, &export.document.map.name)?]),
    ),
    one("valetudo", "Map with segments for Valetudo", "Valetudo map cards", "valetudo.json", |export, _| {
        Ok(vec![valetudo_json(&export.map, &export.shape)?])
    }),
    Format {
        needs_cells: true,
        ..one(
            "mcap",
            "ROS 2 recording with grids, markers and the document",
            "Foxglove, Lichtblick, Rerun, rosbag2",
            "semantic_map.mcap",
            |export, _| Ok(vec![export.recording()?]),
        )
    },
    Format {
        needs_cells: true,
        ..one("report", "HTML report on one page", "a browser", "report.html", |export, _| {
            Ok(vec![export.report()?.into_bytes()])
        })
    },
];

fn mask_files(files: MaskFiles) -> Vec<Vec<u8>> {
    vec![files.map, files.image, files.parameters]
}

impl Format {
    /// The format called `name`.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.name == name)
    }

    /// The usual name of the main file for the map called `map_name`.
    pub fn usual_name(&self, map_name: &str) -> String {
        self.file.replace(MAP, map_name)
    }

    /// The names of all files if the main one is called `main`.
    ///
    /// # Errors
    /// If a format of several files has a main name that does not end in `.yaml`.
    pub fn file_names(&self, main: &str) -> Result<Vec<String>, ExportError> {
        let mut names = vec![main.to_owned()];
        if !self.companions.is_empty() {
            let path = Path::new(main);
            let is_yaml = path.extension().is_some_and(|extension| extension == "yaml");
            let stem = path.file_stem().filter(|_| is_yaml).map(|stem| stem.to_string_lossy());
            let Some(stem) = stem else {
                return Err(ExportError::MainName { found: main.to_owned() });
            };
            names.extend(self.companions.iter().map(|ending| format!("{stem}{ending}")));
        }
        Ok(names)
    }

    /// The files of the format, by name; the main one, called `main`, first.
    ///
    /// # Errors
    /// If the format cannot hold the map, or `main` is no name for its main file.
    pub fn write(&self, export: &Export<'_>, main: &str) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
        let names = self.file_names(main)?;
        let contents = (self.write)(export, &names)?;
        let stamp = stamp(export.document);
        let usual_ending = self.file.rsplit('.').next().unwrap_or_default();
        let endings = std::iter::once(usual_ending)
            .chain(self.companions.iter().map(|ending| ending.rsplit('.').next().unwrap_or_default()));
        let stamped =
            contents.into_iter().zip(endings).map(|(bytes, ending)| with_stamp(bytes, ending, &stamp));
        Ok(names.into_iter().zip(stamped).collect())
    }
}

/// The table of all formats for `docs/exports.md`.
pub fn formats_markdown() -> String {
    let mut table = "| format | what it is | files | consumer |\n|---|---|---|---|\n".to_owned();
    for Format { name, doc, file, companions, consumer, .. } in FORMATS {
        let file = file.replace(MAP, "MAP");
        let stem = file.trim_end_matches(".yaml");
        let files: Vec<String> = std::iter::once(format!("`{file}`"))
            .chain(companions.iter().map(|ending| format!("`{stem}{ending}`")))
            .collect();
        // Writing to a string cannot fail.
        let _ = writeln!(table, "| `{name}` | {doc} | {} | {consumer} |", files.join(", "));
    }
    table
}

/// A result to be written in some format.
#[derive(Debug)]
pub struct Export<'a> {
    document: &'a TopologyDocument,
    /// As the document has it: exports are the same whether made with it or from it.
    map: TopologicalMap,
    shape: GridShape,
    masks: &'a MaskSettings,
    /// The cells of the map, for formats that show them.
    pub occupancy: Option<&'a Grid<Occupancy>>,
    /// Probability of the most likely class per cell, for formats that show it.
    pub probability: Option<Grid<f32>>,
    /// The position of the map on Earth, for formats that can hold it.
    pub georeference: Option<Georeference>,
    /// The date for files that have one, as time since 1970: the same map gives the same bytes whenever it is
    /// exported.
    pub written: Duration,
}

impl<'a> Export<'a> {
    /// The content of `document`, without the cells of the map, dated 1970.
    ///
    /// # Errors
    /// If `masks` name a class that the document does not have, or the document's frame is invalid, which never
    /// happens for a document that was read.
    pub fn new(document: &'a TopologyDocument, masks: &'a MaskSettings) -> Result<Self, ExportError> {
        masks.check(&document.classes)?;
        let shape = document.map.shape().map_err(|error: FrameError| ExportError::writer("a map", &error))?;
        let map = document.topology();
        Ok(Self {
            document,
            map,
            shape,
            masks,
            occupancy: None,
            probability: None,
            georeference: None,
            written: Duration::ZERO,
        })
    }

    fn frame_id(&self) -> &str {
        &self.document.map.frame_id
    }

    fn sheet(&self, names: &[String]) -> MaskSheet {
        MaskSheet {
            shape: self.shape,
            rotated: self.masks.rotated,
            image_name: names[1].clone(),
            map_name: names[0].clone(),
            frame_id: self.frame_id().to_owned(),
        }
    }

    /// `background` is the name of the picture under the building.
    fn rmf_building(&self, background: &str) -> RmfBuilding<'_> {
        RmfBuilding::of_level(&self.document.map.name, "L1", &self.map, self.shape, background)
    }

    fn tmap_info(&self) -> TmapInfo {
        let name = self.document.map.name.clone();
        TmapInfo {
            metric_map: name.clone(),
            name,
            frame_id: self.frame_id().to_owned(),
            last_updated: timestamp(self.written),
        }
    }

    /// What made the result, and from what.
    fn provenance(&self) -> String {
        let TopologyDocument { program, map, model, .. } = self.document;
        let model = model.as_ref().map(|model| format!("model {} {}", model.name, model.hash));
        let mut parts = vec![format!("{} {}", program.name, program.version)];
        parts.extend(model);
        parts.push(format!("map {} {}", map.name, map.hash));
        parts.join(" · ")
    }

    fn recording(&self) -> Result<Vec<u8>, ExportError> {
        // Without the times of the stages: the same map gives the same bytes.
        let document = TopologyDocument { timings_ms: BTreeMap::new(), ..self.document.clone() };
        let document = document.to_json().map_err(|error| ExportError::writer("MCAP", &error))?;
        recording(&RecordingInput {
            map: &self.map,
            labels: &self.document.classes,
            shape: &self.shape,
            frame_id: self.frame_id(),
            occupancy: self.occupancy,
            document,
            written: self.written,
            library: &stamp(self.document),
        })
    }

    fn report(&self) -> Result<String, ExportError> {
        let graph = self.document.graph.as_ref().map(ToString::to_string);
        let findings: Vec<String> = self.document.findings.iter().cloned().chain(graph).collect();
        report_html(&ReportInput {
            title: &self.document.map.name,
            frame_id: self.frame_id(),
            map: &self.map,
            labels: &self.document.classes,
            shape: &self.shape,
            occupancy: self.occupancy,
            probability: self.probability.as_ref(),
            findings: &findings,
            provenance: &self.provenance(),
        })
    }
}

/// The time `since_1970` in UTC as `MM-DD-YYYY_HH-MM-SS`.
fn timestamp(since_1970: Duration) -> String {
    let seconds = since_1970.as_secs();
    let (mut days, of_day) = (seconds / 86_400, seconds % 86_400);
    let is_leap =
        |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{month:02}-{:02}-{year}_{hour:02}-{minute:02}-{second:02}", days + 1)
}

#[cfg(test)]
mod tests;
