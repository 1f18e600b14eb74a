//! Orders in which no path is drawn backwards.

use super::block::Block;
use super::problem::{Ordering, Pick};
use super::writer::ends;
use crate::order::Scope;
use geometry::distance_mm;

/// How many paths are moved at once.
const LONGEST_MOVE: usize = 3;
/// How far in the order paths are moved at most.
const FARTHEST_MOVE: usize = 400;
/// How often the order is gone through.
const ROUNDS: usize = 20;

/// An order with every open path forwards: the given one or, run by run, the one that always continues to the nearest
/// start, whichever is shorter; then up to three consecutive paths at a time are moved to where they lengthen the travel
/// least (Or-opt: Or 1976, as in Babin, Deneault & Laporte 2007, doi:10.1057/palgrave.jors.2602196), as long as that
/// helps. Runs keep their order.
pub fn forwards(block: &Block, ordering: &Ordering, scope: Scope, picks: &[Pick]) -> Vec<Pick> {
    let mut picks: Vec<Pick> = picks.iter().map(|pick| Pick { reversed: false, ..*pick }).collect();
    let runs = ordering.runs(scope);
    let ends_mm = |pick: &Pick| {
        let (from, to) = ends(block, pick);
        [block.mm(from), block.mm(to)]
    };
    let (mut start, mut at) = (0, None);
    while start < picks.len() {
        let run = runs[picks[start].path];
        let len = picks[start..].iter().take_while(|pick| runs[pick.path] == run).count();
        let part = &mut picks[start..start + len];
        let ends: Vec<[[f64; 2]; 2]> = part.iter().map(ends_mm).collect();
        let stays = run.0 > 0;
        let order = if stays { (0..len).collect() } else { improved(&ends, at) };
        let ordered: Vec<Pick> = order.iter().map(|&i| part[i]).collect();
        part.copy_from_slice(&ordered);
        at = order.last().map(|&i| ends[i][1]);
        start += len;
    }
    picks
}

/// The better of the order as given and of going to the nearest, improved. `at`: where the nozzle comes from.
fn improved(ends: &[[[f64; 2]; 2]], at: Option<[f64; 2]>) -> Vec<usize> {
    let given: Vec<usize> = (0..ends.len()).collect();
    let length = |order: &[usize]| {
        let first = at.map_or(0.0, |at| distance_mm(at, ends[order[0]][0]));
        first + order.windows(2).map(|w| distance_mm(ends[w[0]][1], ends[w[1]][0])).sum::<f64>()
    };
    let nearest = nearest(ends, at);
    let mut order = if length(&nearest) < length(&given) { nearest } else { given };
    for _ in 0..ROUNDS {
        if !moves(&mut order, ends, at) {
            break;
        }
    }
    order
}

/// Always on to the nearest start. O(n²).
fn nearest(ends: &[[[f64; 2]; 2]], at: Option<[f64; 2]>) -> Vec<usize> {
    let mut left: Vec<usize> = (0..ends.len()).collect();
    let mut order = Vec::with_capacity(ends.len());
    let mut at = at.unwrap_or(ends[0][0]);
    while !left.is_empty() {
        let key = |&k: &usize| distance_mm(at, ends[left[k]][0]);
        let next = (0..left.len()).min_by(|a, b| key(a).total_cmp(&key(b)).then(left[*a].cmp(&left[*b])));
        let index = left.swap_remove(next.unwrap_or(0));
        at = ends[index][1];
        order.push(index);
    }
    order
}

/// Moves paths to better places, once through the order; whether any was moved.
fn moves(order: &mut Vec<usize>, ends: &[[[f64; 2]; 2]], at: Option<[f64; 2]>) -> bool {
    let mut moved = false;
    for len in 1..=LONGEST_MOVE.min(order.len()) {
        for from in 0..=order.len() - len {
            let before = from.checked_sub(1).map(|i| ends[order[i]][1]).or(at);
            let after = order.get(from + len).map(|&j| ends[j][0]);
            let link =
                |a: Option<[f64; 2]>, b: Option<[f64; 2]>| a.zip(b).map_or(0.0, |(a, b)| distance_mm(a, b));
            let (head, tail) = (ends[order[from]][0], ends[order[from + len - 1]][1]);
            let gain = link(before, Some(head)) + link(Some(tail), after) - link(before, after);
            let positions =
                from.saturating_sub(FARTHEST_MOVE)..(from + len + FARTHEST_MOVE).min(order.len()) + 1;
            // Position p is before the path that is p-th now.
            let best = positions.filter(|p| *p < from || *p > from + len).map(|position| {
                let left = position.checked_sub(1).map(|i| ends[order[i]][1]).or(at);
                let right = order.get(position).map(|&j| ends[j][0]);
                (link(left, Some(head)) + link(Some(tail), right) - link(left, right), position)
            });
            let best = best.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((cost, position)) = best
                && cost < gain - 1e-9
            {
                let part: Vec<usize> = order.drain(from..from + len).collect();
                let position = if position > from { position - len } else { position };
                order.splice(position..position, part);
                moved = true;
            }
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_fixed_direction_are_drawn_from_left_to_right_in_the_order_of_their_starts() {
        // Ten lines end to end, given shuffled.
        let ends: Vec<[[f64; 2]; 2]> =
            [7, 2, 9, 0, 4, 1, 8, 3, 6, 5].map(|i| [[f64::from(i), 0.0], [f64::from(i) + 1.0, 0.0]]).to_vec();
        let order = improved(&ends, Some([0.0, 0.0]));
        let starts: Vec<f64> = order.iter().map(|&i| ends[i][0][0]).collect();
        assert_eq!(starts, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    }
}
