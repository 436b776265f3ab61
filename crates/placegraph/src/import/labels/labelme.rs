//! The JSON of labelme: polygons, rectangles, circles and masks in pixels, y down from the upper left corner.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;

use super::paint::Canvas;
use super::{LabelFileError, LabelTarget, parsed};
use crate::geom::Point2;
use crate::import::image::{self, Samples};
use crate::labels::LabelCell;

const KIND: &str = "the JSON of labelme";

#[derive(Deserialize)]
struct File {
    #[serde(rename = "imageWidth")]
    width: Option<u64>,
    #[serde(rename = "imageHeight")]
    height: Option<u64>,
    shapes: Vec<Shape>,
}

#[derive(Deserialize)]
struct Shape {
    label: String,
    points: Vec<[f64; 2]>,
    #[serde(rename = "shape_type")]
    kind: Option<String>,
    mask: Option<String>,
}

pub(super) fn paint(
    bytes: &[u8],
    target: &LabelTarget<'_>,
    canvas: &mut Canvas,
) -> Result<(), LabelFileError> {
    let File { width, height, shapes } = parsed(bytes, KIND)?;
    if let Some(size) = width.zip(height) {
        target.check_size(size, "labels for an image")?;
    }
    for (shape, number) in shapes.iter().zip(1..) {
        let what = || format!("shape {number}");
        let cell = target.meaning(&shape.label, what)?;
        shape.paint(cell, canvas).map_err(|message| LabelFileError::Shape { what: what(), message })?;
    }
    Ok(())
}

impl Shape {
    fn paint(&self, cell: LabelCell, canvas: &mut Canvas) -> Result<(), String> {
        let kind = self.kind.as_deref().unwrap_or("polygon");
        match (kind, &self.points[..]) {
            ("polygon", points) => {
                canvas.fill(&[points.iter().map(|&point| canvas.at_pixel(point)).collect()], cell);
            }
            // Older versions write two opposite corners, newer ones all four.
            ("rectangle", &[a, b] | &[a, _, b, _]) => {
                let corners = [a, [b[0], a[1]], b, [a[0], b[1]]].map(|point| canvas.at_pixel(point));
                canvas.fill(&[corners.to_vec()], cell);
            }
            ("circle", &[center, edge]) => {
                canvas.fill(&[circle(canvas.at_pixel(center), canvas.at_pixel(edge))], cell);
            }
            ("mask", &[corner, ..]) => self.paint_mask(corner, cell, canvas)?,
            ("rectangle" | "circle" | "mask", points) => {
                return Err(format!("a {kind} cannot have {} points", points.len()));
            }
            (other, _) => {
                return Err(format!(
                    "a shape of the type {other:?} has no cells: use polygons, rectangles, circles and masks"
                ));
            }
        }
        Ok(())
    }

    /// A mask: a picture of the box whose upper left pixel is `corner`.
    fn paint_mask(&self, [x, y]: [f64; 2], cell: LabelCell, canvas: &mut Canvas) -> Result<(), String> {
        let picture = self.mask.as_deref().ok_or("a mask without its picture")?;
        let png = STANDARD.decode(picture).map_err(|error| format!("its mask is not base64: {error}"))?;
        let (width, height) = canvas.size();
        let max_pixels = u64::from(width) * u64::from(height);
        let raster = image::decode(&png, max_pixels).map_err(|error| format!("its mask: {error}"))?;
        let (left, top, columns) = (x as i64, y as i64, raster.width as usize);
        let n_samples = raster.channels.n_samples();
        let Samples::Eight(samples) = &raster.samples else { return Err("its mask has 16 bits".into()) };
        for (index, _) in samples.chunks_exact(n_samples).enumerate().filter(|(_, pixel)| pixel[0] > 0) {
            let (column, row) = ((index % columns) as i64, (index / columns) as i64);
            canvas.set_from_top(left.saturating_add(column), top.saturating_add(row), cell);
        }
        Ok(())
    }
}

/// A circle as a polygon of so many corners that no cell of a map notices.
fn circle(center: Point2, edge: Point2) -> Vec<Point2> {
    const N: u32 = 720;
    let radius = center.distance(edge);
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(N)).sin_cos();
        Point2::new(center.x + radius * cos, center.y + radius * sin)
    };
    (0..N).map(corner).collect()
}
