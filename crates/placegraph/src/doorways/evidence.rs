//! Whether a gate is a doorway: what its surroundings and the labels say.

use super::gate::Gate;
use super::paint;
use super::sides::{Side, Sides, Walks};
use super::{DoorwayConfig, GateRule};
use crate::geom::{Point2, Vec2};
use crate::grid::{Cell, CellGraph, Obstacles};
use crate::labels::{LabelField, LabelSet, Role};

/// All that is asked when a gate is judged.
pub(super) struct Evidence<'a> {
    /// The free cells of the map.
    pub(super) graph: &'a CellGraph,
    /// Distribution of every node of `graph`.
    pub(super) field: &'a LabelField,
    pub(super) label_set: &'a LabelSet,
    /// The obstacles between the nodes of `graph`.
    pub(super) obstacles: Obstacles<'a>,
    pub(super) resolution_m: f64,
    pub(super) config: &'a DoorwayConfig,
}

impl Evidence<'_> {
    /// Whether `gate`, found in `cleared`, is a doorway: by its form alone, or by its form and the labels.
    pub(super) fn is_doorway(&self, cleared: &CellGraph, clearance: &[u32], gate: &Gate) -> bool {
        let cells = |meters: f64| meters / self.resolution_m;
        let config = self.config;
        let walks = Walks {
            near: cells(config.walks.near_m),
            far: cells(config.walks.far_m),
            labels: config.walks.labels_m.map(cells).into(),
            bypass: cells(config.clear.min_bypass_m.max(config.plausible.min_bypass_m)),
        };
        let mut sides = Sides::of(cleared, clearance, gate, &walks);
        let near = sides.near();
        // The way around is the longest to look for: only where all else is as a rule asks.
        let rules = [&config.clear, &config.plausible];
        let [is_clear, is_plausible] = rules.map(|rule| self.has_form(rule, gate, &near));
        if !is_clear && !is_plausible {
            return false;
        }
        let bypass = sides.bypass();
        let is_around = |rule: &GateRule| {
            // Half a step of tolerance: the walk is capped at the number asked for.
            bypass * self.resolution_m >= rule.min_bypass_m - self.resolution_m / 2.0
        };
        is_clear && is_around(&config.clear)
            || is_plausible
                && is_around(&config.plausible)
                && self.support(cleared, gate, &near) >= config.min_support
    }

    /// Whether the jambs are as long and both sides as wide as `rule` asks.
    fn has_form(&self, rule: &GateRule, gate: &Gate, sides: &[Side; 2]) -> bool {
        let half = gate.width / 2.0;
        let wide_enough = |side: &Side| {
            (side.near_clearance as f64).sqrt() >= rule.near_widening * half
                && (side.far_clearance as f64).sqrt() >= rule.far_widening * half
                && side.n_cells as f64 * self.resolution_m.powi(2) >= rule.min_area_m2
        };
        let to_jamb: Vec2 = gate.across * half;
        let jambs = [gate.center + to_jamb, gate.center + to_jamb * -1.0];
        sides.iter().all(wide_enough) && jambs.iter().all(|&jamb| self.is_jamb(jamb, rule.min_jamb_m))
    }

    /// Whether there is an obstacle of at least this length at most 1.25 columns and rows from `point`. Outside of the map
    /// is one.
    fn is_jamb(&self, point: Point2, min_length_m: f64) -> bool {
        // The longest that is too short; lengths are whole cells.
        let too_short = ((min_length_m / self.resolution_m - 1e-9).ceil() as u32).saturating_sub(1);
        let columns = |v: f64| (v - 1.75).ceil() as i64..=(v + 0.75).floor() as i64;
        columns(point.y).any(|y| {
            columns(point.x).any(|x| {
                let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return true };
                let is_inside = x < self.graph.width() && y < self.graph.height();
                !is_inside || {
                    let cell = Cell::new(x, y);
                    self.graph.node_at(cell).is_none() && self.obstacles.small_at(cell, too_short).is_none()
                }
            })
        })
    }

    /// How much the labels speak for a doorway, 0 to 1: the mean probability of one in it, or the largest
    /// difference between the two sides in the mean probability of another class.
    fn support(&self, cleared: &CellGraph, gate: &Gate, [one, other]: &[Side; 2]) -> f64 {
        let mean = |nodes: &[usize], wanted: &dyn Fn(usize) -> bool| {
            let rows: Vec<&[f32]> = (nodes.iter())
                .filter_map(|&node| self.graph.node_at(cleared.cell(node)))
                .map(|node| self.field.row(node))
                .collect();
            let total: f64 = (rows.iter())
                .map(|row| (0..row.len()).filter(|&k| wanted(k)).map(|k| row[k] as f64).sum::<f64>())
                .sum();
            total / rows.len().max(1) as f64
        };
        let is_doorway: Vec<bool> =
            self.label_set.labels().map(|label| self.label_set.role(label) == Role::Doorway).collect();
        let margin = self.config.margin_m / self.resolution_m;
        let of_doorway = mean(&paint::strip(cleared, gate, margin), &|k| is_doorway[k]);
        (0..is_doorway.len())
            .filter(|&k| !is_doorway[k])
            .map(|k| (mean(&one.label_nodes, &|l| l == k) - mean(&other.label_nodes, &|l| l == k)).abs())
            .fold(of_doorway, f64::max)
    }
}
