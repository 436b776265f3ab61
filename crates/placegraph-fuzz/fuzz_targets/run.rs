//! Every target, by the name of its program.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| placegraph_fuzz::run(env!("CARGO_BIN_NAME"), bytes));
