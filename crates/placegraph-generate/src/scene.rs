//! The world as fine cells: what stops a ray, and which space each cell belongs to.

use placegraph::geom::Point2;
use placegraph::grid::{Cell, Grid};

use crate::dice::Dice;
use crate::floor::{Floor, Ground};
use crate::plan::Plan;
use crate::shape::{Rect, Solid, heading};
use crate::warp::Warp;

/// What fills a fine cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Surface {
    Open,
    Wall,
    Glass,
    Leaf,
    Furniture,
    /// Bushes, cars and facades outside.
    Outside,
}

/// Fine cells over the building and its surroundings; the fine grid's lower left corner is at `origin`.
#[derive(Clone, Debug)]
pub(crate) struct Scene {
    pub(crate) origin: Point2,
    pub(crate) cell_m: f64,
    pub(crate) surface: Grid<Surface>,
    /// Index of the space plus 1, 0 in walls and outside.
    pub(crate) space: Grid<u16>,
    /// Index of the opening plus 1 in doorways and passages, 0 elsewhere.
    pub(crate) opening: Grid<u16>,
}

impl Scene {
    /// Paints `plan` in cells of `cell_m` meters, with `margin_m` meters of open ground around it.
    pub(crate) fn paint(plan: &Plan, warp: &Warp, cell_m: f64, margin_m: f64) -> Self {
        let bounds = world_bounds(&plan.bounds(), warp).grown(margin_m);
        let n = |length: f64| (length / cell_m).ceil() as u32 + 1;
        let (width, height) = (n(bounds.width()), n(bounds.height()));
        let mut scene = Self {
            origin: bounds.min,
            cell_m,
            surface: Grid::filled(width, height, Surface::Open),
            space: Grid::filled(width, height, 0),
            opening: Grid::filled(width, height, 0),
        };
        scene.paint_walls(plan, warp);
        scene.paint_openings(plan, warp);
        let layers = [(&plan.fixtures, Surface::Wall), (&plan.furniture, Surface::Furniture)];
        for (solids, surface) in layers {
            for solid in solids {
                scene.fill(solid, warp, |scene, index| scene.surface.values_mut()[index] = surface);
            }
        }
        scene
    }

    fn paint_walls(&mut self, plan: &Plan, warp: &Warp) {
        if let Some(floor) = &plan.floor {
            return self.paint_floor(floor, warp);
        }
        for tile in &plan.tiles {
            let around = Solid::rect(tile.outer.grown(plan.outer_wall_m));
            self.fill(&around, warp, |scene, index| scene.surface.values_mut()[index] = Surface::Wall);
        }
        for tile in &plan.tiles {
            self.open(&tile.inner, tile.space, warp);
        }
        for contact in plan.contacts() {
            let [a, b] = contact.tiles.map(|tile| plan.tiles[tile].space);
            if a == b {
                self.open(&Rect::along(contact.wall, contact.along, contact.across), a, warp);
            }
        }
        for pane in &plan.panes {
            self.fill(&Solid::rect(*pane), warp, |scene, index| {
                if scene.surface.values()[index] == Surface::Wall {
                    scene.surface.values_mut()[index] = Surface::Glass;
                }
            });
        }
    }

    /// Looks up every fine cell in the floor of a surveyed building.
    fn paint_floor(&mut self, floor: &Floor, warp: &Warp) {
        for index in 0..self.surface.values().len() {
            match floor.at(warp.plan_from_world(self.center(self.surface.cell(index)))) {
                Ground::Outside => {}
                Ground::Wall => self.surface.values_mut()[index] = Surface::Wall,
                Ground::Space(space) => self.space.values_mut()[index] = space as u16 + 1,
            }
        }
    }

    fn paint_openings(&mut self, plan: &Plan, warp: &Warp) {
        for (number, opening) in plan.openings.iter().enumerate() {
            self.fill(&opening.solid(opening.gap.grown(1e-3)), warp, |scene, index| {
                scene.surface.values_mut()[index] = Surface::Open;
            });
            self.fill(&opening.solid(opening.strip()), warp, |scene, index| {
                scene.opening.values_mut()[index] = number as u16 + 1;
            });
        }
        for solid in plan.openings.iter().flat_map(|opening| &opening.leaves) {
            self.fill(solid, warp, |scene, index| scene.surface.values_mut()[index] = Surface::Leaf);
        }
    }

    fn open(&mut self, rect: &Rect, space: usize, warp: &Warp) {
        self.fill(&Solid::rect(*rect), warp, |scene, index| {
            scene.surface.values_mut()[index] = Surface::Open;
            scene.space.values_mut()[index] = space as u16 + 1;
        });
    }

    /// Calls `paint` for every cell whose center lies in `solid`.
    fn fill(&mut self, solid: &Solid, warp: &Warp, mut paint: impl FnMut(&mut Self, usize)) {
        let bounds = world_bounds(&solid.bounds(), warp).grown(self.cell_m);
        let low = |v: f64, from: f64| ((v - from) / self.cell_m).floor().max(0.0) as u32;
        let (x0, y0) = (low(bounds.min.x, self.origin.x), low(bounds.min.y, self.origin.y));
        let x1 = low(bounds.max.x, self.origin.x).min(self.surface.width() - 1);
        let y1 = low(bounds.max.y, self.origin.y).min(self.surface.height() - 1);
        for y in y0..=y1 {
            for x in x0..=x1 {
                let cell = Cell::new(x, y);
                if solid.contains(warp.plan_from_world(self.center(cell))) {
                    let index = self.surface.index(cell);
                    paint(self, index);
                }
            }
        }
    }

    /// Scatters things outside that stop the rays that leave through glass.
    pub(crate) fn plant_outside(&mut self, dice: &mut Dice) {
        let n = dice.count(20, 150);
        for _ in 0..n {
            let (width, height) = (self.surface.width() as usize, self.surface.height() as usize);
            let at = self.center(Cell::new(dice.below(width) as u32, dice.below(height) as u32));
            let (radius, turn) = (dice.between(0.1, 1.0), heading(dice.between(0.0, std::f64::consts::TAU)));
            let stand = crate::shape::Stand { at, forward: turn };
            let solid = stand.rect(Rect::new(-radius, -0.2, radius, 0.2));
            let taken = |scene: &Self, index: usize| {
                scene.space.values()[index] != 0 || scene.surface.values()[index] != Surface::Open
            };
            self.fill(&solid, &Warp::none(), |scene, index| {
                if !taken(scene, index) && scene.opening.values()[index] == 0 {
                    scene.surface.values_mut()[index] = Surface::Outside;
                }
            });
        }
    }

    /// Center of a fine cell in the world.
    pub(crate) fn center(&self, cell: Cell) -> Point2 {
        let at = |k: u32, from: f64| from + (f64::from(k) + 0.5) * self.cell_m;
        Point2::new(at(cell.x, self.origin.x), at(cell.y, self.origin.y))
    }

    /// The fine cell at `point` of the world, if it is on the grid.
    pub(crate) fn cell_at(&self, point: Point2) -> Option<Cell> {
        let (x, y) = ((point.x - self.origin.x) / self.cell_m, (point.y - self.origin.y) / self.cell_m);
        let on_grid = x >= 0.0
            && y >= 0.0
            && x < f64::from(self.surface.width())
            && y < f64::from(self.surface.height());
        on_grid.then(|| Cell::new(x as u32, y as u32))
    }

    /// Whether nothing stands at the fine cell and it belongs to the building.
    pub(crate) fn is_floor(&self, index: usize) -> bool {
        self.surface.values()[index] == Surface::Open
            && (self.space.values()[index] != 0 || self.opening.values()[index] != 0)
    }
}

/// The rectangle in the world around a rectangle of the plan.
fn world_bounds(rect: &Rect, warp: &Warp) -> Rect {
    let n = 1 + (rect.width().max(rect.height()) / 2.0) as usize;
    let at = |low: f64, high: f64, k: usize| low + (high - low) * k as f64 / n as f64;
    let edge = (0..=n).flat_map(|k| {
        let (x, y) = (at(rect.min.x, rect.max.x, k), at(rect.min.y, rect.max.y, k));
        [
            Point2::new(x, rect.min.y),
            Point2::new(x, rect.max.y),
            Point2::new(rect.min.x, y),
            Point2::new(rect.max.x, y),
        ]
    });
    let mut corners = edge.map(|point| warp.world_from_plan(point));
    let first = corners.next().unwrap_or_default();
    let bounds = corners.fold(Rect { min: first, max: first }, |Rect { min, max }, p| {
        Rect::new(min.x.min(p.x), min.y.min(p.y), max.x.max(p.x), max.y.max(p.y))
    });
    // Between the samples a bent edge bulges by less than this.
    bounds.grown(if n > 1 { 0.2 } else { 0.0 })
}
