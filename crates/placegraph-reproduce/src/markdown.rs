//! Tables and numbers as Markdown.

use placegraph::eval::CellScores;
use placegraph::labels::LabelSet;

use super::results::doorways;

/// Heads of the columns that [`measures`] fills.
pub(super) const MEASURES: [&str; 5] =
    ["accuracy", "within one cell", "macro F1", "doorway precision", "doorway recall"];

/// A table with one row per item of `rows`.
pub(super) fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = line(head.iter().map(ToString::to_string).collect());
    text += &line(vec!["---".to_owned(); head.len()]);
    text.extend(rows.into_iter().map(line));
    text
}

/// `first` columns, then [`MEASURES`].
pub(super) fn with_measures<'a>(first: &[&'a str]) -> Vec<&'a str> {
    first.iter().copied().chain(MEASURES).collect()
}

/// A share in per cent, or a dash.
pub(super) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.2} %", 100.0 * share))
}

/// A number with two decimals, or a dash.
pub(super) fn decimal(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

/// `part` of `whole` in per cent, without decimals.
pub(super) fn share(part: u64, whole: u64) -> String {
    if whole == 0 { "–".to_owned() } else { format!("{:.0} %", 100.0 * part as f64 / whole as f64) }
}

/// The cells of a row under [`MEASURES`].
pub(super) fn measures(scores: &CellScores) -> Vec<String> {
    let doorway = doorways(scores);
    vec![
        percent(scores.accuracy),
        percent(scores.accuracy_within_one_cell),
        decimal(scores.macro_f1),
        decimal(doorway.precision),
        decimal(doorway.recall),
    ]
}

/// Counts of cells by true class (row) and found class (column).
pub(super) fn confusion(scores: &CellScores) -> String {
    let label_set = LabelSet::default();
    let names = || label_set.classes().iter().map(|class| class.name.clone());
    let found: Vec<String> = names().map(|name| format!("found {name}")).collect();
    let head: Vec<&str> = std::iter::once("drawn").chain(found.iter().map(String::as_str)).collect();
    let rows = names().zip(&scores.confusion.matrix.counts).map(|(name, counts)| {
        std::iter::once(name).chain(counts.iter().take(label_set.len()).map(u64::to_string)).collect()
    });
    table(&head, rows)
}

#[cfg(test)]
mod tests {
    use super::super::results::compare;
    use super::*;
    use placegraph::grid::Grid;
    use placegraph::labels::Label;

    #[test]
    fn a_table_has_a_line_per_row_and_a_rule() {
        let text = table(&["a", "b"], [vec!["1".to_owned(), "2".to_owned()]]);
        assert_eq!(text, "| a | b |\n| --- | --- |\n| 1 | 2 |\n");
    }

    #[test]
    fn measures_of_four_cells() {
        let labels = |labels: [u8; 4]| Grid::from_rows(4, 1, labels.map(|k| Some(Label(k))).to_vec());
        // Drawn c c d d, found c r d c: half is right; the last cell has no c next to it, the second no r.
        let scores = compare(&labels([0, 1, 2, 0]), &labels([0, 0, 2, 2]));
        assert_eq!(measures(&scores), ["50.00 %", "50.00 %", "0.39", "1.00", "0.50"]);
        assert!(confusion(&scores).contains("| corridor | 1 | 1 | 0 |"));
        assert!(confusion(&scores).contains("| doorway | 1 | 0 | 1 |"));
    }

    #[test]
    fn nothing_is_a_dash() {
        assert_eq!((percent(None), decimal(None), share(1, 0)), ("–".into(), "–".into(), "–".into()));
        assert_eq!(share(1, 8), "12 %");
    }
}
