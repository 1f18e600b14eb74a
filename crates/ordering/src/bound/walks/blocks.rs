//! In which order a relaxed walk may take what it draws without interruption.

use rustc_hash::FxHashMap;

use super::super::model::Model;
use crate::options::Scope;

/// A set of blocks, or of the paths of one.
pub(super) type Set = u128;
/// Members that such a set can have.
pub(in super::super) const MOST: usize = Set::BITS as usize;

/// A block being drawn, and what is remembered of those before it.
pub(super) struct Turn {
    pub(super) block: u32,
    /// Blocks that are known to be drawn when it is over.
    pub(super) done: Set,
    /// Turns that may come next.
    pub(super) next: Vec<u32>,
    /// How many come before it.
    pub(super) place: usize,
}

/// What is drawn without interruption: a run, or under `layer` scope a stage.
pub(super) struct Blocks {
    /// Paths of each.
    pub(super) items: Vec<Vec<u32>>,
    /// Block of each path, and its number there.
    pub(super) of: Vec<u32>,
    pub(super) nth: Vec<u32>,
    /// Each after all that may come before it.
    pub(super) turns: Vec<Turn>,
    /// Blocks below each layer, and in all.
    pub(super) below: Vec<usize>,
    /// Blocks that must come before each.
    pub(super) before: Vec<Set>,
    /// What is remembered at each block.
    pub(super) remembered: Vec<Set>,
}

impl Blocks {
    /// Blocks that are known to be drawn after one, and after those known before it.
    pub(super) fn after(&self, done: Set, block: usize) -> Set {
        (done | 1 << block | self.before[block]) & self.remembered[block]
    }

    /// At each block walks remember so many others as the first of `tries` says with which there are not more than `most` turns.
    /// `None` if blocks or paths are too many.
    pub(super) fn new(model: &Model, layer_of: &[u32], tries: &[usize], most: usize) -> Option<Self> {
        let of: Vec<u32> = match model.scope {
            Scope::Layer => model.bodies.iter().map(|body| body.groups[0]).collect(),
            Scope::Feature | Scope::Island => model.run_of(),
        };
        let count = of.iter().max().map_or(0, |&last| last as usize + 1);
        let mut items = vec![Vec::new(); count];
        let mut nth = vec![0; of.len()];
        for (item, &block) in of.iter().enumerate() {
            nth[item] = items[block as usize].len() as u32;
            items[block as usize].push(item as u32);
        }
        if count > MOST || items.iter().any(|items| items.len() > MOST) {
            return None;
        }
        let order = Order::new(model, layer_of, &items);
        let (turns, remembered) = tries.iter().find_map(|&near| {
            let remembered = order.remembered(near);
            Some((order.turns(near >= count, &remembered, most)?, remembered))
        })?;
        Some(Self { items, of, nth, turns, below: order.below, before: order.before, remembered })
    }
}

/// What precedence says of blocks.
struct Order<'a> {
    model: &'a Model,
    /// One path of each.
    path: Vec<u32>,
    /// Blocks that must come before each, and after it; those of its island and stage.
    before: Vec<Set>,
    after: Vec<Set>,
    island: Vec<Set>,
    /// Others, nearest first.
    near: Vec<Vec<usize>>,
    /// Blocks in the layers below each layer, and in all.
    below: Vec<usize>,
}

impl<'a> Order<'a> {
    fn new(model: &'a Model, layer_of: &[u32], items: &[Vec<u32>]) -> Self {
        let path: Vec<u32> = items.iter().map(|items| items[0]).collect();
        let body = |block: usize| &model.bodies[path[block] as usize];
        let count = items.len();
        let set = |block: usize, has: &dyn Fn(usize) -> bool| {
            (0..count)
                .filter(|&other| other != block && has(other))
                .fold(0, |set: Set, other| set | 1 << other)
        };
        let together = |a: usize, b: usize| {
            body(a).groups[0] == body(b).groups[0] && body(a).place.island == body(b).place.island
        };
        let ordered = model.scope != Scope::Layer;
        let earlier = |a: usize, b: usize| {
            body(a).groups[0] < body(b).groups[0] || ordered && together(a, b) && body(a).rank < body(b).rank
        };
        let points = |block: usize| {
            let points = items[block].iter().flat_map(|&item| model.points_of_item(item));
            points.copied().collect::<Vec<_>>()
        };
        let points: Vec<_> = (0..count).map(points).collect();
        let distance = |a: usize, b: usize| {
            let some = |block: usize| points[block].iter().step_by(points[block].len().div_ceil(16));
            some(a).flat_map(|p| some(b).map(|q| p.distance2(*q))).min()
        };
        let near = |block: usize| {
            let mut others: Vec<usize> = (0..count).filter(|&other| other != block).collect();
            others.sort_by_cached_key(|&other| distance(block, other));
            others
        };
        let layer = |block: usize| layer_of[path[block] as usize] as usize;
        let layers = (0..count).map(layer).max().map_or(0, |last| last + 1);
        let below = (0..=layers).map(|k| (0..count).filter(|&block| layer(block) < k).count()).collect();
        Self {
            model,
            before: (0..count).map(|block| set(block, &|other| earlier(other, block))).collect(),
            after: (0..count).map(|block| set(block, &|other| earlier(block, other))).collect(),
            island: (0..count)
                .map(|block| set(block, &|other| ordered && together(block, other)) | 1 << block)
                .collect(),
            near: (0..count).map(near).collect(),
            below,
            path,
        }
    }

    /// Each block, and so many others near it.
    fn remembered(&self, near: usize) -> Vec<Set> {
        let some = |block: usize| self.near[block].iter().take(near);
        let set = |block: usize| some(block).fold(1 << block, |set: Set, other| set | 1 << other);
        (0..self.path.len()).map(set).collect()
    }

    /// All turns of walks that remember at each block those given, or `all`; `None` if there are more than so many.
    fn turns(&self, all: bool, remembered: &[Set], most: usize) -> Option<Vec<Turn>> {
        let count = self.path.len();
        let mut turns: Vec<Turn> = Vec::new();
        let (mut begin, mut numbers) = (0, FxHashMap::default());
        for place in 0..count {
            let end = turns.len();
            numbers.clear();
            for from in if place == 0 { 0..1 } else { begin..end } {
                for (block, remembered) in remembered.iter().enumerate() {
                    let (before, after) = (self.before[block].count_ones(), self.after[block].count_ones());
                    if (place as u32) < before || place + after as usize >= count {
                        continue;
                    }
                    let known = if place == 0 { 0 } else { turns[from].done };
                    let follows = place == 0 || self.follows(turns[from].block as usize, block, known, all);
                    if !follows || known >> block & 1 == 1 || all && self.before[block] & !known != 0 {
                        continue;
                    }
                    let known = (known | 1 << block | self.before[block]) & remembered;
                    let number = *numbers.entry((block, known)).or_insert_with(|| {
                        turns.push(Turn { block: block as u32, done: known, next: Vec::new(), place });
                        turns.len() as u32 - 1
                    });
                    if place > 0 {
                        turns[from].next.push(number);
                    }
                }
            }
            if turns.len() > most {
                return None;
            }
            begin = end;
        }
        Some(turns)
    }

    /// Whether a block may come straight after another, `known` drawn before; `all`: nothing else.
    fn follows(&self, from: usize, to: usize, known: Set, all: bool) -> bool {
        let [i, j] = [self.path[from], self.path[to]];
        let [a, b] = [i, j].map(|item| self.model.bodies[item as usize].groups[0]);
        if a != b {
            return a < b && self.model.permits(i, j);
        }
        if all && self.model.scope == Scope::Island && self.island[from] != self.island[to] {
            return self.island[from] & !known == 0;
        }
        self.model.leads(i, j)
    }
}
