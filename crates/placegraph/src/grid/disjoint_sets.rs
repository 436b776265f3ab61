//! Union–find over small integers; the representative of a set is its lowest member.

/// A partition of 0..n into sets that can only grow together.
#[derive(Debug)]
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// n sets of one member.
    pub(crate) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// The lowest member of the set of `member`. Halves the path as it goes.
    pub(crate) fn find(&mut self, member: usize) -> usize {
        let mut member = member;
        while self.parent[member] as usize != member {
            let grandparent = self.parent[self.parent[member] as usize];
            self.parent[member] = grandparent;
            member = grandparent as usize;
        }
        member
    }

    /// Makes one set of the sets of `a` and `b`.
    pub(crate) fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }
}
