//! The queue of the searches for routes.

use super::DIAGONAL;

/// Positions by cost, and of equal cost by number. A step costs 1 to [`Queue::LONGEST`], so that a list for each cost of that range
/// is enough, used again and again.
pub(super) struct Queue {
    lists: Vec<Vec<u32>>,
    cost: u32,
    n_positions: usize,
    is_sorted: bool,
}

impl Queue {
    /// The dearest step.
    const LONGEST: u32 = 2 * DIAGONAL;

    pub(super) fn new() -> Self {
        let lists = vec![Vec::new(); Self::LONGEST as usize + 1];
        Self { lists, cost: 0, n_positions: 0, is_sorted: false }
    }

    /// Begins a search from `positions`: the queue is empty.
    pub(super) fn start(&mut self, positions: impl IntoIterator<Item = u32>) {
        (self.cost, self.is_sorted) = (0, false);
        for position in positions {
            self.push(0, position);
        }
    }

    /// Adds a position at most [`Queue::LONGEST`] dearer than the last that was taken.
    pub(super) fn push(&mut self, cost: u32, position: u32) {
        let n_lists = self.lists.len();
        self.lists[cost as usize % n_lists].push(position);
        self.n_positions += 1;
    }

    pub(super) fn pop(&mut self) -> Option<(u32, u32)> {
        if self.n_positions == 0 {
            return None;
        }
        let n_lists = self.lists.len();
        loop {
            let list = &mut self.lists[self.cost as usize % n_lists];
            if !std::mem::replace(&mut self.is_sorted, true) {
                // No step is free, so nothing joins the list while it is read.
                list.sort_unstable_by(|a, b| b.cmp(a));
            }
            if let Some(position) = list.pop() {
                self.n_positions -= 1;
                return Some((self.cost, position));
            }
            self.cost += 1;
            self.is_sorted = false;
        }
    }
}
