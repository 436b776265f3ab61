//! Set B: measures of the polygon of the beams' end points (appendix B of the book), in polar form.
//!
//! Neighboring beams enclose the same angle, so products of their lengths replace differences of coordinates
//! and nothing cancels: x_i y_{i+1} − x_{i+1} y_i = d_i d_{i+1} sin 1°, and the squared length of an edge is
//! (d_i − d_{i+1})² + d_i d_{i+1} (2 sin ½°)².

use std::f32::consts::PI;

use super::families::Measure as M;
use super::values::Values;
use crate::scan::lanes::{Lanes, Singles, TINY, ZERO, beams, mean_and_sd};
use crate::scan::{N_BEAMS, Ranges, beam_direction};

/// A polygon with less area (m²) or perimeter (m) is a point: all of set B is 0.
const DEGENERATE: f32 = 1e-9;

/// Sine and cosine of beams, once around and the first again.
pub(super) struct Directions {
    pub(super) cos: [f32; N_BEAMS + 1],
    pub(super) sin: [f32; N_BEAMS + 1],
}

impl Directions {
    pub(super) fn new() -> Self {
        Self {
            cos: std::array::from_fn(|beam| beam_direction(beam).x as f32),
            sin: std::array::from_fn(|beam| beam_direction(beam).y as f32),
        }
    }
}

/// Area and perimeter, which the other measures need.
pub(super) struct Outline<'a> {
    pub(super) area: Singles,
    pub(super) perimeter: Singles,
    /// Length of the edge from vertex i to i + 1.
    pub(super) edges: &'a [Singles; N_BEAMS],
}

impl<'a> Outline<'a> {
    /// `edges` is where their lengths are stored.
    #[inline(always)]
    pub(super) fn new(d: &Ranges, edges: &'a mut [Singles; N_BEAMS]) -> Self {
        let [sector, chord] = [sin_deg(1.0), 4.0 * sin_deg(0.5) * sin_deg(0.5)];
        let (mut areas, mut lengths) = ([ZERO; 4], [ZERO; 4]);
        for start in beams(N_BEAMS, 4) {
            for (part, i) in (start..start + 4).enumerate() {
                let (difference, product) = (d[i] - d[i + 1], d[i] * d[i + 1]);
                edges[i] = (difference * difference + product * chord).sqrt();
                areas[part] += product;
                lengths[part] += edges[i];
            }
        }
        let area = (areas[0] + areas[1]) + (areas[2] + areas[3]);
        let perimeter = (lengths[0] + lengths[1]) + (lengths[2] + lengths[3]);
        Self { area: area * (0.5 * sector), perimeter, edges }
    }

    /// `value`, or 0 where the polygon is a point.
    #[inline(always)]
    pub(super) fn or_zero(&self, value: Singles) -> Singles {
        let size = self.area.min(self.perimeter);
        value.zip(size, |value, size| if size <= DEGENERATE { 0.0 } else { value })
    }
}

fn sin_deg(degrees: f64) -> f32 {
    degrees.to_radians().sin() as f32
}

/// B1, B2, B3, B13, B14 and B15.
#[inline(always)]
pub(super) fn areas(outline: &Outline<'_>, values: &mut Values) {
    let (area, perimeter) = (outline.area, outline.perimeter);
    let mut set = |measure, value| values.set(measure, outline.or_zero(value));
    set(M::Area, area);
    set(M::Perimeter, perimeter);
    set(M::AreaOverPerimeter, area / perimeter);
    set(M::FormFactor, area * (4.0 * PI) / perimeter.sqrt());
    set(M::Circularity, perimeter * perimeter / area);
    set(M::NormalizedCircularity, area * (4.0 * PI) / (perimeter * perimeter));
}

/// B4, B5, B16 and B17; `radii` is where the radii are stored.
#[inline(always)]
pub(super) fn radii(
    d: &Ranges,
    directions: &Directions,
    outline: &Outline<'_>,
    radii: &mut [Singles; N_BEAMS],
    values: &mut Values,
) {
    let Directions { cos, sin } = directions;
    // The centroid: triangles from the robot, each weighted by its area.
    let sector = sin_deg(1.0);
    let weight = outline.area.map(|area| sector / (6.0 * area).max(TINY));
    let [mut centroid_x, mut centroid_y] = [Lanes::all(0.0); 2];
    for i in beams(N_BEAMS, 1) {
        let sector = d[i] * d[i + 1];
        centroid_x += (d[i] * cos[i] + d[i + 1] * cos[i + 1]) * sector;
        centroid_y += (d[i] * sin[i] + d[i + 1] * sin[i + 1]) * sector;
    }
    (centroid_x, centroid_y) = (centroid_x * weight, centroid_y * weight);
    let mut largest = Lanes::all(TINY);
    for i in beams(N_BEAMS, 1) {
        let (x, y) = (d[i] * cos[i] - centroid_x, d[i] * sin[i] - centroid_y);
        radii[i] = (x * x + y * y).sqrt();
        largest = largest.max(radii[i]);
    }
    let (mean, sd) = mean_and_sd(
        N_BEAMS,
        #[inline(always)]
        |i| radii[i],
    );
    let mut set = |measure, value| values.set(measure, outline.or_zero(value));
    set(M::MeanRadius, mean);
    set(M::SdRadius, sd);
    set(M::MeanNormalizedRadius, mean / largest);
    set(M::SdNormalizedRadius, sd / largest);
}
