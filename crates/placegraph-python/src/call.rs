//! Long work: without the GIL, on as many threads as asked for, ended by Ctrl-C, and safe against panics.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::time::Duration;

use placegraph::progress::{Progress, Stage};
use placegraph_cli::package;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Exception, Failure};

/// How often signals are looked for.
const SIGNALS: Duration = Duration::from_millis(50);

/// Most threads that can be asked for.
const MAX_THREADS: usize = 1024;

/// The pool of a thread a core, by process: a forked one has the pool of its parent, but not its threads.
static POOLS: Mutex<Vec<(u32, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

/// What `work` returns on `threads` threads, or one a core.
///
/// A signal handler that raises, as that of Ctrl-C does, ends the call at once; what still runs ends with its next step.
pub(crate) fn long<T: Send + 'static>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&dyn Progress) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(package::install_guard);
    let canceled = Arc::new(AtomicBool::new(false));
    let watch = Watch(Arc::clone(&canceled));
    let (sender, receiver) = channel();
    let pool = pool(threads)?;
    pool.spawn(move || {
        let _ = sender.send(guarded(|| work(&watch)));
    });
    // Only this thread receives, but whoever leaves the GIL must not share what is not meant for it.
    let receiver = Mutex::new(receiver);
    loop {
        let received = py.detach(|| {
            let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
            receiver.recv_timeout(SIGNALS)
        });
        match received {
            Ok(result) => return Ok(result?),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::new(Exception::Internal, "the work ended without a result").into());
            }
        }
        if let Err(signal) = py.check_signals() {
            canceled.store(true, Ordering::Relaxed);
            return Err(signal);
        }
    }
}

/// What `work` returns; a panic, which is a bug, is an error that asks for a report.
fn guarded<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let result = package::guarded(|| match catch_unwind(AssertUnwindSafe(work)) {
        Err(panic) if panic.is::<Canceled>() => Ok(Err(Failure::new(Exception::Internal, "canceled"))),
        Err(panic) => resume_unwind(panic),
        Ok(result) => Ok(result),
    });
    result.unwrap_or_else(|error| Err(Failure::new(Exception::Internal, error)))
}

/// The pool of all calls that ask for no number of threads. Others have one each: calls side by side would wait for one another.
fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let of_size = |n: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(n).build();
        let failed = |error| PyRuntimeError::new_err(format!("could not start the threads: {error}"));
        pool.map(Arc::new).map_err(failed)
    };
    match threads {
        Some(n) if (1..=MAX_THREADS).contains(&n) => return of_size(n),
        Some(n) => {
            return Err(PyValueError::new_err(format!("expected 1 to {MAX_THREADS} threads, found {n}")));
        }
        None => {}
    }
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pool)) = pools.iter().find(|(of, _)| *of == process) {
        return Ok(Arc::clone(pool));
    }
    let pool = of_size(0)?;
    pools.push((process, Arc::clone(&pool)));
    Ok(pool)
}

/// The reason of a panic that only ends work nobody waits for.
struct Canceled;

/// Ends the work at its next report once it is canceled.
struct Watch(Arc<AtomicBool>);

impl Watch {
    fn check(&self) {
        if self.0.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Canceled));
        }
    }
}

impl Progress for Watch {
    fn begin(&self, _: Stage) {
        self.check();
    }

    fn advance(&self, _: usize, _: usize) {
        self.check();
    }
}
