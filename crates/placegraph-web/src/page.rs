//! One HTML file: the page's modules, the viewer that it shares with the report, and the library.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use placegraph::export::{VIEWER_STYLE, fill_page, in_script, viewer_script};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// The library as WebAssembly, if the crate was built with it: `build-library`, then `PLACEGRAPH_WASM`.
pub const LIBRARY: Option<&[u8]> = include!(concat!(env!("OUT_DIR"), "/library.rs"));

const TEMPLATE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/page.css");
const WORKER: &str = include_str!("../page/worker.js");

/// The page's modules, each after those that it uses.
const MODULES: [&str; 12] = [
    include_str!("../page/acts.js"),
    include_str!("../page/history.js"),
    include_str!("../page/engine.js"),
    include_str!("../page/files.js"),
    include_str!("../page/store.js"),
    include_str!("../page/zip.js"),
    include_str!("../page/linetool.js"),
    include_str!("../page/tabs.js"),
    include_str!("../page/places.js"),
    include_str!("../page/editlist.js"),
    include_str!("../page/takealong.js"),
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

/// The page with the library `wasm` inside.
///
/// # Errors
/// If the result is no JSON.
pub fn page_html(wasm: &[u8], start: &Start<'_>) -> Result<String, serde_json::Error> {
    let mut data = json!({ "example": files(EXAMPLE.iter().map(|&(name, bytes)| (name, bytes))) });
    match start {
        Start::Empty => {}
        Start::Map { files: given, resolution_m, edits } => {
            let files = files(given.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
            data["map"] = json!({ "files": files, "resolution_m": resolution_m, "edits": edits });
        }
        Start::Result(view) => data["result"] = serde_json::from_str(view)?,
    }
    let script = viewer_script(&MODULES);
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
            ("@LIBRARY@", &STANDARD.encode(packed(wasm))),
            ("@WORKER@", WORKER),
            ("@DATA@", &in_script(&data.to_string())),
            ("@SCRIPT@", &script),
        ],
    ))
}

fn files<'a>(files: impl Iterator<Item = (&'a str, &'a [u8])>) -> Value {
    files.map(|(name, bytes)| json!({ "name": name, "base64": STANDARD.encode(bytes) })).collect()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // Writing to a vector cannot fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
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
