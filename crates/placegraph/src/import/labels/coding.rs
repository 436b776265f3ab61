//! What pixels and names of classes mean.

use std::collections::HashSet;

use crate::labels::{LabelCell, LabelSet};

/// Names of labeling tools for cells without a class.
const NONE: [&str; 4] = ["none", "unlabeled", "background", "_background_"];
/// Names for cells that do not count.
const IGNORE: [&str; 3] = ["ignore", "__ignore__", "ambiguous"];

/// The meaning of pixel values (red, green, blue, or three times the gray value) and of names.
///
/// The color counts, not its place in a palette, unless the palette has colors without a meaning. What is
/// fully transparent is not labeled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelCoding {
    pixels: Vec<([u8; 3], LabelCell)>,
    names: Vec<(String, LabelCell)>,
}

impl LabelCoding {
    /// The coding of this program's own label images: 0 for none, `k` for the k-th class from 1, 255 for ignored; also the
    /// color of each class, and its name.
    pub fn of(classes: &LabelSet) -> Self {
        let mut pixels = vec![([0; 3], LabelCell::None), ([255; 3], LabelCell::Ignore)];
        pixels.extend(classes.labels().map(|label| ([label.0 + 1; 3], LabelCell::Class(label))));
        pixels.extend(classes.labels().map(|label| (classes.class(label).color, LabelCell::Class(label))));
        Self::new(pixels).with_names(classes)
    }

    /// The coding with these `pixels`, without names; if a value occurs twice, the first counts.
    pub fn new(mut pixels: Vec<([u8; 3], LabelCell)>) -> Self {
        let mut known = HashSet::new();
        pixels.retain(|(value, _)| known.insert(*value));
        Self { pixels, names: Vec::new() }
    }

    /// The same, with the names of `classes`, and those that labeling tools have for cells without a class.
    pub fn with_names(mut self, classes: &LabelSet) -> Self {
        let class = |label| (classes.class(label).name.clone(), LabelCell::Class(label));
        self.names = classes.labels().map(class).collect();
        self
    }

    /// The meaning of a pixel.
    pub(in crate::import) fn meaning(&self, value: [u8; 3]) -> Option<LabelCell> {
        self.pixels.iter().find(|(known, _)| *known == value).map(|&(_, cell)| cell)
    }

    /// The meaning of a name: that of a class, as written or but for upper and lower case, "none" or "ignore", or a gray value.
    pub(super) fn named(&self, name: &str) -> Option<LabelCell> {
        let name = name.trim();
        let find =
            |is: &dyn Fn(&str) -> bool| self.names.iter().find(|(known, _)| is(known)).map(|&(_, cell)| cell);
        let any_case = |known: &str| known.eq_ignore_ascii_case(name);
        let other = |names: &[&str], cell| names.iter().any(|known| any_case(known)).then_some(cell);
        find(&|known| known == name)
            .or_else(|| find(&any_case))
            .or_else(|| other(&NONE, LabelCell::None))
            .or_else(|| other(&IGNORE, LabelCell::Ignore))
            .or_else(|| self.meaning([name.parse().ok()?; 3]))
    }

    /// The names of the classes, and of what is no class.
    pub(super) fn names(&self) -> Vec<String> {
        let others = [NONE[0], IGNORE[0]].map(str::to_owned);
        self.names.iter().map(|(name, _)| name.clone()).chain(others).collect()
    }

    /// The pixel values that have a meaning.
    pub(super) fn values(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.pixels.iter().map(|&(value, _)| value)
    }

    /// The same names with other pixels.
    pub(super) fn with_pixels(&self, pixels: Vec<([u8; 3], LabelCell)>) -> Self {
        Self { pixels, names: self.names.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::Label;

    #[test]
    fn names_and_colors_mean_what_the_label_set_says() {
        let coding = LabelCoding::of(&LabelSet::default());
        let room = Some(LabelCell::Class(Label(1)));
        assert_eq!((coding.named("room"), coding.named(" Room ")), (room, room));
        assert_eq!(coding.named("_background_"), Some(LabelCell::None));
        assert_eq!(coding.named("__ignore__"), Some(LabelCell::Ignore));
        assert_eq!((coding.named("2"), coding.named("4"), coding.named("kitchen")), (room, None, None));
        assert_eq!((coding.meaning([2; 3]), coding.meaning([244, 200, 120])), (room, room));
        assert_eq!(coding.meaning([9; 3]), None);
    }
}
