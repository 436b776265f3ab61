//! Every map of the data set through the reader.

use crate::real_maps;
use std::fs;
use std::path::{Path, PathBuf};

use placegraph::grid::{Cell, Occupancy};
use placegraph::import::{MapError, ReadOptions, load_map};

#[test]
fn evaluation_maps_read_as_their_pixels_say() {
    let Some(data) = real_maps::folder() else { return };
    let mut n_maps = 0;
    for entry in fs::read_dir(data.join("eval")).unwrap() {
        let folder = entry.unwrap().path();
        if !folder.is_dir() {
            continue;
        }
        let map = load_map(&folder.join("map.yaml"), &ReadOptions::default()).unwrap();
        let pixels = ::image::open(folder.join("map.png")).unwrap().into_luma8();
        assert_eq!((map.grid.cells.width(), map.grid.cells.height()), pixels.dimensions());
        for (x, row, pixel) in pixels.enumerate_pixels() {
            let expected = match pixel.0[0] {
                0 => Occupancy::Occupied,
                205 => Occupancy::Unknown,
                254 => Occupancy::Free,
                other => panic!("gray {other} in {}", folder.display()),
            };
            assert_eq!(map.grid.cells[Cell::new(x, pixels.height() - 1 - row)], expected);
        }
        n_maps += 1;
    }
    assert!(n_maps >= 95, "{n_maps} maps");
}

#[test]
fn raw_maps_agree_with_the_trinary_ones() {
    let Some(data) = real_maps::folder() else { return };
    for name in
        ["carmen_freiburg", "carmen_longwood", "carmen_nsh_level_3", "carmen_thickwean", "carmen_wean5300"]
    {
        let load = |file: &str| {
            load_map(&data.join("eval").join(name).join(file), &ReadOptions::default()).unwrap().grid.cells
        };
        let (raw, trinary) = (load("map_raw.yaml"), load("map.yaml"));
        let n_same = raw.values().iter().zip(trinary.values()).filter(|(a, b)| a == b).count();
        let share = n_same as f64 / raw.values().len() as f64;
        println!("{name}: {share:.5} of the cells agree");
        // Whole per cents against thresholds of the exact probability.
        assert!(share > 0.99, "{name}: {share}");
    }
}

/// Files that are no maps, or whose image is missing or named elsewhere.
const UNREADABLE: [&str; 7] = [
    "giraff/movecare_map1.yaml",
    "giraff/movecare_map_integrationmeeting1903.yaml",
    "brsu-c069/navigation_goals.yaml",
    "wrs20-arena/navigation_goals.yaml",
    "test/invalid_image.yaml",
    "maps-nostre/movecare_map.yaml",
    "Virtual/mapirlab.yaml",
];

fn yaml_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            yaml_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "yaml") {
            found.push(path);
        }
    }
}

#[test]
fn maps_as_their_authors_published_them() {
    let Some(data) = real_maps::folder() else { return };
    let mut files = Vec::new();
    yaml_files(&data.join("ros_maps"), &mut files);
    yaml_files(&data.join("rose"), &mut files);
    assert!(files.len() > 40);
    for path in files {
        let expected_error = UNREADABLE.iter().any(|end| path.ends_with(end));
        match load_map(&path, &ReadOptions::default()) {
            Ok(map) => {
                assert!(!expected_error, "{} was read", path.display());
                assert!(map.grid.count(Occupancy::Free) > 0, "{}", path.display());
            }
            Err(error) => assert!(expected_error, "{error}"),
        }
    }
    // All three name the image of the first, on the machine that it comes from.
    let load = |name: &str| load_map(&data.join("rose/giraff").join(name), &ReadOptions::default());
    assert!(
        load("movecare_map.yaml")
            .unwrap()
            .source
            .replaced_image
            .is_some_and(|i| i.read == "movecare_map.pgm")
    );
    let error = load("movecare_map1.yaml").unwrap_err();
    assert!(matches!(error.cause(), MapError::Outside { beside, .. } if beside.len() == 2), "{error}");
    assert!(error.to_string().contains("movecare_map.pgm or movecare_map1.pgm"), "{error}");
}

#[test]
fn the_depot_of_nav2_is_the_trap() {
    let Some(data) = real_maps::folder() else { return };
    let map = load_map(&data.join("ros_maps/navigation2/depot.yaml"), &ReadOptions::default()).unwrap();
    assert_eq!(map.source.gray_205_cells, map.grid.count(Occupancy::Unknown) as u64);
    assert!(map.source.gray_205_cells > 0);
}
