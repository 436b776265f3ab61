//! The floor of a surveyed building as fine cells: which belong to which space, and where walls stand.

use placegraph::geom::Point2;
use placegraph::grid::{Cell, Grid};

use crate::shape::Rect;

/// Side of a fine cell, in meters.
pub(crate) const FINE_M: f64 = 0.025;
/// Most fine cells of a floor: 250 m by 250 m.
const MAX_CELLS: f64 = 1e8;

const OUTSIDE: u16 = 0;
const WALL: u16 = u16::MAX;

/// What is at a point of the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ground {
    Outside,
    Wall,
    /// Index of the space.
    Space(usize),
}

/// Spaces and walls of a building.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    origin: Point2,
    /// [`OUTSIDE`], [`WALL`] or the index of a space plus 1.
    cells: Grid<u16>,
}

impl Floor {
    /// Open ground that covers `bounds`; `None` if it is too large.
    pub(crate) fn over(bounds: &Rect) -> Option<Self> {
        let n = |length: f64| (length / FINE_M).ceil().max(1.0);
        let (width, height) = (n(bounds.width()), n(bounds.height()));
        (width * height <= MAX_CELLS)
            .then(|| Self { origin: bounds.min, cells: Grid::filled(width as u32, height as u32, OUTSIDE) })
    }

    /// The rectangle that it covers.
    pub(crate) fn bounds(&self) -> Rect {
        let Point2 { x, y } = self.origin;
        let at = |n: u32| f64::from(n) * FINE_M;
        Rect::new(x, y, x + at(self.cells.width()), y + at(self.cells.height()))
    }

    /// What is at `point`.
    pub(crate) fn at(&self, point: Point2) -> Ground {
        match self.cell_at(point).map_or(OUTSIDE, |cell| self.cells[cell]) {
            OUTSIDE => Ground::Outside,
            WALL => Ground::Wall,
            space => Ground::Space(usize::from(space) - 1),
        }
    }

    /// Area of the spaces that `counts`, in square meters.
    pub(crate) fn area_m2(&self, counts: impl Fn(usize) -> bool) -> f64 {
        let is_counted = |&&value: &&u16| value != OUTSIDE && value != WALL && counts(usize::from(value) - 1);
        self.cells.values().iter().filter(is_counted).count() as f64 * FINE_M * FINE_M
    }

    /// Makes the inside of a polygon (even-odd rule) part of `space`.
    pub(crate) fn fill(&mut self, polygon: &[Point2], space: usize) {
        for y in 0..self.cells.height() {
            let at_y = self.center(Cell::new(0, y)).y;
            let edges = polygon.iter().zip(polygon.iter().cycle().skip(1));
            let mut crossings: Vec<f64> = edges
                .filter(|(a, b)| (a.y <= at_y) != (b.y <= at_y))
                .map(|(a, b)| a.x + (b.x - a.x) * (at_y - a.y) / (b.y - a.y))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for ends in crossings.chunks_exact(2) {
                // Cells with their center between the ends.
                let column = |x: f64| ((x - self.origin.x) / FINE_M - 0.5).ceil().max(0.0) as u32;
                for x in column(ends[0])..column(ends[1]).min(self.cells.width()) {
                    self.cells[Cell::new(x, y)] = space as u16 + 1;
                }
            }
        }
    }

    /// Puts a wall of `thickness_m` along the segment from `a` to `b`.
    pub(crate) fn wall(&mut self, a: Point2, b: Point2, thickness_m: f64) {
        let reach = 0.5 * thickness_m;
        let around = Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y)).grown(reach);
        let (along, n) = (b - a, |v: f64, from: f64| ((v - from) / FINE_M).floor().max(0.0) as u32);
        let (x0, y0) = (n(around.min.x, self.origin.x), n(around.min.y, self.origin.y));
        let x1 = (n(around.max.x, self.origin.x) + 1).min(self.cells.width());
        let y1 = (n(around.max.y, self.origin.y) + 1).min(self.cells.height());
        for cell in (y0..y1).flat_map(|y| (x0..x1).map(move |x| Cell::new(x, y))) {
            let offset = self.center(cell) - a;
            let share = (offset.dot(along) / along.dot(along).max(1e-12)).clamp(0.0, 1.0);
            let miss = offset - along * share;
            if miss.dot(miss) <= reach * reach {
                self.cells[cell] = WALL;
            }
        }
    }

    /// Makes everything that is connected to `seed` part of `space`, unless it belongs to another one or lies open to
    /// the edge of the floor. Returns what `seed` belongs to then.
    pub(crate) fn flood(&mut self, seed: Point2, space: usize) -> Ground {
        let Some(start) = self.cell_at(seed).filter(|&cell| self.cells[cell] == OUTSIDE) else {
            return self.at(seed);
        };
        let mut reached = vec![self.cells.index(start)];
        self.cells[start] = space as u16 + 1;
        let (mut next, mut is_open) = (0, false);
        while next < reached.len() {
            let cell = self.cells.cell(reached[next]);
            next += 1;
            for step in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
                match self.cells.offset(cell, step) {
                    None => is_open = true,
                    Some(beside) if self.cells[beside] == OUTSIDE => {
                        self.cells[beside] = space as u16 + 1;
                        reached.push(self.cells.index(beside));
                    }
                    Some(_) => {}
                }
            }
        }
        if is_open {
            for index in reached {
                self.cells.values_mut()[index] = OUTSIDE;
            }
            return Ground::Outside;
        }
        Ground::Space(space)
    }

    /// Puts walls on everything outside within `thickness_m` of a space: outer walls, and what lies between two spaces.
    pub(crate) fn enclose(&mut self, thickness_m: f64) {
        let reach = (thickness_m / FINE_M).ceil() as i32;
        let disc: Vec<(i32, i32)> = (-reach..=reach)
            .flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)))
            .filter(|(dx, dy)| dx * dx + dy * dy <= reach * reach)
            .collect();
        let before = self.cells.clone();
        let is_space = |value: u16| value != OUTSIDE && value != WALL;
        for cell in before.cells().filter(|&cell| is_space(before[cell])) {
            let mut beside = [(1, 0), (0, 1), (-1, 0), (0, -1)].into_iter();
            if beside.any(|step| before.offset(cell, step).is_none_or(|near| !is_space(before[near]))) {
                for near in disc.iter().filter_map(|&step| before.offset(cell, step)) {
                    if self.cells[near] == OUTSIDE {
                        self.cells[near] = WALL;
                    }
                }
            }
        }
    }

    /// Numbers the spaces by `number`; those without one become part of the outside.
    pub(crate) fn renumber(&mut self, number: &[Option<usize>]) {
        for value in self.cells.values_mut().iter_mut().filter(|value| !matches!(**value, OUTSIDE | WALL)) {
            *value = number[usize::from(*value) - 1].map_or(OUTSIDE, |new| new as u16 + 1);
        }
    }

    /// The largest rectangle along the axes in each of the `n` spaces, on a raster of a tenth of a meter; `None` where not
    /// even one of its cells fits.
    pub(crate) fn largest_rectangles(&self, n: usize) -> Vec<Option<Rect>> {
        const COARSE: u32 = 4;
        let (width, height) = (self.cells.width() / COARSE, self.cells.height() / COARSE);
        let coarse = |x: u32, y: u32| {
            let mut inside = (0..COARSE * COARSE)
                .map(|k| self.cells[Cell::new(x * COARSE + k % COARSE, y * COARSE + k / COARSE)]);
            let first = inside.next().unwrap_or(OUTSIDE);
            if first != WALL && inside.all(|value| value == first) { first } else { OUTSIDE }
        };
        let mut best: Vec<Option<(u32, [u32; 4])>> = vec![None; n];
        // For every column, the value of its cell in this row and how many equal ones lie on and below it.
        let mut stacks = vec![(OUTSIDE, 0_u32); width as usize];
        for y in 0..height {
            for x in 0..width {
                let value = coarse(x, y);
                let (below, depth) = stacks[x as usize];
                stacks[x as usize] = (value, if value == below { depth + 1 } else { 1 });
            }
            for (x, &(value, depth)) in stacks.iter().enumerate().filter(|(_, stack)| stack.0 != OUTSIDE) {
                let mut lowest = depth;
                for (wide, &(beside, depth)) in (1..).zip(&stacks[x..]) {
                    if beside != value {
                        break;
                    }
                    lowest = lowest.min(depth);
                    let best = &mut best[usize::from(value) - 1];
                    if best.is_none_or(|(area, _)| wide * lowest > area) {
                        let x = x as u32;
                        *best = Some((wide * lowest, [x, y + 1 - lowest, x + wide, y + 1]));
                    }
                }
            }
        }
        let side = f64::from(COARSE) * FINE_M;
        let at = |n: u32, from: f64| from + f64::from(n) * side;
        let Point2 { x, y } = self.origin;
        best.into_iter()
            .map(|best| {
                best.map(|(_, [x0, y0, x1, y1])| Rect::new(at(x0, x), at(y0, y), at(x1, x), at(y1, y)))
            })
            .collect()
    }

    fn cell_at(&self, point: Point2) -> Option<Cell> {
        let (x, y) = ((point.x - self.origin.x) / FINE_M, (point.y - self.origin.y) / FINE_M);
        let is_on =
            x >= 0.0 && y >= 0.0 && x < f64::from(self.cells.width()) && y < f64::from(self.cells.height());
        is_on.then(|| Cell::new(x as u32, y as u32))
    }

    fn center(&self, cell: Cell) -> Point2 {
        let at = |n: u32, from: f64| from + (f64::from(n) + 0.5) * FINE_M;
        Point2::new(at(cell.x, self.origin.x), at(cell.y, self.origin.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L of 4 m by 3 m with the upper right 2 m by 1 m missing.
    fn corner() -> Floor {
        let mut floor = Floor::over(&Rect::new(-1.0, -1.0, 6.0, 5.0)).unwrap();
        let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0), (2.0, 3.0), (0.0, 3.0)];
        floor.fill(&points.map(|(x, y)| Point2::new(x, y)), 0);
        floor
    }

    #[test]
    fn a_polygon_has_its_area_and_its_largest_rectangle() {
        let floor = corner();
        assert!((floor.area_m2(|_| true) - 10.0).abs() < 0.01);
        assert_eq!(floor.at(Point2::new(3.9, 1.9)), Ground::Space(0));
        assert_eq!(floor.at(Point2::new(3.0, 2.5)), Ground::Outside);
        let rect = floor.largest_rectangles(1)[0].unwrap();
        // 4 m by 2 m beats 2 m by 3 m.
        assert!((rect.area() - 8.0).abs() < 0.2, "{rect:?}");
    }

    #[test]
    fn walls_stop_the_flood_and_an_open_room_is_none() {
        let mut floor = Floor::over(&Rect::new(0.0, 0.0, 5.0, 5.0)).unwrap();
        let corners = [(1.0, 1.0), (4.0, 1.0), (4.0, 3.0), (1.0, 3.0)].map(|(x, y)| Point2::new(x, y));
        for k in 0..4 {
            floor.wall(corners[k], corners[(k + 1) % 4], 0.1);
        }
        assert_eq!(floor.flood(Point2::new(2.0, 2.0), 0), Ground::Space(0));
        assert_eq!(floor.flood(Point2::new(3.0, 2.5), 1), Ground::Space(0));
        assert_eq!(floor.flood(Point2::new(2.0, 4.0), 1), Ground::Outside);
        assert_eq!(floor.at(Point2::new(2.0, 4.0)), Ground::Outside);
        // 2.9 m by 1.9 m between the faces of the walls.
        assert!((floor.area_m2(|space| space == 0) - 5.51).abs() < 0.1);
        floor.enclose(0.5);
        assert_eq!(floor.at(Point2::new(2.0, 3.4)), Ground::Wall);
        assert_eq!(floor.at(Point2::new(2.0, 3.6)), Ground::Outside);
    }
}
