//! Class probabilities as a NumPy array file.

use crate::grid::CellGraph;
use crate::labels::LabelField;

/// The probability of every class in every cell: a NumPy `.npy` file (format 1.0) with an array
/// `[class, row, column]` of little-endian `float32`.
///
/// Row 0 is the *top* row, as in the label image, so `array.argmax(0) + 1` is that image where cells are free.
/// Cells that are not free have 0 in every class. Cost: one pass, 4 bytes a class and cell.
///
/// # Panics
/// If `field` has not one row per node.
pub fn probability_npy(graph: &CellGraph, field: &LabelField) -> Vec<u8> {
    assert_eq!(field.n_nodes(), graph.n_nodes(), "one distribution per node");
    let (n_labels, height, width) = (field.n_labels(), graph.height() as usize, graph.width() as usize);
    let mut file = npy_header(&format!("({n_labels}, {height}, {width})"));
    let start = file.len();
    file.resize(start + n_labels * height * width * size_of::<f32>(), 0);
    let (values, _) = file[start..].as_chunks_mut::<4>();
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        let pixel = (height - 1 - cell.y as usize) * width + cell.x as usize;
        for (k, p) in field.row(node).iter().enumerate() {
            values[k * height * width + pixel] = p.to_le_bytes();
        }
    }
    file
}

/// Magic, version, and the dictionary padded with spaces so that the data begin at a multiple of 64 bytes.
fn npy_header(shape: &str) -> Vec<u8> {
    const PREFIX: usize = 10;
    let mut dictionary = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    let size = (PREFIX + dictionary.len() + 1).next_multiple_of(64) - PREFIX;
    dictionary = format!("{dictionary:<width$}\n", width = size - 1);
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((size as u16).to_le_bytes());
    header.extend(dictionary.bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::OccupancyGrid;

    #[test]
    fn classes_then_rows_from_the_top() {
        let map = OccupancyGrid::from_ascii(
            1.0,
            "
            .#
            #.
            ",
        );
        let graph = CellGraph::new(&map.cells);
        // Node 0 is the lower right cell, node 1 the upper left one.
        let file = probability_npy(&graph, &LabelField::from_rows(2, vec![0.25, 0.75, 1.0, 0.0]));
        assert_eq!(&file[..8], b"\x93NUMPY\x01\x00");
        let start = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!((start % 64, file[start - 1]), (0, b'\n'));
        let header = std::str::from_utf8(&file[10..start]).unwrap();
        assert_eq!(header.trim_end(), "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2), }");
        let values: Vec<f32> =
            file[start..].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b)).collect();
        assert_eq!(values, [1.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.75]);
    }
}
