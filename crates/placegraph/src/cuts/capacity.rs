//! Integers for the capacities of edges.

/// An integer that holds the capacities of edges, and sums of the two of an edge.
pub trait Capacity: Copy + Into<i32> + std::fmt::Debug {
    /// No capacity.
    const ZERO: Self;
    /// The same number.
    ///
    /// # Panics
    /// If it is out of range.
    fn of(capacity: i32) -> Self;
}

impl Capacity for i32 {
    const ZERO: Self = 0;
    fn of(capacity: i32) -> Self {
        capacity
    }
}

/// For edges of at most 32 767.
impl Capacity for u16 {
    const ZERO: Self = 0;
    #[expect(clippy::expect_used, reason = "a documented panic")]
    fn of(capacity: i32) -> Self {
        capacity.try_into().expect("a capacity of 16 bits")
    }
}
