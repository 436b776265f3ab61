//! Recordings of ROS 2. The files in `tests/corpus/recording` were written by the Python packages `mcap` and `rosbags`.

use std::fs;
use std::path::{Path, PathBuf};

use placegraph::export::{RecordingInput, recording as write};
use placegraph::geom::Pose2;
use placegraph::grid::{Cell, GridShape, MapFrame, Occupancy, OccupancyGrid};
use placegraph::import::recording::{Container, RecordedGrid, Recording, grids, last_grid, map_of};
use placegraph::import::{Format, LoadedMap, MapError, ReadOptions, load_map, load_map_from};
use placegraph::labels::LabelSet;
use placegraph::messages::{self, MarkerArray, Quaternion, Text, from_cdr, to_cdr};
use placegraph::topology::TopologicalMap;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus/recording").join(name)
}

fn on(topic: &str) -> ReadOptions {
    ReadOptions { topic: Some(topic.to_owned()), ..ReadOptions::default() }
}

fn mcap(bytes: &[u8]) -> Recording<'_> {
    Recording::from_bytes(Container::Mcap, bytes).unwrap()
}

fn load(name: &str) -> Result<LoadedMap, MapError> {
    load_map(&path(name), &ReadOptions::default())
}

/// Rows from the top.
fn drawn(map: &OccupancyGrid) -> Vec<String> {
    let state = |x, y| match map.cells[Cell::new(x, y)] {
        Occupancy::Free => '.',
        Occupancy::Occupied => '#',
        Occupancy::Unknown => '?',
    };
    (0..map.cells.height()).rev().map(|y| (0..map.cells.width()).map(|x| state(x, y)).collect()).collect()
}

#[test]
fn the_last_map_by_time_is_read() {
    let map = load("plain.mcap").unwrap();
    // Seven columns: the one of the time 3, which stands before that of the time 2.
    assert_eq!(drawn(&map.grid), ["?......", "?......", "??.....", "?######"]);
    assert_eq!((map.source.format, map.name.as_str()), (Format::Recording, "plain"));
    assert_eq!(map.grid.frame, MapFrame::new(0.05, Pose2::new(-1.5, 2.25, 0.0)).unwrap());
    assert_eq!(map.hash.len(), 64);
}

#[test]
fn in_memory_as_on_the_disk() {
    let bytes = fs::read(path("plain.mcap")).unwrap();
    let files = [("plain.mcap", bytes.as_slice())];
    let in_memory = load_map_from("plain.mcap", &files, &ReadOptions::default()).unwrap();
    let on_disk = load("plain.mcap").unwrap();
    assert_eq!((in_memory.grid, in_memory.hash), (on_disk.grid, on_disk.hash));
}

#[test]
fn chunks_are_unpacked_and_turns_are_the_decimals_they_were() {
    for (name, yaw_rad) in [("zstd.mcap", 0.6), ("lz4.mcap", -2.5)] {
        let frame = load(name).unwrap().grid.frame;
        assert_eq!(
            (frame.resolution_m(), frame.map_from_grid()),
            (0.05, Pose2::new(-1.5, 2.25, yaw_rad)),
            "{name}"
        );
    }
    let frame = MapFrame::new(0.1, Pose2::new(-1.5, 2.25, 0.0)).unwrap();
    assert_eq!(load("big_endian.mcap").unwrap().grid.frame, frame);
}

#[test]
fn of_several_topics_one_is_chosen() {
    let Err(MapError::InFile { error, .. }) = load("topics.mcap") else {
        panic!("several topics are an error")
    };
    assert!(
        matches!(&*error, MapError::SeveralTopics { found } if *found == ["/costmap", "/map"]),
        "{error}"
    );
    for topic in ["/map", "map"] {
        assert_eq!(load_map(&path("topics.mcap"), &on(topic)).unwrap().grid.cells.width(), 6);
    }
    let error = load_map(&path("topics.mcap"), &on("/scan")).unwrap_err().to_string();
    assert!(error.contains("/scan") && error.contains("/costmap, /map"), "{error}");
}

#[test]
fn what_has_no_map_says_so() {
    assert!(matches!(load("no_map.mcap").unwrap_err().cause(), MapError::NoRecordedGrid));
    let error = load_map(&path("no_map.mcap"), &on("/map")).unwrap_err().to_string();
    assert!(error.contains("found none"), "{error}");
    let error = load("none.mcap").unwrap_err();
    assert!(matches!(error.cause(), MapError::Io { .. }), "{error}");
}

/// A chunk of MCAP that is not packed, around `records`.
fn chunk(records: &[u8]) -> Vec<u8> {
    let size = (records.len() as u64).to_le_bytes();
    let mut content = vec![0; 16];
    content.extend_from_slice(&size);
    // No checksum, no name of a compression.
    content.extend_from_slice(&[0; 8]);
    content.extend_from_slice(&size);
    content.extend_from_slice(records);
    [&[6][..], &(content.len() as u64).to_le_bytes(), &content].concat()
}

#[test]
fn a_chunk_holds_records_that_end_in_it_and_no_chunk() {
    let error = |records: &[u8]| {
        let bytes = [&b"\x89MCAP0\r\n"[..], &chunk(records)].concat();
        last_grid(mcap(&bytes), &ReadOptions::default()).unwrap_err().to_string()
    };
    assert!(error(&chunk(&[])).contains("a chunk is in a chunk"), "{}", error(&chunk(&[])));
    // A message of 100 bytes in a chunk of 9.
    let cut_off = [&[5][..], &100_u64.to_le_bytes()].concat();
    assert!(error(&cut_off).contains("it is cut off"), "{}", error(&cut_off));
    assert!(load("chunk_in_chunk.mcap").is_err());
}

#[test]
fn what_is_no_grid_is_not_looked_into() {
    // An attachment without room for its checksum.
    let attachment = [&[9][..], &34_u64.to_le_bytes(), &[0; 34]].concat();
    let plain = fs::read(path("plain.mcap")).unwrap();
    let with = [&plain[..8], &attachment, &plain[8..]].concat();
    let grid = last_grid(mcap(&with), &ReadOptions::default()).unwrap();
    assert_eq!(grid.cdr, last_grid(mcap(&plain), &ReadOptions::default()).unwrap().cdr);
}

#[test]
fn a_recording_that_is_cut_off_or_damaged_says_so() {
    let error = |bytes: &[u8]| last_grid(mcap(bytes), &ReadOptions::default()).unwrap_err().to_string();
    for name in ["plain.mcap", "zstd.mcap", "lz4.mcap"] {
        let bytes = fs::read(path(name)).unwrap();
        for end in [9, 100, bytes.len() / 2, bytes.len() - 1] {
            assert!(error(&bytes[..end]).contains("cut off"), "{name} {end}: {}", error(&bytes[..end]));
        }
        // In the middle of the first chunk.
        let mut damaged = bytes.clone();
        damaged[300] ^= 0x55;
        assert!(error(&damaged).contains("cannot be read"), "{name}: {}", error(&damaged));
    }
    assert!(error(b"something else").contains("does not begin"), "{}", error(b"something else"));
}

#[test]
fn a_topic_is_read_in_order() {
    let bytes = fs::read(path("plain.mcap")).unwrap();
    let mut times = Vec::new();
    let topics = grids(mcap(&bytes), &on("/map"), &mut |grid| {
        times.push(grid.log_time_ns);
        Ok::<(), MapError>(())
    });
    assert_eq!(topics.unwrap().into_iter().collect::<Vec<_>>(), ["/map"]);
    assert_eq!(times, [1, 3, 2]);
}

fn message(change: impl FnOnce(&mut messages::OccupancyGrid)) -> RecordedGrid {
    let mut message = messages::OccupancyGrid { data: vec![0; 6], ..messages::OccupancyGrid::default() };
    (message.info.width, message.info.height, message.info.resolution) = (3, 2, 0.05);
    change(&mut message);
    RecordedGrid { topic: "/map".to_owned(), log_time_ns: 0, cdr: to_cdr(&message).unwrap() }
}

#[test]
fn messages_that_are_no_map_say_why() {
    let options = ReadOptions { max_cells: 100, ..ReadOptions::default() };
    assert!(map_of(&message(|_| {}), &options).is_ok(), "an orientation that was not filled is none");
    let error = |change: fn(&mut messages::OccupancyGrid)| {
        map_of(&message(change), &options).unwrap_err().to_string()
    };
    assert!(error(|m| m.info.width = 0).contains("at least one cell"));
    assert!(error(|m| m.info.width = 4).contains("expected 8 cells, found 6"));
    assert!(error(|m| m.info.height = 1000).contains("at most 100 cells"));
    assert!(error(|m| m.info.resolution = 0.0).contains("resolution"));
    assert!(error(|m| m.info.resolution = f32::NAN).contains("resolution"));
    assert!(error(|m| m.info.origin.position.x = f64::INFINITY).contains("origin"));
    assert!(error(|m| m.data[3] = 101).contains("found 101"));
    assert!(error(|m| m.data[3] = -2).contains("found -2"));
    assert!(error(|m| m.info.origin.orientation.w = 3.0).contains("unit quaternion"));
    assert!(error(|m| m.info.origin.orientation.x = 1.0).contains("tilted"));
}

#[test]
fn both_quaternions_of_a_turn_are_the_same_turn() {
    for yaw_rad in [0.0, 0.6, -2.5, 3.0] {
        for sign in [1.0, -1.0] {
            let recorded = message(|m| {
                let Quaternion { z, w, .. } = Quaternion::from_yaw(yaw_rad);
                m.info.origin.orientation = Quaternion { z: sign * z, w: sign * w, ..Quaternion::default() };
            });
            let (map, _) = map_of(&recorded, &ReadOptions::default()).unwrap();
            assert_eq!(map.frame.map_from_grid(), Pose2::new(0.0, 0.0, yaw_rad), "{sign}");
        }
    }
}

#[test]
fn what_is_written_is_read() {
    let map = OccupancyGrid::from_ascii(0.05, "####\n#..#\n?.##");
    let shape = GridShape { frame: map.frame, width: 4, height: 3 };
    let labels = LabelSet::default();
    let bytes = write(&RecordingInput {
        map: &TopologicalMap::default(),
        labels: &labels,
        shape: &shape,
        frame_id: "map",
        occupancy: Some(&map.cells),
        document: "{}".to_owned(),
        written: std::time::Duration::from_secs(7),
        library: "test",
    })
    .unwrap();
    let read = last_grid(mcap(&bytes), &on("/map")).unwrap();
    assert_eq!(read.log_time_ns, 7_000_000_000);
    assert_eq!(drawn(&map_of(&read, &ReadOptions::default()).unwrap().0), ["####", "#..#", "?.##"]);
    let labels = last_grid(mcap(&bytes), &on("/placegraph/labels")).unwrap();
    let labels: messages::OccupancyGrid = from_cdr(&labels.cdr).unwrap();
    assert_eq!(labels.data, [-1; 12], "no place is anywhere");
    // Not only the reader of this crate is the judge: `check_exports.py` opens exported files with other programs.
    let others = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    let topics: Vec<(String, Vec<u8>)> = others.map(|m| (m.channel.topic.clone(), m.data.to_vec())).collect();
    let names: Vec<&str> = topics.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ["/map", "/placegraph/labels", "/placegraph/regions", "/placegraph/markers", "/placegraph/topology"]
    );
    let markers: MarkerArray = from_cdr(&topics[3].1).unwrap();
    assert_eq!((markers.markers.len(), markers.markers[0].action), (3, 3));
    assert_eq!(from_cdr::<Text>(&topics[4].1).unwrap().data, "{}");
}
