//! Two folders of results on the same maps.

use std::fmt;

use anyhow::{Result, ensure};
use placegraph::eval::PairedTest;
use serde::Serialize;

use super::many::{MEASURES, Row};

/// A paired test of every measure.
#[derive(Serialize)]
pub(super) struct Comparison {
    /// Maps that both have.
    n_maps: usize,
    measures: Vec<MeasureTest>,
}

#[derive(Serialize)]
struct MeasureTest {
    measure: &'static str,
    #[serde(flatten)]
    test: PairedTest,
}

impl Comparison {
    /// Compares rows of the same name.
    pub(super) fn of(first: (&[String], &[Row]), second: (&[String], &[Row])) -> Result<Self> {
        let row_of = |name: &String| second.0.iter().position(|other| other == name).map(|at| &second.1[at]);
        let both: Vec<(&Row, &Row)> =
            first.0.iter().zip(first.1).filter_map(|(name, row)| Some((row, row_of(name)?))).collect();
        ensure!(!both.is_empty(), "the two folders have results of no map in common");
        let test = |(k, measure): (usize, &'static str)| {
            let pairs: Vec<(f64, f64)> = both.iter().filter_map(|(a, b)| a[k].zip(b[k])).collect();
            PairedTest::of(&pairs).map(|test| MeasureTest { measure, test })
        };
        let measures = MEASURES.into_iter().enumerate().filter(|(_, name)| *name != "cells").filter_map(test);
        Ok(Self { n_maps: both.len(), measures: measures.collect() })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Against the other results, on {} maps (differences in points; Wilcoxon signed-rank test)\n",
            self.n_maps
        )?;
        let header =
            ["difference", "better", "worse", "equal", "p"].map(|name| format!("{name:>12}")).concat();
        writeln!(f, "{:15}{header}", "measure")?;
        for MeasureTest { measure, test } in &self.measures {
            let PairedTest { n_pairs, n_more, n_less, mean_difference, p_value } = *test;
            let n_equal = n_pairs - n_more - n_less;
            writeln!(
                f,
                "{:15}{:>+12.2}{n_more:>12}{n_less:>12}{n_equal:>12}{p_value:>12.4}",
                measure.replace('_', " "),
                100.0 * mean_difference
            )?;
        }
        Ok(())
    }
}
