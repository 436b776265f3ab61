//! The training file: which maps, which labels, which classes.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use placegraph::labels::{Class, LabelSet, Role};
use serde::Deserialize;

/// A training file as written.
///
/// ```toml
/// [[map]]
/// map = "office.yaml"
/// labels = "office.labels.png"
/// crop = [0, 0, 350, 300]   # pixels, y down, upper bounds exclusive
///
/// [classes]                 # optional; the default is corridor, room, doorway with values 1, 2, 3
/// hall = { value = 115, role = "passage" }
/// office = { color = [244, 200, 120], role = "place" }
/// door = { value = 179, role = "doorway" }
/// ```
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    /// The labeled maps. Paths are relative to the training file.
    pub(crate) map: Vec<MapEntry>,
    #[serde(default)]
    classes: toml::Table,
}

/// One labeled map.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MapEntry {
    /// The map.
    pub(crate) map: PathBuf,
    /// Its labels.
    pub(crate) labels: PathBuf,
    /// The pixels to train on: x0, y0, x1, y1.
    pub(crate) crop: Option<[u32; 4]>,
}

/// How a class of one's own is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClassEntry {
    role: Role,
    value: Option<u8>,
    color: Option<[u8; 3]>,
}

/// Which pixel of a label image means a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paint {
    /// A gray value.
    Gray(u8),
    /// A color.
    Color([u8; 3]),
}

/// Colors in pictures for classes that are written by gray value.
const PALETTE: [[u8; 3]; LabelSet::MAX] = [
    [86, 156, 214],
    [244, 200, 120],
    [206, 68, 84],
    [120, 178, 120],
    [160, 130, 200],
    [230, 150, 80],
    [110, 190, 190],
    [200, 140, 170],
];

impl Manifest {
    /// Reads a training file; its paths come back relative to where it lies.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("could not read the training file {}", path.display()))?;
        let mut manifest = Self::parse(&text).with_context(|| format!("in {}", path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        for entry in &mut manifest.map {
            entry.map = folder.join(&entry.map);
            entry.labels = folder.join(&entry.labels);
        }
        Ok(manifest)
    }

    fn parse(text: &str) -> Result<Self> {
        let manifest: Self = toml::from_str(text).context("expected a training file")?;
        if manifest.map.is_empty() {
            bail!("expected at least one [[map]] table, found none");
        }
        Ok(manifest)
    }

    /// The classes in the order written, and what paints each in label images.
    pub(crate) fn classes(&self) -> Result<(LabelSet, Vec<Paint>)> {
        if self.classes.is_empty() {
            let set = LabelSet::default();
            let paints = (1..=set.len() as u8).map(Paint::Gray).collect();
            return Ok((set, paints));
        }
        let mut classes = Vec::new();
        let mut paints = Vec::new();
        for (index, (name, entry)) in self.classes.iter().enumerate() {
            let entry: ClassEntry =
                entry.clone().try_into().with_context(|| format!("in class {name:?} of [classes]"))?;
            let paint = match (entry.value, entry.color) {
                (None, None) => Paint::Gray(index as u8 + 1),
                (Some(value), None) => Paint::Gray(value),
                (None, Some(color)) => Paint::Color(color),
                (Some(_), Some(_)) => bail!("class {name:?}: expected a gray value or a color, found both"),
            };
            if matches!(paint, Paint::Gray(0 | 255)) {
                bail!("class {name:?}: expected a gray value of 1 to 254 (0 is no label, 255 is ignored)");
            }
            if let Some(earlier) = paints.iter().position(|&other| other == paint) {
                let first = &classes[earlier];
                let Class { name: first, .. } = first;
                bail!("expected a value of its own for each class, found one for {first:?} and {name:?}");
            }
            let color = entry.color.unwrap_or(PALETTE[index % PALETTE.len()]);
            classes.push(Class { name: name.clone(), role: entry.role, color });
            paints.push(paint);
        }
        Ok((LabelSet::new(classes).context("in [classes]")?, paints))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "[[map]]\nmap = 'a.yaml'\nlabels = 'a.png'\n";

    #[test]
    fn classes_keep_their_order() {
        let text = format!(
            "{MAP}[classes]\nzoo = {{ role = 'place' }}\nhall = {{ value = 115, role = 'passage' }}\n\
             door = {{ color = [1, 2, 3], role = 'doorway' }}\n"
        );
        let (set, paints) = Manifest::parse(&text).unwrap().classes().unwrap();
        let names: Vec<_> = set.classes().iter().map(|class| class.name.as_str()).collect();
        assert_eq!(names, ["zoo", "hall", "door"]);
        assert_eq!(paints, [Paint::Gray(1), Paint::Gray(115), Paint::Color([1, 2, 3])]);
    }

    #[test]
    fn a_value_for_two_classes_is_refused() {
        let text = format!(
            "{MAP}[classes]\na = {{ value = 7, role = 'place' }}\nb = {{ value = 7, role = 'place' }}\n"
        );
        let error = Manifest::parse(&text).unwrap().classes().unwrap_err();
        assert!(error.to_string().contains("\"a\" and \"b\""), "{error}");
    }

    #[test]
    fn a_file_without_maps_is_refused() {
        assert!(Manifest::parse("map = []").is_err());
        assert!(Manifest::parse("[[map]]\nmap = 'a.yaml'\n").is_err(), "labels are missing");
    }
}
