//! Types to bytes: label images, topology, pictures, and the files of other programs (`docs/exports.md`).

mod canvas;
mod dot;
mod error;
mod formats;
mod geojson;
mod graphml;
mod mask_settings;
mod nav2_filters;
mod nav2_masks;
mod nav2_route;
mod npy;
mod overlay;
mod overview;
mod page;
mod raster;
mod report;
mod rmf;
mod scan_picture;
mod segments;
mod svg;
mod tmap2;
mod view;
mod waypoints;
mod yaml;

pub use crate::document::{
    FORMAT, FileRecord, MAX_DOCUMENT_BYTES, MapInfo, ModelInfo, ProgramInfo, SkippedFormat, TopologyDocument,
    TopologyError, VERSION,
};
pub use dot::dot;
pub use error::ExportError;
pub use formats::{Export, FORMATS, Format, MAP, formats_markdown, is_stamped, stamped_map};
pub use geojson::{Georeference, regions_geojson};
pub use graphml::graphml;
pub use mask_settings::MaskSettings;
pub use nav2_filters::{FilterFiles, nav2_filters};
pub use nav2_masks::{
    Keepout, MaskFiles, MaskSheet, Rotated, SpeedLimit, ValueOf, ZonePer, keepout_mask, speed_mask,
    vector_shapes, zone_mask,
};
pub use nav2_route::nav2_route;
pub use npy::probability_npy;
pub use overlay::{View, overlay_svg};
pub use overview::overview_png;
pub use raster::{RasterError, label_png, raster_yaml, region_png};
pub use report::{ReportInput, fill_page, in_script, report_html};
pub use rmf::{RmfInfo, rmf_background, rmf_building, rmf_nav_graph};
pub use scan_picture::scan_png;
pub use segments::{segments_json, valetudo_json};
pub use svg::regions_svg;
pub use tmap2::{TmapInfo, tmap2};
pub use view::{VIEWER_STYLE, view_json, view_occupancy, view_probability, viewer_script};
