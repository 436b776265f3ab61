//! Plain twins of stages and yardsticks from other crates, for `stages.rs`.

use std::collections::HashMap;

use image::GrayImage;
use imageproc::contours::find_contours;
use imageproc::distance_transform::euclidean_squared_distance_transform;
use petgraph::algo::dijkstra;
use petgraph::graph::{NodeIndex, UnGraph};
use placegraph::grid::{Cell, CellGraph, Connectivity, Grid, Occupancy};
use placegraph::regions::RegionMap;

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

/// The squared clearance of all cells, by `imageproc`: what doorways are looked for on.
pub(crate) fn clearance(labels: &GrayImage) -> f64 {
    let walls = GrayImage::from_fn(labels.width(), labels.height(), |x, y| {
        image::Luma([u8::from(labels.get_pixel(x, y).0[0] == 0)])
    });
    euclidean_squared_distance_transform(&walls).iter().sum()
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

/// A gray PNG as encoders write it unless told otherwise: with the best filter of every row.
pub(crate) fn filtered_png(labels: &GrayImage) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, labels.width(), labels.height());
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_filter(png::Filter::Adaptive);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(labels.as_raw()));
    assert!(written.is_ok());
    file
}
