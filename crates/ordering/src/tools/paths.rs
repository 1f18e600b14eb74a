//! Cheapest ways through sets of tools: Bellman 1962 (<https://doi.org/10.1145/321105.321111>) and Held & Karp 1962
//! (<https://doi.org/10.1137/0110015>), the state being the set that was used and the tool it ended with.

use super::problem::Weights;

/// What cannot be; the sum of two still fits.
pub(super) const NEVER: u64 = u64::MAX / 4;

/// Tools of which every subset can be asked for.
pub(super) struct Paths {
    pub tools: Vec<u32>,
    /// Which of them come before each.
    before: Vec<usize>,
    /// Weight of each change, row by row.
    change: Vec<u64>,
}

/// The cheapest way from one tool through every set to every end.
pub(super) struct From<'a> {
    paths: &'a Paths,
    least: Vec<u64>,
}

impl Paths {
    /// `before` are pairs of indices into `tools`.
    pub fn new(tools: Vec<u32>, before: &[(usize, usize)], weights: &Weights) -> Self {
        let change = tools.iter().flat_map(|&a| tools.iter().map(move |&b| weights.of(a, b))).collect();
        let mut masks = vec![0; tools.len()];
        for &(first, second) in before {
            masks[second] |= 1 << first;
        }
        Self { tools, before: masks, change }
    }

    /// What the tables of all first tools take, in additions.
    pub fn work(tools: usize) -> u128 {
        (1u128 << tools.min(100)) * (tools as u128).pow(3)
    }

    /// O(2ⁿ n²) for n tools.
    pub fn from(&self, first: usize) -> From<'_> {
        let n = self.tools.len();
        let mut least = vec![NEVER; n << n];
        if self.before[first] == 0 {
            least[(1 << first) * n + first] = 0;
        }
        for set in (0..1_usize << n).filter(|set| set >> first & 1 == 1) {
            for last in bits(set) {
                let so_far = least[set * n + last];
                if so_far >= NEVER {
                    continue;
                }
                for next in bits(!set & ((1 << n) - 1)) {
                    if self.before[next] & !set == 0 {
                        let place = &mut least[(set | 1 << next) * n + next];
                        *place = (*place).min(so_far + self.change[last * n + next]);
                    }
                }
            }
        }
        From { paths: self, least }
    }
}

impl From<'_> {
    /// Weight of the cheapest way through a set (as bits) that ends with a tool.
    pub fn least(&self, set: usize, last: usize) -> u64 {
        self.least[set * self.paths.tools.len() + last]
    }

    /// The tools of that way.
    pub fn order(&self, mut set: usize, mut last: usize) -> Vec<u32> {
        let n = self.paths.tools.len();
        let mut order = vec![self.paths.tools[last]];
        while set & (set - 1) != 0 {
            let rest = set & !(1 << last);
            let here = self.least(set, last);
            let from =
                |&before: &usize| self.least(rest, before) + self.paths.change[before * n + last] == here;
            let Some(before) = bits(rest).find(from) else { unreachable!("a way has a way to it") };
            order.push(self.paths.tools[before]);
            (set, last) = (rest, before);
        }
        order.reverse();
        order
    }
}

fn bits(mut set: usize) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (set != 0).then(|| set.trailing_zeros() as usize)?;
        set &= set - 1;
        Some(bit)
    })
}
