//! An architect's drawing of the building: everything inside is known, nothing is noisy.

use placegraph::grid::{Cell, Grid, Occupancy};

use crate::dice::Dice;
use crate::scene::{Scene, Surface};

/// The drawing of `scene` in cells of `per_cell` by `per_cell` fine cells.
pub(crate) fn draw(scene: &Scene, per_cell: u32, dice: &mut Dice) -> Grid<Occupancy> {
    let (width, height) =
        (scene.surface.width().div_ceil(per_cell), scene.surface.height().div_ceil(per_cell));
    let mut map = Grid::filled(width, height, Occupancy::Unknown);
    for cell in map.cells() {
        let (mut floor, mut solid) = (0, 0);
        for k in 0..per_cell * per_cell {
            let fine = Cell::new(cell.x * per_cell + k % per_cell, cell.y * per_cell + k / per_cell);
            if fine.x < scene.surface.width() && fine.y < scene.surface.height() {
                let index = scene.surface.index(fine);
                solid +=
                    u32::from(!matches!(scene.surface.values()[index], Surface::Open | Surface::Outside));
                floor += u32::from(scene.is_floor(index));
            }
        }
        if 4 * solid >= per_cell * per_cell {
            map[cell] = Occupancy::Occupied;
        } else if floor > 0 {
            map[cell] = Occupancy::Free;
        }
    }
    if dice.chance(0.6) {
        hollow_out(&mut map, scene, per_cell, (0.25 / (scene.cell_m * f64::from(per_cell))).ceil() as i32);
    }
    map
}

/// Makes cells of walls unknown that are more than `reach` cells from all free ones.
fn hollow_out(map: &mut Grid<Occupancy>, scene: &Scene, per_cell: u32, reach: i32) {
    let mut near_free = map.map(|_| false);
    for cell in map.cells().filter(|&cell| map[cell] == Occupancy::Free) {
        let inside = (1..map.width() - 1).contains(&cell.x) && (1..map.height() - 1).contains(&cell.y);
        let at_edge = !inside
            || [(0, 1), (1, 0), (0, -1), (-1, 0)]
                .iter()
                .any(|&step| map.offset(cell, step).is_some_and(|beside| map[beside] != Occupancy::Free));
        if at_edge {
            for (dx, dy) in (-reach..=reach).flat_map(|dx| (-reach..=reach).map(move |dy| (dx, dy))) {
                if let Some(near) = map.offset(cell, (dx, dy)) {
                    near_free[near] = true;
                }
            }
        }
    }
    for cell in near_free.cells().filter(|&cell| !near_free[cell]) {
        let fine = Cell::new(
            (cell.x * per_cell).min(scene.surface.width() - 1),
            (cell.y * per_cell).min(scene.surface.height() - 1),
        );
        if map[cell] == Occupancy::Occupied && scene.surface[fine] != Surface::Furniture {
            map[cell] = Occupancy::Unknown;
        }
    }
}
