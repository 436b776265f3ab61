//! Plain twins of stages and yardsticks from other crates, for `stages.rs`.

use std::collections::HashMap;
use std::fmt::Write as _;

use image::GrayImage;
use imageproc::contours::find_contours;
use imageproc::distance_transform::euclidean_squared_distance_transform;
use petgraph::algo::dijkstra;
use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use placegraph::grid::{Cell, CellGraph, Connectivity, Grid, Occupancy};
use placegraph::labels::LabelSet;
use placegraph::regions::RegionMap;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg;

/// The number of every free cell, as one would keep it at first.
pub(crate) fn numbered(cells: &Grid<Occupancy>) -> HashMap<Cell, usize> {
    let free = cells.cells().filter(|&cell| cells[cell] == Occupancy::Free);
    free.enumerate().map(|(node, cell)| (cell, node)).collect()
}

/// Number, centroid and second central moments of every region's cells, cell by cell, in two passes.
pub(crate) fn statistics(graph: &CellGraph, regions: &RegionMap) -> Vec<[f64; 6]> {
    let mut found = vec![[0.0; 6]; regions.regions.len()];
    for (cell, region) in graph.cells().iter().zip(&regions.region_of) {
        let [n, x, y, ..] = &mut found[region.index()];
        *n += 1.0;
        *x += f64::from(cell.x);
        *y += f64::from(cell.y);
    }
    for [n, x, y, ..] in &mut found {
        *x /= *n;
        *y /= *n;
    }
    for (cell, region) in graph.cells().iter().zip(&regions.region_of) {
        let [n, x, y, xx, xy, yy] = &mut found[region.index()];
        let (dx, dy) = (f64::from(cell.x) - *x, f64::from(cell.y) - *y);
        *xx += dx * dx / *n;
        *xy += dx * dy / *n;
        *yy += dy * dy / *n;
    }
    found
}

/// The contours of the cells of every class, by `imageproc`.
pub(crate) fn contours(labels: &GrayImage, n_classes: u8) -> usize {
    let of_class = |class: u8| {
        let mask = GrayImage::from_fn(labels.width(), labels.height(), |x, y| {
            image::Luma([u8::from(labels.get_pixel(x, y).0[0] == class + 1) * 255])
        });
        find_contours::<u32>(&mask).len()
    };
    (0..n_classes).map(of_class).sum()
}

/// The cells as a graph of `petgraph`, with lengths in cells.
pub(crate) fn cells_as_graph(graph: &CellGraph) -> UnGraph<(), f32> {
    let forward = [(1, 0), (0, 1), (1, 1), (-1, 1)];
    assert!(forward.iter().all(|step| Connectivity::Eight.steps().contains(step)));
    let edges = (0..graph.n_nodes()).flat_map(|node| {
        forward.into_iter().filter_map(move |step| {
            let next = graph.node_at_step(node, step)?;
            let length = if step.0 != 0 && step.1 != 0 { std::f32::consts::SQRT_2 } else { 1.0 };
            Some((node as u32, next as u32, length))
        })
    });
    UnGraph::from_edges(edges)
}

/// How many cells the shortest ways from the first one reach: the search of routes visits each cell once too.
pub(crate) fn shortest_ways(cells: &UnGraph<(), f32>) -> usize {
    dijkstra(cells, NodeIndex::new(0), None, |edge| *edge.weight()).len()
}

/// A gray PNG with zlib's usual effort instead of one pass.
pub(crate) fn deflated_png(labels: &GrayImage) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, labels.width(), labels.height());
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(labels.as_raw()));
    assert!(written.is_ok());
    file
}

/// The overview with everything in it as SVG, a rectangle for every run of cells that look alike, drawn in one piece.
pub(crate) fn drawn_as_svg(labels: &GrayImage, set: &LabelSet, overlay: &str, px_per_cell: u32) -> Vec<u8> {
    let (width, height) = (labels.width() * px_per_cell, labels.height() * px_per_cell);
    let mut svg = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">"#);
    for (y, row) in (0..).step_by(px_per_cell as usize).zip(labels.rows()) {
        let values: Vec<u8> = row.map(|pixel| pixel.0[0]).collect();
        let mut x = 0;
        for run in values.chunk_by(|a, b| a == b) {
            let run_px = run.len() * px_per_cell as usize;
            let [red, green, blue] = match run[0] {
                0 => [52, 58, 70],
                label => set.classes()[usize::from(label) - 1].color,
            };
            // Writing to a string cannot fail.
            let _ = write!(
                svg,
                r#"<rect x="{x}" y="{y}" width="{run_px}" height="{px_per_cell}" fill="rgb({red},{green},{blue})"/>"#
            );
            x += run_px;
        }
    }
    svg += overlay;
    svg += "</svg>";
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default());
    let picture = tree.ok().zip(Pixmap::new(width, height)).map(|(tree, mut pixmap)| {
        resvg::render(&tree, Transform::identity(), &mut pixmap.as_mut());
        pixmap.encode_png()
    });
    let Some(Ok(file)) = picture else { unreachable!("the SVG is written here") };
    file
}

/// Where spaces meet: cells from the widest down, in sets that grow together, as `petgraph` keeps them. Of the doorways'
/// work, this is how saddles are looked for at first.
pub(crate) fn flooded(labels: &GrayImage) -> usize {
    let walls = GrayImage::from_fn(labels.width(), labels.height(), |x, y| {
        image::Luma([u8::from(labels.get_pixel(x, y).0[0] == 0)])
    });
    let clearance = euclidean_squared_distance_transform(&walls);
    let width = labels.width() as usize;
    let squared = clearance.as_raw();
    let mut order: Vec<usize> = (0..squared.len()).filter(|&pixel| squared[pixel] > 0.0).collect();
    order.sort_by(|&a, &b| squared[b].total_cmp(&squared[a]));
    let mut sets = UnionFind::<usize>::new(squared.len());
    let mut is_flooded = vec![false; squared.len()];
    let mut n_saddles = 0;
    for pixel in order {
        is_flooded[pixel] = true;
        let mut n_joined = 0;
        for beside in [width + 1, width, width - 1, 1] {
            for other in [pixel.checked_sub(beside), pixel.checked_add(beside)].into_iter().flatten() {
                let is_joined = is_flooded.get(other) == Some(&true) && sets.union(pixel, other);
                n_joined += usize::from(is_joined);
            }
        }
        n_saddles += usize::from(n_joined > 1);
    }
    n_saddles
}
