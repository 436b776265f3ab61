//! Panics are bugs. They are reported as errors that ask for a bug report, and in a batch they end one map, not the run.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook};
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow};

/// Where the last panic happened, on any thread.
static PLACE: Mutex<Option<String>> = Mutex::new(None);

/// Keeps panics from being printed where they happen: [`guarded`] reports them.
pub(crate) fn install() {
    set_hook(Box::new(|info| {
        *PLACE.lock().unwrap_or_else(PoisonError::into_inner) = info.location().map(ToString::to_string);
    }));
}

/// What `work` returns, or an error if it panics, on whatever thread.
///
/// Everything that `work` changes must be its own or be given up with it.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let place = PLACE.lock().unwrap_or_else(PoisonError::into_inner).take();
        let place = place.map_or_else(String::new, |place| format!(" at {place}"));
        Err(anyhow!(
            "this is a bug in placegraph, please report it with the files that led to it: {}{place}",
            message(panic.as_ref())
        ))
    })
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message")
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn a_panic_on_any_thread_is_an_error_and_the_next_one_works() {
        let message = |result: Result<()>| format!("{:#}", result.unwrap_err());
        let here = guarded(|| panic!("index {} is out of bounds", 7));
        assert!(message(here).contains("index 7 is out of bounds"));
        let there = guarded(|| {
            (0..100).into_par_iter().for_each(|i| assert!(i != 50, "fifty"));
            Ok(())
        });
        assert!(message(there).contains("fifty"));
        let error = guarded(|| Err::<(), _>(anyhow!("expected a map")));
        assert_eq!(message(error), "expected a map");
        assert_eq!(guarded(|| Ok((0..100).into_par_iter().sum::<i32>())).unwrap(), 4950);
    }
}
