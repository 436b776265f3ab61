//! The ways between neighboring places: for every connection a line through free cells.
//!
//! One search from all stations at once gives every cell's cheapest way to the station of its own place. The
//! route of a connection crosses the common border where the two ways together are cheapest, and is then pulled
//! straight. Steps near walls cost more, up to twice as much at the wall itself. A robot with a radius keeps it: cells nearer to
//! a wall are not entered, and every straight part is checked exactly.
//!
//! Cost: one search over the free cells, linear in them but for sorting those of equal cost; the pulling looks some tens of
//! times along every straight part of a route. Memory: 6 bytes a node.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use rayon::prelude::*;

use super::body::Body;
use super::segment::all_touched;
use super::{Route, TopologicalMap};
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Connectivity, FreeSpace, NO_NODE};
use crate::regions::{RegionId, RegionMap};

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
        let pair = [connection.a, connection.b].map(|place| RegionId(place.0 - 1));
        let path = match portals.get(&(pair[0], pair[1])) {
            Some(portal) => Some(walks.path_through(portal.nodes)),
            None if walks.passable.is_some() => None,
            None => walks.detour(pair),
        };
        connection.route = path.map(|path| {
            let line = walks.pulled_straight(&path, pair);
            let clearance = walks.body.clearance(&line, walks.radius.max(f64::from(walks.comfort)));
            let line = line.into_iter().map(|point| space.frame.map_from_cells(point)).collect();
            Route { clearance_m: Some(clearance * space.resolution_m()), ..Route::along(line) }
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
    cost: Vec<u32>,
    /// Position in the steps of [`Connectivity::Eight`] that leads back towards the station.
    back: Vec<u8>,
}

impl<'a> Walks<'a> {
    fn new(map: &TopologicalMap, space: &'a FreeSpace, regions: &'a RegionMap, radius_m: f64) -> Self {
        let graph = &space.graph;
        let radius = space.in_cells(radius_m);
        let body = Body { graph };
        let passable = (radius > 0.0).then(|| body.passable(radius));
        let comfort = space.in_cells(COMFORT_M).ceil().clamp(1.0, 255.0) as u8;
        let stations = map.places.iter().map(|place| {
            let region = RegionId(place.id.0 - 1);
            let center = place.doorway.as_ref().map(|doorway| doorway.jambs[0].midpoint(doorway.jambs[1]));
            center
                .and_then(|center| node_near(space, center))
                .filter(|&node| regions.region_of[node] == region)
                .or_else(|| node_near(space, place.anchor))
                .unwrap_or_default()
        });
        let mut stations: Vec<usize> = stations.collect();
        if let Some(passable) = &passable {
            move_to_passable(&mut stations, graph, regions, passable);
        }
        let mut walks = Self {
            graph,
            body,
            radius,
            passable,
            regions,
            stations,
            clearance: clearance(graph, comfort),
            comfort,
            cost: Vec::new(),
            back: Vec::new(),
        };
        (walks.cost, walks.back) = walks.search();
        walks
    }

    /// Dijkstra's search from the station of every region to all its nodes, regions in parallel: no two write to one place.
    fn search(&self) -> (Vec<u32>, Vec<u8>) {
        let cost: Vec<_> = (0..self.graph.n_nodes()).map(|_| AtomicU32::new(UNREACHED)).collect();
        let back: Vec<_> = (0..self.graph.n_nodes()).map(|_| AtomicU8::new(0)).collect();
        let regions = self.stations.par_iter().enumerate();
        regions
            .filter(|&(region, &station)| self.regions.region_of[station].index() == region)
            .filter(|&(_, &station)| self.is_passable(station))
            .for_each_init(Queue::new, |queue, (region, &station)| {
                cost[station].store(0, Ordering::Relaxed);
                queue.start(self.position(station));
                while let Some((so_far, position)) = queue.pop() {
                    let around = self.around(position);
                    if so_far > cost[around[1][1] as usize].load(Ordering::Relaxed) {
                        continue;
                    }
                    for (step, next, step_cost) in self.steps(around) {
                        let total = so_far.saturating_add(step_cost);
                        let is_own = self.regions.region_of[next].index() == region;
                        if is_own && total < cost[next].load(Ordering::Relaxed) {
                            cost[next].store(total, Ordering::Relaxed);
                            back[next].store(opposite(step), Ordering::Relaxed);
                            queue.push(total, self.beside(position, step));
                        }
                    }
                }
            });
        let cost = cost.into_iter().map(AtomicU32::into_inner).collect();
        (cost, back.into_iter().map(AtomicU8::into_inner).collect())
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
    fn portals(&self) -> BTreeMap<(RegionId, RegionId), Portal> {
        let mut portals: BTreeMap<(RegionId, RegionId), Portal> = BTreeMap::new();
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
                    if next != NO_NODE {
                        self.add_portal(&mut portals, [row[x] as usize, next as usize], step);
                    }
                }
            }
        }
        portals
    }

    /// Adds the crossing between two neighboring nodes if it is the cheapest of its border so far.
    fn add_portal(
        &self,
        portals: &mut BTreeMap<(RegionId, RegionId), Portal>,
        [node, next]: [usize; 2],
        step: (i32, i32),
    ) {
        let [here, there] = [node, next].map(|node| self.regions.region_of[node]);
        if here == there || self.cost[node] == UNREACHED || self.cost[next] == UNREACHED {
            return;
        }
        let cost = self.cost[node].saturating_add(self.cost[next]).saturating_add(self.step_cost(next, step));
        let nodes = if here < there { [node, next] } else { [next, node] };
        let pair = (here.min(there), here.max(there));
        let best = portals.entry(pair).or_insert(Portal { cost: UNREACHED, nodes });
        if cost < best.cost {
            *best = Portal { cost, nodes };
        }
    }

    /// From the station of the first node's region through both nodes to the station of the second's.
    fn path_through(&self, nodes: [usize; 2]) -> Vec<usize> {
        let way = |node: usize| (self.cost[node] > 0).then(|| self.back[node]);
        let mut path = self.walk_back(nodes[0], way);
        path.reverse();
        path.extend(self.walk_back(nodes[1], way));
        path
    }

    /// From station to station through whatever is free. Cost: that of the cells that are nearer; these stand in a tree, so that
    /// a short way costs nothing for the rest of the map.
    fn detour(&self, pair: [RegionId; 2]) -> Option<Vec<usize>> {
        let [from, to] = pair.map(|region| self.stations[region.index()]);
        let mut reached = BTreeMap::from([(to, (0, 0))]);
        let mut queue = Queue::new();
        queue.start(self.position(to));
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

    /// The corners that remain when `path` is replaced by straight lines as long as these touch only cells of
    /// the two regions, none nearer to a wall than the cells they replace. In cells.
    fn pulled_straight(&self, path: &[usize], pair: [RegionId; 2]) -> Vec<Point2> {
        let center = |position: usize| self.graph.cell(path[position]).center();
        let mut line = vec![center(0)];
        let mut corner = 0;
        while corner + 1 < path.len() {
            let mut reach = corner + 1;
            // The last cell that was looked at, and the least clearance of the path from the corner to it.
            let mut position = reach;
            let mut tightest = self.clearance[path[corner]].min(self.clearance[path[reach]]);
            // In strides that double while cells are visible and halve where one is not.
            let mut stride = 1;
            while position + 1 < path.len() {
                let next = (position + stride).min(path.len() - 1);
                let between = path[position + 1..=next].iter().map(|&node| self.clearance[node]);
                let tightest_to_next = between.fold(tightest, u8::min);
                let is_visible = all_touched(center(corner), center(next), |x, y| {
                    self.node_in(pair, x, y).is_some_and(|node| self.clearance[node] >= tightest_to_next)
                }) && self.keeps_radius(center(corner), center(next));
                if !is_visible && stride > 1 {
                    stride /= 2;
                    continue;
                }
                (position, tightest) = (next, tightest_to_next);
                if is_visible {
                    reach = position;
                    stride *= 2;
                } else if position > reach + GIVE_UP {
                    break;
                }
            }
            line.push(center(reach));
            corner = reach;
        }
        line
    }

    /// Whether the robot has what it needs all along the line.
    fn keeps_radius(&self, a: Point2, b: Point2) -> bool {
        self.passable.is_none() || self.body.clearance(&[a, b], self.radius + 1.0) >= self.radius - 1e-9
    }

    /// The node in column `x` and row `y` if it belongs to one of two regions.
    fn node_in(&self, pair: [RegionId; 2], x: i64, y: i64) -> Option<usize> {
        let cell = Cell::new(u32::try_from(x).ok()?, u32::try_from(y).ok()?);
        let inside = cell.x < self.graph.width() && cell.y < self.graph.height();
        let node = if inside { self.graph.node_at(cell)? } else { return None };
        pair.contains(&self.regions.region_of[node]).then_some(node)
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

/// How many cells beyond the last visible one are tried before a corner is set.
const GIVE_UP: usize = 16;

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

/// Positions by cost, and of equal cost by number. A step costs 1 to [`Queue::LONGEST`], so that a list for each cost of that range
/// is enough, used again and again.
struct Queue {
    lists: Vec<Vec<u32>>,
    cost: u32,
    n_positions: usize,
    is_sorted: bool,
}

impl Queue {
    /// The dearest step.
    const LONGEST: u32 = 2 * DIAGONAL;

    fn new() -> Self {
        let lists = vec![Vec::new(); Self::LONGEST as usize + 1];
        Self { lists, cost: 0, n_positions: 0, is_sorted: false }
    }

    /// Begins a search: the queue is empty.
    fn start(&mut self, position: u32) {
        (self.cost, self.is_sorted) = (0, false);
        self.push(0, position);
    }

    /// Adds a position at most [`Queue::LONGEST`] dearer than the last that was taken.
    fn push(&mut self, cost: u32, position: u32) {
        let n_lists = self.lists.len();
        self.lists[cost as usize % n_lists].push(position);
        self.n_positions += 1;
    }

    fn pop(&mut self) -> Option<(u32, u32)> {
        if self.n_positions == 0 {
            return None;
        }
        let n_lists = self.lists.len();
        loop {
            let list = &mut self.lists[self.cost as usize % n_lists];
            if !std::mem::replace(&mut self.is_sorted, true) {
                // No step is free, so nothing joins the list while it is read.
                list.sort_unstable_by(|a, b| b.cmp(a));
            }
            if let Some(position) = list.pop() {
                self.n_positions -= 1;
                return Some((self.cost, position));
            }
            self.cost += 1;
            self.is_sorted = false;
        }
    }
}
