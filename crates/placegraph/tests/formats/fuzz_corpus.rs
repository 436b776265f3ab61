//! Replays the committed corpus through the fuzz targets: whole, cut off at every byte, with every byte changed, and
//! with random changes. No input may panic.

use crate::fuzz_targets::TARGETS;
use std::env;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::Instant;

/// The files of a target: one for every way into the reader, and those that once crashed it.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(target);
    let mut paths: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} has files", folder.display());
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// Every file whole, cut off and with every byte changed, then random changes of random files:
/// `PLACEGRAPH_FUZZ` says how many, by default 2000.
fn replay(target: &str, run: fn(&[u8])) {
    let files = corpus(target);
    for bytes in &files {
        assert!(bytes.len() <= 8192, "the corpus is small");
        run(bytes);
        for at in 0..bytes.len() {
            run(&bytes[..at]);
            for change in [0x01, 0x80, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= change;
                run(&changed);
            }
        }
    }
    let n_runs: u64 = env::var("PLACEGRAPH_FUZZ").map_or(2000, |n| n.parse().unwrap());
    let start = Instant::now();
    let mut dice = Dice(n_runs ^ 0x9e37_79b9_7f4a_7c15);
    for _ in 0..n_runs {
        run(&changed_at_random(&files, &mut dice));
    }
    println!("{target}: {n_runs} random changes in {:.1} s", start.elapsed().as_secs_f64());
}

/// Marsaglia's xorshift: the same changes every time.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }
}

/// Bytes and words that formats have a meaning for.
const WORDS: [&[u8]; 20] = [
    b"\0",
    b"\xff\xff\xff\xff",
    b"\0\0\0\x80",
    b"-1",
    b"0",
    b"1e308",
    b"-1e308",
    b"1e-308",
    b"4294967295",
    b"nan",
    b"inf",
    b"null",
    b"[]",
    b"{}",
    b"\"\"",
    b"[[",
    b"\n",
    b" ",
    b"#",
    b"9999999999999999999",
];

fn changed_at_random(files: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = files[dice.below(files.len())].clone();
    for _ in 0..=dice.below(6) {
        let at = dice.below(bytes.len() + 1);
        let reach = 1 << dice.below(8);
        let end = (at + dice.below(reach)).min(bytes.len());
        match dice.below(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << dice.below(8),
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..end, WORDS[dice.below(WORDS.len())].iter().copied())),
            3 => {
                let again = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, again));
            }
            4 => {
                let other = &files[dice.below(files.len())];
                let from = dice.below(other.len());
                let part = &other[from..(from + end - at).min(other.len())];
                drop(bytes.splice(at..end, part.iter().copied()));
            }
            _ => replace_a_number(&mut bytes, at, WORDS[dice.below(WORDS.len())]),
        }
    }
    bytes
}

/// Puts `word` in the place of the first number from `at` on.
fn replace_a_number(bytes: &mut Vec<u8>, at: usize, word: &[u8]) {
    let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-');
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|n| at + n) else { return };
    let end = bytes[start..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |n| start + n);
    drop(bytes.splice(start..end, word.iter().copied()));
}

#[test]
fn no_input_makes_a_reader_panic() {
    thread::scope(|scope| {
        for &(target, run) in TARGETS {
            let named = thread::Builder::new().name(target.to_owned());
            named.spawn_scoped(scope, move || replay(target, run)).unwrap();
        }
    });
}

#[test]
fn every_target_has_a_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../placegraph-fuzz/Cargo.toml");
    let manifest = fs::read_to_string(path).unwrap();
    for (target, _) in TARGETS {
        assert!(manifest.contains(&format!("[[bin]]\nname = \"{target}\"\n")), "no program runs {target}");
    }
}
