//! A building is mapped again: with noise, on a grid that begins elsewhere, with a room more. Places keep their names.

use std::fs;
use std::path::{Path, PathBuf};

use crate::running::{done, json, shipped};
use image::{GrayImage, Luma};
use placegraph::export::TopologyDocument;
use placegraph::grid::Cell;
use placegraph::topology::{Place, PlaceRaster};
use serde_json::Value;
use tempfile::TempDir;

const FREE: u8 = 254;
const OCCUPIED: u8 = 0;
const UNKNOWN: u8 = 205;
const RESOLUTION_M: f64 = 0.05;
/// How many cells the face of a straight wall varies.
const FACE: u32 = 4;

/// A map_server map: its picture, and where the lower left corner of that lies.
#[derive(Clone)]
struct Map {
    picture: GrayImage,
    origin: [f64; 2],
}

impl Map {
    fn shipped(name: &str) -> Self {
        let yaml = fs::read_to_string(shipped(&format!("{name}/map.yaml"))).unwrap();
        let origin = yaml.lines().find_map(|line| line.strip_prefix("origin: ")).unwrap();
        let [x, y, _]: [f64; 3] = serde_json::from_str(origin).unwrap();
        let picture = image::open(shipped(&format!("{name}/map.png"))).unwrap().into_luma8();
        Self { picture, origin: [x, y] }
    }

    fn write(&self, folder: &Path, name: &str) -> PathBuf {
        self.picture.save(folder.join(format!("{name}.png"))).unwrap();
        let path = folder.join(format!("{name}.yaml"));
        let [x, y] = self.origin;
        let text = format!(
            "image: {name}.png\nresolution: {RESOLUTION_M}\norigin: [{x}, {y}, 0.0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        );
        fs::write(&path, text).unwrap();
        path
    }

    /// One in 3000 free cells, one on every 7.5 m², is occupied or unknown now, and one in 12 cells of a wall's face is free where
    /// that opens no way through the wall.
    fn noisy(&self, draw: u64) -> Self {
        let mut state = 0x9e37_79b9_7f4a_7c15u64 ^ (draw * 0x1234_5678_9abc_def1);
        let mut one_in = |n: u64| {
            // xorshift [Marsaglia 2003].
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            state.is_multiple_of(n)
        };
        let mut noisy = self.clone();
        for (x, y, pixel) in self.picture.enumerate_pixels() {
            match pixel.0[0] {
                FREE if one_in(3000) => {
                    noisy.picture.put_pixel(x, y, Luma([if one_in(2) { OCCUPIED } else { UNKNOWN }]));
                }
                OCCUPIED if noisy.is_face(x, y) && one_in(12) => noisy.picture.put_pixel(x, y, Luma([FREE])),
                _ => {}
            }
        }
        noisy
    }

    /// Whether what is free around a cell all lies on one side of it.
    fn is_face(&self, x: u32, y: u32) -> bool {
        let is_free = |dx: i32, dy: i32| {
            let at = (x.checked_add_signed(dx), y.checked_add_signed(dy));
            let pixel = at.0.zip(at.1).and_then(|(x, y)| self.picture.get_pixel_checked(x, y));
            pixel.is_some_and(|pixel| pixel.0[0] == FREE)
        };
        let around =
            || (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))).filter(|&(dx, dy)| is_free(dx, dy));
        let sides = [(0, 1), (0, -1), (1, 0), (-1, 0)];
        sides.iter().any(|&(sx, sy)| is_free(sx, sy) && around().all(|(dx, dy)| dx * sx + dy * sy > 0))
    }

    /// The same building on a grid that begins 37 columns further left, 12 rows further up, and four tenths of a cell off.
    fn on_another_grid(&self) -> Self {
        let (left, down) = (37, 12);
        let (width, height) = self.picture.dimensions();
        let picture = GrayImage::from_fn(width + left, height - down, |x, y| {
            if x < left { Luma([UNKNOWN]) } else { *self.picture.get_pixel(x - left, y) }
        });
        let origin = [
            self.origin[0] - (left as f64 + 0.4) * RESOLUTION_M,
            self.origin[1] + (down as f64 + 0.4) * RESOLUTION_M,
        ];
        Self { picture, origin }
    }

    /// A room of 4 by 3.5 m more, behind a door of 0.9 m in a straight piece of wall on the right.
    fn with_a_room_more(&self) -> Self {
        let (width, height) = self.picture.dimensions();
        let (room_width, room_height, door) = (80, 70, 18);
        let margin = room_width + 20;
        let door_from = (room_height - door) / 2;
        let mut picture = GrayImage::from_pixel(width + margin, height, Luma([UNKNOWN]));
        image::imageops::replace(&mut picture, &self.picture, 0, 0);
        let last_free = |y: u32| (0..width).rev().find(|&x| self.picture.get_pixel(x, y).0[0] == FREE);
        // The rightmost straight face that a room has place beside.
        let face = |top: u32| {
            let beside: Vec<Option<u32>> = (top..top + room_height).map(last_free).collect();
            let right = beside.iter().copied().flatten().max()?;
            let at_door = &beside[door_from as usize..(door_from + door) as usize];
            let is_straight = at_door.iter().all(|x| x.is_some_and(|x| x + FACE >= right));
            is_straight.then_some((right, top))
        };
        let (right, top) = (1..height - room_height - 1).filter_map(face).max().expect("a straight wall");
        let mut fill = |x: u32, y: u32, columns: u32, rows: u32, value: u8| {
            for y in y..y + rows {
                for x in x..x + columns {
                    picture.put_pixel(x, y, Luma([value]));
                }
            }
        };
        fill(right + 3, top - 1, room_width + 4, room_height + 2, OCCUPIED);
        fill(right + 5, top + 1, room_width, room_height - 2, FREE);
        let door_top = top + door_from;
        // Through the wall, and through what stands out of its face.
        fill(right + 1, door_top - 2, 4, door + 4, OCCUPIED);
        fill(right - FACE, door_top, FACE + 5, door, FREE);
        Self { picture, origin: self.origin }
    }
}

/// The result of `map`, with every name made one that no map gives by itself.
fn named(map: &Path, out: &Path) -> PathBuf {
    done(&[&"map", &map, &"--out", &out]);
    let path = out.join("topology.json");
    let mut document: Value = json(&path);
    for place in document["places"].as_array_mut().unwrap() {
        place["name"] = format!("named {}", place["id"]).into();
    }
    fs::write(&path, document.to_string()).unwrap();
    path
}

fn read(path: &Path) -> TopologyDocument {
    TopologyDocument::from_json(&fs::read(path).unwrap()).unwrap()
}

/// Whether the place that has the name of `place` in `later` is there too: it has most of its area, or its middle is less than
/// the width of the door away.
fn kept(place: &Place, earlier: &PlaceRaster, later: &TopologyDocument, raster: &PlaceRaster) -> bool {
    let Some(namesake) = later.places.iter().find(|other| other.name == place.name) else { return false };
    if let (Some(doorway), Some(_)) = (&place.doorway, &namesake.doorway)
        && place.centroid.distance(namesake.centroid) < doorway.width_m
    {
        return true;
    }
    let shape = earlier.shape();
    let cells = (0..shape.height).flat_map(|y| earlier.row(y).iter().map(move |span| (y, span)));
    let own = cells.filter(|(_, span)| span.place == place.id);
    let centers =
        own.flat_map(|(y, span)| (span.start..span.end).map(move |x| shape.frame.center(Cell::new(x, y))));
    let n_shared = centers.filter(|&center| raster.place_at(center) == Some(namesake.id)).count();
    2 * n_shared > place.n_cells as usize
}

/// Labels `later` with the result at `previous`; how many names stayed where they were, and of how many.
fn names_kept(previous: &Path, later: &Path, out: &Path) -> (usize, usize) {
    done(&[&"map", &later, &"--out", &out, &"--previous", &previous]);
    let (before, after) = (read(previous), read(&out.join("topology.json")));
    let [old, new] = [&before, &after]
        .map(|document| PlaceRaster::new(&document.topology(), document.map.shape().unwrap()));
    let missed = before.places.iter().filter(|place| !kept(place, &old, &after, &new));
    let missed: Vec<&Place> = missed.collect();
    for place in &missed {
        println!("  {} ({}, {:.2} m²) lost its name", place.name, place.class, place.area_m2);
    }
    (before.places.len() - missed.len(), before.places.len())
}

#[test]
fn names_stay_when_a_building_is_mapped_again() {
    let (mut n_kept_of_all, mut n_all) = (0, 0);
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    for building in ["home", "office"] {
        let map = Map::shipped(building);
        let previous = named(&map.write(folder.path(), building), &path("before"));
        let changed = [
            ("noise", map.noisy(0)),
            ("noise again", map.noisy(1)),
            ("noise once more", map.noisy(2)),
            ("another grid", map.on_another_grid()),
            ("a room more", map.with_a_room_more()),
            ("all three", map.noisy(3).with_a_room_more().on_another_grid()),
        ];
        for (change, map) in changed {
            let later = map.write(folder.path(), "later");
            let (n_kept, n_places) = names_kept(&previous, &later, &path("after"));
            println!("{building}, {change}: {n_kept} of {n_places} names stay");
            n_kept_of_all += n_kept;
            n_all += n_places;
        }
    }
    println!("{n_kept_of_all} of {n_all} names stay");
    assert!(n_kept_of_all * 100 >= n_all * 95, "{n_kept_of_all} of {n_all}");
}
