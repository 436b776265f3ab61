//! Types to bytes: label images, topology, pictures, and the files of other programs (`docs/exports.md`).

mod canvas;
mod error;
mod formats;
mod geojson;
mod labels;
mod mask_settings;
mod nav2_filters;
mod nav2_masks;
mod nav2_route;
mod nav2_shapes;
mod npy;
mod overlay;
mod overview;
mod page;
mod raster;
mod recording;
mod report;
mod rmf;
mod scan_picture;
mod stamp;
mod svg;
mod view;
mod waypoints;
mod yaml;

pub use crate::document::{
    FORMAT, FRAME_ID, FileRecord, MAX_DOCUMENT_BYTES, MapInfo, ModelInfo, ProgramInfo, SkippedFormat,
    TopologyDocument, TopologyError, VERSION,
};
pub use error::ExportError;
pub use formats::{
    Export, FORMATS, Format, MAP, TmapInfo, dot, formats_markdown, graphml, segments_json, tmap2,
    valetudo_json,
};
pub use geojson::{Georeference, regions_geojson};
pub use labels::LabelSheet;
pub use mask_settings::MaskSettings;
pub use nav2_filters::{FilterFiles, nav2_filters};
pub use nav2_masks::{
    Keepout, MaskFiles, MaskSheet, Rotated, SpeedLimit, ValueOf, ZonePer, keepout_mask, speed_mask, zone_mask,
};
pub use nav2_route::nav2_route;
pub use nav2_shapes::vector_shapes;
pub use npy::probability_npy;
pub use overlay::{View, overlay_svg};
pub use overview::overview_png;
pub use raster::{RasterError, label_png, labels_yaml, raster_yaml, region_png};
pub use recording::{RecordingInput, recording};
pub use report::{ReportInput, fill_page, in_script, report_html};
pub use rmf::{RmfBuilding, RmfLevel, RmfLift, RmfStop, rmf_background, rmf_building, rmf_nav_graph};
pub use scan_picture::scan_png;
pub use stamp::{is_stamped, stamped_map};
pub use svg::regions_svg;
pub use view::{VIEWER_STYLE, view_json, view_labels, view_occupancy, view_probability, viewer_script};
