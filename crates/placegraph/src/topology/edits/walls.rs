//! Edits of the map itself: walls that close a gap, openings through walls.

use super::gap::{gap, in_cells, in_map, reach_m};
use super::{Applied, At, Edit, NotApplied, Outcome};
use crate::geom::Point2;
use crate::grid::{Cell, CellGraph, Occupancy, OccupancyGrid};
use crate::topology::segment::for_each_touched_in;

/// A map with walls and openings drawn into it.
#[derive(Clone, Debug, PartialEq)]
pub struct OnMap {
    /// The map.
    pub map: OccupancyGrid,
    /// Outcomes of the edits that change the map, by their position.
    pub outcomes: Vec<(usize, Outcome)>,
}

/// Applies the edits among `edits` that change the map; `None` if there are none.
pub fn apply_to_map(map: &OccupancyGrid, edits: &[Edit]) -> Option<OnMap> {
    let on_map: Vec<(usize, &Edit)> = edits.iter().enumerate().filter(|(_, edit)| edit.is_on_map()).collect();
    if on_map.is_empty() {
        return None;
    }
    let mut map = map.clone();
    let mut outcomes = Vec::new();
    for (position, edit) in on_map {
        let outcome = match *edit {
            Edit::Open { line, width_m } => open(&mut map, line, width_m),
            _ => edit.line().map_or(Err(NotApplied::NothingToOpen), |line| close(&mut map, line)),
        };
        let applied =
            |line| Applied { action: edit.action().to_owned(), line: Some(line), ..Applied::default() };
        outcomes.push((position, outcome.map(applied)));
    }
    Some(OnMap { map, outcomes })
}

/// Draws a wall from wall to wall.
fn close(map: &mut OccupancyGrid, line: [At; 2]) -> Result<[At; 2], NotApplied> {
    let graph = CellGraph::new(&map.cells);
    let within_m = reach_m(line);
    let drawn = in_cells(&map.frame, line);
    let [[ax, ay], [bx, by]] = line;
    let [a, b] = gap(&graph, drawn, within_m / map.frame.resolution_m()).ok_or(NotApplied::PartsNothing {
        ax,
        ay,
        bx,
        by,
        within_m,
    })?;
    for_each_touched_in((graph.width(), graph.height()), a, b, |x, y| {
        let cell = &mut map.cells[Cell::new(x, y)];
        if *cell == Occupancy::Free {
            *cell = Occupancy::Occupied;
        }
    });
    Ok(in_map(&map.frame, [a, b]))
}

/// Frees what lies within half of `width_m` of the line, whose ends are moved on until they are free.
fn open(map: &mut OccupancyGrid, line: [At; 2], width_m: f64) -> Result<[At; 2], NotApplied> {
    let resolution_m = map.frame.resolution_m();
    let [a, b] = in_cells(&map.frame, line);
    let ends = [free_end(map, a, b, line)?, free_end(map, b, a, [line[1], line[0]])?];
    let along = ends[1] - ends[0];
    let length = along.length();
    let half = 0.5 * width_m / resolution_m;
    let is_on = |cell: Cell| {
        let center = cell.center();
        let from = center - ends[0];
        let ahead = if length < 1e-9 { 0.0 } else { from.dot(along) / length };
        (0.0..=length).contains(&ahead) && (from.length().powi(2) - ahead * ahead).max(0.0).sqrt() <= half
    };
    let range = |a: f64, b: f64, side: u32| {
        let low = (a.min(b) - half).floor().clamp(0.0, f64::from(side));
        let high = (a.max(b) + half).ceil().clamp(0.0, f64::from(side));
        low as u32..high as u32
    };
    let (width, height) = (map.cells.width(), map.cells.height());
    let columns = range(ends[0].x, ends[1].x, width);
    let rows = range(ends[0].y, ends[1].y, height);
    let mut opened: Vec<Cell> = rows
        .flat_map(|y| columns.clone().map(move |x| Cell::new(x, y)))
        .filter(|&cell| is_on(cell))
        .collect();
    // However thin, it leads through.
    for_each_touched_in((width, height), ends[0], ends[1], |x, y| opened.push(Cell::new(x, y)));
    let mut n_opened = 0;
    for cell in opened {
        n_opened += u32::from(map.cells[cell] != Occupancy::Free);
        map.cells[cell] = Occupancy::Free;
    }
    if n_opened == 0 { Err(NotApplied::NothingToOpen) } else { Ok(in_map(&map.frame, ends)) }
}

/// `end` if it is free, else the first free point beyond it on the line from `other`, within reach. In cells.
fn free_end(map: &OccupancyGrid, end: Point2, other: Point2, line: [At; 2]) -> Result<Point2, NotApplied> {
    let at = |point: Point2| {
        let inside = |v: f64, side: u32| (0.0..f64::from(side)).contains(&v);
        let is_in = inside(point.x, map.cells.width()) && inside(point.y, map.cells.height());
        is_in.then(|| map.cells[Cell::new(point.x as u32, point.y as u32)])
    };
    let away = end - other;
    let length = away.length();
    let reach = reach_m(line) / map.frame.resolution_m();
    let steps = if length < 1e-9 { 0 } else { (2.0 * reach) as u32 };
    let beyond =
        (0..=steps).map(|step| if step == 0 { end } else { end + away * (0.5 * f64::from(step) / length) });
    // Off the map there is nothing to find, however far the line leads.
    let found =
        beyond.take_while(|&point| at(point).is_some()).find(|&point| at(point) == Some(Occupancy::Free));
    let [x, y] = line[0];
    let there = match at(end) {
        Some(Occupancy::Occupied) => "a wall",
        Some(_) => "unknown space",
        None => "nothing of the map",
    };
    found.ok_or(NotApplied::LeadsNowhere { found: there, x, y })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rooms and a wall of two cells between them; the lower wall has a gap.
    fn rooms() -> OccupancyGrid {
        OccupancyGrid::from_ascii(
            0.1,
            "
            ##################
            #......####......#
            #......#??#......#
            #......####......#
            #................#
            #......####......#
            ##################
            ",
        )
    }

    fn at(x: f64, y: f64) -> At {
        [x * 0.1, y * 0.1]
    }

    fn n_free(map: &OccupancyGrid) -> usize {
        map.count(Occupancy::Free)
    }

    #[test]
    fn a_wall_closes_the_gap_and_an_opening_makes_another() {
        let map = rooms();
        // Drawn half a cell away from the jambs of the gap.
        let close = Edit::Close { line: [at(8.5, 1.6), at(8.4, 3.3)] };
        let open = Edit::Open { line: [at(7.4, 4.5), at(10.6, 4.5)], width_m: 0.1 };
        let done = apply_to_map(&map, &[close, open]).unwrap();
        assert!(done.outcomes.iter().all(|(_, outcome)| outcome.is_ok()), "{:?}", done.outcomes);
        // One cell closed, a row of four opened.
        assert_eq!(n_free(&done.map), n_free(&map) - 1 + 4);
        assert_eq!(done.map.cells[Cell::new(8, 2)], Occupancy::Occupied);
        assert!((7..=10).all(|x| done.map.is_free(Cell::new(x, 4))));
    }

    #[test]
    fn an_opening_is_as_wide_as_it_should_be() {
        let map = rooms();
        let open = Edit::Open { line: [at(7.4, 4.5), at(10.6, 4.5)], width_m: 0.3 };
        let done = apply_to_map(&map, &[open]).unwrap();
        // Three rows of four cells.
        assert_eq!(n_free(&done.map), n_free(&map) + 12);
        assert!((3..=5).all(|y| (7..=10).all(|x| done.map.is_free(Cell::new(x, y)))));
    }

    #[test]
    fn an_end_in_a_wall_moves_on_by_half_a_meter() {
        // From the middle of the last cell but four, and but five, of a wall of nine.
        let map = OccupancyGrid::from_ascii(0.1, "...#########...");
        let opens = |x| {
            let open = Edit::Open { line: [at(1.5, 0.5), at(x, 0.5)], width_m: 0.1 };
            apply_to_map(&map, &[open]).unwrap().outcomes[0].1.is_ok()
        };
        assert_eq!([opens(7.5), opens(6.5)], [true, false]);
    }

    #[test]
    fn what_closes_or_opens_nothing_changes_nothing() {
        let map = rooms();
        let edits = [
            Edit::Close { line: [at(3.0, 3.0); 2] },
            Edit::Open { line: [at(2.0, 3.0), at(5.0, 3.0)], width_m: 0.1 },
            Edit::Open { line: [at(3.0, 3.0), at(3.0, -20.0)], width_m: 0.1 },
        ];
        let done = apply_to_map(&map, &edits).unwrap();
        let [(0, close), (1, open), (2, out)] = done.outcomes.as_slice() else { panic!("in order") };
        assert!(matches!(close, Err(NotApplied::PartsNothing { .. })), "{close:?}");
        assert_eq!(*open, Err(NotApplied::NothingToOpen));
        assert!(matches!(out, Err(NotApplied::LeadsNowhere { .. })), "{out:?}");
        assert!(apply_to_map(&map, &[Edit::Exclude { at: at(1.0, 1.0).into() }]).is_none());
    }
}
