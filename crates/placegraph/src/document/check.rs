//! Checks of a `topology.json`, before other code relies on it.

use std::collections::BTreeSet;

use super::{TopologyDocument, TopologyError};
use crate::geom::Point2;
use crate::grid::MapFrame;
use crate::labels::Class;
use crate::text::is_printable;
use crate::topology::{Connection, MAX_NAME_CHARS, Place, PlaceId, Route, Shortcut};

/// Points may lie this far outside of the grid: what rounding in any frame moves them.
const MARGIN_CELLS: f64 = 1.0;
/// Areas may differ from those of their cells by this much, relatively and in m²: documents round them.
const AREA_ROUNDING: f64 = 1e-6;
/// Coordinates of documents are rounded; two of them differ by at most this much more, in meters.
const POINT_ROUNDING_M: f64 = 1e-8;
/// Longest name that is read: that of a class or one given by hand, with a number behind it.
const MAX_NAME: usize = 2 * MAX_NAME_CHARS;

/// Checks that the document does not contradict itself.
pub(super) fn check(document: &TopologyDocument) -> Result<(), TopologyError> {
    let frame = check_map(document)?;
    check_places(document)?;
    check_connections(document)?;
    check_shortcuts(document)?;
    check_files(document)?;
    Geometry { document, frame }.check()
}

fn check_map(document: &TopologyDocument) -> Result<MapFrame, TopologyError> {
    let (width, height, resolution_m) = (document.map.width, document.map.height, document.map.resolution_m);
    let wrong = || TopologyError::Map { width, height, resolution_m };
    let n_cells = u64::from(width) * u64::from(height);
    if n_cells == 0 || n_cells >= u64::from(u32::MAX) {
        return Err(wrong());
    }
    MapFrame::new(resolution_m, document.map.origin).map_err(|_| wrong())
}

fn check_places(document: &TopologyDocument) -> Result<(), TopologyError> {
    let mut previous = 0;
    let mut names = BTreeSet::new();
    for place in &document.places {
        let PlaceId(found) = place.id;
        if found <= previous {
            return Err(TopologyError::PlaceOrder { previous, found });
        }
        if place.id > PlaceId::MAX {
            return Err(TopologyError::PlaceId { found });
        }
        previous = found;
        if !is_printable(&place.name, MAX_NAME) || !names.insert(place.name.as_str()) {
            let name = place.name.chars().take(MAX_NAME).collect();
            return Err(TopologyError::PlaceName { place: found, name });
        }
        let has_class = |class: &Class| class.name == place.class && class.role == place.role;
        if !document.classes.classes().iter().any(has_class) {
            let role = format!("{:?}", place.role).to_lowercase();
            return Err(TopologyError::PlaceClass { place: found, class: place.class.clone(), role });
        }
    }
    for place in &document.places {
        let mut seen = BTreeSet::from([place.id]);
        for &side in place.doorway.iter().flat_map(|doorway| &doorway.sides) {
            check_id(document, side, || format!("the sides of place {}", place.id.0))?;
            if !seen.insert(side) {
                return Err(TopologyError::Sides { place: place.id.0, found: side.0 });
            }
        }
    }
    Ok(())
}

/// The names of files have no folders: who cleans up after a document removes nothing elsewhere.
fn check_files(document: &TopologyDocument) -> Result<(), TopologyError> {
    let is_plain = |name: &str| !matches!(name, "" | "." | "..") && !name.contains(['/', '\\', '\0']);
    match document.files.iter().find(|file| !is_plain(&file.name)) {
        None => Ok(()),
        Some(file) => Err(TopologyError::FileName { found: file.name.clone() }),
    }
}

fn check_connections(document: &TopologyDocument) -> Result<(), TopologyError> {
    let mut previous = (PlaceId(0), PlaceId(0));
    for &Connection { a, b, .. } in &document.connections {
        check_id(document, a, || format!("the connection {} to {}", a.0, b.0))?;
        check_id(document, b, || format!("the connection {} to {}", a.0, b.0))?;
        if a >= b || (a, b) <= previous {
            return Err(TopologyError::ConnectionOrder { a: a.0, b: b.0 });
        }
        previous = (a, b);
    }
    Ok(())
}

/// Every end of a shortcut is a doorway that touches the place.
fn check_shortcuts(document: &TopologyDocument) -> Result<(), TopologyError> {
    let place = |id: PlaceId| {
        let found = document.places.binary_search_by_key(&id, |place| place.id);
        found.ok().map(|index| &document.places[index])
    };
    let is_connected = |p: PlaceId, q: PlaceId| {
        let pair = (p.min(q), p.max(q));
        document.connections.binary_search_by_key(&pair, |connection| (connection.a, connection.b)).is_ok()
    };
    let mut previous = None;
    for way in &document.shortcuts {
        let &Shortcut { within, a, b, .. } = way;
        let is_gate =
            |id: PlaceId| place(id).is_some_and(|place| place.doorway.is_some()) && is_connected(id, within);
        let key = Some((within, a, b));
        if a >= b || key <= previous || !is_gate(a) || !is_gate(b) {
            return Err(TopologyError::Shortcut { within: within.0, a: a.0, b: b.0 });
        }
        previous = key;
    }
    Ok(())
}

fn check_id(
    document: &TopologyDocument,
    id: PlaceId,
    referrer: impl Fn() -> String,
) -> Result<(), TopologyError> {
    match document.places.binary_search_by_key(&id, |place| place.id) {
        Ok(_) => Ok(()),
        Err(_) => Err(TopologyError::UnknownPlace { referrer: referrer(), found: id.0 }),
    }
}

/// The numbers of a document.
struct Geometry<'a> {
    document: &'a TopologyDocument,
    frame: MapFrame,
}

impl Geometry<'_> {
    fn check(&self) -> Result<(), TopologyError> {
        // Every side of a cell bounds at most two places.
        let n_cells = u64::from(self.document.map.width) * u64::from(self.document.map.height);
        if self.document.places.iter().map(|place| u64::from(place.n_cells)).sum::<u64>() > n_cells {
            return Err(TopologyError::Cells { n_cells });
        }
        let mut rows_left = 4.0 * n_cells as f64;
        for place in &self.document.places {
            self.check_place(place)?;
            for ring in place.rings() {
                self.points(ring, || format!("a corner of the outline of place {}", place.id.0))?;
                let next = ring.iter().cycle().skip(1);
                let rows = |(a, b): (&Point2, &Point2)| {
                    (self.frame.cells_from_map(*a).y - self.frame.cells_from_map(*b).y).abs()
                };
                rows_left -= ring.iter().zip(next).map(rows).sum::<f64>();
            }
            if rows_left < -1.0 {
                return Err(TopologyError::Outlines { n_cells });
            }
        }
        self.document.connections.iter().try_for_each(|connection| self.check_connection(connection))?;
        self.document.shortcuts.iter().try_for_each(|way| self.check_shortcut(way))
    }

    fn check_place(&self, place: &Place) -> Result<(), TopologyError> {
        let of = |what: &str| format!("the {what} of place {}", place.id.0);
        measure(place.probability, || of("probability"))?;
        if place.probability > 1.0 {
            return Err(TopologyError::Probability { place: place.id.0, found: place.probability });
        }
        measure(place.area_m2, || of("area"))?;
        let expected = f64::from(place.n_cells) * self.frame.cell_area_m2();
        if (place.area_m2 - expected).abs() > AREA_ROUNDING * expected + AREA_ROUNDING {
            return Err(TopologyError::Area { place: place.id.0, expected, found: place.area_m2 });
        }
        measure(place.clearance_m, || of("clearance"))?;
        measure(place.axes.major_m, || of("major axis"))?;
        measure(place.axes.minor_m, || of("minor axis"))?;
        measure(place.axes.direction_rad.abs(), || of("direction"))?;
        self.points(&[place.centroid], || of("centroid"))?;
        self.points(&[place.anchor], || of("anchor"))?;
        if let Some(doorway) = &place.doorway {
            measure(doorway.width_m, || of("width"))?;
            self.points(&doorway.jambs, || of("jambs"))?;
            let found_m = doorway.jambs[0].distance(doorway.jambs[1]);
            if (found_m - doorway.width_m).abs() > 0.5 * self.frame.resolution_m() {
                let (place, width_m) = (place.id.0, doorway.width_m);
                return Err(TopologyError::Jambs { place, width_m, found_m });
            }
        }
        Ok(())
    }

    fn check_connection(&self, connection: &Connection) -> Result<(), TopologyError> {
        let of =
            |what: &str| format!("the {what} of the connection {} to {}", connection.a.0, connection.b.0);
        measure(connection.contact_m, || of("contact"))?;
        self.points(&[connection.middle], || of("middle"))?;
        let ends = [connection.a, connection.b];
        connection.route.as_ref().map_or(Ok(()), |route| self.check_route(route, ends, of))
    }

    fn check_shortcut(&self, way: &Shortcut) -> Result<(), TopologyError> {
        let Shortcut { within, a, b, route } = way;
        let of = |what: &str| format!("the {what} of the shortcut {} to {} within {}", a.0, b.0, within.0);
        self.check_route(route, [*a, *b], of)
    }

    fn check_route(
        &self,
        route: &Route,
        [a, b]: [PlaceId; 2],
        of: impl Fn(&str) -> String,
    ) -> Result<(), TopologyError> {
        measure(route.length_m, || of("length"))?;
        self.points(&route.line, || of("route"))?;
        let straight_m = match route.line.as_slice() {
            [] => f64::INFINITY,
            [first, .., last] => first.distance(*last),
            [_] => 0.0,
        };
        if route.length_m < straight_m - self.frame.resolution_m() {
            let (n_points, length_m) = (route.line.len(), route.length_m);
            return Err(TopologyError::Route { a: a.0, b: b.0, n_points, length_m });
        }
        let ends = [(a, route.line.first()), (b, route.line.last())];
        for (id, &Point2 { x, y }) in ends.into_iter().filter_map(|(id, end)| Some((id, end?))) {
            if !self.may_end_in(id, Point2 { x, y }) {
                return Err(TopologyError::RouteEnd { a: a.0, b: b.0, place: id.0, x, y });
            }
        }
        Ok(())
    }

    /// Whether the point lies within the columns and rows of the place's outline. Routes end in the middle of cells.
    fn may_end_in(&self, id: PlaceId, point: Point2) -> bool {
        let places = &self.document.places;
        let Ok(index) = places.binary_search_by_key(&id, |place| place.id) else { return false };
        let mut corners = places[index].rings().flatten().map(|&corner| self.frame.cells_from_map(corner));
        let Some(first) = corners.next() else { return true };
        let (low, high) = corners.fold((first, first), |(low, high), corner| {
            let low = Point2::new(low.x.min(corner.x), low.y.min(corner.y));
            (low, Point2::new(high.x.max(corner.x), high.y.max(corner.y)))
        });
        let margin = 0.25 + POINT_ROUNDING_M / self.frame.resolution_m();
        let inside = |v: f64, low: f64, high: f64| (low - margin..=high + margin).contains(&v);
        let point = self.frame.cells_from_map(point);
        inside(point.x, low.x, high.x) && inside(point.y, low.y, high.y)
    }

    fn points(&self, points: &[Point2], of: impl Fn() -> String) -> Result<(), TopologyError> {
        for &point in points {
            let Point2 { x, y } = self.frame.cells_from_map(point);
            let inside = |v: f64, side: u32| (-MARGIN_CELLS..=side as f64 + MARGIN_CELLS).contains(&v);
            if !inside(x, self.document.map.width) || !inside(y, self.document.map.height) {
                return Err(TopologyError::Point { of: of(), x: point.x, y: point.y });
            }
        }
        Ok(())
    }
}

fn measure(found: f64, of: impl Fn() -> String) -> Result<(), TopologyError> {
    // Sums and squares of what passes stay finite.
    if (0.0..1e18).contains(&found) { Ok(()) } else { Err(TopologyError::Measure { of: of(), found }) }
}
