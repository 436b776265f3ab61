//! Values with a form of their own.

use std::ffi::OsString;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use placegraph::export::{FORMATS, Format, Georeference};
use placegraph::topology::reach::MAX_RADIUS_M;
use placegraph_generate::{Mapping, Style};

/// Pixels of an image, y down, upper bounds exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CropArg {
    /// First column.
    pub(crate) x0: u32,
    /// First row from the top.
    pub(crate) y0: u32,
    /// One past the last column.
    pub(crate) x1: u32,
    /// One past the last row.
    pub(crate) y1: u32,
}

impl std::fmt::Display for CropArg {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{},{},{}", self.x0, self.y0, self.x1, self.y1)
    }
}

impl FromStr for CropArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = comma_separated::<u32>(text);
        match numbers.as_deref() {
            Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Self { x0, y0, x1, y1 }),
            _ => Err(format!("expected X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1, found {text:?}")),
        }
    }
}

/// Farther from the origin than this is nothing: some maps have their origin at a corner of a country.
const FARTHEST_M: f64 = 1e8;

/// A point in meters of the map frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointArg {
    /// First coordinate.
    pub(crate) x: f64,
    /// Second coordinate.
    pub(crate) y: f64,
}

impl FromStr for PointArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match comma_separated::<f64>(text).as_deref() {
            Some(&[x, y]) if x.abs() <= FARTHEST_M && y.abs() <= FARTHEST_M => Ok(Self { x, y }),
            _ => Err(format!("expected X,Y in meters of a place on Earth, found {text:?}")),
        }
    }
}

/// The position of a map on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GeoArg(pub(crate) Georeference);

impl FromStr for GeoArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let place = match comma_separated::<f64>(text).as_deref() {
            Some(&[latitude_deg, longitude_deg, heading_deg]) => {
                Georeference::new(latitude_deg, longitude_deg, heading_deg)
            }
            _ => None,
        };
        let most = Georeference::MAX_LATITUDE_DEG;
        place.map(Self).ok_or_else(|| {
            format!(
                "expected LATITUDE,LONGITUDE,HEADING in degrees, up to {most}, 180 and 360, found {text:?}"
            )
        })
    }
}

/// A share, 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err(format!("expected a number from 0 to 1, found {text:?}")),
    }
}

/// A robot's radius in meters.
pub(crate) fn radius(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(radius_m) if (0.0..=MAX_RADIUS_M).contains(&radius_m) => Ok(radius_m),
        _ => Err(format!("expected meters from 0 to {MAX_RADIUS_M}, found {text:?}")),
    }
}

/// `arg` so that the parser of the command line takes a point with a negative coordinate for a value and not for an option: with a
/// space before it, which the readers of points skip. Several values that may begin with a hyphen would swallow all options
/// after them.
pub(crate) fn no_option(arg: OsString) -> OsString {
    match arg.to_str() {
        Some(text)
            if text.starts_with('-') && text.contains(',') && comma_separated::<f64>(text).is_some() =>
        {
            format!(" {text}").into()
        }
        _ => arg,
    }
}

pub(super) fn comma_separated<T: FromStr>(text: &str) -> Option<Vec<T>> {
    text.split(',').map(|part| part.trim().parse().ok()).collect()
}

/// A point in meters, and the name of its frame if one was typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlacePointArg {
    /// The point.
    pub(crate) point: PointArg,
    /// The frame.
    pub(crate) frame_id: Option<String>,
}

impl FromStr for PlacePointArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let (point, frame_id) = match text.match_indices(',').nth(1) {
            Some((comma, _)) => (&text[..comma], Some(text[comma + 1..].trim().to_owned())),
            None => (text, None),
        };
        let point = point.parse().map_err(|_| format!("expected X,Y or X,Y,FRAME, found {text:?}"))?;
        Ok(Self { point, frame_id })
    }
}

/// A format by its name.
pub(crate) fn format() -> impl TypedValueParser<Value = &'static Format> {
    PossibleValuesParser::new(named_formats())
        .try_map(|name| Format::by_name(&name).ok_or_else(|| format!("there is no format {name}")))
}

fn named_formats() -> impl Iterator<Item = PossibleValue> {
    FORMATS.iter().map(|format| PossibleValue::new(format.name).help(format.doc))
}

/// Formats that one word stands for.
#[derive(Clone, Debug)]
pub(crate) struct Formats(Vec<&'static Format>);

/// The word for every format.
const ALL: &str = "all";

impl Formats {
    /// A format by its name, or all of them.
    pub(crate) fn parser() -> impl TypedValueParser<Value = Self> {
        let all = PossibleValue::new(ALL).help("All of these");
        PossibleValuesParser::new(named_formats().chain([all]))
            .map(|name| Self(FORMATS.iter().filter(|format| name == ALL || name == format.name).collect()))
    }

    /// What several words stand for: each format once, in the order of the table.
    pub(crate) fn in_order(words: &[Self]) -> Vec<&'static Format> {
        let is_asked =
            |format: &&Format| words.iter().any(|word| word.0.iter().any(|f| f.name == format.name));
        FORMATS.iter().filter(is_asked).collect()
    }
}

/// A style of generated buildings by its name.
pub(crate) fn style() -> impl TypedValueParser<Value = Style> {
    let value = |style: Style| {
        let value = PossibleValue::new(style.name());
        match style {
            Style::Mixed => value.help("Any of the six above"),
            Style::Campus => value.help("Open lobbies, wide and deep doors, short dead-end corridors"),
            Style::OpenOffice => value.help("Desks on an open floor around a core"),
            Style::Flat => value.help("Narrow hallways, closets, with door leaves and furniture in the way"),
            _ => value,
        }
    };
    PossibleValuesParser::new(Style::ALL.map(value)).try_map(|name| name.parse::<Style>())
}

/// A way to make maps of generated buildings by its name.
pub(crate) fn mapping() -> impl TypedValueParser<Value = Mapping> {
    let value = |mapping: Mapping| {
        PossibleValue::new(mapping.name()).help(match mapping {
            Mapping::Slam => "A robot drives through and maps what its laser sees",
            Mapping::Clean => "A drawing without furniture",
            Mapping::Furnished => "A drawing with furniture",
            Mapping::Mixed => "Any of these, most often slam",
        })
    };
    PossibleValuesParser::new(Mapping::ALL.map(value)).try_map(|name| name.parse::<Mapping>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_come_once_and_in_the_order_of_the_table() {
        let parse = |words: &[&str]| {
            let word =
                |word: &&str| Formats(FORMATS.iter().filter(|f| *word == ALL || *word == f.name).collect());
            let formats = Formats::in_order(&words.iter().map(word).collect::<Vec<_>>());
            formats.iter().map(|format| format.name).collect::<Vec<_>>()
        };
        assert_eq!(parse(&["svg", "nav2", "svg"]), ["nav2", "svg"]);
        assert_eq!(parse(&["svg", "all"]), FORMATS.iter().map(|format| format.name).collect::<Vec<_>>());
        assert!(parse(&[]).is_empty());
    }

    #[test]
    fn a_point_may_name_its_frame() {
        let point = PointArg { x: 1.5, y: -2.0 };
        assert_eq!("1.5, -2".parse(), Ok(PlacePointArg { point, frame_id: None }));
        assert_eq!("1.5,-2,map".parse(), Ok(PlacePointArg { point, frame_id: Some("map".to_owned()) }));
        for bad in ["", "1", "1,map", "1,nan", "a,b,map", "1e308,1e308", "inf,0"] {
            assert!(bad.parse::<PlacePointArg>().is_err(), "{bad}");
        }
    }
}
