//! Maps as the arguments say they are read, with the check's findings told to the user.

use std::path::Path;

use anyhow::Result;
use placegraph::import::{self, Gray205, ImageFolder, LoadedMap, ReadOptions, ros::Rules};

use crate::args::{ReadArgs, RulesArg};

/// The reader's options that the arguments ask for.
pub(crate) fn options(args: &ReadArgs) -> ReadOptions {
    ReadOptions {
        resolution_m: args.resolution,
        rules: match args.rules {
            RulesArg::Nav2 => Rules::Nav2,
            RulesArg::Ros1 => Rules::Ros1,
        },
        gray_205: if args.trust_thresholds { Gray205::AsFile } else { Gray205::Unknown },
        image_folder: if args.allow_outside { ImageFolder::Anywhere } else { ImageFolder::Inside },
        max_cells: args.max_cells,
        ..ReadOptions::default()
    }
}

/// Reads the map at `path`.
pub(crate) fn map(path: &Path, args: &ReadArgs) -> Result<LoadedMap> {
    Ok(import::load_map(path, &options(args))?)
}
