//! How far walls hang over what they rest on, and how they are printed there.

use super::bead::{Vertex, length_mm};
use geometry::{Bounds, EdgeGrid, Point, Region, distance_mm, to_segment_mm};

/// Walls are looked at in steps of this.
const STEP_MM: f64 = 0.5;

/// A grade holds at least so long where what is beside it hangs further.
const SHORTEST_MM: f64 = 1.0;

/// Edges longer than this are looked at in parts, so that what is near them stays little.
const PART_MM: f64 = 2.0;

/// Distances that differ by less may be the same, in millimetres.
const NOISE_MM: f64 = 1e-9;

/// A bead whose centre line is so far inside of the layer below, in its widths, is held; how much farther makes no difference.
const HELD: f64 = 0.25;

/// One that is so far outside lies in the air.
const AIR: f64 = 0.5;

/// How much of a bead's width has nothing under it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Grade {
    /// At most a quarter.
    Held,
    /// Up to a half.
    Quarter,
    /// Up to three quarters.
    Half,
    /// More than that.
    ThreeQuarters,
    /// All of it.
    Air,
}

impl Grade {
    /// The grade of a bead whose centre line is so far (in its widths) outside of the layer below.
    fn of(outside: f64) -> Self {
        match outside {
            d if d <= -HELD => Self::Held,
            d if d <= 0.0 => Self::Quarter,
            d if d <= 0.25 => Self::Half,
            d if d < AIR => Self::ThreeQuarters,
            _ => Self::Air,
        }
    }
}

/// Part of a bead with one grade: vertices, each stretch beginning where the one before ends.
pub(super) type Stretch = (Grade, Vec<Vertex>);

/// The layer below, as support.
#[derive(Debug)]
pub(super) struct Support {
    outline: EdgeGrid,
}

impl Support {
    pub(super) fn new(beneath: &Region) -> Self {
        Self { outline: EdgeGrid::new(beneath) }
    }

    /// Cuts a bead of this width where its grade changes; empty if all of it is supported. Short stretches take the
    /// grade of what hangs further beside them. O(vertices) for outlines of like detail.
    pub(super) fn stretches(&self, vertices: &[Vertex], width_mm: f64) -> Vec<Stretch> {
        let mut walk = Walk { support: self, width_mm, inside: None, near: Vec::new(), out: Vec::new() };
        for pair in vertices.windows(2) {
            let parts = (distance_mm(pair[0].at, pair[1].at) / PART_MM).ceil().max(1.0);
            let mut from = pair[0];
            for part in 1..=parts as u32 {
                let to = pair[0].towards(pair[1], f64::from(part) / parts);
                walk.edge(from, to);
                from = to;
            }
        }
        if walk.out.iter().all(|(grade, _)| *grade == Grade::Held) {
            return Vec::new();
        }
        smoothed(walk.out)
    }
}

/// Short stretches take the higher grade of their neighbours, and neighbours of one grade are joined.
fn smoothed(stretches: Vec<Stretch>) -> Vec<Stretch> {
    let grades: Vec<Grade> = stretches.iter().map(|stretch| stretch.0).collect();
    let mut out: Vec<Stretch> = Vec::with_capacity(stretches.len());
    for (i, (own, vertices)) in stretches.into_iter().enumerate() {
        let length_mm = length_mm(&vertices);
        let beside = &grades[i.saturating_sub(1)..(i + 2).min(grades.len())];
        let grade = match beside.iter().max() {
            Some(&most) if length_mm < SHORTEST_MM => most,
            _ => own,
        };
        match out.last_mut() {
            Some((last, joined)) if *last == grade => joined.extend(&vertices[1..]),
            _ => out.push((grade, vertices)),
        }
    }
    out
}

/// The state along one bead.
struct Walk<'a> {
    support: &'a Support,
    width_mm: f64,
    /// Whether the present vertex is over the support, if that is known.
    inside: Option<bool>,
    /// Ends of the outline's edges that are near.
    near: Vec<[[f64; 2]; 2]>,
    out: Vec<Stretch>,
}

impl Walk<'_> {
    fn edge(&mut self, from: Vertex, to: Vertex) {
        let mut away = self.look_around([from, to], HELD);
        let inside = match self.inside {
            Some(inside) if away > 0.0 => inside,
            _ => self.support.outline.contains(Point::from_mm(from.at[0], from.at[1])),
        };
        if !(inside && away > 0.0) {
            away = self.look_around([from, to], AIR);
        }
        self.inside = (away > 0.0).then_some(inside);
        if away >= AIR || (inside && away >= HELD) {
            return self.push(Grade::of(if inside { -away } else { away }), from, to);
        }
        let steps = (distance_mm(from.at, to.at) / STEP_MM).ceil().max(1.0);
        let mut start = from;
        for step in 1..=steps as u32 {
            let end = from.towards(to, f64::from(step) / steps);
            let middle = start.towards(end, 0.5).at;
            let inside = match self.inside {
                Some(inside) => inside,
                None => self.support.outline.contains(Point::from_mm(middle[0], middle[1])),
            };
            let away = self.away([middle, middle]) / self.width_mm;
            self.push(Grade::of(if inside { -away } else { away }), start, end);
            start = end;
        }
    }

    /// Distance of an edge from those of the outline, in widths; any that is no less where none is nearer than a reach.
    fn look_around(&mut self, edge: [Vertex; 2], reach: f64) -> f64 {
        let [a, b] = edge.map(|v| Point::from_mm(v.at[0], v.at[1]));
        let bounds = Bounds::spanned(a, b).grown(geometry::to_units(reach * self.width_mm) + 1);
        self.near.clear();
        let edges = self.support.outline.edges_touching(bounds);
        edges.for_each(|edge| self.near.push([edge.a.mm(), edge.b.mm()]));
        self.away(edge.map(|v| v.at)) / self.width_mm
    }

    /// Distance of a segment from the edges near it; 0 where they meet.
    fn away(&self, segment: [[f64; 2]; 2]) -> f64 {
        let mut nearest = f64::INFINITY;
        for &edge in &self.near {
            // Most are farther off than another is, which their boxes show.
            if boxes_mm(segment, edge) <= nearest + NOISE_MM {
                nearest = segments_mm(segment, edge).min(nearest);
            }
        }
        nearest
    }

    fn push(&mut self, grade: Grade, from: Vertex, to: Vertex) {
        match self.out.last_mut() {
            Some((last, vertices)) if *last == grade => vertices.push(to),
            _ => self.out.push((grade, vec![from, to])),
        }
    }
}

/// How far apart the boxes of two segments are along an axis, at most; negative where they overlap.
fn boxes_mm(s: [[f64; 2]; 2], e: [[f64; 2]; 2]) -> f64 {
    let apart = |axis: usize| {
        let [[a, b], [c, d]] = [s, e].map(|ends| ends.map(|p| p[axis]));
        (a.min(b) - c.max(d)).max(c.min(d) - a.max(b))
    };
    apart(0).max(apart(1))
}

/// Distance of two segments.
fn segments_mm(s: [[f64; 2]; 2], e: [[f64; 2]; 2]) -> f64 {
    let side =
        |[a, b]: [[f64; 2]; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let apart = |s, e: [[f64; 2]; 2]| side(s, e[0]) * side(s, e[1]) > 0.0;
    let ends = [
        to_segment_mm(s[0], e[0], e[1]),
        to_segment_mm(s[1], e[0], e[1]),
        to_segment_mm(e[0], s[0], s[1]),
        to_segment_mm(e[1], s[0], s[1]),
    ];
    let nearest = ends.into_iter().fold(f64::INFINITY, f64::min);
    if s[0] != s[1] && !apart(s, e) && !apart(e, s) && side(s, e[0]) != side(s, e[1]) { 0.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Polygon;

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Region {
        let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    fn line(points: &[[f64; 2]]) -> Vec<Vertex> {
        points.iter().map(|&at| Vertex { at, area_mm2: 0.08 }).collect()
    }

    #[test]
    fn a_wall_is_graded_by_how_far_it_hangs() {
        let support = Support::new(&rectangle(0.0, 0.0, 20.0, 20.0));
        let grade = |outside_mm: f64| {
            let x = 20.0 + outside_mm;
            let stretches = support.stretches(&line(&[[x, 2.0], [x, 18.0]]), 0.4);
            assert!(stretches.len() <= 1, "{outside_mm}: {stretches:?}");
            stretches.first().map_or(Grade::Held, |stretch| stretch.0)
        };
        let grades = [-5.0, -0.2, -0.11, -0.05, 0.05, 0.15, 0.25, 5.0].map(grade);
        let wanted = {
            use Grade::*;
            [Held, Held, Held, Quarter, Half, ThreeQuarters, Air, Air]
        };
        assert_eq!(grades, wanted);
    }

    #[test]
    fn a_wall_over_a_gap_is_cut_where_the_air_begins() {
        let mut two = rectangle(0.0, 0.0, 10.0, 10.0);
        two.add_disjoint(rectangle(20.0, 0.0, 30.0, 10.0).into_polygons());
        let stretches = Support::new(&two).stretches(&line(&[[1.0, 5.0], [29.0, 5.0]]), 0.4);
        let grades: Vec<Grade> = stretches.iter().map(|s| s.0).collect();
        assert_eq!(grades, [Grade::Held, Grade::Air, Grade::Held]);
        let (air, length_mm) = (&stretches[1].1, distance_mm([1.0, 5.0], [29.0, 5.0]));
        assert!((air[0].at[0] - 10.0).abs() < 0.6 && (air.last().unwrap().at[0] - 20.0).abs() < 0.6);
        let sum: f64 = stretches.iter().map(|s| super::length_mm(&s.1)).sum();
        assert!((sum - length_mm).abs() < 1e-9, "nothing is lost: {sum}");
    }
}
