//! Shows how far long work is, and keeps the time of every stage.

use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use placegraph::progress::{Progress, Stage};

/// A bar on standard error for work longer than this; nothing where that is no terminal.
const SHOW_AFTER: Duration = Duration::from_secs(1);

/// A progress bar and a stopwatch: the library has neither.
#[derive(Debug)]
pub(crate) struct Watch {
    state: Mutex<State>,
    bar: ProgressBar,
    started: Instant,
}

#[derive(Debug, Default)]
struct State {
    running: Option<(Stage, Instant)>,
    finished: Vec<(Stage, Duration)>,
}

impl Watch {
    /// A stopwatch that starts now. `what` is named in front of the bar.
    pub(crate) fn start(what: &str) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{prefix} {msg:<10} {bar:40} {percent:>3} %") {
            bar.set_style(style);
        }
        bar.set_prefix(what.to_owned());
        Self { state: Mutex::default(), bar, started: Instant::now() }
    }

    /// Ends the stage that runs and tells how long each took, in order.
    pub(crate) fn finish(&self) -> Vec<(Stage, Duration)> {
        let mut state = self.lock();
        state.end_stage();
        self.bar.finish_and_clear();
        std::mem::take(&mut state.finished)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A stopwatch stays readable after a panic elsewhere.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn end_stage(&mut self) {
        if let Some((stage, since)) = self.running.take() {
            self.finished.push((stage, since.elapsed()));
        }
    }
}

impl Progress for Watch {
    fn begin(&self, stage: Stage) {
        let mut state = self.lock();
        state.end_stage();
        state.running = Some((stage, Instant::now()));
        self.bar.set_message(stage.name());
        self.bar.set_position(0);
    }

    fn advance(&self, done: usize, total: usize) {
        if self.bar.is_hidden() && self.started.elapsed() > SHOW_AFTER && std::io::stderr().is_terminal() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
    }
}
