//! Where a single output goes that the user named.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::set::{Existing, OutputSet};

/// What an argument for an output names.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// `-`, and what names the same.
    StandardOutput,
    /// A file in a folder; symbolic links are followed.
    File {
        /// The folder.
        folder: PathBuf,
        /// The name of the file in it.
        name: String,
    },
    /// An existing folder.
    Folder(PathBuf),
}

impl Target {
    /// What `path` names.
    pub(crate) fn of(path: &Path) -> Result<Self> {
        if path == Path::new("-") || path == Path::new("/dev/stdout") {
            return Ok(Self::StandardOutput);
        }
        if path.is_dir() {
            return Ok(Self::Folder(path.to_owned()));
        }
        // Renaming a file onto a link would replace the link.
        let path = if path.is_symlink() {
            let cannot_follow = || format!("cannot follow the symbolic link {}", path.display());
            fs::canonicalize(path).with_context(cannot_follow)?
        } else {
            path.to_owned()
        };
        let name = path.file_name().and_then(|name| name.to_str()).with_context(|| {
            format!("expected the path of a file with a name in UTF-8, found {}", path.display())
        })?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        Ok(Self::File { folder: folder.unwrap_or(Path::new(".")).to_owned(), name: name.to_owned() })
    }
}

/// Writes the file that the user named, completely or not at all; `-` is standard output. A file of that name is
/// replaced unless it is one of the `inputs` of the run.
pub(crate) fn write_file(path: &Path, bytes: &[u8], inputs: &[PathBuf]) -> Result<()> {
    match Target::of(path)? {
        Target::StandardOutput => super::print_bytes(bytes),
        Target::Folder(folder) => {
            anyhow::bail!("expected the path of a file, found the folder {}", folder.display())
        }
        Target::File { folder, name } => {
            let mut files = OutputSet::new(Existing::Replace);
            files.add(name, bytes);
            files.keep_inputs(inputs, false);
            files.commit(&folder)?;
            Ok(())
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn links_are_followed_and_standard_output_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("real"), "old").unwrap();
        symlink("real", path("link")).unwrap();
        symlink("nowhere", path("dangling")).unwrap();
        write_file(&path("link"), b"new", &[]).unwrap();
        assert!(path("link").is_symlink());
        assert_eq!(fs::read_to_string(path("real")).unwrap(), "new");
        assert!(write_file(&path("dangling"), b"", &[]).is_err());
        assert!(write_file(folder.path(), b"", &[]).is_err());
        for name in ["-", "/dev/stdout"] {
            assert_eq!(Target::of(Path::new(name)).unwrap(), Target::StandardOutput);
        }
        assert_eq!(
            Target::of(Path::new("file")).unwrap(),
            Target::File { folder: ".".into(), name: "file".into() }
        );
    }

    #[test]
    fn names_that_are_no_text_are_refused_and_not_changed() {
        use std::os::unix::ffi::OsStrExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(std::ffi::OsStr::from_bytes(b"b\xff.svg"));
        assert!(write_file(&path, b"", &[]).unwrap_err().to_string().contains("UTF-8"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn an_input_is_no_output_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("input"), "precious").unwrap();
        fs::hard_link(path("input"), path("hard")).unwrap();
        symlink("input", path("soft")).unwrap();
        for name in ["input", "hard", "soft"] {
            let error = write_file(&path(name), b"", &[path("input")]).unwrap_err();
            assert!(error.to_string().contains("input of this run"), "{error}");
        }
        assert_eq!(fs::read_to_string(path("input")).unwrap(), "precious");
    }
}
