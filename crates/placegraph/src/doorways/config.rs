//! Every tuned number of this stage.
//!
//! Where no other source is named, a number was chosen on generated buildings, with no real map looked at
//! (`docs/default-model.md`, "What was tried"). Numbers in whole and half cells that follow from how cells are drawn stand where they are used.

use std::borrow::Cow;

use super::GateModel;
use crate::boost::WeightedStump;

/// The sizes of gates, and when one is a doorway.
#[derive(Clone, Debug, PartialEq)]
pub struct DoorwayConfig {
    /// Narrowest gate between its jambs, in meters. Default 0.4.
    pub min_width_m: f64,
    /// Widest gate between its jambs, in meters. Default 4.2: the mouth of a hall.
    pub max_width_m: f64,
    /// Longest narrow part in the direction of passage, in meters. Default 3; what is longer is a corridor.
    pub max_depth_m: f64,
    /// Both ends of a gate that is deeper are gates of their own, in meters. Default 0.8: a thick wall with its frame.
    pub deep_m: f64,
    /// Gates of about one width and direction that are as near are one, in meters. Default 0.25.
    pub merge_m: f64,
    /// How far a doorway reaches beyond the faces of its wall, in meters. Default 0.2; people who label maps draw
    /// 0.1 to 0.5.
    pub margin_m: f64,
    /// Obstacles that stand free and are at most this long and wide are not seen, in meters. Default 0.4: the leg of a chair, or
    /// the base of one; chosen on generated buildings.
    pub max_speck_m: f64,
    /// Obstacles that stand free and are at most this long and wide are clutter, in meters. Default 1.2.
    pub max_furniture_m: f64,
    /// What was learned of gates.
    pub model: GateModel,
    /// Least probability of a doorway. Default 0.7 (`docs/default-model.md` has the curve).
    pub min_doorway: f64,
    /// A gate that is narrower, in cells, must have the form of a doorway. Default 8: the model has seen no coarser ones, and takes
    /// lines across a narrow corridor for doorways there.
    pub min_learned_cells: f64,
    /// Greatest depth of a doorway, in meters. Default 1.5; of a deeper passage each end may be one.
    pub max_doorway_depth_m: f64,
    /// Least probability of a doorway that has the form of one: `form_clear` or `form_supported` of at least 1, width and depth as
    /// below. Default 0.05.
    pub min_well_formed: f64,
    /// Width of a doorway by its form, in meters. Default 0.6 to 2.6: a wide double door.
    pub well_formed_width_m: [f64; 2],
    /// Greatest depth of a doorway by its form, in meters. Default 0.85: a thick wall with its frame.
    pub well_formed_depth_m: f64,
    /// Least probability that a gate parts two spaces. Default 0.05: what cuts a space
    /// need not be sure, as both sides may get one class (the same page).
    pub min_parting: f64,
    /// How much less probable a doorway may be that stood in an earlier result which is held on to. Default 0.3.
    pub held_lead: f64,
    /// How much more probable a doorway must be in cells where such a result had none. Default 0.1.
    pub new_lag: f64,
    /// How the direction of the walls around a gate is found.
    pub walls: WallConfig,
}

/// How the direction of the walls around a gate is found. All defaults were chosen on generated buildings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallConfig {
    /// The walls that are looked at reach this far from the center of a gate, in meters. Default 2.5.
    pub radius_m: f64,
    /// The gradient of the clearance is taken from this far to that far from a wall, in cells: nearer it is ragged, farther
    /// it belongs to what is beyond. Default 1.5 and 6.
    pub from_wall_cells: [f64; 2],
    /// Least agreement of the directions, 0 to 1: 0 for a round room, 1 for straight walls at right angles. Default 0.4.
    pub min_agreement: f64,
    /// A gate is turned by at most this angle, in degrees: what lies more askew is a door in another wall. Default 25.
    pub max_turn_deg: f64,
}

impl DoorwayConfig {
    /// These settings with what painted doorways added to the model of gates.
    pub fn heeding(&self, stumps: &[WeightedStump]) -> Cow<'_, Self> {
        if stumps.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut config = self.clone();
        config.model.doorway.classifier.stumps.extend(stumps);
        Cow::Owned(config)
    }
}

impl Default for DoorwayConfig {
    fn default() -> Self {
        Self {
            min_width_m: 0.4,
            max_width_m: 4.2,
            max_depth_m: 3.0,
            deep_m: 0.8,
            merge_m: 0.25,
            margin_m: 0.2,
            max_speck_m: 0.4,
            max_furniture_m: 1.2,
            model: GateModel::builtin(),
            min_doorway: 0.7,
            min_learned_cells: 8.0,
            max_doorway_depth_m: 1.5,
            min_well_formed: 0.05,
            well_formed_width_m: [0.6, 2.6],
            well_formed_depth_m: 0.85,
            min_parting: 0.05,
            held_lead: 0.3,
            new_lag: 0.1,
            walls: WallConfig::default(),
        }
    }
}

impl Default for WallConfig {
    fn default() -> Self {
        Self { radius_m: 2.5, from_wall_cells: [1.5, 6.0], min_agreement: 0.4, max_turn_deg: 25.0 }
    }
}
