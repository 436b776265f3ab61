//! B6 to B9: Fourier coefficients of the polygon's boundary, a closed polyline over its arc length.
//!
//! ```text
//! c_k = L / (2πk)² · S_k,   S_k = Σ_j (u_{j−1} − u_j) exp(−i k θ_j),   θ_j = 2π t_j / L
//! ```
//! with unit edge directions u_j and arc lengths t_j of the vertices: the exact coefficients of the polyline,
//! not a transform of the vertices. A vertex at an edge of length 0 drops out of the sum.
//!
//! Harmonics are written k = 11 a ± b, b ≤ 5: with z_a = (u_{j−1} − u_j) exp(−11 i a θ_j), the four real sums
//! of z_a's components times cos bθ_j and sin bθ_j give S_{11a+b} and S_{11a−b} together. That is half the
//! work of a recurrence over k, and products of powers lose fewer digits. Cost: 4 · 360 operations per
//! harmonic that is asked for, and 6 · 360 per row up to that of the largest.

use super::families::{MAX_HARMONIC, Measure as M};
use super::polygon::{Directions, Outline};
use super::values::Values;
use crate::scan::lanes::{Doubles, Lanes, Singles, TINY, WIDTH, ZERO, beams};
use crate::scan::{N_BEAMS, Ranges};

/// Largest b.
const B: usize = 5;
/// Step of k from row to row.
const ROW: usize = 2 * B + 1;
/// Rows, so that all harmonics up to [`MAX_HARMONIC`] are reached.
const N_ROWS: usize = (MAX_HARMONIC + B) / ROW + 1;
/// Vertices that are worked on together, in the first-level cache.
const CHUNK: usize = 24;

/// The row of harmonic `k`.
fn row_of(k: usize) -> usize {
    (k + B) / ROW
}

/// Σ z, and for b = 1 … 5: Σ Re z cos bθ, Σ Im z cos bθ, Σ Re z sin bθ, Σ Im z sin bθ.
#[derive(Clone, Copy)]
struct Row {
    constant: [Singles; 2],
    products: [[Singles; 4]; B],
}

/// cos bθ and sin bθ, b = 1 … 5.
type Powers = [[Singles; 2]; B];

/// The harmonics of B6 that are asked for, and which sums they need.
pub(super) struct Harmonics {
    of_b6: Vec<usize>,
    /// For every row, whether its sums for b = 0 … 5 are needed.
    rows: Vec<[bool; B + 1]>,
}

impl Harmonics {
    pub(super) fn new(of_b6: Vec<usize>) -> Self {
        let n_rows = of_b6.iter().map(|&k| row_of(k) + 1).max().unwrap_or(1);
        let mut rows = vec![[false; B + 1]; n_rows];
        for k in of_b6.iter().copied().chain([1]) {
            let (row, b) = position_of(k);
            rows[row][b.unsigned_abs()] = true;
        }
        Self { of_b6, rows }
    }
}

/// The row and b of harmonic `k` = 11 row + b.
fn position_of(k: usize) -> (usize, isize) {
    (row_of(k), (k + B) as isize % ROW as isize - B as isize)
}

/// B6 of `harmonics`, and B7 to B9. A register of the machine holds `lanes` cells.
#[inline(always)]
pub(super) fn fourier(
    d: &Ranges,
    directions: &Directions,
    outline: &Outline<'_>,
    harmonics: &Harmonics,
    lanes: usize,
    values: &mut Values,
) {
    let sums = row_sums(d, directions, outline, &harmonics.rows, lanes);
    let (first, before) = sums[0].at(1);
    let scale = outline.perimeter * (1.0 / (4.0 * std::f32::consts::PI * std::f32::consts::PI));
    let (c1, c_1) = (first * scale, before * scale);
    let (major, minor) = (c1 + c_1, (c1 - c_1).abs());
    let q = before / (first + Lanes::all(TINY));
    let one = Lanes::all(1.0);
    let mut set = |measure, member, value| values.set_member(measure, member, outline.or_zero(value));
    set(M::MajorAxis, 0, major);
    set(M::MinorAxis, 0, minor);
    set(M::AxisRatio, 0, minor / (major + Lanes::all(TINY)));
    set(M::DescriptorMajorAxis, 0, one + q);
    set(M::DescriptorMinorAxis, 0, (one - q).abs());
    set(M::DescriptorAxisRatio, 0, (one - q).abs() / (one + q));
    for &k in &harmonics.of_b6 {
        let (row, b) = position_of(k);
        let (after, before) = sums[row].at(b.unsigned_abs());
        let magnitude = if b >= 0 { after } else { before };
        let ratio = magnitude / (first + Lanes::all(TINY)) * (1.0 / (k * k) as f32);
        set(M::Fourier, k - 2, ratio);
    }
}

impl Row {
    const ZERO: Self = Self { constant: [ZERO; 2], products: [[ZERO; 4]; B] };

    /// |S_{11a+b}| and |S_{11a−b}|.
    #[inline(always)]
    fn at(&self, b: usize) -> (Singles, Singles) {
        let length = |re: Singles, im: Singles| (re * re + im * im).sqrt();
        if b == 0 {
            let magnitude = length(self.constant[0], self.constant[1]);
            return (magnitude, magnitude);
        }
        // exp(−ibθ) = cos bθ − i sin bθ.
        let [re_cos, im_cos, re_sin, im_sin] = self.products[b - 1];
        (length(re_cos + im_sin, im_cos - re_sin), length(re_cos - im_sin, im_cos + re_sin))
    }

    /// Adds vertices with weights `z`, and turns the weights into those of the next row, if there is one. A register of the
    /// machine holds `lanes` cells.
    #[inline(always)]
    fn add(
        &mut self,
        z: &mut [[Singles; 2]; CHUNK],
        powers: &[Powers; CHUNK],
        turn: Option<&[[Singles; 2]; CHUNK]>,
        needed: [bool; B + 1],
        lanes: usize,
    ) {
        let is_most = needed[1..].iter().filter(|&&needed| needed).count() > 3;
        if is_most && lanes == WIDTH {
            // All sums at once: each vertex is fetched once.
            let mut sums = *self;
            for i in beams(CHUNK, 1) {
                let (z, powers) = (&mut z[i], &powers[i]);
                add_to(&mut sums.constant, z);
                for (sums, power) in sums.products.iter_mut().zip(powers) {
                    add_products(sums, z, power);
                }
                if let Some(turn) = turn {
                    *z = product(*z, turn[i]);
                }
            }
            *self = sums;
            return;
        }
        if needed[0] {
            let mut sums = self.constant;
            for i in beams(CHUNK, 1) {
                add_to(&mut sums, &z[i]);
            }
            self.constant = sums;
        }
        if is_most && lanes == 8 {
            self.add_in_parts::<8, 0, 2>(z, powers);
            self.add_in_parts::<8, 2, 3>(z, powers);
        } else if is_most {
            self.add_in_parts::<4, 0, 2>(z, powers);
            self.add_in_parts::<4, 2, 3>(z, powers);
        } else {
            for b in (0..B).filter(|&b| needed[b + 1]) {
                let mut sums = self.products[b];
                for i in beams(CHUNK, 1) {
                    add_products(&mut sums, &z[i], &powers[i][b]);
                }
                self.products[b] = sums;
            }
        }
        if let Some(turn) = turn {
            for i in beams(CHUNK, 1) {
                z[i] = product(z[i], turn[i]);
            }
        }
    }

    /// Adds the products for the `N` numbers b from `FIRST` + 1 on, of `L` cells at a time: as many sums as registers hold.
    #[inline(always)]
    fn add_in_parts<const L: usize, const FIRST: usize, const N: usize>(
        &mut self,
        z: &[[Singles; 2]; CHUNK],
        powers: &[Powers; CHUNK],
    ) {
        for part in beams(WIDTH / L, 1) {
            let mut sums = [[[0.0; L]; 4]; N];
            for (sums, whole) in sums.iter_mut().zip(&self.products[FIRST..]) {
                for (sum, whole) in sums.iter_mut().zip(whole) {
                    *sum = whole.part(part);
                }
            }
            for i in beams(CHUNK, 1) {
                let [re, im]: [[f32; L]; 2] = [z[i][0].part(part), z[i][1].part(part)];
                for (sums, [cos, sin]) in sums.iter_mut().zip(&powers[i][FIRST..]) {
                    let [cos, sin]: [[f32; L]; 2] = [cos.part(part), sin.part(part)];
                    for lane in 0..L {
                        sums[0][lane] += re[lane] * cos[lane];
                        sums[1][lane] += im[lane] * cos[lane];
                        sums[2][lane] += re[lane] * sin[lane];
                        sums[3][lane] += im[lane] * sin[lane];
                    }
                }
            }
            for (sums, whole) in sums.iter().zip(&mut self.products[FIRST..]) {
                for (sum, whole) in sums.iter().zip(whole) {
                    *whole.part_mut(part) = *sum;
                }
            }
        }
    }
}

#[inline(always)]
fn add_to(sums: &mut [Singles; 2], z: &[Singles; 2]) {
    sums[0] += z[0];
    sums[1] += z[1];
}

#[inline(always)]
fn add_products(sums: &mut [Singles; 4], z: &[Singles; 2], [cos, sin]: &[Singles; 2]) {
    sums[0] += z[0] * *cos;
    sums[1] += z[1] * *cos;
    sums[2] += z[0] * *sin;
    sums[3] += z[1] * *sin;
}

#[inline(always)]
fn row_sums(
    d: &Ranges,
    directions: &Directions,
    outline: &Outline<'_>,
    needed: &[[bool; B + 1]],
    lanes: usize,
) -> [Row; N_ROWS] {
    let mut sums = [Row::ZERO; N_ROWS];
    let mut arc: Doubles = Lanes::all(0.0);
    let turns_per_meter = Lanes::all(1.0)
        / outline.edges.iter().fold(Lanes::all(1e-300), |length, edge| length + edge.double());
    let mut u_before = direction(d, directions, outline, N_BEAMS - 1);
    let mut z = [[ZERO; 2]; CHUNK];
    let mut turns = [ZERO; CHUNK];
    let mut powers = [[[ZERO; 2]; B]; CHUNK];
    let mut row_step = [[ZERO; 2]; CHUNK];
    for start in (0..N_BEAMS).step_by(CHUNK) {
        // Short loops, so that the processor works on several turns of them at once.
        for i in beams(CHUNK, 1) {
            turns[i] = (arc * turns_per_meter).single();
            arc += outline.edges[start + i].double();
        }
        for i in beams(CHUNK, 1) {
            powers[i][0] = cos_sin(turns[i]);
        }
        for i in beams(CHUNK, 1) {
            let one = powers[i][0];
            let two = product(one, one);
            let three = product(two, one);
            powers[i] = [one, two, three, product(two, two), product(three, two)];
        }
        if needed.len() > 1 {
            for i in beams(CHUNK, 1) {
                let [one, .., five] = powers[i];
                let eleven = product(product(five, five), one);
                row_step[i] = [eleven[0], -eleven[1]];
            }
        }
        for i in beams(CHUNK, 1) {
            let u = direction(d, directions, outline, start + i);
            z[i] = [u_before[0] - u[0], u_before[1] - u[1]];
            u_before = u;
        }
        for (row, &of_row) in needed.iter().enumerate() {
            let turn = (row + 1 < needed.len()).then_some(&row_step);
            sums[row].add(&mut z, &powers, turn, of_row, lanes);
        }
    }
    sums
}

/// Unit direction of the edge from `vertex` to the next; 0 for an edge of length 0.
///
/// Worked out in the frame of the beam, where only lengths of neighboring beams are subtracted.
#[inline(always)]
fn direction(d: &Ranges, directions: &Directions, outline: &Outline<'_>, vertex: usize) -> [Singles; 2] {
    let (one, next) = (d[vertex], d[vertex + 1]);
    let (sin, half) = (1f64.to_radians().sin() as f32, 0.5f64.to_radians().sin());
    let scale = Lanes::all(1.0) / outline.edges[vertex].max(Lanes::all(TINY));
    let along = ((next - one) - next * (2.0 * half * half) as f32) * scale;
    let across = next * sin * scale;
    let (cos, sin) = (directions.cos[vertex], directions.sin[vertex]);
    [along * cos - across * sin, along * sin + across * cos]
}

/// Product of two complex numbers.
#[inline(always)]
fn product(z: [Singles; 2], w: [Singles; 2]) -> [Singles; 2] {
    [z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0]]
}

/// cos 2πx and sin 2πx for 0 ≤ x ≤ 1, within 2e-7: a polynomial in the eighth of a turn around the nearest
/// quarter.
#[inline(always)]
fn cos_sin(x: Singles) -> [Singles; 2] {
    // Adding this leaves the nearest whole number in the lowest bits.
    const ROUND: f32 = 12_582_912.0;
    let rounded = x.map(|x| x * 4.0 + ROUND);
    let angle = x.zip(rounded, |x, rounded| (x - (rounded - ROUND) * 0.25) * std::f32::consts::TAU);
    let square = angle * angle;
    // Not by `map` over the three: the compiler may call it, and then the lanes go through memory.
    let polynomial = |[a, b, c]: [f32; 3]| (square * a + Lanes::all(b)) * square + Lanes::all(c);
    // Minimax polynomials on ±π/4.
    let sin = polynomial([-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1]) * square * angle + angle;
    let cos = polynomial([2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]) * square * square;
    let cos = cos - square * 0.5 + Lanes::all(1.0);
    // Quarter q: cos is cos, −sin, −cos, sin; sin is sin, cos, −sin, −cos.
    let (quarter, cos, sin) = (rounded.map(f32::to_bits), cos.map(f32::to_bits), sin.map(f32::to_bits));
    let exchanged =
        cos.zip(sin, |cos, sin| cos ^ sin).zip(quarter, |both, q| both & 0u32.wrapping_sub(q & 1));
    let cos = cos.zip(exchanged, |cos, bits| cos ^ bits);
    let sin = sin.zip(exchanged, |sin, bits| sin ^ bits);
    [
        cos.zip(quarter, |cos, q| f32::from_bits(cos ^ (q.wrapping_add(1) & 2) << 30)),
        sin.zip(quarter, |sin, q| f32::from_bits(sin ^ (q & 2) << 30)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cos_sin_over_a_turn() {
        for step in 0..=100_000 {
            let x = step as f32 / 100_000.0;
            let [cos, sin] = cos_sin(Lanes::all(x));
            let angle = f64::from(x) * std::f64::consts::TAU;
            assert!((f64::from(cos.0[0]) - angle.cos()).abs() < 2e-7, "cos at {x}");
            assert!((f64::from(sin.0[0]) - angle.sin()).abs() < 2e-7, "sin at {x}");
        }
    }

    #[test]
    fn every_harmonic_has_its_row() {
        assert_eq!((row_of(1), row_of(5), row_of(6), row_of(16), row_of(17)), (0, 0, 1, 1, 2));
        assert_eq!(row_of(MAX_HARMONIC), N_ROWS - 1);
    }
}
