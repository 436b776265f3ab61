//! The engine's features against the plain formulas, cell by cell.

use placegraph::features::{all, extract, of_scan};
use placegraph::grid::{Cell, CellGraph, Grid, Occupancy, OccupancyGrid};
use placegraph::progress::Silent;
use placegraph::scan::{self, RangeScan, ScanConfig};
use placegraph_testkit::plain_features::plain_feature;

use crate::maps::{self, bounds::bound};

/// The engine and the plain formulas agree on `cells` of `grid`.
fn assert_agree(grid: &OccupancyGrid, cells: &[Cell], config: &ScanConfig) {
    let columns = all();
    let table = extract(grid, cells, &columns, config, &Silent);
    for (row, &cell) in cells.iter().enumerate() {
        let scan = scan::cast(grid, cell, config);
        // The ranges as the engine has them: equal ones stay equal.
        let ranges: Vec<f64> = scan.ranges_m().iter().map(|&range| f64::from(range as f32)).collect();
        let longest = ranges.iter().copied().fold(0.0, f64::max);
        let alone = of_scan(&scan, &columns);
        for (column, id) in columns.iter().enumerate() {
            let feature = id.feature();
            let value = table.column(column)[row];
            assert_eq!(value.to_bits(), alone[column].to_bits(), "{} alone, {cell:?}", feature.name);
            let plain = plain_feature(feature, &ranges);
            assert!(
                (f64::from(value) - plain).abs() <= bound(feature, plain, longest),
                "{} of {cell:?}: {value}, plain formula {plain}",
                feature.name
            );
        }
    }
}

fn every(grid: &OccupancyGrid, stride: usize) -> Vec<Cell> {
    CellGraph::new(&grid.cells).cells().iter().copied().step_by(stride).collect()
}

#[test]
fn drawn_map() {
    let grid = maps::drawn();
    assert_agree(&grid, &every(&grid, 5), &ScanConfig::default());
    let scaled = ScanConfig { range_scale: 0.7, range_max_m: 4.0, ..ScanConfig::default() };
    assert_agree(&grid, &every(&grid, 31), &scaled);
}

#[test]
fn real_maps() {
    for name in ["fr79_slam", "fr52_slam", "log_intel"] {
        let Some(grid) = maps::real(name) else { return };
        let cells = every(&grid, 2503);
        assert_agree(&grid, &cells, &ScanConfig::default());
    }
}

#[test]
fn cells_with_hardly_any_room_have_finite_features() {
    let grid = OccupancyGrid::from_ascii(0.05, "#####\n#.#.#\n#####\n#...#\n####.\n");
    assert_agree(&grid, &every(&grid, 1), &ScanConfig::default());
}

#[test]
fn degenerate_scans_have_finite_features() {
    let mut spike = vec![0.0; 360];
    spike[17] = 3.0;
    let mut huge = vec![1e4; 360];
    huge[90] = 1e-3;
    for ranges in [vec![0.0; 360], vec![80.0; 360], vec![1e-12; 360], spike, huge] {
        let columns = all();
        let values = of_scan(&RangeScan::new(ranges.clone()), &columns);
        for (id, value) in columns.iter().zip(values) {
            assert!(value.is_finite(), "{} of {:?} …: {value}", id.feature().name, &ranges[..3]);
        }
    }
}

#[test]
fn equal_ranges_have_no_spread_and_no_kurtosis() {
    let columns = all();
    let values = of_scan(&RangeScan::new(vec![2.0 / 3.0; 360]), &columns);
    for (id, value) in columns.iter().zip(values) {
        if ["A1", "A2", "A6", "A14", "A16", "A9", "A12"].contains(&id.feature().name.as_str()) {
            assert_eq!(value.to_bits(), 0.0f32.to_bits(), "{}", id.feature().name);
        }
    }
}

/// A hall of 60 m with pillars here and there: beams end at all distances, next to one another.
fn hall_with_pillars() -> OccupancyGrid {
    let mut grid = OccupancyGrid::from_ascii(0.25, ".");
    let side = 240;
    let mut state = 1u32;
    let mut dice = |n: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % n
    };
    let pillars: Vec<[u32; 3]> = (0..60).map(|_| [dice(side), dice(side), 1 + dice(6)]).collect();
    let is_wall = |cell: Cell| {
        let on_border = cell.x == 0 || cell.y == 0 || cell.x == side - 1 || cell.y == side - 1;
        let in_pillar =
            |&[x, y, size]: &[u32; 3]| (x..x + size).contains(&cell.x) && (y..y + size).contains(&cell.y);
        on_border || pillars.iter().any(in_pillar)
    };
    let state = |cell| if is_wall(cell) { Occupancy::Occupied } else { Occupancy::Free };
    let cells = Grid::filled(side, side, ()).cells().map(state).collect();
    grid.cells = Grid::from_rows(side, side, cells);
    grid
}

/// Every column is told from every other one by the formulas, so that a column in the place of another would not agree.
#[test]
fn no_column_could_stand_for_another() {
    let grid = hall_with_pillars();
    let cells = every(&grid, 409);
    assert_agree(&grid, &cells, &ScanConfig::default());
    let columns = all();
    let table = extract(&grid, &cells, &columns, &ScanConfig::default(), &Silent);
    let mut alike = Vec::new();
    for (column, id) in columns.iter().enumerate() {
        let same = (0..column).filter(|&other| table.column(other) == table.column(column));
        alike.extend(same.map(|other| (columns[other].feature().name.clone(), id.feature().name.clone())));
    }
    assert!(alike.iter().all(|(a, b)| a == "B9" && b == "f19_2"), "{alike:?}");
}
