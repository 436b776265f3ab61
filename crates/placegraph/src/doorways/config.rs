//! Every tuned number of this stage.
//!
//! Where no other source is named, a number was chosen on generated buildings, with no real map looked at
//! (`docs/default-model.md`, "What was tried"). Numbers in whole and half cells that follow from how cells are drawn stand where they are used.

/// The sizes of doors and of the spaces beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoorwayConfig {
    /// Narrowest doorway between its jambs, in meters. Default 0.6: chosen on generated buildings.
    pub min_width_m: f64,
    /// Widest doorway between its jambs, in meters. Default 2: a double door.
    pub max_width_m: f64,
    /// Longest narrow part in the direction of passage, in meters. Default 0.8: a thick wall with its frame; what is
    /// longer is a corridor.
    pub max_depth_m: f64,
    /// How far a doorway reaches beyond the faces of its wall, in meters. Default 0.2; people who label maps draw
    /// 0.1 to 0.5.
    pub margin_m: f64,
    /// Obstacles that stand free and are at most this long and wide are not seen, in meters. Default 0.4: the leg of a chair, or
    /// the base of one; chosen on generated buildings.
    pub max_speck_m: f64,
    /// What makes a gate a doorway whatever the labels are.
    pub clear: GateRule,
    /// What makes a gate a doorway that the labels support.
    pub plausible: GateRule,
    /// The support of the labels that is enough, 0 to 1: the mean probability of a doorway in it, or the
    /// difference of the two sides in the mean probability of another class. Default 0.5: chosen on generated buildings.
    pub min_support: f64,
    /// How far the two sides of a gate are looked at.
    pub walks: WalkConfig,
    /// How the direction of the walls around a gate is found.
    pub walls: WallConfig,
}

/// What is asked of the surroundings of a gate, on both of its sides. All defaults were chosen on generated buildings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GateRule {
    /// Shortest way from one side to the other around the gate, in meters. Default 6 for a clear gate, 2.5 for a plausible one.
    pub min_bypass_m: f64,
    /// Least length of the walls or other obstacles that are its jambs, in meters. Default 2 and 0.8.
    pub min_jamb_m: f64,
    /// How many times wider than the gate the space is somewhere within [`WalkConfig::near_m`]. Default 1.3 and 1.1.
    pub near_widening: f64,
    /// The same within [`WalkConfig::far_m`]. Default 1.5 and 1.33.
    pub far_widening: f64,
    /// Least area within [`WalkConfig::far_m`], in square meters. Default 1 for both.
    pub min_area_m2: f64,
}

/// How far the two sides of a gate are looked at, along walks that start at the gate. All defaults were chosen on generated
/// buildings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkConfig {
    /// Just behind the door, in meters. Default 0.6.
    pub near_m: f64,
    /// In the space behind it, in meters. Default 1.
    pub far_m: f64,
    /// From where to where the labels of that space are read, in meters. Default 0.4 and 1.5.
    pub labels_m: [f64; 2],
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

impl Default for DoorwayConfig {
    fn default() -> Self {
        Self {
            min_width_m: 0.6,
            max_width_m: 2.0,
            max_depth_m: 0.8,
            margin_m: 0.2,
            max_speck_m: 0.4,
            clear: GateRule {
                min_bypass_m: 6.0,
                min_jamb_m: 2.0,
                near_widening: 1.3,
                far_widening: 1.5,
                min_area_m2: 1.0,
            },
            plausible: GateRule {
                min_bypass_m: 2.5,
                min_jamb_m: 0.8,
                near_widening: 1.1,
                far_widening: 1.33,
                min_area_m2: 1.0,
            },
            min_support: 0.5,
            walks: WalkConfig::default(),
            walls: WallConfig::default(),
        }
    }
}

impl Default for WalkConfig {
    fn default() -> Self {
        Self { near_m: 0.6, far_m: 1.0, labels_m: [0.4, 1.5] }
    }
}

impl Default for WallConfig {
    fn default() -> Self {
        Self { radius_m: 2.5, from_wall_cells: [1.5, 6.0], min_agreement: 0.4, max_turn_deg: 25.0 }
    }
}
