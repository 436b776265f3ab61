//! The user's classes and the labels that name them.

use serde::{Deserialize, Serialize};

use crate::text::is_printable;

/// The role of a class; only roles enter the heuristics of Sect. 4.7.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Where one stays: a room.
    Place,
    /// Where one moves on: a corridor.
    Passage,
    /// What joins the others: a doorway.
    Doorway,
}

/// One class of a [`LabelSet`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// Name, unique in its set.
    pub name: String,
    /// Role of the class.
    pub role: Role,
    /// Color in pictures: red, green, blue.
    pub color: [u8; 3],
}

/// Index of a class in its [`LabelSet`]. A label image stores `index + 1`, and 0 for cells without a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Label(pub u8);

impl Label {
    /// The label as a position in arrays over classes.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What people say of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LabelCell {
    /// Nothing: no class was drawn here.
    #[default]
    None,
    /// The class drawn.
    Class(Label),
    /// Ignored in training and scores: free, but ambiguous.
    Ignore,
}

impl LabelCell {
    /// The class to learn from or to compare with, if there is one.
    pub const fn class(self) -> Option<Label> {
        match self {
            Self::Class(label) => Some(label),
            Self::None | Self::Ignore => None,
        }
    }
}

/// One label per node of a [`crate::grid::CellGraph`].
pub type Labeling = Vec<Label>;

/// The labels that nodes had in an earlier result which is held on to, `None` where it had none; or no such result.
pub type Held<'a> = Option<&'a [Option<Label>]>;

/// The classes of a model, in order: 2 to 8, with unique names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Class>", into = "Vec<Class>")]
pub struct LabelSet {
    classes: Vec<Class>,
}

/// Why classes do not form a label set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LabelSetError {
    /// Too few or too many classes: the decision list's order is searched among K! orders.
    #[error("expected 2 to 8 classes, found {found}")]
    Number {
        /// How many were given.
        found: usize,
    },
    /// A name is empty, too long, given twice, or cannot be printed.
    #[error(
        "expected a different name for every class, of 1 to {} printable characters, found {name:?}",
        LabelSet::MAX_NAME
    )]
    Name {
        /// The name at fault.
        name: String,
    },
}

impl LabelSet {
    /// Smallest number of classes.
    pub const MIN: usize = 2;
    /// Largest number of classes.
    pub const MAX: usize = 8;
    /// Largest number of characters of a class name.
    pub const MAX_NAME: usize = 100;

    /// A set of `classes` in this order.
    ///
    /// # Examples
    /// ```
    /// use placegraph::labels::{Class, Label, LabelSet, Role};
    ///
    /// let class = |name: &str, role, color| Class { name: name.to_owned(), role, color };
    /// let set = LabelSet::new(vec![
    ///     class("hall", Role::Passage, [86, 156, 214]),
    ///     class("office", Role::Place, [244, 200, 120]),
    ///     class("door", Role::Doorway, [206, 68, 84]),
    /// ])?;
    /// assert_eq!(set.label("door"), Some(Label(2)));
    /// # Ok::<(), placegraph::labels::LabelSetError>(())
    /// ```
    ///
    /// # Errors
    /// If there are fewer than 2 or more than 8, or a name is empty, too long, not unique, or has characters that are
    /// not printable.
    pub fn new(classes: Vec<Class>) -> Result<Self, LabelSetError> {
        if !(Self::MIN..=Self::MAX).contains(&classes.len()) {
            return Err(LabelSetError::Number { found: classes.len() });
        }
        for (index, class) in classes.iter().enumerate() {
            if !is_printable(&class.name, Self::MAX_NAME)
                || classes[..index].iter().any(|other| other.name == class.name)
            {
                return Err(LabelSetError::Name { name: class.name.clone() });
            }
        }
        Ok(Self { classes })
    }

    /// Number of classes K.
    #[expect(clippy::len_without_is_empty, reason = "a label set is never empty")]
    pub fn len(&self) -> usize {
        self.classes.len()
    }

    /// The classes in order.
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// The labels in order.
    pub fn labels(&self) -> impl Iterator<Item = Label> + use<> {
        (0..self.classes.len() as u8).map(Label)
    }

    /// The class that `label` names.
    pub fn class(&self, label: Label) -> &Class {
        &self.classes[label.index()]
    }

    /// The role of the class that `label` names.
    pub fn role(&self, label: Label) -> Role {
        self.class(label).role
    }

    /// The label of the class called `name`.
    pub fn label(&self, name: &str) -> Option<Label> {
        self.labels().find(|&label| self.class(label).name == name)
    }
}

impl Default for LabelSet {
    /// Corridor, room and doorway, the classes of the chapter.
    fn default() -> Self {
        let class = |name: &str, role, color| Class { name: name.to_owned(), role, color };
        Self {
            classes: vec![
                class("corridor", Role::Passage, [86, 156, 214]),
                class("room", Role::Place, [244, 200, 120]),
                class("doorway", Role::Doorway, [206, 68, 84]),
            ],
        }
    }
}

impl TryFrom<Vec<Class>> for LabelSet {
    type Error = LabelSetError;
    fn try_from(classes: Vec<Class>) -> Result<Self, LabelSetError> {
        Self::new(classes)
    }
}

impl From<LabelSet> for Vec<Class> {
    fn from(set: LabelSet) -> Self {
        set.classes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_two_to_eight() {
        let class = |name: &str| Class { name: name.into(), role: Role::Place, color: [0; 3] };
        assert_eq!(LabelSet::new(vec![class("a")]), Err(LabelSetError::Number { found: 1 }));
        assert_eq!(
            LabelSet::new(vec![class("a"), class("a")]),
            Err(LabelSetError::Name { name: "a".into() })
        );
        for bad in ["", "a\u{7}", "a\nb", &"x".repeat(101)] {
            assert!(LabelSet::new(vec![class("a"), class(bad)]).is_err(), "{bad:?}");
        }
        let set = LabelSet::new(vec![class("a"), class("b")]).unwrap();
        assert_eq!(set.label("b"), Some(Label(1)));
    }
}
