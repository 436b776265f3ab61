//! Folders with a small map and a result of it.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::{done, names};

/// A folder with a small map called `map.yaml`, its image called `image`, and a result of it in `out`.
pub(crate) fn site(image: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    write_map(folder.path(), image, 60);
    folder
}

/// Two rooms and a doorway, `columns` wide.
pub(crate) fn write_map(folder: &Path, image: &str, columns: u32) {
    let is_wall = |x: u32, y: u32| {
        x == 0 || y == 0 || x == columns - 1 || y == 39 || x == columns / 2 && !(15..24).contains(&y)
    };
    let pixels =
        image::GrayImage::from_fn(columns, 40, |x, y| image::Luma([if is_wall(x, y) { 0 } else { 254 }]));
    pixels.save(folder.join(image)).unwrap();
    let yaml = format!(
        "image: {image}\nresolution: 0.1\norigin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
         free_thresh: 0.196\n"
    );
    fs::write(folder.join("map.yaml"), yaml).unwrap();
}

pub(crate) fn labeled(folder: &Path, formats: &str) -> PathBuf {
    let out = folder.join("out");
    done(&[&"map", &folder.join("map.yaml"), &"--out", &out, &"--export", &formats]);
    out
}

/// The files of a folder with their content, by name.
pub(crate) fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = names(folder).into_iter().filter(|name| folder.join(name).is_file());
    files.map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap())).collect()
}
