//! From the axis as a graph to paths: spurs pruned, branches joined straight through junctions.

use super::axis::{NONE, Node};
use super::outline::{Position, direction, distance};

/// Rounds of pruning; each takes at least one spur off every junction concerned, and noise is not deeper than this.
const ROUNDS: usize = 8;

/// Branches that leave a junction at this cosine or below count as one line (a bend of up to 75°).
const STRAIGHT: f64 = -0.25;

/// Node indices from end to end; closed if the last is linked to the first.
pub(super) struct AxisPath {
    pub(super) nodes: Vec<u32>,
    pub(super) closed: bool,
    /// Whether either end is a free end, not one at another path.
    pub(super) free: [bool; 2],
}

/// A run of nodes between two nodes that are ends or junctions.
pub(super) struct Branch {
    nodes: Vec<u32>,
    length: f64,
}

impl Branch {
    fn end(&self, i: usize) -> u32 {
        if i == 0 { self.nodes[0] } else { self.nodes[self.nodes.len() - 1] }
    }

    /// Ends where the region widens to the junction at one of its ends: the line that goes on there covers that.
    fn leave_junction(&mut self, end: usize) {
        if self.nodes.len() > 2 {
            self.nodes.remove(if end == 0 { 0 } else { self.nodes.len() - 1 });
        }
    }
}

/// Removes branches with a free end that reach no farther than the region is wide where they leave: they lead into
/// corners, which the width there covers already, if anything does. Returns the branches that are left.
pub(super) fn prune(nodes: &mut [Node], covers: impl Fn(&Node) -> bool) -> Vec<Branch> {
    for _ in 0..ROUNDS {
        let mut spurs: Vec<(u32, f64, u32)> = Vec::new();
        let left = branches(nodes);
        for branch in &left {
            for i in 0..2 {
                let (leaf, root) = (branch.end(i), branch.end(1 - i));
                let (leaf_node, root_node) = (&nodes[leaf as usize], &nodes[root as usize]);
                let extent = branch.length + leaf_node.reach;
                if leaf_node.degree() == 1
                    && root_node.degree() == 3
                    && extent < root_node.width
                    && covers(root_node)
                {
                    let first = branch.nodes[if i == 0 { branch.nodes.len() - 2 } else { 1 }];
                    spurs.push((root, extent, first));
                }
            }
        }
        if spurs.is_empty() {
            return left;
        }
        spurs.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for group in spurs.chunk_by(|a, b| a.0 == b.0) {
            // Where all three are spurs the shape is a blob; its longest line stays.
            let gone = if group.len() == 3 { &group[..1] } else { group };
            for &(root, _, first) in gone {
                nodes[root as usize].unlink(first);
                nodes[first as usize].unlink(root);
                // What is left of the spur must not come back as a line of its own.
                forget(nodes, first);
            }
        }
    }
    branches(nodes)
}

fn forget(nodes: &mut [Node], from: u32) {
    let mut next = Some(from);
    while let Some(node) = next {
        next = nodes[node as usize].neighbours().next();
        if let Some(other) = next {
            nodes[other as usize].unlink(node);
        }
        nodes[node as usize].links = [NONE; 3];
    }
}

/// All runs between ends and junctions, each once, in the order of their first nodes.
fn branches(nodes: &[Node]) -> Vec<Branch> {
    let (mut found, mut run) = (Vec::new(), Vec::new());
    for (i, node) in nodes.iter().enumerate() {
        if !matches!(node.degree(), 1 | 3) {
            continue;
        }
        for first in node.neighbours() {
            walk(nodes, i as u32, first, &mut run);
            let (start, end) = (run[0], run[run.len() - 1]);
            let back = run[run.len() - 2];
            // Met from both ends; kept once.
            if (start, first) <= (end, back) {
                let length =
                    run.windows(2).map(|w| distance(nodes[w[0] as usize].at, nodes[w[1] as usize].at)).sum();
                found.push(Branch { nodes: run.clone(), length });
            }
        }
    }
    found
}

/// The nodes from `start` over `first` to the next node that is an end or a junction, or back to `start`. They replace the
/// contents of `run`.
fn walk(nodes: &[Node], start: u32, first: u32, run: &mut Vec<u32>) {
    run.clear();
    run.extend([start, first]);
    let (mut before, mut here) = (start, first);
    while here != start && nodes[here as usize].degree() == 2 {
        let Some(next) = nodes[here as usize].neighbours().find(|&n| n != before) else {
            break;
        };
        run.push(next);
        (before, here) = (here, next);
    }
}

/// Joins the straightest pair of branches at each junction, lets the others end beside it, and adds the loops that have no
/// junction.
///
/// Junctions closer to each other than half their width are one.
pub(super) fn axis_paths(nodes: &[Node], all: Vec<Branch>) -> Vec<AxisPath> {
    let loops = loops(nodes, &all);
    let mut cluster: Vec<u32> = (0..nodes.len() as u32).collect();
    let is_junction = |n: u32| nodes[n as usize].degree() == 3;
    let is_bridge = |b: &Branch| {
        let [p, q] = [0, 1].map(|i| b.end(i));
        let width = nodes[p as usize].width.min(nodes[q as usize].width);
        p != q && is_junction(p) && is_junction(q) && b.length < 0.5 * width
    };
    let (bridges, mut branches): (Vec<Branch>, Vec<Branch>) = all.into_iter().partition(is_bridge);
    for bridge in &bridges {
        let (a, b) = (find(&cluster, bridge.end(0)), find(&cluster, bridge.end(1)));
        cluster[a.max(b) as usize] = a.min(b);
    }

    // Every end of a branch at a junction: (cluster, branch, which end, direction of leaving).
    let mut arrivals: Vec<(u32, usize, usize, Position)> = Vec::new();
    for (i, branch) in branches.iter().enumerate() {
        for end in 0..2 {
            let node = branch.end(end);
            if is_junction(node) {
                arrivals.push((find(&cluster, node), i, end, leaving(nodes, branch, end)));
            }
        }
    }
    arrivals.sort_by_key(|a| (a.0, a.1, a.2));
    let mut partner: Vec<[Option<(usize, usize)>; 2]> = vec![[None; 2]; branches.len()];
    for group in arrivals.chunk_by(|a, b| a.0 == b.0) {
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, a) in group.iter().enumerate() {
            for (j, b) in group.iter().enumerate().skip(i + 1) {
                let cos = a.3[0] * b.3[0] + a.3[1] * b.3[1];
                if cos <= STRAIGHT {
                    pairs.push((cos, i, j));
                }
            }
        }
        let straightest = pairs.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, i, j)) = straightest {
            let (a, b) = (&group[i], &group[j]);
            partner[a.1][a.2] = Some((b.1, b.2));
            partner[b.1][b.2] = Some((a.1, a.2));
            let others = (0..group.len()).filter(|&k| k != i && k != j);
            others.for_each(|k| branches[group[k].1].leave_junction(group[k].2));
        }
    }

    let mut found = chain(nodes, &mut branches, &partner);
    found.extend(loops);
    found
}

fn find(cluster: &[u32], mut n: u32) -> u32 {
    while cluster[n as usize] != n {
        n = cluster[n as usize];
    }
    n
}

/// The direction in which a branch leaves the junction at one of its ends, seen over the junction's width.
fn leaving(nodes: &[Node], branch: &Branch, end: usize) -> Position {
    let at = |k: usize| {
        let k = if end == 0 { k } else { branch.nodes.len() - 1 - k };
        nodes[branch.nodes[k] as usize]
    };
    let start = at(0);
    let far = (1..branch.nodes.len()).find(|&k| distance(start.at, at(k).at) >= start.width);
    direction(start.at, at(far.unwrap_or(branch.nodes.len() - 1)).at)
}

/// Follows the partners from branch to branch.
fn chain(nodes: &[Node], branches: &mut [Branch], partner: &[[Option<(usize, usize)>; 2]]) -> Vec<AxisPath> {
    let mut used = vec![false; branches.len()];
    let mut found = Vec::new();
    // Paths with ends first, from those ends; what is left goes round.
    let starts = (0..branches.len()).flat_map(|b| [(b, 0), (b, 1)]);
    let open = starts.clone().filter(|&(b, end)| partner[b][end].is_none());
    for (first, end) in open.chain(starts.clone()) {
        if used[first] {
            continue;
        }
        let mut path = AxisPath { nodes: Vec::new(), closed: false, free: [false; 2] };
        let (mut branch, mut end) = (first, end);
        path.free[0] = nodes[branches[branch].end(end) as usize].degree() == 1;
        loop {
            used[branch] = true;
            let mut run = std::mem::take(&mut branches[branch].nodes);
            if end == 1 {
                run.reverse();
            }
            let last = run[run.len() - 1];
            path.free[1] = nodes[last as usize].degree() == 1;
            match partner[branch][1 - end] {
                Some((next, next_end)) if !used[next] => {
                    // The junction itself is no part of a line that continues.
                    run.pop();
                    append(&mut path.nodes, &run);
                    (branch, end) = (next, next_end);
                }
                Some(_) => {
                    run.pop();
                    append(&mut path.nodes, &run);
                    path.closed = path.nodes.len() > 2;
                    break;
                }
                None => {
                    append(&mut path.nodes, &run);
                    break;
                }
            }
        }
        found.push(path);
    }
    found
}

/// Appends a branch to a path; the junction between them is left out.
fn append(path: &mut Vec<u32>, run: &[u32]) {
    let skip = usize::from(!path.is_empty());
    path.extend_from_slice(run.get(skip..).unwrap_or(&[]));
}

/// The loops of nodes that are in none of the branches.
fn loops(nodes: &[Node], branches: &[Branch]) -> Vec<AxisPath> {
    let mut seen = vec![false; nodes.len()];
    for branch in branches {
        branch.nodes.iter().for_each(|&n| seen[n as usize] = true);
    }
    let mut found = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        if seen[i] || node.degree() != 2 {
            continue;
        }
        let Some(first) = node.neighbours().next() else {
            continue;
        };
        let mut run = Vec::new();
        walk(nodes, i as u32, first, &mut run);
        run.pop();
        run.iter().for_each(|&n| seen[n as usize] = true);
        if run.len() > 2 {
            found.push(AxisPath { nodes: run, closed: true, free: [false; 2] });
        }
    }
    found
}
