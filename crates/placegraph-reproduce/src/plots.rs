//! Curves as SVG: accuracy over rounds and over iterations.

use anyhow::Result;
use plotters::prelude::*;

const SIZE_PX: (u32, u32) = (900, 540);
/// Told apart by lightness as well as by hue.
const COLORS: [RGBColor; 4] =
    [RGBColor(20, 70, 140), RGBColor(214, 120, 20), RGBColor(40, 150, 90), RGBColor(150, 40, 120)];

/// A curve of accuracies, in per cent.
#[derive(Debug)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
}

/// Draws `lines` in one frame; a line of two points without marks is a level to compare with.
pub(super) fn curves_svg(title: &str, x_title: &str, lines: &[Line]) -> Result<String> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, SIZE_PX).into_drawing_area();
    root.fill(&WHITE)?;
    let all = || lines.iter().flat_map(|line| &line.points);
    let (x, y) = (range(all().map(|p| p.0), 0.0), range(all().map(|p| p.1), 0.3));
    let mut chart = ChartBuilder::on(&root)
        .caption(title, ("sans-serif", 24))
        .margin(16)
        .x_label_area_size(52)
        .y_label_area_size(76)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc(x_title)
        .y_desc("cells labeled right")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y:.1} %"))
        .label_style(("sans-serif", 16))
        .axis_desc_style(("sans-serif", 18))
        .light_line_style(WHITE)
        .draw()?;
    for (number, line) in lines.iter().enumerate() {
        let color = COLORS[number % COLORS.len()];
        chart
            .draw_series(LineSeries::new(line.points.iter().copied(), color.stroke_width(2)))?
            .label(&line.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], color.stroke_width(2)));
        if line.points.len() > 2 {
            chart.draw_series(line.points.iter().map(|&p| Circle::new(p, 4, color.filled())))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(160, 160, 160))
        .label_font(("sans-serif", 16))
        .draw()?;
    root.present()?;
    drop(chart);
    drop(root);
    Ok(svg)
}

/// From the least to the largest value, and `margin` more at either end.
fn range(values: impl Iterator<Item = f64> + Clone, margin: f64) -> std::ops::Range<f64> {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let largest = values.fold(f64::NEG_INFINITY, f64::max);
    if least < largest { least - margin..largest + margin } else { least - 1.0..least + 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_names_its_axes_and_lines() {
        let line =
            |name: &str, points: &[(f64, f64)]| Line { name: name.to_owned(), points: points.to_vec() };
        let lines = [
            line("measured", &[(0.0, 90.0), (50.0, 95.0), (100.0, 97.0)]),
            line("level", &[(0.0, 96.0), (100.0, 96.0)]),
        ];
        let svg = curves_svg("A title", "steps", &lines).unwrap();
        for text in ["A title", "steps", "cells labeled right", "measured", "level", "</svg>"] {
            assert!(svg.contains(text), "{text}");
        }
        // A mark for each point of the curve, none for the level.
        assert_eq!(svg.matches("<circle").count(), 3);
        assert_eq!(svg, curves_svg("A title", "steps", &lines).unwrap());
    }

    #[test]
    fn a_single_value_still_has_a_range() {
        assert_eq!(range([5.0].into_iter(), 0.3), 4.0..6.0);
        assert_eq!(range([1.0, 3.0].into_iter(), 0.5), 0.5..3.5);
    }
}
