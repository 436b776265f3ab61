//! The kinds of buildings, and their dimensions (`docs/generated-buildings.md` names the standards).

use std::str::FromStr;

use crate::plan::Usage;

/// A kind of building.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Offices, laboratories, meeting rooms along corridors; cubicles; open-plan floors.
    Office,
    /// Flats and houses, with or without a hallway.
    Home,
    /// Wards with baths along wide corridors.
    Hospital,
    /// Guest rooms with baths along narrow corridors.
    Hotel,
    /// Classrooms along wide corridors.
    School,
    /// A hall with racks, and offices beside it.
    Warehouse,
    /// Any of the others above.
    Mixed,
    /// Schools and institutes with lobbies that lie open, wide and deep doors, stubs of corridors, frames without a door.
    Campus,
    /// Desks on an open floor around a core.
    OpenOffice,
    /// Flats with narrow hallways, closets, doors flush with the walls beside them and leaves in the way.
    Flat,
}

impl Style {
    /// All styles, in the order of their numbers.
    pub const ALL: [Self; 10] = [
        Self::Office,
        Self::Home,
        Self::Hospital,
        Self::Hotel,
        Self::School,
        Self::Warehouse,
        Self::Mixed,
        Self::Campus,
        Self::OpenOffice,
        Self::Flat,
    ];

    /// Whether doors are regular and kept clear.
    pub(crate) fn is_plain(self) -> bool {
        Recipe::of(self).extras.is_none()
    }

    /// Name for people and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::Home => "home",
            Self::Hospital => "hospital",
            Self::Hotel => "hotel",
            Self::School => "school",
            Self::Warehouse => "warehouse",
            Self::Mixed => "mixed",
            Self::Campus => "campus",
            Self::OpenOffice => "open-office",
            Self::Flat => "flat",
        }
    }
}

/// A name that no style or mapping has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected one of {expected}, found {found:?}")]
pub struct NameError {
    /// The names there are.
    pub expected: String,
    /// The name given.
    pub found: String,
}

/// The one of `all` that is called `found`.
pub(crate) fn by_name<T: Copy>(all: &[T], name: fn(T) -> &'static str, found: &str) -> Result<T, NameError> {
    all.iter().copied().find(|&one| name(one) == found).ok_or_else(|| NameError {
        expected: all.iter().map(|&one| name(one)).collect::<Vec<_>>().join(", "),
        found: found.to_owned(),
    })
}

impl FromStr for Style {
    type Err = NameError;
    fn from_str(name: &str) -> Result<Self, NameError> {
        by_name(&Self::ALL, Self::name, name)
    }
}

/// Lengths in meters and shares that a style draws its building from.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    /// Width of corridors, between wall centers.
    pub(crate) corridor: (f64, f64),
    /// Depth of a row of rooms.
    pub(crate) depth: (f64, f64),
    /// Length of a wing.
    pub(crate) wing: (f64, f64),
    /// How many columns of blocks, and how many rows, at most.
    pub(crate) blocks: [usize; 2],
    /// Clear width of single doors.
    pub(crate) door: (f64, f64),
    /// Share of double doors.
    pub(crate) double_doors: f64,
    /// Share of doors between neighboring rooms.
    pub(crate) inner_doors: f64,
    /// Share of rooms with a bath in the corner.
    pub(crate) baths: f64,
    /// Share of blocks that are one large hall.
    pub(crate) halls: f64,
    /// Share of blocks with nothing to enter: courtyards, shafts.
    pub(crate) voids: f64,
    /// What makes a building irregular.
    pub(crate) extras: Option<Extras>,
    /// What rooms are used for, with the range of their widths and how common they are.
    pub(crate) rooms: &'static [(Usage, (f64, f64), f64)],
}

/// Shares of what the plain styles do not have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extras {
    /// Doors with a jamb in line with a wall beside them.
    pub(crate) flush: f64,
    /// Doors with two leaves, 1.6 to 2.6 m wide.
    pub(crate) wide: f64,
    /// Buildings with walls of 0.4 to 0.9 m along corridors.
    pub(crate) deep_walls: f64,
    /// Rooms beside which a stub of the corridor leads inward.
    pub(crate) stubs: f64,
    /// Rooms with a closet beside their entrance.
    pub(crate) closets: f64,
    /// Large spaces that lie open to their neighbor along the whole wall.
    pub(crate) open_fronts: f64,
    /// Stretches of corridor that taper.
    pub(crate) tapers: f64,
    /// Stretches of corridor with a frame and no door.
    pub(crate) frames: f64,
    /// Doors that stand ajar.
    pub(crate) ajar: f64,
}

const OFFICE_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Office, (2.4, 4.2), 5.0),
    (Usage::Office, (4.0, 6.5), 3.0),
    (Usage::Meeting, (3.5, 8.0), 1.5),
    (Usage::Laboratory, (5.0, 10.0), 1.2),
    (Usage::Storage, (1.6, 3.0), 0.7),
    (Usage::Toilet, (2.4, 4.0), 0.6),
    (Usage::Kitchen, (2.4, 4.0), 0.4),
    (Usage::OpenPlan, (8.0, 14.0), 0.5),
];
const HOSPITAL_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Ward, (3.6, 5.0), 5.0),
    (Usage::Ward, (5.5, 8.0), 2.0),
    (Usage::Office, (2.8, 4.5), 2.0),
    (Usage::Laboratory, (4.0, 7.0), 1.0),
    (Usage::Storage, (1.8, 3.5), 1.0),
    (Usage::Toilet, (2.0, 3.0), 0.7),
    (Usage::Meeting, (4.0, 6.0), 0.5),
];
const HOTEL_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Bedroom, (3.4, 4.4), 8.0),
    (Usage::Bedroom, (4.5, 6.5), 1.0),
    (Usage::Storage, (1.8, 3.0), 0.7),
    (Usage::Meeting, (6.0, 9.0), 0.2),
];
const SCHOOL_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Classroom, (7.0, 10.0), 5.0),
    (Usage::Office, (3.0, 5.0), 1.3),
    (Usage::Laboratory, (8.0, 11.0), 0.8),
    (Usage::Toilet, (3.0, 5.0), 0.8),
    (Usage::Storage, (2.0, 4.0), 0.8),
    (Usage::Meeting, (4.0, 7.0), 0.5),
];
const DEPOT_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Office, (2.8, 5.0), 4.0),
    (Usage::Meeting, (4.0, 6.0), 1.0),
    (Usage::Toilet, (2.4, 4.0), 0.8),
    (Usage::Kitchen, (3.0, 4.5), 0.8),
    (Usage::Storage, (2.0, 4.0), 0.8),
];
const CORE_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Office, (2.4, 4.5), 3.0),
    (Usage::Meeting, (3.5, 7.0), 2.0),
    (Usage::Toilet, (2.4, 4.5), 1.2),
    (Usage::Storage, (1.8, 3.5), 1.2),
    (Usage::Kitchen, (2.4, 4.5), 0.8),
];
const FLAT_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Bedroom, (2.4, 4.0), 4.0),
    (Usage::Bath, (1.4, 2.4), 1.5),
    (Usage::Kitchen, (1.8, 3.4), 1.2),
    (Usage::Living, (3.5, 5.5), 1.0),
    (Usage::Storage, (1.1, 1.8), 0.8),
];
const HOME_ROOMS: &[(Usage, (f64, f64), f64)] = &[
    (Usage::Bedroom, (2.5, 4.5), 4.0),
    (Usage::Bath, (1.6, 2.6), 1.5),
    (Usage::Kitchen, (2.2, 3.8), 1.0),
    (Usage::Living, (3.8, 6.0), 1.0),
    (Usage::Storage, (1.2, 2.0), 0.7),
];

impl Recipe {
    /// The dimensions of `style`; [`Style::Mixed`] stands for an office here.
    pub(crate) fn of(style: Style) -> Self {
        let office = Self {
            corridor: (1.5, 3.2),
            depth: (3.8, 7.0),
            wing: (10.0, 30.0),
            blocks: [3, 3],
            door: (0.8, 1.1),
            double_doors: 0.1,
            inner_doors: 0.15,
            baths: 0.04,
            halls: 0.14,
            voids: 0.07,
            extras: None,
            rooms: OFFICE_ROOMS,
        };
        match style {
            Style::Office | Style::Mixed => office,
            Style::Home => Self {
                corridor: (1.1, 1.7),
                depth: (2.6, 4.6),
                wing: (6.0, 10.0),
                blocks: [2, 2],
                door: (0.7, 0.95),
                double_doors: 0.05,
                inner_doors: 0.1,
                baths: 0.05,
                halls: 0.0,
                voids: 0.06,
                extras: None,
                rooms: HOME_ROOMS,
            },
            Style::Hospital => Self {
                corridor: (2.3, 3.2),
                depth: (4.5, 7.5),
                door: (1.0, 1.35),
                double_doors: 0.2,
                baths: 0.4,
                rooms: HOSPITAL_ROOMS,
                ..office
            },
            Style::Hotel => Self {
                corridor: (1.5, 2.2),
                depth: (5.5, 8.0),
                wing: (16.0, 36.0),
                blocks: [2, 3],
                door: (0.8, 0.95),
                double_doors: 0.03,
                inner_doors: 0.06,
                baths: 0.85,
                halls: 0.08,
                rooms: HOTEL_ROOMS,
                ..office
            },
            Style::School => Self {
                corridor: (2.2, 4.2),
                depth: (6.5, 9.0),
                wing: (18.0, 36.0),
                blocks: [2, 3],
                door: (0.85, 1.1),
                double_doors: 0.2,
                inner_doors: 0.12,
                baths: 0.0,
                rooms: SCHOOL_ROOMS,
                ..office
            },
            Style::Warehouse => Self {
                corridor: (1.4, 2.2),
                depth: (3.5, 5.5),
                wing: (18.0, 40.0),
                blocks: [1, 2],
                rooms: DEPOT_ROOMS,
                ..office
            },
            Style::Campus | Style::OpenOffice | Style::Flat => Self::irregular(style, &office),
        }
    }

    /// The dimensions of a style with extras; any other style stands for a flat here.
    fn irregular(style: Style, office: &Self) -> Self {
        match style {
            Style::Campus => Self {
                corridor: (1.8, 4.2),
                depth: (5.0, 9.0),
                wing: (16.0, 36.0),
                blocks: [2, 3],
                door: (0.8, 1.15),
                double_doors: 0.15,
                inner_doors: 0.2,
                halls: 0.3,
                extras: Some(Extras {
                    flush: 0.35,
                    wide: 0.12,
                    deep_walls: 0.5,
                    stubs: 0.12,
                    closets: 0.05,
                    open_fronts: 0.5,
                    tapers: 0.2,
                    frames: 0.3,
                    ajar: 0.3,
                }),
                rooms: SCHOOL_ROOMS,
                ..office.clone()
            },
            Style::OpenOffice => Self {
                depth: (3.0, 5.0),
                inner_doors: 0.2,
                baths: 0.0,
                extras: Some(Extras {
                    flush: 0.3,
                    wide: 0.08,
                    deep_walls: 0.2,
                    stubs: 0.0,
                    closets: 0.1,
                    open_fronts: 0.1,
                    tapers: 0.1,
                    frames: 0.1,
                    ajar: 0.2,
                }),
                rooms: CORE_ROOMS,
                ..office.clone()
            },
            _ => Self {
                corridor: (0.95, 1.5),
                depth: (2.4, 4.4),
                wing: (5.0, 9.0),
                blocks: [2, 2],
                door: (0.68, 0.9),
                double_doors: 0.06,
                inner_doors: 0.15,
                baths: 0.0,
                halls: 0.0,
                voids: 0.05,
                extras: Some(Extras {
                    flush: 0.5,
                    wide: 0.06,
                    deep_walls: 0.1,
                    stubs: 0.15,
                    closets: 0.25,
                    open_fronts: 0.15,
                    tapers: 0.05,
                    frames: 0.05,
                    ajar: 0.4,
                }),
                rooms: FLAT_ROOMS,
            },
        }
    }
}
