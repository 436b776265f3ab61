//! The training file: which maps, which labels, which classes.
//!
//! ```toml
//! [[map]]
//! map = "office.yaml"
//! labels = "office.labels.png"
//! crop = [0, 0, 350, 300]   # pixels, y down, upper bounds exclusive
//!
//! [classes]                 # optional; the default is corridor, room, doorway with values 1, 2, 3
//! hall = { value = 115, role = "passage" }
//! office = { color = [244, 200, 120], role = "place" }
//! door = { value = 179, role = "doorway" }
//! ```

use serde::Deserialize;

use super::{LabelCell, LabelCoding};
use crate::labels::{Class, LabelSet, LabelSetError, Role};
use crate::syntax::{SyntaxError, from_toml};

/// A training file that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrainingFile {
    /// The labeled maps, at least one.
    pub maps: Vec<TrainingMap>,
    /// The classes, in the order written.
    pub classes: LabelSet,
    /// Which pixels of label images mean which class.
    pub coding: LabelCoding,
}

/// One labeled map of a training file.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingMap {
    /// Path of the map, as written: relative to the folder of the training file.
    pub map: String,
    /// Path of its label image, likewise.
    pub labels: String,
    /// The pixels to train on: x0, y0, x1, y1, y down, upper bounds exclusive.
    pub crop: Option<[u32; 4]>,
}

/// Why a training file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrainingFileError {
    /// No TOML, or not the keys of a training file.
    #[error("expected a training file: {error}")]
    Toml {
        /// What the TOML reader found, and where.
        error: SyntaxError,
    },
    /// It names no map.
    #[error("expected at least one [[map]] table, found none")]
    NoMap,
    /// A class is not written as it should be.
    #[error("in class {name:?} of [classes]: {error}")]
    Class {
        /// Name of the class.
        name: String,
        /// What the TOML reader found.
        error: SyntaxError,
    },
    /// A class has both ways to paint it.
    #[error("class {name:?}: expected a gray value or a color, found both")]
    ValueAndColor {
        /// Name of the class.
        name: String,
    },
    /// A class has a value that means something else.
    #[error("class {name:?}: expected a gray value of 1 to 254 (0 is no label, 255 is ignored)")]
    Reserved {
        /// Name of the class.
        name: String,
    },
    /// Two classes are painted alike.
    #[error("expected a value of its own for each class, found one for {first:?} and {second:?}")]
    SamePaint {
        /// Name of one class.
        first: String,
        /// Name of the other.
        second: String,
    },
    /// The classes form no label set.
    #[error("in [classes]: {0}")]
    LabelSet(#[from] LabelSetError),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    map: Vec<TrainingMap>,
    #[serde(default)]
    classes: toml::Table,
}

/// How a class of one's own is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a class such as { value = 1, role = \"place\" }")]
struct ClassEntry {
    role: Role,
    value: Option<u8>,
    color: Option<[u8; 3]>,
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

impl TrainingFile {
    /// Reads a file's text.
    ///
    /// # Errors
    /// If it is no TOML, has an unknown key, names no map, or its classes contradict each other.
    pub fn from_toml(text: &str) -> Result<Self, TrainingFileError> {
        let Tables { map: maps, classes } =
            from_toml(text).map_err(|error| TrainingFileError::Toml { error })?;
        if maps.is_empty() {
            return Err(TrainingFileError::NoMap);
        }
        if classes.is_empty() {
            let classes = LabelSet::default();
            let coding = LabelCoding::of(&classes);
            return Ok(Self { maps, classes, coding });
        }
        let (classes, paints) = own_classes(classes)?;
        let mut entries = vec![([0; 3], LabelCell::None), ([255; 3], LabelCell::Ignore)];
        entries.extend(classes.labels().zip(&paints).map(|(label, &pixel)| (pixel, LabelCell::Class(label))));
        Ok(Self { maps, classes, coding: LabelCoding::new(entries) })
    }
}

/// The classes in the order written, and the pixel of each in label images.
fn own_classes(table: toml::Table) -> Result<(LabelSet, Vec<[u8; 3]>), TrainingFileError> {
    let mut classes: Vec<Class> = Vec::new();
    let mut paints: Vec<[u8; 3]> = Vec::new();
    for (index, (name, entry)) in table.into_iter().enumerate() {
        let entry: ClassEntry = match entry.try_into() {
            Ok(entry) => entry,
            Err(error) => {
                return Err(TrainingFileError::Class { name, error: SyntaxError::of_toml(&error, "") });
            }
        };
        let paint = match (entry.value, entry.color) {
            // Beyond the last class that a label set may have, the number does not matter.
            (None, None) => [u8::try_from(index + 1).unwrap_or(u8::MAX); 3],
            (Some(value), None) => [value; 3],
            (None, Some(color)) => color,
            (Some(_), Some(_)) => return Err(TrainingFileError::ValueAndColor { name }),
        };
        if paint == [0; 3] || paint == [255; 3] {
            return Err(TrainingFileError::Reserved { name });
        }
        if let Some(earlier) = paints.iter().position(|&other| other == paint) {
            let first = classes[earlier].name.clone();
            return Err(TrainingFileError::SamePaint { first, second: name });
        }
        let color = entry.color.unwrap_or(PALETTE[index % PALETTE.len()]);
        classes.push(Class { name, role: entry.role, color });
        paints.push(paint);
    }
    Ok((LabelSet::new(classes)?, paints))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::Label;

    const MAP: &str = "[[map]]\nmap = 'a.yaml'\nlabels = 'a.png'\n";

    fn with_classes(classes: &str) -> Result<TrainingFile, TrainingFileError> {
        TrainingFile::from_toml(&format!("{MAP}[classes]\n{classes}"))
    }

    #[test]
    fn classes_keep_their_order() {
        let file = with_classes(
            "zoo = { role = 'place' }\nhall = { value = 115, role = 'passage' }\n\
             door = { color = [1, 2, 3], role = 'doorway' }\n",
        )
        .unwrap();
        let names: Vec<_> = file.classes.classes().iter().map(|class| class.name.as_str()).collect();
        assert_eq!(names, ["zoo", "hall", "door"]);
        let paints = [[1; 3], [115; 3], [1, 2, 3]];
        let mut entries = vec![([0; 3], LabelCell::None), ([255; 3], LabelCell::Ignore)];
        entries.extend(paints.into_iter().zip(0..).map(|(p, k)| (p, LabelCell::Class(Label(k)))));
        assert_eq!(file.coding, LabelCoding::new(entries));
    }

    #[test]
    fn a_pixel_that_means_two_things_is_refused() {
        let two =
            with_classes("a = { value = 7, role = 'place' }\nb = { color = [7, 7, 7], role = 'place' }");
        assert!(two.unwrap_err().to_string().contains("\"a\" and \"b\""));
        for reserved in ["value = 0", "value = 255", "color = [0, 0, 0]", "color = [255, 255, 255]"] {
            let class = format!("a = {{ {reserved}, role = 'place' }}");
            assert!(matches!(with_classes(&class), Err(TrainingFileError::Reserved { .. })), "{reserved}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        for bad in ["value = nan", "value = inf", "value = 1e3", "value = 256", "color = [nan, 1, 1]"] {
            let class = format!("a = {{ {bad}, role = 'place' }}\nb = {{ role = 'place' }}");
            assert!(matches!(with_classes(&class), Err(TrainingFileError::Class { .. })), "{bad}");
        }
        let crop = format!("{MAP}crop = [0, 0, inf, 3]");
        assert!(matches!(TrainingFile::from_toml(&crop), Err(TrainingFileError::Toml { .. })));
    }

    #[test]
    fn more_classes_than_a_label_set_has_are_refused() {
        let many: Vec<String> = (0..300).map(|k| format!("c{k} = {{ role = 'place' }}")).collect();
        assert!(with_classes(&many.join("\n")).is_err());
    }

    #[test]
    fn a_file_without_maps_is_refused() {
        assert!(matches!(TrainingFile::from_toml("map = []"), Err(TrainingFileError::NoMap)));
        assert!(TrainingFile::from_toml("[[map]]\nmap = 'a.yaml'\n").is_err(), "labels are missing");
    }
}
