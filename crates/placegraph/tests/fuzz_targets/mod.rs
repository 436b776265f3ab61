//! What every fuzz target does with its bytes: used by `crates/placegraph-fuzz`, and by `fuzz_corpus.rs` to
//! replay the committed corpus on the stable toolchain.

use placegraph::import::{
    Format, LabelCoding, ReadOptions, carmen, image, read_image, read_labels, read_rooms, ros,
};
use placegraph::labels::LabelSet;

/// Small enough for fuzzing, large enough for every branch.
const MAX_CELLS: u64 = 1 << 16;

/// map_server YAML files.
pub fn map_yaml(bytes: &[u8]) {
    if let Ok(map) = ros::parse_yaml(bytes) {
        assert!(map.frame.resolution_m() > 0.0);
        for gray in 0..=255 {
            let value = ros::cell_value(f64::from(gray), 255, &map.interpretation);
            assert!((-1..=100).contains(&value), "{value}");
        }
    }
}

/// Map images: decoded, and made an occupancy grid.
pub fn map_image(bytes: &[u8]) {
    let options = ReadOptions { max_cells: MAX_CELLS, ..ReadOptions::default() };
    if let Ok(raster) = image::decode(bytes, MAX_CELLS) {
        let size = (raster.width, raster.height);
        let (cells, _) = read_image(raster, Format::Image, ros::Interpretation::default(), &options);
        assert_eq!((cells.width(), cells.height()), size);
    }
}

/// CARMEN maps, plain and gzipped.
pub fn carmen(bytes: &[u8]) {
    if let Ok(map) = carmen::parse(bytes, MAX_CELLS) {
        assert!(map.probabilities.values().iter().all(|p| (-1.001..=1.001).contains(p)));
    }
}

/// Label and room images; the first two bytes are the size of the map, less 1.
pub fn label_image(bytes: &[u8]) {
    if let [width, height, image @ ..] = bytes {
        let size = (u32::from(*width) + 1, u32::from(*height) + 1);
        if let Ok(cells) = read_labels(image, size, &LabelCoding::of(&LabelSet::default())) {
            assert_eq!((cells.width(), cells.height()), size);
        }
        if let Ok(cells) = read_rooms(image, size) {
            assert_eq!((cells.width(), cells.height()), size);
        }
    }
}
