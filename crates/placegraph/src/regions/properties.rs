//! Area, centroid and ellipse axes of every region (Sect. 4.7).
//!
//! Second moments include the spread of a cell itself, `resolution² / 12`, so a region of one cell has the
//! axes of a square, not 0. Sums are exact integers. Cost: linear in runs.

use super::RegionMap;
use crate::geom::{EllipseAxes, Point2};
use crate::grid::{FreeSpace, MapFrame, Runs};

/// Measures of a region, in the map frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionProperties {
    /// Area of its cells, in m².
    pub area_m2: f64,
    /// Mean of its cells' centers; may lie outside of a bent region.
    pub centroid: Point2,
    /// Axes of the ellipse with the same second moments.
    pub axes: EllipseAxes,
}

/// Sums over the columns x and rows y of a region's cells.
#[derive(Clone, Copy, Default)]
struct Sums {
    n: i128,
    x: i128,
    y: i128,
    xx: i128,
    xy: i128,
    yy: i128,
}

/// The measures of every region, in the order of [`RegionMap::regions`].
pub fn properties(space: &FreeSpace, regions: &RegionMap) -> Vec<RegionProperties> {
    let mut sums = vec![Sums::default(); regions.regions.len()];
    for run in Runs::new(&space.graph, |node| regions.region_of[node].0).all() {
        sums[run.value as usize].add_run(run.start as i128, run.end as i128, run.y as i128);
    }
    sums.iter().map(|sums| sums.properties(&space.frame)).collect()
}

impl Sums {
    /// Adds the cells in columns `start..end` of row `y`.
    fn add_run(&mut self, start: i128, end: i128, y: i128) {
        let n = end - start;
        let below = |m: i128| m * (m - 1) / 2; // 0 + 1 + … + (m − 1)
        let squares_below = |m: i128| (m - 1) * m * (2 * m - 1) / 6;
        let x = below(end) - below(start);
        self.n += n;
        self.x += x;
        self.y += n * y;
        self.xx += squares_below(end) - squares_below(start);
        self.xy += x * y;
        self.yy += n * y * y;
    }

    fn properties(&self, frame: &MapFrame) -> RegionProperties {
        let n = self.n as f64;
        let cell_m2 = frame.cell_area_m2();
        let centroid_cells = Point2::new(self.x as f64 / n + 0.5, self.y as f64 / n + 0.5);
        // Central moments in m², e.g. (n Σx² − (Σx)²) / n².
        let central = |ab: i128, a: i128, b: i128| (self.n * ab - a * b) as f64 / (n * n) * cell_m2;
        let own = cell_m2 / 12.0;
        let axes = EllipseAxes::from_moments(
            central(self.xx, self.x, self.x) + own,
            central(self.xy, self.x, self.y),
            central(self.yy, self.y, self.y) + own,
        );
        RegionProperties {
            area_m2: n * cell_m2,
            centroid: frame.map_from_cells(centroid_cells),
            axes: axes.rotated(frame.map_from_grid().yaw_rad),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Pose2;
    use crate::grid::{CellGraph, OccupancyGrid};
    use crate::labels::Label;
    use crate::regions::{DiagonalSteps, connected};

    #[test]
    fn a_bar_of_four_cells_in_a_turned_map() {
        let map = OccupancyGrid::from_ascii(0.5, "????\n....\n");
        let graph = CellGraph::new(&map.cells);
        let regions = connected(&graph, &[Label(0); 4], DiagonalSteps::ThroughFree);
        let frame = MapFrame::new(0.5, Pose2::new(1.0, 2.0, std::f64::consts::FRAC_PI_2)).unwrap();
        let [bar] = properties(&FreeSpace { frame, graph }, &regions)[..] else { panic!("one region") };
        assert!((bar.area_m2 - 1.0).abs() < 1e-12);
        // Grid (1.0 m, 0.25 m), turned to the left: (−0.25, 1.0), from (1, 2).
        assert!(bar.centroid.distance(Point2::new(0.75, 3.0)) < 1e-12);
        // A bar of 2 m by 0.5 m has variances 4/12 and 0.25/12.
        assert!((bar.axes.major_m - 4.0 * (4.0f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!((bar.axes.minor_m - 4.0 * (0.25f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!((bar.axes.direction_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }
}
