//! Where the floors of a site lie upon each other.

use super::SiteFile;
use crate::geom::{Point2, Pose2, Vec2};

/// Lifts may lean by this much before it is remarked, in meters: what drawing a point by hand moves it.
const MAX_LEAN_M: f64 = 1.0;

/// Where every floor's map frame lies in the frame of the site: as the file says; else so that its lifts stand on those of floors that
/// are placed already: by turn and shift where there are two, by a shift where there is one. A floor without either lies like the
/// first. The first floor's frame is that of the site unless its pose says otherwise.
pub(super) fn poses(file: &SiteFile) -> Vec<Pose2> {
    let mut poses: Vec<Option<Pose2>> = file.floors.iter().map(super::Floor::site_from_map).collect();
    poses[0].get_or_insert_default();
    while let Some(index) = next(file, &poses) {
        let pairs = pairs(file, &poses, index);
        poses[index] = Some(fitted(&pairs).or(poses[0]).unwrap_or_default());
    }
    poses.into_iter().map(Option::unwrap_or_default).collect()
}

/// The floor to place next: that with the most lifts in common with those that are placed (ties: the first).
fn next(file: &SiteFile, poses: &[Option<Pose2>]) -> Option<usize> {
    let open = (0..poses.len()).filter(|&index| poses[index].is_none());
    open.min_by_key(|&index| (usize::MAX - pairs(file, poses, index).len(), index))
}

/// The points of lifts on the floor at `index`, in its map frame, and where these lifts are in the frame of the site.
fn pairs(file: &SiteFile, poses: &[Option<Pose2>], index: usize) -> Vec<(Point2, Point2)> {
    let on = |lift: &super::ShaftEntry, index: usize| {
        lift.at.get(&file.floors[index].level).map(|&[x, y]| Point2::new(x, y))
    };
    let placed = |lift: &super::ShaftEntry| {
        poses.iter().enumerate().find_map(|(other, pose)| Some((*pose)?.apply(on(lift, other)?)))
    };
    file.lifts.iter().filter_map(|lift| Some((on(lift, index)?, placed(lift)?))).collect()
}

/// The turn and the shift that lay the first points of `pairs` on the second with the least squares; the shift alone for a single pair.
fn fitted(pairs: &[(Point2, Point2)]) -> Option<Pose2> {
    let n = pairs.len() as f64;
    let mean = |side: fn(&(Point2, Point2)) -> Point2| {
        let sum = pairs.iter().map(side).fold(Vec2::default(), |sum, p| Vec2::new(sum.x + p.x, sum.y + p.y));
        Point2::new(sum.x / n, sum.y / n)
    };
    let (from, to) = (!pairs.is_empty()).then(|| (mean(|pair| pair.0), mean(|pair| pair.1)))?;
    let (mut sin, mut cos) = (0.0, 0.0);
    for &(a, b) in pairs {
        let (a, b) = (a - from, b - to);
        sin += a.cross(b);
        cos += a.dot(b);
    }
    let yaw_rad = if pairs.len() > 1 { sin.atan2(cos) } else { 0.0 };
    let turned = Vec2::new(from.x, from.y).rotated(yaw_rad);
    Some(Pose2::new(to.x - turned.x, to.y - turned.y, yaw_rad))
}

/// What is wrong with the poses: lifts that are elsewhere on another floor.
pub(super) fn remarks(file: &SiteFile, poses: &[Pose2]) -> Vec<String> {
    let mut remarks = Vec::new();
    for lift in &file.lifts {
        let stands = file.floors.iter().zip(poses).filter_map(|(floor, pose)| {
            let [x, y] = *lift.at.get(&floor.level)?;
            Some((&floor.level, pose.apply(Point2::new(x, y))))
        });
        let stands: Vec<_> = stands.collect();
        let Some((first, at)) = stands.first() else { continue };
        for (level, other) in &stands[1..] {
            let lean_m = other.distance(*at);
            if lean_m > MAX_LEAN_M {
                remarks.push(format!(
                    "{} on {level} is {lean_m:.1} m beside where it is on {first}: its points or the poses of the floors do not fit",
                    lift.name
                ));
            }
        }
    }
    remarks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(lifts: &[&str], poses: [&str; 3]) -> SiteFile {
        let floors =
            poses.iter().zip(1..).map(|(pose, n)| format!("[[floor]]\nlevel = {n}\nmap = 'm'\n{pose}\n"));
        let lifts =
            lifts.iter().zip(1..).map(|(at, n)| format!("[[lift]]\nname = 'lift {n}.'\nat = {{{at}}}\n"));
        let text = std::iter::once("name = 's'\n".to_owned()).chain(floors).chain(lifts).collect::<String>();
        SiteFile::from_toml(&text).unwrap()
    }

    #[test]
    fn two_lifts_turn_a_floor_and_one_shifts_it() {
        // Floor 2 is turned by a quarter: its lifts at (1, 0) and (1, 4) stand on (5, 1) and (1, 1). By hand: x' = 5 − y, y' = x.
        let file = file(&["1 = [5, 1], 2 = [1, 0]", "1 = [1, 1], 2 = [1, 4], 3 = [7, 7]"], ["", "", ""]);
        let poses = poses(&file);
        assert_eq!(poses[0], Pose2::default());
        let corner = poses[1].apply(Point2::new(3.0, 2.0));
        assert!(corner.distance(Point2::new(3.0, 3.0)) < 1e-12, "{corner:?}");
        assert_eq!(poses[2], Pose2::new(-6.0, -6.0, 0.0));
        assert!(remarks(&file, &poses).is_empty());
    }

    #[test]
    fn a_pose_of_the_file_stands_and_what_does_not_fit_is_remarked() {
        let file = file(&["1 = [5, 1], 2 = [1, 0]"], ["pose = [1, 0, 0]", "pose = [0, 0, 90]", ""]);
        let poses = poses(&file);
        assert_eq!(poses[0], Pose2::new(1.0, 0.0, 0.0));
        assert_eq!(poses[2], poses[0], "nothing says where the third floor is");
        // (5, 1) is at (6, 1), (1, 0) at (0, 1).
        assert_eq!(
            remarks(&file, &poses),
            [
                "lift 1. on 2 is 6.0 m beside where it is on 1: its points or the poses of the floors do not fit"
            ]
        );
    }
}
