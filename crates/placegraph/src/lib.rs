//! Turns an occupancy grid map into a *semantic-topological map*: labels every free cell as corridor, room or doorway
//! (or as one of your own classes), groups the cells into regions, and builds the graph that connects them.
//!
//! The method is chapter 4 of O. Martinez Mozos, *Semantic Labeling of Places with Mobile Robots* (`[Mozos 2010]` in
//! all comments; `docs/references.md` lists the references).
//!
//! | stage | module | section |
//! |---|---|---|
//! | a simulated laser scan in every free cell | [`scan`] | 4.4 |
//! | rotation-invariant features of the scan | [`features`] | 4.4, appendices A and B |
//! | boosted stumps in a probabilistic decision list | [`boost`] | 4.2, 4.3 |
//! | relaxation labeling over the 8-neighborhood | [`relax`] | 4.5 |
//! | or: instance-based associative Markov network | [`amn`] | 4.6 |
//! | narrow passages marked as doorways (not in the chapter) | [`doorways`] | |
//! | the spaces between them labeled as a whole (not in the chapter) | [`spaces`] | |
//! | regions and the two corrections by size | [`regions`] | 4.7 |
//! | the topological map | [`topology`] | 4.7 |
//!
//! The same input gives the same bits on any number of threads. The library does not print, read a clock or draw random
//! numbers, and keeps no state, except that the environment chooses the vector instructions once (`scan::Instructions`), and that
//! the built-in models are read once.
//! Only functions like `import::load_map` open files.
//!
//! # Start here
//!
//! ```
//! use placegraph::grid::OccupancyGrid;
//! use placegraph::model::Model;
//! use placegraph::pipeline::{Config, analyze};
//! use placegraph::progress::Silent;
//!
//! let map = OccupancyGrid::from_ascii(0.5, "##########\n#........#\n#........#\n##########");
//! let analysis = analyze(&map, &Model::builtin(), &Config::default(), &Silent);
//! assert_eq!(analysis.topology.places.len(), 1);
//! ```
//!
//! The examples `01_label_map` to `05_update` show more: classes of your own, routes, a feature of your own, and updates
//! that keep names.
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `default-model` | [`Model::builtin`](model::Model) |
//! | `import` | the readers of map files, label images, training and edit files |
//! | `export` | label images, pictures, and the files of other programs |
//! | `recording` | messages of ROS 2 in MCAP files; the two above bring it |
//! | `sqlite` | maps in bags of ROS 2 up to Humble (`.db3`); off by default, compiles SQLite |
//! | `ros1` | maps in bags of ROS 1 (`.bag`); off by default |
//!
//! All are on by default. Without them, the library needs less than half of the crates.
//!
//! Items that are hidden in the documentation are for benches and oracles, and may change in any release.
//!
//! `ARCHITECTURE.md` gives the order of the modules: each uses only those before it.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod amn;
pub mod boost;
pub mod cuts;
pub mod document;
pub mod doorways;
pub mod eval;
#[cfg(feature = "export")]
pub mod export;
pub mod features;
pub mod geom;
pub mod grid;
#[cfg(feature = "import")]
pub mod import;
pub mod labels;
pub mod learning;
#[cfg(feature = "recording")]
pub mod messages;
pub mod model;
pub mod pipeline;
pub mod progress;
pub mod regions;
pub mod relax;
#[cfg(all(feature = "import", feature = "export"))]
pub mod result;
pub mod scan;
pub mod session;
#[cfg(all(feature = "import", feature = "export"))]
pub mod site;
pub mod spaces;
pub mod syntax;
pub mod text;
pub mod topology;
pub mod training;
