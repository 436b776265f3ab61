//! Floor plans and flats that `generate` maps.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::import;
use placegraph_generate::{Survey, read_flat, read_plan_xml};

use crate::output::complain;

/// Largest file of plans, in bytes.
const MAX_BYTES: u64 = 1 << 28;

/// A building and what it is called in the names of folders.
pub(super) struct NamedPlan {
    pub(super) name: String,
    pub(super) survey: Survey,
}

/// Reads all plans of the files, in their order. Flats that cannot be used are reported and skipped.
pub(super) fn read(paths: &[PathBuf]) -> Result<Vec<NamedPlan>> {
    let mut plans: Vec<NamedPlan> = Vec::new();
    for path in paths {
        let could_not = || format!("could not read the plan {}", path.display());
        let text = String::from_utf8(import::read(path, MAX_BYTES).with_context(could_not)?)
            .with_context(could_not)?;
        let stem = safe_stem(path);
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("xml") => {
                plans.push(NamedPlan { name: stem, survey: read_plan_xml(&text).with_context(could_not)? });
            }
            Some("jsonl" | "json") => {
                for (line, text) in (1..).zip(text.lines()).filter(|(_, text)| !text.trim().is_empty()) {
                    match read_flat(text) {
                        Ok(survey) => plans.push(NamedPlan { name: format!("{stem}-{line:04}"), survey }),
                        Err(error) => complain(&format!("{}: line {line}: {error}", path.display())),
                    }
                }
            }
            _ => bail!("expected a plan called .xml, .jsonl or .json, found {}", path.display()),
        }
    }
    ensure!(!plans.is_empty(), "expected at least one plan that can be read, found none");
    for (index, plan) in plans.iter().enumerate() {
        let is_new = plans[..index].iter().all(|earlier| earlier.name != plan.name);
        ensure!(is_new, "expected plans with different names, found {} twice", plan.name);
    }
    Ok(plans)
}

/// The name of the file without its extension, in letters that every file system takes.
fn safe_stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' }).collect()
}
