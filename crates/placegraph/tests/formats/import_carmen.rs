//! CARMEN maps as they are found.

use crate::real_maps;
use std::fs;
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use placegraph::grid::Occupancy;
use placegraph::import::{Format, MapError, ReadOptions, carmen, load_map};

/// A map of `width` × `height` cells with probability 0.
fn file(width: i32, height: i32) -> Vec<u8> {
    let size = 10 + 12 + 4 * width * height;
    let parts = [
        &b"CARMENMAPFILEv020\x01"[..],
        &size.to_le_bytes(),
        b"GRIDMAP   ",
        &width.to_le_bytes(),
        &height.to_le_bytes(),
    ];
    let mut bytes = parts.concat();
    bytes.extend(0.1f32.to_le_bytes());
    bytes.resize(bytes.len() + 4 * (width * height) as usize, 0);
    bytes
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn gzip_is_told_by_its_first_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("level 3.map");
    fs::write(&path, gzipped(&file(3, 2))).unwrap();
    let map = load_map(&path, &ReadOptions::default()).unwrap();
    assert_eq!((map.grid.cells.width(), map.grid.cells.height()), (3, 2));
    assert_eq!(map.grid.count(Occupancy::Free), 6);
    assert_eq!((map.name.as_str(), map.source.format), ("level 3", Format::Carmen));
}

#[test]
fn a_gzip_bomb_is_refused_by_its_header() {
    let bomb = gzipped(&file(4000, 4000));
    assert!(bomb.len() < 100_000);
    assert!(matches!(carmen::parse(&bomb, 1_000_000), Err(MapError::TooManyCells { .. })));
    let comment = gzipped(&[b"#".to_vec(), vec![b'x'; 10_000_000]].concat());
    assert!(matches!(carmen::parse(&comment, 1_000_000), Err(MapError::CarmenTag { .. })));
}

/// A chunk of another type with `size` bytes of data.
fn places(size: u32) -> Vec<u8> {
    [&b"\x04"[..], &(size + 10).to_le_bytes(), b"PLACES    ", &vec![0; size as usize]].concat()
}

#[test]
fn a_gzip_bomb_of_other_chunks_is_refused() {
    let (tag, grid) = (b"CARMENMAPFILEv020".to_vec(), file(3, 2)[17..].to_vec());
    let small = gzipped(&[tag.clone(), places(100), places(1 << 20), grid.clone()].concat());
    assert!(carmen::parse(&small, 6).is_ok());
    let bomb = gzipped(&[tag, places(1 << 25), places(1 << 25), grid].concat());
    assert!(bomb.len() < 100_000);
    assert!(matches!(carmen::parse(&bomb, 6), Err(MapError::CarmenSize { .. })));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.map");
    let at_resolution = file(3, 2).len() - 4 * 7;
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -0.5] {
        for at in (0..7).map(|number| at_resolution + 4 * number) {
            let mut bytes = file(3, 2);
            bytes[at..at + 4].copy_from_slice(&bad.to_le_bytes());
            fs::write(&path, &bytes).unwrap();
            assert!(load_map(&path, &ReadOptions::default()).is_err(), "{bad} at byte {at}");
        }
    }
}

#[test]
fn a_damaged_gzip_stream_is_an_error() {
    let whole = gzipped(&file(30, 20));
    assert!(carmen::parse(&whole, 600).is_ok());
    assert!(matches!(carmen::parse(&whole[..whole.len() / 2], 600), Err(MapError::CarmenRead { .. })));
    let Some(data) = real_maps::folder() else { return };
    let error = load_map(&data.join("carmen_maps/damaged/nsh1.map.gz"), &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("damaged or cut off"), "{error}");
}

#[test]
fn real_maps_agree_with_the_evaluation_set_in_every_cell() {
    let Some(data) = real_maps::folder() else { return };
    let mut n_maps = 0;
    for entry in fs::read_dir(data.join("carmen_maps")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let map = load_map(&path, &ReadOptions::default()).unwrap();
        let name = format!("carmen_{}", map.name.replace('.', "_"));
        let expected =
            load_map(&data.join("eval").join(&name).join("map.yaml"), &ReadOptions::default()).unwrap();
        assert_eq!(map.grid, expected.grid, "{name}");
        n_maps += 1;
    }
    assert_eq!(n_maps, 6);
}

#[test]
fn thresholds_of_the_options_apply() {
    let folder = tempfile::tempdir().unwrap();
    let path: &Path = &folder.path().join("a.map");
    fs::write(path, file(1, 1)).unwrap();
    let count = |options: &ReadOptions, state| load_map(path, options).map(|map| map.grid.count(state));
    assert_eq!(count(&ReadOptions::default(), Occupancy::Free).unwrap(), 1);
    let at_zero = ReadOptions { free_thresh: Some(0.0), occupied_thresh: Some(1e-9), ..Default::default() };
    assert_eq!(count(&at_zero, Occupancy::Free).unwrap(), 1);
    let below = ReadOptions { free_thresh: Some(-0.5), ..Default::default() };
    assert!(count(&below, Occupancy::Free).is_err());
}
