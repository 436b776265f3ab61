//! `placegraph edit`: adds a correction to an edit file.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use placegraph::topology::TopologicalMap;
use placegraph::topology::edits::{Edit, EditFile, Target};
use placegraph::topology::query::place_called;

use super::Outcome;
use crate::args::{EditArgs, MAX_CELLS};
use crate::output::complain;
use crate::{document, read};

/// Adds the edit at the end of the file; what stands there stays as it is.
pub(crate) fn run(args: &EditArgs) -> Result<Outcome> {
    let mut edit = args.action.edit();
    let before = if args.file.exists() { read::text(&args.file, "edit file")? } else { String::new() };
    let wrong = || format!("in {}", args.file.display());
    let earlier = EditFile::from_toml(&before).with_context(wrong)?;
    let mut named = Vec::new();
    if let Some(result) = &args.result {
        let document = document::read(&document::path_in(result), MAX_CELLS)?;
        if let Edit::Relabel { class, .. } = &edit {
            let known: Vec<&str> =
                document.classes.classes().iter().map(|class| class.name.as_str()).collect();
            ensure!(known.contains(&class.as_str()), "expected one of {}, found {class:?}", known.join(", "));
        }
        named = pin(&mut edit, &document.topology(), &earlier)
            .with_context(|| format!("in {}", result.display()))?;
    }
    let mut text = before;
    if !text.is_empty() {
        text.push_str(if text.ends_with('\n') { "\n" } else { "\n\n" });
    }
    if !named.is_empty() {
        text.extend(["# ", named.join(", ").as_str(), "\n"]);
    }
    let action = edit.action();
    text.push_str(&toml::to_string(&EditFile { edits: vec![edit] })?);
    let file = EditFile::from_toml(&text).with_context(wrong)?;
    write(&args.file, &text)?;
    complain(&format!("{}: added {action} as edit {}", args.file.display(), file.edits.len()));
    Ok(Outcome::Done)
}

/// Replaces names by points inside of the places of `map`, and returns the names. A name that only an earlier edit gives stays:
/// the place will have it when this edit is replayed.
fn pin(edit: &mut Edit, map: &TopologicalMap, earlier: &EditFile) -> Result<Vec<String>> {
    let is_given = |wanted: &str| {
        earlier.edits.iter().any(|edit| matches!(edit, Edit::Rename { name, .. } if name == wanted))
    };
    let mut named = Vec::new();
    for target in edit.targets_mut() {
        let Target::Named(name) = target else { continue };
        match place_called(map, name) {
            Ok(place) => {
                named.push(place.name.clone());
                *target = Target::Point([place.anchor.x, place.anchor.y]);
            }
            Err(_) if is_given(name) => {}
            Err(unknown) => return Err(unknown.into()),
        }
    }
    Ok(named)
}

/// Writes the file whole or not at all; a link is followed.
fn write(path: &Path, text: &str) -> Result<()> {
    let could_not = || format!("could not write {}", path.display());
    let target: PathBuf =
        if path.exists() { fs::canonicalize(path).with_context(could_not)? } else { path.into() };
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder).with_context(could_not)?;
    if let Ok(found) = fs::metadata(&target) {
        file.as_file().set_permissions(found.permissions()).with_context(could_not)?;
    } else {
        readable(file.path()).with_context(could_not)?;
    }
    file.write_all(text.as_bytes()).with_context(could_not)?;
    file.as_file().sync_all().with_context(could_not)?;
    file.persist(&target).with_context(could_not)?;
    Ok(())
}

/// Temporary files are private; an edit file is not.
#[cfg(unix)]
fn readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_: &Path) -> std::io::Result<()> {
    Ok(())
}
