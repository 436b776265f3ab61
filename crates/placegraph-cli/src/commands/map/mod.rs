//! `placegraph map`: labels, regions and the topological map of one or many maps.
//!
//! What was typed becomes a [`setup::Setup`], every map a [`jobs::Job`]; a job is labeled ([`result`]) and written,
//! or kept if its result is still what it would be ([`resume`]); [`one`] and [`batch`] report it.

mod batch;
mod changes;
mod jobs;
mod one;
mod result;
mod resume;
mod setup;
mod table;

use anyhow::{Result, bail};

pub(super) use self::jobs::{is_folder_of_maps, maps_in};
pub(super) use self::one::{Prepared, removal};
pub(super) use self::result::join;
pub(super) use self::setup::read_edits;

use self::setup::Setup;
use super::Outcome;
use crate::args::MapArgs;

/// Labels every map; with several, one that fails does not stop the rest. The status is 1 where a result lacks
/// something that was asked for, or a finding is an error.
pub(crate) fn run(args: &MapArgs, verbose: bool) -> Result<Outcome> {
    let jobs = jobs::jobs(&args.maps, &args.out)?;
    let setup = Setup::new(args, &jobs)?;
    match jobs.as_slice() {
        [job] if setup.is_single && !args.resume => one::run(job, &setup, verbose),
        _ => batch::run(&jobs, &setup, verbose),
    }
}

/// Labels the only map of `args`; its result is still to be written.
pub(super) fn prepare(args: &MapArgs) -> Result<Prepared> {
    let jobs = jobs::jobs(&args.maps, &args.out)?;
    let setup = Setup::new(args, &jobs)?;
    match jobs.as_slice() {
        [job] if setup.is_single => Prepared::new(job, &setup),
        _ => bail!("expected the file of a map, found the folder {}", args.maps[0].display()),
    }
}
