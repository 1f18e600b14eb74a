//! Building closed surfaces out of faces, walls, lofts and lathes.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// A closed curve in the plane, millimetres; the edge from the last to the first point is implied.
pub type Outline = Vec<[f64; 2]>;

/// Facets, corners counter-clockwise seen from outside.
#[derive(Clone, Default)]
pub struct Solid {
    pub facets: Vec<[[f64; 3]; 3]>,
}

impl Solid {
    /// A horizontal face, looking up or down: the first outline without the others.
    pub fn face(&mut self, outlines: &[Outline], z: f64, up: bool) {
        for [a, b, c] in triangulate(outlines) {
            let [a, b, c] = [a, b, c].map(|p| [p[0], p[1], z]);
            self.facets.push(if up { [a, b, c] } else { [a, c, b] });
        }
    }

    /// The surface between two outlines with as many points, the solid to the left of each (a hole runs clockwise).
    pub fn band(&mut self, low: &[[f64; 3]], high: &[[f64; 3]]) {
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            for facet in [[low[i], low[j], high[j]], [low[i], high[j], high[i]]] {
                if facet[0] != facet[1] && facet[1] != facet[2] && facet[2] != facet[0] {
                    self.facets.push(facet);
                }
            }
        }
    }

    /// An upright wall over an outline.
    pub fn wall(&mut self, outline: &Outline, z0: f64, z1: f64) {
        self.band(&at(outline, z0), &at(outline, z1));
    }

    /// An upright body: the first outline (counter-clockwise) without the others (clockwise).
    pub fn prism(outlines: &[Outline], z0: f64, z1: f64) -> Self {
        Self::loft(outlines, &[z0, z1], |p, z| [p[0], p[1], z])
    }

    /// A body whose section at each height is moved by a function, which must keep the outlines apart.
    pub fn loft(outlines: &[Outline], heights: &[f64], place: impl Fn([f64; 2], f64) -> [f64; 3]) -> Self {
        let mut solid = Self::default();
        let (bottom, top) = (heights[0], heights[heights.len() - 1]);
        for [a, b, c] in triangulate(outlines) {
            solid.facets.push([a, c, b].map(|p| place(p, bottom)));
            solid.facets.push([a, b, c].map(|p| place(p, top)));
        }
        for outline in outlines {
            for pair in heights.windows(2) {
                let ring = |z: f64| outline.iter().map(|&p| place(p, z)).collect::<Vec<_>>();
                solid.band(&ring(pair[0]), &ring(pair[1]));
            }
        }
        solid
    }

    /// A body of revolution about Z. The profile runs from axis to axis, in (radius, z), the solid to its left.
    pub fn lathe(profile: &[[f64; 2]], sides: usize) -> Self {
        let mut solid = Self::default();
        let ring = |[r, z]: [f64; 2]| at(&circle([0.0; 2], r, sides), z);
        for pair in profile.windows(2) {
            solid.band(&ring(pair[0]), &ring(pair[1]));
        }
        solid
    }

    /// The same surface with every facet turned over: the wall of a cavity.
    pub fn inside_out(mut self) -> Self {
        self.facets.iter_mut().for_each(|f| f.swap(1, 2));
        self
    }

    /// Both surfaces.
    pub fn with(mut self, other: Self) -> Self {
        self.facets.extend(other.facets);
        self
    }

    /// Every corner moved.
    pub fn map(mut self, place: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        self.facets.iter_mut().flatten().for_each(|p| *p = place(*p));
        self
    }

    /// A profile in (x, z) drawn out along Y.
    pub fn profile(outlines: &[Outline], depth: f64) -> Self {
        Self::prism(outlines, 0.0, depth).map(|[x, z, y]| [x, depth - y, z])
    }
}

/// An outline at a height.
pub fn at(outline: &Outline, z: f64) -> Vec<[f64; 3]> {
    outline.iter().map(|p| [p[0], p[1], z]).collect()
}

/// A regular polygon, counter-clockwise.
pub fn circle(middle: [f64; 2], radius: f64, sides: usize) -> Outline {
    let angle = |i: usize| i as f64 / sides as f64 * std::f64::consts::TAU;
    (0..sides).map(|i| [middle[0] + radius * angle(i).cos(), middle[1] + radius * angle(i).sin()]).collect()
}

/// A rectangle, counter-clockwise.
pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Outline {
    vec![low, [high[0], low[1]], high, [low[0], high[1]]]
}

/// The outline in the opposite direction: a hole.
pub fn hole(mut outline: Outline) -> Outline {
    outline.reverse();
    outline
}

/// Triangles of a polygon with holes, counter-clockwise, in a fixed order.
fn triangulate(outlines: &[Outline]) -> Vec<[[f64; 2]; 3]> {
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    for outline in outlines {
        let corners: Vec<_> = outline
            .iter()
            .map(|p| mesh.insert(Point2::new(p[0], p[1])).expect("finite coordinates"))
            .collect();
        for i in 0..corners.len() {
            mesh.add_constraint(corners[i], corners[(i + 1) % corners.len()]);
        }
    }
    let inside = |p: [f64; 2]| {
        let edges = outlines.iter().flat_map(|o| (0..o.len()).map(move |i| (o[i], o[(i + 1) % o.len()])));
        let crossings = edges.filter(|(a, b)| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        });
        crossings.count() % 2 == 1
    };
    let corners = mesh.inner_faces().map(|f| f.positions().map(|p| [p.x, p.y]));
    corners.filter(|[a, b, c]| inside([(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0])).collect()
}
