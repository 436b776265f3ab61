//! Which groups of features have to be computed for the columns asked for.

use super::FeatureId;
use super::beams;
use super::families::Measure as M;
use super::fourier::{Harmonics, fourier};
use super::lines::lines;
use super::minima::minima;
use super::moments::{Along, moments};
use super::polygon::{self, Directions, Outline};
use super::values::{Ranges, Values};
use crate::scan::Instructions;

/// Features that share their work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    Differences,
    ClippedDifferences,
    Lengths,
    Gaps,
    Lines,
    Minima,
    Relations,
    Areas,
    Radii,
    Moments,
    Fourier,
}

impl Group {
    fn of(measure: M) -> Self {
        match measure {
            M::MeanDifference | M::SdDifference => Self::Differences,
            M::MeanClippedDifference | M::SdClippedDifference => Self::ClippedDifferences,
            M::MeanLength | M::SdLength | M::MeanNormalizedLength | M::SdNormalizedLength | M::Kurtosis => {
                Self::Lengths
            }
            M::Gaps | M::GapFraction => Self::Gaps,
            M::BeamsOnLines => Self::Lines,
            M::MinimaDistance | M::MinimaAngle => Self::Minima,
            M::MeanRelation | M::SdRelation | M::RelativeGaps | M::RelativeGapFraction => Self::Relations,
            M::Area
            | M::Perimeter
            | M::AreaOverPerimeter
            | M::FormFactor
            | M::Circularity
            | M::NormalizedCircularity => Self::Areas,
            M::MeanRadius | M::SdRadius | M::MeanNormalizedRadius | M::SdNormalizedRadius => Self::Radii,
            M::Moment | M::Compactness | M::Eccentricity => Self::Moments,
            M::Fourier
            | M::MajorAxis
            | M::MinorAxis
            | M::AxisRatio
            | M::DescriptorMajorAxis
            | M::DescriptorMinorAxis
            | M::DescriptorAxisRatio => Self::Fourier,
        }
    }

    fn is_polygon(self) -> bool {
        matches!(self, Self::Areas | Self::Radii | Self::Moments | Self::Fourier)
    }
}

/// The groups that a list of features needs, and constants for computing them.
pub(super) struct Plan {
    groups: Vec<Group>,
    /// Whether A4 is asked for.
    sd_of_clipped: bool,
    harmonics: Harmonics,
    directions: Directions,
    along: Along,
}

impl Plan {
    pub(super) fn new(columns: &[FeatureId]) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        let mut harmonics = Vec::new();
        let mut sd_of_clipped = false;
        for feature in columns.iter().map(|id| id.feature()) {
            let group = Group::of(feature.measure);
            if !groups.contains(&group) {
                groups.push(group);
            }
            sd_of_clipped |= feature.measure == M::SdClippedDifference;
            if let (M::Fourier, Some(k)) = (feature.measure, feature.parameter) {
                harmonics.push(k as usize);
            }
        }
        Self {
            groups,
            sd_of_clipped,
            harmonics: Harmonics::new(harmonics),
            directions: Directions::new(),
            along: Along::new(),
        }
    }

    /// Computes the features of the cells with ranges `d`.
    pub(super) fn measure(&self, d: &Ranges, instructions: Instructions, values: &mut Values) {
        instructions.run(
            #[inline(always)]
            || self.measure_inlined(d, values),
        );
    }

    #[inline(always)]
    fn measure_inlined(&self, d: &Ranges, values: &mut Values) {
        let is_polygon = self.groups.iter().any(|group| group.is_polygon());
        let outline = if is_polygon { Some(Outline::new(d)) } else { None };
        for group in &self.groups {
            match (group, &outline) {
                (Group::Differences, _) => beams::differences(d, values),
                (Group::ClippedDifferences, _) => {
                    beams::clipped_differences(d, self.sd_of_clipped, values);
                }
                (Group::Lengths, _) => beams::lengths(d, values),
                (Group::Gaps, _) => beams::gaps(d, values),
                (Group::Lines, _) => lines(d, &self.along, values),
                (Group::Minima, _) => minima(d, &self.along, values),
                (Group::Relations, _) => beams::relations(d, values),
                (Group::Areas, Some(outline)) => polygon::areas(outline, values),
                (Group::Radii, Some(outline)) => polygon::radii(d, &self.directions, outline, values),
                (Group::Moments, Some(outline)) => {
                    moments(d, &self.along, outline, values);
                }
                (Group::Fourier, Some(outline)) => {
                    fourier(d, &self.directions, outline, &self.harmonics, values);
                }
                (Group::Areas | Group::Radii | Group::Moments | Group::Fourier, None) => {}
            }
        }
    }
}
