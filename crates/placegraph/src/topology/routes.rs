//! The ways between neighboring places: for every connection a line through free cells.
//!
//! One search from all stations at once gives every cell's cheapest way to the station of its own place. The
//! route of a connection crosses the common border where the two ways together are cheapest, and is then pulled
//! straight. Steps near walls cost more, up to twice as much at the wall itself. A robot with a radius keeps it: cells nearer to
//! a wall are not entered, and every straight part is checked exactly. [`shortcuts`] then joins doors of one place.
//!
//! Cost: two searches over the free cells, linear in them but for sorting those of equal cost; the pulling looks some tens of
//! times along every straight part of a route. Memory: 8 bytes a node.

mod approach;
mod pull;
mod queue;
mod shortcuts;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use rayon::prelude::*;

use self::queue::Queue;
use super::body::Body;
use super::{PlaceId, Route, TopologicalMap};
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity, FreeSpace, NO_NODE};
use crate::regions::{RegionId, RegionMap};
pub use approach::{Approach, approaches};

/// Walls farther than this do not make a step dearer, in meters.
pub const COMFORT_M: f64 = 0.5;

/// Cost of a straight and of a diagonal step far from walls.
const STRAIGHT: u32 = 1000;
const DIAGONAL: u32 = 1414;

/// Not reached by the search.
const UNREACHED: u32 = u32::MAX;

/// Computes the routes of all connections of `map`, whose place number i + 1 is region i, for the center of a robot that needs
/// `radius_m` meters on all sides; 0 for a point.
///
/// A route stays within its two places. Where that is impossible (cells that meet at a corner only) that of a point may
/// touch others; where there is no way at all the connection has no route.
pub fn lay_routes(map: &mut TopologicalMap, space: &FreeSpace, regions: &RegionMap, radius_m: f64) {
    let walks = Walks::new(map, space, regions, radius_m);
    let portals = walks.portals();
    for connection in &mut map.connections {
        let pair = [connection.a, connection.b].map(region_of);
        let path = match portals.get(&(pair[0], pair[1])) {
            Some(portal) => Some(walks.path_through(portal.nodes)),
            None if walks.passable.is_some() => None,
            None => walks.detour(pair),
        };
        connection.route = path.map(|path| walks.route(&path, &pair, space));
    }
    map.shortcuts = shortcuts::lay(map, walks, &portals, space);
}

/// The region of a place, before places get the numbers of an earlier result.
fn region_of(place: PlaceId) -> RegionId {
    RegionId(place.0 - 1)
}

/// The cheapest pair of neighboring cells on the two sides of a border.
struct Portal {
    cost: u32,
    nodes: [usize; 2],
}

/// The cheapest crossings of all borders, by what lies on both sides, the smaller first.
type Portals<K> = BTreeMap<(K, K), Portal>;

/// Every node's cheapest way to the station of its region.
struct Walks<'a> {
    graph: &'a CellGraph,
    body: Body<'a>,
    /// What the robot needs on all sides, in cells.
    radius: f64,
    /// Where it has that; `None` for a point, which is everywhere.
    passable: Option<Vec<bool>>,
    regions: &'a RegionMap,
    /// Node of each region's station.
    stations: Vec<usize>,
    /// Cells to the nearest wall along the larger coordinate, at most `comfort`.
    clearance: Vec<u8>,
    comfort: u8,
    cost: Vec<AtomicU32>,
    /// Position in the steps of [`Connectivity::Eight`] that leads back towards the station.
    back: Vec<AtomicU8>,
}

impl<'a> Walks<'a> {
    fn new(map: &TopologicalMap, space: &'a FreeSpace, regions: &'a RegionMap, radius_m: f64) -> Self {
        let stations = map.places.iter().map(|place| {
            let region = RegionId(place.id.0 - 1);
            let center = place.doorway.as_ref().map(|doorway| doorway.jambs[0].midpoint(doorway.jambs[1]));
            center
                .and_then(|center| node_near(space, center))
                .filter(|&node| regions.region_of[node] == region)
                .or_else(|| node_near(space, place.anchor))
                .unwrap_or_default()
        });
        Self::from_stations(stations.collect(), space, regions, radius_m)
    }

    /// Searches from `stations`, the node of each region's station.
    fn from_stations(
        mut stations: Vec<usize>,
        space: &'a FreeSpace,
        regions: &'a RegionMap,
        radius_m: f64,
    ) -> Self {
        let graph = &space.graph;
        let radius = space.in_cells(radius_m);
        let body = Body { graph };
        let passable = (radius > 0.0).then(|| body.passable(radius));
        let comfort = space.in_cells(COMFORT_M).ceil().clamp(1.0, 255.0) as u8;
        if let Some(passable) = &passable {
            move_to_passable(&mut stations, graph, regions, passable);
        }
        let walks = Self {
            graph,
            body,
            radius,
            passable,
            regions,
            stations,
            clearance: clearance(graph, comfort),
            comfort,
            cost: (0..graph.n_nodes()).map(|_| AtomicU32::new(UNREACHED)).collect(),
            back: (0..graph.n_nodes()).map(|_| AtomicU8::new(0)).collect(),
        };
        walks.search_from_stations();
        walks
    }

    /// Searches from the station of every region, regions in parallel: no two write to one place.
    fn search_from_stations(&self) {
        let regions = self.stations.par_iter().enumerate();
        regions.for_each_init(Queue::new, |queue, (region, &station)| {
            if self.regions.region_of[station].index() == region && self.is_passable(station) {
                self.search(queue, RegionId(region as u32), &[station], |_, _| ());
            }
        });
    }

    /// Dijkstra's search from `sources` to all nodes of `region`. `reach` is called for
    /// every node that is reached, with the node before it.
    fn search(&self, queue: &mut Queue, region: RegionId, sources: &[usize], reach: impl Fn(usize, usize)) {
        for &source in sources {
            self.cost[source].store(0, Ordering::Relaxed);
        }
        queue.start(sources.iter().map(|&source| self.position(source)));
        while let Some((so_far, position)) = queue.pop() {
            let around = self.around(position);
            let node = around[1][1] as usize;
            if so_far > self.cost_of(node) {
                continue;
            }
            for (step, next, step_cost) in self.steps(around) {
                let total = so_far.saturating_add(step_cost);
                if self.regions.region_of[next] == region && total < self.cost_of(next) {
                    self.cost[next].store(total, Ordering::Relaxed);
                    self.back[next].store(opposite(step), Ordering::Relaxed);
                    reach(next, node);
                    queue.push(total, self.beside(position, step));
                }
            }
        }
    }

    fn cost_of(&self, node: usize) -> u32 {
        self.cost[node].load(Ordering::Relaxed)
    }

    /// The row-major position of a node's cell: in the same order as the nodes, and its neighbors are found sooner.
    fn position(&self, node: usize) -> u32 {
        let cell = self.graph.cell(node);
        cell.y * self.graph.width() + cell.x
    }

    fn is_passable(&self, node: usize) -> bool {
        self.passable.as_ref().is_none_or(|passable| passable[node])
    }

    /// The position one step away, which is in the map.
    fn beside(&self, position: u32, step: usize) -> u32 {
        let (x, y) = Connectivity::Eight.steps()[step];
        position.wrapping_add_signed(y * self.graph.width() as i32 + x)
    }

    fn around(&self, position: u32) -> [[u32; 3]; 3] {
        self.graph.around(Cell::new(position % self.graph.width(), position / self.graph.width()))
    }

    /// The steps from the cell in the middle of `around`: number in the steps of [`Connectivity::Eight`], the node there, the cost. A
    /// diagonal step needs both cells beside it to be free.
    fn steps(&self, around: [[u32; 3]; 3]) -> impl Iterator<Item = (usize, usize, u32)> + '_ {
        let steps = Connectivity::Eight.steps().iter().enumerate();
        steps.filter_map(move |(number, &step)| {
            let at = |x: i32, y: i32| around[(y + 1) as usize][(x + 1) as usize];
            let (x, y) = step;
            let next = at(x, y);
            let is_cut = next == NO_NODE || at(x, 0) == NO_NODE || at(0, y) == NO_NODE;
            let is_open = !is_cut && self.is_passable(next as usize);
            is_open.then(|| (number, next as usize, self.step_cost(next as usize, step)))
        })
    }

    fn step_cost(&self, to: usize, step: (i32, i32)) -> u32 {
        let length = if step.0 != 0 && step.1 != 0 { DIAGONAL } else { STRAIGHT };
        let comfort = self.comfort as u32;
        length * (2 * comfort - self.clearance[to] as u32) / comfort
    }

    /// The cheapest crossing of every border between two regions.
    fn portals(&self) -> Portals<RegionId> {
        self.crossings(|nodes| Some(nodes.map(|node| self.regions.region_of[node])))
    }

    /// The cheapest crossing of every border between nodes of different `sides`.
    fn crossings<K: Copy + Ord>(&self, sides: impl Fn([usize; 2]) -> Option<[K; 2]>) -> Portals<K> {
        let mut portals = Portals::new();
        let width = self.graph.width() as usize;
        let (mut row, mut above) = (vec![NO_NODE; width], vec![NO_NODE; width]);
        self.graph.fill_row(0, &mut above);
        for y in 0..self.graph.height() {
            std::mem::swap(&mut row, &mut above);
            if y + 1 < self.graph.height() {
                self.graph.fill_row(y + 1, &mut above);
            } else {
                above.fill(NO_NODE);
            }
            for x in (0..width).filter(|&x| row[x] != NO_NODE) {
                let right = row.get(x + 1).copied().unwrap_or(NO_NODE);
                for (step, next) in [((1, 0), right), ((0, 1), above[x])] {
                    if next == NO_NODE {
                        continue;
                    }
                    let nodes = [row[x] as usize, next as usize];
                    if let Some(sides) = sides(nodes).filter(|[here, there]| here != there) {
                        self.add_portal(&mut portals, nodes, sides, step);
                    }
                }
            }
        }
        portals
    }

    /// Adds the crossing between two neighboring nodes if it is the cheapest of its border so far.
    fn add_portal<K: Copy + Ord>(
        &self,
        portals: &mut Portals<K>,
        [node, next]: [usize; 2],
        [here, there]: [K; 2],
        step: (i32, i32),
    ) {
        let [cost_here, cost_there] = [node, next].map(|node| self.cost_of(node));
        if cost_here == UNREACHED || cost_there == UNREACHED {
            return;
        }
        let cost = cost_here.saturating_add(cost_there).saturating_add(self.step_cost(next, step));
        let nodes = if here < there { [node, next] } else { [next, node] };
        let pair = (here.min(there), here.max(there));
        let best = portals.entry(pair).or_insert(Portal { cost: UNREACHED, nodes });
        if cost < best.cost {
            *best = Portal { cost, nodes };
        }
    }

    /// From the station of the first node's region through both nodes to the station of the second's.
    fn path_through(&self, nodes: [usize; 2]) -> Vec<usize> {
        let mut path = self.way_back(nodes[0]);
        path.reverse();
        path.extend(self.way_back(nodes[1]));
        path
    }

    /// The nodes from `node` to where the search of its region began.
    fn way_back(&self, node: usize) -> Vec<usize> {
        self.walk_back(node, |node| (self.cost_of(node) > 0).then(|| self.back[node].load(Ordering::Relaxed)))
    }

    /// The route along `path`, which touches only cells of `regions`.
    fn route(&self, path: &[usize], regions: &[RegionId], space: &FreeSpace) -> Route {
        let line = self.pulled_straight(path, regions);
        let clearance = self.body.clearance(&line, self.radius.max(f64::from(self.comfort)));
        let line = line.into_iter().map(|point| space.frame.map_from_cells(point)).collect();
        Route { clearance_m: Some(clearance * space.resolution_m()), ..Route::along(line) }
    }

    /// From station to station through whatever is free. Cost: that of the cells that are nearer; these stand in a tree, so that
    /// a short way costs nothing for the rest of the map.
    fn detour(&self, pair: [RegionId; 2]) -> Option<Vec<usize>> {
        let [from, to] = pair.map(|region| self.stations[region.index()]);
        let mut reached = BTreeMap::from([(to, (0, 0))]);
        let mut queue = Queue::new();
        queue.start([self.position(to)]);
        while let Some((so_far, position)) = queue.pop() {
            let around = self.around(position);
            let node = around[1][1] as usize;
            if so_far > reached[&node].0 {
                continue;
            }
            if node == from {
                let way =
                    |node: usize| reached.get(&node).filter(|(cost, _)| *cost > 0).map(|(_, back)| *back);
                return Some(self.walk_back(from, way));
            }
            for (step, next, step_cost) in self.steps(around) {
                let total = so_far.saturating_add(step_cost);
                let known = reached.entry(next).or_insert((UNREACHED, 0));
                if total < known.0 {
                    *known = (total, opposite(step));
                    queue.push(total, self.beside(position, step));
                }
            }
        }
        None
    }

    /// The nodes from `node` to the station that its way leads to; `way` gives the step from a node on it.
    fn walk_back(&self, node: usize, way: impl Fn(usize) -> Option<u8>) -> Vec<usize> {
        let mut path = vec![node];
        let mut last = node;
        while let Some(position) = way(last) {
            let step = Connectivity::Eight.steps()[position as usize];
            let Some(next) = self.graph.node_at_step(last, step) else { break };
            path.push(next);
            last = next;
        }
        path
    }
}

/// Moves stations that are not passable to the nearest node of their region that is; of equally near ones to the first.
fn move_to_passable(stations: &mut [usize], graph: &CellGraph, regions: &RegionMap, passable: &[bool]) {
    let wanted: Vec<Option<Cell>> =
        stations.iter().map(|&station| (!passable[station]).then(|| graph.cell(station))).collect();
    let mut nearest = vec![u64::MAX; stations.len()];
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        let region = regions.region_of[node].index();
        let Some(from) = wanted[region].filter(|_| passable[node]) else { continue };
        let squared = u64::from(cell.x.abs_diff(from.x)).pow(2) + u64::from(cell.y.abs_diff(from.y)).pow(2);
        if squared < nearest[region] {
            nearest[region] = squared;
            stations[region] = node;
        }
    }
}

/// The node of the cell that contains `point`.
fn node_near(space: &FreeSpace, point: Point2) -> Option<usize> {
    let FreeSpace { frame, graph } = space;
    frame
        .cell_at(point)
        .filter(|cell| cell.x < graph.width() && cell.y < graph.height())
        .and_then(|cell| graph.node_at(cell))
}

/// Chessboard distance of every node to the nearest cell that is not free, at most `most`: two sweeps.
fn clearance(graph: &CellGraph, most: u8) -> Vec<u8> {
    let mut clearance = vec![most; graph.n_nodes()];
    let width = graph.width() as usize;
    // The row before, with a column that is not free at both ends.
    let (mut before, mut row, mut nodes) = (vec![0u8; width + 2], vec![0; width + 2], vec![NO_NODE; width]);
    let mut sweep = |rows: &mut dyn Iterator<Item = u32>, columns: &dyn Fn(usize) -> usize, back: isize| {
        before.fill(0);
        for y in rows {
            graph.fill_row(y, &mut nodes);
            row.fill(0);
            for x in (0..width).map(columns).filter(|&x| nodes[x] != NO_NODE) {
                let beside = row[(x + 1).wrapping_add_signed(back)];
                let nearest = before[x].min(before[x + 1]).min(before[x + 2]).min(beside);
                let own = &mut clearance[nodes[x] as usize];
                *own = nearest.saturating_add(1).min(*own);
                row[x + 1] = *own;
            }
            std::mem::swap(&mut before, &mut row);
        }
    };
    sweep(&mut (0..graph.height()), &|x| x, -1);
    sweep(&mut (0..graph.height()).rev(), &|x| width - 1 - x, 1);
    clearance
}

/// The step back: the steps are symmetric, and the opposite stands at the mirrored number.
fn opposite(step: usize) -> u8 {
    (Connectivity::Eight.steps().len() - 1 - step) as u8
}
