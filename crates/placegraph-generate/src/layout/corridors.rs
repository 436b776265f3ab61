//! Corridors as bands between blocks of rooms: one band makes a double-loaded corridor, two crossing
//! bands an L, T or cross, more of them combs, ladders and loops, once some stretches are taken away.

use super::{add, blocks, extend};
use crate::dice::Dice;
use crate::plan::{Plan, Usage};
use crate::shape::{Axis, Rect, across};
use crate::style::Recipe;

/// A strip of the floor, the whole plan long.
#[derive(Clone, Copy, Debug)]
struct Band {
    from: f64,
    to: f64,
    is_corridor: bool,
}

/// Columns and rows of bands, and which of the cells where they cross are corridor.
struct Weave {
    columns: Vec<Band>,
    rows: Vec<Band>,
    open: Vec<bool>,
}

/// Fills `plan` with corridors and the blocks of rooms between them.
pub(super) fn blocks_on_corridors(plan: &mut Plan, recipe: &Recipe, dice: &mut Dice) {
    let mut weave = loop {
        let n_columns = dice.count(1, recipe.blocks[0]);
        let n_rows = dice.count(if n_columns == 1 { 2 } else { 1 }, recipe.blocks[1].max(2));
        let weave = Weave::new(bands(n_columns, recipe, dice), bands(n_rows, recipe, dice));
        if weave.hangs_together() {
            break weave;
        }
    };
    let thinning = dice.pick(&[0.0, 0.3, 0.7]);
    weave.thin_out(thinning, dice);

    let mut corridor = None;
    for (column, row) in weave.places().filter(|&(column, row)| weave.is_open(column, row)) {
        let rect = weave.rect(column, row);
        match corridor {
            None => corridor = Some(add(plan, Usage::Corridor, rect)),
            Some(space) => _ = extend(plan, space, rect),
        }
    }
    for rect in weave.blocks() {
        blocks::fill(plan, &rect, recipe, dice);
    }
}

/// `n` blocks with corridors between them, now and then with one at the edge.
fn bands(n: usize, recipe: &Recipe, dice: &mut Dice) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    let mut push = |length: f64, is_corridor: bool| {
        let from = bands.last().map_or(0.0, |band| band.to);
        bands.push(Band { from, to: from + length, is_corridor });
    };
    let corridor = |dice: &mut Dice| {
        dice.within(recipe.corridor) * if dice.chance(0.1) { dice.between(1.2, 1.8) } else { 1.0 }
    };
    let depth = dice.within(recipe.depth);
    if dice.chance(0.1) {
        push(corridor(dice), true);
    }
    for block in 0..n {
        if block > 0 {
            push(corridor(dice), true);
        }
        let at_edge = block == 0 || block == n - 1;
        push(
            match dice.below(10) {
                _ if n == 1 => dice.within(recipe.wing),
                0..7 if at_edge => (depth + dice.normal() * 0.3).max(recipe.depth.0),
                0..5 => 2.0 * depth,
                5..7 => depth,
                _ => dice.within(recipe.wing) / n as f64 + recipe.depth.0,
            },
            false,
        );
    }
    if dice.chance(0.1) {
        push(corridor(dice), true);
    }
    bands
}

impl Weave {
    fn new(columns: Vec<Band>, rows: Vec<Band>) -> Self {
        let open = rows
            .iter()
            .flat_map(|row| columns.iter().map(|column| row.is_corridor || column.is_corridor))
            .collect();
        Self { columns, rows, open }
    }

    fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let width = self.columns.len();
        (0..self.rows.len()).flat_map(move |row| (0..width).map(move |column| (column, row)))
    }

    fn is_open(&self, column: usize, row: usize) -> bool {
        self.open[row * self.columns.len() + column]
    }

    fn rect(&self, column: usize, row: usize) -> Rect {
        let (x, y) = (self.columns[column], self.rows[row]);
        Rect::new(x.from, y.from, x.to, y.to)
    }

    fn is_block(&self, column: usize, row: usize) -> bool {
        !self.columns[column].is_corridor && !self.rows[row].is_corridor
    }

    fn is_crossing(&self, column: usize, row: usize) -> bool {
        self.columns[column].is_corridor && self.rows[row].is_corridor
    }

    /// The places that share a side with this one.
    fn beside(&self, column: usize, row: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (width, height) = (self.columns.len(), self.rows.len());
        [(0, -1), (-1, 0), (1, 0), (0, 1)].into_iter().filter_map(move |(dx, dy)| {
            let x = column.checked_add_signed(dx).filter(|&x| x < width)?;
            Some((x, row.checked_add_signed(dy).filter(|&y| y < height)?))
        })
    }

    /// Closes stretches of corridor with probability `share`, as long as all that is left hangs together and
    /// every block keeps a corridor.
    fn thin_out(&mut self, share: f64, dice: &mut Dice) {
        let mut stretches: Vec<(usize, usize)> = self
            .places()
            .filter(|&(column, row)| self.is_open(column, row) && !self.is_crossing(column, row))
            .collect();
        dice.shuffle(&mut stretches);
        for (column, row) in stretches {
            if dice.chance(share) {
                let before = self.open.clone();
                let width = self.columns.len();
                self.open[row * width + column] = false;
                self.close_lone_crossings();
                if !self.hangs_together() {
                    self.open = before;
                }
            }
        }
    }

    fn close_lone_crossings(&mut self) {
        for (column, row) in self.places() {
            let is_lone = !self.beside(column, row).any(|(x, y)| self.is_open(x, y));
            if is_lone && self.is_crossing(column, row) {
                let width = self.columns.len();
                self.open[row * width + column] = false;
            }
        }
    }

    fn hangs_together(&self) -> bool {
        let Some(start) = self.open.iter().position(|&open| open) else { return false };
        let width = self.columns.len();
        let mut reached = vec![false; self.open.len()];
        let mut queue = vec![start];
        reached[start] = true;
        while let Some(index) = queue.pop() {
            for (column, row) in self.beside(index % width, index / width) {
                let next = row * width + column;
                if self.open[next] && !reached[next] {
                    reached[next] = true;
                    queue.push(next);
                }
            }
        }
        let blocks_have_corridors = self
            .places()
            .filter(|&(column, row)| self.is_block(column, row))
            .all(|(column, row)| self.beside(column, row).any(|(x, y)| self.is_open(x, y)));
        reached == self.open && blocks_have_corridors
    }

    /// The blocks, grown over a closed stretch of corridor beside them.
    fn blocks(&self) -> Vec<Rect> {
        let mut taken = self.open.clone();
        let width = self.columns.len();
        let mut blocks = Vec::new();
        for (column, row) in self.places().filter(|&(column, row)| self.is_block(column, row)) {
            let mut rect = self.rect(column, row);
            let grow = self.beside(column, row).find(|&(x, y)| !taken[y * width + x]);
            if let Some((x, y)) = grow {
                taken[y * width + x] = true;
                let more = self.rect(x, y);
                rect = Rect::new(
                    rect.min.x.min(more.min.x),
                    rect.min.y.min(more.min.y),
                    rect.max.x.max(more.max.x),
                    rect.max.y.max(more.max.y),
                );
            }
            blocks.push(rect);
        }
        blocks
    }
}

/// Cuts long corridors by walls with a door where that parts the corridor in two.
pub(super) fn add_fire_doors(plan: &mut Plan, dice: &mut Dice) {
    let share = dice.pick(&[0.0, 0.0, 0.15, 0.4]);
    for index in 0..plan.tiles.len() {
        let tile = plan.tiles[index].clone();
        if !plan.spaces[tile.space].is_corridor() || !dice.chance(share) {
            continue;
        }
        let run = if tile.outer.width() > tile.outer.height() { Axis::X } else { Axis::Y };
        let (lo, hi) = tile.outer.span(run);
        if hi - lo < 8.0 {
            continue;
        }
        let cut = dice.between(lo + 2.5, hi - 2.5);
        let side = tile.outer.span(across(run));
        let (near, far) = (Rect::along(run, (lo, cut), side), Rect::along(run, (cut, hi), side));
        part(plan, index, near, far);
    }
}

/// Replaces tile `index` by `near` and `far`, with what hangs on `far` as a space of its own; leaves the plan
/// as it is if the two hang together elsewhere.
fn part(plan: &mut Plan, index: usize, near: Rect, far: Rect) {
    let space = plan.tiles[index].space;
    let whole = plan.tiles[index].outer;
    plan.tiles[index].outer = near;
    plan.tiles[index].inner = near;
    extend(plan, space, far);
    let far_index = plan.tiles.len() - 1;
    let contacts = plan.contacts();
    let mut behind = vec![false; plan.tiles.len()];
    let mut queue = vec![far_index];
    behind[far_index] = true;
    while let Some(tile) = queue.pop() {
        for contact in contacts.iter().filter(|contact| contact.tiles.contains(&tile)) {
            let next = contact.tiles[usize::from(contact.tiles[0] == tile)];
            let at_cut = contact.tiles.contains(&index) && contact.tiles.contains(&far_index);
            if plan.tiles[next].space == space && !behind[next] && !at_cut {
                behind[next] = true;
                queue.push(next);
            }
        }
    }
    if behind[index] {
        plan.tiles.pop();
        plan.tiles[index].outer = whole;
        plan.tiles[index].inner = whole;
        return;
    }
    plan.spaces.push(plan.spaces[space].clone());
    let new = plan.spaces.len() - 1;
    for (tile, _) in plan.tiles.iter_mut().zip(behind).filter(|(_, behind)| *behind) {
        tile.space = new;
    }
}
