#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| placegraph_fuzz::valetudo(bytes));
