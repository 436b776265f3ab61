//! Images of all kinds, good and bad.

use std::fs;

use crate::import_ros::{YAML, cause, folder, load_yaml};
use placegraph::grid::Occupancy;
use placegraph::import::image::{Channels, Raster, Samples};
use placegraph::import::ros::{self, Interpretation};
use placegraph::import::{Format, MapError, ReadOptions, load_map, read_image};

#[test]
fn images_of_all_pixel_types_read_alike() {
    // Black, gray 205, near white: occupied, unknown, free.
    let expected = [Occupancy::Occupied, Occupancy::Unknown, Occupancy::Free];
    let gray = [0u8, 205, 254];
    let wide = gray.map(|v| u16::from(v) * 257);
    let spread = |n: usize, alpha: bool| -> Vec<u8> {
        let pixel = |v: u8| (0..n).map(move |k| if alpha && k + 1 == n { 255 } else { v });
        gray.into_iter().flat_map(pixel).collect()
    };
    let eight = [
        (Channels::Gray, spread(1, false)),
        (Channels::GrayAlpha, spread(2, true)),
        (Channels::Rgb, spread(3, false)),
        (Channels::Rgba, spread(4, true)),
    ];
    let mut rasters: Vec<(Channels, Samples)> =
        eight.into_iter().map(|(channels, samples)| (channels, Samples::Eight(samples))).collect();
    rasters.push((Channels::Gray, Samples::Sixteen(wide.to_vec())));
    for (channels, samples) in rasters {
        let raster = Raster { width: 3, height: 1, channels, samples };
        let (cells, source) =
            read_image(raster, Format::Image, Interpretation::default(), &ReadOptions::default());
        assert_eq!(cells.values(), expected, "{channels:?}");
        assert_eq!(source.transparent_cells, 0);
    }
}

#[test]
fn encoded_images_decode_to_the_same_gray_values() {
    let decode = |bytes: &[u8]| ros_gray(placegraph::import::image::decode(bytes, 100).unwrap());
    assert_eq!(decode(b"P2 3 1 100\n0 50 100"), [0, 128, 255]);
    assert_eq!(decode(b"P5 3 1 255\n\x00\xcd\xfe"), [0, 205, 254]);
    assert_eq!(decode(b"P5 2 1 65535\n\x00\x00\xcd\xcd"), [0, 205]);
    assert_eq!(decode(b"P1 3 1\n0 1 0"), [255, 0, 255]);
    assert_eq!(decode(b"P4 3 1\n\x40"), [255, 0, 255]);
    assert_eq!(decode(b"P3 1 1 255\n10 10 10"), [10]);
}

fn ros_gray(raster: Raster) -> Vec<u8> {
    let measured = ros::brightness(raster, &Interpretation::default());
    measured.cells.values().iter().map(|&(gray, _)| gray as u8).collect()
}

#[test]
fn png_palettes_and_single_bits_are_expanded() {
    let png = |color, depth, palette: Option<Vec<u8>>, data: &[u8], width| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        file
    };
    let gray = |bytes: &[u8]| ros_gray(placegraph::import::image::decode(bytes, 100).unwrap());
    let palette = vec![205, 205, 205, 0, 0, 0, 254, 254, 254];
    let indexed = png(png::ColorType::Indexed, png::BitDepth::Two, Some(palette), &[0b0001_1000], 3);
    assert_eq!(gray(&indexed), [205, 0, 254]);
    let bits = png(png::ColorType::Grayscale, png::BitDepth::One, None, &[0b0100_0000], 2);
    assert_eq!(gray(&bits), [0, 255]);
}

#[test]
fn bad_images_are_one_clear_error_each() {
    let error = |image: &[u8]| cause(load_yaml(YAML, image).unwrap_err());
    assert!(matches!(error(b"this is no image\n"), MapError::ImageFormat { found: "text" }));
    assert!(matches!(error(b""), MapError::ImageFormat { found: "an empty file" }));
    assert!(matches!(error(b"\xff\xd8\xff\xe0 jpeg"), MapError::ImageFormat { .. }));
    assert!(matches!(error(b"P5 10 10 255\nshort"), MapError::ImageData { .. }));
    assert!(matches!(error(b"P5 4000000 4000000 255\n"), MapError::TooManyCells { .. }));
    assert!(matches!(error(b"P2 0 5 255\n"), MapError::Empty { width: 0, height: 5 }));
    assert!(matches!(error(b"\x89PNG\r\n\x1a\n rest"), MapError::ImageData { .. }));
    let palette = include_bytes!("../corpus/map_image/palette_cut_off.png");
    // Gray 205 would be the maximum, white, and free.
    for image in
        [&b"P5 2 1 100\n\x64\xcd"[..], b"P2 2 1 100\n100 205", b"P5 1 1 1000\n\x03\xe9", b"P3 1 1 9\n9 9 10"]
    {
        assert!(error(image).to_string().contains("above its maximum"), "{}", error(image));
    }
    for image in
        [&b"P5 2 1 100\n\x64\x00"[..], b"P2 2 1 100\n100 0", b"P5 1 1 1000\n\x03\xe8", b"P1 2 1\n0 1"]
    {
        assert!(load_yaml(YAML, image).is_ok(), "{image:?}");
    }
    assert!(error(palette).to_string().contains("a palette of 137 bytes"), "{}", error(palette));

    let folder = folder(YAML, b"P2 1 1 255 0");
    fs::remove_file(folder.path().join("map.pgm")).unwrap();
    let missing = load_map(&folder.path().join("map.yaml"), &ReadOptions::default()).unwrap_err();
    let message = missing.to_string();
    assert!(message.contains("map.pgm") && message.contains("map.yaml"), "{message}");
    assert!(matches!(cause(missing), MapError::Io { .. }));
    assert!(load_map(folder.path(), &ReadOptions::default()).is_err());
}

#[test]
fn images_of_other_kinds_are_named_and_what_to_do_is_told() {
    for (begin, told) in [
        (&b"\xff\xd8\xff\xe0"[..], "JPEG, which blurs gray values: save the original as PNG"),
        (b"GIF89a", "GIF: convert it to PNG"),
        (b"II*\0", "TIFF: convert it to PNG"),
        (b"RIFF\x10\0\0\0WEBPVP8 ", "WebP: convert it to PNG"),
        (b"\0\0\x01\0", "another image format: convert it to PNG"),
    ] {
        let error = placegraph::import::image::decode(begin, 100).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn a_bmp_is_read_like_the_png_of_its_pixels() {
    let gray = [[0u8, 205, 254], [254, 254, 0]];
    let expected = [
        Occupancy::Free,
        Occupancy::Free,
        Occupancy::Occupied,
        Occupancy::Occupied,
        Occupancy::Unknown,
        Occupancy::Free,
    ];
    let mut files: Vec<(&str, Vec<u8>)> = Vec::new();
    // 8 bits with a gray palette, as map_saver writes it: rows from the bottom, each filled up to four bytes.
    let mut palette = bmp_header(3, 2, 8, 54 + 1024, 1024);
    palette.extend((0..=255u8).flat_map(|v| [v, v, v, 0]));
    palette.extend(gray.iter().rev().flat_map(|row| row.iter().chain(&[0])));
    files.push(("8 bits", palette));
    // 24 bits, rows from the top.
    let mut colors = bmp_header(3, -2, 24, 54, 0);
    colors.extend(gray.iter().flat_map(|row| row.iter().chain(&[0]).flat_map(|&v| [v; 3])));
    files.push(("24 bits", colors));
    for (name, bytes) in files {
        let map = load_yaml(YAML, &bytes).unwrap();
        assert_eq!(map.grid.cells.values(), expected, "{name}");
        for n in 0..bytes.len() - 6 {
            assert!(load_yaml(YAML, &bytes[..n]).is_err(), "{name} cut off at {n}");
        }
    }
    let huge = bmp_header(30_000, 30_000, 8, 1078, 1024);
    assert!(matches!(
        cause(load_yaml(YAML, &huge).unwrap_err()),
        MapError::TooManyCells { .. } | MapError::ImageData { .. }
    ));
}

/// Header of a BMP file with `n_palette` bytes of palette and pixels from byte `offset` on.
fn bmp_header(width: i32, height: i32, bits: u16, offset: u32, n_palette: u32) -> Vec<u8> {
    let mut header = b"BM".to_vec();
    header.extend([0u32, 0, offset, 40].map(u32::to_le_bytes).as_flattened());
    header.extend([width, height].map(i32::to_le_bytes).as_flattened());
    header.extend([1, bits].map(u16::to_le_bytes).as_flattened());
    header.extend([0u32, 0, 3780, 3780, n_palette / 4, 0].map(u32::to_le_bytes).as_flattened());
    header
}
