//! Where the files of a map come from: a disk, or the memory of a program without a file system.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::file::{self, NamedFiles};
use super::recording::{Container, Recording};
use super::{MapError, ReadOptions, ReplacedImage};

/// Where a map's files come from.
pub(super) trait Files {
    /// The bytes of a small file.
    fn text(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError>;
    /// The bytes of a file with cells.
    fn cells(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError>;
    /// A recording of any size.
    fn recording(&self, path: &Path, container: Container) -> Result<Recording<'_>, MapError>;
    /// The path of the image that the YAML at `by` calls `name`, and what it is called if that is not its name.
    fn image(&self, by: &Path, name: &str) -> Result<(PathBuf, Option<ReplacedImage>), MapError>;
}

/// The files of a disk.
pub(super) struct OnDisk<'a> {
    pub(super) options: &'a ReadOptions,
}

impl Files for OnDisk<'_> {
    fn text(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError> {
        file::read(path, file::MAX_TEXT_BYTES).map(Cow::Owned)
    }

    fn cells(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError> {
        file::read_cells(path, self.options.max_cells).map(Cow::Owned)
    }

    fn recording(&self, path: &Path, _: Container) -> Result<Recording<'_>, MapError> {
        Recording::open(path)
    }

    fn image(&self, by: &Path, name: &str) -> Result<(PathBuf, Option<ReplacedImage>), MapError> {
        image_of(by, name, self.options)
    }
}

/// Files that are given, each a name and its bytes.
pub(super) struct InMemory<'a> {
    pub(super) files: &'a [(&'a str, &'a [u8])],
    pub(super) options: &'a ReadOptions,
}

impl InMemory<'_> {
    fn given(&self, path: &Path) -> Result<&[u8], MapError> {
        let found = self.files.iter().find(|(name, _)| Path::new(name) == path);
        found.map(|(_, bytes)| *bytes).ok_or_else(|| MapError::NotGiven { name: path.display().to_string() })
    }

    fn bytes(&self, path: &Path, max_bytes: u64) -> Result<Cow<'_, [u8]>, MapError> {
        let bytes = self.given(path)?;
        if bytes.len() as u64 > max_bytes {
            return Err(MapError::FileTooLarge { max_bytes });
        }
        Ok(Cow::Borrowed(bytes))
    }
}

impl Files for InMemory<'_> {
    fn text(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError> {
        self.bytes(path, file::MAX_TEXT_BYTES)
    }

    fn cells(&self, path: &Path) -> Result<Cow<'_, [u8]>, MapError> {
        let bytes = self.bytes(path, u64::MAX)?;
        let max_bytes = file::max_file_bytes(&bytes, self.options.max_cells)?;
        self.bytes(path, max_bytes)
    }

    fn recording(&self, path: &Path, container: Container) -> Result<Recording<'_>, MapError> {
        Recording::from_bytes(container, self.given(path)?)
    }

    fn image(&self, _: &Path, name: &str) -> Result<(PathBuf, Option<ReplacedImage>), MapError> {
        let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let is_beside = name.strip_prefix("./").unwrap_or(name) == last;
        let replaced = ReplacedImage { named: name.to_owned(), read: last.to_owned() };
        Ok((PathBuf::from(last), (!is_beside).then_some(replaced)))
    }
}

/// The image that the YAML at `path` names. If it is not there, the one of its name next to the YAML, and which that is: maps
/// are copied from machine to machine, and their YAML files hold the path on the first.
fn image_of(
    path: &Path,
    named: &str,
    options: &ReadOptions,
) -> Result<(PathBuf, Option<ReplacedImage>), MapError> {
    let is_there = path.parent().is_none_or(|folder| folder.join(named).exists());
    match file::namesake(path, named) {
        Some(read) if !is_there => {
            // A YAML that was copied under another name, with its image, still names the first one.
            let own = Path::new(&read).extension().map(|extension| path.with_extension(extension));
            let own = own
                .filter(|own| own.is_file())
                .and_then(|own| Some(own.file_name()?.to_string_lossy().into_owned()));
            if let Some(own) = own.filter(|own| *own != read) {
                return Err(MapError::Outside { name: named.to_owned(), beside: vec![read, own] });
            }
            let image = file::named_file(path, &read, NamedFiles::Inside)?;
            Ok((image, Some(ReplacedImage { named: named.to_owned(), read })))
        }
        _ => Ok((file::named_file(path, named, options.named_files)?, None)),
    }
}
