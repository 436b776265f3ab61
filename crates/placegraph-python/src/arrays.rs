//! Grids as arrays: row 0 of an array is the map's top, row 0 of a grid its bottom.

use numpy::{Element, PyArray1, PyArray2, PyArrayMethods};
use placegraph::grid::{CellGraph, Grid};
use pyo3::prelude::*;

/// `values`, row-major, as an array of `height` rows, without a copy.
pub(crate) fn array2<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    height: usize,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    PyArray1::from_vec(py, values).reshape([height, width])
}

/// The values of `grid` as an array.
pub(crate) fn from_grid<'py, T, U: Element>(
    py: Python<'py>,
    grid: &Grid<T>,
    value: impl Fn(&T) -> U,
) -> PyResult<Bound<'py, PyArray2<U>>> {
    let rows = (0..grid.height()).rev().flat_map(|y| grid.row(y).iter().map(&value));
    array2(py, rows.collect(), grid.height() as usize, grid.width() as usize)
}

/// A value for every free cell, 0 elsewhere, as an array. `value` takes the node's number.
pub(crate) fn from_nodes<'py, T: Element + Clone + Default>(
    py: Python<'py>,
    graph: &CellGraph,
    value: impl Fn(usize) -> T,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let (height, width) = (graph.height() as usize, graph.width() as usize);
    let mut values = vec![T::default(); height * width];
    for (node, cell) in graph.cells_in_rows(0..graph.height()).enumerate() {
        values[(height - 1 - cell.y as usize) * width + cell.x as usize] = value(node);
    }
    array2(py, values, height, width)
}

/// The grid of an array in any memory order.
pub(crate) fn to_grid<T: Element + Copy, U>(
    array: &Bound<'_, PyArray2<T>>,
    value: impl Fn(T) -> U,
) -> PyResult<Grid<U>> {
    let readable = array.try_readonly()?;
    let view = readable.as_array();
    let (height, width) = view.dim();
    let values =
        view.rows().into_iter().rev().flat_map(|row| row.into_iter().map(|&v| value(v)).collect::<Vec<U>>());
    Ok(Grid::from_rows(width as u32, height as u32, values.collect()))
}
