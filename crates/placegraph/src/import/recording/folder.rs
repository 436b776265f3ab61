//! Folders of ROS 2's recorder: the files of a recording, and `metadata.yaml`, which names them in their order.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::file::{MAX_TEXT_BYTES, NamedFiles, named_file, read};
use super::super::ros::yaml_error;
use super::{MapError, wrong};

/// What describes the recording.
const METADATA: &str = "metadata.yaml";

/// The part of `metadata.yaml` that is needed.
#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: Information,
}

#[derive(Deserialize)]
struct Information {
    relative_file_paths: Vec<String>,
}

/// Whether `path` is such a folder.
pub(super) fn is_bag(path: &Path) -> bool {
    // Hidden parts and links are looked at when it is opened.
    path.is_dir() && path.join(METADATA).is_file()
}

/// The files of the recording in `folder`, in the order in which they were recorded; `metadata.yaml` is the first.
///
/// # Errors
/// If `metadata.yaml` cannot be read, names no file, or one outside of the folder.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>, MapError> {
    let metadata = folder.join(METADATA);
    let in_metadata = |error: MapError| error.in_file(&metadata);
    let bytes = read(&metadata, MAX_TEXT_BYTES).map_err(in_metadata)?;
    let read: Metadata = serde_saphyr::from_slice(&bytes).map_err(|error| in_metadata(yaml_error(&error)))?;
    let names = read.rosbag2_bagfile_information.relative_file_paths;
    if names.is_empty() {
        return Err(in_metadata(wrong("it names no file: `ros2 bag reindex` writes it anew".to_owned())));
    }
    let named = names.iter().map(|name| named_file(&metadata, name, NamedFiles::Inside));
    let named = named.collect::<Result<Vec<_>, _>>().map_err(in_metadata)?;
    Ok([vec![metadata], named].concat())
}
