//! COCO annotations: polygons and run-length masks in pixels, y down from the upper left corner.

use serde::Deserialize;

use super::paint::Canvas;
use super::{LabelFileError, LabelTarget, parsed};
use crate::labels::LabelCell;

const KIND: &str = "the JSON of COCO annotations";

#[derive(Deserialize)]
struct File {
    images: Vec<Image>,
    categories: Vec<Category>,
    annotations: Vec<Annotation>,
}

#[derive(Deserialize)]
struct Image {
    id: i64,
    width: u64,
    height: u64,
    #[serde(default)]
    file_name: String,
}

#[derive(Deserialize)]
struct Category {
    id: i64,
    name: String,
}

#[derive(Deserialize)]
struct Annotation {
    #[serde(default)]
    id: i64,
    image_id: i64,
    category_id: i64,
    #[serde(default)]
    segmentation: Option<Segmentation>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Segmentation {
    /// x, y, x, y … of every part.
    Polygons(Vec<Vec<f64>>),
    Runs {
        size: [u64; 2],
        counts: Counts,
    },
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Counts {
    Numbers(Vec<u64>),
    Packed(String),
}

pub(super) fn paint(
    bytes: &[u8],
    target: &LabelTarget<'_>,
    canvas: &mut Canvas,
) -> Result<(), LabelFileError> {
    let file: File = parsed(bytes, KIND)?;
    let image = file.image(target)?;
    for annotation in file.annotations.iter().filter(|annotation| annotation.image_id == image) {
        let what = || format!("annotation {}", annotation.id);
        let wrong = |message: String| LabelFileError::Shape { what: what(), message };
        let category = file.categories.iter().find(|category| category.id == annotation.category_id);
        let category =
            category.ok_or_else(|| wrong(format!("there is no category {}", annotation.category_id)))?;
        let cell = target.meaning(&category.name, what)?;
        annotation.paint(cell, canvas).map_err(wrong)?;
    }
    Ok(())
}

impl File {
    /// The id of the image that is the map: the only one, the only one of its size, or the one called like it.
    fn image(&self, target: &LabelTarget<'_>) -> Result<i64, LabelFileError> {
        let expected = target.size;
        let fits = |image: &&Image| (image.width, image.height) == (expected.0.into(), expected.1.into());
        if let [only] = &self.images[..] {
            target.check_size((only.width, only.height), "labels for an image")?;
            return Ok(only.id);
        }
        let fitting: Vec<&Image> = self.images.iter().filter(fits).collect();
        let is_called_so = |image: &&&Image| stem(&image.file_name) == target.name;
        let called: Vec<&&Image> = fitting.iter().filter(is_called_so).collect();
        match (&fitting[..], &called[..]) {
            ([only], _) => Ok(only.id),
            (_, [only]) => Ok(only.id),
            _ => Err(LabelFileError::Images {
                expected,
                map: target.name.to_owned(),
                n_found: self.images.len(),
                n_fitting: fitting.len(),
            }),
        }
    }
}

fn stem(path: &str) -> &str {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

impl Annotation {
    fn paint(&self, cell: LabelCell, canvas: &mut Canvas) -> Result<(), String> {
        match &self.segmentation {
            Some(Segmentation::Polygons(parts)) if !parts.is_empty() => {
                for part in parts {
                    let (points, rest) = part.as_chunks::<2>();
                    if !rest.is_empty() {
                        return Err(format!("expected pairs of x and y, found {} numbers", part.len()));
                    }
                    canvas.fill(&[points.iter().map(|&point| canvas.at_pixel(point)).collect()], cell);
                }
                Ok(())
            }
            Some(Segmentation::Runs { size, counts }) => {
                let (width, height) = canvas.size();
                if *size != [u64::from(height), u64::from(width)] {
                    return Err(format!(
                        "expected a mask of {width} x {height} pixels, found {} x {}",
                        size[1], size[0]
                    ));
                }
                let runs = match counts {
                    Counts::Numbers(runs) => runs.clone(),
                    Counts::Packed(text) => unpacked(text.as_bytes())?,
                };
                paint_runs(&runs, cell, canvas)
            }
            _ => Err("expected a polygon or a mask: a box alone does not say which cells".into()),
        }
    }
}

/// Runs of pixels outside and inside in turn, column by column from the left, each from the top.
fn paint_runs(runs: &[u64], cell: LabelCell, canvas: &mut Canvas) -> Result<(), String> {
    let (width, height) = canvas.size();
    let n_pixels = u64::from(width) * u64::from(height);
    let total = runs.iter().try_fold(0u64, |sum, &run| sum.checked_add(run));
    if total != Some(n_pixels) {
        return Err(format!("expected a mask of {n_pixels} pixels, found runs of another sum"));
    }
    let mut at = 0;
    for (index, run) in runs.iter().enumerate() {
        for pixel in (at..at + run).filter(|_| index % 2 == 1) {
            let (x, row) = (pixel / u64::from(height), pixel % u64::from(height));
            canvas.set_from_top(x as i64, row as i64, cell);
        }
        at += run;
    }
    Ok(())
}

/// The runs of a packed mask: 5 bits a character, the lowest first, with a sign; from the third run on, the difference to the run two
/// before (`rleFrString` of pycocotools).
fn unpacked(text: &[u8]) -> Result<Vec<u64>, String> {
    let wrong = || "the packed runs of its mask are damaged".to_owned();
    let mut runs: Vec<u64> = Vec::new();
    let mut characters = text.iter();
    while let Some(&first) = characters.next() {
        let (mut value, mut shift, mut character) = (0i64, 0, first);
        loop {
            let bits = character.checked_sub(48).filter(|&bits| bits < 64).ok_or_else(wrong)?;
            value |= i64::from(bits & 0x1f) << shift;
            shift += 5;
            if bits & 0x20 == 0 {
                if bits & 0x10 != 0 {
                    value |= -1 << shift;
                }
                break;
            }
            if shift > 50 {
                return Err(wrong());
            }
            character = *characters.next().ok_or_else(wrong)?;
        }
        let before = if runs.len() > 2 { runs[runs.len() - 2] as i64 } else { 0 };
        runs.push(before.checked_add(value).and_then(|run| u64::try_from(run).ok()).ok_or_else(wrong)?);
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_runs_by_hand() {
        // 6 1 40 4: 6; 1; 40 = 8 + 32 in two characters; 4 - 1 = 3.
        assert_eq!(unpacked(b"61X13").unwrap(), [6, 1, 40, 4]);
        // From the fourth run on, a difference: 2, 3, 4, then 1 - 3 = -2, which is 11110 in five bits.
        assert_eq!(unpacked(b"234N").unwrap(), [2, 3, 4, 1]);
        // Then 5 - 4 and 7 - 1.
        assert_eq!(unpacked(b"234N16").unwrap(), [2, 3, 4, 1, 5, 7]);
        for bad in ["\u{7f}", "X", "200N", "oooooooooooooooooooo0"] {
            assert!(unpacked(bad.as_bytes()).is_err(), "{bad}");
        }
    }

    #[test]
    fn file_names_lose_folder_and_extension() {
        assert_eq!([stem("a/b.c/map.v2.png"), stem("C:\\x\\map"), stem("")], ["map.v2", "map", ""]);
    }
}
