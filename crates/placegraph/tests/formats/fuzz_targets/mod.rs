//! What every fuzz target does with its bytes: used by `crates/placegraph-fuzz`, and by `fuzz_corpus.rs` to
//! replay the committed corpus on the stable toolchain.
#![allow(clippy::expect_used, reason = "a broken promise shall crash")]

use std::sync::LazyLock;

use placegraph::doorways::{GateModel, figure_table};
use placegraph::export::{
    Export, FORMATS, MapInfo, MaskSettings, MaskSheet, Rotated, TopologyDocument, ZonePer, keepout_mask,
    speed_mask, vector_shapes, zone_mask,
};
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{FreeSpace, GridShape, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::recording::{self, Container, Recording};
use placegraph::import::{
    Format, LabelCoding, LabelTarget, LabelsYaml, MapError, ReadOptions, TrainingFile, carmen, image,
    read_image, read_label_file, read_labels, read_rooms, ros, valetudo,
};
use placegraph::labels::{Label, LabelField, LabelSet, Labeling};
use placegraph::model::{Method, Model};
use placegraph::pipeline;
use placegraph::progress::Silent;
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::site::{SiteDocument, SiteFile};
use placegraph::spaces::{self, SpaceModel};
use placegraph::syntax::from_toml;
use placegraph::topology::PlaceId;
use placegraph::topology::edits::{EditFile, Numbering, apply, apply_to_map};
use placegraph::topology::query::{PlaceIndex, find_route};
use placegraph::topology::{PlaceRaster, TopologicalMap};

/// What a target does with bytes.
pub type Target = fn(&[u8]);

/// Every target: its name, which is that of its corpus, and what it does with bytes.
pub const TARGETS: &[(&str, Target)] = &[
    ("map_yaml", map_yaml),
    ("map_image", map_image),
    ("carmen", carmen),
    ("valetudo", valetudo),
    ("recording", recording),
    #[cfg(feature = "ros1")]
    ("bag", bag),
    #[cfg(feature = "sqlite")]
    ("database", database),
    ("label_image", label_image),
    ("label_file", label_file),
    ("label_map", label_map),
    ("labels_yaml", labels_yaml),
    ("model", model),
    ("topology", topology),
    ("training_file", training_file),
    ("edits", edits),
    ("masks", masks),
    ("gates", gates),
    ("site", site),
];

/// Small enough for fuzzing, large enough for every branch.
const MAX_CELLS: u64 = 1 << 16;

/// map_server YAML files.
pub fn map_yaml(bytes: &[u8]) {
    if let Ok(map) = ros::parse_yaml(bytes) {
        assert!(map.frame.resolution_m() > 0.0);
        for gray in 0..=255 {
            let value = ros::cell_value(f64::from(gray), 255, &map.interpretation);
            assert!((-1..=100).contains(&value), "{value}");
        }
    }
}

/// Map images: decoded, and made an occupancy grid.
pub fn map_image(bytes: &[u8]) {
    let options = ReadOptions { max_cells: MAX_CELLS, ..ReadOptions::default() };
    if let Ok(raster) = image::decode(bytes, MAX_CELLS) {
        let size = (raster.width, raster.height);
        let (cells, _) = read_image(raster, Format::Image, ros::Interpretation::default(), &options);
        assert_eq!((cells.width(), cells.height()), size);
    }
}

/// CARMEN maps, plain and gzipped.
pub fn carmen(bytes: &[u8]) {
    if let Ok(map) = carmen::parse(bytes, MAX_CELLS) {
        assert!(map.probabilities.values().iter().all(|p| (-1.001..=1.001).contains(p)));
    }
}

/// Maps of robot vacuums.
pub fn valetudo(bytes: &[u8]) {
    if let Ok(map) = valetudo::parse(bytes, MAX_CELLS) {
        let size = (map.cells.width(), map.cells.height());
        assert!((map.segments.width(), map.segments.height()) == size && map.frame.resolution_m() > 0.0);
        let states = map.cells.values().iter().zip(map.segments.values());
        assert!(states.into_iter().all(|(&state, &segment)| segment == 0 || state == Occupancy::Free));
        assert_eq!(read_rooms(bytes, size).ok(), Some(map.segments));
    }
}

/// Recordings of ROS 2.
pub fn recording(bytes: &[u8]) {
    recorded(Container::Mcap, bytes);
}

/// Bags of ROS 1.
#[cfg(feature = "ros1")]
pub fn bag(bytes: &[u8]) {
    recorded(Container::Ros1, bytes);
}

/// Bags of ROS 2 before Iron.
#[cfg(feature = "sqlite")]
pub fn database(bytes: &[u8]) {
    recorded(Container::Sqlite, bytes);
}

fn recorded(container: Container, bytes: &[u8]) {
    let options = ReadOptions { max_cells: MAX_CELLS, ..ReadOptions::default() };
    let Ok(recording) = Recording::from_bytes(container, bytes) else { return };
    // What is wrong with a recording after its first maps does not undo them.
    let _ = recording::grids(recording, &options, &mut |grid| {
        if let Ok((map, _)) = recording::map_of(&grid, &options) {
            assert!(map.frame.resolution_m() > 0.0 && map.cells.width() > 0);
        }
        Ok::<(), MapError>(())
    });
    let _ =
        Recording::from_bytes(container, bytes).map(|recording| recording::last_grid(recording, &options));
}

/// Label and room images; the first two bytes are the size of the map, less 1.
pub fn label_image(bytes: &[u8]) {
    if let [width, height, image @ ..] = bytes {
        let size = (u32::from(*width) + 1, u32::from(*height) + 1);
        if let Ok(cells) = read_labels(image, size, &LabelCoding::of(&LabelSet::default())) {
            assert_eq!((cells.width(), cells.height()), size);
        }
        if let Ok(cells) = read_rooms(image, size) {
            assert_eq!((cells.width(), cells.height()), size);
        }
    }
}

/// Labels of labeling tools: labelme, COCO, GeoJSON, `topology.json`; for a map of 48 by 36 cells.
pub fn label_file(bytes: &[u8]) {
    let frame = MapFrame::new(0.5, Pose2::new(-3.0, 2.0, 0.3)).expect("a frame");
    let coding = LabelCoding::of(&LabelSet::default());
    let target = LabelTarget { name: "office", size: (48, 36), frame: Some(frame), coding: &coding };
    if let Ok(cells) = read_label_file(bytes, None, &target) {
        assert_eq!((cells.width(), cells.height()), (48, 36));
    }
}

/// Label maps, for an image of one pixel.
pub fn label_map(bytes: &[u8]) {
    let coding = LabelCoding::of(&LabelSet::default());
    let target = LabelTarget { name: "", size: (1, 1), frame: None, coding: &coding };
    let _ = read_label_file(b"P3 1 1 255 51 221 255", Some(bytes), &target);
}

/// The classes of label images.
pub fn labels_yaml(bytes: &[u8]) {
    if let Ok(yaml) = LabelsYaml::parse(bytes) {
        assert!(yaml.label_set().is_none_or(|set| (LabelSet::MIN..=LabelSet::MAX).contains(&set.len())));
    }
}

/// Two rooms and what joins them.
fn small_map() -> OccupancyGrid {
    OccupancyGrid::from_ascii(0.2, "###########\n#....#....#\n#.........#\n#....#....#\n###########")
}

fn assert_distributions(field: &LabelField) {
    for node in 0..field.n_nodes() {
        let row = field.row(node);
        let sum: f32 = row.iter().sum();
        assert!(row.iter().all(|p| (0.0..=1.0 + 1e-5).contains(p)) && (sum - 1.0).abs() < 1e-3, "{row:?}");
    }
}

/// Model files: read and written again, and what is a model labels a small map.
pub fn model(bytes: &[u8]) {
    let Ok(mut model) = Model::from_json(bytes) else { return };
    assert_eq!(Model::from_json(&model.to_json()).ok().as_ref(), Some(&model));
    if let Method::Boosted(boosted) = &mut model.method {
        boosted.relaxation.iterations = boosted.relaxation.iterations.min(50);
    }
    let found = pipeline::analyze(&small_map(), &model, &pipeline::Config::default(), &Silent);
    assert_distributions(&pipeline::classify(&small_map(), &found.space, &model, &Silent).field);
    assert_distributions(&found.smoothed);
}

/// `topology.json`: read and written again, asked, and exported in every format.
pub fn topology(bytes: &[u8]) {
    let Ok(document) = TopologyDocument::from_json(bytes) else { return };
    let text = document.to_json().expect("what was read can be written");
    assert_eq!(TopologyDocument::from_json(text.as_bytes()).ok().as_ref(), Some(&document));
    let map = document.topology();
    let shape = document.map.shape().expect("what was read has a frame");
    let index = PlaceIndex::new(&map, shape);
    let raster = PlaceRaster::new(&map, shape);
    for place in &map.places {
        assert!(index.locate(place.anchor).is_some() || place.outline.is_empty());
        let _ = index.locate(Point2::new(1e300, -1e300));
        if let Some(way) = find_route(&map, map.places[0].id, place.id) {
            let _ = way.pulled_straight(&raster);
        }
    }
    let n_cells = u64::from(shape.width) * u64::from(shape.height);
    if n_cells <= MAX_CELLS {
        exports(&document);
    }
}

/// All formats; one that refuses does not keep the others from being tried.
fn exports(document: &TopologyDocument) {
    let masks = MaskSettings { rotated: Rotated::Resample, zones: ZonePer::Place, ..MaskSettings::default() };
    let export = Export::new(document, &masks).expect("what was read has a frame, and no mask is asked for");
    for format in FORMATS {
        let files = format.write(&export, &format.usual_name("b")).unwrap_or_default();
        assert!(files.iter().all(|(_, bytes)| !bytes.is_empty()), "{}", format.name);
    }
}

/// Training files.
pub fn training_file(bytes: &[u8]) {
    if let Some(file) = std::str::from_utf8(bytes).ok().and_then(|text| TrainingFile::from_toml(text).ok()) {
        assert!(!file.maps.is_empty());
        assert!((LabelSet::MIN..=LabelSet::MAX).contains(&file.classes.len()));
    }
}

/// Mask files, and the masks of a small map by them.
pub fn masks(bytes: &[u8]) {
    static MAP: LazyLock<TopologicalMap> = LazyLock::new(|| {
        pipeline::analyze(&small_map(), &Model::builtin(), &pipeline::Config::chapter(), &Silent).topology
    });
    let text = std::str::from_utf8(bytes).ok();
    let Some(settings) = text.and_then(|text| from_toml::<MaskSettings>(text).ok()) else { return };
    let (classes, grid) = (LabelSet::default(), small_map());
    let _ = settings.check(&classes);
    let sheet = MaskSheet {
        shape: GridShape::of(&grid),
        rotated: settings.rotated,
        image_name: "mask.png".into(),
        map_name: "mask.yaml".into(),
        frame_id: "map".into(),
    };
    let _ = (keepout_mask(&MAP, &sheet, &settings.keepout), zone_mask(&MAP, &sheet, settings.zones));
    let _ = speed_mask(&MAP, &sheet, &settings.speed(&classes));
    let _ = vector_shapes(&MAP, &sheet.shape, "map", &settings.keepout);
}

/// Models of gates and of spaces: read and written again, and all that they say is a probability.
pub fn gates(bytes: &[u8]) {
    if let Ok(model) = SpaceModel::from_json(bytes) {
        assert_eq!(SpaceModel::from_json(&model.to_json()).ok().as_ref(), Some(&model));
        let figures = vec![1.0; spaces::figure_table().len()];
        for calibrated in [&model.first, &model.second] {
            assert!((0.0..=1.0).contains(&calibrated.probability(&figures)));
        }
    }
    let Ok(model) = GateModel::from_json(bytes) else { return };
    assert_eq!(GateModel::from_json(&model.to_json()).ok().as_ref(), Some(&model));
    for value in [0.0, 1.0, -1e30] {
        let figures = vec![value; figure_table().len()];
        for calibrated in [&model.doorway, &model.parting] {
            assert!((0.0..=1.0).contains(&calibrated.probability(&figures)));
        }
    }
}

/// Site files, and documents of sites: read and written again, asked for a route, and exported.
pub fn site(bytes: &[u8]) {
    if let Some(file) = std::str::from_utf8(bytes).ok().and_then(|text| SiteFile::from_toml(text).ok()) {
        assert!(!file.floors.is_empty() && file.floors.iter().all(|floor| floor.elevation_m.is_some()));
    }
    let Ok(mut site) = SiteDocument::from_json(bytes) else { return };
    let text = site.to_json().expect("what was read can be written");
    assert_eq!(SiteDocument::from_json(text.as_bytes()).ok().as_ref(), Some(&site));
    let n_cells = |map: &MapInfo| u64::from(map.width) * u64::from(map.height);
    if site.levels.iter().any(|level| n_cells(&level.map) > MAX_CELLS) {
        return;
    }
    let place = |level: usize| Some((level, site.levels.get(level)?.places.first()?.id));
    if let Some((from, to)) = place(0).zip(place(site.levels.len().saturating_sub(1))) {
        let _ = site.route(from, to, true);
    }
    assert!(site.files().is_ok_and(|files| !files.is_empty()));
}

/// Edit files, applied to a small map.
pub fn edits(bytes: &[u8]) {
    let Some(file) = std::str::from_utf8(bytes).ok().and_then(|text| EditFile::from_toml(text).ok()) else {
        return;
    };
    let map = small_map();
    let map = apply_to_map(&map, &file.edits).map_or(map, |drawn| drawn.map);
    let space = FreeSpace::of(&map);
    let graph = &space.graph;
    let label = |x: u32| Label([1, 2, 0][(x > 4) as usize + (x > 5) as usize]);
    let labels: Labeling = graph.cells().iter().map(|cell| label(cell.x)).collect();
    let regions = connected(graph, &labels, DiagonalSteps::default());
    let numbers = (1..=regions.regions.len() as u32).map(|id| Some(PlaceId(id))).collect();
    let numbering = Numbering { numbers, ..Numbering::default() };
    let edited = apply(&space, &LabelSet::default(), regions, numbering, &file.edits);
    assert_eq!(edited.outcomes.len(), file.edits.len());
    let mut numbers: Vec<PlaceId> = edited.numbers.iter().copied().flatten().collect();
    numbers.sort_unstable();
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]), "every number once");
    let n_cells: u32 = edited.regions.regions.iter().map(|region| region.n_cells).sum();
    assert!(n_cells as usize == graph.n_nodes() && edited.regions.regions.iter().all(|r| r.n_cells > 0));
}
