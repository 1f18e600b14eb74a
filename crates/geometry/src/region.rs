//! Areas of the plane: disjoint polygons with holes.

use super::point::{Point, UNITS_PER_MM};

/// A closed ring of vertices; the edge from the last to the first is implied.
pub type Ring = Vec<Point>;

/// Twice-signed area halved: positive for a counter-clockwise ring. Square millimetres.
pub fn ring_area(ring: &[Point]) -> f64 {
    let Some(&origin) = ring.first() else {
        return 0.0;
    };
    let twice: i128 = ring.windows(2).map(|e| i128::from((e[0] - origin).cross(e[1] - origin))).sum();
    twice as f64 / 2.0 / (UNITS_PER_MM * UNITS_PER_MM)
}

/// Length of a closed ring in millimetres.
pub fn ring_length_mm(ring: &[Point]) -> f64 {
    let closing = match (ring.last(), ring.first()) {
        (Some(a), Some(b)) => a.distance_mm(*b),
        _ => 0.0,
    };
    closing + ring.windows(2).map(|e| e[0].distance_mm(e[1])).sum::<f64>()
}

/// One polygon: a counter-clockwise outer ring and clockwise holes inside it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polygon {
    /// Boundary, counter-clockwise.
    pub outer: Ring,
    /// Holes, clockwise.
    pub holes: Vec<Ring>,
}

impl Polygon {
    /// The outer ring, then the holes.
    pub fn rings(&self) -> impl Iterator<Item = &Ring> {
        std::iter::once(&self.outer).chain(&self.holes)
    }

    /// Area in square millimetres, holes taken out.
    pub fn area_mm2(&self) -> f64 {
        self.rings().map(|r| ring_area(r)).sum()
    }

    /// The smallest box around it; that of the origin for one without vertices.
    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.outer.iter().copied()).unwrap_or_default()
    }

    /// Whether the point is inside or on the boundary. O(vertices).
    pub fn contains(&self, p: Point) -> bool {
        contained(self.rings(), p)
    }
}

/// Whether the point is inside of a ring or on it. O(vertices).
pub fn ring_contains(ring: &Ring, p: Point) -> bool {
    contained(std::iter::once(ring), p)
}

/// Whether a ring winds around a point an odd number of times; of one on the ring, either.
pub(super) fn surrounds(ring: &[Point], p: Point) -> bool {
    let closing = ring.last().map(|&last| (last, ring[0]));
    let edges = ring.windows(2).map(|edge| (edge[0], edge[1])).chain(closing);
    let crossed =
        edges.filter(|&(a, b)| (a.y > p.y) != (b.y > p.y) && ((b - a).cross(p - a) > 0) == (b.y > a.y));
    crossed.count() % 2 == 1
}

/// Whether the point is inside of rings or on one of them (even-odd).
fn contained<'a>(rings: impl Iterator<Item = &'a Ring>, p: Point) -> bool {
    let mut inside = false;
    for ring in rings {
        let Some(&(mut a)) = ring.last() else {
            continue;
        };
        for &b in ring {
            if a.y == p.y && b.y == p.y && (a.x <= p.x) != (b.x < p.x) || b == p {
                return true;
            }
            if (a.y > p.y) != (b.y > p.y) {
                let side = (b - a).cross(p - a);
                if side == 0 {
                    return true;
                }
                if (side > 0) == (b.y > a.y) {
                    inside = !inside;
                }
            }
            a = b;
        }
    }
    inside
}

/// Disjoint polygons with holes; what a layer's cross-section is.
///
/// [`unite_rings`](super::unite_rings) makes one of any rings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Region {
    /// No two overlap.
    pub(super) polygons: Vec<Polygon>,
}

/// A polygon alone.
impl From<Polygon> for Region {
    fn from(polygon: Polygon) -> Self {
        Self { polygons: vec![polygon] }
    }
}

impl Region {
    /// Nothing.
    pub const EMPTY: &'static Region = &Region { polygons: Vec::new() };

    /// Of polygons of which no two overlap, which is not verified.
    pub fn disjoint(polygons: impl IntoIterator<Item = Polygon>) -> Self {
        Self { polygons: polygons.into_iter().collect() }
    }

    /// Adds polygons that overlap neither each other nor what is there, which is not verified.
    pub fn add_disjoint(&mut self, polygons: impl IntoIterator<Item = Polygon>) {
        self.polygons.extend(polygons);
    }

    /// Leaves out the polygons that a function refuses.
    pub fn retain(&mut self, keep: impl FnMut(&Polygon) -> bool) {
        self.polygons.retain(keep);
    }

    /// The polygons.
    pub fn polygons(&self) -> &[Polygon] {
        &self.polygons
    }

    /// The polygons, out of the region.
    pub fn into_polygons(self) -> Vec<Polygon> {
        self.polygons
    }

    /// Whether it has no area.
    pub fn is_empty(&self) -> bool {
        self.polygons.is_empty()
    }

    /// Every ring of every polygon.
    pub fn rings(&self) -> impl Iterator<Item = &Ring> {
        self.polygons.iter().flat_map(Polygon::rings)
    }

    /// Area in square millimetres.
    pub fn area_mm2(&self) -> f64 {
        self.polygons.iter().map(Polygon::area_mm2).sum()
    }

    /// Number of vertices in all rings.
    pub fn vertex_count(&self) -> usize {
        self.rings().map(Vec::len).sum()
    }

    /// Bounding box, or `None` of an empty region.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.polygons.iter().flat_map(|p| p.outer.iter().copied()))
    }

    /// Whether the point is inside or on the boundary (even-odd over all rings). O(vertices).
    pub fn contains(&self, p: Point) -> bool {
        contained(self.rings(), p)
    }

    /// The region moved by a displacement.
    pub fn translated(&self, by: Point) -> Region {
        let ring = |r: &Ring| r.iter().map(|&p| p + by).collect();
        Region {
            polygons: self
                .polygons
                .iter()
                .map(|p| Polygon { outer: ring(&p.outer), holes: p.holes.iter().map(ring).collect() })
                .collect(),
        }
    }
}

/// Appends a ring to points, of equal neighbours one.
pub(super) fn push_ring(points: &mut Vec<Point>, ring: &[Point]) {
    let start = points.len();
    if ring.windows(2).all(|pair| pair[0] != pair[1]) {
        points.extend_from_slice(ring);
    } else {
        points.extend(ring.chunk_by(|a, b| a == b).map(|same| same[0]));
    }
    while points.len() > start + 1 && points.last() == Some(&points[start]) {
        points.pop();
    }
}

/// An axis-parallel box in grid units, limits included. By default the origin alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// Lower left corner.
    pub min: Point,
    /// Upper right corner.
    pub max: Point,
}

impl Bounds {
    /// The smallest box around the points, or `None` where there are none.
    pub fn of(points: impl IntoIterator<Item = Point>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        Some(points.fold(Self { min: first, max: first }, |b, p| Self {
            min: Point::new(b.min.x.min(p.x), b.min.y.min(p.y)),
            max: Point::new(b.max.x.max(p.x), b.max.y.max(p.y)),
        }))
    }

    /// The box that two points span.
    #[inline]
    pub fn spanned(a: Point, b: Point) -> Self {
        Self { min: Point::new(a.x.min(b.x), a.y.min(b.y)), max: Point::new(a.x.max(b.x), a.y.max(b.y)) }
    }

    /// Width and height, in grid units.
    #[inline]
    pub fn size(&self) -> [i64; 2] {
        let length = |low: i32, high: i32| i64::from(high) - i64::from(low);
        [length(self.min.x, self.max.x), length(self.min.y, self.max.y)]
    }

    /// How far a point lies outside along X and Y, in grid units; 0 where it is between the sides.
    #[inline]
    pub fn beyond(&self, p: Point) -> [i64; 2] {
        let axis = |low: i32, high: i32, at: i32| {
            (i64::from(low) - i64::from(at)).max(i64::from(at) - i64::from(high)).max(0)
        };
        [axis(self.min.x, self.max.x, p.x), axis(self.min.y, self.max.y, p.y)]
    }

    /// Squared distance of a point, in square units; 0 inside.
    #[inline]
    pub fn distance2(&self, p: Point) -> i64 {
        let [dx, dy] = self.beyond(p);
        dx * dx + dy * dy
    }

    /// Whether a point is in the box.
    pub fn holds(&self, p: Point) -> bool {
        self.min.x <= p.x && p.x <= self.max.x && self.min.y <= p.y && p.y <= self.max.y
    }

    /// Whether two boxes share a point.
    pub fn touches(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }

    /// The box with a margin on every side, cut off at the grid's limits.
    pub fn grown(&self, by: i32) -> Self {
        let moved = |p: Point, by: i32| Point::new(p.x.saturating_add(by), p.y.saturating_add(by));
        Self { min: moved(self.min, by.saturating_neg()), max: moved(self.max, by) }
    }

    /// The box that holds both.
    #[inline]
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            min: Point::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y)),
            max: Point::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y)),
        }
    }
}
