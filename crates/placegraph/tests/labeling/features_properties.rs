//! What the registry declares of every feature holds: invariance to turning and mirroring, and the law of
//! scale. A new feature cannot escape these tests.

use placegraph::features::{Feature, Scale, all, extract, of_scan};
use placegraph::grid::CellGraph;
use placegraph::progress::Silent;
use placegraph::scan::{N_BEAMS, RangeScan, ScanConfig};
use placegraph_testkit::scenes::{doorway, rectangle};
use proptest::prelude::*;

use crate::maps::{self, bounds::bound};

prop_compose! {
    /// The scan of a room with slanted walls and pillars.
    fn room()(
        walls in prop::collection::vec((0.0..360f64, 0.5..9f64), 0..5),
        pillars in prop::collection::vec((0usize..N_BEAMS, 1usize..20, 0.4..5f64), 0..4),
        box_m in 3.0..12f64,
    ) -> RangeScan {
        let range = |beam: usize| {
            let squares = [0.3, 90.3, 180.3, 270.3].map(|normal| (normal, box_m));
            let reach = |&(normal_deg, distance): &(f64, f64)| {
                let cosine = (beam as f64 - normal_deg).to_radians().cos();
                if cosine > 1e-3 { distance / cosine } else { f64::INFINITY }
            };
            let wall = walls.iter().chain(&squares).map(reach).fold(f64::INFINITY, f64::min);
            let on_pillar = |&&(first, width, _): &&(usize, usize, f64)| (beam + N_BEAMS - first) % N_BEAMS < width;
            pillars.iter().filter(on_pillar).map(|pillar| pillar.2).fold(wall, f64::min)
        };
        RangeScan::new((0..N_BEAMS).map(range).collect())
    }
}

/// The features of both scans agree, for the features that `holds` selects.
fn assert_unchanged(scan: &RangeScan, other: &RangeScan, holds: impl Fn(&Feature) -> bool) {
    let longest = scan.ranges_m().iter().copied().fold(0.0, f64::max);
    let (values, others) = (of_scan(scan, &all()), of_scan(other, &all()));
    for ((id, value), other) in all().iter().zip(values).zip(others) {
        let (feature, value, other) = (id.feature(), f64::from(value), f64::from(other));
        if holds(feature) {
            let tolerance = 2.0 * bound(feature, value, longest);
            assert!((value - other).abs() <= tolerance, "{}: {value} became {other}", feature.name);
        }
    }
}

fn turned(scan: &RangeScan, beams: usize) -> RangeScan {
    let mut ranges = scan.ranges_m().to_vec();
    ranges.rotate_right(beams);
    RangeScan::new(ranges)
}

fn mirrored(scan: &RangeScan) -> RangeScan {
    RangeScan::new((0..N_BEAMS).map(|beam| scan.ranges_m()[(N_BEAMS - beam) % N_BEAMS]).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn turning_the_robot(scan in room(), beams in 1usize..N_BEAMS) {
        assert_unchanged(&scan, &turned(&scan, beams), |feature| feature.rotation_invariant);
    }

    #[test]
    fn mirroring_the_building(scan in room()) {
        assert_unchanged(&scan, &mirrored(&scan), |feature| feature.mirror_invariant);
    }
}

#[test]
fn what_is_not_declared_invariant_does_change() {
    let values = |scan: &RangeScan| of_scan(scan, &all());
    let scene = turned(&doorway(), 30);
    let (here, there) = (values(&scene), values(&mirrored(&scene)));
    let sign = all().iter().position(|id| id.feature().name == "B10(7)").unwrap();
    assert!(here[sign] * there[sign] < 0.0, "the seventh invariant changes its sign in a mirror");
}

#[test]
fn scaling_the_building() {
    for scan in [rectangle(), doorway()] {
        let longest = scan.ranges_m().iter().copied().fold(0.0, f64::max);
        let values = of_scan(&scan, &all());
        for scale in [0.7, 0.85, 1.2, 1.4f64] {
            let scaled = RangeScan::new(scan.ranges_m().iter().map(|range| range * scale).collect());
            for ((id, &value), found) in all().iter().zip(&values).zip(of_scan(&scaled, &all())) {
                let (feature, value) = (id.feature(), f64::from(value));
                let expected = match feature.scale {
                    Scale::Invariant => value,
                    Scale::Power(power) => value * scale.powf(power),
                    // Too near 0 for the law of decades, or on its way there.
                    Scale::Decades(_) if value.abs() < 8.0 => continue,
                    Scale::Decades(power) => value + value.signum() * power * scale.log10(),
                    Scale::FixedLength => continue,
                };
                let tolerance = 2.0 * bound(feature, expected, longest * scale);
                assert!(
                    (f64::from(found) - expected).abs() <= tolerance,
                    "{} at {scale}: {found}, expected {expected}",
                    feature.name
                );
            }
        }
    }
}

#[test]
fn features_of_a_turned_map() {
    let grid = maps::drawn();
    let other = maps::quarter_turn(&grid);
    let (graph, turned) = (CellGraph::new(&grid.cells), CellGraph::new(&other.cells));
    let config = ScanConfig::default();
    let here = extract(&grid, graph.cells(), &all(), &config, &Silent);
    let there = extract(&other, turned.cells(), &all(), &config, &Silent);
    for (row, &cell) in graph.cells().iter().enumerate() {
        let node = turned.node_at(maps::quarter_turn_cell(&grid, cell)).unwrap();
        for (column, id) in all().iter().enumerate() {
            let (feature, value) = (id.feature(), f64::from(here.column(column)[row]));
            // Equally wide gaps around: where the ring of A8 starts is arbitrary.
            if feature.name == "A8" {
                continue;
            }
            let found = f64::from(there.column(column)[node]);
            assert!(
                (value - found).abs() <= 2.0 * bound(feature, value, 15.0),
                "{} of {cell:?}",
                feature.name
            );
        }
    }
}
