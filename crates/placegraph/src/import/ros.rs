//! map_server YAML files and what they make of gray values (Nav2 and ROS 1).
//!
//! [`cell_value`] is the value that map_server publishes, −1 or 0..=100; [`occupancy`] makes the three states
//! of it. With rules of [`Rules::Nav2`] the values are those of nav2_map_server's `map_io`, bit for bit, for
//! every gray value (`tests/formats/import_ros.rs`). Cost: one pass over the pixels with a table of 256 values.

use serde::{Deserialize, Serialize};

use super::MapError;
use super::image::{Channels, Raster};
use crate::geom::Pose2;
use crate::grid::{Grid, MapFrame, Occupancy};

/// How gray values become occupancy values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Occupied, free, and unknown between the thresholds.
    Trinary,
    /// As trinary at the ends, graded between the thresholds.
    Scale,
    /// The gray value is the occupancy value.
    Raw,
}

/// Whose loader is followed where Nav2 and ROS 1 differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Rules {
    /// Thresholds are inclusive, colors are weighed by luminance, a pixel that is not opaque is unknown.
    #[default]
    Nav2,
    /// Thresholds are exclusive, all channels are averaged (alpha too, in mode trinary).
    Ros1,
}

/// The keys of a map_server YAML that say what a gray value means.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interpretation {
    /// How gray values become occupancy values.
    pub mode: Mode,
    /// Whether white is occupied.
    pub negate: bool,
    /// Occupied from this probability on.
    pub occupied_thresh: f64,
    /// Free up to this probability.
    pub free_thresh: f64,
    /// Whose loader is followed.
    pub rules: Rules,
}

impl Default for Interpretation {
    /// What trinary map savers write: 0 occupied, 205 unknown, 254 free.
    fn default() -> Self {
        Self {
            mode: Mode::Trinary,
            negate: false,
            occupied_thresh: 0.65,
            free_thresh: 0.196,
            rules: Rules::Nav2,
        }
    }
}

/// A map_server YAML file.
#[derive(Clone, Debug, PartialEq)]
pub struct MapYaml {
    /// Path of the image, as written: relative to the folder of the YAML file unless it is absolute.
    pub image: String,
    /// Resolution and origin.
    pub frame: MapFrame,
    /// What a gray value means; the rules are Nav2's.
    pub interpretation: Interpretation,
}

/// The file's keys; others, such as `cost_translation_table`, are passed over.
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
        rules: Rules::Nav2,
    };
    Ok(MapYaml { image: keys.image, frame, interpretation })
}

fn yaml_error(error: &serde_saphyr::Error) -> MapError {
    let location = error.location();
    MapError::Yaml {
        // The first line is the message; a picture of the source follows.
        message: error.without_snippet().to_string(),
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

/// The occupancy value −1 or 0..=100 that map_server gives a pixel.
///
/// `gray` is the pixel's brightness in 0..=255 (an integer with the rules of Nav2, a mean of channels with
/// those of ROS 1), `alpha` 255 where the image has none. Nav2 computes in `f32` and assigns free last, so
/// free wins if the thresholds cross.
pub fn cell_value(gray: f64, alpha: u8, how: &Interpretation) -> i8 {
    match how.rules {
        Rules::Nav2 => nav2_value(gray as f32, alpha, how),
        Rules::Ros1 => ros1_value(gray, alpha, how),
    }
}

fn nav2_value(gray: f32, alpha: u8, how: &Interpretation) -> i8 {
    if how.mode == Mode::Raw {
        return if gray <= 100.0 { gray as i8 } else { -1 };
    }
    if alpha < 255 {
        return -1;
    }
    let p = if how.negate { gray / 255.0 } else { 1.0 - gray / 255.0 };
    let (occupied, free) = (how.occupied_thresh as f32, how.free_thresh as f32);
    if p <= free {
        0
    } else if p >= occupied {
        100
    } else if how.mode == Mode::Trinary {
        -1
    } else {
        let span = (how.occupied_thresh - how.free_thresh) as f32;
        ((p - free) / span * 100.0).round() as i8
    }
}

fn ros1_value(gray: f64, alpha: u8, how: &Interpretation) -> i8 {
    let gray = if how.negate { 255.0 - gray } else { gray };
    if how.mode == Mode::Raw {
        return if gray < 101.0 { gray as i8 } else { -1 };
    }
    let p = (255.0 - gray) / 255.0;
    if p > how.occupied_thresh {
        100
    } else if p < how.free_thresh {
        0
    } else if how.mode == Mode::Trinary || alpha < 1 {
        -1
    } else {
        let ratio = (p - how.free_thresh) / (how.occupied_thresh - how.free_thresh);
        (1.0 + 98.0 * ratio) as i8
    }
}

/// The state that an occupancy value stands for.
///
/// In modes trinary and scale the file's thresholds have spoken: 0 is free, 100 is occupied, what lies between
/// them is as unknown as −1. In mode raw the value is a probability in per cent, and the thresholds, which
/// map_server does not look at, are applied to it: `p ≥ occupied_thresh` is occupied, `p ≤ free_thresh` free.
pub fn occupancy(value: i8, how: &Interpretation) -> Occupancy {
    if value < 0 {
        return Occupancy::Unknown;
    }
    match how.mode {
        Mode::Raw => probability_occupancy(f64::from(value) / 100.0, how),
        Mode::Trinary | Mode::Scale if value == 0 => Occupancy::Free,
        Mode::Trinary | Mode::Scale if value == 100 => Occupancy::Occupied,
        Mode::Trinary | Mode::Scale => Occupancy::Unknown,
    }
}

/// The state of a cell that is occupied with probability `p`.
pub(super) fn probability_occupancy(p: f64, how: &Interpretation) -> Occupancy {
    if p <= how.free_thresh {
        Occupancy::Free
    } else if p >= how.occupied_thresh {
        Occupancy::Occupied
    } else {
        Occupancy::Unknown
    }
}

/// Brightness of every pixel, as the loader whose rules are followed measures it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Brightness {
    /// Per cell: sum of the channels that count, over `divisor`, and the pixel's alpha.
    pub cells: Grid<(u16, u8)>,
    /// Number of channels summed.
    pub divisor: u16,
}

/// Measures the brightness of an image's pixels; row 0 of the result is the image's bottom row.
///
/// Nav2 takes the luminance of colors (weights 0.299, 0.587, 0.114), ROS 1 the mean of the channels, in mode
/// trinary with alpha among them.
pub fn brightness(raster: Raster, how: &Interpretation) -> Brightness {
    let (width, height, channels) = (raster.width, raster.height, raster.channels);
    let samples = raster.into_8_bit();
    let n_summed = match (how.rules, how.mode) {
        (Rules::Nav2, _) => 1,
        (Rules::Ros1, Mode::Trinary) => channels.n_samples(),
        (Rules::Ros1, _) => channels.n_colors(),
    };
    let has_alpha = matches!(channels, Channels::GrayAlpha | Channels::Rgba);
    let measure = |pixel: &[u8]| {
        let sum = match how.rules {
            Rules::Nav2 => u16::from(luminance(pixel, channels)),
            Rules::Ros1 => pixel[..n_summed].iter().map(|&v| u16::from(v)).sum(),
        };
        (sum, if has_alpha { pixel[channels.n_samples() - 1] } else { 255 })
    };
    // The flip: the image's last row is the map's first.
    let rows = samples.chunks_exact(width as usize * channels.n_samples()).rev();
    let values = rows.flat_map(|row| row.chunks_exact(channels.n_samples())).map(measure).collect();
    Brightness { cells: Grid::from_rows(width, height, values), divisor: n_summed as u16 }
}

fn luminance(pixel: &[u8], channels: Channels) -> u8 {
    if channels.n_colors() == 1 {
        return pixel[0];
    }
    let [r, g, b] = [0, 1, 2].map(|k| u32::from(pixel[k]));
    ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8
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

    #[test]
    fn ros_1_decides_strictly_and_nav2_inclusively() {
        // Gray 127.5 has p = 0.5 exactly.
        let nav2 = Interpretation { occupied_thresh: 0.5, free_thresh: 0.5, ..Default::default() };
        assert_eq!(cell_value(127.5, 255, &nav2), 0);
        assert_eq!(cell_value(127.5, 255, &Interpretation { rules: Rules::Ros1, ..nav2 }), -1);
    }

    #[test]
    fn alpha_makes_nav2_cells_unknown_and_dims_ros_1_cells() {
        let nav2 = Interpretation::default();
        let ros1 = Interpretation { rules: Rules::Ros1, ..nav2 };
        assert_eq!(cell_value(254.0, 254, &nav2), -1);
        let pixel = |how: &Interpretation| {
            let raster = Raster {
                width: 1,
                height: 1,
                channels: Channels::GrayAlpha,
                samples: super::super::image::Samples::Eight(vec![0, 255]),
            };
            let measured = brightness(raster, how);
            (measured.cells.values()[0], measured.divisor)
        };
        assert_eq!(pixel(&nav2), ((0, 255), 1));
        // A black opaque pixel averages to 127.5 in ROS 1.
        assert_eq!(pixel(&ros1), ((255, 255), 2));
        assert_eq!(pixel(&Interpretation { mode: Mode::Scale, ..ros1 }), ((0, 255), 1));
    }

    #[test]
    fn raw_values_are_per_cent() {
        use Occupancy::{Free, Occupied, Unknown};
        let raw = Interpretation { mode: Mode::Raw, ..Default::default() };
        let states = [0, 19, 20, 64, 65, 100].map(|value| occupancy(value, &raw));
        assert_eq!(states, [Free, Free, Unknown, Unknown, Occupied, Occupied]);
        assert_eq!(occupancy(-1, &raw), Unknown);
    }
}
