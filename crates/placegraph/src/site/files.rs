//! The files of a site beside those of its floors.

use std::borrow::Cow;

use super::{DOCUMENT, Level, Shaft, ShaftKind, SiteDocument, SiteError};
use crate::document::FileRecord;
use crate::export::{
    Export, ExportError, Format, MaskSettings, RmfBuilding, RmfLevel, RmfLift, RmfStop, rmf_background,
    rmf_building, rmf_nav_graph,
};
use crate::geom::{Point2, Pose2};
use crate::grid::{GridShape, MapFrame};
use crate::result::Files;

impl SiteDocument {
    /// All files of the site, the document last, which lists the others: the route graph of Nav2 of every level in its own map frame;
    /// building file, pictures and navigation graph of Open-RMF in the frame of the site. What cannot be written is a
    /// finding of the document.
    ///
    /// # Errors
    /// If the document cannot be written.
    pub fn files(&mut self) -> Result<Files, SiteError> {
        let mut files = Files::new();
        let mut unmet = Vec::new();
        for (position, level) in self.levels.iter().enumerate() {
            match self.route_graph(position) {
                Ok(written) => files.extend(written),
                Err(error) => unmet.push(format!("{} has no route graph: {error}", level.level)),
            }
        }
        match self.rmf() {
            Ok(written) => files.extend(written),
            Err(error) => unmet.push(format!("the site has no files of Open-RMF: {error}")),
        }
        self.findings.extend(unmet);
        self.files = files.iter().map(|(name, bytes)| FileRecord::of(name, bytes)).collect();
        self.seal()?;
        files.push((DOCUMENT.to_owned(), self.to_json()?.into_bytes()));
        Ok(files)
    }

    fn route_graph(&self, position: usize) -> Result<Files, ExportError> {
        let (document, masks) = (self.document(position), MaskSettings::default());
        let Some(nav2) = Format::by_name("nav2") else { return Ok(Files::new()) };
        let name = format!("{}.{}", self.levels[position].level, nav2.file);
        nav2.write(&Export::new(&document, &masks)?, &name)
    }

    fn rmf(&self) -> Result<Files, ExportError> {
        let background = |level: &Level| format!("{}.{}.png", self.name, level.level);
        let levels = self.levels.iter().map(|level| {
            let pose = level.site_from_map;
            Ok(RmfLevel {
                name: level.level.clone(),
                elevation_m: level.elevation_m,
                map: Cow::Owned(level.topology().moved(pose)),
                shape: moved(level, pose).map_err(|error| ExportError::writer("RMF building", &error))?,
                background: background(level),
            })
        });
        let lifts = self.shafts.iter().filter(|shaft| shaft.kind == ShaftKind::Lift);
        let building = RmfBuilding {
            name: self.name.clone(),
            levels: levels.collect::<Result<_, ExportError>>()?,
            lifts: lifts.map(|lift| self.rmf_lift(lift)).collect(),
        };
        let stamp = format!("# written by placegraph {}\n", self.program.version);
        let stamped = |bytes: Vec<u8>| [stamp.as_bytes(), &bytes].concat();
        let mut files = vec![
            (format!("{}.building.yaml", self.name), stamped(rmf_building(&building)?)),
            ("nav_graph.yaml".to_owned(), stamped(rmf_nav_graph(&building)?)),
        ];
        for level in &building.levels {
            files.push((level.background.clone(), rmf_background(&level.map, &level.shape)?));
        }
        Ok(files)
    }

    fn rmf_lift(&self, lift: &Shaft) -> RmfLift {
        let stops = lift.stops.iter().filter_map(|stop| {
            let (position, level) = self.level(&stop.level)?;
            let line: Vec<Point2> =
                stop.route.line.iter().map(|&point| level.site_from_map.apply(point)).collect();
            Some(RmfStop { level: position, place: stop.place, line })
        });
        RmfLift {
            name: lift.name.clone(),
            size_m: lift.size_m.unwrap_or([super::CABIN_M; 2]),
            stops: stops.collect(),
        }
    }
}

/// The grid of a level in another frame, to which `pose` transforms its points.
fn moved(level: &Level, pose: Pose2) -> Result<GridShape, crate::grid::FrameError> {
    let shape = level.map.shape()?;
    let origin = shape.frame.map_from_grid();
    let corner = pose.apply(Point2::new(origin.x, origin.y));
    let origin = Pose2::new(corner.x, corner.y, origin.yaw_rad + pose.yaw_rad);
    Ok(GridShape { frame: MapFrame::new(shape.frame.resolution_m(), origin)?, ..shape })
}
