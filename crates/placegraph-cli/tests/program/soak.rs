//! Many maps in one run: memory stays flat. `PLACEGRAPH_SOAK` says how many, by default 150.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use crate::running::start_batch;
use placegraph_generate::{Mapping, Options, Style, files, generate};
use tempfile::TempDir;

/// Different generated homes, which the batch takes in turn.
const N_BUILDINGS: u64 = 5;

/// So many maps: links to the buildings, each with a name of its own.
fn maps(folder: &Path, n: usize) -> Vec<PathBuf> {
    let options = Options { mapping: Mapping::Clean, resolution_m: Some(0.2) };
    for index in 0..N_BUILDINGS {
        for (name, bytes) in files(&generate(Style::Home, 5, index, &options)).unwrap() {
            let name = if name == "map.png" { format!("{index}.png") } else { format!("{index}.{name}") };
            fs::write(folder.join(name), bytes).unwrap();
        }
    }
    let link = |number: usize| {
        let path = folder.join(format!("map{number:05}.yaml"));
        let index = number as u64 % N_BUILDINGS;
        let yaml = fs::read_to_string(folder.join(format!("{index}.map.yaml"))).unwrap();
        fs::write(&path, yaml.replace("map.png", &format!("{index}.png"))).unwrap();
        path
    };
    (0..n).map(link).collect()
}

/// Resident memory of a process in KiB.
fn resident_kib(id: u32) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}

#[test]
fn memory_is_flat_over_many_maps() {
    let n: usize = env::var("PLACEGRAPH_SOAK").map_or(150, |n| n.parse().expect("a number of maps"));
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let maps = maps(folder.path(), n);
    let mut run = start_batch(&maps, &out);
    let mut samples = Vec::new();
    while run.try_wait().unwrap().is_none() {
        samples.extend(resident_kib(run.id()));
        thread::sleep(Duration::from_millis(10));
    }
    assert!(run.wait().unwrap().success());
    let table = fs::read_to_string(out.join("summary.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.contains(",labeled,")).count(), n);

    // Every building was there several times in the first third.
    let largest = |part: &[u64]| part.iter().copied().max().unwrap_or(0);
    let (first, last) = (largest(&samples[..samples.len() / 3]), largest(&samples[samples.len() * 2 / 3..]));
    println!(
        "{n} maps, {} samples: at most {first} KiB in the first third, {last} in the last",
        samples.len()
    );
    // What names and table take, and what the allocator keeps.
    assert!(last < first + 2048 + n as u64 / 2, "{first} KiB grew to {last}");
}
