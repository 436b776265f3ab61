//! What is measured of a gate: the figures that a [`GateModel`](super::GateModel) looks at.
//!
//! Lengths are compared with the width of the gate wherever the eye does so too. Of the two sides of a gate neither is
//! the first: a figure takes the lower or the higher value of both. "Scans" is the field of single scans, "smoothed" the
//! field after the neighbors were heard.

use super::WallConfig;
use super::flood::{Flood, Window};
use super::gate::{self, Narrow, center_of};
use super::paint;
use super::walls::{self, Directions};
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph, NO_NODE, Obstacles};
use crate::labels::{LabelField, LabelSet, Role};

/// One figure of a gate.
#[derive(Clone, Copy)]
pub(super) struct Figure {
    /// Name in model files.
    pub(super) name: &'static str,
    /// What it is, with its unit.
    pub(super) about: &'static str,
    of: fn(&Measured) -> f64,
}

/// The figures of a gate, in the order of [`REGISTRY`].
pub(super) fn figures(measured: &Measured) -> Vec<f32> {
    REGISTRY.iter().map(|figure| (figure.of)(measured) as f32).collect()
}

/// The position of a figure in [`REGISTRY`].
pub(super) fn position(name: &str) -> Option<usize> {
    REGISTRY.iter().position(|figure| figure.name == name)
}

macro_rules! registry {
    ($($name:literal, $about:literal, $of:expr;)*) => {
        /// All figures.
        pub(super) const REGISTRY: &[Figure] = &[$(Figure { name: $name, about: $about, of: $of }),*];
    };
}

registry! {
    "width", "width between the jambs, m", |m| m.width_m;
    "depth", "length of the narrow part in the direction of passage, m", |m| m.depth_m;
    "depth_by_width", "depth over width", |m| m.depth_m / m.width_m;
    "line_scans", "mean probability of a doorway on the line between the jambs, scans", |m| m.line[0];
    "line_smoothed", "the same, smoothed", |m| m.line[1];
    "inside_scans", "mean probability of a doorway in the strip of the gate, scans", |m| m.inside[0];
    "inside_smoothed", "the same, smoothed", |m| m.inside[1];
    "difference_scans", "largest difference of both sides in the mean probability of a class, scans", |m| m.difference(0);
    "difference_smoothed", "the same, smoothed", |m| m.difference(1);
    "passage_low_scans", "mean probability of a corridor beside the gate, lower side, scans", |m| m.low(|s| s.passage[0]);
    "passage_high_scans", "the same, higher side", |m| m.high(|s| s.passage[0]);
    "passage_low_smoothed", "the same, lower side, smoothed", |m| m.low(|s| s.passage[1]);
    "passage_high_smoothed", "the same, higher side, smoothed", |m| m.high(|s| s.passage[1]);
    "beside_high_scans", "mean probability of a doorway beside the gate, higher side, scans", |m| m.high(|s| s.doorway[0]);
    "reach12_low", "walk to the first clearance of 1.2 times the gate's, nearer side, m", |m| m.low(|s| s.reach_m[0]);
    "reach12_high", "the same, farther side, m", |m| m.high(|s| s.reach_m[0]);
    "reach12_high_by_width", "the same over the width", |m| m.high(|s| s.reach_m[0]) / m.width_m;
    "reach15_low", "walk to the first clearance of 1.5 times the gate's, nearer side, m", |m| m.low(|s| s.reach_m[1]);
    "reach15_high", "the same, farther side, m", |m| m.high(|s| s.reach_m[1]);
    "reach15_high_by_width", "the same over the width", |m| m.high(|s| s.reach_m[1]) / m.width_m;
    "widest06_low", "largest clearance within a walk of 0.6 m over the gate's, poorer side", |m| m.low(|s| s.widest[0]);
    "widest06_high", "the same, richer side", |m| m.high(|s| s.widest[0]);
    "widest10_low", "the same within 1 m, poorer side", |m| m.low(|s| s.widest[1]);
    "widest10_high", "the same, richer side", |m| m.high(|s| s.widest[1]);
    "widest15_low", "the same within 1.5 m, poorer side", |m| m.low(|s| s.widest[2]);
    "widest15_high", "the same, richer side", |m| m.high(|s| s.widest[2]);
    "widest25_low", "the same within 2.5 m, poorer side", |m| m.low(|s| s.widest[3]);
    "widest25_high", "the same, richer side", |m| m.high(|s| s.widest[3]);
    "widest_w_low", "the same within 1.5 widths, poorer side", |m| m.low(|s| s.widest[4]);
    "widest_w_high", "the same, richer side", |m| m.high(|s| s.widest[4]);
    "area10_low", "area within a walk of 1 m, smaller side, m²", |m| m.low(|s| s.area_m2[0]);
    "area10_high", "the same, larger side, m²", |m| m.high(|s| s.area_m2[0]);
    "area15_low", "area within a walk of 1.5 m, smaller side, m²", |m| m.low(|s| s.area_m2[1]);
    "area15_high", "the same, larger side, m²", |m| m.high(|s| s.area_m2[1]);
    "area25_low", "area within a walk of 2.5 m, smaller side, m²", |m| m.low(|s| s.area_m2[2]);
    "area_w_low", "area within 1.5 widths over the square of the width, smaller side", |m| m.low(|s| s.area_by_w);
    "area_w_high", "the same, larger side", |m| m.high(|s| s.area_by_w);
    "bypass", "shortest walk from side to side around the gate, m, at most 6", |m| m.bypass_m;
    "jamb", "length of the shorter of both jambs, m, in steps up to 3", |m| m.jamb_m;
    "jamb_by_width", "the same over the width", |m| m.jamb_m / m.width_m;
    "inline_low", "share of wall on the line beyond a jamb up to 0.8 m, poorer jamb", |m| m.inline[0].min(m.inline[1]);
    "inline_high", "the same, richer jamb", |m| m.inline[0].max(m.inline[1]);
    "thickness", "thickness of the wall 0.2 m beyond a jamb, thinner jamb, m, at most 1", |m| m.thickness_m;
    "span02_near_low", "free way along the wall 0.2 m before the gate, to the nearer end, over half of the width, poorer side",
        |m| m.low(|s| s.span[0][0]);
    "span02_far_low", "the same to the farther end", |m| m.low(|s| s.span[0][1]);
    "span05_near_low", "the same at 0.5 m, nearer end, poorer side", |m| m.low(|s| s.span[1][0]);
    "span05_near_high", "the same, richer side", |m| m.high(|s| s.span[1][0]);
    "span05_far_low", "the same, farther end, poorer side", |m| m.low(|s| s.span[1][1]);
    "span10_near_low", "the same at 1 m, nearer end, poorer side", |m| m.low(|s| s.span[2][0]);
    "span10_near_high", "the same, richer side", |m| m.high(|s| s.span[2][0]);
    "span10_far_low", "the same, farther end, poorer side", |m| m.low(|s| s.span[2][1]);
    "span10_far_high", "the same, richer side", |m| m.high(|s| s.span[2][1]);
    "sight_low", "free sight ahead through the gate, shorter side, m, at most 8", |m| m.low(|s| s.sight_m);
    "sight_high", "the same, longer side, m", |m| m.high(|s| s.sight_m);
    "turn", "angle against the walls around, rad; 0.8 where these do not agree", |m| m.turn_rad;
    "clutter", "share of the surroundings that is covered by small obstacles", |m| m.clutter;
    "narrowest_nearby", "width of the narrowest gate within 1.5 m over the width", |m| m.narrowest_nearby;
    "form_clear", "what is least of the form of a clear doorway over what is asked of it (`Form`)", |m| m.form(&CLEAR);
    "form_plausible", "the same of a plausible doorway", |m| m.form(&PLAUSIBLE);
    "form_supported", "the lesser of this and twice the support", |m| m.form(&PLAUSIBLE).min(2.0 * m.support());
    "support", "what the labels say: the larger of `inside_smoothed` and `difference_smoothed`", |m| m.support();
}

/// Walks within which the largest clearance is taken, and within all but the first the area, in meters.
const WIDEST_M: [f64; 4] = [0.6, 1.0, 1.5, 2.5];
/// The labels of a side are read from this to that walk, in meters.
const LABELS_M: [f64; 2] = [0.4, 1.5];
/// Distances before the gate where the free way along the wall is taken, in meters.
const SPANS_M: [f64; 3] = [0.2, 0.5, 1.0];
/// Longest way around that is looked for, in meters.
const MAX_WAY_M: f64 = 6.0;
/// Longest sight that is looked for, in meters.
const MAX_SIGHT_M: f64 = 8.0;
/// Lengths that a jamb is compared with, in meters.
const JAMBS_M: [f64; 5] = [0.4, 0.8, 1.4, 2.0, 3.0];
/// Gates so near compete, in meters.
const NEARBY_M: f64 = 1.5;

/// What is asked of the form of a doorway, on both of its sides.
struct Form {
    /// How many times wider than the gate the space is within 0.6 m, and within 1 m or 1.5 widths.
    widening: [f64; 2],
    bypass_m: f64,
    jamb_m: f64,
}

/// Of a doorway whatever the labels say. Chosen on generated buildings.
const CLEAR: Form = Form { widening: [1.3, 1.5], bypass_m: 6.0, jamb_m: 2.0 };
/// Of a doorway that the labels support. Chosen on generated buildings.
const PLAUSIBLE: Form = Form { widening: [1.1, 1.33], bypass_m: 2.5, jamb_m: 0.8 };

/// What was measured of a gate.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    width_m: f64,
    depth_m: f64,
    line: [f64; 2],
    inside: [f64; 2],
    sides: [Side; 2],
    bypass_m: f64,
    jamb_m: f64,
    inline: [f64; 2],
    thickness_m: f64,
    turn_rad: f64,
    clutter: f64,
    narrowest_nearby: f64,
}

/// What was measured of one side of a gate.
#[derive(Clone, Debug, Default)]
struct Side {
    reach_m: [f64; 2],
    widest: [f64; 5],
    area_m2: [f64; 3],
    area_by_w: f64,
    /// Of every field: the mean of the classes of role passage, of role doorway, and of every class.
    passage: [f64; 2],
    doorway: [f64; 2],
    classes: [Vec<f64>; 2],
    span: [[f64; 2]; 3],
    sight_m: f64,
}

impl Measured {
    fn low(&self, of: fn(&Side) -> f64) -> f64 {
        of(&self.sides[0]).min(of(&self.sides[1]))
    }

    fn high(&self, of: fn(&Side) -> f64) -> f64 {
        of(&self.sides[0]).max(of(&self.sides[1]))
    }

    /// The least of what was measured over what `asked` asks, and of the smaller side's area within 1 m in m².
    fn form(&self, asked: &Form) -> f64 {
        let near = self.low(|side| side.widest[0]) / asked.widening[0];
        let far = self.low(|side| side.widest[1]).max(self.low(|side| side.widest[4])) / asked.widening[1];
        let around = (self.bypass_m / asked.bypass_m).min(self.jamb_m / asked.jamb_m);
        near.min(far).min(around).min(self.low(|side| side.area_m2[0]))
    }

    fn support(&self) -> f64 {
        self.inside[1].max(self.difference(1))
    }

    fn difference(&self, field: usize) -> f64 {
        let [one, other] = self.sides.each_ref().map(|side| &side.classes[field]);
        one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

/// All that is asked when a gate is measured.
pub(super) struct Surroundings<'a> {
    /// The free cells of the map.
    pub(super) graph: &'a CellGraph,
    /// The same without specks, in which gates are sought, and its clearance.
    pub(super) cleared: &'a CellGraph,
    pub(super) clearance: &'a [u32],
    /// The same without any furniture that stands free.
    pub(super) bare: &'a CellGraph,
    pub(super) directions: &'a Directions,
    /// The node of `graph` in the cell of every node of `cleared`, [`NO_NODE`] in a speck.
    pub(super) node_of: &'a [u32],
    /// The field of single scans and the smoothed one.
    pub(super) fields: [&'a LabelField; 2],
    pub(super) label_set: &'a LabelSet,
    pub(super) walls: &'a WallConfig,
    pub(super) resolution_m: f64,
}

impl Surroundings<'_> {
    /// Measures `gate`, one of `all`. Cost: linear in the cells within 3 m.
    pub(super) fn measure(&self, gate: &Narrow, all: &[Narrow]) -> Measured {
        let r = self.resolution_m;
        let width_m = (gate.width - 1.0) * r;
        let reach = (MAX_WAY_M / 2.0 / r).ceil() as u32;
        let window = Window::around(self.cleared, gate, reach);
        let mut floods = [1.0, -1.0].map(|direction| Flood::from(self.cleared, gate, direction, &window));
        for flood in &mut floods {
            flood.advance(&window, reach);
        }
        let shortest = Flood::meeting(&floods);
        let bypass_m = shortest.map_or(MAX_WAY_M, |steps| (steps as f64 * r).min(MAX_WAY_M));
        let mut sides = [0, 1].map(|side| self.side(gate, &window, &floods[side], width_m));
        for (side, direction) in sides.iter_mut().zip([1.0, -1.0]) {
            side.sight_m = self.free_way(gate.center, gate.along() * direction, MAX_SIGHT_M / r) * r;
            side.span = SPANS_M.map(|before| {
                let start = gate.center + gate.along() * (direction * (gate.depth / 2.0 + before / r));
                let way = |turn: f64| {
                    self.free_way(start, gate.across * turn, 2.0 * gate.width) / (gate.width / 2.0)
                };
                let (one, other) = (way(1.0), way(-1.0));
                [one.min(other), one.max(other)]
            });
        }
        let of_map = |nodes: Vec<usize>| -> Vec<usize> {
            nodes.into_iter().filter_map(|node| self.of_map(node)).collect()
        };
        let line = of_map(paint::nodes_in(self.cleared, gate, 0.75));
        let inside = of_map(paint::strip(self.cleared, gate, 0.2 / r));
        Measured {
            width_m,
            depth_m: gate.depth * r,
            line: [0, 1].map(|field| self.mean_of_role(field, &line, Role::Doorway)),
            inside: [0, 1].map(|field| self.mean_of_role(field, &inside, Role::Doorway)),
            sides,
            bypass_m,
            jamb_m: self.jamb_m(gate),
            inline: [1.0, -1.0].map(|end| self.inline(gate, end)),
            thickness_m: self.thickness_m(gate, 1.0).min(self.thickness_m(gate, -1.0)),
            turn_rad: walls::turn(self.directions, r, self.walls, gate).map_or(0.8, f64::abs),
            clutter: self.clutter(gate),
            narrowest_nearby: all
                .iter()
                .filter(|other| other.center.distance(gate.center) * r <= NEARBY_M)
                .map(|other| (other.width - 1.0) / (gate.width - 1.0))
                .fold(1.0, f64::min),
        }
    }

    fn of_map(&self, node: usize) -> Option<usize> {
        Some(self.node_of[node]).filter(|&node| node != NO_NODE).map(|node| node as usize)
    }

    fn side(&self, gate: &Narrow, window: &Window, flood: &Flood, width_m: f64) -> Side {
        let r = self.resolution_m;
        let half = gate.width / 2.0;
        let mut side = Side { reach_m: [MAX_WAY_M / 2.0; 2], ..Side::default() };
        // Walks come in the order of their length: what is within one is known where the first longer one comes.
        let [from_m, to_m] = LABELS_M;
        let within_m = WIDEST_M.into_iter().chain([1.5 * width_m]);
        let (mut widest, mut n_cells) = ([None; 5], [None; 5]);
        let (mut highest, mut n) = (0u32, 0u32);
        let mut label_nodes = Vec::new();
        let mut last = u32::MAX;
        for (node, steps) in flood.visited(window) {
            let walked_m = steps as f64 * r;
            if steps != last {
                last = steps;
                for (k, _) in within_m.clone().enumerate().filter(|&(_, within_m)| walked_m > within_m) {
                    widest[k].get_or_insert(highest);
                    n_cells[k].get_or_insert(n);
                }
            }
            n += 1;
            let clearance = self.clearance[node];
            if clearance > highest {
                highest = clearance;
                let wide = (clearance as f64).sqrt() / half;
                for (reach, times) in side.reach_m.iter_mut().zip([1.2, 1.5]) {
                    if wide >= times && walked_m < *reach {
                        *reach = walked_m;
                    }
                }
            }
            if walked_m > from_m && walked_m < to_m {
                label_nodes.extend(self.of_map(node));
            }
        }
        let widest = widest.map(|within| within.unwrap_or(highest));
        let [_, n_10, n_15, n_25, n_by_w] = n_cells.map(|within| within.unwrap_or(n));
        side.widest = widest.map(|squared| (squared as f64).sqrt() / half);
        side.area_m2 = [n_10, n_15, n_25].map(|n| n as f64 * r * r);
        side.area_by_w = n_by_w as f64 * r * r / (width_m * width_m);
        side.classes = [0, 1].map(|field| self.means(field, &label_nodes));
        let of_role = |classes: &Vec<f64>, role: Role| {
            let of_class = classes.iter().zip(self.label_set.classes());
            of_class.filter(|(_, class)| class.role == role).map(|(mean, _)| mean).sum()
        };
        side.passage = side.classes.each_ref().map(|classes| of_role(classes, Role::Passage));
        side.doorway = side.classes.each_ref().map(|classes| of_role(classes, Role::Doorway));
        side
    }

    /// Mean probability of every class over `nodes`.
    fn means(&self, field: usize, nodes: &[usize]) -> Vec<f64> {
        let mut sums = vec![0.0; self.label_set.len()];
        for &node in nodes {
            for (sum, &p) in sums.iter_mut().zip(self.fields[field].row(node)) {
                *sum += p as f64;
            }
        }
        sums.iter().map(|sum| sum / nodes.len().max(1) as f64).collect()
    }

    fn mean_of_role(&self, field: usize, nodes: &[usize], role: Role) -> f64 {
        let means = self.means(field, nodes);
        let of_class = means.iter().zip(self.label_set.classes());
        of_class.filter(|(_, class)| class.role == role).map(|(mean, _)| mean).sum()
    }

    /// Length of the way from `from` to the first cell that is not free, in cells, at most `limit`.
    fn free_way(&self, from: Point2, direction: Vec2, limit: f64) -> f64 {
        let mut way = 0.0;
        while way < limit && self.is_open(from + direction * way) {
            way += 0.5;
        }
        way.min(limit)
    }

    fn is_open(&self, point: Point2) -> bool {
        gate::is_free(self.cleared, point)
    }

    /// The longest of [`JAMBS_M`] that an obstacle at either jamb reaches, of the shorter jamb. What reaches the border of
    /// the map goes on.
    fn jamb_m(&self, gate: &Narrow) -> f64 {
        let obstacles = Obstacles::of(self.graph);
        let jambs = [gate.width / 2.0, -gate.width / 2.0].map(|to| gate.center + gate.across * to);
        let around = |v: f64| (v - 1.75).ceil() as i64..=(v + 0.75).floor() as i64;
        let length = |jamb: Point2| {
            let mut longest = 0.0;
            for (y, x) in around(jamb.y).flat_map(|y| around(jamb.x).map(move |x| (y, x))) {
                let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return JAMBS_M[4] };
                if x >= self.graph.width() || y >= self.graph.height() {
                    return JAMBS_M[4];
                }
                let cell = Cell::new(x, y);
                if self.graph.is_free(cell) {
                    continue;
                }
                for &at_least in &JAMBS_M {
                    if at_least <= longest {
                        continue;
                    }
                    let too_short = ((at_least / self.resolution_m - 1e-9).ceil() as u32).saturating_sub(1);
                    if obstacles.small_at(cell, too_short).is_some() {
                        break;
                    }
                    longest = at_least;
                }
            }
            longest
        };
        jambs.map(length).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Share of the line beyond a jamb that is not free, up to 0.8 m. A cell beside it counts too.
    fn inline(&self, gate: &Narrow, end: f64) -> f64 {
        let along = gate.along();
        let n_steps = (2.0 * 0.8 / self.resolution_m).round().max(1.0) as u32;
        let is_wall = |step: u32| {
            let at = gate.center + gate.across * (end * (gate.width / 2.0 + 0.5 * step as f64));
            [-1.0, 0.0, 1.0].iter().any(|beside| !self.is_open(at + along * *beside))
        };
        (0..n_steps).filter(|&step| is_wall(step)).count() as f64 / n_steps as f64
    }

    fn thickness_m(&self, gate: &Narrow, end: f64) -> f64 {
        let at = gate.center + gate.across * (end * (gate.width / 2.0 + 0.2 / self.resolution_m));
        let limit = 1.0 / self.resolution_m;
        let run = |direction: Vec2| {
            let mut way = 0.0;
            while way < limit && !self.is_open(at + direction * way) {
                way += 0.5;
            }
            way
        };
        ((run(gate.along()) + run(gate.along() * -1.0)) * self.resolution_m).min(1.0)
    }

    /// Share of the cells within a square of 1.5 m around that free-standing obstacles cover.
    fn clutter(&self, gate: &Narrow) -> f64 {
        let (mut n, mut n_covered) = (0u32, 0u32);
        for cell in paint::cells_within(self.graph, gate, 1.5 / self.resolution_m) {
            if self.bare.is_free(cell) && center_of(cell).distance(gate.center) * self.resolution_m <= 1.5 {
                n += 1;
                n_covered += u32::from(!self.graph.is_free(cell));
            }
        }
        n_covered as f64 / n.max(1) as f64
    }
}
