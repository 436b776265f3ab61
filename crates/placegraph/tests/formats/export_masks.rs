//! Nav2's masks, read back as images and parameters.

use std::collections::{BTreeMap, BTreeSet};

use crate::building;
use crate::export_formats::{TURNED, UPRIGHT, known_doorway, sheet};
use placegraph::export::*;
use placegraph::geom::Pose2;

#[test]
fn masks_put_the_value_of_the_class_into_its_cells() {
    let building = building::drawn(UPRIGHT);
    let files =
        speed_mask(&building.map, &sheet(&building, Rotated::Refuse), &SpeedLimit::default()).unwrap();
    let image = image::load_from_memory(&files.image).unwrap().into_luma8();
    for cell in building.grid.cells.cells() {
        let doorway = building.space.graph.node_at(cell).is_some_and(|node| {
            building.regions.regions[building.regions.region_of[node].index()].label.0 == 2
        });
        let pixel = image.get_pixel(cell.x, building.grid.cells.height() - 1 - cell.y).0[0];
        assert_eq!(pixel, if doorway { 50 } else { 0 }, "{cell:?}");
    }
}

#[test]
fn keepout_covers_what_is_no_place() {
    let building = building::drawn(UPRIGHT);
    let files = keepout_mask(&building.map, &sheet(&building, Rotated::Refuse), &Keepout::default()).unwrap();
    let image = image::load_from_memory(&files.image).unwrap().into_luma8();
    let n_free = image.pixels().filter(|pixel| pixel.0[0] == 0).count();
    assert_eq!(n_free, building.space.graph.n_nodes());
    assert!(image.pixels().all(|pixel| [0, 100].contains(&pixel.0[0])));
}

#[test]
fn a_rotated_map_is_refused_or_resampled() {
    let building = building::drawn(TURNED);
    let refused = zone_mask(&building.map, &sheet(&building, Rotated::Refuse), ZonePer::Class);
    assert_eq!(refused, Err(ExportError::Rotated { yaw_rad: 0.4 }));
    let files = zone_mask(&building.map, &sheet(&building, Rotated::Resample), ZonePer::Place).unwrap();
    let image = image::load_from_memory(&files.image).unwrap().into_luma8();
    let upright = building.shape().upright();
    let (doorway, center) = known_doorway(&building);
    let cell = upright.cell_at(center).unwrap();
    let zone = building.map.places.iter().position(|place| place.id == doorway).unwrap() as u8 + 1;
    assert_eq!(image.get_pixel(cell.x, upright.height - 1 - cell.y).0[0], zone);
    let text = String::from_utf8(files.map).unwrap();
    assert!(text.contains("mode: raw") && text.contains(", 0"), "{text}");
}

#[test]
fn limits_that_a_cell_cannot_hold_are_refused() {
    let building = building::drawn(UPRIGHT);
    let class = BTreeMap::from([("room".to_owned(), 140.0)]);
    let speed = SpeedLimit::Percent { limit: ValueOf { class, ..ValueOf::default() } };
    let result = speed_mask(&building.map, &sheet(&building, Rotated::Refuse), &speed);
    assert!(matches!(result, Err(ExportError::Value { max: 100.0, found: 140.0, .. })), "{result:?}");
}

#[test]
fn the_masks_together_have_a_pair_of_servers_each() {
    let building = building::drawn(Pose2::default());
    let sheets = ["keepout", "speed", "zones"].map(|name| MaskSheet {
        image_name: format!("{name}.png"),
        map_name: format!("{name}.yaml"),
        ..sheet(&building, Rotated::Refuse)
    });
    let (keepout, speed) = (Keepout::default(), SpeedLimit::default());
    let files = nav2_filters(&building.map, &sheets, &keepout, &speed, ZonePer::Class).unwrap();
    let text = String::from_utf8(files.parameters).unwrap();
    let parameters: serde_json::Value = serde_saphyr::from_str(&text).unwrap();
    let mut topics = BTreeSet::new();
    for name in ["keepout", "speed", "zone_parameter"] {
        let server = &parameters[format!("{name}_filter_mask_server")]["ros__parameters"];
        let info = &parameters[format!("{name}_costmap_filter_info_server")]["ros__parameters"];
        assert_eq!(server["topic_name"], info["mask_topic"], "{text}");
        let costmap = &parameters["global_costmap"]["global_costmap"]["ros__parameters"];
        assert_eq!(
            costmap[format!("{name}_filter")]["filter_info_topic"],
            info["filter_info_topic"],
            "{text}"
        );
        assert!(
            topics.insert(info["mask_topic"].to_string())
                && topics.insert(info["filter_info_topic"].to_string())
        );
    }
    let listed = |costmap: &str| parameters[costmap][costmap]["ros__parameters"]["filters"].clone();
    assert_eq!(listed("global_costmap"), serde_json::json!(["keepout_filter", "speed_filter"]));
    assert_eq!(listed("local_costmap"), serde_json::json!(["keepout_filter"]));
    let launch = String::from_utf8(files.launch).unwrap();
    for mask in ["'keepout': \"keepout.yaml\"", "'speed': \"speed.yaml\"", "'zone_parameter': \"zones.yaml\""]
    {
        assert!(launch.contains(mask), "{launch}");
    }
}
