//! Writes a series of buildings: `buildings STYLE MAPPING COUNT SEED DIRECTORY`.

use std::{env, fs, path::Path};

use placegraph_generate::{Mapping, Options, Style, files, generate};
use rayon::prelude::*;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [style, mapping, count, seed, directory] = arguments.as_slice() else {
        panic!("expected STYLE MAPPING COUNT SEED DIRECTORY");
    };
    let style = Style::ALL.into_iter().find(|other| other.name() == style).expect("a style");
    let mapping = Mapping::ALL.into_iter().find(|other| other.name() == mapping).expect("a mapping");
    let options = Options { mapping, resolution_m: None };
    let seed = seed.parse().expect("a seed");
    (0..count.parse().expect("a count")).into_par_iter().for_each(|index: u64| {
        let building = generate(style, seed, index, &options);
        let folder = Path::new(directory).join(format!("{}_{seed}_{index:03}", style.name()));
        fs::create_dir_all(&folder).expect("a folder");
        for (name, bytes) in files(&building).expect("bytes") {
            fs::write(folder.join(name), bytes).expect("a file");
        }
    });
}
