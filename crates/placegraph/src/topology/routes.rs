//! The ways between neighboring places: for every connection a line through free cells.
//!
//! One search from all stations at once gives every cell's cheapest way to the station of its own place. The
//! route of a connection crosses the common border where the two ways together are cheapest, and is then pulled
//! straight. Steps near walls cost more, up to twice as much at the wall itself.
//!
//! Cost: one search over the free cells, `O(n log n)`; the pulling is quadratic in the cells of a route.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::segment::all_touched;
use super::{Route, TopologicalMap};
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity, MapFrame};
use crate::regions::{RegionId, RegionMap};

/// Walls farther than this do not make a step dearer, in meters.
pub const COMFORT_M: f64 = 0.5;

/// Cost of a straight and of a diagonal step far from walls.
const STRAIGHT: u32 = 1000;
const DIAGONAL: u32 = 1414;

/// Not reached by the search.
const UNREACHED: u32 = u32::MAX;

/// Computes the routes of all connections of `map`, whose place number i + 1 is region i.
///
/// A route stays within its two places. Where that is impossible (cells that meet at a corner only) it may
/// touch others; where there is no way at all the connection has no route.
pub fn lay_routes(map: &mut TopologicalMap, frame: &MapFrame, graph: &CellGraph, regions: &RegionMap) {
    let walks = Walks::new(map, frame, graph, regions);
    let portals = walks.portals();
    for connection in &mut map.connections {
        let pair = [connection.a, connection.b].map(|place| RegionId(place.0 - 1));
        let path = match portals.get(&(pair[0], pair[1])) {
            Some(portal) => Some(walks.path_through(portal.nodes)),
            None => walks.detour(pair),
        };
        connection.route = path.map(|path| {
            let line = walks.pulled_straight(&path, pair);
            Route::along(line.into_iter().map(|point| frame.map_from_cells(point)).collect())
        });
    }
}

/// The cheapest pair of neighboring cells on the two sides of a border.
struct Portal {
    cost: u32,
    nodes: [usize; 2],
}

/// Every node's cheapest way to the station of its region.
struct Walks<'a> {
    graph: &'a CellGraph,
    regions: &'a RegionMap,
    /// Node of each region's station.
    stations: Vec<usize>,
    /// Cells to the nearest wall along the larger coordinate, at most `comfort`.
    clearance: Vec<u8>,
    comfort: u8,
    cost: Vec<u32>,
    /// Position in the steps of [`Connectivity::Eight`] that leads back towards the station.
    back: Vec<u8>,
}

impl<'a> Walks<'a> {
    fn new(map: &TopologicalMap, frame: &MapFrame, graph: &'a CellGraph, regions: &'a RegionMap) -> Self {
        let comfort = (COMFORT_M / frame.resolution_m()).ceil().clamp(1.0, 255.0) as u8;
        let stations = map.places.iter().map(|place| {
            let region = RegionId(place.id.0 - 1);
            let center = place.doorway.as_ref().map(|doorway| doorway.jambs[0].midpoint(doorway.jambs[1]));
            center
                .and_then(|center| node_near(frame, graph, center))
                .filter(|&node| regions.region_of[node] == region)
                .or_else(|| node_near(frame, graph, place.anchor))
                .unwrap_or_default()
        });
        let mut walks = Self {
            graph,
            regions,
            stations: stations.collect(),
            clearance: clearance(graph, comfort),
            comfort,
            cost: Vec::new(),
            back: Vec::new(),
        };
        (walks.cost, walks.back) = walks.search(&walks.stations, None, |from, to| {
            walks.regions.region_of[from] == walks.regions.region_of[to]
        });
        walks
    }

    /// Dijkstra's search from `sources` along steps that `may_step` allows, until `target` is reached.
    fn search(
        &self,
        sources: &[usize],
        target: Option<usize>,
        may_step: impl Fn(usize, usize) -> bool,
    ) -> (Vec<u32>, Vec<u8>) {
        let mut cost = vec![UNREACHED; self.graph.n_nodes()];
        let mut back = vec![0; self.graph.n_nodes()];
        let mut queue = BinaryHeap::new();
        for &source in sources {
            cost[source] = 0;
            queue.push(Reverse((0, source)));
        }
        while let Some(Reverse((so_far, node))) = queue.pop() {
            if so_far > cost[node] {
                continue;
            }
            if target == Some(node) {
                break;
            }
            for (position, &step) in Connectivity::Eight.steps().iter().enumerate() {
                let Some(next) = self.step(node, step).filter(|&next| may_step(node, next)) else { continue };
                let total = so_far.saturating_add(self.step_cost(next, step));
                if total < cost[next] {
                    cost[next] = total;
                    // The steps are symmetric: the opposite stands at the mirrored position.
                    back[next] = (Connectivity::Eight.steps().len() - 1 - position) as u8;
                    queue.push(Reverse((total, next)));
                }
            }
        }
        (cost, back)
    }

    /// The node one `step` away; a diagonal step needs both cells beside it to be free.
    fn step(&self, node: usize, step: (i32, i32)) -> Option<usize> {
        let next = self.graph.node_at_step(node, step)?;
        if step.0 != 0 && step.1 != 0 {
            self.graph.node_at_step(node, (step.0, 0))?;
            self.graph.node_at_step(node, (0, step.1))?;
        }
        Some(next)
    }

    fn step_cost(&self, to: usize, step: (i32, i32)) -> u32 {
        let length = if step.0 != 0 && step.1 != 0 { DIAGONAL } else { STRAIGHT };
        let comfort = self.comfort as u32;
        length * (2 * comfort - self.clearance[to] as u32) / comfort
    }

    /// The cheapest crossing of every border between two regions.
    fn portals(&self) -> BTreeMap<(RegionId, RegionId), Portal> {
        let mut portals: BTreeMap<(RegionId, RegionId), Portal> = BTreeMap::new();
        for node in 0..self.graph.n_nodes() {
            for step in [(1, 0), (0, 1)] {
                let Some(next) = self.graph.node_at_step(node, step) else { continue };
                let [here, there] = [node, next].map(|node| self.regions.region_of[node]);
                if here == there || self.cost[node] == UNREACHED || self.cost[next] == UNREACHED {
                    continue;
                }
                let cost = self.cost[node]
                    .saturating_add(self.cost[next])
                    .saturating_add(self.step_cost(next, step));
                let nodes = if here < there { [node, next] } else { [next, node] };
                let best = portals
                    .entry((here.min(there), here.max(there)))
                    .or_insert(Portal { cost: UNREACHED, nodes });
                if cost < best.cost {
                    *best = Portal { cost, nodes };
                }
            }
        }
        portals
    }

    /// From the station of the first node's region through both nodes to the station of the second's.
    fn path_through(&self, nodes: [usize; 2]) -> Vec<usize> {
        let mut path = self.walk_back(nodes[0], &self.cost, &self.back);
        path.reverse();
        path.extend(self.walk_back(nodes[1], &self.cost, &self.back));
        path
    }

    /// From station to station through whatever is free.
    fn detour(&self, pair: [RegionId; 2]) -> Option<Vec<usize>> {
        let [from, to] = pair.map(|region| self.stations[region.index()]);
        let (cost, back) = self.search(&[to], Some(from), |_, _| true);
        (cost[from] != UNREACHED).then(|| self.walk_back(from, &cost, &back))
    }

    /// The nodes from `node` to the station that its way leads to.
    fn walk_back(&self, node: usize, cost: &[u32], back: &[u8]) -> Vec<usize> {
        let mut path = vec![node];
        let mut last = node;
        while cost[last] > 0 {
            let step = Connectivity::Eight.steps()[back[last] as usize];
            let Some(next) = self.graph.node_at_step(last, step) else { break };
            path.push(next);
            last = next;
        }
        path
    }

    /// The corners that remain when `path` is replaced by straight lines as long as these touch only cells of
    /// the two regions, none nearer to a wall than the cells they replace. In cells.
    fn pulled_straight(&self, path: &[usize], pair: [RegionId; 2]) -> Vec<Point2> {
        let center = |position: usize| {
            let cell = self.graph.cells()[path[position]];
            Point2::new(cell.x as f64 + 0.5, cell.y as f64 + 0.5)
        };
        let mut line = vec![center(0)];
        let mut corner = 0;
        while corner + 1 < path.len() {
            let mut reach = corner + 1;
            let mut tightest = self.clearance[path[corner]].min(self.clearance[path[reach]]);
            for position in corner + 2..path.len() {
                tightest = tightest.min(self.clearance[path[position]]);
                let visible = all_touched(center(corner), center(position), |x, y| {
                    self.node_in(pair, x, y).is_some_and(|node| self.clearance[node] >= tightest)
                });
                if visible {
                    reach = position;
                } else if position > reach + GIVE_UP {
                    break;
                }
            }
            line.push(center(reach));
            corner = reach;
        }
        line
    }

    /// The node in column `x` and row `y` if it belongs to one of two regions.
    fn node_in(&self, pair: [RegionId; 2], x: i64, y: i64) -> Option<usize> {
        let cell = Cell::new(u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        let inside = cell.x < self.graph.width() && cell.y < self.graph.height();
        let node = if inside { self.graph.node_at(cell)? } else { return None };
        pair.contains(&self.regions.region_of[node]).then_some(node)
    }
}

/// How many cells beyond the last visible one are tried before a corner is set.
const GIVE_UP: usize = 16;

/// The node of the cell that contains `point`.
fn node_near(frame: &MapFrame, graph: &CellGraph, point: Point2) -> Option<usize> {
    frame
        .cell_at(point)
        .filter(|cell| cell.x < graph.width() && cell.y < graph.height())
        .and_then(|cell| graph.node_at(cell))
}

/// Chessboard distance of every node to the nearest cell that is not free, at most `most`: two sweeps.
fn clearance(graph: &CellGraph, most: u8) -> Vec<u8> {
    let mut clearance = vec![most; graph.n_nodes()];
    let near = |clearance: &[u8], node: usize, steps: &mut dyn Iterator<Item = (i32, i32)>| {
        steps
            .map(|step| graph.node_at_step(node, step).map_or(1, |next| clearance[next].saturating_add(1)))
            .min()
    };
    for node in 0..graph.n_nodes() {
        let mut steps = Connectivity::Eight.steps_back().iter().copied();
        let nearest = near(&clearance, node, &mut steps);
        clearance[node] = clearance[node].min(nearest.unwrap_or(most));
    }
    for node in (0..graph.n_nodes()).rev() {
        let mut steps = Connectivity::Eight.steps_back().iter().map(|step| (-step.0, -step.1));
        let nearest = near(&clearance, node, &mut steps);
        clearance[node] = clearance[node].min(nearest.unwrap_or(most));
    }
    clearance
}
