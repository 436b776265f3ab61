//! The rules of Sect. 4.7 on drawn maps: letters are labels, `#` is a wall.

use placegraph::geom::Pose2;
use placegraph::grid::{CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Label, LabelSet};
use placegraph::regions::{Corrected, DiagonalSteps, Relabeled, Thresholds, connected, correct};

const LETTERS: [char; 3] = ['c', 'r', 'd'];

/// Corrects a drawing with cells of `resolution_m` and draws the result.
fn corrected(resolution_m: f64, drawing: &str) -> (Vec<String>, Corrected) {
    let lines: Vec<&str> = drawing.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let (width, height) = (lines[0].len() as u32, lines.len() as u32);
    let letters = Grid::from_rows(width, height, lines.iter().rev().flat_map(|l| l.chars()).collect());
    let graph = CellGraph::new(&letters.map(|&letter| match letter {
        '#' => Occupancy::Occupied,
        _ => Occupancy::Free,
    }));
    let label_of = |letter| Label(LETTERS.iter().position(|&l| l == letter).expect("c, r or d") as u8);
    let labels: Vec<Label> = graph.cells().iter().map(|&cell| label_of(letters[cell])).collect();
    let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
    let set = LabelSet::default();
    let space = FreeSpace { frame: MapFrame::new(resolution_m, Pose2::default()).unwrap(), graph };
    let result = correct(&space, &regions, &set, &Thresholds::default());
    let mut drawn = letters;
    for (&cell, label) in space.graph.cells().iter().zip(result.regions.labeling()) {
        drawn[cell] = LETTERS[label.index()];
    }
    let rows = (0..height).rev().map(|y| drawn.row(y).iter().collect()).collect();
    (rows, result)
}

#[test]
fn a_small_room_takes_the_label_of_the_longest_contact() {
    // Cells of 0.5 m: rooms and corridors need 4 cells. The two r touch c five times and d twice.
    let (rows, result) = corrected(
        0.5,
        "
        cccccc
        crrdcc
        cccdcc
        cccdrr
        cccdrr
        ",
    );
    assert_eq!(rows, ["cccccc", "cccdcc", "cccdcc", "cccdrr", "cccdrr"]);
    assert_eq!(result.places, Relabeled { n_regions: 1, n_cells: 2 });
    assert_eq!(result.doorways, Relabeled::default());
}

#[test]
fn a_doorway_inside_one_room_is_none() {
    let (rows, result) = corrected(
        0.5,
        "
        rrrrr
        rddrr
        rrrrr
        ",
    );
    assert_eq!(rows, ["rrrrr"; 3]);
    assert_eq!(result.doorways, Relabeled { n_regions: 1, n_cells: 2 });
    assert_eq!(result.regions.regions.len(), 1);
}

#[test]
fn a_doorway_that_touches_one_room_twice_has_one_neighbor() {
    let (rows, _) = corrected(
        0.5,
        "
        rrrrrr
        r####r
        rrddrr
        ",
    );
    assert_eq!(rows, ["rrrrrr", "r####r", "rrrrrr"]);
}

#[test]
fn a_doorway_below_a_tenth_of_a_square_meter_is_none() {
    // One cell of 0.3 m is 0.09 m²; two are a doorway.
    let small = "
        rrrr#cccc
        rrrrdcccc
        rrrr#cccc
        rrrr#cccc
        ";
    let (rows, result) = corrected(0.3, small);
    // Equal contact, equal area: the lower id, which is the room's.
    assert_eq!(rows[1], "rrrrrcccc");
    assert_eq!(result.doorways.n_cells, 1);
    let (rows, _) = corrected(0.4, small);
    assert_eq!(rows[1], "rrrrdcccc");
}

#[test]
fn what_touches_nothing() {
    // A small room stays, a doorway becomes a room.
    let (rows, result) = corrected(0.5, "r#dd#\n");
    assert_eq!(rows, ["r#rr#"]);
    assert_eq!((result.places.n_regions, result.doorways.n_regions), (0, 1));
}

#[test]
fn mending_one_region_can_break_a_doorway() {
    // The small corridor goes to the room, then the doorway joins nothing.
    let (rows, result) = corrected(
        0.5,
        "
        rrr##
        rrrdc
        rrrrc
        ",
    );
    assert_eq!(rows, ["rrr##", "rrrrr", "rrrrr"]);
    assert_eq!((result.places.n_regions, result.doorways.n_regions), (1, 1));
}

#[test]
fn thresholds_read_defaults_and_refuse_unknown_keys() {
    let read = |text: &str| toml::from_str::<Thresholds>(text);
    assert_eq!(read("").unwrap(), Thresholds::default());
    assert!((read("min_place_m2 = 2.5").unwrap().min_place_m2 - 2.5).abs() < 1e-12);
    assert!(read("min_room_m2 = 2.5").is_err());
}
