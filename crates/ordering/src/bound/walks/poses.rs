//! How each path can be drawn: the places of a relaxed walk.

use super::super::model::{Model, price};
use super::costs::least;
use pathwright_geometry::Point;
use pathwright_geometry::real;

/// Pieces that a free loop has at first.
const PIECES: usize = 6;

/// The ways in which paths are drawn: an open path in either direction, a loop entered and left somewhere in a piece of it.
pub(super) struct Poses {
    /// Of each loop, the first vertex of each piece, and the number of vertices; nothing for open paths.
    cuts: Vec<Vec<u32>>,
    /// First pose of each path, and their number.
    first: Vec<u32>,
    item: Vec<u32>,
    /// Least cost of a link from one pose to another, in fine units, row by row.
    between: Vec<f64>,
    /// The least of these to any of a path from each pose, and from each path, row by row.
    to_item: Vec<f64>,
    of_items: Vec<f64>,
}

impl Poses {
    /// `None` if there are more than so many vertices.
    pub(super) fn new(model: &Model, most: usize) -> Option<Self> {
        if model.points.len() > most {
            return None;
        }
        let pieces = |item: usize| {
            let vertices = model.points_of_item(item as u32).len() as u32;
            let count = vertices.min(PIECES as u32);
            (0..=count).map(|k| k * vertices / count).collect()
        };
        let cuts = |item: usize| if model.bodies[item].closed { pieces(item) } else { Vec::new() };
        Some(Self::cut(model, (0..model.bodies.len()).map(cuts).collect()))
    }

    /// Those of several layers, one after the other.
    pub(super) fn joined<'p>(model: &Model, layers: impl Iterator<Item = &'p Self>) -> Self {
        Self::cut(model, layers.flat_map(|poses| poses.cuts.iter().cloned()).collect())
    }

    fn cut(model: &Model, cuts: Vec<Vec<u32>>) -> Self {
        let mut poses = Self {
            cuts,
            first: Vec::new(),
            item: Vec::new(),
            between: Vec::new(),
            to_item: Vec::new(),
            of_items: Vec::new(),
        };
        poses.measure(model, &vec![true; model.bodies.len()]);
        poses
    }

    pub(super) fn count(&self) -> usize {
        self.item.len()
    }

    pub(super) fn of(&self, item: u32) -> std::ops::Range<usize> {
        self.first[item as usize] as usize..self.first[item as usize + 1] as usize
    }

    pub(super) fn item_of(&self, pose: usize) -> u32 {
        self.item[pose]
    }

    /// Lengths of the links from a pose to all.
    pub(super) fn from(&self, pose: usize) -> &[f64] {
        &self.between[pose * self.count()..(pose + 1) * self.count()]
    }

    /// Least lengths of the links to a path from each pose.
    pub(super) fn to_item(&self, item: u32) -> &[f64] {
        &self.to_item[item as usize * self.count()..(item as usize + 1) * self.count()]
    }

    /// Least lengths of the links to a path from each.
    pub(super) fn least_to(&self, item: u32) -> &[f64] {
        let count = self.cuts.len();
        &self.of_items[item as usize * count..(item as usize + 1) * count]
    }

    /// The points, among those of the path, where a pose begins (0) or ends (1).
    pub(super) fn range(&self, pose: usize, side: usize) -> std::ops::Range<usize> {
        let item = self.item[pose] as usize;
        let nth = pose - self.first[item] as usize;
        match &self.cuts[item][..] {
            [] => nth ^ side..(nth ^ side) + 1,
            cuts => cuts[nth] as usize..cuts[nth + 1] as usize,
        }
    }

    pub(super) fn points<'a>(&self, model: &'a Model, pose: usize, side: usize) -> &'a [Point] {
        &model.points_of_item(self.item[pose])[self.range(pose, side)]
    }

    /// The points, by number among those of their paths, between which a link from one pose to another is shortest.
    pub(super) fn joint(&self, model: &Model, from: usize, to: usize) -> (usize, usize) {
        let (a, b) = nearest(self.points(model, from, 1), self.points(model, to, 0));
        (self.range(from, 1).start + a, self.range(to, 0).start + b)
    }

    /// Makes vertices of loops pieces of their own; whether any was not.
    pub(super) fn split(&mut self, model: &Model, vertices: &[(u32, usize)]) -> bool {
        let mut changed = vec![false; self.cuts.len()];
        for &(item, vertex) in vertices {
            let cuts = &mut self.cuts[item as usize];
            if cuts.is_empty() {
                continue;
            }
            for cut in [vertex as u32, vertex as u32 + 1] {
                if let Err(at) = cuts.binary_search(&cut) {
                    cuts.insert(at, cut);
                    changed[item as usize] = true;
                }
            }
        }
        let any = changed.contains(&true);
        if any {
            self.measure(model, &changed);
        }
        any
    }

    /// Measures all links at paths whose pieces have changed.
    fn measure(&mut self, model: &Model, changed: &[bool]) {
        let (old_first, old_count) = (std::mem::take(&mut self.first), self.count());
        self.first = vec![0];
        self.item.clear();
        for (item, cuts) in (0..).zip(&self.cuts) {
            let count = if cuts.is_empty() { 2 } else { cuts.len() - 1 };
            self.item.resize(self.item.len() + count, item);
            self.first.push(self.item.len() as u32);
        }
        let (count, items) = (self.count(), self.cuts.len());
        let mut between = Vec::with_capacity(count * count);
        let mut to_item = vec![0.0; count * items];
        let mut of_items = vec![f64::INFINITY; items * items];
        for (p, &from) in self.item.iter().enumerate() {
            let leave = self.points(model, p, 1);
            for to in 0..items as u32 {
                let begin = between.len();
                let kind = model.kind(from, to);
                if !model.permits(from, to) {
                    // None leads there.
                    between.resize(begin + self.of(to).len(), 0.0);
                } else if changed[from as usize] || changed[to as usize] {
                    between.extend(self.of(to).map(|q| {
                        let enter = self.points(model, q, 0);
                        let (a, b) = nearest(leave, enter);
                        price(&model.cost, leave[a], enter[b], kind) as f64
                    }));
                } else {
                    let row = old_first[from as usize] as usize + p - self.first[from as usize] as usize;
                    let own = old_first[to as usize] as usize..old_first[to as usize + 1] as usize;
                    between.extend(&self.between[row * old_count..][own]);
                }
                let least = least(between[begin..].iter().copied());
                to_item[to as usize * count + p] = least;
                let at = &mut of_items[to as usize * items + from as usize];
                *at = real::lesser(least, *at);
            }
        }
        (self.between, self.to_item, self.of_items) = (between, to_item, of_items);
    }
}

/// The numbers of the nearest two points of two sets.
fn nearest(from: &[Point], to: &[Point]) -> (usize, usize) {
    let mut best = (i64::MAX, 0, 0);
    for (a, p) in from.iter().enumerate() {
        for (b, q) in to.iter().enumerate() {
            let distance2 = p.distance2(*q);
            if distance2 < best.0 {
                best = (distance2, a, b);
            }
        }
    }
    (best.1, best.2)
}
