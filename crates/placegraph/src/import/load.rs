//! Opens a map, whatever its format.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::file::NamedFiles;
use super::image::Raster;
use super::recording::Container;
use super::ros::{self, Brightness, Interpretation, Mode, Rules};
use super::storage::{Files, InMemory, OnDisk};
use super::{Format, MapError, image, reader_of, recording, smoothing};
use crate::geom::Pose2;
use crate::grid::{Grid, MapFrame, Occupancy, OccupancyGrid};
use crate::text::printable;

/// How to read gray 205 if the thresholds of a trinary map would make it free.
///
/// Map savers write 205 for unknown, p = 0.19608; older Nav2 savers also wrote `free_thresh: 0.25`, which
/// makes all unexplored space free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gray205 {
    /// Unknown, where the file has the signature of the trap: see [`Source::gray_205_cells`].
    #[default]
    Unknown,
    /// Follow the file.
    AsFile,
}

/// How maps are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Meters per pixel: required for a plain image; for other maps it replaces the value in the file.
    pub resolution_m: Option<f64>,
    /// Replaces the threshold in the file (CARMEN maps and plain images: 0.65).
    pub occupied_thresh: Option<f64>,
    /// Replaces the threshold in the file (CARMEN maps and plain images: 0.196).
    pub free_thresh: Option<f64>,
    /// The loader to follow where Nav2 and ROS 1 differ.
    pub rules: Rules,
    /// How to read gray 205 if the thresholds would make it free.
    pub gray_205: Gray205,
    /// Where an image that a YAML file names may lie.
    pub named_files: NamedFiles,
    /// The topic of a recording's map; `None` where only one has maps.
    pub topic: Option<String>,
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
            topic: None,
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

/// How a map was read, for the check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// Kind of file.
    pub format: Format,
    /// The meaning of gray values, or of CARMEN probabilities (as mode raw).
    pub interpretation: Interpretation,
    /// The requested reading of gray 205.
    pub gray_205: Gray205,
    /// Number of cells of gray 205 if the map has the signature of the trap, else 0: mode trinary, thresholds
    /// that make 205 free, at least one cell in a hundred of exactly this gray, and more than half of the
    /// cells with a gray between 101 and 249.
    pub gray_205_cells: u64,
    /// Number of cells that became unknown because of an alpha below 255.
    pub transparent_cells: u64,
    /// Number of pixels with a gray between those of their neighbors, if there are so many that the picture must have
    /// been smoothed, else 0: see [`super::Finding::Smoothed`].
    pub blended_cells: u64,
    /// The image that was read instead of a missing one that the YAML file names.
    pub replaced_image: Option<ReplacedImage>,
}

impl Source {
    /// A map that was read as `interpretation` says, without remarks.
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

/// An image next to a YAML file that names one of the same name elsewhere.
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

/// The name of the map at `path`: that of the file, without extension, or that of its folder if the file is just
/// called `map`, as map savers call it. Characters that cannot be printed become low lines.
pub fn map_name(path: &Path) -> String {
    name_below(path, std::path::absolute(path).ok().as_deref())
}

/// The name of the map at `path`; a file called `map` takes that of its folder in `whole`, where that names one.
fn name_below(path: &Path, whole: Option<&Path>) -> String {
    // A folder may be called `.`.
    let stem = path.file_stem().or_else(|| whole?.file_stem()).unwrap_or_default();
    let folder = whole.and_then(Path::parent).and_then(Path::file_name);
    let name = if stem == "map" { folder.unwrap_or(stem) } else { stem };
    printable(&name.to_string_lossy())
}

/// Reads the map at `path`: a map_server YAML or a recording by its extension, else what its first bytes say: a file with a whole
/// map, or an image. Cost: a few passes over the cells.
///
/// # Errors
/// If a file cannot be read or is not what it should be, see [`MapError`]; the error names the file.
pub fn load_map(path: &Path, options: &ReadOptions) -> Result<LoadedMap, MapError> {
    load(path, &OnDisk { options }, options).map_err(|error| error.in_file(path))
}

/// Reads the map whose first file is `name` from `files`, each a name and its bytes, for programs without a file
/// system. The image that a YAML file names is found by the last part of its path.
///
/// # Errors
/// As [`load_map`], and [`MapError::NotGiven`] if a file that is needed is not among `files`.
pub fn load_map_from(
    name: &str,
    files: &[(&str, &[u8])],
    options: &ReadOptions,
) -> Result<LoadedMap, MapError> {
    let path = Path::new(name);
    let map = load(path, &InMemory { files, options }, options).map_err(|error| error.in_file(path))?;
    // The folder that the process runs in is not the map's.
    Ok(LoadedMap { name: name_below(path, Some(path)), ..map })
}

fn load(path: &Path, opener: &impl Files, options: &ReadOptions) -> Result<LoadedMap, MapError> {
    if let Some(container) = Container::of(path) {
        let recording = opener.recording(path, container)?;
        let files = match recording.files() {
            [] => vec![path.to_owned()],
            files => files.to_vec(),
        };
        let recorded = recording::last_grid(recording, options)?;
        let (grid, source) = recording::map_of(&recorded, options)?;
        let hash = hex(Sha256::new_with_prefix(&recorded.cdr));
        return Ok(LoadedMap { grid, name: map_name(path), source, hash, files });
    }
    let is_yaml = is_yaml(path);
    let bytes = if is_yaml { opener.text(path)? } else { opener.cells(path)? };
    let mut hash = Sha256::new_with_prefix(&bytes);
    let mut files = vec![path.to_owned()];
    let (grid, source) = if is_yaml {
        let yaml = ros::parse_yaml(&bytes)?;
        let (image, replaced_image) = opener.image(path, &yaml.image)?;
        let in_image = |error| MapError::ImageFile { image: image.clone(), error: Box::new(error) };
        let image_bytes = opener.cells(&image).map_err(in_image)?;
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
    Ok(LoadedMap { grid, name: map_name(path), source, hash: hex(hash), files })
}

fn hex(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// Name of the YAML file next to an image, with the same stem.
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
    has_extension(path, "yaml") || has_extension(path, "yml")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    const YAML: &[u8] = b"image: far/away/map.pgm\nresolution: 0.05\norigin: [1, 2, 0]\nnegate: 0\n\
        occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    const IMAGE: &[u8] = b"P5\n2 1\n255\n\xfe\x00";

    #[test]
    fn a_map_in_memory_is_the_map_on_disk() {
        let folder = tempfile::tempdir().unwrap();
        let yaml = String::from_utf8(YAML.to_vec()).unwrap().replace("far/away/", "");
        let files = [("map.yaml", yaml.as_bytes()), ("map.pgm", IMAGE)];
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let options = ReadOptions { resolution_m: Some(0.1), ..ReadOptions::default() };
        for name in ["map.yaml", "map.pgm"] {
            let on_disk = load_map(&folder.path().join(name), &options).unwrap();
            let in_memory = load_map_from(name, &files, &options).unwrap();
            // On the disk, a file called `map` takes the name of its folder.
            let (files, name) = (on_disk.files.clone(), on_disk.name.clone());
            assert_eq!(LoadedMap { name, files, ..in_memory }, on_disk);
        }
    }

    #[test]
    fn an_image_in_memory_is_found_by_its_last_part_or_named() {
        let options = ReadOptions::default();
        assert!(load_map_from("map.yaml", &[("map.yaml", YAML), ("map.pgm", IMAGE)], &options).is_ok());
        let error = load_map_from("map.yaml", &[("map.yaml", YAML)], &options).unwrap_err();
        assert!(error.to_string().contains("the file map.pgm, which this one names, is missing"), "{error}");
    }

    #[test]
    fn what_is_too_large_in_memory_is_refused_by_its_header() {
        let options = ReadOptions { max_cells: 1, resolution_m: Some(0.1), ..ReadOptions::default() };
        let error = load_map_from("map.pgm", &[("map.pgm", IMAGE)], &options).unwrap_err();
        assert!(error.to_string().contains("2 x 1"), "{error}");
    }
}
