//! Bytes → polygons and layers of the kinds that break geometry.

use pathwright::geometry::{Point, Ring};
use pathwright::order::{Item, Problem, Run, Shape};
use pathwright::profile::Scope;

/// Bytes, one after the other; zeros when they are used up.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    fn next(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A number below `end`, of two bytes.
    pub fn int(&mut self, end: u32) -> u32 {
        (u32::from(self.next()) << 8 | u32::from(self.next())) % end.max(1)
    }

    /// A number between −`reach` and `reach`.
    fn around(&mut self, reach: i32) -> i32 {
        let bits = [self.next(), self.next(), self.next(), self.next()];
        (i64::from(i32::from_le_bytes(bits)) % (i64::from(reach) + 1)) as i32
    }
}

/// Millimetres in grid units.
const MM: i32 = 100_000;
/// Meshes end 10 m from the origin.
const LIMIT: i32 = 9_950 * MM;
const MOST_RINGS: usize = 12;
const MOST_POINTS: u32 = 40;

/// Rings with corners anywhere, spikes, repeated and touching corners, straight runs, corners 10 nm apart, all at the
/// origin or at the limits of the grid.
pub fn rings(bytes: &mut Bytes<'_>) -> Vec<Ring> {
    let far = match bytes.next() % 8 {
        6 => Point::new(LIMIT, LIMIT),
        7 => Point::new(-LIMIT, LIMIT),
        _ => Point::new(0, 0),
    };
    let mut rings = Vec::new();
    while rings.len() < MOST_RINGS && !bytes.is_empty() {
        let ring = ring(bytes);
        rings.push(ring.into_iter().map(|p| p + far).collect());
    }
    rings
}

fn ring(bytes: &mut Bytes<'_>) -> Ring {
    let kind = bytes.next() % 6;
    let count = 3 + bytes.int(MOST_POINTS);
    let middle = Point::new(bytes.around(15 * MM), bytes.around(15 * MM));
    let mut at = middle;
    (0..count)
        .map(|i| {
            at = match kind {
                0 => Point::new(bytes.around(20 * MM), bytes.around(20 * MM)),
                1 => {
                    let angle = f64::from(i) / f64::from(count) * std::f64::consts::TAU;
                    let reach = if i % 2 == 0 { 10 * MM } else { bytes.around(MM) };
                    let (sine, cosine) = angle.sin_cos();
                    middle + Point::new((f64::from(reach) * cosine) as i32, (f64::from(reach) * sine) as i32)
                }
                2 => Point::new(bytes.around(4) * MM, bytes.around(4) * MM),
                3 => {
                    at + if bytes.next().is_multiple_of(2) {
                        Point::new(bytes.around(MM), 0)
                    } else {
                        Point::new(0, bytes.around(MM))
                    }
                }
                4 => at + Point::new(bytes.around(2), bytes.around(2)),
                _ => at + Point::new(bytes.around(MM / 2), bytes.around(MM / 2)),
            };
            at
        })
        .collect()
}

/// A layer as plain data, from which a problem borrows.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Run and vertices; two vertices make an open path, others a loop.
    pub items: Vec<(u32, Vec<Point>)>,
    pub runs: Vec<Run>,
    pub scope: Scope,
    pub start: Option<Point>,
    pub end: Option<Point>,
}

impl Layer {
    /// The layer as strategies take it.
    pub fn problem(&self) -> Problem<'_> {
        let items = self.items.iter().map(|(run, points)| Item {
            run: *run,
            shape: if points.len() == 2 { Shape::Open([points[0], points[1]]) } else { Shape::Loop(points) },
        });
        let (items, runs) = (items.collect(), self.runs.clone());
        Problem { items, runs, scope: self.scope, start: self.start, end: self.end }
    }
}

/// Up to sixty paths in up to six runs, many of them in the same places.
pub fn layer(bytes: &mut Bytes<'_>) -> Layer {
    let scope = Scope::ALL[bytes.int(3) as usize].1;
    let reach = [4, 5_000_000, 1_000_000_000][bytes.next() as usize % 3];
    let point = |bytes: &mut Bytes<'_>| Point::new(bytes.around(reach), bytes.around(reach));
    let [start, end] = [0, 1].map(|_| bytes.next().is_multiple_of(2).then(|| point(bytes)));
    let mut items: Vec<(u32, Vec<Point>)> = Vec::new();
    let mut used = Vec::new();
    while items.len() < 60 && !bytes.is_empty() {
        let run = (bytes.int(4), bytes.int(3), bytes.int(3));
        let at = used.iter().position(|known| *known == run).unwrap_or_else(|| {
            used.push(run);
            used.len() - 1
        });
        let count = [2, 2, 2, 1, 3, 8][bytes.next() as usize % 6];
        items.push((at as u32, (0..count).map(|_| point(bytes)).collect()));
    }
    // Runs are numbered in their order.
    let mut sorted = used.clone();
    sorted.sort_unstable();
    for (run, _) in &mut items {
        *run = sorted.iter().position(|known| *known == used[*run as usize]).unwrap_or(0) as u32;
    }
    let runs =
        sorted.into_iter().map(|(stage, island, rank)| Run { stage, island, layer: 0, rank }).collect();
    Layer { items, runs, scope, start, end }
}
