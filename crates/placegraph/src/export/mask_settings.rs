//! Settings of Navigation 2's masks: costs, speed limits and zones.

use serde::Deserialize;

use super::{ExportError, Keepout, Rotated, SpeedLimit, ValueOf, ZonePer};
use crate::labels::{LabelSet, Role};

/// A mask file as written; every part is optional.
///
/// ```toml
/// zones = "place"             # or "class"
/// rotated = "resample"        # or "refuse"
///
/// [keepout]
/// elsewhere = 100
/// cost = { class = { doorway = 30 }, place = { "room 4" = 100 } }
///
/// [speed]
/// unit = "meters_per_second"  # or "percent"
/// limit = { class = { doorway = 0.3, corridor = 1.2 } }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MaskSettings {
    /// Where a robot must not go.
    pub keepout: Keepout,
    /// Speed limits; without any, half speed in doorways.
    pub speed: Option<SpeedLimit>,
    /// What a zone is.
    pub zones: ZonePer,
    /// How to make the mask of a rotated map.
    pub rotated: Rotated,
}

impl MaskSettings {
    /// The speed limits; if none are set, half speed in doorways.
    pub fn speed(&self, classes: &LabelSet) -> SpeedLimit {
        self.speed.clone().unwrap_or_else(|| {
            let doorways = classes.classes().iter().filter(|class| class.role == Role::Doorway);
            let class = doorways.map(|class| (class.name.clone(), 50.0)).collect();
            SpeedLimit::Percent { limit: ValueOf { class, ..ValueOf::default() } }
        })
    }

    /// Checks that every class with a value exists: a misspelled one would silently have no effect.
    ///
    /// # Errors
    /// If a class is not one of `classes`.
    pub fn check(&self, classes: &LabelSet) -> Result<(), ExportError> {
        let limits = match &self.speed {
            Some(SpeedLimit::Percent { limit } | SpeedLimit::MetersPerSecond { limit }) => Some(limit),
            None => None,
        };
        let mut names =
            [Some(&self.keepout.cost), limits].into_iter().flatten().flat_map(|values| values.class.keys());
        match names.find(|name| classes.label(name).is_none()) {
            None => Ok(()),
            Some(found) => Err(ExportError::UnknownClass {
                found: found.clone(),
                known: classes.classes().iter().map(|class| class.name.clone()).collect(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_read_and_classes_are_checked() {
        let text = "zones = 'place'\nrotated = 'resample'\n\
                    [keepout]\nelsewhere = 100\ncost = { class = { doorway = 30 }, place = { 'room 4' = 100 } }\n\
                    [speed]\nunit = 'meters_per_second'\nlimit = { class = { doorway = 0.3, corridor = 1.2 } }\n";
        let masks: MaskSettings = toml::from_str(text).unwrap();
        assert_eq!((masks.zones, masks.rotated), (ZonePer::Place, Rotated::Resample));
        masks.check(&LabelSet::default()).unwrap();
        let wrong: MaskSettings = toml::from_str(&text.replace("corridor", "coridor")).unwrap();
        let message = wrong.check(&LabelSet::default()).unwrap_err().to_string();
        assert!(message.contains("coridor") && message.contains("corridor, room, doorway"), "{message}");
        assert!(toml::from_str::<MaskSettings>("zone = 'place'").is_err());
    }

    #[test]
    fn doorways_halve_the_speed_by_default() {
        assert_eq!(MaskSettings::default().speed(&LabelSet::default()), SpeedLimit::default());
    }
}
