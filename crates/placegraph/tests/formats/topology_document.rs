//! `topology.json`: the same bytes after reading and writing, and what is refused.

use placegraph::export::{MapInfo, TopologyDocument, TopologyError};
use placegraph::geom::Pose2;
use placegraph::grid::{CellGraph, FreeSpace, MapFrame, OccupancyGrid};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::topology::build;

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

#[test]
fn errors_say_what_was_expected_and_found() {
    let error = read(&with("\"sides\": [2, 1]", "\"sides\": [2, 4]")).unwrap_err();
    assert_eq!(error.to_string(), "expected the id of a place in the sides of place 3, found 4");
}
