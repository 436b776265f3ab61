//! Writes a set of files as one: all of them, or none.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

/// Files to be written into one folder together.
///
/// [`OutputSet::commit`] writes them all into a temporary folder inside the target, syncs them to the disk,
/// and only then renames them into place; other files in the target stay. If anything fails before the first
/// rename, the target is as it was. A rename within one folder fails only if the folder changes meanwhile.
#[derive(Debug, Default)]
pub(crate) struct OutputSet {
    files: Vec<(String, Vec<u8>)>,
}

impl OutputSet {
    /// Adds a file called `name`, without folders.
    pub(crate) fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        self.files.push((name.into(), bytes.into()));
    }

    /// Writes all files into `folder`, which is made if it does not exist. Returns their paths in the order in
    /// which they were added.
    pub(crate) fn commit(self, folder: &Path) -> Result<Vec<PathBuf>> {
        self.check_names(folder)?;
        let is_new = !folder.exists();
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let written = self.write(folder);
        if written.is_err() && is_new {
            // It is empty: nothing was renamed into it. If not, it is better left.
            let _ = fs::remove_dir(folder);
        }
        written
    }

    fn check_names(&self, folder: &Path) -> Result<()> {
        for (index, (name, _)) in self.files.iter().enumerate() {
            ensure!(Path::new(name).file_name() == Some(name.as_ref()), "expected a plain file name, found {name:?}");
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
        // Inside the target: renames then stay on one file system.
        let staging =
            tempfile::Builder::new().prefix(".placegraph-").tempdir_in(folder).with_context(cannot_write)?;
        for (name, bytes) in &self.files {
            let path = staging.path().join(name);
            let write = || -> std::io::Result<()> {
                let mut file = File::create(&path)?;
                file.write_all(bytes)?;
                file.sync_all()
            };
            write().with_context(|| format!("cannot write {name} into {}", folder.display()))?;
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
