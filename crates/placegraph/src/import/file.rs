//! Opens untrusted files: bounded, unchanged while they are read, and inside the folder that they may lie in.

use std::fs::{self, File, Metadata};
use std::io::{self, BufReader, Read};
use std::path::{Component, Path, PathBuf};

use super::{MapError, image, reader_of};

/// Largest YAML or TOML file that is read, in bytes.
pub const MAX_TEXT_BYTES: u64 = 1 << 20;
/// A header and some metadata: bytes that a file may have in addition to its cells.
const OVERHEAD_BYTES: u64 = 1 << 24;
/// Plain PNM takes up to 18 bytes per cell; everything else is smaller.
const BYTES_PER_CELL: u64 = 18;
/// Enough for the header of any image.
const HEAD_BYTES: u64 = 1 << 16;

/// Where a file that another file names may lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NamedFiles {
    /// In the folder of the file that names it, or below it.
    #[default]
    Inside,
    /// Anywhere: a map or training file from a stranger then reads any file.
    Anywhere,
}

/// Reads the file at `path`, of at most `max_bytes` bytes.
///
/// # Errors
/// If it cannot be read, is larger, or changes meanwhile.
pub fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>, MapError> {
    read_with(path, |_| Ok(max_bytes))
}

/// Reads the file at `path` that holds an image or a whole map of at most `max_cells` cells.
///
/// # Errors
/// If it cannot be read, changes meanwhile, or is larger than such a file can be. An image with too many pixels is
/// refused by its header, before the rest is read.
pub fn read_cells(path: &Path, max_cells: u64) -> Result<Vec<u8>, MapError> {
    read_with(path, |head| max_file_bytes(head, max_cells))
}

/// How many bytes a file may have that begins with `head` and holds an image or a map of at most `max_cells` cells.
pub(super) fn max_file_bytes(head: &[u8], max_cells: u64) -> Result<u64, MapError> {
    match image::declared_size(head) {
        Some((width, height)) => {
            MapError::check_size(width, height, max_cells)?;
            Ok(max_bytes(width * height))
        }
        None => match reader_of(head) {
            Some(reader) => Ok((reader.max_bytes)(max_cells)),
            // No header that is read: the decoder says what is wrong, whatever follows.
            None => image::decode(head, max_cells).map(|_| OVERHEAD_BYTES),
        },
    }
}

/// Most bytes of a file with this many cells.
pub(super) fn max_bytes(cells: u64) -> u64 {
    cells.saturating_mul(BYTES_PER_CELL).saturating_add(OVERHEAD_BYTES)
}

/// Reads the file at `path`, of at most as many bytes as `max_bytes` returns for its first bytes.
pub(super) fn read_with(
    path: &Path,
    max_bytes: impl Fn(&[u8]) -> Result<u64, MapError>,
) -> Result<Vec<u8>, MapError> {
    let io = |error| MapError::Io { error };
    let mut file = open(path).map_err(io)?;
    let before = file.metadata().map_err(io)?;
    if !(before.is_file() || is_handed_over(path) && is_pipe(&before)) {
        return Err(MapError::NoFile { found: kind(&before) });
    }
    let mut bytes = Vec::new();
    file.by_ref().take(HEAD_BYTES).read_to_end(&mut bytes).map_err(io)?;
    let max_bytes = max_bytes(&bytes)?;
    let too_large = |n_bytes: u64| n_bytes > max_bytes;
    if too_large(before.len()) {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    let rest = max_bytes.saturating_add(1).saturating_sub(bytes.len() as u64);
    file.by_ref().take(rest).read_to_end(&mut bytes).map_err(io)?;
    if too_large(bytes.len() as u64) {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    let after = file.metadata().map_err(io)?;
    if before.is_file() && has_changed(&before, &after, bytes.len() as u64) {
        return Err(MapError::Changed);
    }
    Ok(bytes)
}

/// Opens the file at `path` to be read from its beginning to its end.
///
/// # Errors
/// If it cannot be opened or is no regular file.
pub fn open_stream(path: &Path) -> Result<BufReader<File>, MapError> {
    let io = |error| MapError::Io { error };
    let file = open(path).map_err(io)?;
    let metadata = file.metadata().map_err(io)?;
    if metadata.is_file() || is_handed_over(path) && is_pipe(&metadata) {
        Ok(BufReader::new(file))
    } else {
        Err(MapError::NoFile { found: kind(&metadata) })
    }
}

/// Opens a file without waiting for anybody: a pipe without a writer would let the program hang.
fn open(path: &Path) -> io::Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    if !is_handed_over(path) {
        std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    }
    options.open(path)
}

/// Whether `path` names an open file of this very process: standard input, or what a shell put there for `<(command)`.
fn is_handed_over(path: &Path) -> bool {
    path == Path::new("/dev/stdin") || path.starts_with("/dev/fd") || path.starts_with("/proc/self/fd")
}

fn is_pipe(metadata: &Metadata) -> bool {
    kind(metadata) == PIPE
}

const PIPE: &str = "a pipe";

/// What something is that is no regular file, in words.
fn kind(metadata: &Metadata) -> &'static str {
    if metadata.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    if std::os::unix::fs::FileTypeExt::is_fifo(&metadata.file_type()) {
        return PIPE;
    }
    "a device or a socket"
}

fn has_changed(before: &Metadata, after: &Metadata, n_read: u64) -> bool {
    before.len() != n_read || after.len() != n_read || before.modified().ok() != after.modified().ok()
}

/// The path of the file that the file at `by` names `name`, relative to its folder unless it is absolute.
///
/// Symbolic links are followed first. A file next to the target of the link `by` counts as inside: an installed
/// folder of links is one folder.
///
/// # Errors
/// If it must lie [`NamedFiles::Inside`] and does not, or it is no file.
pub fn named_file(by: &Path, name: &str, allowed: NamedFiles) -> Result<PathBuf, MapError> {
    let folder = by.parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    let outside =
        || MapError::Outside { name: name.to_owned(), beside: namesake(by, name).into_iter().collect() };
    let real = match fs::canonicalize(&path) {
        Ok(real) => real,
        // Nothing is there: opening it says so, unless one should not even look.
        Err(_) if allowed == NamedFiles::Anywhere || is_plain(Path::new(name)) => return Ok(path),
        Err(_) => return Err(outside()),
    };
    if allowed == NamedFiles::Inside {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let is_in = |folder: Option<PathBuf>| folder.is_some_and(|folder| real.starts_with(folder));
        let linked = fs::canonicalize(by).ok().and_then(|by| by.parent().map(Path::to_owned));
        if !is_in(fs::canonicalize(folder).ok()) && !is_in(linked) {
            return Err(outside());
        }
    }
    let metadata = fs::metadata(&real).map_err(|error| MapError::Io { error })?;
    if metadata.is_file() { Ok(real) } else { Err(MapError::NoFile { found: kind(&metadata) }) }
}

/// The last part of the path `name`, if a file of that name lies in the folder of the file at `by`. `name` may have been
/// written on another machine, with backslashes, as an address, or from a home folder.
pub fn namesake(by: &Path, name: &str) -> Option<String> {
    let last = name.rsplit(['/', '\\']).next().filter(|last| !matches!(*last, "" | "." | ".."))?;
    let is_beside = || named_file(by, last, NamedFiles::Inside).is_ok_and(|path| path.is_file());
    (last != name && is_beside()).then(|| last.to_owned())
}

/// Whether a path goes down only.
fn is_plain(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("placegraph-file-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("maps/below")).unwrap();
        folder
    }

    #[test]
    fn a_file_that_changes_while_it_is_read_is_refused() {
        let folder = folder("changes");
        let path = folder.join("map.pgm");
        let long = vec![b'x'; 3 * HEAD_BYTES as usize];
        for after in [&long[..100], &long[..long.len() - 1], &[long.as_slice(), b"more"].concat()] {
            fs::write(&path, &long).unwrap();
            let read = read_with(&path, |_| {
                // Between the first read and the rest.
                fs::write(&path, after).unwrap();
                Ok(1 << 20)
            });
            assert!(matches!(read, Err(MapError::Changed)), "{} bytes: {read:?}", after.len());
        }
        fs::write(&path, &long).unwrap();
        let read_while_another_has_its_length = read_with(&path, |_| {
            fs::write(&path, vec![b'y'; long.len()]).unwrap();
            // The clock of the file system may be too coarse to show a change.
            File::options().write(true).open(&path).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
            Ok(1 << 20)
        });
        assert!(matches!(read_while_another_has_its_length, Err(MapError::Changed)));
        fs::write(&path, &long).unwrap();
        assert_eq!(read(&path, 1 << 20).unwrap(), long);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_regular_file_is_refused_and_not_waited_for() {
        let folder = folder("kinds");
        let pipe = folder.join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let socket = folder.join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, expected) in [(pipe.as_path(), "a pipe"), (Path::new("/dev/zero"), "a device or a socket")]
        {
            let cells = read_cells(path, 100);
            for found in [read(path, 100), cells] {
                assert!(matches!(found, Err(MapError::NoFile { found }) if found == expected), "{path:?}");
            }
        }
        assert!(read(&socket, 100).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn namesakes_of_paths_from_other_machines_are_found_beside() {
        let folder = folder("namesakes");
        let yaml = folder.join("maps/map.yaml");
        fs::write(folder.join("maps/map.pgm"), "").unwrap();
        let foreign = [
            "/home/someone/map.pgm",
            "~/map.pgm",
            "file:///home/someone/map.pgm",
            "package://maps/map.pgm",
            r"C:\maps\map.pgm",
            r"maps\map.pgm",
            "../map.pgm",
        ];
        for name in foreign {
            assert_eq!(namesake(&yaml, name).as_deref(), Some("map.pgm"), "{name}");
        }
        for name in ["map.pgm", "/home/someone/other.pgm", "..", "/", "below", "/home/below"] {
            assert_eq!(namesake(&yaml, name), None, "{name}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_file_is_no_larger_than_its_kind() {
        let folder = folder("large");
        let path = folder.join("file");
        fs::write(&path, [0; 11]).unwrap();
        assert!(matches!(read(&path, 10), Err(MapError::FileTooLarge { max_bytes: 10 })));
        assert_eq!(read(&path, 11).unwrap().len(), 11);
        assert!(matches!(read(&folder, 10), Err(MapError::NoFile { found: "a folder" })));
        // A header is enough; what follows it is not read. The file has holes, not bytes.
        let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        header.extend(100_000u32.to_be_bytes());
        header.extend(100_000u32.to_be_bytes());
        fs::write(&path, &header).unwrap();
        File::options().write(true).open(&path).unwrap().set_len(1 << 40).unwrap();
        let expected = 100_000;
        let error = read_cells(&path, 400_000_000).unwrap_err();
        assert!(
            matches!(error, MapError::TooManyCells { width, height, .. } if (width, height) == (expected, expected)),
            "{error}"
        );
        let mut small = header;
        small[16..24].copy_from_slice(&[0, 0, 0, 9, 0, 0, 0, 9]);
        fs::write(&path, &small).unwrap();
        File::options().write(true).open(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(matches!(read_cells(&path, 400_000_000), Err(MapError::FileTooLarge { .. })));
        fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn files_are_named_inside_of_their_folder() {
        use std::os::unix::fs::symlink;

        let folder = folder("named");
        let (maps, install) = (folder.join("maps"), folder.join("install"));
        fs::create_dir(&install).unwrap();
        fs::write(folder.join("secret"), "").unwrap();
        for name in ["map.yaml", "map.png", "below/map.png"] {
            fs::write(maps.join(name), "").unwrap();
        }
        symlink(folder.join("secret"), maps.join("link.png")).unwrap();
        symlink(&folder, maps.join("up")).unwrap();
        symlink("map.png", maps.join("beside.png")).unwrap();
        // As installed by a build that links to its sources.
        symlink(maps.join("map.yaml"), install.join("map.yaml")).unwrap();
        symlink(maps.join("map.png"), install.join("map.png")).unwrap();

        let yaml = maps.join("map.yaml");
        let absolute = |name: &str| folder.join(name).to_string_lossy().into_owned();
        let inside = ["map.png", "below/map.png", "./map.png", "beside.png", "below/../map.png", "gone.png"];
        for name in inside.map(str::to_owned).into_iter().chain([absolute("maps/map.png")]) {
            assert!(named_file(&yaml, &name, NamedFiles::Inside).is_ok(), "{name}");
        }
        let outside =
            ["../secret", "link.png", "up/secret", "up/maps/../secret", "../gone", "/gone", "/dev/zero"];
        for name in outside.map(str::to_owned).into_iter().chain([absolute("secret")]) {
            let found = named_file(&yaml, &name, NamedFiles::Inside);
            assert!(matches!(found, Err(MapError::Outside { .. })), "{name}: {found:?}");
        }
        for name in ["../secret".to_owned(), "link.png".to_owned(), absolute("secret")] {
            assert!(named_file(&yaml, &name, NamedFiles::Anywhere).is_ok(), "{name}");
        }
        for name in ["/dev/zero", "..", "below"] {
            let found = named_file(&yaml, name, NamedFiles::Anywhere);
            assert!(matches!(found, Err(MapError::NoFile { .. })), "{name}: {found:?}");
        }
        let installed = install.join("map.yaml");
        assert!(
            named_file(&installed, "map.png", NamedFiles::Inside).is_ok(),
            "a folder of links is one folder"
        );
        assert!(named_file(&installed, "../secret", NamedFiles::Inside).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
