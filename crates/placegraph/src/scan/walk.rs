//! The walk of a whole block of beams of one direction, one bit per beam.

use super::obstacles::{Obstacles, Offset, ROWS, STRIDE, WORD};

/// Cells of a block.
pub(super) const LANES: usize = ROWS * WORD;
/// Bits of a step count.
const PLANES: usize = u16::BITS as usize;
/// Longest path: step counts have 16 bits.
pub(super) const MAX_STEPS: usize = u16::MAX as usize;

/// One bit for every cell of a block.
pub(super) type Plane = [u64; ROWS];

/// The cells that beams of one direction enter, as displacements.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub(super) cells: Vec<Offset>,
    /// Only for diagonal beams: the two cells next to each corner that they run through.
    pub(super) beside: Vec<[Offset; 2]>,
}

/// Step counts of the cells of a block, in the order of [`slot`]: their lower bytes, and the upper ones where a beam takes
/// more than 255 steps, which few do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Steps {
    pub(super) low: [u8; LANES],
    pub(super) high: Option<[u8; LANES]>,
}

/// Where [`Steps`] has the count of the cell with this number, row-major in the block.
pub(super) fn slot(lane: u16) -> u16 {
    let (row, column) = (lane / WORD as u16, lane % WORD as u16);
    (column / 8 * ROWS as u16 + row) * 8 + column % 8
}

/// Number of cells of `path` that the beam of every cell enters before one stops it.
///
/// `position` is that of the block's words, `wanted` the cells to start from; the others count 0. Cost: about
/// 12 vector instructions per step of the longest beam.
#[inline(always)]
pub(super) fn count_steps(obstacles: &Obstacles, position: usize, wanted: &Plane, path: &Path) -> Steps {
    let planes = if path.beside.is_empty() {
        let (chunks, rest) = path.cells.as_chunks::<STRIDE>();
        walk(
            wanted,
            chunks,
            rest,
            #[inline(always)]
            |&cell| obstacles.around(position, cell),
        )
    } else {
        let steps: Vec<_> = path.cells.iter().zip(&path.beside).collect();
        let (chunks, rest) = steps.as_chunks::<STRIDE>();
        walk(
            wanted,
            chunks,
            rest,
            #[inline(always)]
            |&(&cell, &[one, other])| {
                let (one, other) = (obstacles.around(position, one), obstacles.around(position, other));
                let mut stops = obstacles.around(position, cell);
                for row in 0..ROWS {
                    stops[row] |= one[row] & other[row];
                }
                stops
            },
        )
    };
    numbers(&planes)
}

/// The cells of `wanted` whose beam enters one of `changed`, before or where `obstacles` stop it, or passes one beside a corner.
#[inline(always)]
pub(super) fn meets(
    obstacles: &Obstacles,
    changed: &Obstacles,
    position: usize,
    wanted: &Plane,
    path: &Path,
) -> Plane {
    let (mut alive, mut met) = (*wanted, [0; ROWS]);
    for (number, &cell) in path.cells.iter().enumerate() {
        if number.is_multiple_of(STRIDE) && alive == [0; ROWS] {
            break;
        }
        let mut stops = obstacles.around(position, cell);
        let mut changes = changed.around(position, cell);
        if let Some(&beside) = path.beside.get(number) {
            let [one, other] = beside.map(|cell| obstacles.around(position, cell));
            let [changed_one, changed_other] = beside.map(|cell| changed.around(position, cell));
            for row in 0..ROWS {
                stops[row] |= one[row] & other[row];
                changes[row] |= changed_one[row] | changed_other[row];
            }
        }
        for row in 0..ROWS {
            met[row] |= alive[row] & changes[row];
            // What met a change is known.
            alive[row] &= !(stops[row] | changes[row]);
        }
    }
    met
}

/// Counts for every bit the steps it survives, as bit planes: plane p is bit p of the count.
///
/// A beam that ends stays ended, so its count reaches a multiple of 2^p exactly when it survives that step:
/// plane p changes only at multiples of 2^p.
#[inline(always)]
fn walk<T>(
    wanted: &Plane,
    chunks: &[[T; STRIDE]],
    rest: &[T],
    stops: impl Fn(&T) -> Plane,
) -> [Plane; PLANES] {
    let mut planes = [[0; ROWS]; PLANES];
    let mut alive = *wanted;
    // The three planes that change within a chunk stay in registers.
    let mut low = [[0; ROWS]; 3];
    for (chunk, cells) in chunks.iter().enumerate() {
        for (index, cell) in cells.iter().enumerate() {
            clear(&mut alive, &stops(cell));
            count(&mut low, &alive, index + 1);
        }
        let number = (chunk + 1) * STRIDE;
        for plane in &mut planes[low.len()..=number.trailing_zeros() as usize] {
            flip(plane, &alive);
        }
        if alive.iter().fold(0, |any, row| any | row) == 0 {
            break;
        }
    }
    // Nothing that ended before survives a step of the rest.
    for (index, cell) in rest.iter().enumerate() {
        if alive.iter().fold(0, |any, row| any | row) == 0 {
            break;
        }
        clear(&mut alive, &stops(cell));
        count(&mut low, &alive, index + 1);
    }
    planes[..low.len()].copy_from_slice(&low);
    planes
}

/// Counts a step with this number in the lower planes.
#[inline(always)]
fn count(planes: &mut [Plane], alive: &Plane, number: usize) {
    for (power, plane) in planes.iter_mut().enumerate() {
        if number.is_multiple_of(1 << power) {
            flip(plane, alive);
        }
    }
}

#[inline(always)]
fn clear(plane: &mut Plane, bits: &Plane) {
    for row in 0..ROWS {
        plane[row] &= !bits[row];
    }
}

#[inline(always)]
fn flip(plane: &mut Plane, bits: &Plane) {
    for row in 0..ROWS {
        plane[row] ^= bits[row];
    }
}

/// Bit planes as numbers.
#[inline(always)]
fn numbers(planes: &[Plane; PLANES]) -> Steps {
    let (low, high) = planes.split_at(PLANES / 2);
    let is_long = high.as_flattened().iter().fold(0, |any, word| any | word) != 0;
    Steps { low: bytes(low), high: if is_long { Some(bytes(high)) } else { None } }
}

/// Eight bit planes as bytes, in the order of [`slot`]: byte l of word b of a row is the number in bit 8 b + l of the
/// planes.
#[inline(always)]
fn bytes(planes: &[Plane]) -> [u8; LANES] {
    let mut words: [Plane; 8] = std::array::from_fn(|plane| planes[plane]);
    // Transpose the 8 × 8 bytes of the words of a row: blocks of 4, of 2, of 1.
    for (step, mask) in [(4, 0x0000_0000_FFFF_FFFF), (2, 0x0000_FFFF_0000_FFFF), (1, 0x00FF_00FF_00FF_00FF)] {
        for one in (0..8).filter(|word| word & step == 0) {
            for row in 0..ROWS {
                let changed = (words[one][row] >> (8 * step) ^ words[one + step][row]) & mask;
                words[one + step][row] ^= changed;
                words[one][row] ^= changed << (8 * step);
            }
        }
    }
    // Transpose the 8 × 8 bits of every word: blocks of 1, of 2, of 4.
    for (shift, mask) in
        [(7, 0x00AA_00AA_00AA_00AA), (14, 0x0000_CCCC_0000_CCCC), (28, 0x0000_0000_F0F0_F0F0)]
    {
        for word in words.as_flattened_mut() {
            let changed = (*word ^ *word >> shift) & mask;
            *word ^= changed ^ changed << shift;
        }
    }
    let mut bytes = [0; LANES];
    for (bytes, word) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(words.as_flattened()) {
        *bytes = word.to_le_bytes();
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_the_bits_of_numbers() {
        for bits in [8, 16] {
            let expected: [u16; LANES] =
                std::array::from_fn(|lane| (lane * 2_654_435_761 % (1 << bits)) as u16);
            let mut planes = [[0; ROWS]; PLANES];
            for (lane, number) in expected.iter().enumerate() {
                for (bit, plane) in planes.iter_mut().enumerate() {
                    plane[lane / WORD] |= u64::from(number >> bit & 1) << (lane % WORD);
                }
            }
            let steps = numbers(&planes);
            assert_eq!(steps.high.is_some(), bits == 16);
            for (lane, number) in expected.into_iter().enumerate() {
                let at = usize::from(slot(lane as u16));
                let high = steps.high.map_or(0, |high| high[at]);
                assert_eq!(u16::from_le_bytes([steps.low[at], high]), number);
            }
        }
    }
}
