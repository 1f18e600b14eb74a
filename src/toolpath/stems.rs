//! Single beads over air that end where a loop of their wall turns, as where a thin wall above a gap becomes thicker: the loop
//! goes on from there. Each alone would end over nothing.

use geometry::Point;

use super::Path;
use super::beneath::{Beneath, LooseEnd};
use super::path::Width;

/// Loops turn at most this far from the end, in its widths.
const NEAR: f64 = 1.0;

/// Puts beads with loose ends and the loops at these ends into one path each: from the bead's other end around the loop, back
/// to where the two meet.
pub(super) fn join(paths: &mut Vec<Path>, loose: &[LooseEnd], beneath: &Beneath<'_>) {
    let mut is_joined = vec![false; paths.len()];
    for end in loose {
        if is_joined[end.path] {
            continue;
        }
        let Some(Turning { path, edge, at }) = turning(paths, &is_joined, end, beneath) else { continue };
        let turn = paths[path].clone();
        let of_turn = per_vertex(&turn);
        let stem = &mut paths[end.path];
        let mut widths = per_vertex(stem);
        if end.is_start {
            stem.points.reverse();
            widths.reverse();
        }
        let count = turn.points.len();
        let [before, after] = [edge, (edge + 1) % count];
        let between = (of_turn[before] + of_turn[after]) / 2.0;
        let around = (after..after + count).map(|i| i % count);
        let mut turned = vec![(at, between)];
        turned.extend(around.map(|i| (turn.points[i], of_turn[i])));
        turned.push((at, between));
        turned.dedup_by_key(|(p, _)| *p);
        stem.points.extend(turned.iter().map(|(p, _)| *p));
        widths.extend(turned.iter().map(|(_, width)| *width));
        stem.width = Width::PerVertex(widths);
        // Neither is looked at again.
        (is_joined[path], is_joined[end.path]) = (true, true);
    }
    let mut is_joined = is_joined.into_iter();
    paths.retain(|path| !is_joined.next().unwrap_or_default() || !path.closed);
}

/// Where a loop turns.
struct Turning {
    path: usize,
    /// Between this vertex and the next,
    edge: usize,
    /// here.
    at: Point,
}

/// The loop, held elsewhere, that turns over air beside an end.
fn turning(paths: &[Path], is_joined: &[bool], end: &LooseEnd, beneath: &Beneath<'_>) -> Option<Turning> {
    let stem = &paths[end.path];
    let tip = *if end.is_start { stem.points.first() } else { stem.points.last() }?;
    let near_mm = NEAR * stem.width.widest_mm();
    let kind = |path: &Path| (path.role, path.phase, path.tool);
    let is_alike = |path: &Path| path.closed && kind(path) == kind(stem);
    let is_held = |path: &Path| path.points.iter().any(|&p| beneath.holds(p));
    let loops = paths.iter().enumerate();
    let loops = loops.filter(|&(index, path)| is_alike(path) && !is_joined[index] && is_held(path));
    let edges = loops.flat_map(|(index, path)| {
        let ends = path.points.iter().zip(path.points.iter().cycle().skip(1));
        ends.enumerate().map(move |(edge, (a, b))| {
            let [x, y] = geometry::on_segment_mm(tip.mm(), a.mm(), b.mm());
            Turning { path: index, edge, at: Point::from_mm(x, y) }
        })
    });
    edges
        .filter(|turning| turning.at.distance_mm(tip) <= near_mm && !beneath.holds(turning.at))
        .min_by(|a, b| a.at.distance_mm(tip).total_cmp(&b.at.distance_mm(tip)))
}

/// The width of a path at each of its vertices.
fn per_vertex(path: &Path) -> Vec<f32> {
    (0..path.points.len()).map(|vertex| path.width.at_mm(vertex) as f32).collect()
}
