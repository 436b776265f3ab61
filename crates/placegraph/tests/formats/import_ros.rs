//! map_server rules against what nav2_map_server itself gave, and map files good and bad.

use crate::real_maps;
use std::fs;

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Occupancy};
use placegraph::import::image::{Channels, Raster, Samples};
use placegraph::import::ros::{self, Interpretation, Mode, Rules};
use placegraph::import::{Finding, Format, Gray205, MapError, NamedFiles, ReadOptions, check, load_map};

pub(crate) const YAML: &str = "image: map.pgm\nresolution: 0.05\norigin: [1, 2, 0.5]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A folder with `map.yaml` and `map.pgm`.
pub(crate) fn folder(yaml: &str, image: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("map.yaml"), yaml).unwrap();
    fs::write(folder.path().join("map.pgm"), image).unwrap();
    folder
}

pub(crate) fn load_yaml(yaml: &str, image: &[u8]) -> Result<placegraph::import::LoadedMap, MapError> {
    load_map(&folder(yaml, image).path().join("map.yaml"), &ReadOptions::default())
}

/// The error inside the wrapper that names the file.
pub(crate) fn cause(error: MapError) -> MapError {
    match error {
        MapError::InFile { error, .. } | MapError::ImageFile { error, .. } => cause(*error),
        other => other,
    }
}

#[test]
fn every_gray_value_is_what_nav2_map_server_gives() {
    let Some(data) = real_maps::folder() else { return };
    let file = data.join("../tools/nav2_map_vectors.json");
    let vectors: serde_json::Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
    let mut n_compared = 0;
    for case in vectors["cases"].as_array().unwrap() {
        let how = Interpretation {
            mode: match case["mode"].as_str().unwrap() {
                "trinary" => Mode::Trinary,
                "scale" => Mode::Scale,
                _ => Mode::Raw,
            },
            negate: case["negate"] == 1,
            occupied_thresh: case["occupied_thresh"].as_f64().unwrap(),
            free_thresh: case["free_thresh"].as_f64().unwrap(),
            rules: Rules::Jazzy,
        };
        for (gray, expected) in case["occupancy"].as_array().unwrap().iter().enumerate() {
            let found = ros::cell_value(gray as f64, 255, &how);
            assert_eq!(i64::from(found), expected.as_i64().unwrap(), "gray {gray}, {how:?}");
            n_compared += 1;
        }
    }
    assert_eq!(n_compared, 21 * 256);
}

#[test]
fn the_first_row_of_the_image_is_the_top_of_the_map() {
    let map = load_yaml(YAML, b"P2 # comment\n2 2\n# another\n255\n0 254\n205 254\n").unwrap();
    assert_eq!(map.grid.cells[Cell::new(0, 1)], Occupancy::Occupied);
    assert_eq!(map.grid.cells[Cell::new(0, 0)], Occupancy::Unknown);
    assert_eq!(map.grid.cells.row(0)[1], Occupancy::Free);
    assert_eq!(map.grid.frame.map_from_grid(), Pose2::new(1.0, 2.0, 0.5));
    assert_eq!(map.source.format, Format::MapServer);
}

#[test]
fn a_map_is_called_by_its_file_or_its_folder() {
    let name = |path: &str| placegraph::import::map_name(std::path::Path::new(path));
    assert_eq!(name("sites/office/map.yaml"), "office");
    assert_eq!(name("sites/office/floor1.yaml"), "floor1");
    assert_eq!(name("sites/map/other.pgm"), "other");
    assert_eq!(name("/map.yaml"), "map");
    let here = std::env::current_dir().unwrap();
    assert_eq!(name("map.yaml"), here.file_name().unwrap().to_string_lossy());
}

#[test]
fn the_hash_covers_yaml_and_image() {
    let hash = |yaml, image| load_yaml(yaml, image).unwrap().hash;
    let other_yaml = YAML.replace("0.05", "0.1");
    // cat map.yaml map.pgm | sha256sum
    let one = hash(YAML, b"P2 1 1 255 0");
    assert_eq!(one, "e567c038a935319b14090e2a76fa716c459a169ef146346d271064fb156f43d7");
    assert_ne!(one, hash(&other_yaml, b"P2 1 1 255 0"));
    assert_ne!(one, hash(YAML, b"P2 1 1 255 1"));
}

#[test]
fn saved_with_free_thresh_25_unknown_stays_unknown_unless_asked() {
    let yaml = YAML.replace("0.196", "0.25");
    let image = b"P2 4 1 255 0 205 205 254";
    let map = load_yaml(&yaml, image).unwrap();
    assert_eq!(map.grid.count(Occupancy::Unknown), 2);
    assert_eq!(map.source.gray_205_cells, 2);

    let options = ReadOptions { gray_205: Gray205::AsFile, ..Default::default() };
    let map = load_map(&folder(&yaml, image).path().join("map.yaml"), &options).unwrap();
    assert_eq!((map.grid.count(Occupancy::Free), map.source.gray_205_cells), (3, 2));

    // A picture with all shades of gray is no saved map: the file's word counts.
    let shades = b"P2 6 1 255 0 205 204 203 202 254";
    assert_eq!(load_yaml(&yaml, shades).unwrap().grid.count(Occupancy::Free), 5);
    // One shade more is one too many; what is as bright as 250 is white and no shade.
    let free = |image: &[u8]| load_yaml(&yaml, image).unwrap().grid.count(Occupancy::Free);
    assert_eq!([free(b"P2 4 1 255 0 205 204 254"), free(b"P2 4 1 255 0 205 250 254")], [3, 2]);
}

#[test]
fn options_replace_what_the_file_says() {
    let options = ReadOptions {
        resolution_m: Some(0.2),
        free_thresh: Some(0.1),
        occupied_thresh: Some(0.3),
        ..Default::default()
    };
    let image = b"P2 3 1 255 170 205 254";
    let map = load_map(&folder(YAML, image).path().join("map.yaml"), &options).unwrap();
    assert_eq!(map.grid.cells.values(), [Occupancy::Occupied, Occupancy::Unknown, Occupancy::Free]);
    assert!((map.grid.frame.resolution_m() - 0.2).abs() < 1e-15);
}

#[test]
fn an_image_alone_needs_a_resolution() {
    let folder = folder("", b"P2 1 1 255 254");
    let image = folder.path().join("map.pgm");
    let error = cause(load_map(&image, &ReadOptions::default()).unwrap_err());
    assert!(matches!(&error, MapError::NoResolution { yaml: Some(yaml) } if yaml == "map.yaml"), "{error}");
    assert!(error.to_string().contains("read map.yaml"), "{error}");
    fs::remove_file(folder.path().join("map.yaml")).unwrap();
    let error = cause(load_map(&image, &ReadOptions::default()).unwrap_err());
    assert!(matches!(error, MapError::NoResolution { yaml: None }), "{error}");
    let options = ReadOptions { resolution_m: Some(0.05), ..Default::default() };
    assert!(load_map(&image, &options).unwrap().grid.is_free(Cell::new(0, 0)));
}

#[test]
fn bad_yaml_is_one_clear_error_each() {
    let with = |from: &str, to: &str| {
        let error = load_yaml(&YAML.replace(from, to), b"P2 1 1 255 0").unwrap_err();
        (error.to_string(), cause(error))
    };
    let (message, error) = with("resolution: 0.05\n", "");
    assert!(matches!(error, MapError::Yaml { .. }) && message.contains("resolution"), "{message}");
    assert!(message.contains("map.yaml"), "{message}");
    let (message, error) = with("0.65", "high");
    assert!(matches!(error, MapError::Yaml { line: 5, .. }), "{message}");
    assert!(!message.contains('\n'), "{message}");
    assert!(matches!(with("resolution: 0.05", "resolution: 0").1, MapError::Frame(_)));
    assert!(matches!(with("resolution: 0.05", "resolution: -1").1, MapError::Frame(_)));
    assert!(matches!(with("2, 0.5]", "2]").1, MapError::Origin { found: 2 }));
    assert!(matches!(with("2, 0.5]", "2, 0.5, 0]").1, MapError::Origin { found: 4 }));
    assert!(matches!(with("negate: 0", "negate: 0\nmode: binary").1, MapError::Mode { .. }));
    assert!(matches!(with("image: map.pgm", "image: [").1, MapError::Yaml { .. }));
    for bad in [".nan", ".inf", "-.inf"] {
        for key in ["resolution: 0.05", "occupied_thresh: 0.65", "free_thresh: 0.196", "origin: [1, 2, 0.5]"]
        {
            let (name, _) = key.split_once(':').unwrap();
            let value = if name == "origin" { format!("[0, {bad}, 0]") } else { bad.to_owned() };
            assert!(ros::parse_yaml(YAML.replace(key, &format!("{name}: {value}")).as_bytes()).is_err());
        }
    }
    assert!(matches!(ros::parse_yaml(b"").unwrap_err(), MapError::Yaml { .. }));
    assert!(matches!(ros::parse_yaml(b"\xff\xfe\x00").unwrap_err(), MapError::Yaml { .. }));
}

#[test]
fn images_outside_the_folder_need_permission() {
    let image = folder("", b"P2 1 1 255 0");
    fs::rename(image.path().join("map.pgm"), image.path().join("other.pgm")).unwrap();
    let elsewhere = image.path().join("other.pgm");
    for path in [elsewhere.to_str().unwrap(), "../other.pgm", "deeper/../../other.pgm"] {
        let error = cause(load_yaml(&YAML.replace("map.pgm", path), b"P2 1 1 255 0").unwrap_err());
        assert!(matches!(error, MapError::Outside { beside, .. } if beside.is_empty()), "{path}");
    }
    let yaml = folder(&YAML.replace("map.pgm", elsewhere.to_str().unwrap()), b"");
    let options = ReadOptions { named_files: NamedFiles::Anywhere, ..Default::default() };
    assert_eq!(load_map(&yaml.path().join("map.yaml"), &options).unwrap().grid.cells.width(), 1);
}

#[test]
fn the_path_of_another_machine_gives_way_to_the_image_beside() {
    let names = [
        "/home/someone/maps/map.pgm",
        "~/map.pgm",
        "file:///home/someone/map.pgm",
        "package://robot_maps/map.pgm",
        r"C:\maps\map.pgm",
        r"maps\map.pgm",
        "../maps/map.pgm",
    ];
    for named in names {
        let map = load_yaml(&YAML.replace("map.pgm", named), b"P2 1 1 255 254").unwrap();
        assert!(map.grid.is_free(Cell::new(0, 0)), "{named}");
        let found = check(&map).findings;
        let told = found.iter().any(
            |f| matches!(f, Finding::ReplacedImage(image) if image.named == named && image.read == "map.pgm"),
        );
        assert!(told, "{named}: {found:?}");
    }
    // Nothing of that name beside it: what is named is wrong, or not there.
    for named in ["/home/someone/office.pgm", "office.pgm"] {
        let error = load_yaml(&YAML.replace("map.pgm", named), b"P2 1 1 255 254").unwrap_err();
        assert!(error.to_string().contains("office.pgm"), "{error}");
    }
    // What is there, but outside, is not passed over in silence.
    let elsewhere = folder("", b"P2 1 1 255 0");
    let named = elsewhere.path().join("map.pgm");
    let error = load_yaml(&YAML.replace("map.pgm", named.to_str().unwrap()), b"P2 1 1 255 254").unwrap_err();
    assert!(error.to_string().contains("but map.pgm lies there: write the name of the right one"), "{error}");
}

#[test]
fn thresholds_without_room_between_them_are_refused() {
    for (occupied, free) in [("65", "25"), ("0.196", "0.65"), ("0.5", "0.5"), ("0.65", "-1"), ("-3", "0.196")]
    {
        let yaml =
            YAML.replace("0.65", occupied).replace("free_thresh: 0.196", &format!("free_thresh: {free}"));
        for mode in ["trinary", "scale", "raw"] {
            let error = load_yaml(&format!("{yaml}mode: {mode}\n"), b"P2 1 1 255 0").unwrap_err();
            let message = error.to_string();
            assert!(matches!(cause(error), MapError::Thresholds { .. }), "{message}");
            assert!(
                message.contains(&format!("free_thresh {free} must be below occupied_thresh {occupied}")),
                "{message}"
            );
        }
    }
    let options = ReadOptions { free_thresh: Some(0.7), ..Default::default() };
    let error = load_map(&folder(YAML, b"P2 1 1 255 0").path().join("map.yaml"), &options).unwrap_err();
    assert!(matches!(cause(error), MapError::Thresholds { .. }));
}

/// One pixel as the loader of Nav2 on Humble takes it, written from its formulas.
fn humble(rgba: [u8; 4], has_alpha: bool, how: &Interpretation) -> i64 {
    let [r, g, b, a] = rgba.map(f64::from);
    let mean = if has_alpha && how.mode == Mode::Trinary { (r + g + b + a) / 4.0 } else { (r + g + b) / 3.0 };
    let shade = mean / 255.0;
    let occupied = if how.negate { shade } else { 1.0 - shade };
    let graded = (occupied - how.free_thresh) / (how.occupied_thresh - how.free_thresh) * 100.0;
    match how.mode {
        Mode::Raw if (shade * 255.0).round() <= 100.0 => (shade * 255.0).round() as i64,
        Mode::Raw => -1,
        Mode::Scale if has_alpha && a < 255.0 => -1,
        _ if how.occupied_thresh < occupied => 100,
        _ if occupied < how.free_thresh => 0,
        Mode::Trinary => -1,
        Mode::Scale => graded.round_ties_even() as i64,
    }
}

#[test]
fn every_pixel_is_what_nav2_gives_on_humble() {
    let colors = (0..=255u8).flat_map(|v| [[v; 3], [v, v / 2, 255 - v]]);
    let pixels: Vec<[u8; 4]> =
        colors.flat_map(|[r, g, b]| [255, 254, 128, 0].map(|alpha| [r, g, b, alpha])).collect();
    let mut n_not_jazzy = 0;
    for mode in [Mode::Trinary, Mode::Scale, Mode::Raw] {
        for (negate, occupied_thresh, free_thresh) in [
            (false, 0.65, 0.196),
            (true, 0.65, 0.196),
            (false, 0.65, 0.25),
            (false, 0.9, 0.1),
            (true, 1.0, 0.0),
        ] {
            let how = Interpretation { mode, negate, occupied_thresh, free_thresh, rules: Rules::Humble };
            for (channels, has_alpha) in [(Channels::Rgba, true), (Channels::Rgb, false)] {
                let n = if has_alpha { 4 } else { 3 };
                let samples = pixels.iter().flat_map(|pixel| &pixel[..n]).copied().collect();
                let raster = Raster {
                    width: pixels.len() as u32,
                    height: 1,
                    channels,
                    samples: Samples::Eight(samples),
                };
                let jazzy = Interpretation { rules: Rules::Jazzy, ..how };
                let value = |how: &Interpretation| -> Vec<i8> {
                    let measured = ros::brightness(raster.clone(), how);
                    let gray = |sum: u16| f64::from(sum) / f64::from(measured.divisor);
                    measured
                        .cells
                        .values()
                        .iter()
                        .map(|&(sum, a)| ros::cell_value(gray(sum), a, how))
                        .collect()
                };
                for ((pixel, found), jazzy) in pixels.iter().zip(value(&how)).zip(value(&jazzy)) {
                    assert_eq!(i64::from(found), humble(*pixel, has_alpha, &how), "{pixel:?} {how:?}");
                    n_not_jazzy += usize::from(found != jazzy);
                }
            }
        }
    }
    assert!(n_not_jazzy > 1000, "the releases differ: {n_not_jazzy}");
}
