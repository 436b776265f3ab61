//! `placegraph map`: labels, regions and the topological map of one or many maps.
//!
//! What was typed becomes a [`setup::Setup`], every map a [`jobs::Job`]; a job is labeled ([`result`]) and written,
//! or kept if its result is still what it would be ([`resume`]); [`one`] and [`batch`] tell about it.

mod batch;
mod changes;
mod jobs;
mod one;
mod result;
mod resume;
mod setup;
mod table;

use anyhow::Result;

pub(super) use self::result::{export_option, seal};

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
