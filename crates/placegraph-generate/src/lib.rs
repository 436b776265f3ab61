//! Generated buildings with perfect ground truth, and what a robot with a laser makes of them.
//!
//! [`generate`] draws a floor plan in a [`Style`], furnishes it, lets a simulated robot map it (or draws it
//! cleanly, see [`Mapping`]) and looks up the class and the room of every free cell; [`files`] turns the result
//! into the files of a labeled map. `docs/generated-buildings.md` tells the dimensions and the conventions.
//!
//! A building depends on (style, seed, index) and the options only: it has the same bytes on every platform and
//! for any number of threads that make several at once.

mod dice;
mod drawing;
mod files;
mod floor;
mod furnish;
mod laser;
mod layout;
mod mapper;
mod plan;
mod ray;
mod record;
mod scene;
mod shape;
mod style;
mod survey;
mod tour;
mod truth;
mod warp;

use std::num::NonZeroUsize;
use std::str::FromStr;

use placegraph::geom::Pose2;
use placegraph::grid::{Cell, Grid, MapFrame, Occupancy, OccupancyGrid};

use crate::dice::Dice;
use crate::furnish::Care;
use crate::mapper::Explored;
use crate::scene::Scene;
use crate::truth::Truth;
use crate::warp::Warp;

pub use files::{FilesError, files, map_files};
pub use floor::Floor;
pub use plan::{Opening, OpeningKind, Plan, STRAIGHT, Space, SpaceClass, Tile, Usage};
pub use record::{OpeningRecord, Record, SpaceRecord};
pub use shape::{Axis, Rect, Solid};
pub use style::{NameError, Style};
pub use survey::{Survey, SurveyError, read_flat, read_plan_xml};
pub use truth::{AMBIGUOUS, CORRIDOR, DOORWAY, Edge, Graph, Node, ROOM};

/// How the map of a building comes about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mapping {
    /// A robot drives through and maps what its laser sees.
    Slam,
    /// A drawing without furniture.
    Clean,
    /// A drawing with furniture.
    Furnished,
    /// Any of the others, most often the robot.
    #[default]
    Mixed,
}

impl Mapping {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Slam, Self::Clean, Self::Furnished, Self::Mixed];

    /// Name for people and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slam => "slam",
            Self::Clean => "clean",
            Self::Furnished => "furnished",
            Self::Mixed => "mixed",
        }
    }
}

impl FromStr for Mapping {
    type Err = NameError;
    fn from_str(name: &str) -> Result<Self, NameError> {
        style::by_name(&Self::ALL, Self::name, name)
    }
}

/// What else to choose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// How the map comes about.
    pub mapping: Mapping,
    /// Side of a cell in meters, 0.02 to 0.2; drawn per building if absent.
    pub resolution_m: Option<f64>,
}

/// A building, its map and the truth of the map.
#[derive(Clone, Debug)]
pub struct Building {
    /// The style, never [`Style::Mixed`]; `None` of a surveyed building.
    pub style: Option<Style>,
    /// How the map came about, never [`Mapping::Mixed`].
    pub mapping: Mapping,
    /// Where the floor plan comes from.
    pub source: String,
    /// What one may do with it, if that is known.
    pub license: Option<String>,
    /// The map.
    pub map: OccupancyGrid,
    /// One of [`CORRIDOR`], [`ROOM`], [`DOORWAY`], [`AMBIGUOUS`] in free cells, 0 in all others.
    pub labels: Grid<u8>,
    /// Index of the space plus 1 in free cells, 0 in others and where a doorway is cut.
    pub rooms: Grid<u16>,
    /// Mapped rooms and the openings between them.
    pub graph: Graph,
    /// All openings and spaces as objects.
    pub record: Record,
    /// The floor plan, straight and in its own frame.
    pub plan: Plan,
}

/// Building `index` of the series `seed` in `style`.
///
/// Cost: for a robot's map a few hundred scans of some hundred beams, about a quarter of a second for 40 m by
/// 20 m at 0.05 m.
///
/// # Examples
/// ```
/// use placegraph_generate::{Mapping, Options, Style, generate};
///
/// let options = Options { mapping: Mapping::Clean, resolution_m: Some(0.1) };
/// let home = generate(Style::Home, 1, 0, &options);
/// assert!(home.labels.values().contains(&placegraph_generate::DOORWAY));
/// ```
///
/// # Panics
/// If the resolution is not within 0.02 to 0.2 meters.
pub fn generate(style: Style, seed: u64, index: u64, options: &Options) -> Building {
    drawn(style, seed, index, options, None).0
}

/// A building drawn in `style`, and how its map grew.
fn drawn(
    style: Style,
    seed: u64,
    index: u64,
    options: &Options,
    every: Option<NonZeroUsize>,
) -> (Building, Vec<OccupancyGrid>) {
    let number = Style::ALL.iter().position(|&other| other == style).unwrap_or(0) as u64;
    let stream = |purpose| Dice::new(seed, number, index, purpose);
    let mut dice = stream(0);
    let style = match style {
        Style::Mixed => dice.weighted(&[
            (Style::Office, 4.0),
            (Style::Home, 2.0),
            (Style::Hospital, 1.0),
            (Style::Hotel, 1.0),
            (Style::School, 1.0),
            (Style::Warehouse, 0.5),
        ]),
        style => style,
    };
    let mut plan = layout::lay_out(style, &mut dice);
    let care = if style.is_plain() { Care::PLAIN } else { Care::draw(&mut dice) };
    furnish::furnish(&mut plan, care, &mut dice);
    let warp = Warp::draw(&plan.bounds(), &mut dice);
    let source = format!("placegraph generate, style {}, seed {seed}, building {index}", style.name());
    let (mut building, growing) = mapped(plan, &warp, stream(1), options, every);
    (building.style, building.source) = (Some(style), source);
    building.license = Some(env!("CARGO_PKG_LICENSE").to_owned());
    (building, growing)
}

/// Building `index` of the series `seed` that a robot maps, or an architect draws, of the surveyed building called `name`.
///
/// Thickness of the walls, widths and leaves of doors, furniture, warp and mapping are drawn; what `name`, `seed`, `index`
/// and `options` are decides them.
///
/// # Errors
/// If fewer than two spaces are connected.
///
/// # Panics
/// If the resolution is not within 0.02 to 0.2 meters.
pub fn generate_surveyed(
    survey: &Survey,
    name: &str,
    seed: u64,
    index: u64,
    options: &Options,
) -> Result<Building, SurveyError> {
    // 64-bit FNV-1a; numbers of styles are small.
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let stream = |purpose| Dice::new(seed, hash, index, purpose);
    let mut dice = stream(0);
    let mut plan = survey::lay_out(survey, &mut dice)?;
    let care = Care::draw(&mut dice);
    furnish::furnish(&mut plan, care, &mut dice);
    let warp = Warp::draw(&plan.bounds(), &mut dice);
    let (building, _) = mapped(plan, &warp, stream(1), options, None);
    Ok(Building { source: name.to_owned(), ..building })
}

/// As [`generate`] with [`Mapping::Slam`], and the map as it was after every `every` scans of the robot. Each is cropped to what is
/// known, and stands where it belongs in the map frame.
///
/// # Panics
/// If the resolution is not within 0.02 to 0.2 meters.
pub fn generate_growing(
    style: Style,
    seed: u64,
    index: u64,
    resolution_m: Option<f64>,
    every: NonZeroUsize,
) -> (Building, Vec<OccupancyGrid>) {
    let options = Options { mapping: Mapping::Slam, resolution_m };
    drawn(style, seed, index, &options, Some(every))
}

/// The building as the options say that it is mapped, and how its map grew.
fn mapped(
    mut plan: Plan,
    warp: &Warp,
    mut dice: Dice,
    options: &Options,
    every: Option<NonZeroUsize>,
) -> (Building, Vec<OccupancyGrid>) {
    let mapping = match options.mapping {
        Mapping::Mixed => {
            dice.weighted(&[(Mapping::Slam, 6.0), (Mapping::Clean, 1.0), (Mapping::Furnished, 1.0)])
        }
        mapping => mapping,
    };
    let drawn_m = dice.weighted(&[(0.05, 6.0), (0.025, 1.0), (0.02, 0.5), (0.04, 0.5), (0.1, 1.0)]);
    let cell_m = options.resolution_m.unwrap_or(drawn_m);
    assert!((0.02..=0.2).contains(&cell_m), "expected a resolution of 0.02 to 0.2 m, found {cell_m}");
    let per_cell = (cell_m / 0.026).ceil() as u32;
    if mapping != Mapping::Slam {
        open_all(&mut plan);
        plan.openings.iter_mut().for_each(|opening| opening.leaves.clear());
        if mapping == Mapping::Clean {
            plan.furniture.clear();
        }
    }
    let mut attempt = 0;
    loop {
        let fine_m = cell_m / f64::from(per_cell);
        let (scene, explored) = map_of(&plan, warp, mapping, fine_m, per_cell, every, &mut dice);
        let margin = (dice.pick(&[0.1, 0.5, 2.0, 6.0]) * dice.between(0.5, 1.5) / cell_m).ceil() as i64;
        let map = cropped(&explored.map, &scene, cell_m, margin);
        let Truth { labels, rooms, graph } = truth::look_up(&plan, warp, &scene, &map.cells, &map.frame);
        attempt += 1;
        if attempt == ATTEMPTS || is_worth_keeping(&plan, &labels, &graph, cell_m) {
            let record = record::of(&plan, warp, &map, &rooms);
            let (style, source, license) = (None, String::new(), None);
            let growing = explored.growing.iter().map(|cells| cropped(cells, &scene, cell_m, 1)).collect();
            let building =
                Building { style, mapping, source, license, map, labels, rooms, graph, record, plan };
            return (building, growing);
        }
        open_all(&mut plan);
    }
}

/// Times that a robot starts out before its map is taken as it is.
const ATTEMPTS: usize = 4;

/// The scene that stands there for a map, and the cells of the map over the same ground.
fn map_of(
    plan: &Plan,
    warp: &Warp,
    mapping: Mapping,
    fine_m: f64,
    per_cell: u32,
    every: Option<NonZeroUsize>,
    dice: &mut Dice,
) -> (Scene, Explored) {
    let margin_m = if mapping == Mapping::Slam && !plan.panes.is_empty() { 3.5 } else { 1.0 };
    let mut scene = Scene::paint(plan, warp, fine_m, margin_m);
    let explored = if mapping == Mapping::Slam {
        scene.plant_outside(dice);
        mapper::explore(plan, &scene, fine_m * f64::from(per_cell), every, dice)
    } else {
        Explored { map: drawing::draw(&scene, per_cell, dice), growing: Vec::new() }
    };
    (scene, explored)
}

/// Whether the robot came far enough: it saw a third of the floor, and a few doors.
fn is_worth_keeping(plan: &Plan, labels: &Grid<u8>, graph: &Graph, cell_m: f64) -> bool {
    let known = labels.values().iter().filter(|&&label| label == CORRIDOR || label == ROOM).count();
    graph.edges.len() >= 2 && known as f64 * cell_m * cell_m > 0.35 * plan.floor_m2()
}

/// Opens all closed doors.
fn open_all(plan: &mut Plan) {
    for opening in plan.openings.iter_mut().filter(|opening| opening.closed) {
        opening.leaves.clear();
        opening.closed = false;
    }
}

/// The map with `margin` unknown cells around what is known, where it stands in the map frame.
fn cropped(cells: &Grid<Occupancy>, scene: &Scene, cell_m: f64, margin: i64) -> OccupancyGrid {
    let (mut min, mut max) = ((i64::MAX, i64::MAX), (0, 0));
    for cell in cells.cells().filter(|&cell| cells[cell] != Occupancy::Unknown) {
        let (x, y) = (i64::from(cell.x), i64::from(cell.y));
        min = (min.0.min(x), min.1.min(y));
        max = (max.0.max(x), max.1.max(y));
    }
    if min.0 > max.0 {
        min = (0, 0);
    }
    let (x0, y0) = (min.0 - margin, min.1 - margin);
    let (width, height) = ((max.0 + margin + 1 - x0) as u32, (max.1 + margin + 1 - y0) as u32);
    let values = (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).map(move |x| (x + x0, y + y0)));
    let values = values.map(|(x, y)| {
        let on_grid = x >= 0 && y >= 0 && x < i64::from(cells.width()) && y < i64::from(cells.height());
        if on_grid { cells[Cell::new(x as u32, y as u32)] } else { Occupancy::Unknown }
    });
    let values = values.collect();
    let origin = Pose2::new(scene.origin.x + x0 as f64 * cell_m, scene.origin.y + y0 as f64 * cell_m, 0.0);
    #[expect(clippy::expect_used, reason = "the resolution was checked and the origin is finite")]
    let frame = MapFrame::new(cell_m, origin).expect("a frame");
    OccupancyGrid { frame, cells: Grid::from_rows(width, height, values) }
}
