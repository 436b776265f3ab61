//! The training report as one HTML page: no other file, no script.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::{ImageFormat, Rgb, RgbImage};
use placegraph::grid::Occupancy;
use placegraph::labels::{ConfusionMatrix, Label, LabelSet};
use placegraph::training::{HoldOut, LabeledMap, MapScore, TrainingReport, Validation};

use super::words;

/// Maps of which the page has a picture: those with most errors.
const MAX_PICTURES: usize = 6;
/// Largest map that is drawn.
const MAX_PIXELS: usize = 4_000_000;
/// Features that the page lists.
const MAX_FEATURES: usize = 20;

const STYLE: &str = ":root{color-scheme:light dark}body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;\
color:light-dark(#222,#e8ebf1);background:light-dark(#fff,#12151b)}h1,h2,h3{line-height:1.25}h2{margin-top:2.5rem}table{border-collapse:collapse}\
.wide{overflow-x:auto}td,th{padding:.2rem .7rem;text-align:right;white-space:nowrap;border-bottom:1px solid light-dark(#ddd,#323946)}\
td:first-child,th:first-child{text-align:left}.big{font-size:1.3rem}.note{color:light-dark(#555,#a2acbc)}\
img{width:min(100%,48rem);image-rendering:pixelated;border:1px solid light-dark(#ddd,#323946)}svg{max-width:100%}\
.swatch{display:inline-block;width:.8em;height:.8em;margin-right:.3em}svg text{font:12px system-ui,sans-serif;fill:currentColor}";

/// The page about a model that was trained on `maps`.
pub(super) fn html(report: &TrainingReport, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Training report</title><style>{STYLE}</style></head>\
         <body><main>\n<h1>Training report</h1>\n"
    );
    // Writing to a string cannot fail.
    let _ = writeln!(page, "<p>{}</p>", escaped(&words::examples(report, maps, classes)));
    match &report.validation {
        None => {
            page += "<p>No part could be held out: every class must be labeled in two places at least.</p>\n";
        }
        Some(validation) => {
            let _ = writeln!(page, "<p class=\"big\">{}</p>", escaped(&words::verdict(validation)));
            let _ = writeln!(page, "<p class=\"note\">{}</p>", in_code(&escaped(words::CELL_BY_CELL)));
            page += &maps_table(validation, maps);
            page += &confusion_table(&validation.confusion, classes);
            page += &pictures(validation, maps, classes);
            page += &learning_curve(report);
            page += &reliability(validation);
            page += &orders(validation, classes);
        }
    }
    page += &features(report, classes);
    page += "</main></body></html>\n";
    page
}

/// Parts of a page, one after the other.
fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// What stands between backticks, as code.
fn in_code(text: &str) -> String {
    let parts = text.split('`').enumerate();
    joined(parts.map(|(k, part)| if k % 2 == 1 { format!("<code>{part}</code>") } else { part.to_owned() }))
}

/// A table that scrolls where it is wider than the screen.
fn table(name: &str, rows: &str) -> String {
    format!(
        "<div class=\"wide\" role=\"region\" aria-label=\"{name}\" tabindex=\"0\"><table>{rows}</table></div>"
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

fn maps_table(validation: &Validation, maps: &[LabeledMap]) -> String {
    let title = match validation.held_out {
        HoldOut::Buildings => "Buildings that were held out",
        HoldOut::Blocks => "Parts that were held out, by map",
    };
    let row = |score: &MapScore| {
        format!(
            "<tr><td>{}</td><td>{}</td></tr>",
            escaped(&maps[score.map as usize].name),
            percent(score.accuracy)
        )
    };
    let rows = joined(validation.maps.iter().map(row));
    let table = table(title, &format!("<tr><th>map</th><th>cells right</th></tr>{rows}"));
    format!("<h2>{title}</h2>{table}\n")
}

fn swatch(classes: &LabelSet, label: Label) -> String {
    let class = classes.class(label);
    let [r, g, b] = class.color;
    format!("<span class=\"swatch\" style=\"background:rgb({r},{g},{b})\"></span>{}", escaped(&class.name))
}

fn confusion_table(confusion: &ConfusionMatrix, classes: &LabelSet) -> String {
    let header = joined(classes.labels().map(|label| format!("<th>{}</th>", swatch(classes, label))));
    let row = |label: Label| {
        let n = confusion.n_true(label).max(1) as f64;
        let cell = |found: Label| {
            let share = confusion.counts[label.index()][found.index()] as f64 / n;
            let color = if found == label { "60,150,80" } else { "200,60,60" };
            format!("<td style=\"background:rgba({color},{:.2})\">{}</td>", 0.6 * share, percent(share))
        };
        let cells = joined(classes.labels().map(cell));
        format!("<tr><td>{}</td>{cells}</tr>", swatch(classes, label))
    };
    let rows = joined(classes.labels().map(row));
    let alike = words::hard_to_tell_apart(confusion, classes);
    let alike = joined(alike.iter().map(|line| format!("<li>{}</li>", escaped(line))));
    let alike = if alike.is_empty() {
        "<p>No class is taken for another one in a quarter of its cells.</p>".to_owned()
    } else {
        format!(
            "<p>Classes that are hard to tell apart from one place:</p><ul>{alike}</ul><p class=\"note\">A laser sees shapes only. Join such \
             classes, or label more of the rarer one.</p>"
        )
    };
    let title = "What is taken for what";
    let table = table(title, &format!("<tr><th>true class</th>{header}</tr>{rows}"));
    format!("<h2>{title}</h2>{table}{alike}\n")
}

fn pictures(validation: &Validation, maps: &[LabeledMap], classes: &LabelSet) -> String {
    let mut worst: Vec<&MapScore> = validation.maps.iter().collect();
    worst.sort_by(|a, b| a.accuracy.total_cmp(&b.accuracy));
    let drawn = worst.iter().filter(|score| maps[score.map as usize].grid.cells.values().len() <= MAX_PIXELS);
    let mut text = "<h2>Where it is wrong</h2><p class=\"note\">Every dot is a cell that was held out: pale if it is labeled right, else in \
        the color of the wrong class. Cells without a dot were not used.</p>\n"
        .to_owned();
    for score in drawn.take(MAX_PICTURES) {
        let map = &maps[score.map as usize];
        let name = escaped(&map.name);
        let picture = STANDARD.encode(picture(validation, score.map, map, classes));
        let _ = writeln!(
            text,
            "<h3>{name}: {}</h3><img alt=\"Held-out cells of {name}\" src=\"data:image/png;base64,{picture}\">",
            percent(score.accuracy)
        );
    }
    text
}

/// The map with its held-out cells, as PNG.
fn picture(validation: &Validation, number: u32, map: &LabeledMap, classes: &LabelSet) -> Vec<u8> {
    let cells = &map.grid.cells;
    let (width, height) = (cells.width(), cells.height());
    let gray = |occupancy: Occupancy| match occupancy {
        Occupancy::Free => 255,
        Occupancy::Unknown => 225,
        Occupancy::Occupied => 60,
    };
    let mut image = RgbImage::new(width, height);
    for (cell, &occupancy) in cells.cells().zip(cells.values()) {
        image.put_pixel(cell.x, height - 1 - cell.y, Rgb([gray(occupancy); 3]));
    }
    let of_map = validation.found.iter().filter(|(seen, _)| seen.map == number);
    for (seen, found) in of_map {
        let color = classes.class(*found).color;
        let is_right = map.labels[seen.cell] == Some(*found);
        let (color, reach) = if is_right { (color.map(|v| 255 - (255 - v) / 3), 0) } else { (color, 1) };
        for (dx, dy) in (0..=2 * reach).flat_map(|dx| (0..=2 * reach).map(move |dy| (dx, dy))) {
            let (x, y) =
                ((seen.cell.x + dx).wrapping_sub(reach), (height - 1 - seen.cell.y + dy).wrapping_sub(reach));
            if x < width && y < height {
                image.put_pixel(x, y, Rgb(color));
            }
        }
    }
    let mut bytes = std::io::Cursor::new(Vec::new());
    // A PNG in memory cannot fail.
    let _ = image.write_to(&mut bytes, ImageFormat::Png);
    bytes.into_inner()
}

/// Points in a square of 0 to 1 on both axes, joined by a line.
fn plot(points: &[(f64, f64)], x_name: &str, y_name: &str, diagonal: bool) -> String {
    let at = |(x, y): (f64, f64)| (50.0 + 300.0 * x, 260.0 - 240.0 * y);
    let line: Vec<String> =
        points.iter().map(|&point| at(point)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let dots = joined(
        points
            .iter()
            .map(|&point| at(point))
            .map(|(x, y)| format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#2a6fb0\"/>")),
    );
    let diagonal =
        if diagonal { "<path d=\"M50 260L350 20\" stroke=\"#999\" stroke-dasharray=\"4\"/>" } else { "" };
    let ticks = joined([0.0, 0.25, 0.5, 0.75, 1.0].iter().map(|&v| {
        let ((x, _), (_, y)) = (at((v, 0.0)), at((0.0, v)));
        format!(
            "<text x=\"{x:.0}\" y=\"275\" text-anchor=\"middle\">{:.0}</text><text x=\"44\" y=\"{:.0}\" text-anchor=\"end\">{:.0}</text>",
            100.0 * v,
            y + 4.0,
            100.0 * v
        )
    }));
    format!(
        "<svg width=\"380\" viewBox=\"0 0 380 300\" role=\"img\" aria-label=\"{y_name} by {x_name}\"><path d=\"M50 20V260H350\" fill=\"none\" \
         stroke=\"currentColor\"/>{diagonal}<polyline points=\"{}\" fill=\"none\" stroke=\"#2a6fb0\" stroke-width=\"2\"/>{dots}{ticks}\
         <text x=\"200\" y=\"294\" text-anchor=\"middle\">{x_name} (%)</text><text x=\"54\" y=\"16\">{y_name} (%)</text></svg>",
        line.join(" ")
    )
}

fn learning_curve(report: &TrainingReport) -> String {
    let Some(words) = words::more_maps(&report.curve) else { return String::new() };
    let points: Vec<(f64, f64)> = report.curve.iter().map(|point| (point.share, point.accuracy)).collect();
    format!(
        "<h2>Would more labels help?</h2>{}<p>{}</p>\n",
        plot(&points, "share of the labeled places", "held-out cells right", false),
        escaped(&words)
    )
}

fn reliability(validation: &Validation) -> String {
    let bins = validation.reliability.iter().filter(|bin| bin.n_cells > 0.0);
    let points: Vec<(f64, f64)> = bins.map(|bin| (bin.probability, bin.accuracy)).collect();
    format!(
        "<h2>Are the probabilities right?</h2>{}<p>Of cells that the model gives a class with a probability of 80 %, 80 % should have that \
         class: points on the dashed line. The mean distance from it is {:.1} points.</p>\n",
        plot(&points, "probability of the class found", "cells right", true),
        100.0 * validation.calibration_error()
    )
}

const ROUNDS: &str =
    "<tr><th>rounds</th><th>cells right</th><th>best temperature</th><th>mean −ln p</th></tr>";

fn orders(validation: &Validation, classes: &LabelSet) -> String {
    let rows = joined(words::best_orders(validation, classes).iter().map(|(accuracy, macro_f1, names)| {
        format!("<tr><td>{}</td><td>{}</td><td>{macro_f1:.3}</td></tr>", escaped(names), percent(*accuracy))
    }));
    let rounds = joined(validation.curve.iter().map(|score| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.4}</td></tr>",
            score.n_rounds,
            percent(score.accuracy),
            score.temperature,
            score.log_loss
        )
    }));
    format!(
        "<h2>What was chosen</h2><p>{} rounds of boosting and temperature {}, which make the mean of −ln p of the true class smallest.</p>\
         {}<p>The best orders of the decision list:</p>{}\n",
        validation.n_rounds,
        validation.temperature,
        table("Rounds of boosting", &format!("{ROUNDS}{rounds}")),
        table("Orders", &format!("<tr><th>order</th><th>cells right</th><th>macro-F1</th></tr>{rows}"))
    )
}

fn features(report: &TrainingReport, classes: &LabelSet) -> String {
    let header = joined(classes.labels().map(|label| format!("<th>{}</th>", swatch(classes, label))));
    let largest = report.votes.iter().flat_map(|vote| vote.alpha.iter().copied()).fold(1e-9, f64::max);
    let row = |vote: &placegraph::training::FeatureVote| {
        let bar = |alpha: &f64| {
            format!("<td style=\"background:rgba(42,111,176,{:.2})\">{alpha:.2}</td>", 0.6 * alpha / largest)
        };
        let bars = joined(vote.alpha.iter().map(bar));
        let feature = vote.feature.feature();
        format!("<tr><td title=\"{}\">{}</td>{bars}</tr>", escaped(&feature.name), escaped(&feature.name))
    };
    let rows = joined(report.votes.iter().take(MAX_FEATURES).map(row));
    let title = "Features that matter";
    let table = table(title, &format!("<tr><th>feature</th>{header}</tr>{rows}"));
    format!(
        "<h2>{title}</h2><p class=\"note\">Sum of the weights of the stumps that use a feature, for each class; the page of features \
         has their formulas.</p>{table}\n"
    )
}
