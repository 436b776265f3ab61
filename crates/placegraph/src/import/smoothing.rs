//! Whether a picture of a map was smoothed: turned, scaled or drawn with interpolation.

use crate::grid::Grid;

/// A map saver writes three grays; a smoothed picture has dozens.
const MIN_GRAYS: usize = 64;
/// Areas of a smoothed picture are flat: the three commonest grays are those of most pixels.
const MIN_FLAT: f64 = 0.6;
/// Of the other pixels, more than this part lies between its neighbors and next to a flat area: 0.39 to 0.84 in the ten public
/// maps with halos that were looked at. Occupancy that a sensor counted, 0.35 to 0.95, cannot be distinguished from them, which is why
/// this is a note, and why in mode raw, where every gray is meant, nothing is said.
const MIN_BLENDED: f64 = 1.0 / 3.0;
/// Fewer than this part of all pixels are not worth a line.
const MIN_SHARE: f64 = 0.005;

/// Number of pixels with a gray between those of their neighbors, if there are so many, and so few flat grays, that the
/// picture must have been smoothed, else 0. `cells` holds the brightness and alpha of pixels, `counts` how many have which
/// brightness. Cost: a pass, and only for pictures of many grays.
pub(super) fn blended_cells(cells: &Grid<(u16, u8)>, counts: &[u64]) -> u64 {
    let n_cells = cells.values().len() as f64;
    let mut grays: Vec<usize> = (0..counts.len()).filter(|&gray| counts[gray] > 0).collect();
    if grays.len() < MIN_GRAYS {
        return 0;
    }
    grays.sort_by_key(|&gray| (std::cmp::Reverse(counts[gray]), gray));
    let flat = &grays[..3];
    let n_flat: u64 = flat.iter().map(|&gray| counts[gray]).sum();
    if (n_flat as f64) < MIN_FLAT * n_cells {
        return 0;
    }
    let is_flat = |gray: u16| flat.contains(&usize::from(gray));
    let rows: Vec<&[(u16, u8)]> = (0..cells.height()).map(|y| cells.row(y)).collect();
    let mut n_blended = 0;
    for three in rows.windows(3) {
        for x in 1..three[0].len().saturating_sub(1) {
            let gray = three[1][x].0;
            if is_flat(gray) {
                continue;
            }
            let around = || three.iter().flat_map(|row| &row[x - 1..=x + 1]).map(|&(gray, _)| gray);
            let (darker, brighter) = (around().any(|other| other < gray), around().any(|other| other > gray));
            n_blended += u64::from(darker && brighter && around().any(is_flat));
        }
    }
    let (blended, other) = (n_blended as f64, n_cells - n_flat as f64);
    if blended > MIN_BLENDED * other && blended > MIN_SHARE * n_cells { n_blended } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Brightness of a picture of 200 x 200 pixels, and how often each occurs.
    fn found(gray: impl Fn(u32, u32) -> f64) -> u64 {
        let pixels: Vec<(u16, u8)> = (0..200)
            .flat_map(|y| (0..200).map(move |x| (x, y)))
            .map(|(x, y)| (gray(x, y) as u16, 255))
            .collect();
        let mut counts = vec![0; 256];
        for &(gray, _) in &pixels {
            counts[usize::from(gray)] += 1;
        }
        blended_cells(&Grid::from_rows(200, 200, pixels), &counts)
    }

    /// Free rooms of 40 pixels behind walls of three, turned by 0.3 rad; `soft` says over how many pixels an edge goes.
    fn turned_rooms(x: u32, y: u32, soft: f64) -> f64 {
        let (sin, cos) = 0.3f64.sin_cos();
        let (u, v) = (cos * x as f64 - sin * y as f64, sin * x as f64 + cos * y as f64);
        let to_wall =
            [u, v].map(|w| (w.rem_euclid(43.0) - 1.5).abs()).into_iter().fold(f64::MAX, f64::min) - 1.5;
        254.0 * (to_wall / soft + 0.5).clamp(0.0, 1.0)
    }

    #[test]
    fn soft_edges_are_found_and_hard_ones_are_not() {
        let n_soft = found(|x, y| turned_rooms(x, y, 2.0));
        assert!((2000..12_000).contains(&n_soft), "{n_soft}");
        assert_eq!(found(|x, y| turned_rooms(x, y, 1e-9)), 0);
    }

    #[test]
    fn soft_edges_of_few_grays_were_drawn() {
        // 0, 32 ... 224.
        assert_eq!(found(|x, y| 32.0 * (turned_rooms(x, y, 2.0) / 32.0).floor()), 0);
    }

    #[test]
    fn grays_of_a_sensor_are_no_soft_edges() {
        // Every free cell has been seen another number of times.
        assert_eq!(found(|x, y| f64::from(150 + (x * 7919 + y * 104_729) % 97)), 0);
    }
}
