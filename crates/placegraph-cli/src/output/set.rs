//! Files that are written as one: all of them, or none.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::export::is_stamped;
use placegraph::import;

use super::replace;
use crate::document::{Beside, DOCUMENT, SITE, head};

/// Files to be written into one folder together.
///
/// [`OutputSet::commit`] writes them all into a hidden folder inside the target, syncs them to the disk, and only then
/// moves them into place; other files in the target stay. The file that was added last vouches for the set: an
/// earlier one of its name is moved away first, and the new one is put in place after all others. So
/// whenever the program ends, killed or not, every file is whole, and where the last one stands the set is
/// complete. If anything fails, the target is as it was; if the program is killed in between, the next one that
/// writes there puts back what was.
///
/// Runs that write into one folder wait for each other.
#[derive(Debug)]
pub(crate) struct OutputSet {
    files: Vec<(String, Vec<u8>)>,
    existing: Existing,
    inputs: Vec<PathBuf>,
    kept: Vec<String>,
    force: bool,
}

/// What becomes of files that are there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    /// Those of the same names are replaced: the user named them.
    Replace,
    /// Those of the same names are replaced if this program wrote them: they bear its stamp, or a document next to them
    /// lists them. Else the set is refused.
    ReplaceOurs,
    /// As above; and the other files of the result that is replaced go.
    ReplaceResult,
}

/// What was done.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Committed {
    /// Names of the files that were written, in the order in which they were added.
    pub(crate) written: Vec<String>,
    /// Names of the files of an earlier result that do not belong to this one, and are gone.
    pub(crate) removed: Vec<String>,
}

impl OutputSet {
    /// A set without files.
    pub(crate) fn new(existing: Existing) -> Self {
        Self { files: Vec::new(), existing, inputs: Vec::new(), kept: Vec::new(), force: false }
    }

    /// Adds a file called `name`, without folders.
    pub(crate) fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// Adds files by name.
    pub(crate) fn extend(&mut self, files: Vec<(String, Vec<u8>)>) {
        self.files.extend(files);
    }

    /// Refuses to replace one of the `inputs`, and files of others, unless by `force`.
    pub(crate) fn keep_inputs(&mut self, inputs: &[PathBuf], force: bool) {
        self.inputs = inputs.to_vec();
        self.force = force;
    }

    /// The files of the result that is replaced that belong to the new one too, as they are.
    pub(crate) fn keep_files(&mut self, names: Vec<String>) {
        self.kept = names;
    }

    /// Writes all files into `folder`, which is made if it does not exist.
    pub(crate) fn commit(self, folder: &Path) -> Result<Committed> {
        self.check_names()?;
        let made = make_folder(folder)?;
        let written = self.write(folder);
        if written.is_err() {
            // What was made is empty: nothing was moved into it. If not, it is better left.
            for folder in made.iter().rev() {
                let _ = fs::remove_dir(folder);
            }
        }
        written
    }

    /// Refuses what [`OutputSet::commit`] would refuse for what stands in `folder` now, for sets that are written one after the other.
    pub(crate) fn check(&self, folder: &Path) -> Result<()> {
        self.check_names()?;
        let beside = self.beside(folder);
        self.files.iter().try_for_each(|(name, bytes)| self.check_target(folder, name, bytes, &beside))
    }

    fn beside(&self, folder: &Path) -> Beside {
        match self.existing {
            Existing::Replace => Beside::Nothing,
            Existing::ReplaceOurs | Existing::ReplaceResult => Beside::of(folder),
        }
    }

    fn check_names(&self) -> Result<()> {
        for (index, (name, _)) in self.files.iter().enumerate() {
            ensure!(
                Path::new(name).file_name() == Some(name.as_ref()),
                "expected a plain file name, found {name:?}"
            );
            ensure!(
                self.files[..index].iter().all(|(earlier, _)| earlier != name),
                "two outputs would be written to {name}"
            );
        }
        Ok(())
    }

    fn write(self, folder: &Path) -> Result<Committed> {
        let _lock = replace::lock_and_recover(folder)?;
        let beside = self.beside(folder);
        for (name, bytes) in &self.files {
            self.check_target(folder, name, bytes, &beside)?;
        }
        let removed = self.leftovers(folder, &beside);
        replace::replace(folder, &self.files, &removed)?;
        Ok(Committed { written: self.files.into_iter().map(|(name, _)| name).collect(), removed })
    }

    /// Refuses to replace what must not be lost.
    fn check_target(&self, folder: &Path, name: &str, bytes: &[u8], beside: &Beside) -> Result<()> {
        let path = folder.join(name);
        let Ok(metadata) = fs::symlink_metadata(&path) else { return Ok(()) };
        let kind = metadata.file_type();
        let shown = path.display();
        if !kind.is_file() {
            let what = if kind.is_dir() {
                "a folder"
            } else if kind.is_symlink() {
                "a symbolic link"
            } else {
                "a device or a pipe"
            };
            bail!("cannot write {shown}: {what} of this name exists");
        }
        if self.force {
            return Ok(());
        }
        // The document of the result that is replaced may be where its names come from.
        let is_document = self.existing == Existing::ReplaceResult
            && [DOCUMENT, SITE].contains(&name)
            && *beside != Beside::Nothing;
        let is_input = |input: &PathBuf| same_file::is_same_file(input, &path).unwrap_or(false);
        ensure!(
            is_document || !self.inputs.iter().any(is_input),
            "cannot write {shown}: it is an input of this run; choose another place for the output, or replace it \
             with --force"
        );
        let is_ours = || self.existing == Existing::Replace || is_document || beside.vouches_for(name);
        ensure!(
            is_ours() || self.bears_stamp(folder, name) || has_content(&path, bytes),
            "cannot write {shown}: a file of this name exists and is not known to be a result of placegraph; choose \
             another place for the output, or replace it with --force"
        );
        Ok(())
    }

    /// Whether the file says that this program wrote it. A picture cannot; the file that it goes with does.
    fn bears_stamp(&self, folder: &Path, name: &str) -> bool {
        let bears = |name: &str| is_stamped(&head(&folder.join(name)));
        let is_picture = Path::new(name).extension().is_some_and(|extension| extension == "png");
        bears(name) || (is_picture && self.files.first().is_some_and(|(main, _)| bears(main)))
    }

    /// The other files of the result that is replaced, those alone that are as this program wrote them.
    fn leftovers(&self, folder: &Path, beside: &Beside) -> Vec<String> {
        let (Existing::ReplaceResult, Beside::Result(files)) = (self.existing, beside) else {
            return Vec::new();
        };
        let stays =
            |name: &String| self.kept.contains(name) || self.files.iter().any(|(written, _)| written == name);
        let is_ours = |path: &Path, file: &placegraph::export::FileRecord| {
            path.is_file()
                && !path.is_symlink()
                && import::read(path, file.bytes).is_ok_and(|bytes| file.matches(&bytes))
        };
        let old = files.iter().filter(|file| !stays(&file.name));
        old.filter(|file| is_ours(&folder.join(&file.name), file)).map(|file| file.name.clone()).collect()
    }
}

/// Whether the file at `path` holds just these bytes already.
fn has_content(path: &Path, bytes: &[u8]) -> bool {
    import::read(path, bytes.len() as u64).is_ok_and(|found| found == bytes)
}

/// Makes `folder` and those above it that are missing; returns what was made, uppermost first.
fn make_folder(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut missing: Vec<PathBuf> = folder
        .ancestors()
        .take_while(|above| !above.as_os_str().is_empty() && !above.exists())
        .map(Path::to_owned)
        .collect();
    missing.reverse();
    let made = fs::create_dir_all(folder);
    if made.is_err() {
        for folder in missing.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
    made.with_context(|| format!("cannot make the folder {}", folder.display()))?;
    Ok(missing)
}

#[cfg(test)]
mod tests;
