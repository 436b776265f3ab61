//! Values of neighboring cells side by side: the compiler turns each operation into a few vector instructions.

use std::hint::black_box;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Cells that are measured together: one 512-bit register of `f32`.
pub(crate) const WIDTH: usize = 16;

/// One value for each of [`WIDTH`] cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct Lanes<T>(pub(crate) [T; WIDTH]);

/// Single precision, for nearly everything.
pub(crate) type Singles = Lanes<f32>;
/// Double precision, for sums that cancel.
pub(crate) type Doubles = Lanes<f64>;

/// 0 for every cell.
pub(crate) const ZERO: Singles = Lanes([0.0; WIDTH]);

/// Added to divisors that may be 0; far below any length or area of a scan.
pub(crate) const TINY: f32 = 1e-30;

impl<T: Copy> Lanes<T> {
    /// The same value for every cell.
    #[inline(always)]
    pub(crate) fn all(value: T) -> Self {
        Self([value; WIDTH])
    }

    /// Part number `part` of `L` values.
    #[inline(always)]
    pub(crate) fn part<const L: usize>(&self, part: usize) -> [T; L] {
        self.0.as_chunks::<L>().0[part]
    }

    /// The same, to be changed.
    #[inline(always)]
    pub(crate) fn part_mut<const L: usize>(&mut self, part: usize) -> &mut [T; L] {
        &mut self.0.as_chunks_mut::<L>().0[part]
    }

    #[inline(always)]
    pub(crate) fn map<U: Copy + Default>(self, f: impl Fn(T) -> U) -> Lanes<U> {
        let mut out = [U::default(); WIDTH];
        for lane in 0..WIDTH {
            out[lane] = f(self.0[lane]);
        }
        Lanes(out)
    }

    #[inline(always)]
    pub(crate) fn zip<U: Copy, V: Copy + Default>(self, other: Lanes<U>, f: impl Fn(T, U) -> V) -> Lanes<V> {
        let mut out = [V::default(); WIDTH];
        for lane in 0..WIDTH {
            out[lane] = f(self.0[lane], other.0[lane]);
        }
        Lanes(out)
    }
}

impl Singles {
    #[inline(always)]
    pub(crate) fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(f32::abs)
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    pub(crate) fn double(self) -> Doubles {
        self.map(f64::from)
    }

    /// 1 where the value is below `limit`, else 0.
    #[inline(always)]
    pub(crate) fn below(self, limit: f32) -> Self {
        self.map(|value| if value < limit { 1.0 } else { 0.0 })
    }

    /// 1 where the value is above `limit`, else 0.
    #[inline(always)]
    pub(crate) fn above(self, limit: f32) -> Self {
        self.map(|value| if value > limit { 1.0 } else { 0.0 })
    }

    /// The largest value.
    #[inline(always)]
    pub(crate) fn largest(self) -> f32 {
        self.halves(|a, b| if a > b { a } else { b })
    }

    /// The smallest value.
    #[inline(always)]
    pub(crate) fn smallest(self) -> f32 {
        self.halves(|a, b| if a < b { a } else { b })
    }

    /// Combines all values, one half with the other, until one is left.
    #[inline(always)]
    fn halves(mut self, combine: impl Fn(f32, f32) -> f32) -> f32 {
        for half in [8, 4, 2, 1] {
            for lane in 0..half {
                self.0[lane] = combine(self.0[lane], self.0[lane + half]);
            }
        }
        self.0[0]
    }
}

impl Lanes<u32> {
    /// Whether a value is not 0.
    #[inline(always)]
    pub(crate) fn is_any(self) -> bool {
        self.0.iter().fold(0, |any, value| any | value) != 0
    }

    /// `yes` where the value is not 0, else `no`.
    #[inline(always)]
    pub(crate) fn choose<T: Copy>(self, yes: Lanes<T>, no: Lanes<T>) -> Lanes<T> {
        let mut chosen = no;
        for lane in 0..WIDTH {
            chosen.0[lane] = if self.0[lane] == 0 { no.0[lane] } else { yes.0[lane] };
        }
        chosen
    }
}

impl Doubles {
    #[inline(always)]
    pub(crate) fn single(self) -> Singles {
        self.map(|value| value as f32)
    }
}

impl<T: Copy + Default + Add<Output = T>> Add for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Copy + Default + Add<Output = T>> AddAssign for Lanes<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Copy + Default + Sub<Output = T>> Sub for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<T: Copy + Default + Mul<Output = T>> Mul for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<T: Copy + Default + Mul<Output = T>> Mul<T> for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        self.map(|value| value * factor)
    }
}

impl<T: Copy + Default + Div<Output = T>> Div for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl<T: Copy + Default + Neg<Output = T>> Neg for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|value| -value)
    }
}

/// Beams from 0 to `end` in steps, of which the compiler knows nothing more: left alone it would put beams side by side,
/// whose values lie far apart in memory, instead of cells, whose values are neighbors.
#[inline(always)]
pub(crate) fn beams(end: usize, step: usize) -> impl Iterator<Item = usize> {
    (0..end).step_by(step).map(black_box)
}

/// The values of one lane.
///
/// One after the other: the compiler would gather them, which takes several times as long.
#[inline(always)]
pub(crate) fn of_lane(lane: usize, from: &[Singles], to: &mut [f32]) {
    const TOGETHER: usize = 8;
    let (chunks, to_chunks) = (from.as_chunks::<TOGETHER>().0, to.as_chunks_mut::<TOGETHER>().0);
    for chunk in beams(chunks.len(), 1) {
        for (to, from) in to_chunks[chunk].iter_mut().zip(&chunks[chunk]) {
            *to = from.0[lane];
        }
    }
}

/// Σ f(i) over `n` (a multiple of 4), in four interleaved sums: faster, and rounds less than one.
#[inline(always)]
pub(crate) fn sum<T>(n: usize, f: impl Fn(usize) -> Lanes<T>) -> Lanes<T>
where
    T: Copy + Default + Add<Output = T>,
{
    let mut sums = [Lanes::all(T::default()); 4];
    for start in beams(n, 4) {
        for (part, sum) in sums.iter_mut().enumerate() {
            *sum += f(start + part);
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Mean of f(i) over `n` (a multiple of 4), relative to f(0): equal values have exactly their mean.
#[inline(always)]
fn mean(n: usize, f: impl Fn(usize) -> Singles) -> Singles {
    let first = f(0);
    let from_first = sum(
        n,
        #[inline(always)]
        |i| f(i) - first,
    );
    first + from_first * (1.0 / n as f32)
}

/// Mean and population standard deviation of f(i) over `n` (a multiple of 4); equal values have deviation 0.
#[inline(always)]
pub(crate) fn mean_and_sd(n: usize, f: impl Fn(usize) -> Singles) -> (Singles, Singles) {
    let mean = mean(n, &f);
    let variance = sum(
        n,
        #[inline(always)]
        |i| {
            let deviation = f(i) - mean;
            deviation * deviation
        },
    );
    (mean, (variance * (1.0 / n as f32)).sqrt())
}
