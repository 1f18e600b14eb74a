//! Disjoint sets: what is connected, and whether it has the same orientation.

/// Disjoint sets of the numbers below a count, named by their least members, with the parity between members.
///
/// Union–find with path halving (Tarjan & van Leeuwen 1984, <https://doi.org/10.1145/62.2160>).
#[derive(Clone, Debug, Default)]
pub struct DisjointSets {
    /// `parent << 1 | parity towards it`.
    link: Vec<u32>,
}

impl DisjointSets {
    /// Every number in a set of its own.
    pub fn new(count: usize) -> Self {
        Self { link: (0..count as u32).map(|i| i << 1).collect() }
    }

    /// One more number, in a set of its own.
    pub fn push(&mut self) {
        self.link.push((self.link.len() as u32) << 1);
    }

    /// Least member of the set of `x`.
    pub fn find(&mut self, x: u32) -> u32 {
        self.find_opposed(x).0
    }

    /// Least member of the set of `x`, and whether `x` is opposed to it.
    pub fn find_opposed(&mut self, x: u32) -> (u32, bool) {
        let (mut at, mut parity) = (x, 0);
        loop {
            let up = self.link[at as usize];
            if up >> 1 == at {
                return (at, parity == 1);
            }
            let upper = self.link[(up >> 1) as usize];
            // Halving: hang `at` on its grandparent.
            let halved = upper ^ (up & 1);
            self.link[at as usize] = halved;
            parity ^= halved & 1;
            at = halved >> 1;
        }
    }

    /// Joins the sets of two members; whether they were apart.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.link[a.max(b) as usize] = a.min(b) << 1;
        }
        a != b
    }

    /// Joins the sets of two members that have the same orientation or are opposed; false if they were joined before with another
    /// parity.
    pub fn join_opposed(&mut self, a: u32, b: u32, opposed: bool) -> bool {
        let ((ra, pa), (rb, pb)) = (self.find_opposed(a), self.find_opposed(b));
        if ra == rb {
            return (pa ^ pb) == opposed;
        }
        let (low, high) = (ra.min(rb), ra.max(rb));
        self.link[high as usize] = low << 1 | u32::from(pa ^ pb ^ opposed);
        true
    }

    /// Numbers the sets by their first member: the set of each member, and how many there are.
    pub fn number(&mut self) -> (Vec<u32>, usize) {
        let mut count = 0;
        let mut sets = vec![0; self.link.len()];
        for i in 0..self.link.len() {
            let root = self.find(i as u32) as usize;
            // The representative is the smallest member, so it is numbered before the others.
            if root == i {
                sets[i] = count;
                count += 1;
            } else {
                sets[i] = sets[root];
            }
        }
        (sets, count as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parity_adds_up_along_chains_and_contradictions_show() {
        let mut parts = DisjointSets::new(6);
        assert!(
            parts.join_opposed(0, 1, true)
                && parts.join_opposed(2, 3, true)
                && parts.join_opposed(1, 2, false)
        );
        assert_eq!((parts.find_opposed(0), parts.find_opposed(3)), ((0, false), (0, false)));
        assert_eq!(parts.find_opposed(2), (0, true));
        assert!(parts.join_opposed(0, 3, false) && !parts.join_opposed(0, 3, true));
        assert_eq!(parts.number(), (vec![0, 0, 0, 0, 1, 2], 3));
    }
}
