//! Outlines against `geo`, anchors against looking at every cell, and the invariants of the map.

use geo::{Area, Contains, Coord, LineString, Polygon, Validation};
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Label, LabelField, LabelSet, Role};
use placegraph::regions::{DiagonalSteps, RegionMap, connected};
use placegraph::topology::{PlaceId, PolygonWithHoles, Route, TopologicalMap, build};
use placegraph_testkit::distance::squared_clearance;
use proptest::prelude::*;

/// A map in patches: 0 is a wall, the others are label + 1.
fn maps() -> impl Strategy<Value = (CellGraph, Vec<Label>)> {
    (1u32..20, 1u32..20, 1u32..4).prop_flat_map(|(width, height, patch)| {
        prop::collection::vec(0u8..4, (width * height) as usize).prop_map(move |values| {
            let across = width.div_ceil(patch);
            let at = |i: u32| values[((i / width / patch) * across + i % width / patch) as usize];
            let image = Grid::from_rows(width, height, (0..width * height).map(at).collect());
            let graph = CellGraph::new(&image.map(|&value| match value {
                0 => Occupancy::Unknown,
                _ => Occupancy::Free,
            }));
            let labels = graph.cells().iter().map(|&cell| Label(image[cell] - 1)).collect();
            (graph, labels)
        })
    })
}

fn diagonals() -> impl Strategy<Value = DiagonalSteps> {
    prop_oneof![Just(DiagonalSteps::ThroughFree), Just(DiagonalSteps::Any)]
}

fn built(graph: &CellGraph, labels: &[Label], frame: &MapFrame, regions: &RegionMap) -> TopologicalMap {
    let rows = labels.iter().flat_map(|l| (0..3).map(|k| if k == l.index() { 0.8 } else { 0.1 })).collect();
    let space = FreeSpace { frame: *frame, graph: graph.clone() };
    build(&space, &LabelField::from_rows(3, rows), regions, &LabelSet::default())
}

fn ring(points: &[Point2]) -> LineString<f64> {
    let mut coords: Vec<Coord<f64>> = points.iter().map(|p| Coord { x: p.x, y: p.y }).collect();
    coords.extend(coords.first().copied());
    LineString::new(coords)
}

fn polygon(outline: &PolygonWithHoles) -> Polygon<f64> {
    Polygon::new(ring(&outline.exterior), outline.holes.iter().map(|hole| ring(hole)).collect())
}

fn signed_area(points: &[Point2]) -> f64 {
    Polygon::new(ring(points), vec![]).signed_area()
}

proptest! {
    #[test]
    fn outlines_are_valid_and_have_the_area_of_the_cells(
        (graph, labels) in maps(),
        diagonal in diagonals(),
    ) {
        // Half-meter cells and no rotation keep coordinates exact.
        let frame = MapFrame::new(0.5, Pose2::new(-3.0, 2.0, 0.0)).unwrap();
        let regions = connected(&graph, &labels, diagonal);
        for place in &built(&graph, &labels, &frame, &regions).places {
            let mut area_m2 = 0.0;
            for outline in &place.outline {
                let polygon = polygon(outline);
                prop_assert!(polygon.is_valid(), "{:?}", polygon.validation_errors());
                prop_assert!(signed_area(&outline.exterior) > 0.0);
                prop_assert!(outline.holes.iter().all(|hole| signed_area(hole) < 0.0));
                area_m2 += polygon.unsigned_area();
            }
            prop_assert!((area_m2 - place.n_cells as f64 * 0.25).abs() < 1e-9);
            for (&cell, id) in graph.cells().iter().zip(&regions.region_of) {
                let center = frame.center(cell);
                let inside =
                    place.outline.iter().any(|o| polygon(o).contains(&geo::Point::new(center.x, center.y)));
                prop_assert_eq!(inside, id.0 + 1 == place.id.0);
            }
        }
    }

    #[test]
    fn outlines_have_their_own_corners_and_those_beside_them((graph, labels) in maps()) {
        let frame = MapFrame::new(1.0, Pose2::default()).unwrap();
        let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
        let map = built(&graph, &labels, &frame, &regions);
        let outlines = map.places.iter().flat_map(|place| &place.outline);
        let rings: Vec<_> =
            outlines.flat_map(|outline| std::iter::once(&outline.exterior).chain(&outline.holes)).collect();
        for (index, points) in rings.iter().enumerate() {
            let others = || rings.iter().enumerate().filter(|&(other, _)| other != index).flat_map(|(_, ring)| *ring);
            for i in 0..points.len() {
                let [a, b, c] = [0, 1, 2].map(|step| points[(i + step) % points.len()]);
                let is_corner = (b - a).cross(c - b).abs() > 0.5;
                prop_assert!(is_corner || others().any(|other| other.distance(b) < 0.5));
                // No corner of another ring lies within a side.
                let inside = |p: &Point2| {
                    (b - a).cross(*p - a).abs() < 0.5 && (*p - a).dot(b - a) > 0.5 && (*p - b).dot(a - b) > 0.5
                };
                prop_assert!(!others().any(inside));
            }
        }
    }

    #[test]
    fn anchors_have_the_largest_clearance((graph, labels) in maps(), yaw_rad in -3.0..3.0f64) {
        let frame = MapFrame::new(0.05, Pose2::new(1.0, 1.0, yaw_rad)).unwrap();
        let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
        for (index, place) in built(&graph, &labels, &frame, &regions).places.iter().enumerate() {
            let nodes: Vec<usize> =
                (0..graph.n_nodes()).filter(|&n| regions.region_of[n].index() == index).collect();
            let largest = nodes.iter().map(|&n| squared_clearance(&graph, &regions, n)).max().unwrap();
            let from_centroid = |n: usize| frame.center(graph.cells()[n]).distance(place.centroid);
            let best: Vec<usize> = nodes
                .into_iter()
                .filter(|&n| squared_clearance(&graph, &regions, n) == largest)
                .collect();
            let anchor = graph.node_at(frame.cell_at(place.anchor).unwrap()).unwrap();
            prop_assert!(best.contains(&anchor));
            let nearest = best.iter().map(|&n| from_centroid(n)).fold(f64::INFINITY, f64::min);
            prop_assert!(from_centroid(anchor) < nearest + 1e-9);
            // The nearest side is half a cell to half a diagonal nearer than the nearest center.
            let gap = (largest as f64).sqrt() - place.clearance_m / 0.05;
            prop_assert!((0.5 - 1e-9..=0.7072).contains(&gap), "{}", gap);
        }
    }

    #[test]
    fn the_map_keeps_its_invariants((graph, labels) in maps(), diagonal in diagonals()) {
        let frame = MapFrame::new(0.05, Pose2::default()).unwrap();
        let regions = connected(&graph, &labels, diagonal);
        let map = built(&graph, &labels, &frame, &regions);
        prop_assert_eq!(map.places.len(), regions.regions.len());
        for (index, place) in map.places.iter().enumerate() {
            prop_assert_eq!(place.id.0 as usize, index + 1);
            prop_assert!((place.probability - 0.8).abs() < 1e-6);
            prop_assert_eq!(place.doorway.is_some(), place.role == Role::Doorway);
            if let Some(doorway) = &place.doorway {
                let touching = map.connections_of(place.id).count();
                prop_assert_eq!(doorway.sides.len(), touching);
                let [a, b] = doorway.jambs;
                prop_assert!((a.distance(b) - doorway.width_m).abs() < 1e-9);
                prop_assert!(doorway.width_m > 0.0);
                let contact = |side| {
                    let with = map.connections_of(place.id).find(|c| c.a == side || c.b == side);
                    with.unwrap().contact_m
                };
                prop_assert!(doorway.sides.windows(2).all(|s| contact(s[0]) >= contact(s[1])));
            }
        }
        for connection in &map.connections {
            // Cells that meet at a corner only may have no way between them.
            let Some(route) = &connection.route else { continue };
            for point in points_on(route) {
                let node = graph.node_at(frame.cell_at(point).unwrap());
                prop_assert!(node.is_some(), "a route runs through free cells");
            }
        }
        prop_assert!(map.connections.windows(2).all(|c| (c[0].a, c[0].b) < (c[1].a, c[1].b)));
        prop_assert!(map.connections.iter().all(|c| c.a < c.b && map.place(c.b).is_some()));
    }

    #[test]
    fn places_that_share_a_side_have_a_route_that_leaves_neither((graph, labels) in maps()) {
        let frame = MapFrame::new(0.05, Pose2::default()).unwrap();
        // No place hangs together by a corner only.
        let regions = connected(&graph, &labels, DiagonalSteps::Never);
        let map = built(&graph, &labels, &frame, &regions);
        for connection in map.connections.iter().filter(|connection| connection.contact_m > 0.0) {
            let route = connection.route.as_ref();
            prop_assert!(route.is_some(), "{:?} to {:?}", connection.a, connection.b);
            for point in route.into_iter().flat_map(points_on) {
                let node = graph.node_at(frame.cell_at(point).unwrap()).unwrap();
                let place = PlaceId(regions.region_of[node].0 + 1);
                prop_assert!([connection.a, connection.b].contains(&place), "{:?} in {:?}", connection, place);
            }
        }
    }
}

/// Points on the way, but not the corners of cells.
fn points_on(route: &Route) -> impl Iterator<Item = Point2> {
    route.line.windows(2).flat_map(|ends| {
        let parts = (0..=100).map(|part| (part as f64 + 0.317) / 101.0);
        parts.map(|part| ends[0] + (ends[1] - ends[0]) * part)
    })
}
