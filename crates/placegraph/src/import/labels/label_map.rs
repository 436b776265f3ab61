//! The `labelmap.txt` of segmentation masks as CVAT and Datumaro write them (Pascal VOC): a color for every class.
//!
//! Lines are `name:red,green,blue:parts:actions`; lines that begin with `#` are comments. `background` is what has no class.

use super::{LabelCoding, LabelFileError};
use crate::labels::LabelCell;

/// Name of the file.
pub(super) const NAME: &str = "labelmap.txt";

/// `coding` with the colors of a label map instead of its own. Names without a meaning are left out: an error of the image says
/// which colors were not known.
pub(super) fn coding(text: &[u8], coding: &LabelCoding) -> Result<LabelCoding, LabelFileError> {
    let text = String::from_utf8_lossy(text);
    let mut pixels: Vec<([u8; 3], LabelCell)> = Vec::new();
    for (line, number) in text.lines().map(str::trim).zip(1..) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let wrong = || LabelFileError::LabelMap { line: number, found: line.chars().take(80).collect() };
        // A name may have colons, a color has none.
        let mut from_end = line.rsplitn(4, ':').skip(2);
        let color = from_end.next().and_then(color).ok_or_else(wrong)?;
        let name = from_end.next().ok_or_else(wrong)?;
        pixels.extend(coding.named(name).map(|cell| (color, cell)));
    }
    Ok(coding.with_pixels(pixels))
}

fn color(text: &str) -> Option<[u8; 3]> {
    let samples: Vec<u8> = text.split(',').map(|v| v.trim().parse().ok()).collect::<Option<_>>()?;
    samples.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::labels::{Label, LabelSet};

    #[test]
    fn colors_come_from_the_lines() {
        let own = LabelCoding::of(&LabelSet::default());
        let text = b"# label:color_rgb:parts:actions\nbackground:0,0,0::\nroom:51,221,255::\nlamp:1,1,1::\n";
        let coding = coding(text, &own).unwrap();
        assert_eq!(coding.meaning([51, 221, 255]), Some(LabelCell::Class(Label(1))));
        assert_eq!((coding.meaning([0; 3]), coding.meaning([1; 3])), (Some(LabelCell::None), None));
        for bad in ["room", "room:1,2::", "room:1,2,256::", "room:1,2,3"] {
            let error = super::coding(bad.as_bytes(), &own).unwrap_err().to_string();
            assert!(error.contains("line 1"), "{error}");
        }
    }
}
