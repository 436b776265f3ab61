//! `placegraph align`: the turn and the shift between the frames of two results.

use anyhow::{Context, Result};
use placegraph::topology::align::{MIN_LEAD, MIN_SCORE, align};
use serde_json::json;

use super::Outcome;
use crate::args::{AlignArgs, MAX_CELLS};
use crate::document;
use crate::output::{complain, print, print_json};

/// Prints the pose of the old frame in the new one, and how certain it is. Status 1 if it is not certain.
pub(crate) fn run(args: &AlignArgs) -> Result<Outcome> {
    let [old, new] = [&args.old, &args.new].map(|path| document::read(&document::path_in(path), MAX_CELLS));
    let found = align(&old?.topology(), &new?.topology())
        .context("expected two maps with places, found one without")?;
    let pose = found.new_from_old;
    let is_certain = found.is_certain();
    if args.json {
        print_json(&json!({
            "new_from_old": { "x": pose.x, "y": pose.y, "yaw_rad": pose.yaw_rad },
            "score": found.score, "runner_up": found.runner_up, "certain": is_certain,
        }))?;
    } else {
        let turn_deg = pose.yaw_rad.sin().atan2(pose.yaw_rad.cos()).to_degrees();
        print(&format!(
            "turn {turn_deg:.2} degrees, shift {:.2} {:.2} m; {:.0} % of the borders coincide (next solution {:.0} %)\n",
            pose.x,
            pose.y,
            100.0 * found.score,
            100.0 * found.runner_up
        ))?;
    }
    if !is_certain {
        let why = if found.score < MIN_SCORE {
            format!(
                "fewer than {:.0} % of the borders coincide: these are probably maps of different buildings",
                100.0 * MIN_SCORE
            )
        } else {
            format!(
                "the lead over the next solution is below {:.0} points: the building looks alike from several sides",
                100.0 * MIN_LEAD
            )
        };
        complain(&format!("not certain: {why}"));
    }
    Ok(if is_certain { Outcome::Done } else { Outcome::CheckFailed })
}
