//! Buildings that somebody surveyed: spaces, walls and doors are read and not drawn by chance. Walls get a thickness,
//! doors a width and leaves; then they are furnished and mapped as generated buildings are.

mod flats;
mod layout;
mod plan_xml;

use placegraph::geom::{Point2, Vec2};

use crate::plan::Usage;
use crate::shape::Rect;

pub use flats::read_flat;
pub(crate) use layout::lay_out;
pub use plan_xml::read_plan_xml;

/// Where a space lies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outline {
    /// Inside a polygon, of which the edges are walls.
    Polygon(Vec<Point2>),
    /// Around a point, up to the walls.
    Around(Point2),
}

/// A space of the survey.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurveyedSpace {
    /// `None` for balconies and shafts: nobody enters them.
    pub(crate) usage: Option<Usage>,
    pub(crate) outline: Outline,
}

/// A connection between two spaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurveyedDoor {
    /// Its middle.
    pub(crate) at: Point2,
    /// Direction of the wall.
    pub(crate) along: Vec2,
    /// Clear width, if the survey says it.
    pub(crate) width_m: Option<f64>,
    /// Two leaves.
    pub(crate) is_double: bool,
    /// Two spaces meet here without a door.
    pub(crate) is_open: bool,
}

/// A surveyed building, in meters, y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    pub(crate) spaces: Vec<SurveyedSpace>,
    /// Walls beside the edges of polygons.
    pub(crate) walls: Vec<[Point2; 2]>,
    pub(crate) doors: Vec<SurveyedDoor>,
    /// Furniture that the survey shows.
    pub(crate) furniture: Vec<Rect>,
    /// Whether the building is a home.
    pub(crate) is_home: bool,
}

/// Why a survey is of no use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurveyError {
    /// The text is not of the format.
    #[error("expected {expected}: {message}")]
    Text {
        /// The format.
        expected: &'static str,
        /// What the parser says.
        message: String,
    },
    /// The building has no scale, or one that cannot be.
    #[error("expected a scale that makes a building of 5 to 400 m, found {found}")]
    Scale {
        /// What there is.
        found: String,
    },
    /// There is more of something than a building has.
    #[error("expected at most {most} spaces, walls and doors, found {found}")]
    TooMany {
        /// The limit.
        most: usize,
        /// How many there are.
        found: usize,
    },
    /// Fewer than two spaces with a connection between them are left.
    #[error("expected at least two spaces with a door between them")]
    Empty,
}

/// Most spaces, and most corners, walls and doors, of a building.
const MOST: usize = 20_000;

impl SurveyError {
    fn text(expected: &'static str, message: &impl ToString) -> Self {
        Self::Text { expected, message: message.to_string() }
    }
}

impl Survey {
    /// Checks that numbers are finite, there are not too many, and the building has a size that buildings have, and moves it to the origin.
    fn checked(mut self) -> Result<Self, SurveyError> {
        let polygons = self.spaces.iter().flat_map(|space| match &space.outline {
            Outline::Polygon(points) => points.as_slice(),
            Outline::Around(point) => std::slice::from_ref(point),
        });
        let points: Vec<Point2> = polygons.chain(self.walls.iter().flatten()).copied().collect();
        let found = points.len().max(self.spaces.len()).max(self.doors.len());
        if found > MOST {
            return Err(SurveyError::TooMany { most: MOST, found });
        }
        let first = *points.first().ok_or(SurveyError::Empty)?;
        let around = points.iter().fold(Rect { min: first, max: first }, |Rect { min, max }, p| {
            Rect::new(min.x.min(p.x), min.y.min(p.y), max.x.max(p.x), max.y.max(p.y))
        });
        let is_finite = points.iter().all(|point| point.x.is_finite() && point.y.is_finite());
        let size = (around.width().max(around.height()), around.width().min(around.height()));
        if !is_finite || !(5.0..400.0).contains(&size.0) || size.1 < 2.0 {
            let found = format!("{} m x {} m", around.width(), around.height());
            return Err(SurveyError::Scale { found });
        }
        let Point2 { x, y } = around.min;
        let moved = |point: &mut Point2| *point = Point2::new(point.x - x, point.y - y);
        for space in &mut self.spaces {
            match &mut space.outline {
                Outline::Polygon(points) => points.iter_mut().for_each(moved),
                Outline::Around(point) => moved(point),
            }
        }
        self.walls.iter_mut().flatten().for_each(moved);
        self.doors.iter_mut().for_each(|door| moved(&mut door.at));
        for Rect { min, max } in &mut self.furniture {
            moved(min);
            moved(max);
        }
        Ok(self)
    }
}

/// The unit vector from `a` to `b`; along x if they are one point.
fn direction(a: Point2, b: Point2) -> Vec2 {
    let (offset, length) = (b - a, a.distance(b));
    if length > 1e-9 { offset * (1.0 / length) } else { Vec2::new(1.0, 0.0) }
}
