//! Files of other programs: which format has which files, and what goes into them.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use placegraph::export::{
    ExportError, MaskFiles, MaskSheet, ReportInput, RmfInfo, TmapInfo, TopologyDocument, dot, graphml,
    keepout_mask, nav2_route, regions_geojson, regions_svg, report_html, rmf_building, rmf_nav_graph,
    speed_mask, tmap2, vector_shapes, zone_mask,
};
use placegraph::grid::{Grid, GridShape, Occupancy};
use placegraph::topology::TopologicalMap;

use crate::args::Format;
use crate::masks::Masks;

/// What is exported.
#[derive(Debug)]
pub(crate) struct Subject<'a> {
    document: &'a TopologyDocument,
    /// As the document has it: exports are the same whether made with it or from it.
    map: TopologicalMap,
    shape: GridShape,
    masks: &'a Masks,
    /// The map's cells, for the report.
    pub(crate) occupancy: Option<&'a Grid<Occupancy>>,
    /// Probability of the most likely class per cell, for the report.
    pub(crate) probability: Option<Grid<f32>>,
}

impl<'a> Subject<'a> {
    /// What `document` holds, without pictures.
    pub(crate) fn new(document: &'a TopologyDocument, masks: &'a Masks) -> Result<Self> {
        masks.check(&document.classes)?;
        let (map, shape) = (document.topology(), document.map.shape()?);
        Ok(Self { document, map, shape, masks, occupancy: None, probability: None })
    }

    /// The files of `format`; the first is called `main`.
    pub(crate) fn files(&self, format: Format, main: &str) -> Result<Vec<(String, Vec<u8>)>> {
        let names = file_names(format, main)?;
        let contents = self.contents(format, &names).with_context(|| format!("cannot write {main}"))?;
        Ok(names.into_iter().zip(contents).collect())
    }

    fn contents(&self, format: Format, names: &[String]) -> Result<Vec<Vec<u8>>, ExportError> {
        let (map, shape, frame_id) = (&self.map, &self.shape, self.document.map.frame_id.as_str());
        let classes = &self.document.classes;
        Ok(vec![match format {
            Format::Nav2Keepout => {
                return Ok(mask(keepout_mask(map, &self.sheet(names), &self.masks.keepout)?));
            }
            Format::Nav2Speed => {
                return Ok(mask(speed_mask(map, &self.sheet(names), &self.masks.speed(classes))?));
            }
            Format::Nav2Zones => return Ok(mask(zone_mask(map, &self.sheet(names), self.masks.zones)?)),
            Format::Nav2 => nav2_route(map, frame_id)?,
            Format::Nav2Shapes => vector_shapes(map, shape, frame_id, &self.masks.keepout)?,
            Format::Rmf => rmf_nav_graph(map, shape, &self.rmf_info())?,
            Format::RmfBuilding => rmf_building(map, shape, &self.rmf_info())?,
            Format::Tmap2 => tmap2(map, &self.tmap_info())?,
            Format::Graphml => graphml(map, shape, frame_id)?,
            Format::Dot => dot(map, classes).into_bytes(),
            Format::Geojson => regions_geojson(map)?,
            Format::Svg => regions_svg(map, classes, shape).into_bytes(),
            Format::Report => self.report()?.into_bytes(),
        }])
    }

    fn sheet(&self, names: &[String]) -> MaskSheet {
        MaskSheet {
            shape: self.shape,
            rotated: self.masks.rotated,
            image_name: names[1].clone(),
            map_name: names[0].clone(),
            frame_id: self.document.map.frame_id.clone(),
        }
    }

    fn rmf_info(&self) -> RmfInfo {
        RmfInfo {
            building: self.document.map.name.clone(),
            level: "L1".to_owned(),
            // The picture of the result whose pixels are the map's.
            drawing: "labels.png".to_owned(),
        }
    }

    fn tmap_info(&self) -> TmapInfo {
        let name = self.document.map.name.clone();
        TmapInfo {
            metric_map: name.clone(),
            name,
            frame_id: self.document.map.frame_id.clone(),
            // The same map gives the same bytes whenever it is exported.
            last_updated: timestamp(fixed_time().unwrap_or_default()),
        }
    }

    /// What made the result, and from what.
    fn provenance(&self) -> String {
        let TopologyDocument { program, map, model, .. } = self.document;
        let model = model.as_ref().map(|model| format!("model {} {}", model.name, model.hash));
        let mut parts = vec![format!("{} {}", program.name, program.version)];
        parts.extend(model);
        parts.push(format!("map {} {}", map.name, map.hash));
        parts.join(" · ")
    }

    fn report(&self) -> Result<String, ExportError> {
        report_html(&ReportInput {
            title: &self.document.map.name,
            frame_id: &self.document.map.frame_id,
            map: &self.map,
            labels: &self.document.classes,
            shape: &self.shape,
            occupancy: self.occupancy,
            probability: self.probability.as_ref(),
            findings: &self.document.findings,
            provenance: &self.provenance(),
        })
    }
}

fn mask(files: MaskFiles) -> Vec<Vec<u8>> {
    vec![files.map, files.image, files.parameters]
}

/// The usual name of the first file of `format` for the map called `map_name`.
pub(crate) fn usual_name(format: Format, map_name: &str) -> String {
    let fixed = match format {
        Format::Nav2 => "route_graph.geojson",
        Format::Nav2Keepout => "keepout.yaml",
        Format::Nav2Speed => "speed.yaml",
        Format::Nav2Zones => "zones.yaml",
        Format::Nav2Shapes => "shapes.yaml",
        Format::Rmf => "nav_graph.yaml",
        Format::RmfBuilding => return format!("{map_name}.building.yaml"),
        Format::Tmap2 => return format!("{map_name}.tmap2.yaml"),
        Format::Graphml => "graph.graphml",
        Format::Dot => "graph.dot",
        Format::Geojson => "regions.geojson",
        Format::Svg => "regions.svg",
        Format::Report => "report.html",
    };
    fixed.to_owned()
}

/// The names of all files of `format` if the first is called `main`: a mask is a map file, its image and the
/// parameters of its servers.
pub(crate) fn file_names(format: Format, main: &str) -> Result<Vec<String>> {
    let mut names = vec![main.to_owned()];
    if matches!(format, Format::Nav2Keepout | Format::Nav2Speed | Format::Nav2Zones) {
        let path = Path::new(main);
        let is_yaml = path.extension().is_some_and(|extension| extension == "yaml");
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let stem = stem.filter(|_| is_yaml);
        ensure!(stem.is_some(), "expected a name that ends in .yaml for a mask's map file, found {main:?}");
        names.extend(stem.iter().flat_map(|stem| [format!("{stem}.png"), format!("{stem}_params.yaml")]));
    }
    Ok(names)
}

/// The time that results shall bear, from `SOURCE_DATE_EPOCH`: with it, nothing in them tells the clock.
pub(crate) fn fixed_time() -> Option<Duration> {
    let seconds: u32 = std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok()?;
    Some(Duration::from_secs(seconds.into()))
}

/// The time `since_1970` in UTC as `MM-DD-YYYY_HH-MM-SS`.
fn timestamp(since_1970: Duration) -> String {
    let seconds = since_1970.as_secs();
    let (mut days, of_day) = (seconds / 86_400, seconds % 86_400);
    let is_leap =
        |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    format!("{month:02}-{:02}-{year}_{hour:02}-{minute:02}-{second:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_of_seconds() {
        let at = |seconds| timestamp(Duration::from_secs(seconds));
        assert_eq!(at(0), "01-01-1970_00-00-00");
        // 10957 days to 2000-01-01, a leap year of a century: 59 more to the 29th of February.
        assert_eq!(at((10_957 + 59) * 86_400 + 3_661), "02-29-2000_01-01-01");
        assert_eq!(at(10_957 * 86_400 - 1), "12-31-1999_23-59-59");
        assert_eq!(at(253_402_300_799), "12-31-9999_23-59-59");
    }

    #[test]
    fn a_mask_has_three_files_named_alike() {
        let names = file_names(Format::Nav2Speed, "slow.yaml").unwrap();
        assert_eq!(names, ["slow.yaml", "slow.png", "slow_params.yaml"]);
        assert!(file_names(Format::Nav2Speed, "slow.png").is_err());
        assert_eq!(file_names(Format::Svg, "any.thing").unwrap(), ["any.thing"]);
    }
}
