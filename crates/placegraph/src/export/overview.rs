//! The picture of a result: the map colored by class, the graph over it, title, legend and scale bar.
//!
//! Cells are painted here, everything else is SVG and drawn by `resvg` with an embedded font. Cost: linear in
//! cells, at most 4096 pixels a side for the map.

use std::io::Write as _;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg;

use super::canvas::{Canvas, Crop, PAPER, paint};
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

/// A PNG of the part of `grid` that is known, with `labeling` (of the free cells, row-major) and `topology`.
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
    assert_eq!(labeling.len(), grid.count(crate::grid::Occupancy::Free), "one label per free cell");
    let crop = Crop::of_known(grid);
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

    #[expect(clippy::expect_used, reason = "the sides are above 0 and bounded")]
    let mut pixmap = Pixmap::new(width, height).expect("a picture of a bounded size");
    pixmap.fill(Color::from_rgba8(PAPER[0], PAPER[1], PAPER[2], 255));
    let offset = (map.0 as usize, map.1 as usize);
    let canvas = Canvas { rgba: pixmap.data_mut(), stride_px: width as usize, offset };
    paint(grid, labeling, label_set, &crop, canvas);
    draw(&svg, &mut pixmap);
    encode(&pixmap)
}

/// Draws `svg` over `pixmap`.
pub(super) fn draw(svg: &str, pixmap: &mut Pixmap) {
    let mut options = usvg::Options { font_family: "DejaVu Sans".to_owned(), ..usvg::Options::default() };
    for font in FONT_FILES {
        options.fontdb_mut().load_font_data(font.to_vec());
    }
    #[expect(clippy::expect_used, reason = "the text is written here, with everything from outside escaped")]
    let tree = usvg::Tree::from_str(svg, &options).expect("well-formed SVG");
    resvg::render(&tree, Transform::identity(), &mut pixmap.as_mut());
}

/// An opaque picture as PNG.
pub(super) fn encode(pixmap: &Pixmap) -> Vec<u8> {
    let write = || -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, pixmap.width(), pixmap.height());
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Up);
        let mut header = encoder.write_header()?;
        let mut rows = header.stream_writer()?;
        // Row by row: no second picture in memory.
        let mut row = vec![0; pixmap.width() as usize * 3];
        for pixels in pixmap.data().chunks_exact(pixmap.width() as usize * 4) {
            for (rgb, rgba) in row.chunks_exact_mut(3).zip(pixels.chunks_exact(4)) {
                rgb.copy_from_slice(&rgba[..3]);
            }
            rows.write_all(&row)?;
        }
        rows.finish()?;
        header.finish()?;
        Ok(file)
    };
    #[expect(clippy::expect_used, reason = "a vector takes every byte, and the sizes agree")]
    write().expect("a picture in memory")
}
