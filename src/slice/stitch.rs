//! Closing outlines of open meshes.

use super::Gaps;
use geometry::{Point, Ring, to_units};

/// Gaps are closed in this order of width, in millimetres: rounding at T-junctions, hairline cracks, small holes. A
/// ladder keeps the search for pairs short where thousands of ends meet.
const LADDER_MM: [f64; 3] = [0.01, 0.2, 2.0];

/// Joins loose ends, nearest first within each step of the ladder, then closes what is still open. Adds the rings.
///
/// In an oriented mesh the end of a chain joins the beginning of one; else any end joins any. O(n log n) for ends that
/// are few within reach of each other.
pub(super) fn stitch(chains: Vec<Vec<Point>>, oriented: bool, rings: &mut Vec<Ring>) -> Gaps {
    let mut gaps = Gaps::default();
    if chains.is_empty() {
        return gaps;
    }
    // End `2 c` is the beginning of chain `c`, end `2 c + 1` its end.
    let at = |end: usize| {
        let chain = &chains[end / 2];
        if end.is_multiple_of(2) { chain[0] } else { chain[chain.len() - 1] }
    };
    let mut partner: Vec<Option<usize>> = vec![None; 2 * chains.len()];
    for width_mm in LADDER_MM {
        let mut loose: Vec<usize> = (0..partner.len()).filter(|&e| partner[e].is_none()).collect();
        loose.sort_by_key(|&e| (at(e).x, e));
        for (a, b) in pairs(&loose, &at, to_units(width_mm), oriented) {
            if partner[a].is_none() && partner[b].is_none() {
                (partner[a], partner[b]) = (Some(b), Some(a));
                gaps.joined += usize::from(at(a) != at(b));
            }
        }
    }
    let mut used = vec![false; chains.len()];
    // From loose ends first, so that each chain is walked from its beginning.
    let starts = (0..partner.len()).filter(|&e| partner[e].is_none()).chain(0..partner.len());
    for start in starts.collect::<Vec<_>>() {
        if used[start / 2] {
            continue;
        }
        gaps.forced += usize::from(partner[start].is_none());
        let reversed_start = oriented && start % 2 == 1;
        let mut ring = Vec::new();
        let mut enter = Some(start);
        while let Some(end) = enter.filter(|&end| !used[end / 2]) {
            used[end / 2] = true;
            if end.is_multiple_of(2) {
                ring.extend_from_slice(&chains[end / 2]);
            } else {
                ring.extend(chains[end / 2].iter().rev());
            }
            enter = partner[end ^ 1];
        }
        if reversed_start {
            ring.reverse();
        }
        ring.dedup();
        rings.push(ring);
    }
    gaps
}

/// Pairs of loose ends within reach, nearest first, ties by number.
fn pairs(
    sorted_by_x: &[usize],
    at: &impl Fn(usize) -> Point,
    reach: i32,
    oriented: bool,
) -> Vec<(usize, usize)> {
    let reach2 = i64::from(reach) * i64::from(reach);
    let mut found = Vec::new();
    for (i, &a) in sorted_by_x.iter().enumerate() {
        for &b in &sorted_by_x[i + 1..] {
            if at(b).x - at(a).x > reach {
                break;
            }
            let distance2 = at(a).distance2(at(b));
            if distance2 <= reach2 && (!oriented || a % 2 != b % 2) {
                found.push((distance2, a.min(b), a.max(b)));
            }
        }
    }
    found.sort_unstable();
    found.into_iter().map(|(_, a, b)| (a, b)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::ring_area;

    fn chain(points: &[(f64, f64)]) -> Vec<Point> {
        points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
    }

    #[test]
    fn chains_join_at_their_nearest_ends() {
        let chains = vec![
            chain(&[(0.0, 0.0), (10.0, 0.0), (10.0, 4.9)]),
            chain(&[(10.0, 5.0), (0.0, 5.0), (0.0, 0.3)]),
        ];
        let mut rings = Vec::new();
        assert_eq!(stitch(chains, true, &mut rings), Gaps { joined: 2, forced: 0 });
        assert!(rings.len() == 1 && ring_area(&rings[0]) > 48.0);
    }

    #[test]
    fn a_wide_gap_is_closed_and_told() {
        let mut rings = Vec::new();
        let gaps = stitch(vec![chain(&[(0.0, 0.0), (10.0, 0.0), (10.0, 5.0)])], true, &mut rings);
        assert_eq!((gaps, rings.len()), (Gaps { joined: 0, forced: 1 }, 1));
    }

    #[test]
    fn direction_counts_only_where_the_mesh_has_one() {
        let chains =
            vec![chain(&[(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)]), chain(&[(0.0, 0.0), (0.0, 5.0), (5.0, 5.0)])];
        let mut rings = Vec::new();
        assert_eq!(stitch(chains.clone(), false, &mut rings), Gaps::default());
        assert_eq!((rings.len(), ring_area(&rings[0]).abs()), (1, 25.0));
        rings.clear();
        assert_eq!(stitch(chains, true, &mut rings).forced, 2);
    }
}
