//! The training file: maps, labels and classes.
//!
//! ```toml
//! [[map]]
//! map = "office.yaml"
//! labels = "office.labels.png"
//! crop = [0, 0, 350, 300]   # pixels, y down, upper bounds exclusive
//! building = "office"       # optional: maps of one building are held out together
//!
//! [classes]                 # optional; the default is corridor, room, doorway with values 1, 2, 3
//! hall = { value = 115, role = "passage" }
//! office = { color = [244, 200, 120], role = "place" }
//! door = { value = 179, role = "doorway" }
//! ```

use serde::Deserialize;

use super::LabelCoding;
use super::class_table::{classes_and_coding, default_classes};
use crate::labels::{LabelSet, LabelSetError};
use crate::syntax::{SyntaxError, from_toml};

/// A training file that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrainingFile {
    /// The labeled maps, at least one.
    pub maps: Vec<TrainingMap>,
    /// The classes, in the order written.
    pub classes: LabelSet,
    /// The meaning of the pixels of label images.
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
    /// The building, where several maps show it: they are held out together.
    pub building: Option<String>,
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
    /// It has no classes where these are asked for.
    #[error(
        "expected a table [classes] with lines such as kitchen = {{ value = 4, role = \"place\" }}, found {found}"
    )]
    NoClasses {
        /// What is there instead.
        found: &'static str,
    },
    /// A class is not written as it should be.
    #[error("in class {name:?} of [classes]: {error}")]
    Class {
        /// Name of the class.
        name: String,
        /// What is wrong.
        error: String,
    },
    /// A class has both a gray value and a color.
    #[error("class {name:?}: expected a gray value or a color, found both")]
    ValueAndColor {
        /// Name of the class.
        name: String,
    },
    /// A class has a value with another meaning.
    #[error("class {name:?}: expected a gray value of 1 to 254 (0 is no label, 255 is ignored)")]
    Reserved {
        /// Name of the class.
        name: String,
    },
    /// Two classes have the same value or color.
    #[error("the classes {first:?} and {second:?} have the same value: give each class its own")]
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
    classes: Option<toml::Value>,
}

impl TrainingFile {
    /// Parses the text of a training file.
    ///
    /// # Errors
    /// If it is no TOML, has an unknown key, names no map, or its classes contradict each other.
    pub fn from_toml(text: &str) -> Result<Self, TrainingFileError> {
        let Tables { map: maps, classes } =
            from_toml(text).map_err(|error| TrainingFileError::Toml { error })?;
        if maps.is_empty() {
            return Err(TrainingFileError::NoMap);
        }
        let (classes, coding) = match classes {
            Some(classes) => classes_and_coding(classes)?,
            None => default_classes(),
        };
        Ok(Self { maps, classes, coding })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::{Label, LabelCell};

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
        for (paint, k) in paints.into_iter().zip(0..) {
            assert_eq!(file.coding.meaning(paint), Some(LabelCell::Class(Label(k))));
        }
        assert_eq!(file.coding.meaning([0; 3]), Some(LabelCell::None));
        assert_eq!(file.coding.meaning([255; 3]), Some(LabelCell::Ignore));
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
    fn what_is_no_table_of_classes_is_told_in_words_of_the_file() {
        for (classes, found) in [("['kitchen']", "array"), ("'kitchen'", "string"), ("{}", "an empty one")] {
            let text = format!("classes = {classes}\n{MAP}");
            let wanted = format!("lines such as kitchen = {{ value = 4, role = \"place\" }}, found {found}");
            let told = TrainingFile::from_toml(&text).unwrap_err().to_string();
            assert!(told.ends_with(&wanted), "{told}");
            assert_eq!(super::super::class_table::read_classes(&text).unwrap_err().to_string(), told);
        }
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
