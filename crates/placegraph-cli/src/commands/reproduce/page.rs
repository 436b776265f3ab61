//! The page: what was done, the chapter's figures and ours side by side, then every part (`sections`).

use placegraph::eval::CellScores;

use super::markdown::{measures, percent, table, with_measures};
use super::results::{Experiment, Results, Setting};
use super::sections;

/// The whole page.
pub(super) fn page(results: &Results) -> String {
    let parts = [
        introduction(results),
        summary(results),
        all_measures(results),
        results.experiments.iter().map(sections::experiment).collect::<Vec<_>>().join("\n"),
        sections::networks(&results.networks),
        sections::orders(&results.orders),
        sections::rounds(results),
        sections::iterations(results),
        sections::features(&results.features),
        sections::pairs(&results.pairs),
        sections::drawings(&results.drawings),
    ];
    parts.join("\n")
}

fn introduction(results: &Results) -> String {
    let settings = &results.settings;
    format!(
        "# The chapter's experiments\n\n\
         Sect. 4.8 repeated with placegraph {version}: `placegraph reproduce DATA`. Every figure is the share of labeled \
         free cells of the test part that got the drawn label; cells drawn as ambiguous do not count. The whole map is \
         labeled, and the cells of the test part are judged. Scans see the whole map.\n\n\
         * **Chapter's setting**: T = {rounds} rounds, temperature 1, one scale, all training cells (with several scales \
         {scaled} per class), the order of the decision list chosen on held-out blocks of the training cells, 50 \
         iterations of the relaxation, the two corrections.\n\
         * **Best setting**: rounds (of {candidates:?}) and temperature chosen on held-out blocks of the training cells, \
         at most {most} training cells per class, evenly taken ({scaled} with several scales); narrow passages are marked \
         as doorways before the corrections.\n\n\
         The chapter's labels were not published with its maps. Those used here are drawn by hand, and so are the \
         borders of doorways, on which much depends: see [how far two drawings agree](#how-far-two-drawings-agree). \
         \"Within one cell\" also counts a cell as right if its label is drawn in one of its eight neighbors.\n",
        version = results.version,
        rounds = settings.rounds,
        scaled = settings.max_cells_scaled,
        candidates = settings.best_rounds,
        most = settings.max_cells,
    )
}

/// The figure of the chapter and ours, a row a figure.
fn summary(results: &Results) -> String {
    let mut rows = Vec::new();
    for experiment in &results.experiments {
        let Experiment { section, title, published, chapter, best, .. } = experiment;
        let stages = [
            ("decision list", published.list, &chapter.list, &best.list),
            ("relaxation and corrections", published.corrected, &chapter.corrected, &best.corrected),
        ];
        for (stage, published, chapter, best) in stages {
            rows.push(summary_row(section, title, stage, Some(published), Some(chapter), Some(best)));
        }
    }
    let mut networks = results.networks.iter();
    if let Some(chapter) = networks.next() {
        let title = format!("Network, building 79, cells of {:.0} cm", 100.0 * chapter.cell_m);
        let best = networks.next().map(|network| &network.found);
        rows.push(summary_row("4.8.3", &title, "network", Some(97.6), Some(&chapter.found), best));
    }
    for network in networks {
        let title = format!("Network, building 79, cells of {:.0} cm", 100.0 * network.cell_m);
        rows.push(summary_row("4.8.3", &title, "network", None, None, Some(&network.found)));
    }
    for row in &results.orders {
        for (features, published, found) in
            [("new features", row.published[0], &row.new), ("old features", row.published[1], &row.old)]
        {
            let title = format!("Table 4.1, {}", row.order[..2].join("-"));
            rows.push(summary_row("4.8.4", &title, features, Some(published), Some(found), None));
        }
    }
    let head = ["Sect.", "experiment", "stage", "chapter", "chapter's setting", "difference", "best setting"];
    format!("## Side by side\n\n{}", table(&head, rows))
}

fn summary_row(
    section: &str,
    title: &str,
    stage: &str,
    published: Option<f64>,
    chapter: Option<&CellScores>,
    best: Option<&CellScores>,
) -> Vec<String> {
    let accuracy = |scores: Option<&CellScores>| scores.and_then(|scores| scores.accuracy);
    let difference = published.zip(accuracy(chapter)).map(|(published, found)| 100.0 * found - published);
    vec![
        section.to_owned(),
        title.to_owned(),
        stage.to_owned(),
        percent(published.map(|published| published / 100.0)),
        percent(accuracy(chapter)),
        difference.map_or_else(|| "–".to_owned(), |difference| format!("{difference:+.2}")),
        percent(accuracy(best)),
    ]
}

/// All measures of every stage.
fn all_measures(results: &Results) -> String {
    let mut rows = Vec::new();
    let mut row = |first: [&str; 3], scores: &CellScores| {
        rows.push(first.map(str::to_owned).into_iter().chain(measures(scores)).collect());
    };
    for Experiment { title, chapter, best, .. } in &results.experiments {
        for (name, setting, last) in
            [("chapter's", chapter, "corrected"), ("best", best, "doorways marked, corrected")]
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
