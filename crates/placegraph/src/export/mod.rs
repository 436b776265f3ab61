//! Types to bytes: label images, topology, pictures.

mod dot;
mod error;
mod geojson;
mod graphml;
mod nav2_masks;
mod nav2_route;
mod report;
mod rmf;
mod tmap2;
mod waypoints;
mod yaml;

pub use dot::dot;
pub use error::ExportError;
pub use geojson::regions_geojson;
pub use graphml::graphml;
pub use nav2_masks::{
    Keepout, MaskFiles, MaskSheet, Rotated, SpeedLimit, ValueOf, ZonePer, keepout_mask, speed_mask,
    vector_shapes, zone_mask,
};
pub use nav2_route::nav2_route;
pub use report::{ReportInput, report_html};
pub use rmf::{RmfInfo, rmf_building, rmf_nav_graph};
pub use tmap2::{TmapInfo, tmap2};
