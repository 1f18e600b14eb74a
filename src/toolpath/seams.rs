//! Loops that pass what is painted for seams: where they may be entered.

use geometry::{Bounds, EdgeGrid, Point, Region, UNITS_PER_MM};
use ordering::matching::KdTree;

use super::spiral::closest;
use super::{Entries, LayerPaths, Path, Width};
use crate::mesh::Wish;
use crate::slice::PaintedLine;

/// Loops and painted lines are looked at so often, mm.
const STEP_MM: f64 = 0.1;

/// Seams keep so far from the ends of what is painted, where it is long enough, mm.
const MARGIN_MM: f64 = 0.2;

/// Loops may be entered so often where they should be, mm.
const SPACING_MM: f64 = 1.0;

/// Loops are no farther inside the outline than this, mm.
const REACH_MM: f64 = 5.0;

/// An outline differs from the mesh by less than this, mm.
const TOLERANCE_MM: f64 = 0.1;

/// A place on a loop.
struct Sample {
    edge: usize,
    /// Share of the edge.
    at: f64,
    point: Point,
    wish: Option<Wish>,
}

/// Says of each wall that passes painted lines where it may be entered, and adds vertices there: where an enforced line is nearest
/// on the outline; of a loop without one, where no blocked line is. The outline may be moved by `moved_mm` against the lines.
pub fn mark(layer: &mut LayerPaths, lines: &[PaintedLine<Wish>], moved_mm: f64) {
    let painted = Painted::new(lines, &layer.outline, TOLERANCE_MM + moved_mm);
    for (number, path) in (0..).zip(&mut layer.paths) {
        if path.closed
            && path.role.is_wall()
            && let Some(entries) = painted.enter(path)
        {
            layer.entries.insert(number, entries);
        }
    }
}

/// What is painted on an outline.
struct Painted {
    points: Vec<Point>,
    wishes: Vec<Wish>,
    tree: KdTree,
    bounds: Bounds,
    outline: EdgeGrid,
    tolerance_mm: f64,
}

impl Painted {
    fn new(lines: &[PaintedLine<Wish>], outline: &Region, tolerance_mm: f64) -> Self {
        let (mut points, mut wishes) = (Vec::new(), Vec::new());
        for line in lines {
            let [a, b] = line.ends;
            let parts = (a.distance_mm(b) / STEP_MM).ceil().max(1.0);
            points.extend((0..=parts as u32).map(|part| a.towards(b, f64::from(part) / parts)));
            wishes.resize(points.len(), line.paint);
        }
        let tree = KdTree::new(&points);
        let bounds = Bounds::of(points.iter().copied()).unwrap_or_default();
        Self { points, wishes, tree, bounds, outline: EdgeGrid::new(outline), tolerance_mm }
    }

    /// What is painted where the outline is nearest to a place.
    fn at(&self, p: Point) -> Option<Wish> {
        if !self.bounds.grown((REACH_MM * UNITS_PER_MM) as i32).holds(p) {
            return None;
        }
        let (_, nearest) = self.tree.nearest(&self.points, p)?;
        let distance_mm = self.points[nearest as usize].distance_mm(p);
        if distance_mm > REACH_MM {
            return None;
        }
        let around = Bounds::of([p])?.grown(((distance_mm + self.tolerance_mm) * UNITS_PER_MM) as i32);
        let on_outline = self.outline.edges_touching(around).map(|edge| {
            let at = closest(p, edge.a, edge.b);
            (at.distance2(p), at)
        });
        let (_, on_outline) = on_outline.min()?;
        let (_, painted) = self.tree.nearest(&self.points, on_outline)?;
        let is_there = self.points[painted as usize].distance_mm(on_outline) <= self.tolerance_mm;
        is_there.then(|| self.wishes[painted as usize])
    }

    /// Where a loop may be entered; `None`: anywhere.
    fn enter(&self, path: &mut Path) -> Option<Entries> {
        let samples = self.samples(path);
        let enforced = samples.iter().any(|sample| sample.wish == Some(Wish::Enforced));
        let good: Vec<bool> = samples
            .iter()
            .map(|sample| match enforced {
                true => sample.wish == Some(Wish::Enforced),
                false => sample.wish != Some(Wish::Blocked),
            })
            .collect();
        let first_bad = good.iter().position(|good| !good)?;
        let mut chosen = vec![false; samples.len()];
        let turned: Vec<usize> = (0..samples.len()).map(|k| (first_bad + k) % samples.len()).collect();
        for run in turned.chunk_by(|&a, &b| good[a] == good[b]).filter(|run| good[run[0]]) {
            choose(run, &samples, enforced, &mut chosen);
        }
        Some(rebuild(path, &samples, &chosen)).filter(|entries| !entries.points.is_empty())
    }

    fn samples(&self, path: &Path) -> Vec<Sample> {
        let mut samples = Vec::new();
        for (edge, &a) in path.points.iter().enumerate() {
            let b = path.points[(edge + 1) % path.points.len()];
            let parts = (a.distance_mm(b) / STEP_MM).ceil().max(1.0);
            samples.extend((0..parts as u32).map(|part| {
                let at = f64::from(part) / parts;
                let point = a.towards(b, at);
                Sample { edge, at, point, wish: self.at(point) }
            }));
        }
        samples
    }
}

/// Chooses where a run of samples may be entered: in its middle, at its vertices and, if it was painted for that, at regular
/// distances.
fn choose(run: &[usize], samples: &[Sample], painted: bool, chosen: &mut [bool]) {
    let mut along_mm = Vec::with_capacity(run.len());
    let mut length_mm = 0.0;
    for (k, &sample) in run.iter().enumerate() {
        if k > 0 {
            length_mm += samples[run[k - 1]].point.distance_mm(samples[sample].point);
        }
        along_mm.push(length_mm);
    }
    let middle = along_mm.partition_point(|&mm| mm < length_mm / 2.0).min(run.len() - 1);
    chosen[run[middle]] = true;
    let inside = |k: usize| along_mm[k] >= MARGIN_MM && along_mm[k] <= length_mm - MARGIN_MM;
    for k in (0..run.len()).filter(|&k| inside(k) && samples[run[k]].at == 0.0) {
        chosen[run[k]] = true;
    }
    if !painted {
        return;
    }
    for side in [(middle..run.len()).collect::<Vec<_>>(), (0..=middle).rev().collect()] {
        let mut last_mm = along_mm[middle];
        for k in side.into_iter().filter(|&k| inside(k)) {
            if (along_mm[k] - last_mm).abs() >= SPACING_MM {
                chosen[run[k]] = true;
                last_mm = along_mm[k];
            }
        }
    }
}

/// The loop with a vertex at each sample that is chosen.
fn rebuild(path: &mut Path, samples: &[Sample], chosen: &[bool]) -> Entries {
    let mut entries = Entries::default();
    let (mut points, mut widths) = (Vec::with_capacity(path.points.len()), Vec::new());
    let first = path.points[0];
    for (sample, &chosen) in samples.iter().zip(chosen) {
        let is_vertex = sample.at == 0.0;
        let is_new = points.last() != Some(&sample.point) && sample.point != first;
        if is_vertex || (chosen && is_new) {
            points.push(sample.point);
            if let Width::PerVertex(at) = &path.width {
                let (from, to) = (at[sample.edge], at[(sample.edge + 1) % at.len()]);
                widths.push(from + (to - from) * sample.at as f32);
            }
        }
        if chosen && points.last() == Some(&sample.point) {
            entries.vertices.push(points.len() as u32 - 1);
            entries.points.push(sample.point);
        }
    }
    path.points = points;
    if let Width::PerVertex(at) = &mut path.width {
        *at = widths;
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::super::{Island, IslandId, LayerKind, Phase, Role};
    use super::*;

    /// Two walls of a square of 20 mm with lines painted on its lower side, from and to these places.
    fn marked(lines: &[(f64, f64, Wish)]) -> LayerPaths {
        let ring = |inset: f64| {
            let (low, high) = (inset, 20.0 - inset);
            [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| Point::from_mm(x, y)).to_vec()
        };
        let wall = |role, inset: f64| Path {
            role,
            closed: true,
            points: ring(inset),
            width: Width::PerVertex(vec![0.4, 0.5, 0.4, 0.5]),
            height_mm: 0.2,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        };
        let mut layer = LayerPaths {
            index: 3,
            top_mm: 0.8,
            height_mm: 0.2,
            islands: vec![Island { object: 0, repeats: false, meets_others: false }],
            paths: vec![wall(Role::ExternalPerimeter, 0.2), wall(Role::Perimeter, 0.6)],
            outline: geometry::unite_rings(&[ring(0.0)]),
            beneath: None,
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        };
        let line = |&(from, to, paint): &(f64, f64, Wish)| PaintedLine {
            object: 0,
            ends: [Point::from_mm(from, 0.0), Point::from_mm(to, 0.0)],
            paint,
        };
        let lines: Vec<_> = lines.iter().map(line).collect();
        mark(&mut layer, &lines, 0.0);
        layer
    }

    #[test]
    fn walls_are_entered_where_a_line_is_enforced() {
        let layer = marked(&[(6.0, 9.0, Wish::Enforced), (8.0, 14.0, Wish::Blocked)]);
        for number in 0..2 {
            let (path, entries) = (&layer.paths[number as usize], &layer.entries[&number]);
            let points: Vec<Point> = entries.vertices.iter().map(|&v| path.points[v as usize]).collect();
            assert_eq!(points, entries.points);
            assert!(points.len() >= 2);
            for [x, y] in points.iter().map(|p| p.mm()) {
                assert!((6.0..=9.0).contains(&x) && y < 1.0, "{x} {y}");
            }
            let Width::PerVertex(widths) = &path.width else { panic!("widths") };
            assert_eq!(widths.len(), path.points.len());
            let at = entries.vertices[0] as usize;
            assert!((f64::from(widths[at]) - (0.4 + 0.1 * path.points[at].mm()[0] / 20.0)).abs() < 0.01);
        }
    }

    #[test]
    fn walls_are_entered_nowhere_where_it_is_blocked_unless_all_is() {
        let layer = marked(&[(-1.0, 15.0, Wish::Blocked)]);
        for number in 0..2 {
            let blocked = |p: &Point| p.mm()[1] < 1.0 && p.mm()[0] < 15.0;
            assert!(!layer.entries[&number].points.is_empty());
            assert!(!layer.entries[&number].points.iter().any(blocked));
        }
        assert!(marked(&[]).entries.is_empty());
    }
}
