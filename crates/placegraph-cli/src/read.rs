//! Reads maps as the arguments say, and shows the findings of the check to the user.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use placegraph::export::MaskSettings;
use placegraph::import::{self, Gray205, LoadedMap, MapError, NamedFiles, ReadOptions, ros::Rules};
use placegraph::model::sha256_hex;
use placegraph::syntax::from_toml;

use crate::args::{ReadArgs, RulesArg};
use crate::hints;

/// The reader's options that the arguments ask for.
pub(crate) fn options(args: &ReadArgs) -> ReadOptions {
    ReadOptions {
        resolution_m: args.resolution,
        rules: match args.rules {
            RulesArg::Jazzy => Rules::Jazzy,
            RulesArg::Humble => Rules::Humble,
            RulesArg::Ros1 => Rules::Ros1,
        },
        gray_205: if args.trust_thresholds { Gray205::AsFile } else { Gray205::Unknown },
        named_files: if args.allow_outside { NamedFiles::Anywhere } else { NamedFiles::Inside },
        topic: args.topic.clone(),
        max_cells: args.max_cells,
        ..ReadOptions::default()
    }
}

/// Reads the map at `path`.
pub(crate) fn map(path: &Path, args: &ReadArgs) -> Result<LoadedMap> {
    load(path, &options(args))
}

/// Reads the map at `path`; an error names the option that helps.
pub(crate) fn load(path: &Path, options: &ReadOptions) -> Result<LoadedMap> {
    import::load_map(path, options).map_err(told)
}

/// An error with the option that helps.
pub(crate) fn told(error: MapError) -> anyhow::Error {
    match hints::against(&error) {
        Some(option) => anyhow!("{error}; {option}"),
        None => error.into(),
    }
}

/// Reads a TOML file, called a `what` where it cannot be read.
pub(crate) fn text(path: &Path, what: &str) -> Result<String> {
    let could_not = || format!("could not read the {what} {}", path.display());
    let bytes = import::read(path, import::MAX_TEXT_BYTES).with_context(could_not)?;
    String::from_utf8(bytes).with_context(could_not)
}

/// Reads an image of labels, rooms or regions with at most `max_cells` pixels.
pub(crate) fn image(path: &Path, max_cells: u64) -> Result<Vec<u8>> {
    import::read_cells(path, max_cells).with_context(|| format!("could not read {}", path.display()))
}

/// The mask file at `path` and the hash of its bytes, or what holds without one.
pub(crate) fn masks(path: Option<&Path>) -> Result<(MaskSettings, Option<String>)> {
    let Some(path) = path else { return Ok((MaskSettings::default(), None)) };
    let text = text(path, "mask file")?;
    let masks = from_toml(&text).with_context(|| format!("expected a mask file in {}", path.display()))?;
    Ok((masks, Some(sha256_hex(text.as_bytes()))))
}
