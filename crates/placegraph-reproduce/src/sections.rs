//! The parts of the page, one an experiment or table.

use std::fmt::Write;

use super::PICTURES;
use super::markdown::{confusion, measures, percent, share, table, with_measures};
use super::results::{
    ClassVotes, Correction, Drawings, Errors, Experiment, Network, OrderRow, Pair, Point, Results, Setting,
};

/// The last stage of the best setting.
pub(super) const CORRECTED: &str = "doorways marked, corrected";

/// Pictures, confusions, corrections and errors of one experiment.
pub(super) fn experiment(experiment: &Experiment) -> String {
    let Experiment { section, title, chapter, best, corrections, errors, .. } = experiment;
    [
        format!("## {section} {title}\n\n{}\n", choices(chapter, best)),
        gallery(experiment.id),
        format!("Cells in the chapter's setting, corrected:\n\n{}", confusion(&chapter.corrected)),
        format!("Cells in the best setting:\n\n{}", confusion(&best.corrected)),
        effects(corrections),
        shortfall(experiment, errors),
    ]
    .join("\n")
}

fn choices(chapter: &Setting, best: &Setting) -> String {
    let choice = |setting: &Setting| {
        format!(
            "{} training examples, {} rounds, temperature {}, order {}, {} places",
            setting.n_training_cells,
            setting.rounds,
            setting.temperature,
            setting.order.join("-"),
            setting.n_places
        )
    };
    format!("Chapter's setting: {}. Best setting: {}.", choice(chapter), choice(best))
}

fn gallery(id: &str) -> String {
    let picture = |name: &str, caption: &str| format!("![{caption}]({PICTURES}/{id}-{name}.png)");
    let rows = [
        [("drawn", "Drawn labels; the line parts training and test"), ("1-list", "The decision list")],
        [("2-relaxed", "After the relaxation"), ("3-corrected", "After the corrections")],
        [("errors", "Errors of the chapter's setting"), ("topology", "Its topological map")],
        [("best", "The best setting"), ("best-errors", "Its errors")],
    ];
    let mut text =
        "Corridors blue, rooms yellow, doorways red; wrong cells magenta, cells that do not count gray.\n\n"
            .to_owned();
    let mut rows = rows.iter();
    if let Some(first) = rows.next() {
        text += &table(&first.map(|(_, caption)| caption), [first.map(|(n, c)| picture(n, c)).to_vec()]);
    }
    for row in rows {
        let _ = writeln!(text, "| {} | {} |", row[0].1, row[1].1);
        let _ = writeln!(text, "| {} | {} |", picture(row[0].0, row[0].1), picture(row[1].0, row[1].1));
    }
    let _ = writeln!(text, "\n{}", picture("best-topology", "The topological map in the best setting"));
    text
}

fn effects(corrections: &[Correction]) -> String {
    let row = |correction: &Correction| {
        let counts = [correction.n_relabeled_regions, correction.n_regions].map(|n| n.to_string());
        std::iter::once(correction.name.to_owned())
            .chain(counts)
            .chain(measures(&correction.scores))
            .collect()
    };
    let head = with_measures(&["correction", "regions relabeled", "regions left"]);
    format!(
        "What the corrections of Sect. 4.7 do, in the chapter's setting:\n\n{}",
        table(&head, corrections.iter().map(row))
    )
}

/// How far the chapter's setting is from the chapter's figure, and where the errors lie.
fn shortfall(experiment: &Experiment, errors: &Errors) -> String {
    let (published, scores) = (experiment.published.corrected, &experiment.chapter.corrected);
    let difference = 100.0 * scores.accuracy.unwrap_or(0.0) - published;
    let n_cells = (difference.abs() / 100.0 * scores.n_cells as f64).round();
    let side = if difference < 0.0 { "below" } else { "above" };
    let Errors { n_wrong, n_doorway, n_near, n_disputed, patches } = errors;
    let mut text = format!(
        "After the corrections the chapter's setting is {:.2} points ({n_cells} of {} cells) {side} the chapter's \
         {published} %. Of its {n_wrong} wrong cells {} are drawn or were found as doorway, {} have a neighbor that is \
         drawn as what they were found to be",
        difference.abs(),
        scores.n_cells,
        share(*n_doorway, *n_wrong),
        share(*n_near, *n_wrong),
    );
    if let Some(n_disputed) = n_disputed {
        let _ = write!(text, ", {} have the label of the second drawing", share(*n_disputed, *n_wrong));
    }
    let n_listed: u64 = patches.iter().map(|patch| u64::from(patch.n_cells)).sum();
    let _ = writeln!(
        text,
        ". The largest connected patches of one kind of error hold {} of the wrong cells:\n",
        share(n_listed, *n_wrong)
    );
    let rows = patches.iter().map(|patch| {
        let [x, y] = patch.center_m;
        vec![
            patch.truth.clone(),
            patch.found.clone(),
            patch.n_cells.to_string(),
            share(patch.n_cells.into(), *n_wrong),
            format!("({x:.1}, {y:.1})"),
        ]
    });
    text + &table(&["drawn", "found", "cells", "of all wrong", "around, in m"], rows)
}

/// Sect. 4.8.3; `boosted` is the boosted method's best setting on the same building.
pub(super) fn networks(networks: &[Network], boosted: &Setting) -> String {
    let row = |network: &Network, stage: &str, scores| {
        let first = [
            network.title.to_owned(),
            format!("{:.0} cm", 100.0 * network.cell_m),
            network.n_nodes.to_string(),
            network.n_features.to_string(),
            format!("{}, {}", network.n_neighbors, network.cost),
            stage.to_owned(),
        ];
        first.into_iter().chain(measures(scores)).collect()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    for network in networks {
        rows.push(row(network, "node scores alone", &network.alone));
        rows.push(row(network, "network", &network.found));
        rows.extend(network.corrected.iter().map(|scores| row(network, CORRECTED, scores)));
    }
    for (stage, scores) in [("relaxed", &boosted.relaxed), (CORRECTED, &boosted.corrected)] {
        let first = ["no network: the list, best setting", "5 cm", "–", "–", "–", stage].map(str::to_owned);
        rows.push(first.into_iter().chain(measures(scores)).collect());
    }
    let head = with_measures(&["nodes see", "cell", "nodes", "features", "M, C", "labels by"]);
    let mut text = format!(
        "## 4.8.3 Instance-based network, building 79\n\n\
         The chapter: 97.6 % on 8088 nodes with 30 of 203 features, and some doorways lost. Its network sees distances to \
         stored cells alone; the best setting's sees a decision list's confidences too, and every cell is a node. M neighbors \
         per class and the cost C are chosen on held-out blocks of the left part. \"Within one cell\": a cell is here a \
         node.\n\n{}\n",
        table(&head, rows)
    );
    for (number, network) in networks.iter().enumerate() {
        let picture =
            |name: &str| format!("![{}]({PICTURES}/network-{}{name}.png)", network.title, number + 1);
        let caption = format!("{}, {:.0} cm", network.title, 100.0 * network.cell_m);
        text += &table(&[&caption, "errors"], [vec![picture(""), picture("-errors")]]);
        let _ = write!(text, "\nIts cells:\n\n{}\n", confusion(&network.found));
    }
    text.pop();
    text
}

/// Table 4.1.
pub(super) fn orders(orders: &[OrderRow]) -> String {
    let rows = orders.iter().flat_map(|row| {
        let [new, old] = row.published.map(|published| percent(Some(published / 100.0)));
        let none = || "–".to_owned();
        let sets = [
            ("new", new, percent(row.held_out_accuracy), &row.new),
            ("old", old, none(), &row.old),
            ("new, best setting", none(), none(), &row.best),
        ];
        sets.map(|(set, published, held_out, scores)| {
            let first = [row.order[..2].join("-"), set.to_owned(), published, held_out];
            first.into_iter().chain(measures(scores)).collect()
        })
    });
    let head = with_measures(&["order", "features", "chapter", "held out"]);
    format!(
        "## Table 4.1: order of the list, old and new features\n\n\
         Building 79, the decision list alone, in the chapter's setting where nothing else is said. New: all features of this program; old: the 152 \
         features of Sect. 3.4. \"Held out\" is the accuracy on held-out training cells, which chooses the order.\n\n{}",
        table(&head, rows)
    )
}

fn curve(what: &str, points: &[Point]) -> String {
    let row = |point: &Point| {
        std::iter::once(point.at.to_string()).chain(measures(&point.scores)).collect::<Vec<_>>()
    };
    table(&with_measures(&[what]), points.iter().map(row))
}

/// Accuracy over T.
pub(super) fn rounds(results: &Results) -> String {
    format!(
        "## Rounds of boosting\n\nBuilding 79, the decision list alone, in the order of the chapter's setting. One run of \
         the most rounds: boosting is nested.\n\n![Accuracy over rounds]({PICTURES}/rounds.svg)\n\n{}",
        curve("T", &results.rounds)
    )
}

/// Accuracy over iterations.
pub(super) fn iterations(results: &Results) -> String {
    let mut text = format!(
        "## Iterations of the relaxation\n\nThe chapter's setting; 0 is the decision list.\n\n\
         ![Accuracy over iterations]({PICTURES}/iterations.svg)\n"
    );
    for one in &results.iterations {
        let _ = write!(text, "\n{}:\n\n{}", one.title, curve("iterations", &one.points));
    }
    text
}

/// The most informative features.
pub(super) fn features(classes: &[ClassVotes]) -> String {
    let mut text =
        "## The most informative features\n\nBuilding 79, chapter's setting: sum of α over the stumps that \
                    look at the feature.\n"
            .to_owned();
    for ClassVotes { class, features } in classes {
        let rows = features.iter().map(|(name, description, alpha)| {
            vec![name.clone(), (*description).to_owned(), format!("{alpha:.2}")]
        });
        let _ = write!(text, "\n{}", table(&[class, "what it measures", "sum of α"], rows));
    }
    text
}

/// Every building as training map of the others.
pub(super) fn pairs(pairs: &[Pair]) -> String {
    let rows = pairs.iter().flat_map(|pair| {
        let Pair { train, test, chapter, best } = pair;
        let stages = [
            ("chapter's", "list", &chapter.list),
            ("chapter's", "corrected", &chapter.corrected),
            ("best", "list", &best.list),
            ("best", CORRECTED, &best.corrected),
        ];
        stages.map(|(setting, stage, scores)| {
            let first = [train, test, setting, stage].map(str::to_owned);
            first.into_iter().chain(measures(scores)).collect()
        })
    });
    let head = with_measures(&["trained on", "tested on", "setting", "stage"]);
    format!(
        "## From building to building\n\nWhole buildings for training, thinned as in the best setting; one scale; whole \
         buildings for the test.\n\n{}",
        table(&head, rows)
    )
}

/// The second drawings.
pub(super) fn drawings(drawings: &[Drawings]) -> String {
    let rows = drawings.iter().map(|Drawings { title, scores }| {
        std::iter::once((*title).to_owned()).chain(measures(scores)).collect::<Vec<_>>()
    });
    let mut text = "## How far two drawings agree\n\nA second set of labels of the same maps, made apart from the first, \
                    judged as if it were found. A result that agrees with one drawing better than the other drawing \
                    does says nothing.\n\n"
        .to_owned();
    if drawings.is_empty() {
        return text + "There is no second drawing in the data.\n";
    }
    text += &table(&with_measures(&["map"]), rows);
    for Drawings { title, scores } in drawings {
        let _ = write!(text, "\n{title}; the columns are the second drawing:\n\n{}", confusion(scores));
    }
    text
}
