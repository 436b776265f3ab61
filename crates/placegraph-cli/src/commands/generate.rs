//! `placegraph generate`: buildings with perfect labels.

use anyhow::{Context, Result, ensure};
use indicatif::{ParallelProgressIterator, ProgressBar};
use placegraph_generate::{Mapping, Options, Style, files, generate};
use rayon::prelude::*;

use super::Outcome;
use crate::args::{GenerateArgs, MappingArg, StyleArg};
use crate::output::{OutputSet, complain};

/// Makes every building in a folder of its own.
pub(crate) fn run(args: &GenerateArgs) -> Result<Outcome> {
    if let Some(resolution_m) = args.resolution {
        ensure!(
            (0.02..=0.2).contains(&resolution_m),
            "expected a resolution of 0.02 to 0.2, found {resolution_m}"
        );
    }
    let (style, options) =
        (style(args.style), Options { mapping: mapping(args.mapping), resolution_m: args.resolution });
    let last = args.first.checked_add(args.count).context("expected an index that fits in 64 bits")?;
    let bar = ProgressBar::new(args.count);
    (args.first..last).into_par_iter().progress_with(bar).try_for_each(|index| {
        let building = generate(style, args.seed, index, &options);
        let folder = args.out.join(format!("{}_{}_{index:03}", style.name(), args.seed));
        let mut set = OutputSet::default();
        for (name, bytes) in files(&building)? {
            set.add(name, bytes);
        }
        set.commit(&folder).map(drop)
    })?;
    complain(&format!("{} buildings in {}", args.count, args.out.display()));
    Ok(Outcome::Done)
}

fn style(style: StyleArg) -> Style {
    match style {
        StyleArg::Office => Style::Office,
        StyleArg::Home => Style::Home,
        StyleArg::Hospital => Style::Hospital,
        StyleArg::Hotel => Style::Hotel,
        StyleArg::School => Style::School,
        StyleArg::Warehouse => Style::Warehouse,
        StyleArg::Mixed => Style::Mixed,
    }
}

fn mapping(mapping: MappingArg) -> Mapping {
    match mapping {
        MappingArg::Slam => Mapping::Slam,
        MappingArg::Clean => Mapping::Clean,
        MappingArg::Furnished => Mapping::Furnished,
        MappingArg::Mixed => Mapping::Mixed,
    }
}
