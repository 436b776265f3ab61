//! The choice of vector instructions at run time.

use std::sync::LazyLock;

/// Which vector instructions the engine uses. All choices give the same bits: the code is the same, compiled
/// several times, and never fuses a multiplication with an addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instructions {
    /// The widest that this machine has, unless [`Instructions::VARIABLE`] names others.
    #[default]
    Widest,
    /// Vectors of 256 bits (AVX2) where this machine has them, else [`Instructions::Baseline`]; for tests and benches.
    Avx2,
    /// Those that every machine of the target has; for tests and benches.
    Baseline,
}

impl Instructions {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Widest, Self::Avx2, Self::Baseline];

    /// The environment variable that sets [`Instructions::Widest`], by [`Instructions::name`], so that the whole
    /// program can be measured and compared with each choice.
    pub const VARIABLE: &'static str = "PLACEGRAPH_INSTRUCTIONS";

    /// Its name in [`Instructions::VARIABLE`].
    pub fn name(self) -> &'static str {
        match self {
            Self::Widest => "widest",
            Self::Avx2 => "avx2",
            Self::Baseline => "plain",
        }
    }

    /// The choice called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|choice| choice.name() == name)
    }

    /// Runs `work`, compiled for these instructions as far as its calls are inlined: mark the closure
    /// `#[inline(always)]`.
    #[inline(always)]
    pub fn run<R>(self, work: impl FnOnce() -> R) -> R {
        // WebAssembly has one kind of vectors, and a module with others does not load in every browser.
        #[cfg(target_arch = "wasm32")]
        return work();
        #[cfg(not(target_arch = "wasm32"))]
        self.arch().dispatch(work)
    }

    /// How many numbers of single precision a register holds. There are 32 registers where these are 16, else 16 or more.
    pub(crate) fn lanes(self) -> usize {
        match self.arch() {
            pulp::Arch::Scalar => 4,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            pulp::Arch::V3(_) => 8,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            pulp::Arch::V4(_) => 16,
            _ => 4,
        }
    }

    #[inline(always)]
    fn arch(self) -> pulp::Arch {
        match self {
            Self::Widest => *WIDEST,
            Self::Avx2 => avx2(),
            Self::Baseline => pulp::Arch::Scalar,
        }
    }
}

static WIDEST: LazyLock<pulp::Arch> = LazyLock::new(|| {
    let named = std::env::var(Instructions::VARIABLE).ok();
    match named.as_deref().and_then(Instructions::from_name).unwrap_or_default() {
        Instructions::Widest => pulp::Arch::new(),
        narrower => narrower.arch(),
    }
});

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn avx2() -> pulp::Arch {
    pulp::x86::V3::try_new().map_or(pulp::Arch::Scalar, pulp::Arch::V3)
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn avx2() -> pulp::Arch {
    pulp::Arch::Scalar
}
