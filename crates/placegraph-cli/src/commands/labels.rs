//! `placegraph labels`: labels of a map from one format to another.

use std::path::{Path, PathBuf};

use anyhow::Result;
use placegraph::export::LabelSheet;
use placegraph::grid::{Cell, Grid};
use placegraph::import::LabelTarget;
use placegraph::labels::LabelCell;

use super::Outcome;
use crate::args::{LabelFormatArg, LabelsArgs};
use crate::classes::{self, Classes};
use crate::output::write_file;
use crate::read;

/// Reads labels, a result or a label file, and writes them in a format that people correct.
pub(crate) fn run(args: &LabelsArgs) -> Result<Outcome> {
    let map = read::map(&args.map, &args.read)?;
    let from = if args.from.is_dir() { args.from.join("labels.png") } else { args.from.clone() };
    let Classes { label_set, coding } = Classes::of(args.classes.as_deref(), &from)?;
    let image = map.files.last().map_or(args.map.as_path(), PathBuf::as_path);
    let name = image.file_stem().unwrap_or_default().to_string_lossy();
    let cells = classes::labels(&from, args.read.max_cells, &LabelTarget::of(&name, &map.grid, &coding))?;
    // What is painted on walls is nobody's.
    let on_free =
        |(cell, label): (Cell, &LabelCell)| if map.grid.is_free(cell) { *label } else { LabelCell::None };
    let values = cells.cells().zip(cells.values()).map(on_free).collect();
    let cells = Grid::from_rows(cells.width(), cells.height(), values);
    let image = path_from(image, &args.output);
    let sheet = LabelSheet { cells: &cells, map: &map.grid, classes: &label_set, image: &image };
    let bytes = match args.to {
        LabelFormatArg::Png => sheet.png(),
        LabelFormatArg::Labelme => sheet.labelme(),
        LabelFormatArg::Coco => sheet.coco(),
        LabelFormatArg::Geojson => sheet.geojson(),
    }?;
    let inputs: Vec<PathBuf> = map.files.iter().cloned().chain([from]).collect();
    write_file(&args.output, &bytes, &inputs)?;
    Ok(Outcome::Done)
}

/// The path of `image` as a file at `from` names it: its name alone if both lie in one folder.
fn path_from(image: &Path, from: &Path) -> String {
    let folder =
        |path: &Path| std::path::absolute(path).ok().and_then(|path| path.parent().map(Path::to_owned));
    let name = if folder(image) == folder(from) {
        image.file_name().map(PathBuf::from)
    } else {
        std::path::absolute(image).ok()
    };
    name.unwrap_or_else(|| image.to_owned()).to_string_lossy().into_owned()
}
