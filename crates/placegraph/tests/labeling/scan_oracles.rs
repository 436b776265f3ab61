//! The block walk and the single scan against a traversal and against geometry.

use crate::maps;
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, Grid, MapFrame, Obstacles, Occupancy, OccupancyGrid};
use placegraph::scan::{
    self, Block, BlockRanges, Instructions, N_BEAMS, RayCaster, ScanConfig, UnknownCells,
};
use placegraph_testkit::rays::{nearest_box, traverse};
use proptest::prelude::*;

/// The ranges of `cells`, by the block walk.
fn walk(
    grid: &OccupancyGrid,
    cells: &[Cell],
    config: &ScanConfig,
    instructions: Instructions,
) -> Vec<Vec<f32>> {
    let caster = RayCaster::new(grid, config);
    let mut ranges = BlockRanges::new();
    let mut scans = vec![vec![0.0; N_BEAMS]; cells.len()];
    for block in Block::of_cells(cells) {
        caster.cast_block(&block, instructions, &mut ranges);
        let positions = block.rows.iter().flat_map(placegraph::scan::Run::positions);
        for (lane, position) in positions.enumerate() {
            for (beam, range) in scans[position].iter_mut().enumerate() {
                *range = ranges.range_m(lane, beam);
            }
        }
    }
    scans
}

/// All ways to cast agree on `cells`, to the last bit.
fn assert_equal_scans(grid: &OccupancyGrid, cells: &[Cell], config: &ScanConfig) {
    let walks = Instructions::ALL.map(|instructions| walk(grid, cells, config, instructions));
    let max_speck = (config.max_speck_m / grid.frame.resolution_m()).round() as u32;
    let mut cleared = grid.clone();
    for cell in Obstacles::of(&CellGraph::new(&grid.cells)).small(max_speck) {
        cleared.cells[cell] = Occupancy::Free;
    }
    for (i, &cell) in cells.iter().enumerate() {
        let expected = traverse(&cleared, cell, config);
        assert_eq!(scan::cast(grid, cell, config).ranges_m(), expected, "single scan of {cell:?}");
        let expected: Vec<f32> = expected.into_iter().map(|range| range as f32).collect();
        for (walk, instructions) in walks.iter().zip(Instructions::ALL) {
            assert_eq!(walk[i], expected, "walk of {cell:?}, {instructions:?}");
        }
    }
}

prop_compose! {
    /// A map of random cells, a few of them unknown, with side lengths around those of blocks.
    fn random_map()(width in 1u32..150, height in 1u32..40, percent in 0u32..40)(
        values in prop::collection::vec(0u32..1000, (width * height) as usize),
        width in Just(width), height in Just(height), percent in Just(percent),
    ) -> OccupancyGrid {
        let occupancy = |value: u32| match value {
            _ if value < percent * 10 => Occupancy::Occupied,
            _ if value > 990 => Occupancy::Unknown,
            _ => Occupancy::Free,
        };
        let cells = Grid::from_rows(width, height, values.into_iter().map(occupancy).collect());
        OccupancyGrid { frame: MapFrame::new(0.05, Pose2::default()).unwrap(), cells }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn walk_and_single_scan_equal_the_traversal(
        grid in random_map(),
        range_max_m in prop::sample::select(vec![0.3, 2.0, 80.0]),
        unknown in prop::sample::select(vec![UnknownCells::Stop, UnknownCells::Pass]),
        range_scale in prop::sample::select(vec![1.0, 0.7]),
        max_speck_m in prop::sample::select(vec![0.0, 0.05, 0.2]),
        stride in 1usize..9,
    ) {
        let graph = CellGraph::new(&grid.cells);
        let cells: Vec<Cell> = graph.cells().iter().copied().step_by(stride).collect();
        assert_equal_scans(&grid, &cells, &ScanConfig { range_max_m, unknown, range_scale, max_speck_m });
    }

    #[test]
    fn turning_and_mirroring_the_map_turns_and_mirrors_the_scan(grid in random_map()) {
        let config = ScanConfig::default();
        let (turned, mirrored) = (maps::quarter_turn(&grid), maps::mirror(&grid));
        for &cell in CellGraph::new(&grid.cells).cells().iter().step_by(7) {
            let here = scan::cast(&grid, cell, &config);
            let there = scan::cast(&turned, maps::quarter_turn_cell(&grid, cell), &config);
            let back = scan::cast(&mirrored, maps::mirror_cell(&grid, cell), &config);
            for beam in 0..N_BEAMS {
                let range = here.ranges_m()[beam].to_bits();
                prop_assert_eq!(there.ranges_m()[(beam + 90) % N_BEAMS].to_bits(), range);
                prop_assert_eq!(back.ranges_m()[(540 - beam) % N_BEAMS].to_bits(), range);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    #[test]
    fn ranges_are_distances_to_boxes(grid in random_map()) {
        let config = ScanConfig::default();
        for &cell in CellGraph::new(&grid.cells).cells().iter().step_by(97) {
            let scan = scan::cast(&grid, cell, &config);
            for beam in 0..N_BEAMS {
                let range = scan.ranges_m()[beam];
                // A beam through corners may pass beside a single one, but not between two.
                let shortest = nearest_box(&grid, cell, beam, 1e-9, &config);
                let longest = nearest_box(&grid, cell, beam, -1e-9, &config);
                prop_assert!(shortest - 1e-7 <= range && range <= longest + 1e-7, "beam {} of {:?}", beam, cell);
                prop_assert!(beam % 90 == 45 || longest - shortest < 1e-6, "only diagonals meet corners");
            }
        }
    }
}

#[test]
fn a_diagonal_beam_passes_one_corner_but_not_two() {
    let one = OccupancyGrid::from_ascii(1.0, "...\n.#.\n...\n");
    let config = ScanConfig::default();
    let diagonal = |grid: &OccupancyGrid, x, y| scan::cast(grid, Cell::new(x, y), &config).ranges_m()[45];
    // From the middle of the left side past the corner of the obstacle, out of the map at the top.
    assert!((diagonal(&one, 0, 1) - 1.5 * 2f64.sqrt()).abs() < 1e-12);
    let two = OccupancyGrid::from_ascii(1.0, "#..\n.#.\n...\n");
    assert!((diagonal(&two, 0, 1) - 0.5 * 2f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_cell_between_walls_sees_half_a_cell() {
    let grid = OccupancyGrid::from_ascii(0.1, "###\n#.#\n###\n");
    let cells = [Cell::new(1, 1)];
    assert_equal_scans(&grid, &cells, &ScanConfig::default());
    let scan = scan::cast(&grid, cells[0], &ScanConfig::default());
    assert!((scan.ranges_m()[0] - 0.05).abs() < 1e-12);
    assert!((scan.ranges_m()[45] - 0.05 * 2f64.sqrt()).abs() < 1e-12);
}

#[test]
fn cells_that_are_not_free_can_be_cast_too() {
    let grid = OccupancyGrid::from_ascii(0.1, "#?#\n#.#\n###\n");
    let cells: Vec<Cell> = grid.cells.cells().collect();
    assert_equal_scans(&grid, &cells, &ScanConfig::default());
}

#[test]
fn walk_equals_the_traversal_on_a_real_map() {
    let Some(grid) = maps::real("fr79_slam") else { return };
    let graph = CellGraph::new(&grid.cells);
    let cells: Vec<Cell> = graph.cells().iter().copied().step_by(23).collect();
    assert_equal_scans(&grid, &cells, &ScanConfig::default());
    // Whole blocks, as the engine casts them.
    let dense = &graph.cells()[40_000..44_000];
    assert_equal_scans(&grid, dense, &ScanConfig::default());
}
