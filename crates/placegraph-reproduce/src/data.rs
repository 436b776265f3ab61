//! Where the maps and labels of the experiments come from: what to fetch, and how to lay it out.

use std::fmt::Write;
use std::path::Path;

use placegraph::model::sha256_hex;

/// A file of the experiments.
pub(super) struct DataFile {
    /// Where it lies in the folder of the data.
    pub(super) path: &'static str,
    /// What it is made of.
    pub(super) from: &'static str,
    /// SHA-256 of the file that the published figures were made with.
    pub(super) sha256: &'static str,
}

const AREAGRAPH_79: &str = "areaGraph, dataset/input/freiburg_building79.png (SHA-256 dc8e2abd27d9d1bf)";
const AREAGRAPH_52: &str = "areaGraph, dataset/input/freiburg_building52.png (SHA-256 14d2fe65de9fb1a6)";
const AREAGRAPH_B: &str = "areaGraph, dataset/input/lab_a.png (SHA-256 8ff13a141b5bc12d)";
const LABELS: &str = "drawn by hand for these experiments";
const YAML: &str =
    "written for these maps: resolution 0.05, origin [0, 0, 0], mode trinary, thresholds 0.65 and 0.196";

/// All files, maps before labels.
pub(super) const FILES: [DataFile; 9] = [
    file("fr79_slam/map.yaml", YAML, "deb56c9be90184414f7db18bf2c6b9a498e88e86e7926745402f1704110640db"),
    file(
        "fr79_slam/map.png",
        AREAGRAPH_79,
        "26288ba0c460b2198339718ab65f9c4926d3e144e5cb8246d70c4309f1260e36",
    ),
    file("fr79_slam/labels.png", LABELS, "af4035ad7c15c476ceb2048c9d5275e0d9bd0e0edaa70109e669600ba8a940f9"),
    file("fr52_slam/map.yaml", YAML, "deb56c9be90184414f7db18bf2c6b9a498e88e86e7926745402f1704110640db"),
    file(
        "fr52_slam/map.png",
        AREAGRAPH_52,
        "f83851b891d382e0cafaedfc32568b53326d0f3679b2a20d629f80e13ddea03f",
    ),
    file("fr52_slam/labels.png", LABELS, "370734f435f2d759c5b624cb1069f2112df57d3553089d72e541b842bebbe8bf"),
    file("sdr_b_slam/map.yaml", YAML, "deb56c9be90184414f7db18bf2c6b9a498e88e86e7926745402f1704110640db"),
    file(
        "sdr_b_slam/map.png",
        AREAGRAPH_B,
        "2d8cfd576870a48f6ae4d7a82a7a3ea88f4a737e4d95d90e22fd30e155953fbe",
    ),
    file("sdr_b_slam/labels.png", LABELS, "ecbb765beb3a5a318f8068da65d911f7418aac67f37061958900a657fc26dbbb"),
];

const fn file(path: &'static str, from: &'static str, sha256: &'static str) -> DataFile {
    DataFile { path, from, sha256 }
}

/// What the maps are, who made them and under which license, with the state of every file in `data`.
pub(super) fn guide(data: &Path) -> String {
    let mut text = "The experiments need three maps and their labels:\n\n".to_owned();
    for DataFile { path, from, sha256 } in FILES {
        let state = match std::fs::read(data.join(path)) {
            Err(_) => "missing",
            Ok(bytes) if sha256_hex(&bytes) == sha256 => "there",
            Ok(_) => "there, but not the file of the published figures",
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {path:22} {state}\n      {from}\n      SHA-256 {sha256}");
    }
    text += "
The maps: areaGraph of the STAR Center, github.com/STAR-Center/areaGraph, commit 9714868032, GPL-3.0. lab_a is
the map that fits what the chapter says of SDR site B; no source names it so. As map_server reads them: 0 occupied, 205 unknown, 254 free; 8-bit gray, pixel for
pixel the size of the source.

The labels: 8-bit gray, 0 none, 1 corridor, 2 room, 3 doorway, 255 free but ambiguous (ignored). They were drawn by hand for these
experiments and are not published with the maps; with labels of your own the figures differ. Lay all out in one folder as above and give it:

    cargo run --release -p placegraph-reproduce -- DATA
";
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_guide_names_every_file_its_source_and_its_state() {
        let folder = tempfile::tempdir().unwrap();
        let text = guide(folder.path());
        assert_eq!(text.matches(" missing\n").count(), FILES.len());
        for DataFile { path, sha256, .. } in FILES {
            assert!(text.contains(path) && text.contains(sha256) && sha256.len() == 64, "{path}");
        }
        for word in ["GPL-3.0", "9714868032", "by hand"] {
            assert!(text.contains(word), "{word}");
        }
        std::fs::create_dir(folder.path().join("fr79_slam")).unwrap();
        std::fs::write(folder.path().join("fr79_slam/map.png"), b"another one").unwrap();
        assert!(guide(folder.path()).contains("there, but not the file"));
    }
}
