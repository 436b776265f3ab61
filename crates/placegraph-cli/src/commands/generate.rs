//! `placegraph generate`: buildings with perfect labels.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use indicatif::{ParallelProgressIterator, ProgressBar};
use placegraph::grid::OccupancyGrid;
use placegraph_generate::{
    Building, Options, files, generate, generate_growing, generate_surveyed, map_files,
};
use rayon::prelude::*;

use super::{Outcome, plans};
use crate::args::GenerateArgs;
use crate::output::{Existing, OutputSet, complain};

/// Makes every building in a folder of its own.
pub(crate) fn run(args: &GenerateArgs) -> Result<Outcome> {
    if let Some(resolution_m) = args.resolution {
        ensure!(
            (0.02..=0.2).contains(&resolution_m),
            "expected a resolution of 0.02 to 0.2, found {resolution_m}"
        );
    }
    let options = Options { mapping: args.mapping, resolution_m: args.resolution };
    if args.plan.is_empty() {
        let style = args.style;
        return write_all(args, args.count.unwrap_or(1), |index| {
            let name = format!("{}_{}_{index:03}", style.name(), args.seed);
            let (building, growing) = match args.growing {
                Some(every) => generate_growing(style, args.seed, index, args.resolution, every),
                None => (generate(style, args.seed, index, &options), Vec::new()),
            };
            Ok(Made { name, building, growing })
        });
    }
    let plans = plans::read(&args.plan)?;
    write_all(args, args.count.unwrap_or(plans.len() as u64), |index| {
        let plan = &plans[(index % plans.len() as u64) as usize];
        let round = index / plans.len() as u64;
        let building = generate_surveyed(&plan.survey, &plan.name, args.seed, round, &options);
        let mut building = building.with_context(|| format!("plan {}", plan.name))?;
        building.license.clone_from(&args.license);
        let name = format!("{}_{}_{round:03}", plan.name, args.seed);
        Ok(Made { name, building, growing: Vec::new() })
    })
}

/// A building and how its map grew.
struct Made {
    name: String,
    building: Building,
    growing: Vec<OccupancyGrid>,
}

impl Made {
    /// Writes all files into the folder of its name in `folder`; those of the growing map into `growing` in it.
    fn write(&self, folder: &Path) -> Result<()> {
        let folder = folder.join(&self.name);
        let mut set = OutputSet::new(Existing::Replace);
        for (name, bytes) in files(&self.building)? {
            set.add(name, bytes);
        }
        set.commit(&folder)?;
        if !self.growing.is_empty() {
            let mut set = OutputSet::new(Existing::Replace);
            for (map, step) in self.growing.iter().zip(1..) {
                let picture = format!("{step:04}.png");
                let [yaml, bytes] = map_files(map, &picture)?;
                set.add(picture, bytes);
                set.add(format!("{step:04}.yaml"), yaml);
            }
            set.commit(&folder.join("growing"))?;
        }
        Ok(())
    }
}

/// Makes buildings `first` to `first + count` and writes each into the folder of its name. One that cannot be made does not stop
/// the others.
fn write_all(args: &GenerateArgs, count: u64, make: impl Fn(u64) -> Result<Made> + Sync) -> Result<Outcome> {
    let last = args.first.checked_add(count).context("expected an index that fits in 64 bits")?;
    let bar = ProgressBar::new(count);
    let failed = (args.first..last).into_par_iter().progress_with(bar).map(|index| match make(index) {
        Ok(made) => made.write(&args.out).map(|()| 0),
        Err(error) => {
            complain(&format!("error: {error:#}"));
            Ok(1)
        }
    });
    let n_failed = failed.try_reduce(|| 0, |a, b| Ok::<u64, anyhow::Error>(a + b))?;
    complain(&format!("{} buildings in {}", count - n_failed, args.out.display()));
    Ok(if n_failed == 0 { Outcome::Done } else { Outcome::CheckFailed })
}
