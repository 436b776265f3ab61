//! Labels in the formats of labeling tools, to be corrected there and read back ([`crate::import::read_label_file`]).
//!
//! Shapes follow the sides of the cells, so what is read back has the same cell for cell. Cost: a few passes.

use geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject};
use serde_json::{Value, json};

use super::ExportError;
use super::geojson::{collection_bytes, polygon, position};
use crate::geom::{Point2, Pose2};
use crate::grid::{Cell, CellGraph, DiagonalSteps, FreeSpace, Grid, MapFrame, Occupancy, OccupancyGrid};
use crate::labels::{Label, LabelCell, LabelSet};
use crate::regions::connected;
use crate::topology::{PolygonWithHoles, outlines};

/// Labels of a map, and the image that labeling tools show below them.
#[derive(Clone, Copy, Debug)]
pub struct LabelSheet<'a> {
    /// The label of every cell.
    pub cells: &'a Grid<LabelCell>,
    /// The map.
    pub map: &'a OccupancyGrid,
    /// The classes.
    pub classes: &'a LabelSet,
    /// The image of the map, as a path from the label file.
    pub image: &'a str,
}

/// A connected part of cells with the same label, in cells from the lower left corner.
struct Part {
    cell: LabelCell,
    n_cells: usize,
    has_free_cells: bool,
    outline: PolygonWithHoles,
}

impl LabelSheet<'_> {
    /// An image with a palette: pixel `k` is class `k` from 1 in its color, 0 is not labeled (black), 255 is ignored (white).
    ///
    /// # Errors
    /// None for maps that were read.
    pub fn png(&self) -> Result<Vec<u8>, ExportError> {
        let mut palette = vec![0; 3 * 256];
        palette[3 * 255..].fill(255);
        for (class, color) in self.classes.classes().iter().zip(palette[3..].chunks_exact_mut(3)) {
            color.copy_from_slice(&class.color);
        }
        let value = |cell: &LabelCell| match cell {
            LabelCell::None => 0,
            LabelCell::Class(label) => label.0 + 1,
            LabelCell::Ignore => 255,
        };
        let (width, height) = self.size();
        let rows = self.cells.values().chunks_exact(width as usize).rev();
        let pixels: Vec<u8> = rows.flatten().map(value).collect();
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
        written.map_err(|error| ExportError::writer("PNG", &error))?;
        Ok(file)
    }

    /// The JSON of labelme: a polygon for every connected part, larger ones first, because polygons of labelme have no holes and later
    /// shapes cover earlier ones.
    ///
    /// # Errors
    /// None for maps that were read.
    pub fn labelme(&self) -> Result<Vec<u8>, ExportError> {
        let mut parts = self.parts();
        let area = |part: &Part| ring_area(&part.outline.exterior);
        parts.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let mut covered = Vec::new();
        let mut shapes = Vec::new();
        for part in &parts {
            let exterior = &part.outline.exterior;
            let lies_in_a_hole = covered.iter().any(|hole: &&Vec<Point2>| contains(hole, exterior));
            // What has no label is told only where another shape would cover it.
            if part.cell != LabelCell::None || part.has_free_cells && lies_in_a_hole {
                shapes.push(json!({
                    "label": self.name(part.cell),
                    "points": self.on_image(exterior),
                    "group_id": null,
                    "description": "",
                    "shape_type": "polygon",
                    "flags": {},
                    "mask": null,
                }));
                covered.extend(&part.outline.holes);
            }
        }
        bytes_of(&json!({
            "version": "5.0.1",
            "flags": {},
            "shapes": shapes,
            "imagePath": self.image,
            "imageData": null,
            "imageHeight": self.size().1,
            "imageWidth": self.size().0,
        }))
    }

    /// COCO annotations: polygons, and run-length masks for parts with holes.
    ///
    /// # Errors
    /// None for maps that were read.
    pub fn coco(&self) -> Result<Vec<u8>, ExportError> {
        let mut names: Vec<String> = self.classes.classes().iter().map(|class| class.name.clone()).collect();
        let parts: Vec<Part> = self.parts().into_iter().filter(|part| part.cell != LabelCell::None).collect();
        if parts.iter().any(|part| part.cell == LabelCell::Ignore) {
            names.push(self.name(LabelCell::Ignore));
        }
        let annotations = parts.iter().zip(1..).map(|(part, id)| {
            let name = self.name(part.cell);
            let category = names.iter().position(|known| *known == name).map_or(0, |at| at + 1);
            let has_holes = !part.outline.holes.is_empty();
            let points = self.on_image(&part.outline.exterior);
            let segmentation = if has_holes {
                json!({ "size": [self.size().1, self.size().0], "counts": self.runs(&part.outline) })
            } else {
                json!([points.as_flattened()])
            };
            let side = |axis: usize| {
                let values = points.iter().map(|point| point[axis]);
                let low = values.clone().fold(f64::INFINITY, f64::min);
                (low, values.fold(f64::NEG_INFINITY, f64::max) - low)
            };
            let ((x, width), (y, height)) = (side(0), side(1));
            json!({
                "id": id,
                "image_id": 1,
                "category_id": category,
                "segmentation": segmentation,
                "area": part.n_cells,
                "bbox": [x, y, width, height],
                "iscrowd": u8::from(has_holes),
            })
        });
        let annotations: Vec<Value> = annotations.collect();
        let categories = names.iter().zip(1..).map(|(name, id)| json!({ "id": id, "name": name }));
        bytes_of(&json!({
            "images": [{
                "id": 1,
                "width": self.size().0,
                "height": self.size().1,
                "file_name": self.image,
            }],
            "categories": categories.collect::<Vec<_>>(),
            "annotations": annotations,
        }))
    }

    /// GeoJSON polygons in meters of the map frame, with the property `class`.
    ///
    /// # Errors
    /// None for maps that were read.
    pub fn geojson(&self) -> Result<Vec<u8>, ExportError> {
        let parts = self.parts().into_iter().filter(|part| part.cell != LabelCell::None);
        let feature = |part: Part| {
            let in_map =
                |ring: &Vec<Point2>| ring.iter().map(|&p| self.map.frame.map_from_cells(p)).collect();
            let PolygonWithHoles { exterior, holes } = &part.outline;
            let outline =
                PolygonWithHoles { exterior: in_map(exterior), holes: holes.iter().map(in_map).collect() };
            let mut properties = JsonObject::new();
            properties.insert("class".to_owned(), json!(self.name(part.cell)));
            Feature {
                geometry: Some(Geometry::new(GeometryValue::Polygon {
                    coordinates: polygon(&outline, &position),
                })),
                properties: Some(properties),
                ..Feature::default()
            }
        };
        collection_bytes(FeatureCollection::new(parts.map(feature).collect::<Vec<_>>()), "labels")
    }

    /// Width and height of the map, in cells.
    fn size(&self) -> (u32, u32) {
        (self.cells.width(), self.cells.height())
    }

    /// The connected parts of cells with one label, also of those without.
    fn parts(&self) -> Vec<Part> {
        let n_classes = self.classes.len() as u8;
        let number = |cell: LabelCell| match cell {
            LabelCell::Class(label) => label,
            LabelCell::None => Label(n_classes),
            LabelCell::Ignore => Label(n_classes + 1),
        };
        // All cells, in a frame of cells: corners are whole numbers.
        let every = self.cells.map(|_| Occupancy::Free);
        let labels: Vec<Label> = self.cells.values().iter().map(|&cell| number(cell)).collect();
        let Ok(frame) = MapFrame::new(1.0, Pose2::default()) else { return Vec::new() };
        let space = FreeSpace { frame, graph: CellGraph::new(&every) };
        let regions = connected(&space.graph, &labels, DiagonalSteps::Never);
        let outlines = outlines(&space, &regions);
        let cell = |label: Label| match label.0.checked_sub(n_classes) {
            None => LabelCell::Class(label),
            Some(0) => LabelCell::None,
            Some(_) => LabelCell::Ignore,
        };
        let mut has_free_cells = vec![false; regions.regions.len()];
        for (region, &occupancy) in regions.region_of.iter().zip(self.map.cells.values()) {
            has_free_cells[region.index()] |= occupancy == Occupancy::Free;
        }
        let mut parts = Vec::new();
        for ((region, has_free_cells), outline) in regions.regions.iter().zip(has_free_cells).zip(outlines) {
            let (cell, n_cells) = (cell(region.label), region.n_cells as usize);
            parts.extend(outline.into_iter().map(|outline| Part { cell, n_cells, has_free_cells, outline }));
        }
        parts
    }

    fn name(&self, cell: LabelCell) -> String {
        match cell {
            LabelCell::None => "none".to_owned(),
            LabelCell::Class(label) => self.classes.class(label).name.clone(),
            LabelCell::Ignore => "ignore".to_owned(),
        }
    }

    /// Corners in pixels from the upper left corner of the image.
    fn on_image(&self, ring: &[Point2]) -> Vec<[f64; 2]> {
        ring.iter().map(|point| [point.x, f64::from(self.size().1) - point.y]).collect()
    }

    /// The runs of pixels outside and inside of an outline, column by column from the left, each from the top.
    fn runs(&self, outline: &PolygonWithHoles) -> Vec<u64> {
        let (width, height) = self.size();
        // Where a column changes: on the lower or upper side of a cell, from the left to the right end of a side.
        let mut turns: Grid<bool> = Grid::filled(width, height + 1, false);
        for ring in outline.rings() {
            for (index, from) in ring.iter().enumerate() {
                let to = ring[(index + 1) % ring.len()];
                let (left, right) = (from.x.min(to.x) as u32, from.x.max(to.x) as u32);
                for x in left..right {
                    turns[Cell::new(x, from.y as u32)] ^= true;
                }
            }
        }
        let mut runs = vec![0];
        let mut is_inside = false;
        for x in 0..width {
            for y in (0..height).rev() {
                let is_here = is_inside ^ turns[Cell::new(x, y + 1)];
                if is_here != is_inside {
                    runs.push(0);
                }
                is_inside = is_here;
                if let Some(run) = runs.last_mut() {
                    *run += 1;
                }
            }
            // Below the map nothing is inside.
            if is_inside {
                is_inside = false;
                runs.push(0);
            }
        }
        runs
    }
}

fn bytes_of(value: &Value) -> Result<Vec<u8>, ExportError> {
    let mut bytes = serde_json::to_vec_pretty(value).map_err(|error| ExportError::writer("JSON", &error))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The area within a ring, positive counter-clockwise.
fn ring_area(ring: &[Point2]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum::<f64>()
}

/// Whether `hole` surrounds the cell at the first corner of `exterior`, which begins at the lower left of its lowest cell.
fn contains(hole: &[Point2], exterior: &[Point2]) -> bool {
    let Some(first) = exterior.first() else { return false };
    let center = Point2::new(first.x + 0.5, first.y + 0.5);
    let mut is_inside = false;
    for (index, from) in hole.iter().enumerate() {
        let to = hole[(index + 1) % hole.len()];
        is_inside ^= from.x > center.x && (from.y > center.y) != (to.y > center.y);
    }
    is_inside
}
