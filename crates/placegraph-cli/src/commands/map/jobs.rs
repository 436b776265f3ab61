//! Which maps a run labels, what they are called and where their results go.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use placegraph::import;
use placegraph::import::recording::Container;

use super::table;
use crate::document::Beside;

/// A map to be labeled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Job {
    /// The map.
    pub(super) map: PathBuf,
    /// What it is called; by its path alone if `None`.
    pub(super) name: Option<String>,
    /// The folder of its result, relative to that of the run; empty for a single map.
    pub(super) place: PathBuf,
}

/// The maps of a run: those named by `paths`, and all in the folders that are named, for results in `out`.
///
/// A single map has its result in `out` itself. Others are called by their file, with as much of their path as distinguishes
/// them apart; those found in a folder by their path in it. A file that is just called `map` is called by
/// its folder.
pub(super) fn jobs(paths: &[PathBuf], out: &Path) -> Result<Vec<Job>> {
    if let [map] = paths
        && !is_folder_of_maps(map)
    {
        return Ok(vec![Job { map: map.clone(), name: None, place: PathBuf::new() }]);
    }
    let (folders, files): (Vec<&PathBuf>, Vec<&PathBuf>) =
        paths.iter().partition(|path| is_folder_of_maps(path));
    let mut named = told_apart(&files)?;
    for folder in folders {
        let found = maps_in(folder, out)?;
        ensure!(!found.is_empty(), "expected maps in the folder {}, found none", folder.display());
        let prefix = if paths.len() > 1 { folder_name(folder) } else { None };
        for map in found {
            let below = map.strip_prefix(folder).unwrap_or(&map);
            let mut parts: Vec<OsString> = prefix.iter().cloned().collect();
            parts.extend(below.parent().into_iter().flat_map(normal_parts));
            parts.push(stem(&map)?);
            if parts.len() == 1 && is_just_map(&parts[0]) {
                parts = folder_name(folder).map_or(parts, |name| vec![name]);
            }
            named.push((map, without_map(parts)));
        }
    }
    let mut places: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    named
        .into_iter()
        .map(|(map, parts)| {
            let place: PathBuf = parts.iter().collect();
            if let Some(earlier) = places.insert(place.clone(), map.clone()) {
                bail!(
                    "{} and {} would both be written to {}: label them in two runs",
                    earlier.display(),
                    map.display(),
                    out.join(&place).display()
                );
            }
            let is_table = |name: &&str| parts.first().is_some_and(|first| first == *name);
            if let Some(name) = table::NAMES.iter().find(|name| is_table(name)) {
                bail!(
                    "the folder of the result of {} would be called like the table {name}: rename the map",
                    map.display()
                );
            }
            let name = parts.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("-");
            Ok(Job { map, name: Some(name), place })
        })
        .collect()
}

/// `files` with their names, each with as many folders above it as distinguish it from the others.
fn told_apart(files: &[&PathBuf]) -> Result<Vec<(PathBuf, Vec<OsString>)>> {
    let paths: Vec<Vec<OsString>> = files
        .iter()
        .map(|file| {
            let absolute = std::path::absolute(file).with_context(|| format!("in {}", file.display()))?;
            let mut parts: Vec<OsString> = absolute.parent().into_iter().flat_map(normal_parts).collect();
            parts.push(stem(file)?);
            Ok(parts)
        })
        .collect::<Result<_>>()?;
    let name = |parts: &[OsString], n_folders: usize| {
        let n_folders = n_folders.max(usize::from(parts.last().is_some_and(|stem| is_just_map(stem))));
        without_map(parts[parts.len().saturating_sub(n_folders + 1)..].to_vec())
    };
    let mut n_folders = vec![0; files.len()];
    loop {
        let names: Vec<Vec<OsString>> =
            paths.iter().zip(&n_folders).map(|(parts, &n)| name(parts, n)).collect();
        let mut seen: BTreeMap<&[OsString], usize> = BTreeMap::new();
        for name in &names {
            *seen.entry(name).or_default() += 1;
        }
        let mut has_changed = false;
        for (index, name) in names.iter().enumerate() {
            if seen[name.as_slice()] > 1 && n_folders[index] + 1 < paths[index].len() {
                n_folders[index] += 1;
                has_changed = true;
            }
        }
        if !has_changed {
            return Ok(files.iter().map(|&file| file.clone()).zip(names).collect());
        }
    }
}

/// The name that map savers give a file says nothing beyond its folder.
fn without_map(mut parts: Vec<OsString>) -> Vec<OsString> {
    if parts.len() > 1 && parts.last().is_some_and(|stem| is_just_map(stem)) {
        parts.pop();
    }
    parts
}

fn is_just_map(stem: &OsStr) -> bool {
    stem == "map"
}

/// The name of a map file without its extension, which is to be the name of a folder.
fn stem(path: &Path) -> Result<OsString> {
    let stem = path.file_stem().filter(|stem| !stem.is_empty() && *stem != "." && *stem != "..");
    let stem = stem.with_context(|| {
        format!(
            "the name of {} cannot be the name of a folder for its result: rename the map",
            path.display()
        )
    })?;
    Ok(stem.to_owned())
}

fn normal_parts(path: &Path) -> impl Iterator<Item = OsString> {
    path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_owned()),
        _ => None,
    })
}

fn folder_name(folder: &Path) -> Option<OsString> {
    let absolute = std::path::absolute(folder).ok()?;
    // `absolute` keeps `..`: its folder has another name.
    let absolute = if absolute.file_name().is_none() { fs::canonicalize(&absolute).ok()? } else { absolute };
    absolute.file_name().map(OsStr::to_owned)
}

/// Whether `path` is a folder, and not one recording.
pub(crate) fn is_folder_of_maps(path: &Path) -> bool {
    path.is_dir() && Container::of(path).is_none()
}

/// All maps below `folder`, in the order of their paths: YAML files that name an image, recordings, and files that hold a
/// whole map. Hidden folders, links to folders and `out` are skipped; files of results are not maps.
pub(crate) fn maps_in(folder: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let cannot_read = || format!("cannot read the folder {}", folder.display());
    let mut entries: Vec<fs::DirEntry> =
        fs::read_dir(folder).and_then(Iterator::collect).with_context(cannot_read)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    let beside = Beside::of(folder);
    let mut maps = Vec::new();
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name());
        let is_hidden = name.to_string_lossy().starts_with('.');
        let is_out = || same_file::is_same_file(&path, out).unwrap_or(false);
        if entry.file_type().with_context(cannot_read)?.is_dir() {
            if !is_hidden && !is_out() {
                maps.extend(if is_folder_of_maps(&path) { maps_in(&path, out)? } else { vec![path] });
            }
        } else if path.is_file() && !beside.vouches_for(&name.to_string_lossy()) && is_map(&path) {
            maps.push(path);
        }
    }
    Ok(maps)
}

/// Whether a file looks like a map, even if it is damaged: what is wrong with it is reported when it is read.
fn is_map(path: &Path) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "yaml" | "yml" => import::read(path, import::MAX_TEXT_BYTES).is_ok_and(|bytes| {
            let text = String::from_utf8_lossy(&bytes);
            let has_key = |key: &str| {
                text.lines().any(|line| line.starts_with(key)) || text.contains(&format!("\"{key}\""))
            };
            let keys = ["resolution", "origin", "occupied_thresh", "free_thresh", "negate"];
            has_key("image") && keys.into_iter().any(has_key)
        }),
        _ if Container::of(path).is_some() => true,
        other if import::may_hold_map(other) => {
            use std::io::Read;
            let mut head = Vec::new();
            let read = fs::File::open(path).and_then(|file| file.take(1 << 16).read_to_end(&mut head));
            read.is_ok() && import::holds_map(other, &head)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(paths: &[&str]) -> Result<Vec<PathBuf>> {
        let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
        Ok(jobs(&paths, Path::new("out"))?.into_iter().map(|job| job.place).collect())
    }

    #[test]
    fn one_map_takes_the_folder_itself_and_several_get_one_each() {
        assert_eq!(places(&["a/map.yaml"]).unwrap(), [Path::new("")]);
        assert_eq!(places(&["a.yaml", "b.yaml"]).unwrap(), [Path::new("a"), Path::new("b")]);
        assert_eq!(places(&["a/map.yaml", "floor.yaml"]).unwrap(), [Path::new("a"), Path::new("floor")]);
    }

    #[test]
    fn as_much_of_the_path_is_kept_as_tells_maps_apart() {
        assert_eq!(places(&["a/map.yaml", "b/map.yaml"]).unwrap(), [Path::new("a"), Path::new("b")]);
        let found = places(&["x/a/map.yaml", "y/a/map.yaml", "x/b/map.yaml"]).unwrap();
        assert_eq!(found, [Path::new("x/a"), Path::new("y/a"), Path::new("b")]);
        let found = places(&["x/floor1.yaml", "y/floor1.yaml", "x/floor2.yaml"]).unwrap();
        assert_eq!(found, [Path::new("x/floor1"), Path::new("y/floor1"), Path::new("floor2")]);
        // If a map and a folder have one name, both are named.
        assert!(places(&["x/a.yaml", "x/a.pgm"]).unwrap_err().to_string().contains("two runs"));
    }

    #[test]
    fn no_name_leads_out_of_the_folder_or_takes_that_of_the_table() {
        for bad in ["b/...yaml", "..yaml", "...yaml"] {
            assert!(places(&["a.yaml", bad]).is_err(), "{bad}");
        }
        assert!(places(&["a.yaml", "summary.csv.yaml"]).unwrap_err().to_string().contains("summary.csv"));
        for place in places(&["a/../x/map.yaml", "b/../y/map.yaml"]).unwrap() {
            assert!(place.components().all(|part| matches!(part, Component::Normal(_))), "{place:?}");
        }
    }

    #[test]
    fn folders_are_searched_for_maps() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let map = "image: map.pgm\nresolution: 0.05\n";
        for name in
            ["site/a/map.yaml", "site/b/map.yaml", "site/b/up.yml", "site/map.yaml", "site/.old/map.yaml"]
        {
            write(name, map);
        }
        write("site/out/c/map.yaml", map);
        write("site/json.yaml", "{\"image\": \"map.pgm\", \"resolution\": 0.05}");
        write("site/broken.yaml", "image: map.pgm\nresolution: [\n");
        write("site/compose.yaml", "services:\n  web:\n    image: nginx\n");
        write("site/ci.yaml", "image: python\n");
        write("site/notes.txt", map);
        let site = folder.path().join("site");
        let found = jobs(std::slice::from_ref(&site), &site.join("out")).unwrap();
        let places: Vec<&Path> = found.iter().map(|job| job.place.as_path()).collect();
        assert_eq!(
            places.iter().map(|p| p.to_str().unwrap()).collect::<Vec<_>>(),
            ["a", "b", "b/up", "broken", "json", "site"]
        );
        assert_eq!(found[2].name.as_deref(), Some("b-up"));
        // With another one, each with the name of its folder.
        let found = jobs(&[site.join("a"), site.join("b")], &site.join("out")).unwrap();
        assert_eq!(
            found.iter().map(|job| job.place.to_str().unwrap()).collect::<Vec<_>>(),
            ["a", "b", "b/up"]
        );
        assert!(jobs(&[site.join("out/c/nothing")], &site).unwrap()[0].name.is_none());
        // The folder of a recorder is one map, alone and among others.
        write("runs/monday/metadata.yaml", "rosbag2_bagfile_information:\n");
        write("runs/monday/monday_0.mcap", "");
        let monday = folder.path().join("runs/monday");
        for argument in [&monday, &folder.path().join("runs")] {
            let found = jobs(std::slice::from_ref(argument), &site).unwrap();
            assert_eq!(found.iter().map(|job| &job.map).collect::<Vec<_>>(), [&monday]);
        }
        fs::create_dir(site.join("empty")).unwrap();
        assert!(jobs(&[site.join("empty")], &site.join("out")).is_err());
    }
}
