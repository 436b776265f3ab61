//! B10, B11 and B12: moments of the 360 vertices about their mean.
//!
//! In `f64`: third moments of a symmetric room cancel to 0, and a logarithmic scale shows every digit that is
//! lost.
//!
//! **Deviations.** η_pq = μ_pq / n^(p+q+2) as in the author's program, so B10 is not scale invariant. Its
//! values reach 1e-38 for ordinary rooms and less for symmetric ones, beyond the range of `f32`; stored is
//! sign(φ) log10(1 + |φ| / 1e-40), which is monotone, so it makes no difference to a decision stump.

use super::families::Measure as M;
use super::polygon::Outline;
use super::values::Values;
use crate::scan::lanes::{Doubles, Lanes, beams};
use crate::scan::{N_BEAMS, Ranges, beam_direction};

/// Smallest magnitude of a moment invariant that is distinguished from 0.
const PHI_MIN: f64 = 1e-40;
const N: f64 = N_BEAMS as f64;

/// Directions of the beams.
pub(super) struct Along {
    pub(super) x: [f64; N_BEAMS],
    pub(super) y: [f64; N_BEAMS],
}

impl Along {
    pub(super) fn new() -> Self {
        Self {
            x: std::array::from_fn(|beam| beam_direction(beam).x),
            y: std::array::from_fn(|beam| beam_direction(beam).y),
        }
    }
}

/// B10, B11 and B12.
#[inline(always)]
pub(super) fn moments(d: &Ranges, along: &Along, outline: &Outline<'_>, values: &mut Values) {
    let [mut sum_x, mut sum_y] = [Lanes::all(0.0); 2];
    for beam in beams(N_BEAMS, 1) {
        sum_x += d[beam].double() * along.x[beam];
        sum_y += d[beam].double() * along.y[beam];
    }
    let (mean_x, mean_y) = (sum_x * (1.0 / N), sum_y * (1.0 / N));
    let [mut m20, mut m11, mut m02, mut m30, mut m21, mut m12, mut m03] = [Lanes::all(0.0); 7];
    for beam in beams(N_BEAMS, 1) {
        let d = d[beam].double();
        let (x, y) = (d * along.x[beam] - mean_x, d * along.y[beam] - mean_y);
        let (xx, xy, yy) = (x * x, x * y, y * y);
        m20 += xx;
        m11 += xy;
        m02 += yy;
        m30 += xx * x;
        m21 += xx * y;
        m12 += x * yy;
        m03 += yy * y;
    }
    let spread = m20 + m02;
    let compactness = outline.area.double() / spread;
    let difference = m20 - m02;
    let elongation = (difference * difference + m11 * m11 * 4.0).map(f64::sqrt);
    values.set(M::Compactness, outline.or_zero(compactness.single()));
    values.set(M::Eccentricity, outline.or_zero((elongation / spread).single()));
    let (per_second, per_third) = (N.powi(-4), N.powi(-5));
    let second = [m20 * per_second, m11 * per_second, m02 * per_second];
    let third = [m30 * per_third, m21 * per_third, m12 * per_third, m03 * per_third];
    let invariants = invariants(second, third);
    for member in 0..invariants.len() {
        let phi = invariants[member];
        let decades = phi.map(|phi| libm::log10(1.0 + phi.abs() / PHI_MIN).copysign(phi));
        values.set_member(M::Moment, member, outline.or_zero(decades.single()));
    }
}

/// Hu's seven invariants of η20, η11, η02 and η30, η21, η12, η03.
///
/// Two published ports print η30 − η12 where φ5 and φ7 have η30 + η12; here is Hu's form.
#[inline(always)]
fn invariants([n20, n11, n02]: [Doubles; 3], [n30, n21, n12, n03]: [Doubles; 4]) -> [Doubles; 7] {
    let (p, q) = (n30 - n12 * 3.0, n21 * 3.0 - n03);
    let (s, t) = (n30 + n12, n21 + n03);
    let (ss, tt) = (s * s, t * t);
    let difference = n20 - n02;
    [
        n20 + n02,
        difference * difference + n11 * n11 * 4.0,
        p * p + q * q,
        ss + tt,
        p * s * (ss - tt * 3.0) + q * t * (ss * 3.0 - tt),
        difference * (ss - tt) + n11 * s * t * 4.0,
        q * s * (ss - tt * 3.0) - p * t * (ss * 3.0 - tt),
    ]
}
