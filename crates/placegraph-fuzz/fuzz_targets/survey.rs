#![no_main]

use placegraph_generate::{Mapping, Options, generate_surveyed, read_flat, read_plan_xml};

// Floor plans and flats: what can be read is drawn.
libfuzzer_sys::fuzz_target!(|text: &str| {
    let options = Options { mapping: Mapping::Clean, resolution_m: Some(0.2) };
    for survey in [read_plan_xml(text), read_flat(text)].into_iter().flatten() {
        let _ = generate_surveyed(&survey, "fuzz", 1, 0, &options);
    }
});
