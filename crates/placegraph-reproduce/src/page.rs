//! The page: what was done, the chapter's figures and ours side by side, then every part (`sections`).

use placegraph::eval::CellScores;

use super::markdown::{measures, percent, table, with_measures};
use super::results::{Experiment, Results, Setting};
use super::sections;

/// The whole page; it links to `remarks` next to it, if there are any.
pub(super) fn page(results: &Results, remarks: Option<&str>) -> String {
    let parts = [
        introduction(results, remarks),
        summary(results),
        all_measures(results),
        results.experiments.iter().map(sections::experiment).collect::<Vec<_>>().join("\n"),
        sections::networks(&results.networks, &results.experiments[0].best),
        sections::orders(&results.orders),
        sections::rounds(results),
        sections::iterations(results),
        sections::features(&results.features),
        sections::pairs(&results.pairs),
        sections::drawings(&results.drawings),
    ];
    parts.join("\n")
}

fn introduction(results: &Results, remarks: Option<&str>) -> String {
    let settings = &results.settings;
    let text = format!(
        "# The chapter's experiments\n\n\
         Sect. 4.8 repeated with placegraph {version}: `cargo run --release -p placegraph-reproduce -- DATA`. Every figure is the share of labeled \
         free cells of the test part that got the drawn label; cells drawn as ambiguous do not count. The whole map is \
         labeled, and the cells of the test part are judged. Scans see the whole map.\n\n\
         * **Chapter's setting**: T = {rounds} rounds, temperature 1, one scale, all training cells (with several scales \
         {scaled} per class), the order of the decision list chosen on held-out blocks of the training cells, 50 \
         iterations of the relaxation, the two corrections.\n\
         * **Best setting**: rounds (of {candidates:?}) and temperature chosen on held-out blocks of the training cells \
         (with several scales {scaled} per class, evenly taken; for a network's list, and where whole buildings are learned \
         from, {most}); narrow passages are marked as doorways before the corrections.\n\n\
         The chapter's labels were not published with its maps. Those used here are drawn by hand, and so are the \
         borders of doorways, on which much depends: see [how far two drawings agree](#how-far-two-drawings-agree). \
         \"Within one cell\" also counts a cell as right if its label is drawn in one of its eight neighbors.\n",
        version = results.version,
        rounds = settings.rounds,
        scaled = settings.max_cells_scaled,
        candidates = settings.best_rounds,
        most = settings.max_cells,
    );
    match remarks {
        Some(page) => format!("{text}\nOn this run, and why figures differ: [{page}]({page}).\n"),
        None => text,
    }
}

/// A figure of the chapter and ours.
struct Compared<'a> {
    section: &'static str,
    title: String,
    stage: &'static str,
    /// In per cent.
    published: f64,
    chapter: &'a CellScores,
    best: Option<&'a CellScores>,
}

fn compared(results: &Results) -> Vec<Compared<'_>> {
    let mut rows = Vec::new();
    for Experiment { section, title, published, chapter, best, .. } in &results.experiments {
        let stages = [
            ("decision list", published.list, &chapter.list, &best.list),
            ("relaxation and corrections", published.corrected, &chapter.corrected, &best.corrected),
        ];
        rows.extend(stages.map(|(stage, published, chapter, best)| {
            let title = (*title).to_owned();
            Compared { section, title, stage, published, chapter, best: Some(best) }
        }));
    }
    if let [chapter, .., best] = &results.networks[..] {
        let title = "Building 79, left part to right part".to_owned();
        let (chapter, best) = (&chapter.found, Some(&best.found));
        rows.push(Compared { section: "4.8.3", title, stage: "network", published: 97.6, chapter, best });
    }
    for row in &results.orders {
        let [new, old] = row.published;
        let sets = [("new features", new, &row.new, Some(&row.best)), ("old features", old, &row.old, None)];
        rows.extend(sets.map(|(stage, published, chapter, best)| {
            let title = format!("Table 4.1, {}", row.order[..2].join("-"));
            Compared { section: "4.8.4", title, stage, published, chapter, best }
        }));
    }
    rows
}

/// The figure of the chapter and ours, a row a figure; then which are missed.
fn summary(results: &Results) -> String {
    let rows = compared(results);
    let head = [
        "Sect.",
        "experiment",
        "stage",
        "chapter",
        "chapter's setting",
        "difference",
        "best setting",
        "difference",
    ];
    let cells = rows.iter().map(|row| {
        let ours = [Some(row.chapter), row.best].into_iter().flat_map(|scores| {
            let accuracy = scores.and_then(|scores| scores.accuracy);
            let difference = accuracy.map(|found| 100.0 * found - row.published);
            [percent(accuracy), difference.map_or_else(|| "–".to_owned(), |points| format!("{points:+.2}"))]
        });
        let published = percent(Some(row.published / 100.0));
        let first = [row.section.to_owned(), row.title.clone(), row.stage.to_owned(), published];
        first.into_iter().chain(ours).collect()
    });
    let chapter = missed("The chapter's setting", rows.iter().map(|row| (row, Some(row.chapter))));
    let best = missed("The best setting", rows.iter().map(|row| (row, row.best)));
    format!("## Side by side\n\n{}\n{chapter} {best}\n", table(&head, cells))
}

/// How many of the chapter's figures `setting` reaches, and which it misses by how much.
fn missed<'a>(
    setting: &str,
    rows: impl Iterator<Item = (&'a Compared<'a>, Option<&'a CellScores>)>,
) -> String {
    let found = |scores: &CellScores| scores.accuracy.map(|accuracy| 100.0 * accuracy);
    let rows: Vec<_> = rows.filter_map(|(row, scores)| Some((row, found(scores?)?))).collect();
    let below: Vec<String> = rows
        .iter()
        .filter(|(row, found)| *found < row.published)
        .map(|(row, found)| format!("{}, {} ({:+.2})", row.title, row.stage, found - row.published))
        .collect();
    let reached = format!("{setting} reaches {} of {} figures", rows.len() - below.len(), rows.len());
    if below.is_empty() { format!("{reached}.") } else { format!("{reached}; not {}.", below.join("; not ")) }
}

/// All measures of every stage.
fn all_measures(results: &Results) -> String {
    let mut rows = Vec::new();
    let mut row = |first: [&str; 3], scores: &CellScores| {
        rows.push(first.map(str::to_owned).into_iter().chain(measures(scores)).collect());
    };
    for Experiment { title, chapter, best, .. } in &results.experiments {
        for (name, setting, last) in
            [("chapter's", chapter, "corrected"), ("best", best, sections::CORRECTED)]
        {
            let Setting { list, relaxed, corrected, .. } = setting;
            for (stage, scores) in [("list", list), ("relaxed", relaxed), (last, corrected)] {
                row([title, name, stage], scores);
            }
        }
    }
    let head = with_measures(&["experiment", "setting", "stage"]);
    format!("## All measures\n\n{}", table(&head, rows))
}
