//! Label and room images.

use placegraph::grid::Cell;
use placegraph::import::{LabelCell, LabelCoding, LabelImageError, read_labels, read_rooms};
use placegraph::labels::{Label, LabelSet};

fn classes() -> LabelCoding {
    LabelCoding::of(&LabelSet::default())
}

#[test]
fn values_stand_for_classes_and_the_first_row_is_the_top() {
    let cells = read_labels(b"P2 2 2 255  0 255  1 3", (2, 2), &classes()).unwrap();
    assert_eq!(cells[Cell::new(0, 1)], LabelCell::None);
    assert_eq!(cells[Cell::new(1, 1)], LabelCell::Ignore);
    assert_eq!(cells.row(0), [LabelCell::Class(Label(0)), LabelCell::Class(Label(2))]);
}

#[test]
fn an_unknown_value_is_counted_and_located() {
    let error = read_labels(b"P2 3 2 255  0 1 2  0 7 7", (3, 2), &classes()).unwrap_err();
    let LabelImageError::UnknownValue { value, n_pixels, x, y, .. } = error else { panic!("{error}") };
    assert_eq!((value, n_pixels, x, y), ([7; 3], 2, 1, 1));
    let text = error_text(b"P3 1 1 255 9 8 7", (1, 1));
    assert!(text.contains("color [9, 8, 7]") && text.contains("gray 255"), "{text}");
}

fn error_text(bytes: &[u8], size: (u32, u32)) -> String {
    read_labels(bytes, size, &classes()).unwrap_err().to_string()
}

#[test]
fn another_size_depth_or_format_is_an_error() {
    let text = error_text(b"P2 3 2 255  0 1 2  0 1 1", (2, 3));
    assert!(text.contains("2 x 3") && text.contains("found 3 x 2"), "{text}");
    let wide = read_labels(b"P2 1 1 65535 300", (1, 1), &classes());
    assert!(matches!(wide, Err(LabelImageError::PixelType { .. })));
    assert!(matches!(read_labels(b"text", (1, 1), &classes()), Err(LabelImageError::Image(_))));
    assert!(matches!(read_rooms(b"P3 1 1 255 1 1 1", (1, 1)), Err(LabelImageError::PixelType { .. })));
}

#[test]
fn colors_and_grays_of_ones_own() {
    let coding = LabelCoding::new(vec![
        ([77; 3], LabelCell::Class(Label(1))),
        ([255, 0, 0], LabelCell::Class(Label(0))),
        ([0; 3], LabelCell::None),
    ]);
    let cells = read_labels(b"P3 3 1 255  255 0 0  77 77 77  0 0 0", (3, 1), &coding).unwrap();
    assert_eq!(cells.values(), [LabelCell::Class(Label(0)), LabelCell::Class(Label(1)), LabelCell::None]);
}

#[test]
fn room_ids_have_8_or_16_bits() {
    assert_eq!(read_rooms(b"P2 2 1 255 0 200", (2, 1)).unwrap().values(), [0, 200]);
    assert_eq!(read_rooms(b"P2 1 2 65535 0 40000", (1, 2)).unwrap().values(), [40000, 0]);
}
