//! Writes a set of files as one: all of them, or none.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

/// What unfinished sets are called in the folder that they will go to.
const STAGING: &str = ".placegraph-";

/// Files to be written into one folder together.
///
/// [`OutputSet::commit`] writes them all into a hidden folder inside the target, syncs them to the disk, and only then
/// renames them into place; other files in the target stay. The file that was added last vouches for the set: an
/// earlier one of its name is removed before the first rename, and the new one is put in place after all others. So
/// whenever the program ends, killed or not, every file is whole, and where the last one stands the set is
/// complete. If anything fails before the first rename, the target is as it was.
///
/// Runs that write into one folder wait for each other. What a killed run left there is removed by the next one.
#[derive(Debug, Default)]
pub(crate) struct OutputSet {
    files: Vec<(String, Vec<u8>)>,
}

impl OutputSet {
    /// Adds a file called `name`, without folders.
    pub(crate) fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// The files so far, in the order in which they were added.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()))
    }

    /// Writes all files into `folder`, which is made if it does not exist. Returns their paths in the order in
    /// which they were added.
    pub(crate) fn commit(self, folder: &Path) -> Result<Vec<PathBuf>> {
        self.check_names(folder)?;
        let made = make_folder(folder)?;
        let written = self.write(folder);
        if written.is_err() {
            // What was made is empty: nothing was renamed into it. If not, it is better left.
            for folder in made.iter().rev() {
                let _ = fs::remove_dir(folder);
            }
        }
        written
    }

    fn check_names(&self, folder: &Path) -> Result<()> {
        for (index, (name, _)) in self.files.iter().enumerate() {
            ensure!(
                Path::new(name).file_name() == Some(name.as_ref()),
                "expected a plain file name, found {name:?}"
            );
            ensure!(
                self.files[..index].iter().all(|(earlier, _)| earlier != name),
                "two outputs would be written to {name}"
            );
            let path = folder.join(name);
            ensure!(!path.is_dir(), "cannot write {}: a folder of this name exists", path.display());
        }
        Ok(())
    }

    fn write(self, folder: &Path) -> Result<Vec<PathBuf>> {
        let cannot_write = || format!("cannot write into {}", folder.display());
        let _lock = lock_and_clean(folder);
        // Inside the target: renames then stay on one file system.
        let staging =
            tempfile::Builder::new().prefix(STAGING).tempdir_in(folder).with_context(cannot_write)?;
        for (name, bytes) in &self.files {
            let path = staging.path().join(name);
            let write = || -> std::io::Result<()> {
                let mut file = File::create(&path)?;
                file.write_all(bytes)?;
                file.sync_all()
            };
            write().with_context(|| format!("cannot write {name} into {}", folder.display()))?;
        }
        let last = match self.files.as_slice() {
            [_, .., (last, _)] => Some(last),
            _ => None,
        };
        if let Some(name) = last {
            let path = folder.join(name);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(error).with_context(|| format!("cannot replace {}", path.display()));
                }
                _ => {}
            }
        }
        let mut paths = Vec::with_capacity(self.files.len());
        for (name, _) in &self.files {
            let path = folder.join(name);
            fs::rename(staging.path().join(name), &path)
                .with_context(|| format!("cannot put {} into place", path.display()))?;
            paths.push(path);
        }
        Ok(paths)
    }
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

/// Waits until no other run writes into `folder`, for as long as the lock is kept, and removes what killed ones left.
/// Where folders cannot be locked, all is left as it is.
fn lock_and_clean(folder: &Path) -> Option<File> {
    let lock = File::open(folder).ok()?;
    lock.lock().ok()?;
    for entry in fs::read_dir(folder).ok()?.flatten() {
        let is_left = entry.file_name().to_string_lossy().starts_with(STAGING);
        if is_left && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
    Some(lock)
}

/// Writes one file completely or not at all.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let name =
        path.file_name().with_context(|| format!("expected the path of a file, found {}", path.display()))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut files = OutputSet::default();
    files.add(name.to_string_lossy(), bytes);
    files.commit(folder)?;
    Ok(())
}

/// Prints results on standard output. Whoever reads it may stop: the command goes on, and its status stands.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints results as JSON on standard output.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<()> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}

/// Tells people something on standard error; nobody listening there is no error.
pub(crate) fn complain(message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}

/// `fields` as a line of comma-separated values (RFC 4180, with plain line ends).
pub(crate) fn csv_row(fields: impl Iterator<Item = String>) -> String {
    let escaped = |field: String| {
        if field.contains(['"', ',', '\n', '\r']) {
            format!("\"{}\"", field.replace('"', "\"\""))
        } else {
            field
        }
    };
    fields.map(escaped).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(files: &[(&str, &str)]) -> OutputSet {
        let mut set = OutputSet::default();
        for (name, text) in files {
            set.add(*name, *text);
        }
        set
    }

    fn names(folder: &Path) -> Vec<String> {
        let entry = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(entry).collect();
        names.sort();
        names
    }

    #[test]
    fn files_are_replaced_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a"), "old").unwrap();
        fs::write(folder.path().join("other"), "mine").unwrap();
        let paths = set(&[("b", "2"), ("a", "1")]).commit(folder.path()).unwrap();
        assert_eq!(paths, [folder.path().join("b"), folder.path().join("a")]);
        assert_eq!(names(folder.path()), ["a", "b", "other"]);
        assert_eq!(fs::read_to_string(folder.path().join("a")).unwrap(), "1");
        assert_eq!(fs::read_to_string(folder.path().join("other")).unwrap(), "mine");
    }

    #[test]
    fn a_missing_folder_is_made() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("x/y");
        set(&[("a", "1")]).commit(&deep).unwrap();
        assert_eq!(names(&deep), ["a"]);
    }

    #[test]
    fn nothing_is_written_if_one_file_cannot_be() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a"), "old").unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        let error = set(&[("a", "new"), ("b", "2")]).commit(folder.path()).unwrap_err();
        assert!(format!("{error:#}").contains("a folder of this name exists"), "{error:#}");
        let too_long = "x".repeat(300);
        let error = set(&[("a", "new"), (&too_long, "2")]).commit(folder.path()).unwrap_err();
        assert!(format!("{error:#}").starts_with("cannot write"), "{error:#}");
        assert_eq!(names(folder.path()), ["a", "b"]);
        assert_eq!(fs::read_to_string(folder.path().join("a")).unwrap(), "old");

        let new = folder.path().join("new");
        assert!(set(&[("a", "1"), (&too_long, "2")]).commit(&new).is_err());
        assert!(!new.exists());
    }

    #[test]
    fn folders_that_were_made_for_nothing_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let too_long = "x".repeat(300);
        assert!(set(&[(&too_long, "")]).commit(&folder.path().join("a/b/c")).is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_a_killed_run_left_is_removed_and_other_hidden_files_are_not() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(".placegraph-killed")).unwrap();
        fs::write(folder.path().join(".placegraph-killed/labels.png"), "half").unwrap();
        fs::write(folder.path().join(".placegraph-note"), "mine").unwrap();
        fs::create_dir(folder.path().join(".git")).unwrap();
        set(&[("a", "1")]).commit(folder.path()).unwrap();
        assert_eq!(names(folder.path()), [".git", ".placegraph-note", "a"]);
    }

    #[test]
    fn the_last_file_is_there_only_with_all_others() {
        let folder = tempfile::tempdir().unwrap();
        set(&[("a", "1"), ("b", "1"), ("last", "1")]).commit(folder.path()).unwrap();
        // A folder in the way of the second file, found only at its rename.
        let blocked = set(&[("a", "2"), ("b", "2"), ("last", "2")]);
        fs::remove_file(folder.path().join("b")).unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        fs::write(folder.path().join("b/in"), "").unwrap();
        assert!(blocked.write(folder.path()).is_err());
        assert_eq!(names(folder.path()), ["a", "b"]);
    }

    #[test]
    fn sets_of_many_threads_are_never_mixed() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let path = folder.path();
                scope.spawn(move || {
                    let text = writer.to_string();
                    set(&[("a", &text), ("b", &text), ("c", &text)]).commit(path).unwrap();
                });
            }
        });
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(names(folder.path()), ["a", "b", "c"]);
        assert!(read("a") == read("b") && read("b") == read("c"));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        let error = set(&[("a", "1")]).commit(&folder.path().join("file/below")).unwrap_err();
        assert!(format!("{error:#}").contains("file/below"), "{error:#}");
    }

    #[test]
    fn names_are_plain_and_unique() {
        let folder = tempfile::tempdir().unwrap();
        for bad in [&[("../a", "")][..], &[("", "")], &[("a/b", "")], &[("a", ""), ("a", "")]] {
            assert!(set(bad).commit(folder.path()).is_err());
        }
        assert!(names(folder.path()).is_empty());
    }
}
