//! Label files that labeling tools wrote (`tests/python/label_fixtures.py`), against the tools' own rasterizers; and label files
//! that we write, read back.

use std::fs;
use std::path::{Path, PathBuf};

use placegraph::export::LabelSheet;
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{Cell, Grid, MapFrame, OccupancyGrid};
use placegraph::import::{
    LabelCoding, LabelFileError, LabelTarget, load_labels, read_label_file, read_labels,
};
use placegraph::labels::{Label, LabelCell, LabelSet};

const SIZE: (u32, u32) = (48, 36);

/// The hall of the fixtures: pixels from the upper left corner.
const HALL: [[f64; 2]; 5] = [[3.2, 4.1], [30.7, 2.4], [41.3, 17.9], [28.6, 31.2], [4.4, 27.8]];
const ROOM: [[f64; 2]; 4] = [[10.0, 8.0], [25.0, 8.0], [25.0, 20.0], [10.0, 20.0]];
const DOOR: [[f64; 2]; 4] = [[24.3, 11.2], [27.1, 11.9], [26.4, 15.3], [23.8, 14.6]];

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/label_files").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    fs::read(path(name)).unwrap()
}

fn coding() -> LabelCoding {
    LabelCoding::of(&LabelSet::default())
}

fn target<'a>(name: &'a str, coding: &'a LabelCoding) -> LabelTarget<'a> {
    LabelTarget { name, size: SIZE, frame: MapFrame::new(0.5, Pose2::new(-3.0, 2.0, 0.0)).ok(), coding }
}

fn read(bytes: &[u8]) -> Result<Grid<LabelCell>, LabelFileError> {
    read_label_file(bytes, None, &target("office", &coding()))
}

/// What the tool's own rasterizer made of the same shapes.
fn by_tool(name: &str) -> Grid<LabelCell> {
    read_labels(&bytes(name), SIZE, &coding()).unwrap()
}

fn differing(a: &Grid<LabelCell>, b: &Grid<LabelCell>) -> Vec<Cell> {
    a.cells().filter(|&cell| a[cell] != b[cell]).collect()
}

/// Distance of the center of `cell` to the nearest border of `rings`, in cells.
fn to_border(cell: Cell, rings: &[&[[f64; 2]]]) -> f64 {
    let center = Point2::new(cell.x as f64 + 0.5, SIZE.1 as f64 - cell.y as f64 - 0.5);
    let side = |a: [f64; 2], b: [f64; 2]| {
        let (a, b) = (Point2::new(a[0], a[1]), Point2::new(b[0], b[1]));
        let t = ((center - a).dot(b - a) / (b - a).dot(b - a)).clamp(0.0, 1.0);
        center.distance(Point2::new(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)))
    };
    let sides =
        rings.iter().flat_map(|ring| (0..ring.len()).map(|k| side(ring[k], ring[(k + 1) % ring.len()])));
    sides.fold(f64::INFINITY, f64::min)
}

#[test]
fn geopandas_and_gdal_agree_cell_for_cell() {
    let (ours, theirs) = (read(&bytes("regions.geojson")).unwrap(), by_tool("regions.png"));
    for cell in differing(&ours, &theirs) {
        // Only a center exactly on the border may go to either side: a wall of the hall runs through one.
        assert!(to_border(cell, &[&HALL, &ROOM, &DOOR]) < 1e-9, "{cell:?}");
    }
}

#[test]
fn masks_of_coco_agree_cell_for_cell_and_polygons_but_for_their_border() {
    let (ours, theirs) = (read(&bytes("coco.json")).unwrap(), by_tool("coco.png"));
    // Room and doorway are masks; only the hall is a polygon.
    let of = |k: u8| LabelCell::Class(Label(k));
    let is_mask = |cell: &LabelCell| *cell == of(1) || *cell == of(2);
    assert!(ours.cells().all(|cell| !is_mask(&theirs[cell]) || ours[cell] == theirs[cell]));
    assert_eq!(ours.values().iter().filter(|cell| is_mask(cell)).count(), 15 * 12 + 4 * 2);
    let differ = differing(&ours, &theirs);
    assert!(differ.len() < 10, "{}", differ.len());
    for cell in differ {
        assert!(to_border(cell, &[&HALL]) <= 0.1, "{cell:?}");
    }
}

#[test]
fn labelme_moves_shapes_by_half_a_cell_and_adds_their_borders() {
    let (ours, theirs) = (read(&bytes("labelme.json")).unwrap(), by_tool("labelme.png"));
    // labelme takes points for centers of pixels and paints the border too.
    let labeled = |cells: &Grid<LabelCell>| cells.values().iter().filter(|&&c| c != LabelCell::None).count();
    let (n_ours, n_theirs) = (labeled(&ours), labeled(&theirs));
    assert!((n_ours + 10..n_ours + 40).contains(&n_theirs), "{n_ours} {n_theirs}");
    let circle: Vec<[f64; 2]> = (0..64)
        .map(|k| (k as f64 * 0.0982).sin_cos())
        .map(|(s, c)| [40.0 + 3.0 * c, 30.0 + 3.0 * s])
        .collect();
    let differ = differing(&ours, &theirs);
    assert!(!differ.is_empty());
    for cell in differ {
        assert!(to_border(cell, &[&HALL, &ROOM, &DOOR, &circle]) <= 0.9, "{cell:?}");
    }
    // Its masks are pictures: rows 3 to 6 from the top, columns 38 to 43.
    for (column, row) in [(38, 3), (43, 6)] {
        assert_eq!(ours[Cell::new(column, SIZE.1 - 1 - row)], LabelCell::Class(Label(1)));
    }
    assert_eq!(ours[Cell::new(44, SIZE.1 - 1 - 5)], LabelCell::None);
}

#[test]
fn a_segmentation_mask_finds_its_label_map() {
    let coding = coding();
    let target = target("map", &coding);
    let picture = path("segmentation_mask/SegmentationClass/map.png");
    let ours = load_labels(&picture, 1 << 20, &target).unwrap();
    assert_eq!(differing(&ours, &by_tool("segmentation_mask.png")), []);
    assert!(read(&fs::read(picture).unwrap()).is_err(), "without its label map the colors are unknown");
}

#[test]
fn every_kind_of_picture_says_the_same() {
    let read = |name: &str| read_labels(&bytes(name), (6, 4), &coding()).unwrap();
    let expected = read("gray.png");
    let of = |k: u8| LabelCell::Class(Label(k));
    assert_eq!(expected.row(1), [LabelCell::None, of(1), of(1), of(2), LabelCell::None, LabelCell::None]);
    assert_eq!(expected[Cell::new(0, 0)], LabelCell::Ignore);
    let others = [
        "rgb.png",
        "rgba.png",
        "palette_by_color.png",
        "palette_by_place.png",
        "gray16.png",
        "gray16_widened.png",
    ];
    for name in others {
        assert_eq!(read(name), expected, "{name}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    let error = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
    let shape = |rest: &str| {
        format!(
            r#"{{"imageWidth": 48, "imageHeight": 36, "shapes": [{{"label": "room", "points": [[1, 1], [9, 9]] {rest}}}]}}"#
        )
    };
    assert!(read(shape(r#", "shape_type": "rectangle""#).as_bytes()).is_ok());
    let line = error(&shape(r#", "shape_type": "line""#));
    assert!(line.contains("shape 1") && line.contains("polygons"), "{line}");
    let kitchen = error(&shape("").replace("room", "kitchen"));
    assert!(kitchen.contains("\"kitchen\"") && kitchen.contains("corridor, room, doorway"), "{kitchen}");
    let size = error(&shape("").replace("48", "47"));
    assert!(size.contains("48 x 36") && size.contains("47 x 36"), "{size}");
    let degrees = String::from_utf8(bytes("degrees.geojson")).unwrap();
    assert!(error(&degrees).contains("EPSG:3857"), "{}", error(&degrees));
    assert!(error("{}").contains("labelme"));
    assert!(error("{\"shapes\": 3}").contains("line 1"));
    let two = bytes("coco.json");
    let two = String::from_utf8(two)
        .unwrap()
        .replace("\"width\": 5, \"height\": 5", "\"width\": 48, \"height\": 36");
    assert!(read(two.as_bytes()).is_ok(), "one is called like the map");
    assert!(error(&two.replace("office", "cellar")).contains("2 of that size"));
    let box_alone = r#"{"images": [{"id": 1, "width": 48, "height": 36}], "categories": [{"id": 1, "name": "room"}],
        "annotations": [{"id": 4, "image_id": 1, "category_id": 1, "bbox": [0, 0, 3, 3], "segmentation": []}]}"#;
    assert!(error(box_alone).contains("annotation 4"));
    let strays = read_labels(b"P2 3 2 255  9 9 9  8 7 9", (3, 2), &coding()).unwrap_err().to_string();
    assert!(strays.contains("gray 9 in 4 pixels") && strays.contains("gray 7 in 1, gray 8 in 1"), "{strays}");
}

/// A ring of corridor around a room with an unlabeled hole, and cells to ignore.
fn drawing() -> (OccupancyGrid, Grid<LabelCell>) {
    let rows = ["cccccccc##", "crrrrrrc##", "cr....rc#.", "crriirrcdd", "cccccccc#i"];
    let map = OccupancyGrid::from_ascii(0.5, &rows.join("\n").replace(['c', 'r', 'i', 'd'], "."));
    let cell = |mark: char| match mark {
        'i' => LabelCell::Ignore,
        _ => "crd".find(mark).map_or(LabelCell::None, |k| LabelCell::Class(Label(k as u8))),
    };
    let cells = rows.iter().rev().flat_map(|row| row.chars().map(cell)).collect();
    let mut map = map;
    map.frame = MapFrame::new(0.5, Pose2::new(3.0, -7.5, 0.4)).unwrap();
    (map, Grid::from_rows(10, 5, cells))
}

#[test]
fn what_we_write_is_read_back_cell_for_cell() {
    let (map, cells) = drawing();
    let classes = LabelSet::default();
    let sheet = LabelSheet { cells: &cells, map: &map, classes: &classes, image: "map.pgm" };
    let coding = coding();
    let target = LabelTarget::of("map", &map, &coding);
    let files = [
        ("png", sheet.png().unwrap()),
        ("labelme", sheet.labelme().unwrap()),
        ("coco", sheet.coco().unwrap()),
        ("geojson", sheet.geojson().unwrap()),
    ];
    for (format, file) in files {
        let back = read_label_file(&file, None, &target).unwrap();
        let wrong: Vec<Cell> =
            differing(&cells, &back).into_iter().filter(|&cell| map.is_free(cell)).collect();
        assert_eq!(wrong, [], "{format}");
    }
}
