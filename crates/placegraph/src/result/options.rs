//! The options of a result, in the words of its document: what the result depends on besides its map and its model.

use super::ResultContents;
use crate::export::{Format, Georeference};
use crate::geom::Point2;
use crate::import::ros::Rules;
use crate::import::{Gray205, ReadOptions};
use crate::pipeline::Config;
use crate::topology::reach::Robot;

/// What a result depends on besides its map and its model. As long as the [words](Self::words) are the same, so is the result.
#[derive(Clone, Copy, Debug)]
pub struct ResultOptions<'a> {
    /// How the map was read.
    pub read: &'a ReadOptions,
    /// Which stages ran.
    pub config: &'a Config,
    /// Which files the result has.
    pub contents: &'a ResultContents<'a>,
    /// The other files that were read.
    pub inputs: &'a InputHashes,
}

/// SHA-256 of the files that a result was made from besides its map and its model, in hexadecimal digits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InputHashes {
    /// The values of the masks.
    pub masks: Option<String>,
    /// The earlier result.
    pub previous: Option<String>,
    /// The edit file.
    pub edits: Option<String>,
}

impl ResultOptions<'_> {
    /// The options that are not at their defaults, as the document lists them: like the options of the program, in a fixed
    /// order, a file by its hash.
    ///
    /// Every field of the structs is named here: a new one does not compile until it has its place.
    pub fn words(&self) -> Vec<String> {
        let ReadOptions {
            resolution_m,
            occupied_thresh,
            free_thresh,
            rules,
            gray_205,
            topic,
            // What they refuse has no result.
            named_files: _,
            max_cells: _,
        } = self.read;
        let Config {
            // Programs switch these two together.
            doorways,
            spaces: _,
            correction,
            robot: Robot { radius_m, from },
            hold,
            align_previous,
            // Named by their hashes.
            edits: _,
            previous: _,
        } = self.config;
        let ResultContents {
            stages,
            probabilities,
            formats,
            georeference,
            // Named by their hash.
            masks: _,
            // The clock is no option.
            written: _,
        } = self.contents;
        let InputHashes { masks, previous, edits } = self.inputs;

        let with = |name: &str, value: &dyn std::fmt::Display| word(name, &format!(" {value}"));
        let file = |name: &str, hash: &Option<String>| {
            hash.as_ref().map(|hash| with(name, &format_args!("sha256:{hash}")))
        };
        let options = [
            stages.then(|| word("stages", "")),
            probabilities.then(|| word("probabilities", "")),
            doorways.is_none().then(|| word("no-doorways", "")),
            (!correction).then(|| word("no-correction", "")),
            (*rules == Rules::Humble).then(|| with("rules", &"humble")),
            // Nothing is held on to without an earlier result.
            (*hold && previous.is_some()).then(|| word("hold", "")),
            align_previous.then(|| word("align", "")),
            (*rules == Rules::Ros1).then(|| with("rules", &"ros1")),
            (*gray_205 == Gray205::AsFile).then(|| word("trust-thresholds", "")),
            occupied_thresh.map(|threshold| with("occupied-thresh", &threshold)),
            free_thresh.map(|threshold| with("free-thresh", &threshold)),
            (*radius_m > 0.0).then(|| with("robot-radius", radius_m)),
            georeference.map(|Georeference { latitude_deg, longitude_deg, heading_deg }| {
                with("georeference", &format_args!("{latitude_deg},{longitude_deg},{heading_deg}"))
            }),
            from.map(|Point2 { x, y }| with("from", &format_args!("{x},{y}"))),
            topic.as_ref().map(|topic| with("topic", topic)),
            resolution_m.map(|resolution_m| with("resolution", &resolution_m)),
            file("masks", masks),
            file(PREVIOUS, previous),
            file("edits", edits),
        ];
        options.into_iter().flatten().chain(formats.iter().map(|format| export_word(format))).collect()
    }
}

const PREVIOUS: &str = "previous";
const EXPORT: &str = "export";

/// How a document names that `format` was asked for.
pub fn export_word(format: &Format) -> String {
    word(EXPORT, &format!(" {}", format.name))
}

/// Whether `option` asks for a format.
pub fn is_export(option: &str) -> bool {
    option.starts_with(&word(EXPORT, " "))
}

/// Whether `option` names the earlier result.
pub fn is_previous(option: &str) -> bool {
    option.starts_with(&word(PREVIOUS, " "))
}

fn word(name: &str, value: &str) -> String {
    format!("--{name}{value}")
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::export::{FORMATS, MaskSettings};

    /// The words of what `change` makes of the defaults.
    fn words(
        change: impl FnOnce(&mut ReadOptions, &mut Config, &mut ResultContents<'_>, &mut InputHashes),
    ) -> Vec<String> {
        let masks = MaskSettings::default();
        let (mut read, mut config, mut inputs) =
            (ReadOptions::default(), Config::default(), InputHashes::default());
        let mut contents = ResultContents {
            stages: false,
            probabilities: false,
            formats: &[],
            masks: &masks,
            georeference: None,
            written: Duration::ZERO,
        };
        change(&mut read, &mut config, &mut contents, &mut inputs);
        ResultOptions { read: &read, config: &config, contents: &contents, inputs: &inputs }.words()
    }

    #[test]
    fn options_at_their_defaults_are_not_named() {
        assert_eq!(words(|_, _, _, _| ()), [""; 0]);
    }

    #[test]
    fn options_have_fixed_words_in_a_fixed_order() {
        let formats: Vec<&Format> = FORMATS.iter().filter(|format| format.name.starts_with("svg")).collect();
        let found = words(|read, config, contents, inputs| {
            *read = ReadOptions {
                resolution_m: Some(0.05),
                occupied_thresh: Some(0.6),
                free_thresh: Some(0.2),
                rules: Rules::Ros1,
                gray_205: Gray205::AsFile,
                topic: Some("/map".to_owned()),
                ..ReadOptions::default()
            };
            *config = Config { correction: false, align_previous: true, ..Config::chapter() };
            config.robot = Robot { radius_m: 0.3, from: Some(Point2::new(1.0, -2.5)) };
            (contents.stages, contents.probabilities, contents.formats) = (true, true, formats.leak());
            contents.georeference = Georeference::new(48.0, 7.85, 12.5);
            *inputs = InputHashes {
                masks: Some("m".to_owned()),
                previous: Some("p".to_owned()),
                edits: Some("e".to_owned()),
            };
        });
        assert_eq!(
            found,
            [
                "--stages",
                "--probabilities",
                "--no-doorways",
                "--no-correction",
                "--align",
                "--rules ros1",
                "--trust-thresholds",
                "--occupied-thresh 0.6",
                "--free-thresh 0.2",
                "--robot-radius 0.3",
                "--georeference 48,7.85,12.5",
                "--from 1,-2.5",
                "--topic /map",
                "--resolution 0.05",
                "--masks sha256:m",
                "--previous sha256:p",
                "--edits sha256:e",
                "--export svg",
            ]
        );
        assert_eq!(words(|read, _, _, _| read.rules = Rules::Humble), ["--rules humble"]);
        assert_eq!(found.iter().filter(|word| is_export(word)).count(), 1);
        assert_eq!(found.iter().filter(|word| is_previous(word)).count(), 1);
    }
}
