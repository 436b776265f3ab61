//! The surroundings of the map in a picture: title, legend, scale bar.

use std::fmt::Write as _;

use super::canvas::{WALL, pastel};
use super::overlay::{FONTS, INK, escaped, hex};
use crate::labels::{Label, LabelSet, Role};
use crate::topology::TopologicalMap;

/// Color of secondary text.
const GRAY: &str = "#69707d";
/// Mean width of a character by the size of the text: a little more than the font's.
const CHARACTER_WIDTH: f64 = 0.56;

/// Where things are on the page, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Upper left corner of the map.
    pub(super) map: (u32, u32),
    pub(super) text_px: f64,
}

/// Something in the legend: its width and how it is drawn with its left end and baseline given.
struct Item {
    width: f64,
    svg: Box<dyn Fn(f64, f64) -> String>,
}

/// The elements around the map, for a map picture of `map_px` pixels with `m_per_px`.
pub(super) struct Page {
    pub(super) layout: Layout,
    pub(super) svg: String,
}

impl Page {
    pub(super) fn new(
        title: &str,
        topology: &TopologicalMap,
        labeling: &[Label],
        label_set: &LabelSet,
        map_px: (u32, u32),
        m_per_px: f64,
    ) -> Self {
        let text_px = (map_px.0.max(map_px.1) as f64 / 105.0).clamp(13.0, 36.0);
        let margin = 2.0 * text_px;
        let width = (map_px.0 as f64 + 2.0 * margin).max(46.0 * text_px).ceil();
        let map_top = (5.6 * text_px).ceil();
        let legend_top = map_top + map_px.1 as f64 + 0.8 * text_px;
        let items = legend(topology, labeling, label_set, text_px, m_per_px);
        let (legend, legend_height) = flow(&items, margin, legend_top, width - margin, text_px);
        let layout = Layout {
            width: width as u32,
            height: (legend_top + legend_height + text_px).ceil() as u32,
            map: (((width - map_px.0 as f64) / 2.0) as u32, map_top as u32),
            text_px,
        };
        let svg = format!("{}{legend}", heading(title, topology, &layout));
        Self { layout, svg }
    }
}

/// Title and a line of figures.
fn heading(title: &str, topology: &TopologicalMap, layout: &Layout) -> String {
    let (x, text) = (2.0 * layout.text_px, layout.text_px);
    let room = (layout.width as f64 - 2.0 * x) / (1.55 * text * (CHARACTER_WIDTH + 0.06));
    let mut shown: String = title.chars().take(room as usize).collect();
    if shown.len() < title.len() {
        shown.pop();
        shown.push('…');
    }
    let places = &topology.places;
    let n_doorways = places.iter().filter(|place| place.role == Role::Doorway).count();
    let area_m2: f64 = places.iter().map(|place| place.area_m2).sum();
    let count = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let figures = [
        count(places.len() - n_doorways, "place"),
        count(n_doorways, "doorway"),
        count(topology.connections.len(), "connection"),
        format!("{area_m2:.0} m²"),
    ]
    .join(" · ");
    format!(
        "{}{}",
        text_svg(x, 2.5 * text, 1.55 * text, "bold", INK, &shown),
        text_svg(x, 4.2 * text, 1.05 * text, "normal", GRAY, &figures)
    )
}

/// Classes with their shares of the area, the other signs, and the scale bar.
fn legend(
    topology: &TopologicalMap,
    labeling: &[Label],
    label_set: &LabelSet,
    text_px: f64,
    m_per_px: f64,
) -> Vec<Item> {
    let mut n_cells = vec![0usize; label_set.len()];
    for label in labeling {
        n_cells[label.index()] += 1;
    }
    let mut items: Vec<Item> = label_set
        .classes()
        .iter()
        .zip(n_cells)
        .map(|(class, n)| {
            let share = 100.0 * n as f64 / labeling.len().max(1) as f64;
            swatch(&class.name, &format!("{share:.1} %"), pastel(class.color), text_px)
        })
        .collect();
    items.push(swatch("wall", "", WALL, text_px));
    if !topology.places.is_empty() {
        items.push(scale_bar(m_per_px, text_px));
    }
    items
}

/// A colored square, a name and a figure.
fn swatch(name: &str, figure: &str, color: [u8; 3], text_px: f64) -> Item {
    let width = 2.0 * text_px + text_width(name, text_px) + text_width(figure, text_px);
    let (name, figure, color) = (escaped(name), figure.to_owned(), hex(color));
    let svg = move |x: f64, y: f64| {
        let (top, corner, text_x, gap) =
            (y - 0.86 * text_px, 0.18 * text_px, x + 1.5 * text_px, 0.4 * text_px);
        format!(
            r#"<rect x="{x:.1}" y="{top:.1}" width="{text_px:.1}" height="{text_px:.1}" rx="{corner:.1}" fill="{color}" stroke="{INK}" stroke-opacity="0.35" stroke-width="1"/>
<text x="{text_x:.1}" y="{y:.1}" font-family="{FONTS}" font-size="{text_px:.1}" fill="{INK}">{name}<tspan dx="{gap:.1}" fill="{GRAY}">{figure}</tspan></text>"#
        )
    };
    Item { width, svg: Box::new(svg) }
}

/// A bar of 1, 2 or 5 times a power of ten meters, the longest that is at most 20 times the text size long.
fn scale_bar(m_per_px: f64, text_px: f64) -> Item {
    let longest_m = 20.0 * text_px * m_per_px;
    let power = 10f64.powf(longest_m.log10().floor());
    let length_m = [5.0, 2.0, 1.0].into_iter().find(|f| f * power <= longest_m).unwrap_or(1.0) * power;
    let bar = length_m / m_per_px;
    let label = format!("{length_m} m");
    let width = bar + 0.6 * text_px + text_width(&label, text_px);
    let svg = move |x: f64, y: f64| {
        let (top, bottom) = (y - 0.7 * text_px, y - 0.1 * text_px);
        let end = x + bar;
        let mut svg = format!(
            r#"<path d="M{x:.1} {top:.1}V{bottom:.1}H{end:.1}V{top:.1}" fill="none" stroke="{INK}" stroke-width="{:.1}"/>"#,
            0.12 * text_px
        );
        svg += &text_svg(end + 0.6 * text_px, y, text_px, "normal", INK, &label);
        svg
    };
    Item { width, svg: Box::new(svg) }
}

/// Puts `items` in lines between `left` and `right`; returns their elements and their height.
fn flow(items: &[Item], left: f64, top: f64, right: f64, text_px: f64) -> (String, f64) {
    let (mut x, mut y) = (left, top + 1.5 * text_px);
    let mut svg = String::new();
    for item in items {
        if x > left && x + item.width > right {
            x = left;
            y += 1.8 * text_px;
        }
        let _ = writeln!(svg, "{}", (item.svg)(x, y));
        x += item.width + 1.8 * text_px;
    }
    (svg, y - top + 0.5 * text_px)
}

fn text_width(text: &str, text_px: f64) -> f64 {
    text.chars().count() as f64 * CHARACTER_WIDTH * text_px
}

fn text_svg(x: f64, y: f64, size: f64, weight: &str, color: &str, text: &str) -> String {
    let text = escaped(text);
    format!(
        r#"<text x="{x:.1}" y="{y:.1}" font-family="{FONTS}" font-size="{size:.1}" font-weight="{weight}" fill="{color}">{text}</text>"#
    )
}
