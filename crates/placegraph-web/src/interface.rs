//! What the page's worker thread calls. It writes a request to where [`input`] says, has [`call`] answer it, and reads the
//! answer at [`output`].
//!
//! Memory is only ever touched by its owner: the page writes into a vector that Rust lent, before Rust reads it.
#![expect(unsafe_code, reason = "names of exported functions, and the one function that the page gives")]
#![cfg_attr(target_family = "wasm", allow(unreachable_pub, reason = "the page calls these functions"))]

use std::cell::RefCell;
use std::sync::Once;

use placegraph::progress::{Progress, Stage};

use crate::message::block;
use crate::session::Session;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Reports progress: the name of the stage, as position and length in memory, and the finished share of it.
    safe fn progress(stage: *const u8, length: usize, done: usize, total: usize);
}

thread_local! {
    static SESSION: RefCell<Session> = RefCell::default();
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

static PANIC_HOOK: Once = Once::new();

/// Where a request of `length` bytes is to be written; 0 if there is no memory for it.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> usize {
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.shrink_to(0);
        if input.try_reserve_exact(length).is_err() {
            return 0;
        }
        input.resize(length, 0);
        input.as_mut_ptr().addr()
    })
}

/// Answers the request that was written.
#[unsafe(no_mangle)]
pub extern "C" fn call() {
    PANIC_HOOK.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            let answer = block(serde_json::json!({ "panic": info.to_string() }), &[]);
            OUTPUT.with(|output| output.try_borrow_mut().map(|mut output| *output = answer).ok());
        }));
    });
    let request = INPUT.take();
    let answer = SESSION.with_borrow_mut(|session| session.answer(&request, &Tell::default()));
    OUTPUT.set(answer);
}

/// Where the answer lies.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> usize {
    OUTPUT.with_borrow(|output| output.as_ptr().addr())
}

/// How long it is.
#[unsafe(no_mangle)]
pub extern "C" fn output_len() -> usize {
    OUTPUT.with_borrow(Vec::len)
}

/// Reports progress to the page.
#[derive(Debug, Default)]
struct Tell {
    stage: std::sync::Mutex<&'static str>,
}

impl Progress for Tell {
    fn begin(&self, stage: Stage) {
        if let Ok(mut current) = self.stage.lock() {
            *current = stage.name();
        }
        self.advance(0, 0);
    }

    fn advance(&self, done: usize, total: usize) {
        if let Ok(stage) = self.stage.lock() {
            progress(stage.as_ptr(), stage.len(), done, total);
        }
    }
}
