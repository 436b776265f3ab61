//! Shows how far long work is, and keeps the time of every stage.

use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use placegraph::progress::{Progress, Stage};

use crate::output::complain;

/// A bar on standard error for work longer than this; nothing where that is no terminal.
const SHOW_AFTER: Duration = Duration::from_secs(1);

/// Lines instead of a bar come this far apart.
const LINE_AFTER: Duration = Duration::from_secs(15);

/// A progress bar and a stopwatch: the library has neither.
#[derive(Debug)]
pub(crate) struct Watch {
    state: Mutex<State>,
    bar: Option<ProgressBar>,
    started: Instant,
    /// Whether lines are printed where there is no terminal for a bar.
    has_lines: bool,
}

#[derive(Debug, Default)]
struct State {
    running: Option<(Stage, Instant)>,
    finished: Vec<(Stage, Duration)>,
    last_line: Option<Instant>,
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
        Self { state: Mutex::default(), bar: None, started: Instant::now(), has_lines: false }
    }

    /// As [`Watch::start`], for work of minutes: where no bar can be shown, a line from time to time.
    pub(crate) fn with_lines(what: &str) -> Self {
        Self { has_lines: true, ..Self::start(what) }
    }

    /// Prints how far the stage at work is, and how much time it still needs, if it is time for that.
    fn print_line(&self, done: usize, total: usize) {
        let mut state = self.lock();
        let last = state.last_line.unwrap_or(self.started);
        let Some((stage, since)) = state.running.filter(|_| last.elapsed() >= LINE_AFTER && done > 0) else {
            return;
        };
        state.last_line = Some(Instant::now());
        drop(state);
        let left = since.elapsed().as_secs_f64() * total.saturating_sub(done) as f64 / done as f64;
        let elapsed = self.started.elapsed().as_secs();
        complain(&format!(
            "{elapsed} s: {} {:.0} %, about {left:.0} s left of this stage",
            stage.name(),
            100.0 * done as f64 / total.max(1) as f64
        ));
    }

    /// Ends the current stage and returns the time of each, in order.
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
        if self.has_lines && !std::io::stderr().is_terminal() {
            self.print_line(done, total);
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

    /// Prints the outcome of that map above the bar.
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
