//! The remark that exported files bear: what made them, and from what.

use crate::document::TopologyDocument;

/// How the stamp begins that exported files bear where their format has room for a remark.
const STAMP: &str = "written by placegraph";

/// Whether placegraph exported a file that begins with `head`, as its remark says. Pictures have no remark.
pub fn is_stamped(head: &[u8]) -> bool {
    head.windows(STAMP.len()).any(|bytes| bytes == STAMP.as_bytes())
}

/// The hash of the map in the remark of a file that begins with `head`, if there is one.
pub fn stamped_map(head: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(head);
    let (_, stamp) = text.split_once(STAMP)?;
    let (_, hash) = stamp.split_once("; map sha256:")?;
    Some(hash.chars().take_while(char::is_ascii_alphanumeric).collect())
}

/// The content of a file with `ending` with a remark at its beginning.
pub(super) fn with_stamp(bytes: Vec<u8>, ending: &str, stamp: &str) -> Vec<u8> {
    /// Behind the first `mark`, or in front of all.
    fn behind(bytes: &[u8], mark: &[u8], remark: &str) -> Vec<u8> {
        let found = bytes.windows(mark.len()).position(|window| window == mark);
        let at = found.map_or(0, |start| start + mark.len());
        [&bytes[..at], remark.as_bytes(), &bytes[at..]].concat()
    }
    match ending {
        "yaml" => [format!("# {stamp}\n").as_bytes(), &bytes].concat(),
        "dot" => [format!("// {stamp}\n").as_bytes(), &bytes].concat(),
        "graphml" | "svg" => behind(&bytes, b"?>", &format!("<!-- {stamp} -->")),
        "html" => behind(&bytes, b"<!doctype html>", &format!("<!-- {stamp} -->")),
        // A member that GeoJSON does not know.
        "geojson" => behind(&bytes, b"{", &format!("\"written_by\":\"{stamp}\",")),
        _ => bytes,
    }
}

/// What made the files of `document` and from what, in letters that no format takes for syntax.
pub(super) fn stamp(document: &TopologyDocument) -> String {
    let plain =
        |text: &str| text.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '.').collect::<String>();
    let TopologyDocument { program, map, model, .. } = document;
    let model = model.as_ref().map(|model| format!("; model sha256:{}", plain(&model.hash)));
    let (version, map) = (plain(&program.version), plain(&map.hash));
    format!("{STAMP} {version}; map sha256:{map}{}", model.unwrap_or_default())
}
