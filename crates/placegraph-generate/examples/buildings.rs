//! Writes a series of buildings: `buildings STYLE MAPPING COUNT SEED DIRECTORY [RESOLUTION]`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

use placegraph_generate::{Options, Style, files, generate};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [style, mapping, count, seed, directory, resolution @ ..] = arguments.as_slice() else {
        return Err("expected STYLE MAPPING COUNT SEED DIRECTORY [RESOLUTION]".into());
    };
    let (style, seed): (Style, u64) = (style.parse()?, seed.parse()?);
    let resolution_m = resolution.first().map(|text| text.parse()).transpose()?;
    let options = Options { mapping: mapping.parse()?, resolution_m };
    (0..count.parse::<u64>()?).into_par_iter().try_for_each(|index| {
        let building = generate(style, seed, index, &options);
        let folder = Path::new(directory).join(format!("{}_{seed}_{index:03}", style.name()));
        fs::create_dir_all(&folder)?;
        for (name, bytes) in files(&building)? {
            fs::write(folder.join(name), bytes)?;
        }
        Ok(())
    })
}
