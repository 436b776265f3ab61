//! Shows how far long work is, and keeps the time of every stage.

use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use placegraph::progress::{Progress, Stage};

use crate::output::complain;

/// A bar on standard error for work longer than this; nothing where that is no terminal.
const SHOW_AFTER: Duration = Duration::from_secs(1);

/// A progress bar and a stopwatch: the library has neither.
#[derive(Debug)]
pub(crate) struct Watch {
    state: Mutex<State>,
    bar: Option<ProgressBar>,
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
        Self { bar: Some(bar), ..Self::without_bar() }
    }

    /// A stopwatch that starts now and shows nothing.
    pub(crate) fn without_bar() -> Self {
        Self { state: Mutex::default(), bar: None, started: Instant::now() }
    }

    /// Ends the stage that runs and tells how long each took, in order.
    pub(crate) fn finish(&self) -> Vec<(Stage, Duration)> {
        let mut state = self.lock();
        state.end_stage();
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
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
        if let Some(bar) = &self.bar {
            bar.set_message(stage.name());
            bar.set_position(0);
        }
    }

    fn advance(&self, done: usize, total: usize) {
        let Some(bar) = &self.bar else { return };
        if bar.is_hidden() && self.started.elapsed() > SHOW_AFTER && std::io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    }
}

/// How many of several maps are done: a bar on standard error where that is a terminal.
#[derive(Debug)]
pub(crate) struct MapCounter {
    bar: ProgressBar,
}

impl MapCounter {
    /// A bar for `n_maps` maps.
    pub(crate) fn start(n_maps: usize) -> Self {
        let bar = ProgressBar::new(n_maps as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} maps, {eta} left  {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// Names the map at work.
    pub(crate) fn begin(&self, map: &str) {
        self.bar.set_message(map.to_owned());
        self.bar.tick();
    }

    /// Tells above the bar what came of that map.
    pub(crate) fn end(&self, line: &str) {
        self.bar.suspend(|| complain(line));
        self.bar.inc(1);
    }
}

impl Drop for MapCounter {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
