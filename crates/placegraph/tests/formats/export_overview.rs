//! The picture of a result: what it shows, hostile names, odd maps, real maps.

use image::RgbImage;
use placegraph::export::{MapInfo, TopologyDocument, View, overlay_svg, overview_png};
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{CellGraph, FreeSpace, Grid, MapFrame, Occupancy, OccupancyGrid};
use placegraph::labels::{Class, Label, LabelField, LabelSet, Role};
use placegraph::regions::{DiagonalSteps, Thresholds, connected, correct};
use placegraph::topology::{TopologicalMap, build};

/// The topological map of a labeling without corrections.
fn topology(grid: &OccupancyGrid, labels: &[Label], set: &LabelSet) -> TopologicalMap {
    let space = FreeSpace::of(grid);
    let regions = connected(&space.graph, labels, DiagonalSteps::ThroughFree);
    let n_values = labels.len() * set.len();
    let field = LabelField::from_rows(set.len(), vec![1.0 / set.len() as f32; n_values]);
    build(&space, &field, &regions, set)
}

/// A corridor and a room with a doorway between them, 2 m by 1 m, turned.
fn two_places() -> (OccupancyGrid, Vec<Label>) {
    let mut grid = OccupancyGrid::from_ascii(
        0.25,
        "
        ????????????
        ?##########?
        ?#....#...#?
        ?#........#?
        ?#....#...#?
        ?##########?
        ????????????
        ",
    );
    grid.frame = MapFrame::new(0.25, Pose2::new(5.0, 1.0, 1.0)).unwrap();
    let graph = CellGraph::new(&grid.cells);
    let label = |x| match x {
        0..6 => Label(0),
        6 => Label(2),
        _ => Label(1),
    };
    let labels = graph.cells().iter().map(|cell| label(cell.x)).collect();
    (grid, labels)
}

fn decoded(png: &[u8]) -> RgbImage {
    image::load_from_memory(png).expect("a PNG").to_rgb8()
}

fn count(image: &RgbImage, color: [u8; 3]) -> usize {
    image.pixels().filter(|pixel| pixel.0 == color).count()
}

#[test]
fn the_picture_shows_classes_walls_and_signs() {
    let (grid, labels) = two_places();
    let set = LabelSet::default();
    let map = topology(&grid, &labels, &set);
    let image = decoded(&overview_png(&grid, &labels, &set, &map, "two places"));
    assert!(image.width() > image.height() && (600..1500).contains(&image.width()));
    let cell_px = 800usize.div_ceil(12).pow(2);
    // Most of the 12 corridor cells and 9 room cells are in the light color of their class.
    let pastel = |k: usize| set.classes()[k].color.map(|c| (c as f64 * 0.58 + 255.0 * 0.42).round() as u8);
    assert!((9 * cell_px..12 * cell_px).contains(&count(&image, pastel(0))), "{}", count(&image, pastel(0)));
    assert!((6 * cell_px..9 * cell_px).contains(&count(&image, pastel(1))), "{}", count(&image, pastel(1)));
    // The walls: 10 + 2 + 3 + 3 + 2 + 10 of 12 × 7 cells, less what lines cover.
    assert!(count(&image, [52, 58, 70]) > 20 * cell_px);
    // Text and graph.
    assert!(count(&image, [35, 41, 54]) > 200);
    let without = decoded(&overview_png(&grid, &labels, &set, &TopologicalMap::default(), "two places"));
    assert_ne!(image, without);
}

/// A view of the map from this column on, 10 pixels a cell.
fn view(frame: MapFrame, left_cells: f64) -> View {
    View { frame, left_cells, top_cells: 7.0, px_per_cell: 10.0, offset_px: [5.0, 6.0], text_px: 12.0 }
}

#[test]
fn names_with_markup_and_control_characters_are_text() {
    let (grid, labels) = two_places();
    let class = |name: &str, role| Class { name: name.into(), role, color: [90, 120, 200] };
    let set = LabelSet::new(vec![
        class("<corridor> & \"co\"", Role::Passage),
        class("room", Role::Place),
        class("门", Role::Doorway),
    ])
    .unwrap();
    let mut map = topology(&grid, &labels, &set);
    map.places[0].name = "</text><script>".into();
    map.places[1].name = "room\u{1}\u{0}\u{ffff}".into();
    let view = view(grid.frame, 0.0);
    let svg = overlay_svg(&map, &set, &view);
    assert!(svg.contains("&lt;/text&gt;&lt;script&gt;") && !svg.contains("<script>"));
    decoded(&overview_png(&grid, &labels, &set, &map, "]]> & \u{8} <b>"));
}

#[test]
fn a_view_undoes_the_frame() {
    let (grid, _) = two_places();
    let view = view(grid.frame, 1.0);
    let pixel = view.pixel(grid.frame.map_from_cells(Point2::new(3.0, 5.0)));
    assert!(pixel.distance(Point2::new(25.0, 26.0)) < 1e-9);
}

#[test]
fn odd_maps_have_pictures() {
    let set = LabelSet::default();
    for (width, height, value) in [
        (1, 1, Occupancy::Free),
        (1, 1, Occupancy::Unknown),
        (3, 900, Occupancy::Occupied),
        (5000, 2, Occupancy::Free),
    ] {
        let frame = MapFrame::new(0.05, Pose2::default()).unwrap();
        let grid = OccupancyGrid { frame, cells: Grid::filled(width, height, value) };
        let labels = vec![Label(1); grid.count(Occupancy::Free)];
        let image = decoded(&overview_png(&grid, &labels, &set, &topology(&grid, &labels, &set), ""));
        assert!(image.width().max(image.height()) < 4500);
    }
}

/// Map and labels of the data set, with rooms where nothing was drawn.
fn real_map(folder: &std::path::Path) -> (OccupancyGrid, Vec<Label>) {
    let read = |name| image::open(folder.join(name)).expect("a picture").to_luma8();
    let (map, drawn) = (read("map.png"), read("labels.png"));
    let (width, height) = map.dimensions();
    let mut cells = Grid::filled(width, height, Occupancy::Unknown);
    for cell in cells.cells() {
        cells[cell] = match map.get_pixel(cell.x, height - 1 - cell.y)[0] {
            0 => Occupancy::Occupied,
            254 => Occupancy::Free,
            _ => Occupancy::Unknown,
        };
    }
    let grid = OccupancyGrid { frame: MapFrame::new(0.05, Pose2::default()).unwrap(), cells };
    let label = |value| if (1..=3).contains(&value) { Label(value - 1) } else { Label(1) };
    let labels = CellGraph::new(&grid.cells)
        .cells()
        .iter()
        .map(|cell| label(drawn.get_pixel(cell.x, height - 1 - cell.y)[0]))
        .collect();
    (grid, labels)
}

#[test]
fn real_maps_give_documents_and_pictures() {
    let Ok(data) = std::env::var("PLACEGRAPH_DATA") else {
        println!("skipped: PLACEGRAPH_DATA is not set");
        return;
    };
    let set = LabelSet::default();
    for name in ["fr79_slam", "fr52_slam", "lab_d_scan"] {
        let (grid, labels) = real_map(&std::path::Path::new(&data).join("eval").join(name));
        let space = FreeSpace::of(&grid);
        let regions = connected(&space.graph, &labels, DiagonalSteps::ThroughFree);
        let regions = correct(&space, &regions, &set, &Thresholds::default()).regions;
        let labels = regions.labeling();
        let map = topology(&grid, &labels, &set);
        let doorways: Vec<_> = map.places.iter().filter_map(|place| place.doorway.as_ref()).collect();
        assert!(doorways.len() >= 10, "{name}: {} doorways", doorways.len());
        assert!(doorways.iter().all(|doorway| doorway.sides.len() >= 2));
        // Half-open leaves and furniture narrow some of them.
        let usual = doorways.iter().filter(|d| (0.6..=1.3).contains(&d.width_m)).count();
        assert!(10 * usual >= 7 * doorways.len(), "{name}: {usual} of {}", doorways.len());

        let document = TopologyDocument::new(MapInfo::of(&grid, name, ""), None, &set, &map);
        let text = document.to_json().unwrap();
        assert_eq!(TopologyDocument::from_json(text.as_bytes()).unwrap().to_json().unwrap(), text);
        let image = decoded(&overview_png(&grid, &labels, &set, &map, name));
        assert!(image.width() > 1000 && image.height() < 4500);
    }
}
