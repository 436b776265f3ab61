//! The page `docs/features.md`, written from the registry.

use std::fmt::Write;

use super::families::Scale;
use super::registry::{Feature, chapter183, freiburg203, lean120, old152, registry};

const INTRODUCTION: &str = "\
# Features

<!-- Written by the program from the registry of features. Do not edit. -->

Look up the formula of a feature here. To list the features in a terminal:

```sh
placegraph features
```

Every feature is a number computed from one simulated scan of n = 360 beams with ranges d_i, counter-clockwise
from the x axis of the map; beam n is beam 0 again. There are two sets, as in appendices A and B of the book:
from the raw beams, and from the polygon of their end points. The last features exist only in the author's program.

```text
Δ_i = |d_i - d_{i+1}|                         ρ_i = min(d_i, d_{i+1}) / max(d_i, d_{i+1})
v_i = (x_i, y_i) = d_i (cos φ_i, sin φ_i)     A, P area and perimeter of the polygon v_0 v_1 … v_{n-1}
C   centroid of the polygon                   R_i = |v_i - C|
μ_pq = Σ (x_i - mean(x))^p (y_i - mean(y))^q  η_pq = μ_pq / n^(p+q+2)
c_k  Fourier coefficient of the boundary over its arc length t:  c_k = 1/P ∮ v(t) exp(-2πi k t / P) dt
```

`mean` and `sd` are over the n beams; standard deviations have the divisor n. If the polygon of a scan has no area,
all features of set B are 0.

*Scale* is how the value changes when the building is s times as large; `fixed` means that the formula has a
length of fixed size. No value changes when the robot turns on the spot. Those marked *chiral* change when the
building is mirrored.

A8 splits the end points below 6 m into arcs where neighbors are more than 0.3 m apart, splits an arc at the
point farthest from its chord while that is more than 0.1 m away, and counts the points of arcs with at least
5 points and a chord of at least 0.4 m.
";

/// The documentation of all features as a Markdown page, a row per family.
pub fn markdown() -> String {
    let mut page = INTRODUCTION.to_owned();
    let is_extra = |feature: &&Feature| feature.book.is_none();
    let in_set = |set: char| move |feature: &&Feature| feature.book.is_some_and(|name| name.starts_with(set));
    section(&mut page, "Set A: beams", registry().iter().filter(in_set('A')));
    section(&mut page, "Set B: polygon", registry().iter().filter(in_set('B')));
    section(&mut page, "Only in the author's program", registry().iter().filter(is_extra));
    let _ = write!(
        page,
        "\n## Sets\n\n\
         | set | features | which |\n|---|---|---|\n\
         | `all` | {} | every row above |\n\
         | `freiburg203` | {} | the author's program, which the chapter's experiments count; without A4, A8, B13, B14 |\n\
         | `chapter183` | {} | those with a number in the appendices |\n\
         | `old152` | {} | of `freiburg203`, those of Sect. 3.4: without A11 to A16, B15 to B17 and the last section |\n\
         | `lean120` | {} | the cheap ones: without A8 and B6 above 5 |\n",
        registry().len(),
        freiburg203().len(),
        chapter183().len(),
        old152().len(),
        lean120().len(),
    );
    page
}

/// Text whose bars do not end a table's cell.
fn in_table(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A table of `features`; consecutive ones that differ only in their parameter share a row.
fn section<'a>(page: &mut String, title: &str, features: impl Iterator<Item = &'a Feature>) {
    let _ = write!(
        page,
        "\n## {title}\n\n| name | code | what | formula | unit | scale |\n|---|---|---|---|---|---|\n"
    );
    let features: Vec<_> = features.collect();
    for family in features.chunk_by(|one, next| one.formula == next.formula) {
        let (first, last) = (family[0], family[family.len() - 1]);
        let name = match family {
            [only] => format!("`{}`", only.name),
            [first, second, .., last] => format!("`{}`, `{}` … `{}`", first.name, second.name, last.name),
            _ => format!("`{}`, `{}`", first.name, last.name),
        };
        let chiral = if first.mirror_invariant { "" } else { ", chiral" };
        let scale = match first.scale {
            Scale::Invariant => "1".to_owned(),
            Scale::Power(power) => format!("s^{power}"),
            Scale::Decades(power) => format!("+ {power} log10 s"),
            Scale::FixedLength => "fixed".to_owned(),
        };
        let _ = writeln!(
            page,
            "| {name} | {} | {} | {} | {} | {scale}{chiral} |",
            first.code.unwrap_or("–"),
            in_table(first.description),
            in_table(first.formula),
            first.unit,
        );
    }
}
