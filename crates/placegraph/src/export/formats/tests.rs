use super::*;
use crate::export::{is_stamped, stamped_map};

#[test]
fn dates_of_seconds() {
    let at = |seconds| timestamp(Duration::from_secs(seconds));
    assert_eq!(at(0), "01-01-1970_00-00-00");
    // 10957 days to 2000-01-01, a leap year of a century: 59 more to the 29th of February.
    assert_eq!(at((10_957 + 59) * 86_400 + 3_661), "02-29-2000_01-01-01");
    assert_eq!(at(10_957 * 86_400 - 1), "12-31-1999_23-59-59");
    assert_eq!(at(253_402_300_799), "12-31-9999_23-59-59");
}

#[test]
fn a_mask_has_three_files_named_alike() {
    let names = |format: &str, main: &str| Format::by_name(format).unwrap().file_names(main);
    assert_eq!(names("nav2-speed", "slow.yaml").unwrap(), ["slow.yaml", "slow.png", "slow_params.yaml"]);
    assert!(names("nav2-speed", "slow.png").is_err());
    assert_eq!(names("svg", "any.thing").unwrap(), ["any.thing"]);
}

#[test]
fn a_stamp_stands_where_a_format_has_room_for_remarks() {
    let stamped = |text: &str, ending| String::from_utf8(with_stamp(text.into(), ending, "S")).unwrap();
    assert_eq!(stamped("a: 1\n", "yaml"), "# S\na: 1\n");
    assert_eq!(stamped("graph {}", "dot"), "// S\ngraph {}");
    assert_eq!(stamped("<?xml version=\"1.0\"?><svg/>", "svg"), "<?xml version=\"1.0\"?><!-- S --><svg/>");
    assert_eq!(stamped("<svg/>", "svg"), "<!-- S --><svg/>");
    assert_eq!(stamped("{\"type\":1}", "geojson"), "{\"written_by\":\"S\",\"type\":1}");
    assert_eq!(stamped("PNG", "png"), "PNG");
    let stamp = b"# written by placegraph 0.1.0; map sha256:12ab; model sha256:34cd";
    assert_eq!(stamped_map(stamp).as_deref(), Some("12ab"));
    assert_eq!(stamped_map(b"map sha256:12ab"), None);
    assert!(is_stamped(b"<!-- written by placegraph 0.1.0 -->") && !is_stamped(b"see placegraph"));
}

#[test]
fn no_name_of_a_format_or_file_stands_twice() {
    let mut names: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
    let mut files: Vec<String> =
        FORMATS.iter().flat_map(|format| format.file_names(&format.usual_name("map")).unwrap()).collect();
    for list in [&mut names.iter().map(|&name| name.to_owned()).collect(), &mut files] {
        let n = list.len();
        list.sort_unstable();
        list.dedup();
        assert_eq!(list.len(), n, "{list:?}");
    }
    names.sort_unstable();
    assert!(Format::by_name("nothing").is_none());
}
