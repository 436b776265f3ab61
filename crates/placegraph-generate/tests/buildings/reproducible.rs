//! The same building has the same bytes, however many are made at once.

use placegraph_generate::{Mapping, Options, Style, files, generate};
use rayon::prelude::*;

#[expect(clippy::unwrap_used, reason = "a failure is a failed test")]
fn bytes(threads: usize, seed: u64) -> Vec<Vec<u8>> {
    let options = Options { mapping: Mapping::Mixed, resolution_m: Some(0.1) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        (0..6_u64)
            .into_par_iter()
            .map(|index| {
                let building = generate(Style::Mixed, seed, index, &options);
                files(&building).unwrap().into_iter().flat_map(|(_, bytes)| bytes).collect()
            })
            .collect()
    })
}

#[test]
fn one_and_four_threads_make_the_same_bytes() {
    assert_eq!(bytes(1, 3), bytes(4, 3));
}

#[test]
fn seeds_and_indices_make_different_buildings() {
    let (first, second) = (bytes(4, 3), bytes(4, 4));
    for (index, building) in first.iter().enumerate() {
        assert!(!second.contains(building));
        assert!(!first[..index].contains(building));
    }
}
