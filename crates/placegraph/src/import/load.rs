//! Opens a map, whatever its format.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::file::{self, NamedFiles};
use super::image::Raster;
use super::ros::{self, Brightness, Interpretation, Mode, Rules};
use super::{Format, MapError, image, reader_of, smoothing};
use crate::geom::Pose2;
use crate::grid::{Grid, MapFrame, Occupancy, OccupancyGrid};
use crate::text::printable;

/// What to do with gray 205 where a trinary map's thresholds make it free.
///
/// Map savers write 205 for unknown, p = 0.19608; older Nav2 savers wrote `free_thresh: 0.25` beside it, which
/// makes all unexplored space free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gray205 {
    /// Unknown, where the file has the signature of the trap: see [`Source::gray_205_cells`].
    #[default]
    Unknown,
    /// What the file says.
    AsFile,
}

/// How maps are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Meters per pixel: needed for an image alone; else it replaces what the file says.
    pub resolution_m: Option<f64>,
    /// Replaces the file's threshold (CARMEN maps and images alone: 0.65).
    pub occupied_thresh: Option<f64>,
    /// Replaces the file's threshold (CARMEN maps and images alone: 0.196).
    pub free_thresh: Option<f64>,
    /// Whose loader is followed where Nav2 and ROS 1 differ.
    pub rules: Rules,
    /// What to do with gray 205 where it would be free.
    pub gray_205: Gray205,
    /// Where the image that a YAML names may lie.
    pub named_files: NamedFiles,
    /// Most cells a map may have. Default 400 million.
    pub max_cells: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            resolution_m: None,
            occupied_thresh: None,
            free_thresh: None,
            rules: Rules::default(),
            gray_205: Gray205::default(),
            named_files: NamedFiles::default(),
            max_cells: 400_000_000,
        }
    }
}

impl ReadOptions {
    /// What a file says of its values, with what the options replace.
    pub(super) fn interpretation(&self, file: Interpretation) -> Interpretation {
        Interpretation {
            occupied_thresh: self.occupied_thresh.unwrap_or(file.occupied_thresh),
            free_thresh: self.free_thresh.unwrap_or(file.free_thresh),
            rules: self.rules,
            ..file
        }
    }

    /// Where a file says its cells are, with the resolution of the options.
    pub(super) fn frame(&self, file: MapFrame) -> Result<MapFrame, MapError> {
        let resolution_m = self.resolution_m.unwrap_or(file.resolution_m());
        Ok(MapFrame::new(resolution_m, file.map_from_grid())?)
    }
}

/// How a map was read: what the check of it needs to know.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// Kind of file.
    pub format: Format,
    /// What a gray value, or a CARMEN probability (as mode raw), was taken to mean.
    pub interpretation: Interpretation,
    /// What was asked for gray 205.
    pub gray_205: Gray205,
    /// Number of cells of gray 205 if the map has the signature of the trap, else 0: mode trinary, thresholds
    /// that make 205 free, at least one cell in a hundred of exactly this gray, and more than half of the
    /// cells with a gray between 101 and 249.
    pub gray_205_cells: u64,
    /// Number of cells that an alpha below 255 made unknown.
    pub transparent_cells: u64,
    /// Number of pixels with a gray between those of their neighbors, if so many are that the picture must have been
    /// smoothed, else 0: see [`super::Finding::Smoothed`].
    pub blended_cells: u64,
    /// The image that was read in place of the one that the YAML names, which is not there.
    pub replaced_image: Option<ReplacedImage>,
}

impl Source {
    /// A map read as `interpretation` says, in which nothing was noticed.
    pub fn new(format: Format, interpretation: Interpretation) -> Self {
        Self {
            format,
            interpretation,
            gray_205: Gray205::default(),
            gray_205_cells: 0,
            transparent_cells: 0,
            blended_cells: 0,
            replaced_image: None,
        }
    }
}

/// An image that lies beside a YAML, which names one of the same name elsewhere.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ReplacedImage {
    /// The path in the YAML.
    pub named: String,
    /// Name of the image that was read.
    pub read: String,
}

/// A map that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedMap {
    /// The map.
    pub grid: OccupancyGrid,
    /// [`map_name`] of the path.
    pub name: String,
    /// How it was read.
    pub source: Source,
    /// SHA-256 of the bytes read, the YAML's before the image's, in hexadecimal.
    pub hash: String,
    /// The files that it was read from.
    pub files: Vec<PathBuf>,
}

/// The name of the map at `path`: the file's, without extension; the folder's where the file is just called `map`, as
/// map savers call it. What cannot be printed of it is a low line.
pub fn map_name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    let absolute = std::path::absolute(path).ok();
    let folder = absolute.as_deref().and_then(Path::parent).and_then(Path::file_name);
    let name = if stem == "map" { folder.unwrap_or(stem) } else { stem };
    printable(&name.to_string_lossy())
}

/// Reads the map at `path`: a map_server YAML by its extension, else a CARMEN map (gzipped or not), a Valetudo map or an
/// image by its first bytes. Cost: a few passes over the cells.
///
/// # Errors
/// If a file cannot be read or is not what it should be, see [`MapError`]; the error names the file.
pub fn load_map(path: &Path, options: &ReadOptions) -> Result<LoadedMap, MapError> {
    load(path, options).map_err(|error| error.in_file(path))
}

fn load(path: &Path, options: &ReadOptions) -> Result<LoadedMap, MapError> {
    let is_yaml = is_yaml(path);
    let bytes = if is_yaml {
        file::read(path, file::MAX_TEXT_BYTES)?
    } else {
        file::read_cells(path, options.max_cells)?
    };
    let mut hash = Sha256::new_with_prefix(&bytes);
    let mut files = vec![path.to_owned()];
    let (grid, source) = if is_yaml {
        let yaml = ros::parse_yaml(&bytes)?;
        let (image, replaced_image) = image_of(path, &yaml.image, options)?;
        let in_image = |error| MapError::ImageFile { image: image.clone(), error: Box::new(error) };
        let image_bytes = file::read_cells(&image, options.max_cells).map_err(in_image)?;
        hash.update(&image_bytes);
        options.interpretation(yaml.interpretation).check_thresholds()?;
        files.push(image.clone());
        let raster = image::decode(&image_bytes, options.max_cells).map_err(in_image)?;
        let (cells, source) = read_image(raster, Format::MapServer, yaml.interpretation, options);
        let source = Source { replaced_image, ..source };
        (OccupancyGrid { frame: options.frame(yaml.frame)?, cells }, source)
    } else if let Some(reader) = reader_of(&bytes) {
        (reader.read)(&bytes, options)?
    } else {
        let raster = image::decode(&bytes, options.max_cells)?;
        let resolution_m =
            options.resolution_m.ok_or_else(|| MapError::NoResolution { yaml: yaml_beside(path) })?;
        options.interpretation(Interpretation::default()).check_thresholds()?;
        let (cells, source) = read_image(raster, Format::Image, Interpretation::default(), options);
        (OccupancyGrid { frame: MapFrame::new(resolution_m, Pose2::default())?, cells }, source)
    };
    let hash = hash.finalize().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"));
    Ok(LoadedMap { grid, name: map_name(path), source, hash, files })
}

/// The image that the YAML at `path` names. If it is not there, the one of its name beside the YAML, and which that is: maps
/// are copied from machine to machine, and their YAML files hold the path on the first.
fn image_of(
    path: &Path,
    named: &str,
    options: &ReadOptions,
) -> Result<(PathBuf, Option<ReplacedImage>), MapError> {
    let is_there = path.parent().is_none_or(|folder| folder.join(named).exists());
    match file::namesake(path, named) {
        Some(read) if !is_there => {
            // A YAML that was copied under another name, with its image, still names the first one.
            let own = Path::new(&read).extension().map(|extension| path.with_extension(extension));
            let own = own
                .filter(|own| own.is_file())
                .and_then(|own| Some(own.file_name()?.to_string_lossy().into_owned()));
            if let Some(own) = own.filter(|own| *own != read) {
                return Err(MapError::Outside { name: named.to_owned(), beside: vec![read, own] });
            }
            let image = file::named_file(path, &read, NamedFiles::Inside)?;
            Ok((image, Some(ReplacedImage { named: named.to_owned(), read })))
        }
        _ => Ok((file::named_file(path, named, options.named_files)?, None)),
    }
}

/// Name of the YAML file that lies beside an image and is called like it.
fn yaml_beside(image: &Path) -> Option<String> {
    let yaml =
        ["yaml", "yml"].map(|extension| image.with_extension(extension)).into_iter().find(|p| p.is_file())?;
    Some(yaml.file_name()?.to_string_lossy().into_owned())
}

/// The occupancy that `interpretation` gives the pixels of an image, under `options`; row 0 is the image's
/// bottom row.
pub fn read_image(
    raster: Raster,
    format: Format,
    interpretation: Interpretation,
    options: &ReadOptions,
) -> (Grid<Occupancy>, Source) {
    let how = options.interpretation(interpretation);
    let Brightness { cells, divisor } = ros::brightness(raster, &how);
    let mut counts = vec![0; 256 * usize::from(divisor)];
    let mut transparent_cells = 0;
    for &(sum, alpha) in cells.values() {
        counts[usize::from(sum)] += 1;
        transparent_cells += u64::from(alpha < 255);
    }
    let gray_of = |sum: usize| sum as f64 / f64::from(divisor);
    let gray_205_cells = trap_205(&counts, gray_of, &how);
    let state = |sum: usize, alpha: u8| {
        #[expect(clippy::float_cmp, reason = "whole numbers")]
        let trapped = gray_205_cells > 0 && gray_of(sum) == 205.0 && options.gray_205 == Gray205::Unknown;
        if trapped {
            return Occupancy::Unknown;
        }
        ros::occupancy(ros::cell_value(gray_of(sum), alpha, &how), &how)
    };
    let opaque: Vec<Occupancy> = (0..counts.len()).map(|sum| state(sum, 255)).collect();
    let occupancy = cells.map(|&(sum, alpha)| match alpha {
        255 => opaque[usize::from(sum)],
        _ => state(sum.into(), alpha),
    });
    let gray_205 = options.gray_205;
    let blended_cells = if how.mode == Mode::Raw { 0 } else { smoothing::blended_cells(&cells, &counts) };
    let source = Source::new(format, how);
    (occupancy, Source { gray_205, gray_205_cells, transparent_cells, blended_cells, ..source })
}

/// Number of cells of gray 205 if the map has the signature of the trap, else 0.
fn trap_205(counts: &[u64], gray_of: impl Fn(usize) -> f64, how: &Interpretation) -> u64 {
    if how.mode != Mode::Trinary || how.negate || ros::cell_value(205.0, 255, how) != 0 {
        return 0;
    }
    let count = |wanted: &dyn Fn(f64) -> bool| -> u64 {
        counts.iter().enumerate().filter(|&(sum, _)| wanted(gray_of(sum))).map(|(_, n)| n).sum()
    };
    #[expect(clippy::float_cmp, reason = "whole numbers")]
    let n_205 = count(&|gray| gray == 205.0);
    let n_between = count(&|gray| gray > 100.0 && gray < 250.0);
    let n_cells: u64 = counts.iter().sum();
    if n_205 * 100 >= n_cells && n_205 * 2 > n_between { n_205 } else { 0 }
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}
