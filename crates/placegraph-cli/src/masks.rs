//! The mask file: costs, speed limits and zones for Navigation 2's masks.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use placegraph::export::{Keepout, Rotated, SpeedLimit, ValueOf, ZonePer};
use placegraph::labels::{LabelSet, Role};
use serde::Deserialize;

use crate::read;

/// A mask file as written; every part may be left out.
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
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Masks {
    /// Where a robot must not go.
    pub(crate) keepout: Keepout,
    speed: Option<SpeedLimit>,
    /// What a zone is.
    pub(crate) zones: ZonePer,
    /// What becomes of a rotated map.
    pub(crate) rotated: Rotated,
}

impl Masks {
    /// The file at `path`, or what holds without one.
    pub(crate) fn load(path: Option<&Path>) -> Result<Self> {
        let Some(path) = path else { return Ok(Self::default()) };
        let text = read::text(path, "mask file")?;
        toml::from_str(&text).with_context(|| format!("expected a mask file in {}", path.display()))
    }

    /// The speed limits; without any written, half speed in doorways.
    pub(crate) fn speed(&self, classes: &LabelSet) -> SpeedLimit {
        self.speed.clone().unwrap_or_else(|| {
            let doorways = classes.classes().iter().filter(|class| class.role == Role::Doorway);
            let class = doorways.map(|class| (class.name.clone(), 50.0)).collect();
            SpeedLimit::Percent { limit: ValueOf { class, ..ValueOf::default() } }
        })
    }

    /// Checks that every class with a value exists: a misspelled one would silently have no effect.
    pub(crate) fn check(&self, classes: &LabelSet) -> Result<()> {
        let limits = match &self.speed {
            Some(SpeedLimit::Percent { limit } | SpeedLimit::MetersPerSecond { limit }) => Some(limit),
            None => None,
        };
        for name in [Some(&self.keepout.cost), limits].into_iter().flatten().flat_map(|v| v.class.keys()) {
            ensure!(
                classes.label(name).is_some(),
                "expected one of the model's classes in the mask file, found {name:?}"
            );
        }
        Ok(())
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
        let masks: Masks = toml::from_str(text).unwrap();
        assert_eq!((masks.zones, masks.rotated), (ZonePer::Place, Rotated::Resample));
        masks.check(&LabelSet::default()).unwrap();
        let wrong: Masks = toml::from_str(&text.replace("corridor", "coridor")).unwrap();
        assert!(wrong.check(&LabelSet::default()).unwrap_err().to_string().contains("coridor"));
        assert!(toml::from_str::<Masks>("zone = 'place'").is_err());
    }

    #[test]
    fn doorways_halve_the_speed_by_default() {
        assert_eq!(Masks::default().speed(&LabelSet::default()), SpeedLimit::default());
    }
}
