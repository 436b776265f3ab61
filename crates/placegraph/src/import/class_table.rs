//! The table `[classes]` of a training file: names, roles, and what stands for a class in label images.

use serde::Deserialize;

use super::{LabelCoding, TrainingFileError};
use crate::labels::{Class, LabelCell, LabelSet, Role};
use crate::syntax::from_toml;

/// What of a file is read for its classes alone.
#[derive(Deserialize)]
struct ClassTable {
    classes: Option<toml::Value>,
}

/// Colors in pictures for classes that are written by gray value, by role: blues for what one walks along, warm and green ones for
/// places, reds for doorways. The first of each role is that of the default classes.
const PASSAGES: [[u8; 3]; 8] = [
    [86, 156, 214],
    [44, 110, 180],
    [130, 196, 236],
    [70, 130, 150],
    [110, 190, 190],
    [90, 100, 190],
    [150, 170, 220],
    [40, 80, 130],
];
const PLACES: [[u8; 3]; 8] = [
    [244, 200, 120],
    [120, 178, 120],
    [160, 130, 200],
    [230, 150, 80],
    [190, 190, 90],
    [200, 140, 170],
    [150, 110, 80],
    [90, 150, 100],
];
const DOORWAYS: [[u8; 3]; 8] = [
    [206, 68, 84],
    [150, 40, 60],
    [236, 120, 130],
    [180, 60, 140],
    [230, 90, 50],
    [120, 30, 90],
    [250, 150, 170],
    [170, 90, 90],
];

/// The colors of classes with these roles. A class keeps its color whatever classes of other roles stand around it.
fn colors(roles: &[Role]) -> Vec<[u8; 3]> {
    let nth = |index: usize| roles[..index].iter().filter(|&&role| role == roles[index]).count() % 8;
    let of_role = |index: usize| match roles[index] {
        Role::Passage => PASSAGES[nth(index)],
        Role::Place => PLACES[nth(index)],
        Role::Doorway => DOORWAYS[nth(index)],
    };
    (0..roles.len()).map(of_role).collect()
}

/// The classes of a file with a table `[classes]`, such as a training file, and what pixels and names mean.
///
/// # Errors
/// If it is no TOML, or its classes contradict each other.
pub fn read_classes(text: &str) -> Result<(LabelSet, LabelCoding), TrainingFileError> {
    let ClassTable { classes } = from_toml(text).map_err(|error| TrainingFileError::Toml { error })?;
    classes_and_coding(classes.ok_or(TrainingFileError::NoClasses { found: "none" })?)
}

/// The classes of a file that names none, and what pixels and names mean.
pub(super) fn default_classes() -> (LabelSet, LabelCoding) {
    let classes = LabelSet::default();
    let coding = LabelCoding::of(&classes);
    (classes, coding)
}

/// The classes that stand behind the key `classes`, and what pixels and names mean.
pub(super) fn classes_and_coding(table: toml::Value) -> Result<(LabelSet, LabelCoding), TrainingFileError> {
    let found = table.type_str();
    let toml::Value::Table(table) = table else { return Err(TrainingFileError::NoClasses { found }) };
    if table.is_empty() {
        return Err(TrainingFileError::NoClasses { found: "an empty one" });
    }
    let (classes, paints) = own_classes(table)?;
    let mut entries = vec![([0; 3], LabelCell::None), ([255; 3], LabelCell::Ignore)];
    entries.extend(classes.labels().zip(&paints).map(|(label, &pixel)| (pixel, LabelCell::Class(label))));
    // Pictures show the classes in their colors: what was written as such is read as such.
    let colors = classes.labels().map(|label| (classes.class(label).color, LabelCell::Class(label)));
    entries.extend(colors);
    Ok((classes.clone(), LabelCoding::new(entries).with_names(&classes)))
}

/// What may be written of a class.
const CLASS_KEYS: [&str; 3] = ["role", "value", "color"];

/// How a class of one's own is written.
struct ClassEntry {
    role: Role,
    value: Option<u8>,
    color: Option<[u8; 3]>,
}

impl ClassEntry {
    /// Reads what stands behind the name of a class; errors are in words of the file.
    fn read(entry: &toml::Value) -> Result<Self, String> {
        let table = entry.as_table().ok_or_else(|| {
            format!("expected {{ role = \"place\" }}, also with a value or a color, found {entry}")
        })?;
        if let Some(key) = table.keys().find(|key| !CLASS_KEYS.contains(&key.as_str())) {
            return Err(format!("the key {key:?} is unknown; expected {}", CLASS_KEYS.join(", ")));
        }
        let sample = |value: &toml::Value| value.as_integer().and_then(|value| u8::try_from(value).ok());
        let role = match table.get("role").map(|role| (role, role.as_str())) {
            Some((_, Some("place"))) => Role::Place,
            Some((_, Some("passage"))) => Role::Passage,
            Some((_, Some("doorway"))) => Role::Doorway,
            Some((other, _)) => {
                return Err(format!(
                    "expected the role \"place\", \"passage\" or \"doorway\", found {other}"
                ));
            }
            None => return Err("it lacks its role: \"place\", \"passage\" or \"doorway\"".to_owned()),
        };
        let value = table.get("value").map(|value| {
            sample(value).ok_or_else(|| format!("expected a gray value of 1 to 254, found {value}"))
        });
        let color = table.get("color").map(|color| {
            let samples =
                color.as_array().map(|samples| samples.iter().map_while(sample).collect::<Vec<u8>>());
            samples
                .and_then(|samples| <[u8; 3]>::try_from(samples).ok())
                .filter(|_| color.as_array().is_some_and(|samples| samples.len() == 3))
                .ok_or_else(|| {
                    format!("expected a color [red, green, blue] of numbers to 255, found {color}")
                })
        });
        Ok(Self { role, value: value.transpose()?, color: color.transpose()? })
    }
}

/// The classes in the order written, and the pixel of each in label images.
fn own_classes(table: toml::Table) -> Result<(LabelSet, Vec<[u8; 3]>), TrainingFileError> {
    let mut entries: Vec<(String, ClassEntry)> = Vec::new();
    let mut paints: Vec<[u8; 3]> = Vec::new();
    for (name, entry) in table {
        let entry = match ClassEntry::read(&entry) {
            Ok(entry) => entry,
            Err(error) => return Err(TrainingFileError::Class { name, error }),
        };
        let paint = match (entry.value, entry.color) {
            // Beyond the last class that a label set may have, the number does not matter.
            (None, None) => [u8::try_from(paints.len() + 1).unwrap_or(u8::MAX); 3],
            (Some(value), None) => [value; 3],
            (None, Some(color)) => color,
            (Some(_), Some(_)) => return Err(TrainingFileError::ValueAndColor { name }),
        };
        if paint == [0; 3] || paint == [255; 3] {
            return Err(TrainingFileError::Reserved { name });
        }
        if let Some(earlier) = paints.iter().position(|&other| other == paint) {
            let first = entries[earlier].0.clone();
            return Err(TrainingFileError::SamePaint { first, second: name });
        }
        entries.push((name, entry));
        paints.push(paint);
    }
    let roles: Vec<Role> = entries.iter().map(|(_, entry)| entry.role).collect();
    let class = |((name, entry), color): ((String, ClassEntry), [u8; 3])| Class {
        name,
        role: entry.role,
        color: entry.color.unwrap_or(color),
    };
    Ok((LabelSet::new(entries.into_iter().zip(colors(&roles)).map(class).collect())?, paints))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_classes(classes: &str) -> Result<LabelSet, TrainingFileError> {
        read_classes(&format!("[classes]\n{classes}")).map(|(classes, _)| classes)
    }

    #[test]
    fn errors_speak_of_the_file() {
        let error = |class: &str| with_classes(class).unwrap_err().to_string();
        for (class, words) in [
            ("a = 'place'", "{ role = \"place\" }"),
            ("a = {}", "lacks its role: \"place\", \"passage\" or \"doorway\""),
            ("a = { role = 'stairs' }", "\"passage\" or \"doorway\", found \"stairs\""),
            ("a = { role = 'place', gray = 3 }", "expected role, value, color"),
            ("a = { role = 'place', value = -1 }", "1 to 254, found -1"),
            ("a = { role = 'place', color = [1, 2] }", "[red, green, blue]"),
        ] {
            let message = error(class);
            assert!(message.contains(words) && message.contains("\"a\""), "{message}");
            assert!(!message.contains("struct") && !message.contains("variant"), "{message}");
        }
    }

    #[test]
    fn colors_come_from_roles_and_stay() {
        let color = |set: &LabelSet, name: &str| set.class(set.label(name).unwrap()).color;
        let few = with_classes("hall = { role = 'passage' }\nroom = { role = 'place' }").unwrap();
        let many = with_classes(
            "door = { role = 'doorway' }\nhall = { role = 'passage' }\nroom = { role = 'place' }\nlab = { role = 'place' }",
        );
        let (many, standard) = (many.unwrap(), LabelSet::default());
        for (name, of) in [("hall", "corridor"), ("room", "room")] {
            assert_eq!(color(&few, name), color(&many, name));
            assert_eq!(color(&few, name), standard.class(standard.label(of).unwrap()).color);
        }
        let mut colors = [PASSAGES, PLACES, DOORWAYS].concat();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), 24, "all differ");
    }
}
