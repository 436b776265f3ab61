//! Whether a result that is there is the one that would be made now, or one to which files are to be added.

use anyhow::Result;
use placegraph::export::{FORMATS, FileRecord, Format, ModelInfo, TopologyDocument};
use placegraph::import::LoadedMap;
use placegraph::result::{ResultContents, export_word, exported, is_export, is_previous};

use super::result;
use super::setup::{Context, Setup};
use crate::document::{self, DOCUMENT};
use crate::output::{Committed, Existing, OutputSet, lock_and_recover};

/// A result that need not be made again.
pub(super) struct Resumed {
    pub(super) document: TopologyDocument,
    /// What was written and removed because other formats are asked for now.
    pub(super) changed: Option<Committed>,
}

/// The result in the folder if it is whole and made from `map` just as it would be made now; where other formats are
/// asked for, it gets them first. `None` if it must be made again.
pub(super) fn resume(map: &LoadedMap, setup: &Setup<'_>, context: &Context) -> Result<Option<Resumed>> {
    // What a killed run left is undone first, also where nothing is written then.
    drop(lock_and_recover(&context.folder)?);
    let path = context.folder.join(DOCUMENT);
    let Ok(found) = document::read(&path, setup.args.read.max_cells) else { return Ok(None) };
    let now = Identity {
        version: env!("CARGO_PKG_VERSION"),
        options: &context.options,
        map_hash: &map.hash,
        map_name: &map.name,
        model: &setup.model.info(),
    };
    if !now.is_of(&found, context.continues) || !document::faults(&found, &context.folder).is_empty() {
        return Ok(None);
    }
    let missing: Vec<&Format> =
        setup.formats.iter().copied().filter(|format| !has_format(&found, format)).collect();
    if missing.iter().any(|format| format.needs_cells) {
        return Ok(None);
    }
    let is_asked = |option: &String| setup.formats.iter().any(|format| *option == export_word(format));
    let has_more = found.program.options.iter().any(|option| is_export(option) && !is_asked(option));
    if missing.is_empty() && !has_more {
        return Ok(Some(Resumed { document: found, changed: None }));
    }
    let (files, document) = with_formats(found, &missing, setup)?;
    Ok(Some(Resumed { document, changed: Some(files.commit(&context.folder)?) }))
}

/// What a result is made from.
struct Identity<'a> {
    version: &'a str,
    options: &'a [String],
    map_hash: &'a str,
    map_name: &'a str,
    model: &'a ModelInfo,
}

impl Identity<'_> {
    /// Whether `found` was made from this. A result that `continues` itself was made from an older state of itself,
    /// which is gone.
    fn is_of(&self, found: &TopologyDocument, continues: bool) -> bool {
        fn relevant(options: &[String], continues: bool) -> Vec<&String> {
            let is_left_out = |option: &String| is_export(option) || (continues && is_previous(option));
            options.iter().filter(|option| !is_left_out(option)).collect()
        }
        found.program.version == self.version
            && relevant(&found.program.options, continues) == relevant(self.options, continues)
            && found.map.hash == self.map_hash
            && found.map.name == self.map_name
            && found.model.as_ref() == Some(self.model)
    }
}

fn has_format(document: &TopologyDocument, format: &Format) -> bool {
    document.program.options.contains(&export_word(format))
}

/// The result with the formats that are asked for now: `missing` ones are made from the document, others go.
fn with_formats(
    mut document: TopologyDocument,
    missing: &[&'static Format],
    setup: &Setup<'_>,
) -> Result<(OutputSet, TopologyDocument)> {
    let is_asked = |format: &&Format| setup.formats.iter().any(|asked| asked.name == format.name);
    // Usual names are names.
    let names =
        |format: &Format| format.file_names(&format.usual_name(&document.map.name)).unwrap_or_default();
    let dropped: Vec<String> = FORMATS.iter().filter(|format| !is_asked(format)).flat_map(names).collect();
    let is_dropped = |file: &FileRecord| dropped.contains(&file.name);
    let kept: Vec<FileRecord> = document.files.iter().filter(|file| !is_dropped(file)).cloned().collect();
    document.program.options.retain(|option| !is_export(option));
    document.program.options.extend(setup.formats.iter().map(|format| export_word(format)));
    document.skipped.retain(|skipped| setup.formats.iter().any(|format| format.name == skipped.format));
    let mut files = OutputSet::new(Existing::ReplaceResult);
    files.keep_inputs(&[], setup.args.force);
    let contents = ResultContents { formats: missing, ..setup.contents() };
    let added = exported(&mut document, &contents, None)?;
    result::join(&mut files, added, &mut document, kept)?;
    Ok((files, document))
}

#[cfg(test)]
mod tests {
    use placegraph::export::MapInfo;
    use placegraph::grid::OccupancyGrid;
    use placegraph::labels::LabelSet;
    use placegraph::topology::TopologicalMap;

    use super::*;

    fn found() -> TopologyDocument {
        let info = MapInfo::of(&OccupancyGrid::from_ascii(0.1, "..."), "home", "map hash");
        let model = ModelInfo { name: "default".to_owned(), hash: "model hash".to_owned() };
        let topology = TopologicalMap::default();
        let mut document = TopologyDocument::new(info, Some(model), &LabelSet::default(), &topology);
        document.program.options =
            ["--no-doorways", "--previous sha256:1", "--edits sha256:2", "--export svg"]
                .map(str::to_owned)
                .into();
        document
    }

    #[test]
    fn a_result_is_that_of_its_map_model_options_and_version() {
        let document = found();
        let options: Vec<String> = document.program.options.clone();
        let model = document.model.clone().unwrap();
        let same = Identity {
            version: &document.program.version,
            options: &options,
            map_hash: "map hash",
            map_name: "home",
            model: &model,
        };
        assert!(same.is_of(&document, false) && same.is_of(&document, true));
        // Formats are compared where they can be added.
        assert!(Identity { options: &options[..3], ..same }.is_of(&document, false));
        assert!(!Identity { version: "0.0.9", ..same }.is_of(&document, false));
        assert!(!Identity { map_hash: "other", ..same }.is_of(&document, false));
        assert!(!Identity { map_name: "office", ..same }.is_of(&document, false));
        for model in [
            ModelInfo { name: "other".to_owned(), ..model.clone() },
            ModelInfo { hash: "other".to_owned(), ..model.clone() },
        ] {
            assert!(!Identity { model: &model, ..same }.is_of(&document, false));
        }
        for n in 0..3 {
            let mut without = options.clone();
            let option = without.remove(n);
            let continues = is_previous(&option);
            assert!(!Identity { options: &without, ..same }.is_of(&document, false), "without {option}");
            assert_eq!(
                Identity { options: &without, ..same }.is_of(&document, true),
                continues,
                "without {option}"
            );
            let mut changed = options.clone();
            changed[n] += "7";
            assert!(!Identity { options: &changed, ..same }.is_of(&document, false), "other than {option}");
        }
        let more = [&options[..], &["--stages".to_owned()]].concat();
        assert!(!Identity { options: &more, ..same }.is_of(&document, false));
    }
}
