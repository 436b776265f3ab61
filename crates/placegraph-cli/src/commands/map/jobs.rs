//! Which maps a run labels, and where their results go.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// A map to be labeled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Job {
    /// The map.
    pub(super) map: PathBuf,
    /// The folder of its result.
    pub(super) folder: PathBuf,
}

/// One folder a map: `out` for a single map, else a folder in it by file stem, with the parent folder's name
/// where stems repeat.
pub(super) fn jobs(maps: &[PathBuf], out: &Path) -> Result<Vec<Job>> {
    if let [map] = maps {
        return Ok(vec![Job { map: map.clone(), folder: out.to_owned() }]);
    }
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let parent =
        |path: &Path| path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for map in maps {
        *seen.entry(stem(map).context("expected the path of a map file")?).or_default() += 1;
    }
    let mut folders: BTreeMap<String, &Path> = BTreeMap::new();
    maps.iter()
        .map(|map| {
            let own = stem(map).unwrap_or_default();
            let name = if seen[&own] == 1 { own } else { parent(map).unwrap_or(own) };
            if let Some(earlier) = folders.insert(name.clone(), map) {
                bail!(
                    "{} and {} would both be written to {}: label them in two runs",
                    earlier.display(),
                    map.display(),
                    out.join(&name).display()
                );
            }
            Ok(Job { map: map.clone(), folder: out.join(name) })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folders(maps: &[&str]) -> Result<Vec<PathBuf>> {
        let maps: Vec<PathBuf> = maps.iter().map(PathBuf::from).collect();
        Ok(jobs(&maps, Path::new("out"))?.into_iter().map(|job| job.folder).collect())
    }

    #[test]
    fn one_map_takes_the_folder_itself_and_several_get_one_each() {
        assert_eq!(folders(&["a/map.yaml"]).unwrap(), [Path::new("out")]);
        assert_eq!(folders(&["a.yaml", "b.yaml"]).unwrap(), [Path::new("out/a"), Path::new("out/b")]);
    }

    #[test]
    fn parents_tell_apart_what_stems_do_not() {
        assert_eq!(folders(&["a/map.yaml", "b/map.yaml"]).unwrap(), [Path::new("out/a"), Path::new("out/b")]);
        assert!(folders(&["x/a/map.yaml", "y/a/map.yaml"]).is_err());
    }
}
