//! How far walls hang over what they rest on, and how they are printed there.

use super::bead::{Vertex, length_mm};
use geometry::real::{greater, lesser};
use geometry::{Bounds, EdgeGrid, Point, Region, distance_mm, to_segment_mm};

/// Walls are looked at in steps of this.
const STEP_MM: f64 = 0.5;

/// A grade holds at least so long where what is beside it hangs further.
const SHORTEST_MM: f64 = 1.0;

/// Edges longer than this are looked at in parts, so that what is near them stays little.
const PART_MM: f64 = 2.0;

/// Edges are looked at together as long as their box is no larger than this.
const TOGETHER_MM: f64 = 3.0;

/// Distances that differ by less may be the same, in millimetres.
const NOISE_MM: f64 = 1e-9;

/// A bead whose centre line is so far inside of the layer below, in its widths, is held; how much farther makes no difference.
pub(super) const HELD: f64 = 0.25;

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
    /// The grade of a bead whose centre line is so far (in its widths) outside of the layer below, where one that is `held`
    /// inside is.
    fn of(outside: f64, held: f64) -> Self {
        match outside {
            d if d <= -held => Self::Held,
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

    /// Cuts a bead of this width where its grade changes; empty if all of it is held: so many of its widths inside of the layer
    /// below, [`HELD`], or 0 where a quarter makes no difference. Short stretches take the grade of what hangs further beside
    /// them. O(vertices) for outlines of like detail.
    pub(super) fn stretches(&self, vertices: &[Vertex], width_mm: f64, held: f64) -> Vec<Stretch> {
        let parts = in_parts(vertices);
        let mut walk = Walk::new(self, width_mm, held, parts.len());
        let mut rest = parts.as_slice();
        while rest.len() > 1 {
            let (edges, bounds_mm) = together(rest);
            walk.edges(&rest[..=edges], bounds_mm);
            rest = &rest[edges..];
        }
        if walk.out.iter().all(|(grade, _)| *grade == Grade::Held) {
            return Vec::new();
        }
        smoothed(walk.out)
    }

    /// The outline's edges that may be nearer to what is in a box than a reach; they replace the contents of `found`.
    fn near(&self, bounds_mm: [[f64; 2]; 2], reach_mm: f64, found: &mut Vec<[[f64; 2]; 2]>) {
        let [a, b] = bounds_mm.map(|[x, y]| Point::from_mm(x, y));
        let bounds = Bounds::spanned(a, b).grown(geometry::to_units(reach_mm) + 1);
        found.clear();
        self.outline.edges_touching(bounds).for_each(|edge| found.push([edge.a.mm(), edge.b.mm()]));
    }
}

/// The vertices, with more on edges that are longer than [`PART_MM`].
fn in_parts(vertices: &[Vertex]) -> Vec<Vertex> {
    let mut all = Vec::with_capacity(vertices.len());
    all.extend(vertices.first());
    for pair in vertices.windows(2) {
        let length_mm = distance_mm(pair[0].at, pair[1].at);
        if length_mm > PART_MM {
            let parts = (length_mm / PART_MM).ceil();
            all.extend((1..parts as u32).map(|part| pair[0].towards(pair[1], f64::from(part) / parts)));
        }
        all.push(pair[1]);
    }
    all
}

/// How many of the edges that begin here are looked at together, one at least, and their box: no larger than [`TOGETHER_MM`].
fn together(vertices: &[Vertex]) -> (usize, [[f64; 2]; 2]) {
    let mut bounds_mm = joined([vertices[0].at; 2], vertices[1].at);
    let mut edges = 1;
    for vertex in &vertices[2..] {
        let [min, max] = joined(bounds_mm, vertex.at);
        if (max[0] - min[0]).max(max[1] - min[1]) > TOGETHER_MM {
            break;
        }
        bounds_mm = [min, max];
        edges += 1;
    }
    (edges, bounds_mm)
}

/// The box around a box and a point.
fn joined([min, max]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    [[lesser(min[0], x), lesser(min[1], y)], [greater(max[0], x), greater(max[1], y)]]
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
    held: f64,
    /// How many vertices it has.
    count: usize,
    /// Whether the present vertex is over the support, if that is known.
    inside: Option<bool>,
    /// The outline's edges that are near to the edges looked at together, for beads that are held there.
    beside: Vec<[[f64; 2]; 2]>,
    /// Those near to one of them, for beads that may lie in the air.
    around: Vec<[[f64; 2]; 2]>,
    out: Vec<Stretch>,
}

impl<'a> Walk<'a> {
    fn new(support: &'a Support, width_mm: f64, held: f64, count: usize) -> Self {
        let (beside, around, out) = (Vec::new(), Vec::new(), Vec::new());
        Self { support, width_mm, held, count, inside: None, beside, around, out }
    }

    /// Goes along edges that are looked at together, whose box is known.
    fn edges(&mut self, vertices: &[Vertex], bounds_mm: [[f64; 2]; 2]) {
        self.support.near(bounds_mm, self.held * self.width_mm, &mut self.beside);
        for pair in vertices.windows(2) {
            self.edge(pair[0], pair[1]);
        }
    }

    fn edge(&mut self, from: Vertex, to: Vertex) {
        let edge = [from.at, to.at];
        let (mut near, mut reach_mm) = (&self.beside, self.held * self.width_mm);
        let mut away = nearest_mm(edge, near, reach_mm) / self.width_mm;
        let inside = match self.inside {
            Some(inside) if away > 0.0 => inside,
            _ => self.support.outline.contains(Point::from_mm(from.at[0], from.at[1])),
        };
        if !(inside && away > 0.0) {
            reach_mm = AIR * self.width_mm;
            self.support.near(joined([from.at; 2], to.at), reach_mm, &mut self.around);
            near = &self.around;
            away = nearest_mm(edge, near, reach_mm) / self.width_mm;
        }
        self.inside = (away > 0.0).then_some(inside);
        if away >= AIR || (inside && away >= self.held) {
            let grade = Grade::of(if inside { -away } else { away }, self.held);
            return push(&mut self.out, grade, [from, to], self.count);
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
            let away = nearest_mm([middle, middle], near, reach_mm) / self.width_mm;
            let grade = Grade::of(if inside { -away } else { away }, self.held);
            push(&mut self.out, grade, [start, end], self.count);
            start = end;
        }
    }
}

/// `count`: how many vertices the first stretch most likely has.
fn push(out: &mut Vec<Stretch>, grade: Grade, [from, to]: [Vertex; 2], count: usize) {
    match out.last_mut() {
        Some((last, vertices)) if *last == grade => vertices.push(to),
        last => {
            let mut vertices = Vec::with_capacity(if last.is_none() { count } else { 2 });
            vertices.extend([from, to]);
            out.push((grade, vertices));
        }
    }
}

/// Distance of a segment from the nearest of some others, 0 where they meet; any that is no less where none is nearer than a reach.
fn nearest_mm(segment: [[f64; 2]; 2], others: &[[[f64; 2]; 2]], reach_mm: f64) -> f64 {
    let (mut nearest, mut least) = (f64::INFINITY, reach_mm);
    for &other in others {
        // Most are farther off than that or than another is, which their boxes show.
        if boxes_mm(segment, other) <= least + NOISE_MM {
            nearest = lesser(segments_mm(segment, other), nearest);
            least = lesser(nearest, least);
        }
    }
    nearest
}

/// How far apart the boxes of two segments are along an axis, at most; negative where they overlap.
#[inline]
fn boxes_mm([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> f64 {
    let mut most_mm = f64::NEG_INFINITY;
    for i in 0..2 {
        let before_mm = lesser(a[i], b[i]) - greater(c[i], d[i]);
        let after_mm = lesser(c[i], d[i]) - greater(a[i], b[i]);
        most_mm = greater(greater(before_mm, after_mm), most_mm);
    }
    most_mm
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
    let nearest = ends.into_iter().fold(f64::INFINITY, lesser);
    if s[0] != s[1] && !apart(s, e) && !apart(e, s) && side(s, e[0]) != side(s, e[1]) { 0.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Polygon;
    use proptest::prelude::*;

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
            let stretches = support.stretches(&line(&[[x, 2.0], [x, 18.0]]), 0.4, HELD);
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
        let stretches = Support::new(&two).stretches(&line(&[[1.0, 5.0], [29.0, 5.0]]), 0.4, HELD);
        let grades: Vec<Grade> = stretches.iter().map(|s| s.0).collect();
        assert_eq!(grades, [Grade::Held, Grade::Air, Grade::Held]);
        let (air, length_mm) = (&stretches[1].1, distance_mm([1.0, 5.0], [29.0, 5.0]));
        assert!((air[0].at[0] - 10.0).abs() < 0.6 && (air.last().unwrap().at[0] - 20.0).abs() < 0.6);
        let sum: f64 = stretches.iter().map(|s| super::length_mm(&s.1)).sum();
        assert!((sum - length_mm).abs() < 1e-9, "nothing is lost: {sum}");
    }

    /// A star around a point.
    fn star(middle: f64, radii: &[f64]) -> Region {
        let corner = |(i, radius): (usize, &f64)| {
            let (sine, cosine) = (i as f64 / radii.len() as f64 * std::f64::consts::TAU).sin_cos();
            Point::from_mm(middle + radius * cosine, middle + radius * sine)
        };
        Region::from(Polygon { outer: radii.iter().enumerate().map(corner).collect(), holes: Vec::new() })
    }

    proptest! {
        #[test]
        fn edges_looked_at_together_have_the_grades_that_each_has_alone(
            held in prop::sample::select(vec![0.0, HELD]),
            radii in prop::collection::vec(2.0..12.0f64, 3..60),
            corners in prop::collection::vec(((0.0..30.0f64), (0.0..30.0f64)), 1..5),
            steps in prop::collection::vec((-0.6..0.6f64, -0.6..0.6f64), 2..60),
        ) {
            let support = Support::new(&star(15.0, &radii));
            let mut points: Vec<[f64; 2]> = corners.iter().map(|&(x, y)| [x, y]).collect();
            for (dx, dy) in steps {
                let [x, y] = points[points.len() - 1];
                points.push([x + dx, y + dy]);
            }
            let bead = line(&points);
            let mut alone = Walk::new(&support, 0.45, held, bead.len());
            for edge in in_parts(&bead).windows(2) {
                alone.edges(edge, joined([edge[0].at; 2], edge[1].at));
            }
            let all_held = alone.out.iter().all(|(grade, _)| *grade == Grade::Held);
            let wanted = if all_held { Vec::new() } else { smoothed(alone.out) };
            prop_assert_eq!(support.stretches(&bead, 0.45, held), wanted);
        }
    }
}
