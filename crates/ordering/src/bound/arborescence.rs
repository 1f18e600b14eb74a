//! The cheapest arborescence: a tree of arcs that lead away from a root.

/// An arc, by the nodes that it leads from and to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub(super) price: i64,
    pub(super) tail: u32,
    pub(super) head: u32,
}

/// No arc.
const NONE: (i64, u32) = (i64::MAX, u32::MAX);

/// The arc, by its number, that enters each node but the last, the root, in a cheapest arborescence; `None` if the root does
/// not reach every node.
///
/// Chu & Liu 1965; Edmonds 1967, doi:10.6028/jres.071B.032: every node takes its cheapest arc; circles are contracted, and the
/// smaller problem tells where each is entered. O(n²) for each of the at most n contractions, of which few are needed.
pub(super) fn cheapest(nodes: usize, arcs: &[Arc]) -> Option<Vec<u32>> {
    let mut entries = vec![NONE; nodes * nodes];
    for (number, arc) in (0..).zip(arcs) {
        let entry = &mut entries[arc.head as usize * nodes + arc.tail as usize];
        *entry = (*entry).min((arc.price, number));
    }
    let part_of = (0..nodes as u32).collect();
    Some(Level { nodes, root: nodes - 1, entries, part_of }.enter(arcs)?[..nodes - 1].to_vec())
}

/// The problem after some contractions.
struct Level {
    nodes: usize,
    root: usize,
    /// Cheapest arc between two nodes, with what is left of its price: `entries[head * nodes + tail]`.
    entries: Vec<(i64, u32)>,
    /// What has become of each node that there was at first.
    part_of: Vec<u32>,
}

impl Level {
    /// The arc that enters each node; the value of the root is meaningless.
    fn enter(self, arcs: &[Arc]) -> Option<Vec<u32>> {
        let tail_of = |number: u32| self.part_of[arcs[number as usize].tail as usize] as usize;
        let mut chosen = vec![NONE; self.nodes];
        for head in (0..self.nodes).filter(|&head| head != self.root) {
            let row = &self.entries[head * self.nodes..(head + 1) * self.nodes];
            let others = row.iter().enumerate().filter(|&(tail, _)| tail != head);
            chosen[head] = others.map(|(_, &entry)| entry).min().filter(|&entry| entry != NONE)?;
        }
        let (part, in_circle, parts) = self.contract(|head| tail_of(chosen[head].1));
        let mut numbers: Vec<u32> = chosen.iter().map(|&(_, number)| number).collect();
        if parts == self.nodes {
            return Some(numbers);
        }
        let mut entries = vec![NONE; parts * parts];
        for head in 0..self.nodes {
            // A circle that is entered here loses the arc that it has here.
            let spared = if in_circle[head] { chosen[head].0 } else { 0 };
            for tail in (0..self.nodes).filter(|&tail| part[tail] != part[head]) {
                let (price, number) = self.entries[head * self.nodes + tail];
                if number != NONE.1 {
                    let entry = &mut entries[part[head] * parts + part[tail]];
                    *entry = (*entry).min((price - spared, number));
                }
            }
        }
        let part_of = self.part_of.iter().map(|&node| part[node as usize] as u32).collect();
        let root = part[self.root];
        let below = Level { nodes: parts, root, entries, part_of }.enter(arcs)?;
        for (_, &number) in below.iter().enumerate().filter(|&(node, _)| node != root) {
            numbers[self.part_of[arcs[number as usize].head as usize] as usize] = number;
        }
        Some(numbers)
    }

    /// The part that each node belongs to when every circle is one, whether it lies on a circle, and the number of parts.
    fn contract(&self, before: impl Fn(usize) -> usize) -> (Vec<usize>, Vec<bool>, usize) {
        const NEW: usize = usize::MAX;
        let (mut part, mut in_circle, mut parts) = (vec![NEW; self.nodes], vec![false; self.nodes], 0);
        let mut seen = vec![NEW; self.nodes];
        for start in 0..self.nodes {
            let mut node = start;
            while node != self.root && seen[node] == NEW {
                seen[node] = start;
                node = before(node);
            }
            if node != self.root && seen[node] == start && part[node] == NEW {
                let first = node;
                while part[node] == NEW {
                    (part[node], in_circle[node]) = (parts, true);
                    node = before(node);
                }
                debug_assert_eq!(node, first);
                parts += 1;
            }
        }
        for part in part.iter_mut().filter(|part| **part == NEW) {
            *part = parts;
            parts += 1;
        }
        (part, in_circle, parts)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The price of a cheapest arborescence, by trying every choice of arcs.
    fn by_trial(nodes: usize, arcs: &[Arc], chosen: &mut Vec<Arc>) -> Option<i64> {
        let head = chosen.len();
        if head == nodes - 1 {
            let reaches = |mut node: usize| {
                (0..nodes).any(|_| {
                    node = if node == nodes - 1 { node } else { chosen[node].tail as usize };
                    node == nodes - 1
                })
            };
            return (0..nodes).all(reaches).then(|| chosen.iter().map(|arc| arc.price).sum());
        }
        let entering = arcs.iter().filter(|arc| arc.head as usize == head);
        let tried = entering.filter_map(|&arc| {
            chosen.push(arc);
            let price = by_trial(nodes, arcs, chosen);
            chosen.pop();
            price
        });
        tried.min()
    }

    proptest! {
        #[test]
        fn no_arborescence_is_cheaper(
            nodes in 2..7usize,
            arcs in prop::collection::vec((-20..20i64, 0..7u32, 0..7u32), 0..16),
        ) {
            let arc = |&(price, tail, head): &(i64, u32, u32)| {
                Arc { price, tail: tail % nodes as u32, head: head % nodes as u32 }
            };
            let arcs: Vec<Arc> = arcs.iter().map(arc).filter(|arc| arc.tail != arc.head).collect();
            let found = cheapest(nodes, &arcs);
            if let Some(found) = &found {
                let enters = (0..).zip(found).all(|(node, &arc)| arcs[arc as usize].head == node);
                prop_assert!(enters);
            }
            let price = found.map(|found| found.iter().map(|&arc| arcs[arc as usize].price).sum());
            prop_assert_eq!(price, by_trial(nodes, &arcs, &mut Vec::new()));
        }
    }
}
