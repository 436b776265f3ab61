//! The YAML file of a map.

use serde::Deserialize;

use super::{Interpretation, Mode, Rules};
use crate::geom::Pose2;
use crate::grid::MapFrame;
use crate::import::MapError;

/// A map_server YAML file.
#[derive(Clone, Debug, PartialEq)]
pub struct MapYaml {
    /// Path of the image, as written: relative to the folder of the YAML file unless it is absolute.
    pub image: String,
    /// Resolution and origin.
    pub frame: MapFrame,
    /// What a gray value means; the rules are [`Rules::Jazzy`].
    pub interpretation: Interpretation,
}

/// The file's keys; others, such as `cost_translation_table`, are ignored.
#[derive(Deserialize)]
struct Keys {
    image: String,
    resolution: f64,
    origin: Vec<f64>,
    negate: String,
    occupied_thresh: f64,
    free_thresh: f64,
    mode: Option<String>,
}

/// Parses a map_server YAML file. The six keys that Nav2 requires are required; `mode` defaults to trinary.
///
/// # Errors
/// If the text is no YAML, a key is missing or of another type, a number is not finite, the resolution is not
/// above 0, the origin has not three numbers, or `mode` is unknown.
///
/// # Examples
/// ```
/// let yaml = b"{image: map.pgm, resolution: 0.05, origin: [-10, 2.5, 0], negate: 0,
///               occupied_thresh: 0.65, free_thresh: 0.196}";
/// let map = placegraph::import::ros::parse_yaml(yaml)?;
/// assert_eq!(map.frame.map_from_grid().x, -10.0);
/// # Ok::<(), placegraph::import::MapError>(())
/// ```
pub fn parse_yaml(bytes: &[u8]) -> Result<MapYaml, MapError> {
    let keys: Keys = serde_saphyr::from_slice(bytes).map_err(|error| yaml_error(&error))?;
    let mode = match keys.mode.as_deref().map(str::to_ascii_lowercase).as_deref() {
        None | Some("trinary") => Mode::Trinary,
        Some("scale") => Mode::Scale,
        Some("raw") => Mode::Raw,
        Some(other) => return Err(MapError::Mode { found: other.to_owned() }),
    };
    let [x, y, yaw_rad] =
        keys.origin[..].try_into().map_err(|_| MapError::Origin { found: keys.origin.len() })?;
    let frame = MapFrame::new(keys.resolution, Pose2::new(x, y, yaw_rad))?;
    for (key, found) in [("occupied_thresh", keys.occupied_thresh), ("free_thresh", keys.free_thresh)] {
        if !found.is_finite() {
            return Err(MapError::Threshold { key, found });
        }
    }
    let interpretation = Interpretation {
        mode,
        negate: truth_value(keys.negate)?,
        occupied_thresh: keys.occupied_thresh,
        free_thresh: keys.free_thresh,
        rules: Rules::Jazzy,
    };
    Ok(MapYaml { image: keys.image, frame, interpretation })
}

pub(in crate::import) fn yaml_error(error: &serde_saphyr::Error) -> MapError {
    use serde_saphyr::{DefaultMessageFormatter, Error, MessageFormatter};
    let location = error.location();
    // A picture of the source follows the message.
    let message = match error.without_snippet() {
        Error::DuplicateMappingKey { key: Some(key), .. } => format!("the key {key} stands twice"),
        Error::SerdeMissingField { field, .. } => format!("the key {field} is missing"),
        other => DefaultMessageFormatter.format_message(other).escape_debug().to_string(),
    };
    MapError::Yaml {
        message,
        line: location.map_or(0, |at| at.line()),
        column: location.map_or(0, |at| at.column()),
    }
}

/// Truth values of YAML 1.1, and integers as C++ takes them.
fn truth_value(text: String) -> Result<bool, MapError> {
    match text.to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" | "y" => Ok(true),
        "false" | "no" | "off" | "n" => Ok(false),
        other => match other.parse::<i64>() {
            Ok(number) => Ok(number != 0),
            Err(_) => Err(MapError::Negate { found: text }),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const YAML: &str = "image: a.png\nresolution: 0.05\norigin: [1, 2, 0.5]\nnegate: 0\n\
                        occupied_thresh: 0.65\nfree_thresh: 0.196\n";

    #[test]
    fn negate_is_an_integer_or_a_truth_value() {
        for (text, negate) in [("0", false), ("1", true), ("no", false), ("true", true), ("False", false)] {
            let map = parse_yaml(YAML.replace("negate: 0", &format!("negate: {text}")).as_bytes()).unwrap();
            assert_eq!(map.interpretation.negate, negate, "{text}");
        }
        let bad = parse_yaml(YAML.replace("negate: 0", "negate: maybe").as_bytes());
        assert!(matches!(bad, Err(MapError::Negate { .. })));
    }

    #[test]
    fn byte_order_mark_comments_and_other_keys_are_accepted() {
        let text = format!("\u{feff}# saved by a robot\n{YAML}cost_translation_table: [0, 1]\nmode: Raw\n");
        let map = parse_yaml(text.as_bytes()).unwrap();
        assert_eq!(map.interpretation.mode, Mode::Raw);
        assert_eq!(map.frame.map_from_grid(), Pose2::new(1.0, 2.0, 0.5));
    }
}
