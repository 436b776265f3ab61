//! `placegraph features`: the registry of features.

use anyhow::Result;
use placegraph::features;

use super::Outcome;
use crate::args::{FeaturesArgs, ListFormat};
use crate::output::print;

/// Lists the features.
pub(crate) fn run(args: &FeaturesArgs) -> Result<Outcome> {
    match args.format {
        ListFormat::Md => print(&features::markdown())?,
        ListFormat::Text => {
            let lines = features::registry()
                .iter()
                .map(|feature| format!("{:<10} {:<6} {}\n", feature.name, feature.unit, feature.described()));
            print(&lines.collect::<String>())?;
        }
    }
    Ok(Outcome::Done)
}
