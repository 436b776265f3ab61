//! Minimum cut of a grid graph with two terminals, by growing two search trees (Boykov and Kolmogorov).
//!
//! Used by [`super::expand`], Sect. 4.6. Neighbors are implicit: a cell's neighbor in direction d stands at a fixed
//! offset, and one record per cell holds all that the search reads, so that a step touches one or two cache
//! lines. Capacities are integers: the flow is exact and the cut does not depend on rounding. Cost: in
//! practice near linear in the cells; 4 D + 16 bytes per cell of the rectangle, D = 4 or 8 neighbors, or half as much for the
//! neighbors where capacities are small ([`Capacity`]); and 4 bytes per cell with capacity from or to a terminal.
//!
//! Y. Boykov, V. Kolmogorov, *An experimental comparison of min-cut/max-flow algorithms for energy
//! minimization in vision*, PAMI 2004.

use std::collections::VecDeque;

pub use super::capacity::Capacity;
use crate::grid::{Cell, Connectivity};

/// A rectangle of cells with residual capacities to their `D` neighbors and to one of the two terminals.
///
/// Directions are numbered as in [`Connectivity::steps`], so that direction `D − 1 − d` is opposite to `d`.
#[derive(Clone, Debug)]
pub struct GridCut<const D: usize, C = i32> {
    stride: usize,
    offsets: [isize; D],
    nodes: Vec<Node<D, C>>,
    active: VecDeque<u32>,
    orphans: VecDeque<u32>,
    /// Number of augmentations; distances stamped with it are known to be good.
    time: u32,
}

#[derive(Clone, Copy, Debug)]
struct Node<const D: usize, C> {
    /// Residual capacity to the neighbor in each direction.
    residual: [C; D],
    /// Residual capacity from the source if positive, to the sink if negative.
    excess: i32,
    distance: u32,
    stamp: u32,
    /// Direction of the parent, [`TERMINAL`] or [`ORPHAN`].
    parent: u8,
    tree: Tree,
    is_active: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tree {
    None,
    Source,
    Sink,
}

const TERMINAL: u8 = 254;
const ORPHAN: u8 = 255;

impl<const D: usize, C: Capacity> Node<D, C> {
    const EMPTY: Self = Self {
        residual: [C::ZERO; D],
        excess: 0,
        distance: 0,
        stamp: 0,
        parent: ORPHAN,
        tree: Tree::None,
        is_active: false,
    };
}

impl<const D: usize, C: Capacity> GridCut<D, C> {
    /// A rectangle of `width × height` cells without capacities.
    ///
    /// # Panics
    /// If `D` is neither 4 nor 8, or the rectangle has 2³² cells or more.
    pub fn new(width: u32, height: u32) -> Self {
        let steps = match D {
            4 => Connectivity::Four.steps(),
            8 => Connectivity::Eight.steps(),
            _ => panic!("expected 4 or 8 neighbors, found {D}"),
        };
        // A frame of empty cells around the rectangle saves every test for its border.
        let stride = width as usize + 2;
        let n_positions = stride * (height as usize + 2);
        assert!(n_positions < u32::MAX as usize, "positions fit in 32 bits");
        let offsets =
            std::array::from_fn(|d| steps[d].1 as isize * stride.cast_signed() + steps[d].0 as isize);
        Self {
            stride,
            offsets,
            nodes: vec![Node::EMPTY; n_positions],
            active: VecDeque::new(),
            orphans: VecDeque::new(),
            time: 0,
        }
    }

    /// Position of `cell`, as the other functions use it.
    pub fn position(&self, cell: Cell) -> usize {
        self.framed_position(cell.x + 1, cell.y + 1)
    }

    /// Position in a column and row that are counted from the frame of one cell around the rectangle.
    pub fn framed_position(&self, column: u32, row: u32) -> usize {
        row as usize * self.stride + column as usize
    }

    /// Number of positions, the frame around the rectangle included.
    pub fn n_positions(&self) -> usize {
        self.nodes.len()
    }

    /// Position of the neighbor of `position` in direction `d`.
    pub fn neighbor(&self, position: usize, d: usize) -> usize {
        position.wrapping_add_signed(self.offsets[d])
    }

    /// Sets all capacities to 0.
    pub fn clear(&mut self) {
        self.nodes.fill(Node::EMPTY);
    }

    /// Adds capacity from the source (positive) or to the sink (negative).
    pub fn add_excess(&mut self, position: usize, excess: i32) {
        self.nodes[position].excess += excess;
    }

    /// Gives the edge in direction `d` the same `capacity` in both directions.
    pub fn set_edge(&mut self, position: usize, d: usize, capacity: i32) {
        debug_assert!(capacity >= 0, "capacities are not negative");
        let neighbor = self.neighbor(position, d);
        self.nodes[position].residual[d] = C::of(capacity);
        self.nodes[neighbor].residual[D - 1 - d] = C::of(capacity);
    }

    /// Whether `position` is on the sink's side of the minimum cut, after [`GridCut::solve`]. Of several minimum
    /// cuts, the one with the smallest sink side is used.
    pub fn is_sink_side(&self, position: usize) -> bool {
        self.nodes[position].tree == Tree::Sink
    }

    /// Pushes flow until no more gets through; returns the total flow.
    pub fn solve(&mut self) -> i64 {
        self.time = 0;
        let mut flow = self.plant_trees();
        while let Some(position) = self.active.pop_front() {
            let p = position as usize;
            self.nodes[p].is_active = false;
            while let Some((source_end, d)) = self.grow(p) {
                self.time += 1;
                flow += i64::from(self.augment(source_end, d));
                while let Some(orphan) = self.orphans.pop_front() {
                    self.adopt(orphan as usize);
                }
            }
        }
        flow
    }

    /// Pushes what flows from the source over one edge to the sink, then makes every cell with excess a root.
    fn plant_trees(&mut self) -> i64 {
        self.active.reserve_exact(self.nodes.iter().filter(|node| node.excess != 0).count());
        let mut flow = 0;
        for p in 0..self.nodes.len() {
            if self.nodes[p].excess > 0 {
                for d in 0..D {
                    flow += i64::from(self.push_over(p, d));
                }
            }
        }
        for p in 0..self.nodes.len() {
            let node = &mut self.nodes[p];
            node.tree = match node.excess {
                0 => continue,
                1.. => Tree::Source,
                _ => Tree::Sink,
            };
            node.parent = TERMINAL;
            node.distance = 1;
            self.activate(p);
        }
        flow
    }

    /// Pushes from the source over the edge `d` of `p` to the sink, if both ends have excess for it.
    fn push_over(&mut self, p: usize, d: usize) -> i32 {
        let q = self.neighbor(p, d);
        let amount = self.nodes[p].excess.min(self.residual(p, d)).min(-self.nodes[q].excess);
        if amount <= 0 {
            return 0;
        }
        self.nodes[p].excess -= amount;
        self.nodes[q].excess += amount;
        self.move_capacity(p, d, amount);
        amount
    }

    fn residual(&self, p: usize, d: usize) -> i32 {
        self.nodes[p].residual[d].into()
    }

    /// Sends `amount` from `p` in direction `d`.
    fn move_capacity(&mut self, p: usize, d: usize, amount: i32) {
        let q = self.neighbor(p, d);
        self.nodes[p].residual[d] = C::of(self.residual(p, d) - amount);
        self.nodes[q].residual[D - 1 - d] = C::of(self.residual(q, D - 1 - d) + amount);
    }

    fn activate(&mut self, p: usize) {
        if !self.nodes[p].is_active {
            self.nodes[p].is_active = true;
            self.active.push_back(p as u32);
        }
    }

    /// Lets the tree of `p` take its free neighbors. Returns the edge over which it meets the other tree, as its
    /// end in the source's tree and the direction from there.
    fn grow(&mut self, p: usize) -> Option<(usize, usize)> {
        let Node { tree, distance, stamp, residual, .. } = self.nodes[p];
        if tree == Tree::None {
            return None;
        }
        for (d, &forward) in residual.iter().enumerate() {
            let q = self.neighbor(p, d);
            let to_sink = if tree == Tree::Source { forward.into() } else { self.residual(q, D - 1 - d) };
            if to_sink == 0 {
                continue;
            }
            let neighbor = &mut self.nodes[q];
            if neighbor.tree == Tree::None {
                neighbor.tree = tree;
                neighbor.parent = (D - 1 - d) as u8;
                neighbor.distance = distance + 1;
                neighbor.stamp = stamp;
                self.activate(q);
            } else if neighbor.tree != tree {
                self.activate(p);
                return Some(if tree == Tree::Source { (p, d) } else { (q, D - 1 - d) });
            } else if neighbor.stamp <= stamp && neighbor.distance > distance + 1 {
                // A shorter way to the root.
                neighbor.parent = (D - 1 - d) as u8;
                neighbor.distance = distance + 1;
                neighbor.stamp = stamp;
            }
        }
        None
    }

    /// Pushes all that fits along the path through the edge `d` of `source_end`; edges that fill up cut off orphans.
    fn augment(&mut self, source_end: usize, d: usize) -> i32 {
        let sink_end = self.neighbor(source_end, d);
        let amount = self
            .residual(source_end, d)
            .min(self.bottleneck(source_end, Tree::Source))
            .min(self.bottleneck(sink_end, Tree::Sink));
        self.move_capacity(source_end, d, amount);
        self.push_to_root(source_end, Tree::Source, amount);
        self.push_to_root(sink_end, Tree::Sink, amount);
        amount
    }

    /// Smallest residual capacity between `p` and the root of its tree.
    fn bottleneck(&self, mut p: usize, tree: Tree) -> i32 {
        let mut smallest = i32::MAX;
        while self.nodes[p].parent != TERMINAL {
            let d = self.nodes[p].parent as usize;
            let parent = self.neighbor(p, d);
            let residual = match tree {
                Tree::Source => self.residual(parent, D - 1 - d),
                _ => self.residual(p, d),
            };
            smallest = smallest.min(residual);
            p = parent;
        }
        smallest.min(self.nodes[p].excess.abs())
    }

    fn push_to_root(&mut self, mut p: usize, tree: Tree, amount: i32) {
        while self.nodes[p].parent != TERMINAL {
            let d = self.nodes[p].parent as usize;
            let parent = self.neighbor(p, d);
            let left = if tree == Tree::Source {
                self.move_capacity(parent, D - 1 - d, amount);
                self.residual(parent, D - 1 - d)
            } else {
                self.move_capacity(p, d, amount);
                self.residual(p, d)
            };
            if left == 0 {
                self.cut_off(p);
            }
            p = parent;
        }
        self.nodes[p].excess -= if tree == Tree::Source { amount } else { -amount };
        if self.nodes[p].excess == 0 {
            self.cut_off(p);
        }
    }

    fn cut_off(&mut self, p: usize) {
        self.nodes[p].parent = ORPHAN;
        self.orphans.push_back(p as u32);
    }

    /// Finds the orphan `p` the parent nearest to the root, or frees it.
    fn adopt(&mut self, p: usize) {
        let tree = self.nodes[p].tree;
        let mut best = (u32::MAX, 0);
        for d in 0..D {
            if self.residual_from_root(p, d, tree) > 0 {
                let q = self.neighbor(p, d);
                if self.nodes[q].tree == tree
                    && let Some(distance) = self.distance_to_root(q)
                    && distance < best.0
                {
                    best = (distance, d);
                }
            }
        }
        let node = &mut self.nodes[p];
        if best.0 < u32::MAX {
            node.parent = best.1 as u8;
            node.distance = best.0 + 1;
            node.stamp = self.time;
            return;
        }
        node.tree = Tree::None;
        for d in 0..D {
            let q = self.neighbor(p, d);
            if self.nodes[q].tree != tree {
                continue;
            }
            if self.residual_from_root(p, d, tree) > 0 {
                self.activate(q);
            }
            if self.nodes[q].parent as usize == D - 1 - d {
                self.cut_off(q);
            }
        }
    }

    /// Residual capacity between `p` and its neighbor `d`, in the direction in which flow comes from (source) or
    /// goes to (sink) the neighbor's root.
    fn residual_from_root(&self, p: usize, d: usize, tree: Tree) -> i32 {
        match tree {
            Tree::Source => self.residual(self.neighbor(p, d), D - 1 - d),
            _ => self.residual(p, d),
        }
    }

    /// Number of steps from `q` to its terminal, or `None` if the way ends at an orphan. Stamps the way.
    fn distance_to_root(&mut self, q: usize) -> Option<u32> {
        let mut distance = 0;
        let mut p = q;
        loop {
            let node = &mut self.nodes[p];
            if node.stamp == self.time {
                distance += node.distance;
                break;
            }
            match node.parent {
                ORPHAN => return None,
                TERMINAL => {
                    node.stamp = self.time;
                    node.distance = 1;
                    distance += 1;
                    break;
                }
                d => {
                    distance += 1;
                    p = self.neighbor(p, d as usize);
                }
            }
        }
        let mut left = distance;
        p = q;
        while self.nodes[p].stamp != self.time {
            let node = &mut self.nodes[p];
            node.stamp = self.time;
            node.distance = left;
            left -= 1;
            let d = node.parent as usize;
            p = self.neighbor(p, d);
        }
        Some(distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_of_three_cells_by_hand() {
        // Source 5 → a 2 ↔ b 3 ↔ c → 4 sink: the edge of 2 is the narrowest.
        let mut cut = GridCut::<4>::new(3, 2);
        let [a, b, c, apart] = [(0, 0), (1, 0), (2, 0), (1, 1)].map(|(x, y)| cut.position(Cell::new(x, y)));
        cut.add_excess(a, 5);
        cut.add_excess(c, -4);
        let right = Connectivity::Four.steps().iter().position(|&step| step == (1, 0)).unwrap();
        cut.set_edge(a, right, 2);
        cut.set_edge(b, right, 3);
        assert_eq!(cut.solve(), 2);
        assert_eq!([a, b, c].map(|cell| cut.is_sink_side(cell)), [false, true, true]);
        // No terminal reaches the cell below b.
        assert!(!cut.is_sink_side(apart));
    }
}
