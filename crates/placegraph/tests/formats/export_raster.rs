//! Images and arrays that are written, read back.

use placegraph::export::{RasterError, label_png, raster_yaml, region_png};
use placegraph::geom::Pose2;
use placegraph::grid::{CellGraph, MapFrame, OccupancyGrid};
use placegraph::import::image::{Samples, decode};
use placegraph::import::{LabelCell, LabelCoding, read_labels, read_rooms, ros};
use placegraph::labels::{Label, LabelSet};
use placegraph::regions::{DiagonalSteps, Region, RegionId, RegionMap};
use placegraph::topology::PlaceId;
use proptest::prelude::*;

fn map() -> OccupancyGrid {
    OccupancyGrid::from_ascii(
        0.05,
        "
        ..#
        #.?
        ",
    )
}

#[test]
fn a_label_image_reads_back_as_written() {
    let graph = CellGraph::new(&map().cells);
    let labeling = vec![Label(2), Label(0), Label(1)];
    let png = label_png(&graph, &labeling);
    assert_eq!(decode(&png, 6).unwrap().samples, Samples::Eight(vec![1, 2, 0, 0, 3, 0]));
    let cells = read_labels(&png, (3, 2), &LabelCoding::of(&LabelSet::default())).unwrap();
    for (node, &cell) in graph.cells().iter().enumerate() {
        assert_eq!(cells[cell], LabelCell::Class(labeling[node]));
    }
}

#[test]
fn a_region_image_has_16_bits_and_says_when_they_do_not_do() {
    let graph = CellGraph::new(&map().cells);
    let region = Region { label: Label(0), n_cells: 1 };
    let regions = |n: usize| RegionMap {
        region_of: vec![RegionId(0), RegionId(299), RegionId(1)],
        regions: vec![region; n],
        diagonal: DiagonalSteps::default(),
    };
    let up_to = |n: u32| -> Vec<Option<PlaceId>> { (1..=n).map(|id| Some(PlaceId(id))).collect() };
    let png = region_png(&graph, &regions(300), &up_to(300)).unwrap();
    assert_eq!(read_rooms(&png, (3, 2)).unwrap().values(), [0, 1, 0, 300, 2, 0]);
    let mut place_ids = up_to(300);
    place_ids[0] = None;
    place_ids[1] = Some(PlaceId(65535));
    let png = region_png(&graph, &regions(300), &place_ids).unwrap();
    assert_eq!(read_rooms(&png, (3, 2)).unwrap().values(), [0, 0, 0, 300, 65535, 0]);
    place_ids[1] = Some(PlaceId(65536));
    let refused = region_png(&graph, &regions(300), &place_ids);
    assert_eq!(refused, Err(RasterError::TooManyRegions { found: 65536 }));
}

#[test]
fn the_yaml_keeps_class_ids_in_map_server() {
    let frame = MapFrame::new(0.05, Pose2::new(-10.0, 2.5, 0.0)).unwrap();
    let yaml = raster_yaml("labels.png", &frame);
    assert_eq!(
        yaml,
        "image: \"labels.png\"\nmode: raw\nresolution: 0.05\norigin: [-10.0, 2.5, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    );
    let read = ros::parse_yaml(yaml.as_bytes()).unwrap();
    for id in 0..=100 {
        assert_eq!(ros::cell_value(f64::from(id), 255, &read.interpretation), id);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn the_yaml_keeps_every_bit(
        resolution in 1e-6f64..1e6,
        x in -1e9f64..1e9,
        y in proptest::num::f64::NORMAL.prop_filter("origins are within 1e9 m", |y| y.abs() <= 1e9),
        yaw in -7.0f64..7.0,
        image in "[^\\p{C}]{1,20}",
    ) {
        let frame = MapFrame::new(resolution, Pose2::new(x, y, yaw)).unwrap();
        let read = ros::parse_yaml(raster_yaml(&image, &frame).as_bytes()).unwrap();
        prop_assert_eq!(read.frame, frame);
        prop_assert_eq!(read.image, image);
    }
}
