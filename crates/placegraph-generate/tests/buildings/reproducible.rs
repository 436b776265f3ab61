//! The same building has the same bytes, however many are made at once.

use std::num::NonZeroUsize;

use placegraph::grid::Occupancy;
use placegraph_generate::{Mapping, Options, Style, files, generate, generate_growing};
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

#[test]
fn to_watch_a_map_grow_does_not_change_it() {
    let options = Options { mapping: Mapping::Slam, resolution_m: Some(0.1) };
    let alone = generate(Style::Home, 5, 1, &options);
    let growing = |every| generate_growing(Style::Home, 5, 1, Some(0.1), NonZeroUsize::new(every).unwrap());
    let (building, maps) = growing(10);
    assert_eq!((&building.map, &building.labels), (&alone.map, &alone.labels));
    assert_eq!(growing(20).1, maps.iter().skip(1).step_by(2).cloned().collect::<Vec<_>>());
    let n_known = |map: &placegraph::grid::OccupancyGrid| {
        map.cells.values().iter().filter(|&&state| state != Occupancy::Unknown).count()
    };
    assert!(maps.windows(2).all(|pair| n_known(&pair[0]) <= n_known(&pair[1])), "what is known stays known");
    assert!(n_known(maps.last().unwrap()) <= n_known(&alone.map));
}
