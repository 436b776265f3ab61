//! The choice of vector instructions at run time.

/// Which vector instructions the engine uses. Both choices give the same bits: the code is the same, compiled
/// several times, and never fuses a multiplication with an addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instructions {
    /// The widest that this machine has.
    #[default]
    Widest,
    /// Those that every machine of the target has; for tests.
    Baseline,
}

impl Instructions {
    /// Runs `work`, compiled for these instructions as far as its calls are inlined: mark the closure
    /// `#[inline(always)]`.
    #[inline(always)]
    pub fn run<R>(self, work: impl FnOnce() -> R) -> R {
        let arch = match self {
            Self::Widest => pulp::Arch::new(),
            Self::Baseline => pulp::Arch::Scalar,
        };
        arch.dispatch(work)
    }
}
