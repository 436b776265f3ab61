//! What is read and written: maps, labels, models, documents, exports, and the corpus of the fuzz targets.
//!
//! One program for many files: each program is linked on its own, which takes longer than to compile a file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "helpers of tests")]

#[path = "../places/building/mod.rs"]
mod building;
mod export_formats;
mod export_masks;
mod export_overview;
mod export_raster;
mod fuzz_corpus;
#[expect(unreachable_pub, reason = "the fuzz crate exports them")]
mod fuzz_targets;
mod import_bags;
mod import_carmen;
mod import_check;
mod import_images;
mod import_label_files;
mod import_labels;
mod import_maps;
mod import_recording;
mod import_ros;
mod model_file;
mod numbers;
mod real_maps;
mod topology_document;
