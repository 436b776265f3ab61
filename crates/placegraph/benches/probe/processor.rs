//! Processor time of the whole process as what is measured, so that others who use the machine disturb little.

use std::fs;
use std::time::Instant;

use criterion::measurement::{Measurement, ValueFormatter, WallTime};

static WALL: WallTime = WallTime;

/// Processor seconds of all threads, where the system tells them, else the clock. They grow in steps of some
/// milliseconds: a sample has to take many of these.
pub(crate) struct ProcessorTime;

impl Measurement for ProcessorTime {
    type Intermediate = f64;
    type Value = f64;

    fn start(&self) -> f64 {
        seconds()
    }

    fn end(&self, start: f64) -> f64 {
        seconds() - start
    }

    fn add(&self, one: &f64, other: &f64) -> f64 {
        one + other
    }

    fn zero(&self) -> f64 {
        0.0
    }

    fn to_f64(&self, seconds: &f64) -> f64 {
        seconds * 1e9
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        WALL.formatter()
    }
}

fn seconds() -> f64 {
    thread_local!(static START: Instant = Instant::now());
    let Ok(tasks) = fs::read_dir("/proc/self/task") else {
        return START.with(|start| start.elapsed().as_secs_f64());
    };
    let of_task = |task: fs::DirEntry| {
        let line = fs::read_to_string(task.path().join("schedstat")).ok()?;
        line.split_whitespace().next()?.parse::<f64>().ok()
    };
    tasks.flatten().filter_map(of_task).sum::<f64>() * 1e-9
}
