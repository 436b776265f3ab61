//! The open map, and what can be asked of it.
//!
//! Every answer is made by the library calls that the program makes with the same map, model and edit file, so that both
//! write the same bytes.

use placegraph::export::{
    FORMATS, Format, ReportInput, view_json, view_labels, view_occupancy, view_probability,
};
use placegraph::grid::{Grid, GridShape, Occupancy, OccupancyGrid};
use placegraph::import::{LoadedMap, load_map_from};
use placegraph::model::Model;
use placegraph::pipeline::{self, Analysis, Recognized};
use placegraph::progress::Progress;
use placegraph::topology::edits::{Edit, EditFile, Outcome};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::message::{Message, block};
use crate::result::{EDITS, NamedModel, ResultOf, config, read_options};
use crate::teach::{Painted, TrainingSet};

/// What can be asked.
#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
enum Request {
    /// Reads the map in the byte strings, the first of which is its main file.
    Open { names: Vec<String>, resolution_m: Option<f64> },
    /// Reads the text of an edit file.
    ParseEdits { text: String },
    /// Labels the map, applies the edits, and answers with all that the page shows; with pictures if they changed.
    Replay { edits: Vec<Edit> },
    /// The files of the result with these edits, and of these formats.
    Export { edits: Vec<Edit>, formats: Vec<String> },
    /// The class of every cell with these edits, numbered from 1; 0 for cells without one.
    Labels { edits: Vec<Edit> },
    /// The training file of painted maps and what it names; with folders, the files of the maps too.
    TrainingFiles {
        #[serde(flatten)]
        painted: Painted,
        has_folders: bool,
    },
    /// Trains a model on painted maps.
    Train {
        #[serde(flatten)]
        painted: Painted,
        max_cells_per_class: usize,
    },
    /// Labels with the model in the byte string from now on; without a name, with the library's own.
    UseModel { name: Option<String> },
}

/// An answer: an object, and byte strings.
pub(crate) type Answer = (Value, Vec<Vec<u8>>);

/// The state between two requests.
#[derive(Debug, Default)]
pub struct Session {
    opened: Option<Opened>,
    /// The model to label with, if it is not the library's own.
    model: Option<NamedModel>,
}

/// The map that is open.
#[derive(Debug)]
struct Opened {
    map: LoadedMap,
    resolution_m: Option<f64>,
    model: NamedModel,
    /// The map as it is, and as the last edits drew it, with their regions: other edits are replayed on these at once.
    recognized: Vec<(OccupancyGrid, Recognized)>,
    /// The last edits and what came of them.
    last: Option<(Vec<Edit>, Analysis)>,
    /// The cells that the page has pictures of.
    pictured: Option<Grid<Occupancy>>,
}

impl Session {
    /// Answers a request, see [`crate::message`]. What is wrong with it is the member `error` of the answer.
    pub fn answer(&mut self, request: &[u8], progress: &dyn Progress) -> Vec<u8> {
        match self.try_answer(request, progress) {
            Ok((json, blobs)) => block(json, &blobs),
            Err(message) => block(json!({ "error": { "message": message } }), &[]),
        }
    }

    fn try_answer(&mut self, request: &[u8], progress: &dyn Progress) -> Result<Answer, String> {
        let message = Message::parse(request).ok_or("expected a request")?;
        let request = Request::deserialize(&message.json).map_err(in_words)?;
        match request {
            Request::Open { names, resolution_m } => self.open(&names, &message.blobs, resolution_m),
            Request::ParseEdits { text } => {
                let file = EditFile::from_toml(&text).map_err(in_words)?;
                Ok((json!({ "edits": file.edits }), Vec::new()))
            }
            Request::Replay { edits } => self.opened()?.replay(edits, progress),
            Request::Export { edits, formats } => self.opened()?.export(edits, &formats, progress),
            Request::Labels { edits } => self.opened()?.labels(edits, progress),
            Request::TrainingFiles { painted, has_folders } => {
                let set = TrainingSet::new(&painted, &message.blobs, has_folders)?;
                let (names, blobs): (Vec<String>, Vec<Vec<u8>>) = set.files().into_iter().unzip();
                Ok((json!({ "files": names }), blobs))
            }
            Request::Train { painted, max_cells_per_class } => {
                TrainingSet::new(&painted, &message.blobs, true)?.train(max_cells_per_class, progress)
            }
            Request::UseModel { name } => self.use_model(name, &message.blobs),
        }
    }

    fn opened(&mut self) -> Result<&mut Opened, String> {
        self.opened.as_mut().ok_or_else(|| "expected an open map, found none".to_owned())
    }

    fn open(
        &mut self,
        names: &[String],
        blobs: &[&[u8]],
        resolution_m: Option<f64>,
    ) -> Result<Answer, String> {
        self.opened = None;
        let files: Vec<(&str, &[u8])> = names.iter().map(String::as_str).zip(blobs.iter().copied()).collect();
        let map = load(&files, resolution_m)?;
        let answer = json!({ "map": { "name": map.name, "hash": map.hash } });
        let model = self.model.clone().unwrap_or_else(NamedModel::builtin);
        self.opened =
            Some(Opened { map, resolution_m, model, recognized: Vec::new(), last: None, pictured: None });
        Ok((answer, Vec::new()))
    }

    fn use_model(&mut self, name: Option<String>, blobs: &[&[u8]]) -> Result<Answer, String> {
        let named = |name| {
            let bytes = blobs.first().ok_or("expected a model, found no file")?;
            Ok::<_, String>(NamedModel { name, model: Model::from_json(bytes).map_err(in_words)? })
        };
        self.model = name.map(named).transpose()?;
        let model = self.model.clone().unwrap_or_else(NamedModel::builtin);
        let answer = json!({ "name": model.name, "classes": model.model.label_set.classes() });
        if let Some(opened) = &mut self.opened {
            opened.model = model;
            opened.recognized.clear();
            (opened.last, opened.pictured) = (None, None);
        }
        Ok((answer, Vec::new()))
    }
}

/// Reads the map of `files`, the main one first, within what a browser can label.
pub(crate) fn load(files: &[(&str, &[u8])], resolution_m: Option<f64>) -> Result<LoadedMap, String> {
    let (main, _) = files.first().ok_or("expected a map, found no file")?;
    load_map_from(main, files, &read_options(resolution_m)).map_err(in_words)
}

/// An error and what caused it.
pub(crate) fn in_words(error: impl std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        let cause = error.to_string();
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
        source = error.source();
    }
    text
}

impl Opened {
    /// Has what comes of `edits` in `last`.
    fn analyze(&mut self, edits: Vec<Edit>, progress: &dyn Progress) {
        if self.last.as_ref().is_some_and(|(of, _)| *of == edits) {
            return;
        }
        let Self { map, model, recognized, .. } = self;
        let config = config(edits);
        let model = &model.model;
        let analysis = pipeline::analyze_with(&map.grid, model, &config, progress, &mut |grid| {
            if let Some((_, kept)) = recognized.iter().find(|(of, _)| of == grid) {
                return kept.clone();
            }
            let found = pipeline::recognize(grid, model, &config, progress);
            recognized.truncate(1);
            recognized.push((grid.clone(), found.clone()));
            found
        });
        self.last = Some((config.edits, analysis));
    }

    fn result_of<'a>(&'a self, analysis: &'a Analysis, edits_toml: &'a str) -> ResultOf<'a> {
        ResultOf { map: &self.map, resolution_m: self.resolution_m, model: &self.model, analysis, edits_toml }
    }

    fn replay(&mut self, edits: Vec<Edit>, progress: &dyn Progress) -> Result<Answer, String> {
        let edits_toml = edit_text(&edits)?;
        self.analyze(edits, progress);
        let (_, analysis) = self.last.as_ref().ok_or("expected an analysis")?;
        let result = self.result_of(analysis, &edits_toml);
        let labeled = result.labeled();
        let (document, grid) = (result.document(&[]), labeled.grid());
        let view = view_json(&ReportInput {
            title: &self.map.name,
            frame_id: &document.map.frame_id,
            map: &document.topology(),
            labels: &self.model.model.label_set,
            shape: &GridShape::of(&self.map.grid),
            occupancy: None,
            probability: None,
            findings: &document.findings,
            provenance: "",
        });
        let outcome = |outcome: &Outcome| match outcome {
            Ok(applied) => json!({ "line": applied.line }),
            Err(reason) => json!({ "error": reason.to_string() }),
        };
        let outcomes: Vec<Value> = analysis.edit_outcomes.iter().map(outcome).collect();
        let formats = FORMATS.iter().map(|format| json!({ "id": format.name, "doc": format.doc }));
        let answer = json!({
            "view": serde_json::from_str::<Value>(&view).map_err(in_words)?,
            "outcomes": outcomes,
            "edits_toml": edits_toml,
            "formats": formats.collect::<Vec<_>>(),
            "model": self.model.name,
        });
        let mut pictures = Vec::new();
        if self.pictured.as_ref() != Some(&grid.cells) {
            pictures = vec![view_occupancy(&grid.cells), view_probability(&labeled.probability())];
            self.pictured = Some(grid.cells.clone());
        }
        Ok((answer, pictures))
    }

    fn labels(&mut self, edits: Vec<Edit>, progress: &dyn Progress) -> Result<Answer, String> {
        self.analyze(edits, progress);
        let (_, analysis) = self.last.as_ref().ok_or("expected an analysis")?;
        let labels = view_labels(&analysis.space.graph, &analysis.labeling);
        Ok((json!({ "classes": self.model.model.label_set.classes() }), vec![labels]))
    }

    fn export(
        &mut self,
        edits: Vec<Edit>,
        formats: &[String],
        progress: &dyn Progress,
    ) -> Result<Answer, String> {
        let edits_toml = edit_text(&edits)?;
        let known =
            |name: &String| Format::by_name(name).ok_or_else(|| format!("expected a format, found {name:?}"));
        let formats = formats.iter().map(known).collect::<Result<Vec<_>, _>>()?;
        self.analyze(edits, progress);
        let (_, analysis) = self.last.as_ref().ok_or("expected an analysis")?;
        let (document, mut files) = self.result_of(analysis, &edits_toml).files(&formats)?;
        if !edits_toml.is_empty() {
            files.push((EDITS.to_owned(), edits_toml.into_bytes()));
        }
        let (names, blobs): (Vec<String>, Vec<Vec<u8>>) = files.into_iter().unzip();
        Ok((json!({ "files": names, "skipped": document.skipped }), blobs))
    }
}

/// The edit file that the program replays; empty without edits.
fn edit_text(edits: &[Edit]) -> Result<String, String> {
    if edits.is_empty() {
        return Ok(String::new());
    }
    let file = EditFile { edits: edits.to_vec() };
    file.check().map_err(in_words)?;
    toml::to_string(&file).map_err(in_words)
}

#[cfg(test)]
mod tests {
    use placegraph::progress::Silent;

    use super::*;

    const YAML: &[u8] = include_bytes!("../page/example/map.yaml");
    const IMAGE: &[u8] = include_bytes!("../page/example/map.png");

    fn ask(session: &mut Session, json: Value, blobs: &[Vec<u8>]) -> (Value, Vec<Vec<u8>>) {
        let answer = session.answer(&block(json, blobs), &Silent);
        let message = Message::parse(&answer).unwrap_or(Message { json: Value::Null, blobs: Vec::new() });
        (message.json, message.blobs.iter().map(|blob| blob.to_vec()).collect())
    }

    fn opened() -> Session {
        let mut session = Session::default();
        let names = json!(["map.yaml", "map.png"]);
        let open = json!({ "op": "open", "names": names, "resolution_m": null });
        let (answer, _) = ask(&mut session, open, &[YAML.to_vec(), IMAGE.to_vec()]);
        assert_eq!(answer["map"]["name"], "map");
        session
    }

    #[test]
    fn what_is_asked_wrongly_is_an_error_in_words() {
        let mut session = Session::default();
        for wrong in [json!({}), json!({ "op": "fly" }), json!({ "op": "replay", "edits": [] })] {
            let (answer, _) = ask(&mut session, wrong, &[]);
            assert!(
                answer["error"]["message"].as_str().is_some_and(|message| message.len() > 10),
                "{answer}"
            );
        }
        assert!(Message::parse(&session.answer(b"\x01", &Silent)).is_some());
        let edits =
            json!({ "op": "parse_edits", "text": "[[edit]]\naction = \"split\"\nline = [[0, nan], [1, 1]]" });
        assert!(ask(&mut session, edits, &[]).0["error"]["message"].is_string());
    }

    #[test]
    fn a_replay_on_kept_regions_is_the_same_as_one_from_nothing() {
        let split = json!({ "action": "split", "line": [[-14.0, 1.0], [-10.0, 1.0]] });
        let wall = json!({ "action": "close", "line": [[-15.0, 4.0], [-13.0, 4.0]] });
        let name = json!({ "action": "rename", "at": [-14.0, 1.0], "name": "kitchen" });
        let lists =
            [json!([]), json!([split, name]), json!([wall, name]), json!([wall, split]), json!([name])];
        let export = |session: &mut Session, edits: &Value| {
            let (json, files) =
                ask(session, json!({ "op": "export", "edits": edits, "formats": ["nav2", "report"] }), &[]);
            (json["files"].clone(), files)
        };
        let mut kept = opened();
        for edits in &lists {
            let (names, files) = export(&mut kept, edits);
            assert!(names.as_array().is_some_and(|names| names.len() >= 8), "{names}");
            assert!((names, files) == export(&mut opened(), edits), "{edits}");
        }
    }

    #[test]
    fn pictures_are_sent_when_they_change() {
        let mut session = opened();
        let wall = json!([{ "action": "close", "line": [[-15.0, 4.0], [-13.0, 4.0]] }]);
        let n_pictures = |session: &mut Session, edits: &Value| {
            let (answer, pictures) = ask(session, json!({ "op": "replay", "edits": edits }), &[]);
            assert!(answer["view"]["places"].as_array().is_some_and(|places| places.len() > 10), "{answer}");
            pictures.len()
        };
        assert_eq!(n_pictures(&mut session, &json!([])), 2);
        assert_eq!(n_pictures(&mut session, &json!([])), 0);
        assert_eq!(n_pictures(&mut session, &wall), 2);
        assert_eq!(n_pictures(&mut session, &json!([])), 2);
    }

    #[test]
    fn labels_are_those_of_the_result() {
        let mut session = opened();
        let (answer, labels) = ask(&mut session, json!({ "op": "labels", "edits": [] }), &[]);
        assert_eq!(answer["classes"][2]["name"], "doorway");
        let (names, files) = ask(&mut session, json!({ "op": "export", "edits": [], "formats": [] }), &[]);
        let names = names["files"].as_array().cloned().unwrap_or_default();
        let png = names.iter().position(|name| name == "labels.png").map(|at| files[at].as_slice());
        let mut reader =
            png::Decoder::new(std::io::Cursor::new(png.unwrap_or_default())).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap_or_default()];
        reader.next_frame(&mut pixels).unwrap();
        assert!(labels[0] == pixels && pixels.contains(&3));
    }

    #[test]
    fn a_trained_model_labels_from_then_on_until_the_own_one_is_back() {
        let mut session = opened();
        let (_, labels) = ask(&mut session, json!({ "op": "labels", "edits": [] }), &[]);
        let classes = json!([
            { "name": "hall", "role": "passage", "color": [1, 2, 3] },
            { "name": "office", "role": "place", "color": [4, 5, 6] },
            { "name": "gap", "role": "doorway", "color": [7, 8, 9] },
        ]);
        let maps = json!([{ "names": ["map.yaml", "map.png"], "resolution_m": null }]);
        let train = json!({ "op": "train", "maps": maps, "classes": classes, "max_cells_per_class": 20 });
        let (report, model) = ask(&mut session, train, &[YAML.to_vec(), IMAGE.to_vec(), labels[0].clone()]);
        assert!(report["held_out"]["accuracy"].as_f64().is_some_and(|share| share > 0.5), "{report}");
        let classes_with = |session: &mut Session, model: &[Vec<u8>], name: Value| {
            let (answer, _) = ask(session, json!({ "op": "use_model", "name": name }), model);
            assert!(answer["error"].is_null(), "{answer}");
            let (answer, pictures) = ask(session, json!({ "op": "replay", "edits": [] }), &[]);
            assert_eq!(pictures.len(), 2);
            (answer["view"]["classes"][0]["name"].clone(), answer["model"].clone())
        };
        assert_eq!(
            classes_with(&mut session, &model, json!("own.model.json")),
            (json!("hall"), json!("own.model.json"))
        );
        assert_eq!(classes_with(&mut session, &[], Value::Null), (json!("corridor"), json!("default")));
        let (answer, _) = ask(&mut session, json!({ "op": "use_model", "name": "x" }), &[b"{}".to_vec()]);
        assert!(
            answer["error"]["message"].as_str().is_some_and(|message| message.contains("model")),
            "{answer}"
        );
    }
}
