//! Middle lines of a region, of which areas get the parts that are in them.

use super::line::{Line, hits, point};
use super::outline::{Position, distance, lerp};
use crate::{Bounds, Boxes, EdgeGrid};

/// Least length of what is cut out of a line.
const SHORTEST_MM: f64 = 0.2;

/// Lines that go so little into an area only touch it.
const TOUCH_MM: f64 = 0.05;

/// Edges that have a box together.
const EDGES: usize = 16;

/// The middle lines of a polygon.
#[derive(Clone, Debug)]
pub(super) struct WholeLines {
    lines: Vec<WholeLine>,
    boxes: Boxes,
}

impl WholeLines {
    pub(super) fn new(lines: impl Iterator<Item = Line>) -> Self {
        let bounded = lines.filter_map(|line| Some((bounds(&line.at)?, WholeLine::new(line))));
        let (boxes, lines): (Vec<Bounds>, _) = bounded.unzip();
        Self { lines, boxes: Boxes::new(boxes) }
    }

    /// How many points they have.
    pub(super) fn len(&self) -> usize {
        self.lines.iter().map(|whole| whole.along.len()).sum()
    }

    /// The parts in an area, line by line, those shorter than [`SHORTEST_MM`] extended beyond it.
    pub(super) fn parts_in<'a>(&'a self, area: &'a EdgeGrid) -> impl Iterator<Item = Line> + 'a {
        let near = self.boxes.touching(&area.bounds()).into_iter();
        near.flat_map(|line| self.lines[line].parts_in(area))
    }
}

/// A line with an index of its edges; a closed one is opened at its first vertex.
#[derive(Clone, Debug)]
struct WholeLine {
    line: Line,
    is_closed: bool,
    /// Length up to each of the vertices.
    along: Vec<f64>,
    /// Of each [`EDGES`] of the edges.
    boxes: Boxes,
}

impl WholeLine {
    fn new(mut line: Line) -> Self {
        let is_closed = line.closed;
        if is_closed {
            line.open_at(0);
        }
        let steps = line.at.windows(2).map(|w| distance(w[0], w[1]));
        let lengths = steps.scan(0.0, |length, step| {
            *length += step;
            Some(*length)
        });
        let along = std::iter::once(0.0).chain(lengths).collect();
        let last = line.at.len() - 1;
        let firsts = (0..last).step_by(EDGES);
        let boxes = Boxes::new(firsts.filter_map(|first| bounds(&line.at[first..=last.min(first + EDGES)])));
        Self { line, is_closed, along, boxes }
    }

    fn parts_in(&self, area: &EdgeGrid) -> Vec<Line> {
        let is_outside = |at: &Position| !area.contains(point(*at));
        if self.is_closed && !is_outside(&self.line.at[0]) {
            let mut line = self.line.clone();
            line.at.pop();
            line.width.pop();
            let outside = line.at.iter().position(is_outside);
            line.closed = true;
            let Some(outside) = outside else { return vec![line] };
            line.open_at(outside);
            return Self::new(line).parts_in(area);
        }
        let end = self.along[self.along.len() - 1];
        let mut parts = self.stretches_in(area);
        for part in &mut parts {
            let is_cut = [part[0] > 0.0, part[1] < end];
            let missing = (SHORTEST_MM - (part[1] - part[0])).max(0.0);
            let each = if is_cut[0] && is_cut[1] { missing / 2.0 } else { missing };
            part[0] -= if is_cut[0] { each.min(part[0]) } else { 0.0 };
            part[1] += if is_cut[1] { each.min(end - part[1]) } else { 0.0 };
        }
        parts.into_iter().map(|[from, to]| self.stretch(from, to)).collect()
    }

    /// Where the line enters an area and where it leaves it, as lengths; stretches that hardly do are left out.
    fn stretches_in(&self, area: &EdgeGrid) -> Vec<[f64; 2]> {
        let (at, along) = (&self.line.at, &self.along);
        let mut found: Vec<[f64; 2]> = Vec::new();
        let (mut stops, mut inside, mut met, mut before) = (Vec::new(), false, true, 0);
        let near = self.boxes.touching(&area.bounds()).into_iter();
        let edges = near.flat_map(|part| part * EDGES + 1..at.len().min((part + 1) * EDGES + 1));
        for i in edges {
            let (a, b, step) = (at[i - 1], at[i], along[i] - along[i - 1]);
            stops.clear();
            stops.extend([0.0, 1.0].into_iter().chain(hits(area, a, b)));
            stops.sort_unstable_by(f64::total_cmp);
            met |= i != before + 1;
            for stop in stops.windows(2).filter(|stop| stop[0] < stop[1]) {
                // Where the boundary is not met, neither here nor just before, nothing changes.
                if stops.len() > 2 || met {
                    inside = area.contains(point(lerp(a, b, (stop[0] + stop[1]) / 2.0)));
                }
                if !inside {
                    continue;
                }
                let [from, to] = [stop[0], stop[1]].map(|t| along[i - 1] + t * step);
                match found.last_mut().filter(|last| from - last[1] < 1e-6) {
                    Some(last) => last[1] = to,
                    None => found.push([from, to]),
                }
            }
            (met, before) = (stops.len() > 2, i);
        }
        found.retain(|[from, to]| to - from >= TOUCH_MM);
        found
    }

    /// Point and width where the line has a length.
    fn at_length(&self, length: f64) -> (Position, f64) {
        let (line, along) = (&self.line, &self.along);
        let next = along.partition_point(|&l| l < length).clamp(1, along.len() - 1);
        let (from, to) = (along[next - 1], along[next]);
        let t = if to > from { ((length - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        let (a, b) = (line.width[next - 1], line.width[next]);
        (lerp(line.at[next - 1], line.at[next], t), a + t * (b - a))
    }

    /// The line from one length to another.
    fn stretch(&self, from: f64, to: f64) -> Line {
        let ends = [from, to].map(|length| self.at_length(length));
        let first = self.along.partition_point(|&length| length <= from);
        let between = first..self.along.partition_point(|&length| length < to).max(first);
        let inner = between.map(|i| (self.line.at[i], self.line.width[i]));
        let (at, width) = std::iter::once(ends[0]).chain(inner).chain([ends[1]]).unzip();
        Line { at, width, closed: false }
    }
}

/// The box around points; `None` of nothing.
fn bounds(at: &[Position]) -> Option<Bounds> {
    Bounds::of(at.iter().map(|&at| point(at)))
}
