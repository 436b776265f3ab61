//! Why a document is refused.

use super::{FORMAT, MAX_DOCUMENT_BYTES, VERSION};
use crate::syntax::SyntaxError;
use crate::topology::PlaceId;

/// Why bytes are not a valid topological map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// More bytes than any document has.
    #[error("expected a document of at most {MAX_DOCUMENT_BYTES} bytes, found {found}")]
    TooLarge {
        /// Number of bytes.
        found: usize,
    },
    /// Not the JSON of a document.
    #[error("expected the JSON of a {FORMAT} document")]
    Json {
        /// What the parser says, with line and column.
        source: SyntaxError,
    },
    /// Another kind of document.
    #[error("expected format {FORMAT:?}, found {found:?}")]
    Format {
        /// The format found.
        found: String,
    },
    /// Another version.
    #[error("expected version {VERSION} of {FORMAT}, found {found}")]
    Version {
        /// The version found.
        found: u64,
    },
    /// A grid that cannot be.
    #[error(
        "expected a map with cells of a positive size, found {width} x {height} cells of {resolution_m} m"
    )]
    Map {
        /// Columns found.
        width: u32,
        /// Rows found.
        height: u32,
        /// Resolution found.
        resolution_m: f64,
    },
    /// The map has more cells than allowed.
    #[error("expected a document of a map of at most {max_cells} cells, found {width} x {height}")]
    TooManyCells {
        /// Columns found.
        width: u32,
        /// Rows found.
        height: u32,
        /// The limit.
        max_cells: u64,
    },
    /// A place has a number that does not fit into a region image.
    #[error("expected place ids up to {}, found {found}", PlaceId::MAX.0)]
    PlaceId {
        /// The id found.
        found: u32,
    },
    /// Two places have one name, or a name cannot be printed.
    #[error("expected a printable name that no other place has for place {place}, found {name:?}")]
    PlaceName {
        /// The place.
        place: u32,
        /// Its name.
        name: String,
    },
    /// A probability is above 1.
    #[error("expected a probability of at most 1 for place {place}, found {found}")]
    Probability {
        /// The place.
        place: u32,
        /// Its probability.
        found: f64,
    },
    /// The area of a place is not that of its cells.
    #[error("expected {expected} m² as the area of the cells of place {place}, found {found}")]
    Area {
        /// The place.
        place: u32,
        /// The area of its cells.
        expected: f64,
        /// The area found.
        found: f64,
    },
    /// The places have more cells than the map.
    #[error("the places have more cells together than the map, which has {n_cells}")]
    Cells {
        /// Cells of the map.
        n_cells: u64,
    },
    /// A doorway lists a side twice, or itself.
    #[error(
        "expected different places as the sides of place {place}, found {found} twice or the place itself"
    )]
    Sides {
        /// The doorway.
        place: u32,
        /// The side at fault.
        found: u32,
    },
    /// A route has no point, or is shorter than the straight line between its ends.
    #[error(
        "the route of the connection {a} to {b} has {n_points} points and a length of {length_m} m: expected a point or more, and at least the length of the straight line"
    )]
    Route {
        /// One end of the connection.
        a: u32,
        /// The other end.
        b: u32,
        /// Points found.
        n_points: usize,
        /// Length found.
        length_m: f64,
    },
    /// A route does not begin and end in the places that it connects.
    #[error("expected the route from {a} to {b} to end in place {place}, found ({x}, {y})")]
    RouteEnd {
        /// The place where it begins.
        a: u32,
        /// The place where it ends.
        b: u32,
        /// The one of them that it should end in.
        place: u32,
        /// First coordinate of the end found.
        x: f64,
        /// Second coordinate of the end found.
        y: f64,
    },
    /// The jambs of a doorway are not as far apart as the doorway is wide.
    #[error("expected jambs {width_m} m apart for doorway {place}, found {found_m} m")]
    Jambs {
        /// The doorway.
        place: u32,
        /// Its width.
        width_m: f64,
        /// Distance of its jambs.
        found_m: f64,
    },
    /// A measure is below 0 or no number.
    #[error("expected a non-negative number as {of}, found {found}")]
    Measure {
        /// What is measured.
        of: String,
        /// The number found.
        found: f64,
    },
    /// A point lies outside of the map.
    #[error("expected a point inside the map as {of}, found ({x}, {y})")]
    Point {
        /// What the point is.
        of: String,
        /// First coordinate found.
        x: f64,
        /// Second coordinate found.
        y: f64,
    },
    /// Outlines cannot follow the sides of the map's cells.
    #[error("the outlines are longer than the sides of the map's {n_cells} cells allow")]
    Outlines {
        /// Cells of the map.
        n_cells: u64,
    },
    /// Places are not numbered upwards from 1 or more.
    #[error("expected place ids above {previous}, found {found}")]
    PlaceOrder {
        /// The id before.
        previous: u32,
        /// The id found.
        found: u32,
    },
    /// A place has a class that is not listed, or a role that differs from that of its class.
    #[error("expected a class of the document with role {role} in place {place}, found {class:?}")]
    PlaceClass {
        /// The place.
        place: u32,
        /// Its class.
        class: String,
        /// Its role.
        role: String,
    },
    /// The name of a file leads elsewhere.
    #[error("expected the name of a file of the result, without folders, found {found:?}")]
    FileName {
        /// The name found.
        found: String,
    },
    /// Something refers to a place that is not there.
    #[error("expected the id of a place in {referrer}, found {found}")]
    UnknownPlace {
        /// What refers to it.
        referrer: String,
        /// The id found.
        found: u32,
    },
    /// Shortcuts are not in order, or one stands twice, or joins something else than two doorways beside its place.
    #[error(
        "expected shortcuts in order, each once, between two doorways a < b beside the place, found {a} to {b} within {within}"
    )]
    Shortcut {
        /// The place found.
        within: u32,
        /// The end `a` found.
        a: u32,
        /// The end `b` found.
        b: u32,
    },
    /// Connections are out of order, one occurs twice, or its ends are swapped.
    #[error("expected connections in order with a < b, each once, found {a} to {b}")]
    ConnectionOrder {
        /// The end `a` found.
        a: u32,
        /// The end `b` found.
        b: u32,
    },
}
