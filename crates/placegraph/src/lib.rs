//! From an occupancy grid map to a *semantic-topological map*: every free cell labeled corridor, room or
//! doorway (or the user's own classes), the regions those cells form, and the graph of how they connect.
//!
//! The method is that of O. Martinez Mozos, *Semantic Labeling of Places with Mobile Robots*, chapter 4
//! (key `[Mozos 2010]` throughout; the list is in `docs/references.md`).
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
//! The library prints nothing, reads no clock, draws no random numbers and keeps no state; the environment chooses
//! vector instructions once (`scan::Instructions`), and files are opened by `import::load_map` and its like alone: the same input
//! gives the same bits on any number of threads.
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
//! The examples `01_label_map` to `05_update` show more: own classes, routes, an own feature, and updates that keep names.
//!
//! # Features
//!
//! | feature | what it brings |
//! |---|---|
//! | `default-model` | [`Model::builtin`](model::Model) |
//! | `import` | the readers of map files, label images, training and edit files |
//! | `export` | label images, pictures, and the files of other programs |
//!
//! All are on by default. Without them a map is labeled with less than half of the crates.
//!
//! Items that the documentation does not show are for benches and oracles, and may change in any release.
//!
//! The order of the modules is in `ARCHITECTURE.md`: each uses only those before it.

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
pub mod model;
pub mod pipeline;
pub mod progress;
pub mod regions;
pub mod relax;
pub mod scan;
pub mod spaces;
pub mod syntax;
pub mod text;
pub mod topology;
pub mod training;
