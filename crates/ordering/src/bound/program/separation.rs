//! Constraints that a solution of the program violates.

use super::super::network::Network;
use super::super::relaxation::Relaxation;
use super::aside::Aside;
use super::precedence;
use super::simplex::{Rows, Solution};

/// Shares as integers.
const ONE: u32 = 1_000_000;
/// What is violated by less is not.
const SLACK: f64 = 0.02;
/// How often a set must be left, less what is no violation.
const TWICE: u32 = ((2.0 - SLACK) * ONE as f64) as u32;
/// Shares that count as none.
const NONE: f64 = 1e-5;

/// Adds ties, trees and cuts that a solution violates; how many. Cuts are looked for where no tree is missing.
pub(super) fn separate(relaxation: &mut Relaxation, rows: &mut Rows, solution: &Solution) -> usize {
    let ties = add_ties(relaxation, rows, solution);
    let trees = add_trees(relaxation, rows, solution);
    let passages = precedence::separate(relaxation, solution);
    ties + trees + passages + if trees == 0 { add_cuts(relaxation, solution) } else { 0 }
}

/// Links from one neighbour to a piece where the loop is not entered.
fn add_ties(relaxation: &Relaxation, rows: &mut Rows, solution: &Solution) -> usize {
    let mut used = vec![0.0; relaxation.ties];
    for (link, share) in solution.used_links(relaxation, 0.0) {
        link.ties.iter().for_each(|&tie| used[tie as usize] += share);
    }
    for (_, end, share) in solution.used_ends(relaxation, 0.0) {
        used[end.tie as usize] += share;
    }
    let mut is_known = vec![false; relaxation.ties];
    rows.ties.iter().for_each(|&(tie, _)| is_known[tie as usize] = true);
    let before = rows.ties.len();
    for (tie, neighbour) in relaxation.neighbours().into_iter().enumerate() {
        let Some((terminal, _)) = neighbour else { continue };
        if !is_known[tie] && used[tie] > solution.entered[terminal as usize] + SLACK {
            rows.ties.push((tie as u32, terminal));
        }
    }
    rows.ties.len() - before
}

/// The network of a solution's links, and of those at the ends of walks with what is outside; `node` names a terminal's.
fn network(relaxation: &Relaxation, solution: &Solution, outside: u32, node: impl Fn(u32) -> u32) -> Network {
    let whole = |share: f64| (share * f64::from(ONE)) as u32;
    let links = solution.used_links(relaxation, NONE);
    let links = links.map(|(link, share)| (node(link.a), node(link.b), whole(share)));
    let ends = solution.used_ends(relaxation, NONE);
    let ends = ends.map(|(_, end, share)| (node(end.terminal), outside, whole(share)));
    Network::new(outside + 1, links.chain(ends))
}

/// Sets of whole paths that are left less than twice, and so close a circle.
fn add_trees(relaxation: &Relaxation, rows: &mut Rows, solution: &Solution) -> usize {
    let model = relaxation.model;
    let outside = model.bodies.len() as u32;
    let network = network(relaxation, solution, outside, |t| model.terminals[t as usize].item);
    let before = rows.trees.len();
    let mut is_covered = vec![false; model.bodies.len()];
    for item in 0..outside {
        if is_covered[item as usize] {
            continue;
        }
        let Some(mut set) = network.least_cut(&[(item, 2 * ONE)], &[outside], TWICE) else { continue };
        set.truncate(model.bodies.len());
        set.iter().zip(&mut is_covered).for_each(|(is_in, covered)| *covered |= is_in);
        if set.iter().filter(|&&is_in| is_in).count() > 1 && !rows.trees.contains(&set) {
            rows.trees.push(set);
        }
    }
    rows.trees.len() - before
}

/// Sets with pieces of loops that are left less than twice: for each path the one that is left least if it is entered there, and
/// sets that the relaxation looks for.
fn add_cuts(relaxation: &mut Relaxation, solution: &Solution) -> usize {
    let model = relaxation.model;
    let outside = model.terminals.len() as u32;
    // Both ends of an open path are one.
    let node = |t: u32| match model.is_end(t) {
        true => model.bodies[model.terminals[t as usize].item as usize].first,
        false => t,
    };
    let network = network(relaxation, solution, outside, node);
    let aside = Aside::new(relaxation, solution);
    let mut added = 0;
    for (item, body) in (0u32..).zip(&model.bodies) {
        let share = |t: u32| (2.0 * solution.entered[t as usize] * f64::from(ONE)) as u32;
        let sources: Vec<(u32, u32)> = match body.closed {
            false => vec![(body.first, 2 * ONE)],
            true => (body.first..body.last).map(|t| (t, share(t))).filter(|source| source.1 > 0).collect(),
        };
        let Some(side) = network.least_cut(&sources, &[outside], TWICE) else { continue };
        let mut is_in: Vec<bool> = (0..outside).map(|t| side[node(t) as usize]).collect();
        aside.assign(model, &mut is_in);
        let members: Vec<u32> = (0..outside).filter(|&t| is_in[t as usize]).collect();
        let is_whole = (body.first..body.last).all(|t| is_in[t as usize]);
        let guard = (!is_whole).then_some(item);
        added += usize::from(members.len() > 1 && relaxation.cuts.add(model, members, 2, guard));
    }
    added + relaxation.look_for_used(&solution.links, &solution.ends)
}
