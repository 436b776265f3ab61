//! map_server YAML files, and the meaning of gray values in them (Nav2 and ROS 1).
//!
//! [`cell_value`] is the value that map_server publishes, −1 or 0..=100; [`occupancy`] makes the three states
//! of it. With the rules of [`Rules::Jazzy`] the values are those of nav2_map_server's `map_io`, bit for bit, for
//! every gray value; those of [`Rules::Humble`] and [`Rules::Ros1`] follow from their loaders' formulas
//! (`tests/formats/import_ros.rs`). Cost: one pass over the pixels with a table of 256 values.

mod yaml;

use serde::Serialize;

use super::MapError;
use super::image::{Channels, Raster};
use crate::grid::{Grid, Occupancy};

pub(super) use yaml::yaml_error;
pub use yaml::{MapYaml, parse_yaml};

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

/// The loader to follow where loaders differ.
///
/// | | thresholds | colors | a pixel that is not opaque |
/// |---|---|---|---|
/// | Jazzy | inclusive, in `f32`; free wins | luminance | unknown |
/// | Humble | exclusive, in `f64` | mean | trinary: alpha is averaged in; scale: unknown |
/// | ROS 1 | exclusive, in `f64` | mean | trinary: alpha is averaged in; scale: unknown between the thresholds where alpha is 0 |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Rules {
    /// Navigation 2 of ROS 2 Jazzy, Kilted and later.
    #[default]
    Jazzy,
    /// Navigation 2 of ROS 2 Foxy, Humble and Iron.
    Humble,
    /// map_server of ROS 1.
    Ros1,
}

/// The keys of a map_server YAML that give gray values their meaning.
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
    /// The loader to follow.
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
            rules: Rules::Jazzy,
        }
    }
}

impl Interpretation {
    /// Checks that the thresholds are in 0..=1 and leave room between free and occupied. Map savers write no others,
    /// and releases of map_server read them differently.
    ///
    /// # Errors
    /// If they do not.
    pub fn check_thresholds(&self) -> Result<(), MapError> {
        let Self { occupied_thresh, free_thresh, .. } = *self;
        if 0.0 <= free_thresh && free_thresh < occupied_thresh && occupied_thresh <= 1.0 {
            Ok(())
        } else {
            Err(MapError::Thresholds { occupied_thresh, free_thresh })
        }
    }
}

/// The occupancy value −1 or 0..=100 that map_server gives a pixel.
///
/// `gray` is the pixel's brightness in 0..=255 (an integer with the rules of Jazzy, else a mean of channels), `alpha` 255
/// where the image has none. Jazzy computes in `f32` and assigns free last, so free wins if the thresholds cross; in the
/// others occupied does.
pub fn cell_value(gray: f64, alpha: u8, how: &Interpretation) -> i8 {
    match how.rules {
        Rules::Jazzy => jazzy_value(gray as f32, alpha, how),
        Rules::Humble => humble_value(gray, alpha, how),
        Rules::Ros1 => ros1_value(gray, alpha, how),
    }
}

fn jazzy_value(gray: f32, alpha: u8, how: &Interpretation) -> i8 {
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

fn humble_value(gray: f64, alpha: u8, how: &Interpretation) -> i8 {
    let shade = gray / 255.0;
    if how.mode == Mode::Raw {
        let value = (shade * 255.0).round();
        return if value <= 100.0 { value as i8 } else { -1 };
    }
    let p = if how.negate { shade } else { 1.0 - shade };
    if how.mode == Mode::Scale && alpha < 255 {
        -1
    } else if how.occupied_thresh < p {
        100
    } else if p < how.free_thresh {
        0
    } else if how.mode == Mode::Trinary {
        -1
    } else {
        ((p - how.free_thresh) / (how.occupied_thresh - how.free_thresh) * 100.0).round_ties_even() as i8
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

/// The state of a cell with this occupancy value.
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

/// Brightness of every pixel, measured as the loader does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Brightness {
    /// Per cell: sum of the channels that count, over `divisor`, and the pixel's alpha.
    pub cells: Grid<(u16, u8)>,
    /// Number of channels summed.
    pub divisor: u16,
}

/// Measures the brightness of an image's pixels; row 0 of the result is the image's bottom row.
///
/// Jazzy takes the luminance of colors (weights 0.299, 0.587, 0.114), the others the mean of red, green and blue, in mode
/// trinary with alpha among them where the image has it.
pub fn brightness(raster: Raster, how: &Interpretation) -> Brightness {
    let (width, height, channels) = (raster.width, raster.height, raster.channels);
    let samples = raster.into_8_bit();
    let has_alpha = matches!(channels, Channels::GrayAlpha | Channels::Rgba);
    let alpha_counts = has_alpha && how.mode == Mode::Trinary;
    let n_summed = match how.rules {
        Rules::Jazzy => 1,
        Rules::Humble | Rules::Ros1 => 3 + u16::from(alpha_counts),
    };
    let measure = |pixel: &[u8]| {
        let alpha = if has_alpha { pixel[channels.n_samples() - 1] } else { 255 };
        let sum = match how.rules {
            Rules::Jazzy => u16::from(luminance(colors(pixel, channels))),
            Rules::Humble | Rules::Ros1 => {
                let color: u16 = colors(pixel, channels).into_iter().map(u16::from).sum();
                color + if alpha_counts { u16::from(alpha) } else { 0 }
            }
        };
        (sum, alpha)
    };
    // The flip: the image's last row is the map's first.
    let rows = samples.chunks_exact(width as usize * channels.n_samples()).rev();
    let values = rows.flat_map(|row| row.chunks_exact(channels.n_samples())).map(measure).collect();
    Brightness { cells: Grid::from_rows(width, height, values), divisor: n_summed }
}

/// Red, green and blue: gray images have them alike.
fn colors(pixel: &[u8], channels: Channels) -> [u8; 3] {
    match channels.n_colors() {
        1 => [pixel[0]; 3],
        _ => [pixel[0], pixel[1], pixel[2]],
    }
}

fn luminance(rgb: [u8; 3]) -> u8 {
    let [r, g, b] = rgb.map(u32::from);
    ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jazzy_decides_inclusively_and_the_others_strictly() {
        // Gray 51 has p = 0.8 exactly in f64 as well: 1 - 0.2.
        let jazzy = Interpretation { occupied_thresh: 0.8, free_thresh: 0.2, ..Default::default() };
        // Gray 255 has p = 0, gray 0 has p = 1.
        let ends = Interpretation { occupied_thresh: 1.0, free_thresh: 0.0, ..Default::default() };
        for (rules, values) in [(Rules::Jazzy, [100, 0]), (Rules::Humble, [-1, -1]), (Rules::Ros1, [-1, -1])]
        {
            let with = |how: Interpretation| Interpretation { rules, ..how };
            assert_eq!([0.0, 255.0].map(|gray| cell_value(gray, 255, &with(ends))), values, "{rules:?}");
            // Away from the thresholds all agree.
            assert_eq!([0.0, 128.0, 255.0].map(|gray| cell_value(gray, 255, &with(jazzy))), [100, -1, 0]);
        }
    }

    #[test]
    fn thresholds_leave_room_between_free_and_occupied() {
        let check = |free_thresh, occupied_thresh| {
            Interpretation { occupied_thresh, free_thresh, ..Default::default() }.check_thresholds().is_ok()
        };
        assert!(check(0.196, 0.65) && check(0.0, 1.0));
        let bad = [
            (0.65, 0.196),
            (0.5, 0.5),
            (25.0, 65.0),
            (-1.0, 0.65),
            (0.196, 65.0),
            (0.196, -3.0),
            (f64::NAN, 0.6),
        ];
        for (free, occupied) in bad {
            assert!(!check(free, occupied), "{free} {occupied}");
        }
    }

    /// Value of a pixel of gray and alpha.
    fn value([gray, alpha]: [u8; 2], how: &Interpretation) -> i8 {
        let raster = Raster {
            width: 1,
            height: 1,
            channels: Channels::GrayAlpha,
            samples: super::super::image::Samples::Eight(vec![gray, alpha]),
        };
        let Brightness { cells, divisor } = brightness(raster, how);
        let (sum, alpha) = cells.values()[0];
        cell_value(f64::from(sum) / f64::from(divisor), alpha, how)
    }

    /// Worked by hand from the loaders. With alpha averaged in, black and opaque is (0 + 0 + 0 + 255) / 4 = 63.75, p = 0.75;
    /// black and transparent p = 1; white and transparent (3 · 255 + 0) / 4, p = 0.25; white and opaque p = 0.
    #[test]
    fn alpha_counts_as_the_release_counts_it() {
        let pixels = [[0, 255], [0, 0], [255, 0], [255, 255], [254, 254]];
        let trinary =
            |rules, occupied_thresh| Interpretation { occupied_thresh, rules, ..Default::default() };
        let values = |how: &Interpretation| pixels.map(|pixel| value(pixel, how));
        assert_eq!(values(&trinary(Rules::Jazzy, 0.65)), [100, -1, -1, 0, -1]);
        assert_eq!(values(&trinary(Rules::Humble, 0.65)), [100, 100, -1, 0, 0]);
        assert_eq!(values(&trinary(Rules::Ros1, 0.65)), [100, 100, -1, 0, 0]);
        // Opaque walls are no longer walls: 0.75 < 0.9.
        assert_eq!(values(&trinary(Rules::Humble, 0.9)), [-1, 100, -1, 0, 0]);
        let scale = |rules| Interpretation { rules, mode: Mode::Scale, ..Default::default() };
        assert_eq!(values(&scale(Rules::Jazzy)), [100, -1, -1, 0, -1]);
        assert_eq!(values(&scale(Rules::Humble)), [100, -1, -1, 0, -1]);
        assert_eq!(values(&scale(Rules::Ros1)), [100, 100, 0, 0, 0]);
        assert_eq!(value([128, 0], &scale(Rules::Ros1)), -1);
        assert!(value([128, 255], &scale(Rules::Ros1)) > 0);
    }

    #[test]
    fn colors_count_as_the_release_counts_them() {
        let brightness_of = |rules| {
            let samples = super::super::image::Samples::Eight(vec![0, 255, 0]);
            let raster = Raster { width: 1, height: 1, channels: Channels::Rgb, samples };
            let found = brightness(raster, &Interpretation { rules, ..Default::default() });
            (found.cells.values()[0].0, found.divisor)
        };
        // Green: 0.587 · 255 = 149.685, and a third of 255.
        assert_eq!(brightness_of(Rules::Jazzy), (150, 1));
        assert_eq!(brightness_of(Rules::Humble), (255, 3));
        assert_eq!(brightness_of(Rules::Ros1), (255, 3));
    }

    /// Worked by hand from the loader of ROS 1, which turns the gray over before it looks at the mode.
    #[test]
    fn ros_1_grades_and_inverts() {
        let values = |mode, negate| {
            let how = Interpretation { mode, negate, rules: Rules::Ros1, ..Default::default() };
            [0.0, 60.0, 155.0, 255.0].map(|gray| cell_value(gray, 255, &how))
        };
        assert_eq!(values(Mode::Raw, false), [0, 60, -1, -1]);
        assert_eq!(values(Mode::Raw, true), [-1, -1, 100, 0]);
        // p is 1, 0.765, 0.392 and 0.
        assert_eq!(values(Mode::Trinary, false), [100, 100, -1, 0]);
        // 1 + 98 (0.392 - 0.196) / 0.454 = 43.3.
        assert_eq!(values(Mode::Scale, false), [100, 100, 43, 0]);
        // p is 0, 0.235, 0.608 and 1: 1 + 98 · 0.0866 = 9.5, 1 + 98 · 0.907 = 89.9.
        assert_eq!(values(Mode::Scale, true), [0, 9, 89, 100]);
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
