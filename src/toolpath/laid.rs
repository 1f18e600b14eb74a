//! Parts of bridge lines that lie on the layer beneath, beside the air that the others span: there is no room under them for
//! what is thicker than the layer.

use geometry::Point;

use super::bead::Line;
use super::beneath::Beneath;

/// Distance between the points looked at.
const STEP_MM: f64 = 0.4;

/// A line is not divided for less than this: what is too much in short pieces fills the corners between them.
const LEAST_MM: f64 = 5.0;

/// A bead lies where its middle does, and both sides at this share of its spacing from there.
const SIDE: f64 = 0.45;

/// Lines, taken apart.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// Over air, with an anchor at each end.
    pub hanging: Vec<Line>,
    /// On the layer beneath.
    pub laid: Vec<Line>,
}

/// Divides lines where they lie on the layer beneath for longer than they are anchored there.
pub(super) fn split(lines: Vec<Line>, spacing_mm: f64, anchor_mm: f64, beneath: &Beneath<'_>) -> Parts {
    let mut parts = Parts::default();
    for line in lines {
        let way = Way::new(line);
        let laid = way.laid(SIDE * spacing_mm, anchor_mm, beneath);
        way.divide(&laid, &mut parts);
    }
    parts
}

/// A line with the length up to each of its vertices.
struct Way {
    line: Line,
    along_mm: Vec<f64>,
}

impl Way {
    fn new(mut line: Line) -> Self {
        if line.closed {
            line.points.extend(line.points.first().copied());
            line.spacing_mm.extend(line.spacing_mm.first().copied());
        }
        let mut along_mm = vec![0.0];
        for ends in line.points.windows(2) {
            along_mm.push(along_mm[along_mm.len() - 1] + ends[0].distance_mm(ends[1]));
        }
        Self { line, along_mm }
    }

    fn length_mm(&self) -> f64 {
        self.along_mm.last().copied().unwrap_or_default()
    }

    /// The edge at a length, and the share of it up to there.
    fn edge_at(&self, mm: f64) -> (usize, f64) {
        let next = self.along_mm.partition_point(|&along| along < mm).clamp(1, self.along_mm.len() - 1);
        let [from, to] = [self.along_mm[next - 1], self.along_mm[next]];
        (next - 1, if to > from { ((mm - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 })
    }

    fn at(&self, mm: f64) -> (Point, Option<f32>) {
        let (edge, share) = self.edge_at(mm);
        let [[ax, ay], [bx, by]] = [edge, edge + 1].map(|i| self.line.points[i].mm());
        let point = Point::from_mm(ax + share * (bx - ax), ay + share * (by - ay));
        let spacing_mm = match self.line.spacing_mm.get(edge..edge + 2) {
            Some(&[a, b]) => Some(a + share as f32 * (b - a)),
            _ => None,
        };
        (point, spacing_mm)
    }

    /// Whether the bead lies on the layer beneath at a length.
    fn lies(&self, mm: f64, side_mm: f64, beneath: &Beneath<'_>) -> bool {
        let (point, _) = self.at(mm);
        if !beneath.holds(point) {
            return false;
        }
        let (edge, _) = self.edge_at(mm);
        let [a, b] = [self.line.points[edge], self.line.points[edge + 1]];
        let ([dx, dy], length_mm) = ((b - a).mm(), a.distance_mm(b).max(f64::MIN_POSITIVE));
        let aside = Point::from_mm(-dy / length_mm * side_mm, dx / length_mm * side_mm);
        beneath.holds(point + aside) && beneath.holds(point - aside)
    }

    /// Stretches that lie on the layer beneath, without the anchors of what hangs beside them.
    fn laid(&self, side_mm: f64, anchor_mm: f64, beneath: &Beneath<'_>) -> Vec<[f64; 2]> {
        let length_mm = self.length_mm();
        let count = (length_mm / STEP_MM).ceil().max(1.0) as usize;
        let step_mm = length_mm / count as f64;
        let lies: Vec<bool> =
            (0..count).map(|i| self.lies((i as f64 + 0.5) * step_mm, side_mm, beneath)).collect();
        let mut stretches = Vec::new();
        let mut first = 0;
        for run in lies.chunk_by(|a, b| a == b) {
            let last = first + run.len();
            if run[0] {
                let from_mm = first as f64 * step_mm + if first > 0 { anchor_mm } else { 0.0 };
                let to_mm = last as f64 * step_mm - if last < count { anchor_mm } else { 0.0 };
                if to_mm - from_mm >= LEAST_MM {
                    stretches.push([from_mm, to_mm]);
                }
            }
            first = last;
        }
        stretches
    }

    /// Adds the stretches, and what is between them.
    fn divide(self, laid: &[[f64; 2]], parts: &mut Parts) {
        let length_mm = self.length_mm();
        match laid {
            [] => parts.hanging.push(self.whole()),
            [[from_mm, to_mm]] if *from_mm <= 0.0 && *to_mm >= length_mm => parts.laid.push(self.whole()),
            _ => {
                let mut rest_mm = 0.0;
                for &[from_mm, to_mm] in laid {
                    parts.hanging.extend(self.stretch(rest_mm, from_mm));
                    parts.laid.extend(self.stretch(from_mm, to_mm));
                    rest_mm = to_mm;
                }
                parts.hanging.extend(self.stretch(rest_mm, length_mm));
            }
        }
    }

    fn whole(self) -> Line {
        let mut line = self.line;
        if line.closed {
            line.points.pop();
            line.spacing_mm.pop();
        }
        line
    }

    fn stretch(&self, from_mm: f64, to_mm: f64) -> Option<Line> {
        if to_mm <= from_mm {
            return None;
        }
        let inner =
            (0..self.along_mm.len()).filter(|&i| from_mm < self.along_mm[i] && self.along_mm[i] < to_mm);
        let inner = inner.map(|i| (self.line.points[i], self.line.spacing_mm.get(i).copied()));
        let all = std::iter::once(self.at(from_mm)).chain(inner).chain([self.at(to_mm)]);
        let (mut points, mut spacing_mm) = (Vec::new(), Vec::new());
        for (point, spacing) in all {
            if points.last() != Some(&point) {
                points.push(point);
                spacing_mm.extend(spacing);
            }
        }
        Line { points, spacing_mm, closed: false }.sound()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Polygon, Region};

    /// Air between x = 10 and 20 mm.
    fn banks() -> Region {
        let bank = |from: f64, to: f64| {
            let corners = [[from, 0.0], [to, 0.0], [to, 20.0], [from, 20.0]];
            let outer = corners.iter().map(|&[x, y]| Point::from_mm(x, y)).collect();
            Region::from(Polygon { outer, holes: Vec::new() })
        };
        geometry::union(&bank(0.0, 10.0), &bank(20.0, 30.0))
    }

    fn line(points: &[[f64; 2]], closed: bool) -> Line {
        Line::nominal(points.iter().map(|&[x, y]| Point::from_mm(x, y)).collect(), closed)
    }

    fn lengths_mm(lines: &[Line]) -> Vec<f64> {
        let mm = |line: &Line| (geometry::polyline_length_mm(&line.points) * 10.0).round() / 10.0;
        lines.iter().map(mm).collect()
    }

    #[test]
    fn lines_are_thick_over_air_and_at_their_anchors_alone() {
        let region = banks();
        let beneath = Beneath::new(&region);
        let along_bank = line(&[[9.5, 1.0], [9.5, 19.0]], false);
        let half_on_it = line(&[[10.1, 1.0], [10.1, 19.0]], false);
        let across = line(&[[9.0, 5.0], [21.0, 5.0]], false);
        let into_the_bank = line(&[[2.0, 7.0], [21.0, 7.0]], false);
        let parts = split(vec![along_bank, half_on_it, across, into_the_bank], 0.4, 1.0, &beneath);
        let [laid, hanging] = [&parts.laid, &parts.hanging].map(|lines| lengths_mm(lines));
        let [along, cut] = laid[..] else { panic!("{laid:?}") };
        let [half, over, rest] = hanging[..] else { panic!("{hanging:?}") };
        assert_eq!((along, half, over), (18.0, 18.0, 12.0));
        assert!((cut - 7.0).abs() < 0.5 && (cut + rest - 19.0).abs() < 0.11, "{cut} and {rest}");
    }

    #[test]
    fn a_loop_is_divided_and_stays_whole_where_nothing_divides_it() {
        let region = banks();
        let beneath = Beneath::new(&region);
        let around = |x: f64| line(&[[9.0, 5.0], [x, 5.0], [x, 15.0], [9.0, 15.0]], true);
        let parts = split(vec![around(15.0), around(2.0)], 0.4, 1.0, &beneath);
        assert!(parts.laid.len() == 2 && parts.laid[1].closed && !parts.laid[0].closed, "{parts:?}");
        let [laid_mm, hanging_mm] =
            [&parts.laid[..1], &parts.hanging].map(|p| lengths_mm(p).iter().sum::<f64>());
        assert!((laid_mm - 10.0).abs() < 1.0 && (laid_mm + hanging_mm - 32.0).abs() < 0.3, "{parts:?}");
    }
}
