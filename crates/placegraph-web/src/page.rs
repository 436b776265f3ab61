//! One HTML file: the page's modules, the viewer that it shares with the report, and the library.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use placegraph::export::{VIEWER_STYLE, fill_page, in_script, viewer_script};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// The library as WebAssembly, packed by LZMA, if the crate was built with it: `build-library`, then `PLACEGRAPH_WASM`.
pub const LIBRARY: Option<&[u8]> = include!(concat!(env!("OUT_DIR"), "/library.rs"));

const TEMPLATE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/page.css");
/// The script of the worker thread.
const WORKER: [&str; 2] = [include_str!("../page/lzma.js"), include_str!("../page/worker.js")];

/// The page's modules, each after those that it uses.
const MODULES: [&str; 22] = [
    include_str!("../page/acts.js"),
    include_str!("../page/history.js"),
    include_str!("../page/files.js"),
    include_str!("../page/engine.js"),
    include_str!("../page/store.js"),
    include_str!("../page/zip.js"),
    include_str!("../page/covers.js"),
    include_str!("../page/cursor.js"),
    include_str!("../page/linetool.js"),
    include_str!("../page/scaledialog.js"),
    include_str!("../page/toolbar.js"),
    include_str!("../page/tabs.js"),
    include_str!("../page/places.js"),
    include_str!("../page/editlist.js"),
    include_str!("../page/takealong.js"),
    include_str!("../page/painting.js"),
    include_str!("../page/letters.js"),
    include_str!("../page/shapes.js"),
    include_str!("../page/painttool.js"),
    include_str!("../page/teachpanel.js"),
    include_str!("../page/teach.js"),
    include_str!("../page/app.js"),
];

/// The map that is offered as an example.
const EXAMPLE: [(&str, &[u8]); 2] = [
    ("map.yaml", include_bytes!("../page/example/map.yaml")),
    ("map.png", include_bytes!("../page/example/map.png")),
];

/// What a page opens with.
#[derive(Clone, Debug, Default)]
pub enum Start<'a> {
    /// Nothing.
    #[default]
    Empty,
    /// A map, which is labeled at once.
    Map {
        /// Names and bytes of its files, the main one first.
        files: Vec<(String, Vec<u8>)>,
        /// Meters per pixel, for an image alone.
        resolution_m: Option<f64>,
        /// The text of its edit file, if there is one.
        edits: Option<String>,
    },
    /// A result, as [`placegraph::export::view_json`] gives it: to look at, and to be mended once its map is opened.
    Result(&'a str),
}

/// The page with the packed `library` inside.
///
/// # Errors
/// If the result is no JSON.
pub fn page_html(library: &[u8], start: &Start<'_>) -> Result<String, serde_json::Error> {
    let mut data = json!({ "example": files(EXAMPLE.iter().map(|&(name, bytes)| (name, bytes))) });
    match start {
        Start::Empty => {}
        Start::Map { files: given, resolution_m, edits } => {
            let files = files(given.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
            data["map"] = json!({ "files": files, "resolution_m": resolution_m, "edits": edits });
        }
        Start::Result(view) => data["result"] = serde_json::from_str(view)?,
    }
    let script = compact(&viewer_script(&MODULES));
    // Only this very script runs, whatever a name or a file may hold; and nothing is fetched from anywhere.
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{}' 'wasm-unsafe-eval' blob:; worker-src blob:; style-src 'unsafe-inline'; \
         img-src blob: data:; base-uri 'none'; form-action 'none'",
        STANDARD.encode(Sha256::digest(script.as_bytes()))
    );
    Ok(fill_page(
        TEMPLATE,
        &[
            ("@CSP@", &policy),
            ("@STYLE@", &format!("{VIEWER_STYLE}{STYLE}")),
            ("@LIBRARY@", &in_seven_bits(library)),
            ("@WORKER@", &compact(&WORKER.concat())),
            ("@DATA@", &in_script(&data.to_string())),
            ("@SCRIPT@", &script),
        ],
    ))
}

fn files<'a>(files: impl Iterator<Item = (&'a str, &'a [u8])>) -> Value {
    files.map(|(name, bytes)| json!({ "name": name, "base64": STANDARD.encode(bytes) })).collect()
}

/// What HTML does not leave as it is.
const LEFT_OUT: [u32; 3] = [0, '\r' as u32, '<' as u32];

/// `bytes` as text, seven bits a byte of UTF-8, so that the page is a seventh smaller than with base 64. What HTML does not leave
/// as it is is joined with the seven bits after it to one character, which UTF-8 writes with two bytes: nothing is lost.
fn in_seven_bits(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len() / 7 * 8 + 8);
    let mut left_out = None;
    let mut push = |code: u32| match (left_out.take(), LEFT_OUT.iter().position(|&other| other == code)) {
        (Some(which), _) => text.extend(char::from_u32((2 + which) << 7 | code)),
        (None, Some(which)) => left_out = Some(which as u32),
        (None, None) => text.extend(char::from_u32(code)),
    };
    let (mut bits, mut n_bits) = (0u32, 0);
    for &byte in bytes {
        bits = bits << 8 | u32::from(byte);
        n_bits += 8;
        while n_bits >= 7 {
            n_bits -= 7;
            push(bits >> n_bits & 127);
        }
    }
    if n_bits > 0 {
        push(bits << (7 - n_bits) & 127);
    }
    // Nothing comes after the last: it stands in the upper half of a byte's values.
    text.extend(left_out.and_then(|which| char::from_u32(128 | LEFT_OUT[which as usize])));
    text
}

/// A script without indentation, comments on lines of their own, and the mark of what modules export.
fn compact(script: &str) -> String {
    let lines = script.lines().map(str::trim_start);
    let code = lines.filter(|line| !line.starts_with("//") && !line.starts_with("/**"));
    code.flat_map(|line| [line.strip_prefix("export ").unwrap_or(line), "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_edits_cannot_leave_their_element() {
        let evil = "</script><script>alert(1)</script>".to_owned();
        let files = vec![(evil.clone(), Vec::new())];
        let page =
            page_html(b"", &Start::Map { files, resolution_m: None, edits: Some(evil) }).unwrap_or_default();
        assert!(page.contains("alert(1)") && !page.contains("<script>alert(1)"));
        assert_eq!(page.matches("</script>").count(), 4, "library, worker, data, script");
    }

    /// 0x81 0x80 = 1000000 1100000 00(00000): the last bits are filled up with zeros.
    #[test]
    fn bytes_are_written_seven_bits_at_a_time() {
        assert_eq!(in_seven_bits(&[0x81, 0x80]), "@`\u{80}");
        assert_eq!(in_seven_bits(b""), "");
        // 0x00 0x35 … : 0000000 0001101 0111100 1011100 and 0001101: each that is left out takes the next with it.
        assert_eq!(in_seven_bits(&[0x00, 0x35, 0xe5, 0xc0]), "\u{10d}\u{25c}\u{80}");
        assert_eq!(in_seven_bits(&[0x1a]), "\u{180}");
        assert_eq!(in_seven_bits(&[0xff; 7]), "\u{7f}".repeat(8));
    }

    #[test]
    fn scripts_can_be_made_compact_line_by_line() {
        assert_eq!(
            compact("/** x */\nexport const a = 1; // b\n  // c\n  f();\n"),
            "const a = 1; // b\nf();\n"
        );
        for module in MODULES.iter().chain(&WORKER) {
            for line in module.lines() {
                assert!(
                    line.matches('`').count() % 2 == 0,
                    "text over several lines would be changed: {line}"
                );
                assert!(!line.trim_start().starts_with("/*") || line.ends_with("*/"), "{line}");
            }
        }
    }

    #[test]
    fn the_page_asks_for_nothing_and_runs_its_own_script_only() {
        let page = page_html(b"", &Start::Empty).unwrap_or_default();
        let script = page.rsplit_once("<script>").and_then(|(_, rest)| rest.split_once("</script>"));
        let hash = STANDARD.encode(Sha256::digest(script.map(|(script, _)| script).unwrap_or_default()));
        assert!(page.contains(&format!("'sha256-{hash}'")));
        for address in ["http://", "https://", "@import", "url("] {
            assert!(!page.contains(address), "{address}");
        }
    }
}
