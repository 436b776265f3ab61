//! `topology.json`: the same bytes after reading and writing, and what is refused.

use placegraph::export::{MapInfo, TopologyDocument, TopologyError};
use placegraph::geom::{Point2, Pose2};
use placegraph::grid::{CellGraph, FreeSpace, MapFrame, OccupancyGrid};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::topology::{PlaceId, Route, build};

/// Corridor, doorway and room in a turned frame.
fn document() -> TopologyDocument {
    let mut grid = OccupancyGrid::from_ascii(
        0.1,
        "
        ....#....
        .........
        ..#.#....
        ",
    );
    grid.frame = MapFrame::new(0.1, Pose2::new(-1.0 / 3.0, 2.0, 0.7)).unwrap();
    let graph = CellGraph::new(&grid.cells);
    let labels: Vec<Label> = graph
        .cells()
        .iter()
        .map(|cell| match cell.x {
            0..4 => Label(0),
            4 => Label(2),
            _ => Label(1),
        })
        .collect();
    let regions = connected(&graph, &labels, DiagonalSteps::ThroughFree);
    let field = LabelField::from_rows(3, vec![1.0 / 3.0; 3 * graph.n_nodes()]);
    let topology = build(&FreeSpace { frame: grid.frame, graph }, &field, &regions, &LabelSet::default());
    let mut document =
        TopologyDocument::new(MapInfo::of(&grid, "drawn", "00ff"), None, &LabelSet::default(), &topology);
    document.timings_ms.insert("topology".into(), 1.25);
    document.findings.push("the map is very small".into());
    document
}

fn read(text: &str) -> Result<TopologyDocument, TopologyError> {
    TopologyDocument::from_json(text.as_bytes())
}

/// The document's text with `from` replaced, which must occur.
fn with(from: &str, to: &str) -> String {
    let text = document().to_json().unwrap();
    assert!(text.contains(from), "{from} in {text}");
    text.replacen(from, to, 1)
}

#[test]
fn the_same_bytes_after_reading_and_writing() {
    let text = document().to_json().unwrap();
    let document = read(&text).unwrap();
    assert_eq!(document, self::document());
    assert_eq!(document.to_json().unwrap(), text);
    assert_eq!(document.topology().places.len(), 3);
    assert_eq!(document.topology().connections.len(), 2);
}

#[test]
fn other_formats_and_versions_are_refused_before_anything_else() {
    assert!(matches!(read(&with("placegraph-topology", "other")), Err(TopologyError::Format { .. })));
    let newer = with("\"version\": 1", "\"version\": 2").replacen("\"findings\"", "\"remarks\"", 1);
    assert!(matches!(read(&newer), Err(TopologyError::Version { found: 2 })));
}

#[test]
fn what_is_no_document_is_refused() {
    for text in [
        String::new(),
        "[]".into(),
        with("\"findings\"", "\"remarks\""),
        with("\"width\": 9", "\"width\": -9"),
        with("\"resolution_m\": 0.1", "\"resolution_m\": NaN"),
        with("\"resolution_m\": 0.1", "\"resolution_m\": 1e999"),
        with("\"resolution_m\": 0.1", "\"resolution_m\": null"),
    ] {
        assert!(matches!(read(&text), Err(TopologyError::Json { .. })), "{text}");
    }
    assert!(matches!(
        read(&with("\"resolution_m\": 0.1", "\"resolution_m\": 0")),
        Err(TopologyError::Map { .. })
    ));
}

#[test]
fn contradictions_are_refused() {
    assert!(matches!(
        read(&with("\"id\": 2", "\"id\": 1")),
        Err(TopologyError::PlaceOrder { previous: 1, found: 1 })
    ));
    assert!(matches!(
        read(&with("\"class\": \"room\"", "\"class\": \"hall\"")),
        Err(TopologyError::PlaceClass { place: 2, .. })
    ));
    assert!(matches!(
        read(&with("\"sides\": [2, 1]", "\"sides\": [2, 4]")),
        Err(TopologyError::UnknownPlace { found: 4, .. })
    ));
    assert!(matches!(read(&with("\"b\": 3", "\"b\": 7")), Err(TopologyError::UnknownPlace { found: 7, .. })));
    assert!(matches!(
        read(&with("\"a\": 2", "\"a\": 3")),
        Err(TopologyError::ConnectionOrder { a: 3, b: 3 })
    ));
}

/// The document's text after `change`.
fn changed(change: impl FnOnce(&mut TopologyDocument)) -> Result<TopologyDocument, TopologyError> {
    let mut document = document();
    change(&mut document);
    read(&document.to_json().unwrap())
}

#[test]
fn what_contradicts_itself_in_numbers_and_names_is_refused() {
    use TopologyError as E;
    assert!(matches!(
        changed(|d| d.places[1].name = d.places[0].name.clone()),
        Err(E::PlaceName { place: 2, .. })
    ));
    for name in ["", "a\nb", "\u{7}bell", "\u{1b}]0;title\u{7}", "\u{fffe}", &"x".repeat(401)] {
        assert!(
            matches!(changed(|d| d.places[0].name = name.into()), Err(E::PlaceName { place: 1, .. })),
            "{name:?}"
        );
    }
    assert!(matches!(changed(|d| d.places[0].probability = 5.0), Err(E::Probability { place: 1, .. })));
    assert!(matches!(changed(|d| d.places[0].area_m2 *= 1.01), Err(E::Area { place: 1, .. })));
    assert!(matches!(changed(|d| d.places[0].n_cells += 1), Err(E::Area { place: 1, .. })));
    let more_cells = changed(|d| {
        d.places[0].n_cells = 28;
        d.places[0].area_m2 = 0.28;
    });
    assert!(matches!(more_cells, Err(E::Cells { n_cells: 27 })));
    let with_sides = |sides: &[u32]| {
        changed(|d| {
            d.places[2].doorway.as_mut().unwrap().sides = sides.iter().map(|&id| PlaceId(id)).collect();
        })
    };
    assert!(with_sides(&[2, 1]).is_ok() && with_sides(&[]).is_ok());
    assert!(matches!(with_sides(&[1, 3]), Err(E::Sides { place: 3, found: 3 })));
    assert!(matches!(with_sides(&[1, 2, 1]), Err(E::Sides { place: 3, found: 1 })));
    for id in [65_536, u32::MAX] {
        assert!(matches!(
            changed(|d| d.places[2].id = PlaceId(id)),
            Err(E::PlaceId { .. } | E::UnknownPlace { .. })
        ));
    }
    let route = |line: Vec<Point2>, length_m| {
        changed(|d| d.connections[0].route = Some(Route { length_m, clearance_m: None, line }))
    };
    let ends = |d: &TopologyDocument| vec![d.places[0].anchor, d.places[2].anchor];
    let straight_m = document().places[0].anchor.distance(document().places[2].anchor);
    assert!(route(ends(&document()), straight_m).is_ok());
    assert!(matches!(route(Vec::new(), 1.0), Err(E::Route { n_points: 0, .. })));
    assert!(matches!(route(ends(&document()), straight_m - 0.2), Err(E::Route { n_points: 2, .. })));
    // The second connection is that of the room: nothing of the corridor lies there.
    assert!(
        changed(|d| d.connections[1].route = Some(Route::along(vec![d.places[1].anchor, d.places[2].anchor])))
            .is_ok()
    );
    let elsewhere = changed(|d| {
        d.connections[1].route = Some(Route::along(vec![d.places[0].anchor, d.places[2].anchor]));
    });
    assert!(matches!(elsewhere, Err(E::RouteEnd { place: 2, .. })), "{elsewhere:?}");
    let backwards = changed(|d| {
        d.connections[1].route = Some(Route::along(vec![d.places[2].anchor, d.places[1].anchor]));
    });
    assert!(matches!(backwards, Err(E::RouteEnd { .. })), "{backwards:?}");
    let jambs = changed(|d| {
        let doorway = d.places[2].doorway.as_mut().unwrap();
        doorway.jambs[1] = doorway.jambs[0];
    });
    assert!(matches!(jambs, Err(E::Jambs { place: 3, .. })), "{jambs:?}");
}

/// How a test reaches a point of a document.
type PointOf = fn(&mut TopologyDocument) -> &mut Point2;

#[test]
fn points_lie_in_the_map() {
    let points: [(&str, PointOf); 7] = [
        ("the anchor", |d| &mut d.places[0].anchor),
        ("the centroid", |d| &mut d.places[1].centroid),
        ("a corner of the outline", |d| &mut d.places[1].outline[0].exterior[2]),
        ("the jambs", |d| &mut d.places[2].doorway.as_mut().unwrap().jambs[1]),
        ("the middle", |d| &mut d.connections[0].middle),
        ("the route", |d| d.connections[1].route.as_mut().unwrap().line.first_mut().unwrap()),
        ("the route", |d| d.connections[1].route.as_mut().unwrap().line.last_mut().unwrap()),
    ];
    let frame = document().map.shape().unwrap().frame;
    for (of, point) in points {
        // Columns and rows of the map of 9 x 3 cells, and more than a cell beyond each side.
        for cell in [(-1.1, 1.0), (10.1, 1.0), (4.0, -1.1), (4.0, 4.1), (1e9, 1.0), (4.0, -1e9)] {
            let outside = changed(|d| *point(d) = frame.map_from_cells(Point2::new(cell.0, cell.1)));
            assert!(
                matches!(&outside, Err(TopologyError::Point { of: found, .. }) if found.starts_with(of)),
                "{of} at {cell:?}: {outside:?}"
            );
        }
    }
}

#[test]
fn outlines_that_no_cells_have_are_refused() {
    // Along the same corners again and again: each place by itself is in order, the rows of all are too many.
    let again = |n: usize| {
        changed(|d| {
            let ring = &mut d.places[0].outline[0].exterior;
            *ring = ring.iter().copied().cycle().take(n * ring.len()).collect();
        })
    };
    assert!(again(2).is_ok());
    assert!(matches!(again(100), Err(TopologyError::Outlines { n_cells: 27 })));
}

#[test]
fn documents_are_bounded_as_maps_are() {
    let document = document();
    assert!(document.check_size(27).is_ok());
    let error = document.check_size(26).unwrap_err();
    assert!(matches!(error, TopologyError::TooManyCells { width: 9, height: 3, max_cells: 26 }), "{error}");
}

#[test]
fn the_last_number_given_is_kept() {
    let mut document = document();
    assert_eq!(document.topology().last_id, PlaceId(3));
    document.last_place_id = Some(PlaceId(17));
    let text = document.to_json().unwrap();
    assert_eq!(read(&text).unwrap().topology().last_id, PlaceId(17));
    let older = text.replacen("\"last_place_id\": 17,", "", 1);
    assert_ne!(older, text);
    assert_eq!(read(&older).unwrap().topology().last_id, PlaceId(3));
}

#[test]
fn findings_are_there_also_if_there_are_none() {
    let mut document = document();
    document.findings.clear();
    assert!(document.to_json().unwrap().contains("\"findings\": []"));
}

#[test]
fn errors_say_what_was_expected_and_found() {
    let error = read(&with("\"sides\": [2, 1]", "\"sides\": [2, 4]")).unwrap_err();
    assert_eq!(error.to_string(), "expected the id of a place in the sides of place 3, found 4");
}
