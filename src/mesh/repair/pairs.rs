//! Facets that stand at one position more than once: which of them the surface needs.
//!
//! All such facets are left out first. Then they come back, once, where edges of the rest would stay open without them:
//! connected groups of them are in or out as a whole, and the edges around a group vote. What nothing needs is
//! a wall between bodies that touch, or a fin without thickness.

use crate::mesh::edges::{Edges, NO_TWIN, for_each_edge};
use crate::mesh::measure::{area_mm2, keep, length_mm};
use geometry::DisjointSets;

/// What is left.
pub(super) struct Settled {
    /// Those that stood alone, and then others of which one stays.
    pub triangles: Vec<[u32; 3]>,
    /// Which facets stood alone.
    pub alone: Vec<bool>,
    /// Whether the winding of those that follow them says nothing.
    pub added_free: Vec<bool>,
    /// Facets that repeated one that stays.
    pub duplicates: usize,
    /// Pairs of facets of which none stays.
    pub cancelled: usize,
}

/// A group is a body, not a sheet, if its area is this many times the area that its rim could enclose in a plane.
const BODY: f64 = 4.0;

/// Rounds in which groups are decided by those decided before.
const ROUNDS: usize = 200;

/// A set of facets with the same three corners.
struct EqualFacets {
    /// The first of them; of the more frequent winding.
    facet: [u32; 3],
    count: usize,
    /// As many of one winding as of the other.
    balanced: bool,
}

/// An edge of such facets.
struct Seam {
    length_mm: f64,
    /// Facets at it that stay.
    fixed: usize,
    sets: Vec<u32>,
}

/// Votes around a group, in millimetres of edge, for its sets of parity 0 and 1.
#[derive(Clone, Copy, Default)]
struct Votes {
    needed: [f64; 2],
    /// Edges that are closed without it.
    held: [f64; 2],
    /// Edges at which nothing else is.
    loose: [f64; 2],
    area_mm2: [f64; 2],
    balanced_mm2: f64,
}

/// Drops repeated facets as the rest needs it; `None` where none repeats another. Those that stood there in both windings
/// are free: their winding says nothing. O(n), and O(n log n) for facets at edges that are not just between two.
pub(super) fn settle(vertices: &[[f32; 3]], triangles: &[[u32; 3]], edges: &Edges) -> Option<Settled> {
    let (alone, sets) = equal_facets(triangles, candidates(edges));
    if sets.is_empty() {
        return None;
    }
    let mut triangles = triangles.to_vec();
    keep(&mut triangles, &alone);
    let stays = Groups::new(vertices, &triangles, &sets).settle();
    // Of what is nothing but sheets, nothing would be left to tell of.
    if triangles.is_empty() && !stays.contains(&true) {
        return None;
    }
    let mut settled = Settled { triangles, alone, added_free: Vec::new(), duplicates: 0, cancelled: 0 };
    for (set, stays) in sets.iter().zip(stays) {
        if stays {
            settled.triangles.push(set.facet);
            settled.added_free.push(set.balanced);
            settled.duplicates += set.count - 1;
        } else {
            settled.cancelled += set.count / 2;
            settled.duplicates += set.count % 2;
        }
    }
    Some(settled)
}

/// The facets that may be equal to others, ascending: those at edges with more than two facets or with two in the same
/// direction, and those with one neighbour only.
fn candidates(edges: &Edges) -> Vec<u32> {
    let mut candidates = edges.matches.crowded.clone();
    let by_facet = (0u32..).zip(edges.twins.as_chunks::<3>().0);
    let lies_on_one = by_facet.filter(|(_, [a, b, c])| *a != NO_TWIN && a / 3 == b / 3 && b / 3 == c / 3);
    candidates.extend(lies_on_one.map(|(t, _)| t));
    candidates.sort_unstable();
    candidates.dedup();
    candidates
}

/// Which facets stand alone, and the others, among those that may be equal to others.
fn equal_facets(triangles: &[[u32; 3]], candidates: Vec<u32>) -> (Vec<bool>, Vec<EqualFacets>) {
    let key = |t: u32| {
        let mut key = triangles[t as usize];
        key.sort_unstable();
        (key, t as usize)
    };
    let mut sorted: Vec<([u32; 3], usize)> = candidates.into_iter().map(key).collect();
    sorted.sort_unstable();
    let mut alone = vec![true; triangles.len()];
    let mut sets = Vec::new();
    for group in sorted.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
        let [a, b, c] = group[0].0;
        let first = triangles[group[0].1];
        let is_like =
            |t: [u32; 3], to: [u32; 3]| (0..3).any(|k| [to[k], to[(k + 1) % 3], to[(k + 2) % 3]] == t);
        let forward = group.iter().filter(|(_, t)| is_like([a, b, c], triangles[*t])).count();
        let backward = group.len() - forward;
        let facet = match forward.cmp(&backward) {
            std::cmp::Ordering::Greater => [a, b, c],
            std::cmp::Ordering::Less => [a, c, b],
            std::cmp::Ordering::Equal => first,
        };
        sets.push(EqualFacets { facet, count: group.len(), balanced: forward == backward });
        group.iter().for_each(|(_, t)| alone[*t] = false);
    }
    (alone, sets)
}

/// Connected sets of equal facets, and the decisions about them.
struct Groups<'a> {
    vertices: &'a [[f32; 3]],
    sets: &'a [EqualFacets],
    seams: Vec<Seam>,
    /// The group of each set, and on which of its two sides the set is.
    group: Vec<(u32, bool)>,
    /// Which side of each group stays, if any; nothing where it is open.
    stays: Vec<Option<[bool; 2]>>,
}

impl<'a> Groups<'a> {
    fn new(vertices: &'a [[f32; 3]], fixed: &[[u32; 3]], sets: &'a [EqualFacets]) -> Self {
        let all: Vec<[u32; 3]> = fixed.iter().copied().chain(sets.iter().map(|s| s.facet)).collect();
        let mut seams = Vec::new();
        for_each_edge(&all, vertices.len(), |sides| {
            let at = |side: &crate::mesh::edges::Side| (side.triangle() as usize).checked_sub(fixed.len());
            let here: Vec<u32> = sides.iter().filter_map(at).map(|s| s as u32).collect();
            if !here.is_empty() {
                let length_mm = length_mm(vertices, &all, sides[0].half());
                seams.push(Seam { length_mm, fixed: sides.len() - here.len(), sets: here });
            }
        });
        let mut parts = DisjointSets::new(sets.len());
        for seam in &seams {
            if let [a, b] = *seam.sets {
                // At an open edge one of the two is needed, at others both or none.
                parts.join_opposed(a, b, seam.fixed % 2 == 1);
            }
        }
        let group: Vec<(u32, bool)> = (0..sets.len() as u32).map(|s| parts.find_opposed(s)).collect();
        Self { vertices, sets, seams, group, stays: vec![None; sets.len()] }
    }

    /// Whether each set stays.
    fn settle(mut self) -> Vec<bool> {
        let rules: [Rule; 3] = [by_need, by_winding, by_shape];
        // From the rim inwards: what has come back counts for the next.
        for _ in 0..ROUNDS {
            let votes = self.votes();
            let decided = rules.iter().any(|rule| {
                let mut any = false;
                for (stays, votes) in self.stays.iter_mut().zip(&votes).filter(|(stays, _)| stays.is_none()) {
                    *stays = votes.as_ref().and_then(rule);
                    any |= stays.is_some();
                }
                any
            });
            if !decided {
                break;
            }
        }
        (0..self.sets.len()).map(|s| self.state(s) == Some(true)).collect()
    }

    /// Whether a set stays, if that is decided.
    fn state(&self, set: usize) -> Option<bool> {
        let (group, side) = self.group[set];
        self.stays[group as usize].map(|stays| stays[usize::from(side)])
    }

    /// Votes of the groups, at the positions of their representatives.
    fn votes(&self) -> Vec<Option<Votes>> {
        let mut votes = vec![None; self.sets.len()];
        for (set, &(group, side)) in self.sets.iter().zip(&self.group) {
            let votes = votes[group as usize].get_or_insert_with(Votes::default);
            let area_mm2 = area_mm2(self.vertices, set.facet);
            votes.area_mm2[usize::from(side)] += area_mm2;
            votes.balanced_mm2 += if set.balanced { area_mm2 } else { 0.0 };
        }
        for seam in &self.seams {
            let mut fixed = seam.fixed;
            let mut open = Vec::new();
            for &set in &seam.sets {
                match self.state(set as usize) {
                    Some(stays) => fixed += usize::from(stays),
                    None => open.push(set),
                }
            }
            if let [set] = *open {
                let (group, side) = self.group[set as usize];
                let Some(votes) = &mut votes[group as usize] else { continue };
                let count = match fixed {
                    0 => &mut votes.loose,
                    n if n % 2 == 1 => &mut votes.needed,
                    _ => &mut votes.held,
                };
                count[usize::from(side)] += seam.length_mm;
            }
        }
        votes
    }
}

/// Which side of a group stays, where votes decide.
type Rule = fn(&Votes) -> Option<[bool; 2]>;

/// The side that closes more edges than it opens.
fn by_need(votes: &Votes) -> Option<[bool; 2]> {
    let mixed = votes.area_mm2[1] > 0.0;
    let gain = |side: usize| votes.needed[side] - votes.held[side] - votes.loose[side];
    let best = usize::from(mixed && gain(1) > gain(0));
    // Where sets conflict with each other at open edges, one side is needed however the rest votes.
    let wanted = gain(best) > 0.0 || (mixed && gain(best) > gain(1 - best));
    wanted.then_some([best == 0, best == 1])
}

/// Facets of one winding count once, unless they do nothing but part bodies.
fn by_winding(votes: &Votes) -> Option<[bool; 2]> {
    let area_mm2 = votes.area_mm2[0] + votes.area_mm2[1];
    let parts = votes.held[0] > 0.0 && votes.needed[0] + votes.loose[0] <= 0.0;
    (votes.balanced_mm2 < area_mm2 / 2.0 && !parts).then_some([true, false])
}

/// Facets of both windings are a body if they enclose something by themselves.
fn by_shape(votes: &Votes) -> Option<[bool; 2]> {
    let flat_mm2 = votes.loose[0].powi(2) / (4.0 * std::f64::consts::PI);
    let encloses = votes.held[0] <= 0.0 && votes.area_mm2[0] > BODY * flat_mm2;
    encloses.then_some([true, false])
}
