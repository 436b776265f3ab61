//! `placegraph info`: the check of a map.

use anyhow::Result;
use placegraph::import::check;

use super::Outcome;
use crate::args::InfoArgs;
use crate::output::{print, print_json};
use crate::read;

/// Tells what the map is and what to do about it.
pub(crate) fn run(args: &InfoArgs) -> Result<Outcome> {
    let map = read::map(&args.map, &args.read)?;
    let check = check(&map);
    if args.json {
        print_json(&check)?;
    } else {
        print(&check.to_string())?;
    }
    Ok(Outcome::Done)
}
