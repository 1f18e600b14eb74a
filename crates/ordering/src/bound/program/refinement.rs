//! Finer pieces of loops, where a solution crosses them, and what remains known with these.

use std::ops::Range;

use super::super::model::Pieces;
use super::super::passages::Passage;
use super::super::points::PricedPoints;
use super::super::relaxation::{Neighbour, Relaxation};
use super::simplex::{Rows, Solution};

/// Shares of links that are looked at.
const USED: f64 = 0.01;

/// Pieces of loops that are entered at one point and left at another of the same piece become several: each of these points one,
/// and what lies between two of them two. `None` if there is no such piece.
pub(super) fn finer(
    relaxation: &Relaxation,
    solution: &Solution,
    pieces: &Pieces,
    ends: &[Option<PricedPoints>; 2],
) -> Option<Pieces> {
    let model = relaxation.model;
    let mut finer = pieces.clone();
    for (t, mut points) in touched(relaxation, solution, ends).into_iter().enumerate() {
        points.sort_unstable();
        points.dedup();
        if points.len() < 2 {
            continue;
        }
        let terminal = model.terminals[t];
        let first = model.range_of_item(terminal.item).start as u32;
        let middles: Vec<u32> = points.windows(2).map(|pair| (pair[0] + pair[1]).div_ceil(2)).collect();
        let starts =
            points.into_iter().flat_map(|p| [p, p + 1]).chain(middles).filter(|&p| p < terminal.last);
        finer[terminal.item as usize].extend(starts.map(|p| p - first));
    }
    for starts in &mut finer {
        starts.sort_unstable();
        starts.dedup();
    }
    (finer != *pieces).then_some(finer)
}

/// The points at which a solution's links end, by terminal.
fn touched(relaxation: &Relaxation, solution: &Solution, ends: &[Option<PricedPoints>; 2]) -> Vec<Vec<u32>> {
    let model = relaxation.model;
    let mut touched: Vec<Vec<u32>> = vec![Vec::new(); model.terminals.len()];
    for (link, _) in solution.used_links(relaxation, USED) {
        let (p, q) = model.nearest(link.a, link.b);
        touched[link.a as usize].push(p);
        touched[link.b as usize].push(q);
    }
    for (side, end, _) in solution.used_ends(relaxation, USED) {
        let Some(points) = &ends[side] else { continue };
        let at = model.terminals[end.terminal as usize];
        let nearest = (at.first..at.last).min_by_key(|&p| points.nearest(model.points[p as usize]));
        touched[end.terminal as usize].extend(nearest);
    }
    touched
}

/// What is known of links, ties and sets, by the terminals of coarser pieces.
pub(super) struct Carried {
    links: Vec<(u32, u32)>,
    /// Members, how often they are left, and guard.
    cuts: Vec<(Vec<u32>, i32, Option<u32>)>,
    trees: Vec<Vec<bool>>,
    passages: Vec<Passage>,
    ties: Vec<(u32, Neighbour)>,
    /// New terminals of each old one.
    parts: Vec<Range<u32>>,
}

impl Carried {
    /// What has a price, or none yet; of links those that cost no more than they are worth and `worth`.
    pub(super) fn new(
        relaxation: &Relaxation,
        solution: &Solution,
        rows: Rows,
        (coarse, finer): (&Pieces, &Pieces),
        worth: f64,
    ) -> Self {
        let counts = |prices: &[i64], at: usize| prices.get(at).is_none_or(|&price| price > 0);
        let parts = parts(coarse, finer);
        let outside = parts.last().map_or(0, |part| part.end);
        let part = |t: &u32| parts.get(*t as usize).cloned().unwrap_or(outside..outside + 1);
        let (cuts, prices) = (&relaxation.cuts, &solution.multipliers);
        let cuts = (0..cuts.members.len())
            .filter(|&cut| counts(&prices.cuts, cut))
            .map(|cut| (cuts.members[cut].iter().flat_map(part).collect(), cuts.least[cut], cuts.guard[cut]));
        let cuts = cuts.collect();
        let links = relaxation.links.iter().zip(&solution.excess).flat_map(|(links, excess)| {
            let is_worth = move |k: &usize| excess.get(*k).is_none_or(|&excess| excess <= worth);
            (0..links.len()).filter(is_worth).map(|k| (links[k].a, links[k].b))
        });
        let links = links.collect();
        let neighbours = relaxation.neighbours();
        let ties = rows.ties.iter().filter(|tie| counts(&prices.ties, tie.0 as usize));
        let ties = ties.filter_map(|&(tie, _)| neighbours[tie as usize]).collect();
        let passages = relaxation.passages.iter().enumerate();
        let passages =
            passages.filter(|(k, _)| counts(&prices.passages, *k)).map(|(_, passage)| passage.clone());
        Self { links, cuts, trees: rows.trees, passages: passages.collect(), ties, parts }
    }

    /// Makes it known to the relaxation of finer pieces.
    pub(super) fn restore(self, relaxation: &mut Relaxation) -> Rows {
        let model = relaxation.model;
        for (a, b) in self.links {
            let [one, other] = [a, b].map(|t| self.parts[t as usize].clone());
            for (from, to) in [(one.clone(), other.clone()), (other, one)] {
                for t in from {
                    let nearest = to.clone().min_by_key(|&other| (model.cheapest(t, other), other));
                    nearest.into_iter().for_each(|nearest| relaxation.add_link(t, nearest));
                }
            }
        }
        for (members, least, guard) in self.cuts {
            relaxation.cuts.add(model, members, least, guard);
        }
        relaxation.passages = self.passages;
        let pieces = self
            .ties
            .into_iter()
            .flat_map(|(t, neighbour)| self.parts[t as usize].clone().map(move |t| (t, neighbour)));
        let mut ties: Vec<(u32, u32)> =
            pieces.filter_map(|(t, neighbour)| Some((relaxation.tie_of(t, neighbour)?, t))).collect();
        ties.sort_unstable();
        ties.dedup();
        Rows { ties, trees: self.trees }
    }
}

/// The terminals of finer pieces that make up each one of coarser pieces.
fn parts(coarse: &Pieces, finer: &Pieces) -> Vec<Range<u32>> {
    let mut parts = Vec::new();
    let mut next = 0;
    for (coarse, finer) in coarse.iter().zip(finer) {
        for (k, from) in coarse.iter().enumerate() {
            let until = coarse.get(k + 1).copied().unwrap_or(u32::MAX);
            let count = finer.iter().filter(|&at| (*from..until).contains(at)).count() as u32;
            parts.push(next..next + count);
            next += count;
        }
    }
    parts
}
