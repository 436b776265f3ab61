//! Replaces some files of a folder by others in one step that can be undone: when something fails, or by the next run
//! when this one is killed.
//!
//! The new files lie in `new/` of a hidden folder inside the target until all of them are on the disk. A `journal` next to
//! them then says what is to be moved where: files that go to `old/`, the last one (which vouches for
//! the others) first; new ones into place, the last one last. While the last one is in `new/`, the way back is
//! open.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use super::complain;

/// What unfinished sets are called in the folder that they will go to.
const STAGING: &str = ".placegraph-unfinished-";

/// The file that says that such a folder is ours, and its content.
const MARK: (&str, &str) =
    ("mark", "placegraph: removed by the next run that writes into the folder above\n");

/// The file that says how far moving is.
const JOURNAL: &str = "journal";

/// What is moved, written down before the first move.
#[derive(Debug, Serialize, Deserialize)]
struct Journal {
    /// The new files; the last one vouches for the others.
    new: Vec<String>,
}

/// Puts `files` into `folder` in their order, and takes away those called `removed`: all or nothing.
pub(super) fn replace(folder: &Path, files: &[(String, Vec<u8>)], removed: &[String]) -> Result<()> {
    let cannot_write = || format!("cannot write into {}", folder.display());
    // Inside the target: moves then stay on one file system.
    let staging = tempfile::Builder::new().prefix(STAGING).tempdir_in(folder).with_context(cannot_write)?;
    stage(staging.path(), files).map_err(|(name, error)| {
        anyhow::Error::new(error).context(format!("cannot write {name} into {}", folder.display()))
    })?;
    // From here on, what is left of a killed run is more than rubbish: it is not removed by chance.
    let staging = staging.keep();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let moved = move_all(folder, &staging, &names, removed);
    if let Err(error) = moved {
        return Err(match undo(folder, &staging) {
            Ok(()) => error,
            Err(undo) => error.context(format!(
                "and the earlier files could not be restored from {}: {undo}",
                staging.display()
            )),
        });
    }
    // The set is in place: a folder that stays is removed by the next run.
    let _ = remove_staging(&staging);
    Ok(())
}

/// Writes `files` and the journal, and waits until they are on the disk. An error names the file.
fn stage(staging: &Path, files: &[(String, Vec<u8>)]) -> Result<(), (String, io::Error)> {
    let named = |name: &str| {
        let name = name.to_owned();
        move |error| (name, error)
    };
    write_synced(&staging.join(MARK.0), MARK.1.as_bytes()).map_err(named(MARK.0))?;
    let new = staging.join("new");
    for folder in [&new, &staging.join("old")] {
        fs::create_dir(folder).map_err(named("a folder"))?;
    }
    for (name, bytes) in files {
        write_synced(&new.join(name), bytes).map_err(named(name))?;
    }
    sync_folder(&new).map_err(named("a folder"))?;
    let journal = Journal { new: files.iter().map(|(name, _)| name.clone()).collect() };
    let journal = serde_json::to_vec(&journal).map_err(|error| (JOURNAL.to_owned(), error.into()))?;
    write_synced(&staging.join(JOURNAL), &journal).map_err(named(JOURNAL))?;
    sync_folder(staging).map_err(named("a folder"))
}

fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Moves the old files away and the new ones into place.
fn move_all(folder: &Path, staging: &Path, names: &[&str], removed: &[String]) -> Result<()> {
    let Some((last, others)) = names.split_last() else { return Ok(()) };
    let (new, old) = (staging.join("new"), staging.join("old"));
    let sync = || sync_folder(folder).with_context(|| format!("cannot write into {}", folder.display()));
    // A single file is replaced by its move: at no moment is there none.
    if !others.is_empty() || !removed.is_empty() {
        for name in std::iter::once(last).chain(others).copied().chain(removed.iter().map(String::as_str)) {
            let path = folder.join(name);
            match fs::rename(&path, old.join(name)) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(error).with_context(|| format!("cannot replace {}", path.display()));
                }
                _ => {}
            }
            if name == *last {
                // Whatever the disk holds after a power cut: new files never lie next to the old last one.
                sync()?;
            }
        }
    }
    for name in others {
        put(&new, folder, name)?;
    }
    if !others.is_empty() {
        sync()?;
    }
    put(&new, folder, last)?;
    sync()
}

fn put(new: &Path, folder: &Path, name: &str) -> Result<()> {
    let path = folder.join(name);
    fs::rename(new.join(name), &path).with_context(|| format!("cannot put {} into place", path.display()))
}

/// Puts back what was in `folder` before the moves that the journal of `staging` lists, unless they were all done;
/// then removes `staging`. May be repeated.
fn undo(folder: &Path, staging: &Path) -> io::Result<()> {
    if let Ok(journal) = fs::read(staging.join(JOURNAL)) {
        let Journal { new } = serde_json::from_slice(&journal)?;
        let is_waiting = |name: &String| staging.join("new").join(name).exists();
        if new.last().is_some_and(is_waiting) {
            for name in new.iter().filter(|name| !is_waiting(name)) {
                fs::rename(folder.join(name), staging.join("new").join(name))?;
            }
            let last = new.last();
            let mut old: Vec<PathBuf> = fs::read_dir(staging.join("old"))?
                .map(|entry| Ok(entry?.path()))
                .collect::<io::Result<_>>()?;
            // The file that vouches for the others comes last here too.
            old.sort_by_key(|path| {
                path.file_name().and_then(|name| name.to_str()) == last.map(String::as_str)
            });
            for path in old {
                if let Some(name) = path.file_name() {
                    fs::rename(&path, folder.join(name))?;
                }
            }
            sync_folder(folder)?;
        }
    }
    remove_staging(staging)
}

/// Removes a marked folder, its mark last: killed in between, the next run still knows that the rest is ours.
fn remove_staging(staging: &Path) -> io::Result<()> {
    for entry in fs::read_dir(staging)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            fs::remove_dir_all(entry.path())?;
        } else if entry.file_name() != MARK.0 {
            fs::remove_file(entry.path())?;
        }
    }
    remove_mark(staging)
}

/// Removes a folder that holds nothing but the mark, or nothing.
fn remove_mark(staging: &Path) -> io::Result<()> {
    match fs::remove_file(staging.join(MARK.0)) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    fs::remove_dir(staging)
}

/// Whether a folder holds nothing but a mark that was not written to its end, or nothing.
fn is_barely_begun(staging: &Path) -> bool {
    let Ok(mut entries) = fs::read_dir(staging) else { return false };
    let is_part_of_mark =
        || fs::read(staging.join(MARK.0)).is_ok_and(|mark| MARK.1.as_bytes().starts_with(&mark));
    entries.all(|entry| entry.is_ok_and(|entry| entry.file_name() == MARK.0 && is_part_of_mark()))
}

/// Waits until no other run writes into `folder`, for as long as the lock is kept, and undoes what killed ones left.
/// Where folders cannot be locked, all is left as it is.
pub(crate) fn lock_and_recover(folder: &Path) -> Result<Option<File>> {
    let Ok(lock) = File::open(folder) else { return Ok(None) };
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            complain(&format!("waiting for another program that writes into {}", folder.display()));
            if lock.lock().is_err() {
                return Ok(None);
            }
        }
        Err(TryLockError::Error(_)) => return Ok(None),
    }
    let Ok(entries) = fs::read_dir(folder) else { return Ok(Some(lock)) };
    for path in entries.flatten().map(|entry| entry.path()) {
        let is_named = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STAGING));
        if !is_named || path.is_symlink() || !path.is_dir() {
            continue;
        }
        if fs::read(path.join(MARK.0)).is_ok_and(|mark| mark == MARK.1.as_bytes()) {
            undo(folder, &path)
                .with_context(|| format!("cannot undo what a killed run left in {}", path.display()))?;
        } else if is_barely_begun(&path) {
            let _ = remove_mark(&path);
        }
    }
    Ok(Some(lock))
}

/// Waits until the names in a folder are on the disk, where a file system can do that.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entry = |entry: io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(entry).collect();
        names.sort();
        names
    }

    fn files(version: &str) -> Vec<(String, Vec<u8>)> {
        ["a", "b", "last"].map(|name| (name.to_owned(), version.as_bytes().to_vec())).into()
    }

    /// A folder with an old set, and another file; beside it a new set that is staged and not yet moved.
    fn staged() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in [files("old"), vec![("gone".into(), b"old".to_vec())]].concat() {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        fs::write(folder.path().join("other"), "mine").unwrap();
        let staging = folder.path().join(format!("{STAGING}killed"));
        fs::create_dir(&staging).unwrap();
        stage(&staging, &files("new")).unwrap();
        (folder, staging)
    }

    fn content(folder: &Path) -> Vec<(String, String)> {
        names(folder)
            .into_iter()
            .map(|name| (name.clone(), fs::read_to_string(folder.join(name)).unwrap()))
            .collect()
    }

    #[test]
    fn a_single_file_is_replaced_and_several_are_moved_away_first() {
        for (n, moved_away) in [(1, vec![]), (3, vec!["a", "b", "last"])] {
            let (folder, staging) = staged();
            let all = ["a", "b", "last"];
            move_all(folder.path(), &staging, &all[3 - n..], &[]).unwrap();
            assert_eq!(names(&staging.join("old")), moved_away);
            assert_eq!(fs::read(folder.path().join("last")).unwrap(), b"new");
        }
    }

    /// All moves of `move_all` in their order, so that a test can be killed between any two.
    fn moves(folder: &Path, staging: &Path) -> Vec<(PathBuf, PathBuf)> {
        let (new, old) = (staging.join("new"), staging.join("old"));
        let away = ["last", "a", "b", "gone"].map(|name| (folder.join(name), old.join(name)));
        let put = ["a", "b", "last"].map(|name| (new.join(name), folder.join(name)));
        away.into_iter().chain(put).collect()
    }

    #[test]
    fn killed_after_any_move_the_next_run_finds_the_old_set_or_the_new_one() {
        let (folder, _) = staged();
        let n_moves = moves(folder.path(), Path::new("")).len();
        for n in 0..=n_moves {
            let (folder, staging) = staged();
            for (from, to) in &moves(folder.path(), &staging)[..n] {
                fs::rename(from, to).unwrap();
            }
            drop(lock_and_recover(folder.path()).unwrap());
            let found = content(folder.path());
            let [old, new] = ["old", "new"].map(|version| {
                let kept = ["a", "b", "gone", "last", "other"]
                    .into_iter()
                    .filter(|&name| version == "old" || name != "gone");
                kept.map(|name| (name.to_owned(), if name == "other" { "mine" } else { version }.to_owned()))
                    .collect::<Vec<_>>()
            });
            assert!(found == if n == n_moves { new } else { old }, "after {n} moves: {found:?}");
        }
    }

    #[test]
    fn the_moves_are_those_that_the_test_kills() {
        let (folder, staging) = staged();
        move_all(folder.path(), &staging, &["a", "b", "last"], &["gone".to_owned()]).unwrap();
        assert_eq!(names(&staging.join("old")), ["a", "b", "gone", "last"]);
        assert!(names(&staging.join("new")).is_empty());
        assert_eq!(fs::read_to_string(folder.path().join("last")).unwrap(), "new");
    }

    #[test]
    fn if_a_file_cannot_be_put_into_place_all_are_put_back() {
        let (folder, staging) = staged();
        fs::remove_dir_all(&staging).unwrap();
        // Found only when it is moved: a folder that is not empty cannot be replaced.
        fs::remove_file(folder.path().join("b")).unwrap();
        fs::create_dir(folder.path().join("b")).unwrap();
        let before = names(folder.path());
        // Moving the folder away works; so the way of the new file is barred by a name that is too long.
        let mut blocked = files("new");
        blocked[1].0 = "x".repeat(300);
        assert!(replace(folder.path(), &blocked, &[]).is_err());
        assert_eq!(names(folder.path()), before);
        assert_eq!(fs::read_to_string(folder.path().join("last")).unwrap(), "old");
    }

    #[test]
    fn killed_while_files_are_staged_nothing_was_touched() {
        let (folder, staging) = staged();
        fs::remove_file(staging.join(JOURNAL)).unwrap();
        fs::remove_file(staging.join("new/b")).unwrap();
        drop(lock_and_recover(folder.path()).unwrap());
        assert_eq!(names(folder.path()), ["a", "b", "gone", "last", "other"]);
        assert!(
            content(folder.path())
                .iter()
                .all(|(name, text)| text == if name == "other" { "mine" } else { "old" })
        );
    }

    #[test]
    fn killed_while_it_cleans_up_or_marks_the_next_run_removes_the_rest() {
        let (folder, staging) = staged();
        let name = staging.file_name().unwrap().to_str().unwrap().to_owned();
        fs::remove_dir_all(&staging).unwrap();
        let is_cleaned = |files: &[(&str, &str)]| {
            fs::create_dir(&staging).unwrap();
            for (file, text) in files {
                fs::write(staging.join(file), text).unwrap();
            }
            drop(lock_and_recover(folder.path()).unwrap());
            let is_cleaned = !names(folder.path()).contains(&name);
            let _ = fs::remove_dir_all(&staging);
            is_cleaned
        };
        // All but the mark is removed first, whatever order the file system lists.
        assert!(is_cleaned(&[MARK]));
        for n_written in 0..MARK.1.len() {
            assert!(
                is_cleaned(&[(MARK.0, &MARK.1[..n_written])]),
                "killed after {n_written} bytes of the mark"
            );
        }
        assert!(!is_cleaned(&[(MARK.0, ""), ("model.json", "precious")]));
        assert!(!is_cleaned(&[(MARK.0, "a mark of somebody else")]));
    }

    #[test]
    fn folders_of_others_are_left() {
        let folder = tempfile::tempdir().unwrap();
        let kept = [".placegraph-models", ".placegraph-Ab3dE9", ".placegraph-unfinished-mine"];
        for name in kept {
            fs::create_dir(folder.path().join(name)).unwrap();
            fs::write(folder.path().join(name).join("m.json"), "precious").unwrap();
        }
        // What may be the begin of a mark is no mark where something else lies beside it.
        let begun = folder.path().join(kept[2]).join(MARK.0);
        fs::write(&begun, &MARK.1[..5]).unwrap();
        fs::create_dir(folder.path().join(".placegraph-unfinished-empty1")).unwrap();
        replace(folder.path(), &[("a".to_owned(), b"1".to_vec())], &[]).unwrap();
        drop(lock_and_recover(folder.path()).unwrap());
        assert_eq!(names(folder.path()), [kept[1], kept[0], kept[2], "a"]);
        assert!(begun.exists());
    }
}
