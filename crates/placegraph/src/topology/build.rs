//! From regions to the topological map (Sect. 4.7): a place per region, a connection per pair of regions that touch.
//!
//! Cost: linear in nodes and border sides.

use rayon::prelude::*;

use super::clearance::{anchors, clearance_cells};
use super::opening::{Opening, opening};
use super::outline::outlines;
use super::routes::lay_routes;
use super::{Connection, Doorway, Place, PlaceId, PolygonWithHoles, TopologicalMap};
use crate::geom::Point2;
use crate::grid::FreeSpace;
use crate::labels::{LabelField, LabelSet, Role};
use crate::regions::{Contact, RegionId, RegionMap, contacts, properties};

/// The topological map of `regions`. Place numbers are region ids + 1; geometry is in the map frame.
///
/// Routes are those of a point; [`super::lay_routes`] lays those of a robot with a radius.
///
/// `field` gives the probability of a place: the mean over its cells of the probability of its label.
///
/// # Examples
/// ```
/// use placegraph::grid::{FreeSpace, Grid, OccupancyGrid};
/// use placegraph::labels::{Label, LabelField, LabelSet};
/// use placegraph::regions::{DiagonalSteps, connected};
/// use placegraph::topology::build;
///
/// let drawing = "
///     rrr#cccc
///     rrrdcccc
///     rrr#cccc
/// ";
/// let space = FreeSpace::of(&OccupancyGrid::from_ascii(0.5, &drawing.replace(['c', 'r', 'd'], ".")));
/// let letters = Grid::from_ascii(drawing, |letter| letter);
/// let label = |letter| Label("crd".find(letter).unwrap_or_default() as u8);
/// let labels: Vec<Label> = space.graph.cells().iter().map(|&cell| label(letters[cell])).collect();
/// let regions = connected(&space.graph, &labels, DiagonalSteps::default());
/// let field = LabelField::from_rows(3, [0.2, 0.6, 0.2].repeat(labels.len()));
/// let map = build(&space, &field, &regions, &LabelSet::default());
/// let names: Vec<&str> = map.places.iter().map(|place| place.name.as_str()).collect();
/// assert_eq!(names, ["room 1", "corridor 2", "doorway 3"]);
/// let pairs: Vec<(u32, u32)> = map.connections.iter().map(|c| (c.a.0, c.b.0)).collect();
/// assert_eq!(pairs, [(1, 3), (2, 3)]);
/// ```
///
/// # Panics
/// If `field` or `regions` do not belong to `space`, or a label is not of `label_set`.
pub fn build(
    space: &FreeSpace,
    field: &LabelField,
    regions: &RegionMap,
    label_set: &LabelSet,
) -> TopologicalMap {
    let FreeSpace { frame, graph } = space;
    let properties = properties(space, regions);
    let contacts = contacts(graph, regions);
    let centroids: Vec<Point2> = properties.iter().map(|p| frame.cells_from_map(p.centroid)).collect();
    let (outlines, (anchors, probabilities)) = rayon::join(
        || outlines(space, regions),
        || (anchors(graph, regions, &centroids), mean_probabilities(field, regions)),
    );
    let neighbors = neighbors_by_contact(regions, &contacts);

    let place = |(index, outline): (usize, Vec<PolygonWithHoles>)| {
        let region = regions.regions[index];
        let class = label_set.class(region.label);
        let id = place_id(RegionId(index as u32));
        let anchor = graph.cell(anchors[index]);
        let doorway = (class.role == Role::Doorway).then(|| {
            let is_own = |node: usize| regions.region_of[node].index() == index;
            doorway(space, is_own, &neighbors[index], centroids[index], anchor.center())
        });
        Place {
            id,
            name: format!("{} {}", class.name, id.0),
            class: class.name.clone(),
            role: class.role,
            probability: probabilities[index],
            n_cells: region.n_cells,
            area_m2: properties[index].area_m2,
            centroid: properties[index].centroid,
            axes: properties[index].axes,
            anchor: frame.center(anchor),
            clearance_m: clearance_cells(graph, regions, anchors[index]) * frame.resolution_m(),
            outline,
            doorway,
            cut_off: false,
        }
    };
    let connection = |contact: &Contact| Connection {
        a: place_id(contact.a),
        b: place_id(contact.b),
        contact_m: contact.n_sides as f64 * frame.resolution_m(),
        middle: frame.map_from_cells(contact.middle),
        route: None,
    };
    let mut map = TopologicalMap {
        places: outlines.into_par_iter().enumerate().map(place).collect(),
        connections: contacts.iter().map(connection).collect(),
        shortcuts: Vec::new(),
        last_id: PlaceId(regions.regions.len() as u32),
    };
    lay_routes(&mut map, space, regions, 0.0);
    map
}

/// The number that [`build`] gives the place of `region`.
pub(crate) fn place_id(region: RegionId) -> PlaceId {
    PlaceId(region.0 + 1)
}

/// Mean over every region's cells of the probability of its label.
fn mean_probabilities(field: &LabelField, regions: &RegionMap) -> Vec<f64> {
    let mut sums = vec![0.0; regions.regions.len()];
    for (node, id) in regions.region_of.iter().enumerate() {
        let label = regions.regions[id.index()].label;
        sums[id.index()] += field.row(node)[label.index()] as f64;
    }
    sums.iter().zip(&regions.regions).map(|(sum, region)| sum / region.n_cells as f64).collect()
}

/// For every region its neighbors and the mean of the common border in cells, longest contact first (ties:
/// larger area, then lower id).
fn neighbors_by_contact(regions: &RegionMap, contacts: &[Contact]) -> Vec<Vec<(RegionId, Point2)>> {
    let mut of_region: Vec<Vec<(&Contact, RegionId)>> = vec![Vec::new(); regions.regions.len()];
    for contact in contacts {
        of_region[contact.a.index()].push((contact, contact.b));
        of_region[contact.b.index()].push((contact, contact.a));
    }
    of_region
        .into_iter()
        .map(|mut neighbors| {
            neighbors.sort_by_key(|&(contact, id)| {
                std::cmp::Reverse((contact.n_sides, regions.regions[id.index()].n_cells))
            });
            neighbors.into_iter().map(|(contact, id)| (id, contact.mean)).collect()
        })
        .collect()
}

/// The opening between the two neighbors with the longest contact. With one neighbor, the way through is
/// taken to go straight on over the centroid; with none, every direction is looked at from the anchor.
fn doorway(
    space: &FreeSpace,
    is_own: impl Fn(usize) -> bool,
    neighbors: &[(RegionId, Point2)],
    centroid: Point2,
    anchor: Point2,
) -> Doorway {
    let FreeSpace { frame, graph } = space;
    let (from, to) = match neighbors {
        [] => (anchor, anchor),
        [(_, border)] => (*border, centroid + (centroid - *border)),
        [(_, border), (_, opposite), ..] => (*border, *opposite),
    };
    let Opening { width_cells, jambs } = opening(graph, is_own, from, to, anchor);
    Doorway {
        width_m: width_cells * frame.resolution_m(),
        jambs: jambs.map(|jamb| frame.map_from_cells(jamb)),
        sides: neighbors.iter().map(|&(id, _)| place_id(id)).collect(),
    }
}
