//! Floor plans in the XML of Luperto et al. (`building/floor/spaces/space`): polygons with a label, and portals.
//!
//! Polygons share their edges; a portal is a point on an edge, listed at both of its spaces. Lengths are pixels; the file
//! says how many of them are how many centimeters. A portal of type `IMPLICIT` is a connection without a door, unless its
//! `features` are missing: in those files all portals are `IMPLICIT`.

use placegraph::geom::{Point2, Vec2};
use roxmltree::{Document, Node};

use super::{Outline, Survey, SurveyError, SurveyedDoor, SurveyedSpace};
use crate::plan::Usage;

const EXPECTED: &str = "a floor plan (XML with building, scale and space)";

/// Portals that are nearer to each other than this are one, in meters.
const SAME_PORTAL_M: f64 = 0.7;

/// Reads one floor plan.
///
/// # Errors
/// If `text` is no such plan, or has no scale of a building.
pub fn read_plan_xml(text: &str) -> Result<Survey, SurveyError> {
    let document = Document::parse(text).map_err(|error| SurveyError::text(EXPECTED, &error))?;
    let building = document.root_element();
    let length = |name: &str| {
        let scale = child(building, "scale")?;
        child(child(scale, name)?, "value")?.text()?.trim().parse::<f64>().ok()
    };
    let (Some(pixels), Some(centimeters)) = (length("represented_distance"), length("real_distance")) else {
        return Err(SurveyError::text(EXPECTED, &"scale lacks represented_distance or real_distance"));
    };
    let meters_per_pixel = centimeters / 100.0 / pixels;
    let is_home = building.descendants().any(|node| node.has_tag_name("main_type") && words(node) == "HOME");
    let (spaces, doors) = (Vec::new(), Vec::<SurveyedDoor>::new());
    let mut survey = Survey { spaces, walls: Vec::new(), doors, furniture: Vec::new(), is_home };
    let mut seen: Vec<&str> = Vec::new();
    for space in building.descendants().filter(|node| node.has_tag_name("space")) {
        let polygon: Vec<Point2> = child(space, "bounding_polygon")
            .into_iter()
            .flat_map(|polygon| polygon.children().filter_map(|node| point(node, meters_per_pixel)))
            .collect();
        if polygon.len() < 3 {
            continue;
        }
        let label = child(space, "labels").and_then(|labels| child(labels, "label")).map_or("", words);
        for segment in space.descendants().filter(|node| node.has_tag_name("linesegment")) {
            let says = |name| child(segment, name).map_or("", words);
            let Some(at) = segment.children().find_map(|node| point(node, meters_per_pixel)) else {
                continue;
            };
            let id = segment.attribute("id").unwrap_or_default();
            let is_known = (!id.is_empty() && seen.contains(&id))
                || survey.doors.iter().any(|door| door.at.distance(at) < SAME_PORTAL_M);
            if says("class") != "PORTAL" || is_known {
                continue;
            }
            seen.push(id);
            let features = says("features");
            survey.doors.push(SurveyedDoor {
                at,
                along: nearest_edge(&polygon, at),
                width_m: None,
                is_double: features == "DOUBLE",
                is_open: says("type") == "IMPLICIT" && !features.is_empty(),
            });
        }
        survey.spaces.push(SurveyedSpace { usage: Some(usage(label)), outline: Outline::Polygon(polygon) });
    }
    survey.checked()
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Direction of the edge of `polygon` that is nearest to `point`; edges shorter than 5 cm have none.
fn nearest_edge(polygon: &[Point2], point: Point2) -> Vec2 {
    let edges = polygon.iter().zip(polygon.iter().cycle().skip(1)).filter(|(a, b)| a.distance(**b) >= 0.05);
    let nearest =
        edges.min_by(|(a, b), (c, d)| distance_to(**a, **b, point).total_cmp(&distance_to(**c, **d, point)));
    nearest.map_or(Vec2::new(1.0, 0.0), |(&a, &b)| super::direction(a, b))
}

/// Distance from the segment from `a` to `b` to `point`.
fn distance_to(a: Point2, b: Point2, point: Point2) -> f64 {
    let (along, offset) = (b - a, point - a);
    let share = (offset.dot(along) / along.dot(along).max(1e-12)).clamp(0.0, 1.0);
    let miss = offset - along * share;
    miss.dot(miss).sqrt()
}

/// The text of `node`, without space around it.
fn words<'a>(node: Node<'a, 'a>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

/// A `point` with x and y in pixels, y down.
fn point(node: Node<'_, '_>, meters_per_pixel: f64) -> Option<Point2> {
    let coordinate = |name| Some(node.attribute(name)?.trim().parse::<f64>().ok()? * meters_per_pixel);
    node.has_tag_name("point").then_some(())?;
    Some(Point2::new(coordinate("x")?, -coordinate("y")?))
}

/// What a space with this label is used for.
fn usage(label: &str) -> Usage {
    match label {
        "CORRIDOR" => Usage::Corridor,
        "CLASSROOM" => Usage::Classroom,
        "CLOSET" | "SMALL SERVICE" | "SMALL" | "MEDIUM SERVICE" => Usage::Storage,
        "WASHROOM" | "BATHROOM" => Usage::Toilet,
        "LAB" => Usage::Laboratory,
        "KITCHEN" => Usage::Kitchen,
        "CONFERENCE" | "CONFERENCE ROOM" | "CONFERENCE HALL" => Usage::Meeting,
        "CANTEEN" | "GYM" => Usage::Hall,
        "LIBRARY" | "SHARED OFFICE" => Usage::OpenPlan,
        "STAIRS" | "ELEVATOR" => Usage::Stairs,
        "HALL" | "LOBBY" | "ENTRANCE" | "OPENSPACE" | "" => Usage::Lobby,
        _ => Usage::Office,
    }
}
