//! Questions to a map of a hundred rooms: `cargo bench -p placegraph --bench query`.
#![allow(clippy::unwrap_used, clippy::match_same_arms, reason = "helpers of tests")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use placegraph::geom::Point2;
use placegraph::grid::{Cell, FreeSpace, Grid, GridShape, Occupancy, OccupancyGrid};
use placegraph::labels::{Label, LabelField, LabelSet};
use placegraph::regions::{DiagonalSteps, connected};
use placegraph::topology::query::{PlaceIndex, RouteIndex, find_route};
use placegraph::topology::{PlaceId, TopologicalMap, build, lay_routes};

/// Rooms on both sides of a corridor of 200 m, walls rough as in a real map.
fn office() -> (OccupancyGrid, TopologicalMap) {
    let (width, height) = (4000, 240);
    let letter = |Cell { x, y }: Cell| {
        let (in_room, door_x) = (x % 80, (30..50).contains(&(x % 80)));
        let rough = u32::from((x * 7 + y * 13) % 11 < 3);
        match y {
            0 | 239 => b'#',
            100..140 => b'c',
            97..100 | 140..143 if door_x => b'd',
            97..100 | 140..143 => b'#',
            _ if in_room < 3 + rough => b'#',
            _ => b'r',
        }
    };
    let letters: Vec<u8> = Grid::filled(width, height, ()).cells().map(letter).collect();
    let occupancy = letters.iter().map(|&c| if c == b'#' { Occupancy::Occupied } else { Occupancy::Free });
    let cells = Grid::from_rows(width, height, occupancy.collect());
    let grid = OccupancyGrid { cells, ..OccupancyGrid::from_ascii(0.05, ".") };
    let space = FreeSpace::of(&grid);
    let graph = &space.graph;
    let label = |&cell: &Cell| match letters[grid.cells.index(cell)] {
        b'c' => Label(0),
        b'r' => Label(1),
        _ => Label(2),
    };
    let labeling: Vec<Label> = graph.cells().iter().map(label).collect();
    let regions = connected(graph, &labeling, DiagonalSteps::default());
    let field = LabelField::from_rows(3, vec![1.0 / 3.0; 3 * graph.n_nodes()]);
    let mut map = build(&space, &field, &regions, &LabelSet::default());
    lay_routes(&mut map, &space, &regions, 0.0);
    (grid, map)
}

fn query(criterion: &mut Criterion) {
    let (grid, map) = office();
    let index = PlaceIndex::new(&map, GridShape::of(&grid));
    let points: Vec<Point2> = (0..1024u32)
        .map(|i| Point2::new((i * 37 % 4000) as f64 * 0.05, (i * 101 % 240) as f64 * 0.05))
        .collect();
    let mut at = points.iter().cycle();
    criterion
        .bench_function("where", |bencher| bencher.iter(|| index.locate(black_box(*at.next().unwrap()))));
    let routes = RouteIndex::new(&map);
    let n_places = map.places.len();
    let mut pair = (0..n_places).map(|i| [i, (i * 61 + 7) % n_places].map(|i| map.places[i].id)).cycle();
    criterion.bench_function("route", |bencher| {
        bencher.iter(|| {
            let [from, to] = pair.next().unwrap();
            routes.route(black_box(from), to)
        });
    });
    let last = map.places.last().map_or(PlaceId(1), |place| place.id);
    criterion.bench_function("first route", |bencher| {
        bencher.iter(|| find_route(&map, black_box(PlaceId(1)), last));
    });
    criterion.bench_function("index", |bencher| {
        bencher.iter(|| PlaceIndex::new(black_box(&map), GridShape::of(&grid)));
    });
}

criterion_group!(benches, query);
criterion_main!(benches);
