//! The table of formats in the page on exports is what the library's table says.

use placegraph::export::formats_markdown;

const BEGIN: &str = "<!-- formats: written from the library's table, see CONTRIBUTING.md -->\n";
const END: &str = "<!-- end of formats -->\n";

#[test]
fn the_table_of_formats_is_current() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/exports.md");
    let page = std::fs::read_to_string(path).unwrap();
    let start = page.find(BEGIN).unwrap() + BEGIN.len();
    let end = page.find(END).unwrap();
    let current = format!("{}{}{}", &page[..start], formats_markdown(), &page[end..]);
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(path, &current).unwrap();
    }
    let committed = std::fs::read_to_string(path).unwrap();
    assert!(committed == current, "docs/exports.md is stale: run this test with REGENERATE=1");
}
