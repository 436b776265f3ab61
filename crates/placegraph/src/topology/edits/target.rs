//! How an edit names the place that it changes.

use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// A point of the map frame, in meters: `[x, y]`.
pub type At = [f64; 2];

/// A place, given by a point inside it or by its name. In files: `[x, y]`, or a text.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Target {
    /// A point inside it.
    Point(At),
    /// Its name, or its number.
    Named(String),
}

impl Target {
    /// The point, if it is one.
    pub fn point(&self) -> Option<At> {
        match self {
            Self::Point(at) => Some(*at),
            Self::Named(_) => None,
        }
    }
}

impl From<At> for Target {
    fn from(at: At) -> Self {
        Self::Point(at)
    }
}

impl<'de> Deserialize<'de> for Target {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PointOrName;
        impl<'de> Visitor<'de> for PointOrName {
            type Value = Target;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a point [x, y] or the name of a place")
            }
            fn visit_str<E: Error>(self, name: &str) -> Result<Target, E> {
                Ok(Target::Named(name.to_owned()))
            }
            fn visit_i64<E: Error>(self, number: i64) -> Result<Target, E> {
                Ok(Target::Named(number.to_string()))
            }
            fn visit_u64<E: Error>(self, number: u64) -> Result<Target, E> {
                Ok(Target::Named(number.to_string()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Target, A::Error> {
                let mut next = |n: usize| seq.next_element()?.ok_or_else(|| Error::invalid_length(n, &self));
                let at = [next(0)?, next(1)?];
                match seq.next_element::<f64>()? {
                    Some(_) => Err(Error::invalid_length(3, &self)),
                    None => Ok(Target::Point(at)),
                }
            }
        }
        deserializer.deserialize_any(PointOrName)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Deserialize)]
    struct Line {
        at: Target,
    }

    #[test]
    fn a_point_a_name_or_a_number() {
        let read = |text: &str| toml::from_str::<Line>(text).map(|line| line.at);
        assert_eq!(read("at = [1, 2.5]").unwrap(), Target::Point([1.0, 2.5]));
        assert_eq!(read("at = \"room 7\"").unwrap(), Target::Named("room 7".into()));
        assert_eq!(read("at = 7").unwrap(), Target::Named("7".into()));
        for wrong in ["at = [1]", "at = [1, 2, 3]", "at = true", "at = {x = 1, y = 2}"] {
            let error = read(wrong).unwrap_err().to_string();
            assert!(error.contains("a point [x, y] or the name of a place"), "{error}");
        }
    }
}
