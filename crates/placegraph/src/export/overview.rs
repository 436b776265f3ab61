//! The picture of a result: the map colored by class, the graph over it, title, legend and scale bar.
//!
//! Cells are painted here, everything else is SVG and drawn by `resvg` with an embedded font. Cost: linear in
//! cells, at most 4096 pixels a side for the map.

use std::io::Write as _;

use rayon::prelude::*;
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg;

use super::canvas::{Canvas, Crop, PAPER, Painting};
use super::overlay::{View, overlay_svg};
use super::page::{Layout, Page};
use crate::grid::OccupancyGrid;
use crate::labels::{Label, LabelSet};
use crate::topology::TopologicalMap;

/// The regular and the bold face of [`super::overlay::FONTS`].
const FONT_FILES: [&[u8]; 2] = [
    include_bytes!("../../assets/DejaVuSansCondensed.ttf"),
    include_bytes!("../../assets/DejaVuSansCondensed-Bold.ttf"),
];

/// Rows of pixels that are drawn at a time.
const BAND_PX: u32 = 256;

/// A PNG of the part of `grid` that has places, with `labeling` (of the free cells, row-major) and `topology`.
///
/// # Panics
/// If there is not one label per free cell.
pub fn overview_png(
    grid: &OccupancyGrid,
    labeling: &[Label],
    label_set: &LabelSet,
    topology: &TopologicalMap,
    title: &str,
) -> Vec<u8> {
    in_bands(grid, labeling, label_set, topology, title, BAND_PX)
}

/// [`overview_png`] in bands of this many rows.
fn in_bands(
    grid: &OccupancyGrid,
    labeling: &[Label],
    label_set: &LabelSet,
    topology: &TopologicalMap,
    title: &str,
    band_px: u32,
) -> Vec<u8> {
    assert_eq!(labeling.len(), grid.count(crate::grid::Occupancy::Free), "one label per free cell");
    let crop = Crop::of_places(grid, topology);
    let m_per_px = grid.frame.resolution_m() / crop.px_per_cell;
    let map_px = (crop.width_px(), crop.height_px());
    let page = Page::new(title, topology, labeling, label_set, map_px, m_per_px);
    let Layout { width, height, map, text_px, .. } = page.layout;
    let view = View {
        frame: grid.frame,
        left_cells: crop.left as f64,
        top_cells: (crop.bottom + crop.height) as f64,
        px_per_cell: crop.px_per_cell,
        offset_px: [map.0 as f64, map.1 as f64],
        text_px,
    };
    let svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{}{}</svg>"#,
        overlay_svg(topology, label_set, &view),
        page.svg
    );

    let tree = parse(&svg);
    let painting = Painting::new(grid, labeling, label_set, crop);
    let band = |first: u32| {
        let rows = first..height.min(first.saturating_add(band_px));
        let mut pixmap = blank(width, rows.len() as u32);
        let (offset, rows) = ((map.0 as usize, map.1 as usize), rows.start as usize..rows.end as usize);
        painting.paint(Canvas { rgba: pixmap.data_mut(), stride_px: width as usize, rows, offset });
        resvg::render(&tree, Transform::from_translate(0.0, -(first as f32)), &mut pixmap.as_mut());
        pixmap
    };
    // A few at a time: the page as a whole would take more memory than the map.
    let firsts: Vec<u32> = (0..height).step_by(band_px as usize).collect();
    let bands = firsts
        .chunks(rayon::current_num_threads())
        .flat_map(|firsts| firsts.par_iter().map(|&first| band(first)).collect::<Vec<Pixmap>>());
    encode(width, height, bands)
}

/// A white picture.
#[expect(clippy::expect_used, reason = "all sides are above 0 and bounded")]
pub(super) fn blank(width: u32, height: u32) -> Pixmap {
    let mut pixmap = Pixmap::new(width, height).expect("a picture of a bounded size");
    pixmap.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));
    pixmap
}

/// What `svg` shows, with the embedded fonts.
#[expect(clippy::expect_used, reason = "the text is written here, with everything from outside escaped")]
pub(super) fn parse(svg: &str) -> usvg::Tree {
    let mut options = usvg::Options { font_family: "DejaVu Sans".to_owned(), ..usvg::Options::default() };
    for font in FONT_FILES {
        options.fontdb_mut().load_font_data(font.to_vec());
    }
    usvg::Tree::from_str(svg, &options).expect("well-formed SVG")
}

/// An opaque picture as PNG, from its bands of rows.
pub(super) fn encode(width: u32, height: u32, bands: impl Iterator<Item = Pixmap>) -> Vec<u8> {
    let write = || -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Up);
        let mut header = encoder.write_header()?;
        let mut rows = header.stream_writer()?;
        let mut row = vec![0; width as usize * 3];
        for band in bands {
            for pixels in band.data().chunks_exact(width as usize * 4) {
                for (rgb, rgba) in row.chunks_exact_mut(3).zip(pixels.chunks_exact(4)) {
                    rgb.copy_from_slice(&rgba[..3]);
                }
                rows.write_all(&row)?;
            }
        }
        rows.finish()?;
        header.finish()?;
        Ok(file)
    };
    #[expect(clippy::expect_used, reason = "a vector takes every byte, and the sizes agree")]
    write().expect("a picture in memory")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::FreeSpace;
    use crate::labels::LabelField;
    use crate::regions::{DiagonalSteps, connected};
    use crate::topology;

    /// A picture of 120 x 50 cells in bands of `band_px` rows.
    fn picture(band_px: u32) -> image::RgbImage {
        let row = format!("#{}#", ".".repeat(118));
        let wall = "#".repeat(120);
        let drawing: Vec<&str> = (0..50).map(|y| if y % 49 == 0 { &wall } else { &row }.as_str()).collect();
        let grid = OccupancyGrid::from_ascii(0.1, &drawing.join("\n"));
        let (space, set) = (FreeSpace::of(&grid), LabelSet::default());
        let labels: Vec<Label> = space.graph.cells().iter().map(|cell| Label((cell.x / 50) as u8)).collect();
        let regions = connected(&space.graph, &labels, DiagonalSteps::default());
        let field = LabelField::from_rows(3, [0.5, 0.25, 0.25].repeat(labels.len()));
        let map = topology::build(&space, &field, &regions, &set);
        let png = in_bands(&grid, &labels, &set, &map, "in bands", band_px);
        image::load_from_memory(&png).unwrap().to_rgb8()
    }

    #[test]
    fn bands_are_the_picture_in_one_piece() {
        let whole = picture(u32::MAX);
        assert!(whole.height() > 400);
        for band_px in [64, 37] {
            let banded = picture(band_px);
            assert_eq!(banded.dimensions(), whole.dimensions());
            let differs = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| a != b;
            let differing: Vec<_> = whole.pixels().zip(banded.pixels()).filter(differs).collect();
            // Where a curve is cut, its edge may be rounded another way.
            assert!(differing.len() < whole.pixels().len() / 500, "{} pixels", differing.len());
            let far =
                |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| (0..3).any(|c| a.0[c].abs_diff(b.0[c]) > 64);
            assert_eq!(differing.iter().filter(|pair| far(pair)).count(), 0);
        }
    }
}
