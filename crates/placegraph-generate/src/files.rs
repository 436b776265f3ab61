//! A building as files, in the layout of the evaluation data: bytes only, the caller writes them.

use image::{ExtendedColorType, ImageEncoder, ImageError, codecs::png::PngEncoder};
use placegraph::grid::{Grid, Occupancy, OccupancyGrid};
use serde::Serialize;

use crate::{Building, Record, Style};

/// Why a building could not be turned into bytes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilesError {
    /// A picture could not be encoded.
    #[error("could not encode {name}: {source}")]
    Picture {
        /// Name of the file.
        name: &'static str,
        /// What the encoder says.
        source: ImageError,
    },
    /// The graph or the objects could not be serialized.
    #[error("could not serialize graph.json or objects.json: {0}")]
    Json(#[from] serde_json::Error),
}

/// What `objects.json` holds.
#[derive(Serialize)]
struct Objects<'a> {
    note: &'static str,
    source: &'a str,
    license: Option<&'a str>,
    style: Option<&'static str>,
    mapping: &'static str,
    resolution_m: f64,
    #[serde(flatten)]
    record: &'a Record,
}

/// `map.yaml`, `map.png`, `labels.png`, `rooms.png`, `graph.json` and `objects.json`, each with its bytes.
///
/// Pictures have the map's top in their first row; `rooms.png` has 16 bits a pixel if there are more than 255
/// rooms, else 8.
///
/// # Errors
/// If an encoder fails, which it does only for want of memory.
pub fn files(building: &Building) -> Result<Vec<(&'static str, Vec<u8>)>, FilesError> {
    let [yaml, picture] = map_files(&building.map, "map.png")?;
    let rooms = if building.rooms.values().iter().all(|&room| room <= 255) {
        png("rooms.png", &building.rooms.map(|&room| room as u8), ExtendedColorType::L8, |value| {
            vec![*value]
        })?
    } else {
        png("rooms.png", &building.rooms, ExtendedColorType::L16, |value| value.to_ne_bytes().to_vec())?
    };
    let mut graph = serde_json::to_vec_pretty(&building.graph)?;
    graph.push(b'\n');
    let objects = Objects {
        note: "lines in pixels, y down; the center of the top left pixel is at (0, 0)",
        source: &building.source,
        license: building.license.as_deref(),
        style: building.style.map(Style::name),
        mapping: building.mapping.name(),
        resolution_m: building.map.frame.resolution_m(),
        record: &building.record,
    };
    let mut objects = serde_json::to_vec_pretty(&objects)?;
    objects.push(b'\n');
    Ok(vec![
        ("map.yaml", yaml),
        ("map.png", picture),
        ("labels.png", png("labels.png", &building.labels, ExtendedColorType::L8, |value| vec![*value])?),
        ("rooms.png", rooms),
        ("graph.json", graph),
        ("objects.json", objects),
    ])
}

/// A map as map_server has it: the YAML, which calls the picture `picture`, and the picture.
///
/// # Errors
/// If the encoder fails, which it does only for want of memory.
pub fn map_files(map: &OccupancyGrid, picture: &str) -> Result<[Vec<u8>; 2], FilesError> {
    let gray = map.cells.map(|occupancy| match occupancy {
        Occupancy::Occupied => 0,
        Occupancy::Unknown => 205,
        Occupancy::Free => 254,
    });
    let origin = map.frame.map_from_grid();
    let yaml = format!(
        "image: {picture}\nmode: trinary\nresolution: {}\norigin: [{}, {}, {}]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        map.frame.resolution_m(),
        origin.x,
        origin.y,
        origin.yaw_rad,
    );
    Ok([yaml.into_bytes(), png("map.png", &gray, ExtendedColorType::L8, |value| vec![*value])?])
}

/// `grid` as a PNG, top row first.
fn png<T>(
    name: &'static str,
    grid: &Grid<T>,
    color: ExtendedColorType,
    bytes: impl Fn(&T) -> Vec<u8>,
) -> Result<Vec<u8>, FilesError> {
    let pixels: Vec<u8> =
        (0..grid.height()).rev().flat_map(|y| grid.row(y).iter().flat_map(&bytes)).collect();
    let mut file = Vec::new();
    PngEncoder::new(&mut file)
        .write_image(&pixels, grid.width(), grid.height(), color)
        .map_err(|source| FilesError::Picture { name, source })?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_of_a_picture_is_the_top_of_the_map() {
        let grid = Grid::from_rows(2, 2, vec![1_u8, 2, 3, 4]);
        let file = png("map.png", &grid, ExtendedColorType::L8, |value| vec![*value]).unwrap();
        let picture = image::load_from_memory(&file).unwrap().into_luma8();
        assert_eq!(picture.into_raw(), [3, 4, 1, 2]);
    }
}
