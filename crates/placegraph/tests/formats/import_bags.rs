//! Bags of ROS 1 and of ROS 2 before Iron. The files in `tests/corpus/bag` and `tests/corpus/database` were written by the Python package
//! `rosbags` 0.11.9; the databases were written anew with pages of 512 bytes and without the texts of definitions. It wrote the folders in
//! `bags` too, packed as a whole.

use std::path::{Path, PathBuf};

use placegraph::import::{ReadOptions, load_map};

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(name)
}

#[cfg(not(all(feature = "sqlite", feature = "ros1")))]
#[test]
fn without_their_features_bags_are_to_be_converted() {
    for (name, is_read, found) in [
        ("bag/plain.bag", cfg!(feature = "ros1"), "ROS 1"),
        ("database/plain.db3", cfg!(feature = "sqlite"), "SQLite"),
    ] {
        let read = load_map(&path(name), &ReadOptions::default());
        let told = read.err().map(|error| error.to_string()).unwrap_or_default();
        assert_eq!(told.contains(found) && told.contains("convert"), !is_read, "{told}");
    }
}

#[cfg(all(feature = "sqlite", feature = "ros1"))]
mod read {
    use std::fs;

    use placegraph::geom::Pose2;
    use placegraph::grid::{Cell, MapFrame, Occupancy};
    use placegraph::import::recording::{Container, Recording, grids, last_grid};
    use placegraph::import::{Format, MapError, load_map_from};
    use rusqlite::Connection;

    use super::*;

    fn on(topic: &str) -> ReadOptions {
        ReadOptions { topic: Some(topic.to_owned()), ..ReadOptions::default() }
    }

    #[test]
    fn the_last_map_by_time_is_read_from_the_disk_and_from_memory() {
        for name in ["bag/plain.bag", "database/plain.db3"] {
            let map = load_map(&path(name), &ReadOptions::default()).unwrap();
            // Seven columns: the one of the time 3, which stands before that of the time 2.
            assert_eq!((map.grid.cells.width(), map.grid.cells.height()), (7, 4), "{name}");
            assert_eq!(map.grid.frame, MapFrame::new(0.05, Pose2::new(-1.5, 2.25, 0.0)).unwrap(), "{name}");
            // The first column is unknown, the lowest row a wall, and one value of 40 is between the thresholds.
            let at = |x, y| map.grid.cells[Cell::new(x, y)];
            assert_eq!(
                [at(0, 2), at(3, 0), at(1, 1)],
                [Occupancy::Unknown, Occupancy::Occupied, Occupancy::Unknown]
            );
            assert_eq!(map.grid.count(Occupancy::Free), 17, "{name}");
            assert_eq!((map.source.format, map.name.as_str()), (Format::Recording, "plain"));
            let bytes = fs::read(path(name)).unwrap();
            let in_memory = load_map_from(name, &[(name, &bytes)], &ReadOptions::default()).unwrap();
            assert_eq!((in_memory.grid, in_memory.hash), (map.grid, map.hash));
        }
    }

    #[test]
    fn what_is_compressed_is_unpacked_and_turns_are_the_decimals_they_were() {
        for (name, yaw_rad) in [("bag/bz2.bag", 0.6), ("bag/lz4.bag", -2.5), ("database/zstd.db3", 0.6)] {
            let frame = load_map(&path(name), &ReadOptions::default()).unwrap().grid.frame;
            assert_eq!(frame.map_from_grid(), Pose2::new(-1.5, 2.25, yaw_rad), "{name}");
        }
    }

    #[test]
    fn a_topic_is_read_in_order_and_of_several_one_is_chosen() {
        for name in ["bag/plain.bag", "database/plain.db3"] {
            let mut times = Vec::new();
            let topics = grids(Recording::open(&path(name)).unwrap(), &on("map"), &mut |grid| {
                times.push(grid.log_time_ns);
                Ok::<(), MapError>(())
            });
            assert_eq!(
                (topics.unwrap().into_iter().collect::<Vec<_>>(), times),
                (vec!["/map".to_owned()], vec![1, 3, 2])
            );
            let error = load_map(&path(name), &on("/scan")).unwrap_err().to_string();
            assert!(error.contains("/scan") && error.contains("found them on /map"), "{error}");
        }
        let name = path("database/topics.db3");
        let error = load_map(&name, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("/costmap, /map"), "{error}");
        assert_eq!(load_map(&name, &on("/map")).unwrap().grid.cells.width(), 6);
    }

    #[test]
    fn a_bag_that_is_cut_off_or_damaged_says_so() {
        for (name, container) in [
            ("bag/plain.bag", Container::Ros1),
            ("bag/bz2.bag", Container::Ros1),
            ("database/plain.db3", Container::Sqlite),
        ] {
            let bytes = fs::read(path(name)).unwrap();
            let error = |bytes: &[u8]| {
                let read = Recording::from_bytes(container, bytes);
                read.and_then(|recording| last_grid(recording, &ReadOptions::default()))
                    .unwrap_err()
                    .to_string()
            };
            for end in [0, 5, 20, 4200, bytes.len() / 2] {
                let told = error(&bytes[..end.min(bytes.len() / 2)]);
                assert!(told.contains("cannot be read"), "{name} {end}: {told}");
            }
            assert!(error(b"something else").contains("cannot be read"));
        }
        let error = load_map(&path("bag/none.bag"), &ReadOptions::default()).unwrap_err();
        assert!(matches!(error.cause(), MapError::Io { .. }), "{error}");
        let error = load_map(&path("database"), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains("folder") || error.to_string().contains("directory"), "{error}");
    }

    #[test]
    fn a_chunk_has_as_many_bytes_as_its_header_says() {
        for (name, change) in ["plain", "bz2", "lz4"].into_iter().flat_map(|name| [(name, -1), (name, 1)]) {
            let mut bytes = fs::read(path(&format!("bag/{name}.bag"))).unwrap();
            let at = bytes.windows(5).position(|five| five == b"size=").unwrap() + 5;
            let size = u32::from_le_bytes(*bytes[at..].first_chunk().unwrap()).wrapping_add_signed(change);
            bytes[at..at + 4].copy_from_slice(&size.to_le_bytes());
            let read = Recording::from_bytes(Container::Ros1, &bytes);
            let error = read.and_then(|recording| last_grid(recording, &ReadOptions::default())).unwrap_err();
            assert!(error.to_string().contains(&format!("a chunk of {size} bytes has")), "{name}: {error}");
        }
    }

    #[test]
    fn messages_larger_than_a_map_may_be_are_refused() {
        let few = ReadOptions { max_cells: 3, ..ReadOptions::default() };
        for name in ["bag/plain.bag", "database/plain.db3"] {
            assert!(
                matches!(load_map(&path(name), &few).unwrap_err().cause(), MapError::TooManyCells { .. }),
                "{name}"
            );
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("large.db3");
        fs::copy(path("database/plain.db3"), &file).unwrap();
        let database = Connection::open(&file).unwrap();
        database.execute("UPDATE messages SET data = zeroblob(20000000)", ()).unwrap();
        drop(database);
        assert!(matches!(load_map(&file, &few).unwrap_err().cause(), MapError::FileTooLarge { .. }));
    }

    fn folder(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/bags").join(name)
    }

    /// A folder as a recorder makes it, of copies of files.
    fn folder_of(parts: &[PathBuf]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let copy = |(n, part): (usize, &PathBuf)| {
            let name = format!("{n}_{}", part.file_name().unwrap().to_string_lossy());
            fs::copy(part, folder.path().join(&name)).unwrap();
            name
        };
        let names: Vec<String> = parts.iter().enumerate().map(copy).collect();
        let metadata =
            format!("rosbag2_bagfile_information: {{relative_file_paths: [{}]}}\n", names.join(", "));
        fs::write(folder.path().join("metadata.yaml"), metadata).unwrap();
        folder
    }

    #[test]
    fn the_folder_of_a_recorder_is_one_recording() {
        for (name, file) in [("sqlite_zstd", "sqlite_zstd.db3.zstd"), ("mcap_zstd", "mcap_zstd.mcap.zstd")] {
            let folder = folder(name);
            let map = load_map(&folder, &ReadOptions::default()).unwrap();
            assert_eq!((map.grid.cells.width(), map.name.as_str()), (7, name));
            assert_eq!(map.grid.count(Occupancy::Occupied), 7);
            let files: Vec<_> = map.files.iter().map(|file| file.file_name().unwrap()).collect();
            assert_eq!(files, ["metadata.yaml", file]);
            // The file alone is the same recording.
            let alone = load_map(&folder.join(file), &ReadOptions::default()).unwrap();
            assert_eq!((alone.grid, alone.hash), (map.grid, map.hash));
        }
    }

    #[test]
    fn of_several_files_the_last_map_of_all_is_taken() {
        let [early, late] = [folder("mcap_zstd/mcap_zstd.mcap.zstd"), path("database/plain.db3")];
        for parts in [[early.clone(), late.clone()], [late, early]] {
            let folder = folder_of(&parts);
            let map = load_map(folder.path(), &ReadOptions::default()).unwrap();
            assert_eq!(map.grid.frame.map_from_grid(), Pose2::new(-1.5, 2.25, 0.0));
            assert_eq!(map.files.len(), 3);
            let mut times = Vec::new();
            let recording = Recording::open(folder.path()).unwrap();
            grids(recording, &on("/map"), &mut |grid| {
                times.push(grid.log_time_ns);
                Ok::<(), MapError>(())
            })
            .unwrap();
            times.sort_unstable();
            assert_eq!(times, [1, 1, 2, 2, 3]);
        }
    }

    #[test]
    fn a_folder_that_is_not_whole_says_which_file_is_wrong() {
        let error = |folder: &Path| load_map(folder, &ReadOptions::default()).unwrap_err().to_string();
        let bag = folder_of(&[path("database/plain.db3"), path("bag/plain.bag")]);
        let cut_off = fs::read(path("bag/plain.bag")).unwrap();
        fs::write(bag.path().join("1_plain.bag"), &cut_off[..cut_off.len() / 2]).unwrap();
        let told = error(bag.path());
        assert!(told.contains("cannot be read") && told.ends_with("1_plain.bag)"), "{told}");
        fs::remove_file(bag.path().join("0_plain.db3")).unwrap();
        let told = error(bag.path());
        assert!(told.contains("No such file") && told.ends_with("0_plain.db3)"), "{told}");
        let metadata = bag.path().join("metadata.yaml");
        fs::write(&metadata, "rosbag2_bagfile_information: {relative_file_paths: []}").unwrap();
        let told = error(bag.path());
        assert!(told.contains("it names no file") && told.ends_with("metadata.yaml)"), "{told}");
        fs::write(&metadata, "rosbag2_bagfile_information: {relative_file_paths: [../other.mcap]}").unwrap();
        assert!(error(bag.path()).contains("../other.mcap"));
        fs::write(&metadata, "something: else").unwrap();
        assert!(error(bag.path()).contains("rosbag2_bagfile_information"));
        let packed = bag.path().join("none.mcap.zstd");
        fs::write(&packed, "nothing that is packed").unwrap();
        assert!(error(&packed).contains("does not unpack"));
    }

    #[test]
    fn nothing_that_a_database_defines_is_run() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("view.db3");
        let database = Connection::open(&file).unwrap();
        let endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id, 1 AS topic_id FROM n";
        database
            .execute_batch(&format!("CREATE TABLE topics (id); CREATE VIEW messages AS {endless}"))
            .unwrap();
        drop(database);
        let error = load_map(&file, &ReadOptions::default()).unwrap_err().to_string();
        assert!(error.contains("no tables topics and messages"), "{error}");
    }
}
