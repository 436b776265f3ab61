//! Regions, contacts and corrections against flood fill, `imageproc` and starting over.

use image::{GrayImage, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, CellGraph, FreeSpace, Grid, MapFrame, Occupancy};
use placegraph::labels::{Class, Label, LabelSet, Role};
use placegraph::regions::{
    DiagonalSteps, RegionId, Thresholds, connected, contacts, correct, label_islands, properties,
};
use placegraph_testkit::regions as oracle;
use proptest::prelude::*;

/// A map with labels on its free cells: blobs if `cell` values come in patches, noise otherwise.
#[derive(Clone, Debug)]
struct Drawn {
    graph: CellGraph,
    labels: Vec<Label>,
    image: Grid<u8>,
}

/// Values 0 (not free) and 1.. (label + 1), in patches of `patch` by `patch` cells.
fn drawn(width: u32, height: u32, patch: u32, values: &[u8]) -> Drawn {
    let across = width.div_ceil(patch);
    let at = |index: u32| values[((index / width / patch) * across + index % width / patch) as usize];
    let image = Grid::from_rows(width, height, (0..width * height).map(at).collect());
    let graph = CellGraph::new(&image.map(|&v| if v == 0 { Occupancy::Occupied } else { Occupancy::Free }));
    let labels = graph.cells().iter().map(|&cell| Label(image[cell] - 1)).collect();
    Drawn { graph, labels, image }
}

fn maps() -> impl Strategy<Value = Drawn> {
    (1u32..24, 1u32..24, 1u32..4).prop_flat_map(|(width, height, patch)| {
        prop::collection::vec(0u8..4, (width * height) as usize)
            .prop_map(move |values| drawn(width, height, patch, &values))
    })
}

fn diagonals() -> impl Strategy<Value = DiagonalSteps> {
    prop_oneof![Just(DiagonalSteps::ThroughFree), Just(DiagonalSteps::Any), Just(DiagonalSteps::Never)]
}

/// Corridor, room, doorway, and a second kind of doorway, so that doorways can be neighbors.
fn label_set() -> LabelSet {
    let mut classes = Vec::from(LabelSet::default());
    classes.push(Class { name: "gate".into(), role: Role::Doorway, color: [0; 3] });
    LabelSet::new(classes).unwrap()
}

proptest! {
    #[test]
    fn regions_equal_flood_fill(map in maps(), diagonal in diagonals()) {
        let regions = connected(&map.graph, &map.labels, diagonal);
        prop_assert_eq!(&regions, &oracle::flood_fill(&map.graph, &map.labels, diagonal));
        prop_assert_eq!(regions.labeling(), map.labels);
    }

    #[test]
    fn regions_equal_imageproc(map in maps()) {
        for (diagonal, connectivity) in
            [(DiagonalSteps::Any, Connectivity::Eight), (DiagonalSteps::Never, Connectivity::Four)]
        {
            let regions = connected(&map.graph, &map.labels, diagonal);
            // One label at a time: its union-find has room for the components of a binary image.
            for label in (0..3).map(Label) {
                let (width, height) = (map.image.width() + 2, map.image.height() + 2);
                let image = GrayImage::from_fn(width, height, |x, y| {
                    let inside = (1..width - 1).contains(&x) && (1..height - 1).contains(&y);
                    Luma([u8::from(inside && map.image[Cell::new(x - 1, y - 1)] == label.0 + 1)])
                });
                let components = connected_components(&image, connectivity, Luma([0u8]));
                let of_label = || (0..map.labels.len()).filter(|&node| map.labels[node] == label);
                let found: Vec<u32> = of_label().map(|node| regions.region_of[node].0).collect();
                let expected: Vec<u32> = of_label()
                    .map(|node| map.graph.cells()[node])
                    .map(|cell| components.get_pixel(cell.x + 1, cell.y + 1)[0])
                    .collect();
                prop_assert_eq!(renumbered(&found), renumbered(&expected));
            }
        }
    }

    #[test]
    fn contacts_equal_counting_cells(map in maps(), diagonal in diagonals()) {
        let regions = connected(&map.graph, &map.labels, diagonal);
        let found: Vec<_> =
            contacts(&map.graph, &regions).iter().map(|c| ((c.a, c.b), c.n_sides)).collect();
        let expected: Vec<_> = oracle::contact_sides(&map.graph, &regions).into_iter().collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn correction_equals_starting_over(
        map in maps(),
        diagonal in diagonals(),
        min_place_m2 in 0.0..40.0f64,
        min_doorway_m2 in 0.0..15.0f64,
        min_doorway_neighbors in 0usize..4,
    ) {
        let space = FreeSpace { frame: MapFrame::new(1.0, Pose2::default()).unwrap(), graph: map.graph.clone() };
        let thresholds = Thresholds { min_place_m2, min_doorway_m2, min_doorway_neighbors, min_island_m2: 0.0 };
        let regions = connected(&map.graph, &map.labels, diagonal);
        let found = correct(&space, &regions, &label_set(), &thresholds);
        let (expected, n_places, n_doorways) =
            oracle::correct(&map.graph, 1.0, &regions, &label_set(), &thresholds);
        prop_assert_eq!(&found.regions, &expected);
        prop_assert_eq!((found.places.n_regions, found.doorways.n_regions), (n_places, n_doorways));

        let again = correct(&space, &found.regions, &label_set(), &thresholds);
        prop_assert_eq!(&again.regions, &found.regions);
        prop_assert_eq!(again.places.n_regions + again.doorways.n_regions, 0);
    }

    /// Whatever regions are called islands.
    #[test]
    fn islands_take_the_label_that_all_pairs_of_cells_say(map in maps(), one_in in 1u32..4, first in 0u32..4) {
        let regions = connected(&map.graph, &map.labels, DiagonalSteps::default());
        let ids = (0..regions.regions.len() as u32).map(RegionId);
        let islands: Vec<RegionId> = ids.filter(|id| (id.0 + first).is_multiple_of(one_in)).collect();
        let expected = oracle::labels_of_islands(&map.graph, &regions, &islands);
        let found = label_islands(&map.graph, regions, &islands);
        let found: Vec<Label> = found.regions.iter().map(|region| region.label).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn properties_equal_sums_over_cells(map in maps(), yaw_rad in -4.0..4.0f64) {
        let frame = MapFrame::new(0.05, Pose2::new(-3.0, 7.0, yaw_rad)).unwrap();
        let regions = connected(&map.graph, &map.labels, DiagonalSteps::ThroughFree);
        for (index, found) in properties(&FreeSpace { frame, graph: map.graph.clone() }, &regions).iter().enumerate() {
            let centers: Vec<_> = (0..map.graph.n_nodes())
                .filter(|&node| regions.region_of[node].index() == index)
                .map(|node| frame.center(map.graph.cells()[node]))
                .collect();
            let n = centers.len() as f64;
            let x = centers.iter().map(|c| c.x).sum::<f64>() / n;
            let y = centers.iter().map(|c| c.y).sum::<f64>() / n;
            prop_assert!((found.centroid.x - x).abs() < 1e-9 && (found.centroid.y - y).abs() < 1e-9);
            // The trace of the second moments does not depend on the direction.
            let trace = centers.iter().map(|c| (c.x - x).powi(2) + (c.y - y).powi(2)).sum::<f64>() / n
                + 2.0 * 0.05 * 0.05 / 12.0;
            let axes = found.axes;
            prop_assert!(((axes.major_m.powi(2) + axes.minor_m.powi(2)) / 16.0 - trace).abs() < 1e-9);
            // The variance along the major axis is (major / 4)².
            let (sin, cos) = axes.direction_rad.sin_cos();
            let along =
                centers.iter().map(|c| ((c.x - x) * cos + (c.y - y) * sin).powi(2)).sum::<f64>() / n;
            prop_assert!((axes.major_m.powi(2) / 16.0 - along - 0.05 * 0.05 / 12.0).abs() < 1e-9);
        }
    }
}

/// The same partition with ids in the order of first occurrence.
fn renumbered(ids: &[u32]) -> Vec<usize> {
    let mut seen = Vec::new();
    ids.iter()
        .map(|id| {
            seen.iter().position(|other| other == id).unwrap_or_else(|| {
                seen.push(*id);
                seen.len() - 1
            })
        })
        .collect()
}
