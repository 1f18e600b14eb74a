//! Beam lattices → facets: each strut and each ball is a closed body of its own.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use geometry::real;
use nalgebra::{Unit, Vector3};

use super::lattice::{Beam, Cap, Lattice};

/// Facets are nearer to the round than this, millimetres.
const CHORD_MM: f64 = 0.02;

/// Sides of the thinnest and of the thickest strut.
const SIDES: [usize; 2] = [8, 64];

/// Turns each strut a little farther than the one before (golden section), so that struts in line share no corner.
const TURN: f64 = 0.618_033_988_749_894_9;

/// A round body: how far along its axis, and the radius there. The first or last is a tip where its radius is 0, and a
/// flat end otherwise.
struct Profile {
    sides: usize,
    points: Vec<[f64; 2]>,
}

impl Lattice {
    /// Number of its facets; `unit_mm` is the length of a unit of its coordinates at most, millimetres.
    pub fn facet_count(&self, unit_mm: f64) -> usize {
        let balls = self.spheres().into_values().map(|radius| sphere_count(sides(radius * unit_mm)));
        let struts = self.beams.iter().map(|beam| {
            let sides = sides(beam.radii[0].max(beam.radii[1]) * unit_mm);
            let ends =
                beam.caps.map(|cap| if cap == Cap::Hemisphere { (sides / 2 - 1) * sides } else { sides - 2 });
            2 * sides + ends[0] + ends[1]
        });
        balls.chain(struts).fold(0, usize::saturating_add)
    }

    /// Gives every facet, counter-clockwise seen from outside.
    pub fn facets(&self, vertices: &[[f64; 3]], unit_mm: f64, mut give: impl FnMut([[f64; 3]; 3])) {
        for (number, beam) in self.beams.iter().enumerate() {
            let [from, to] = beam.ends.map(|end| Vector3::from(vertices[end as usize]));
            let length = (to - from).norm();
            // A strut without length has its spheres alone.
            if let Some(axis) = Unit::try_new(to - from, 0.0)
                && length.is_normal()
            {
                strut(beam, length, unit_mm).facets(from, axis, TURN * number as f64, &mut give);
            }
        }
        for (vertex, radius) in self.spheres() {
            let profile = sphere(radius, sides(radius * unit_mm));
            profile.facets(Vector3::from(vertices[vertex as usize]), Vector3::z_axis(), 0.0, &mut give);
        }
    }

    /// Balls and round caps by their vertices: of several at one vertex the largest holds the others.
    fn spheres(&self) -> BTreeMap<u32, f64> {
        let mut spheres: BTreeMap<u32, f64> = BTreeMap::new();
        let ends = self
            .beams
            .iter()
            .flat_map(|beam| (0..2).map(move |i| (beam.ends[i], beam.radii[i], beam.caps[i])));
        let caps = ends.filter(|(.., cap)| *cap == Cap::Sphere).map(|(end, radius, _)| (end, radius));
        for (vertex, radius) in caps.chain(self.balls.iter().copied()) {
            let largest = spheres.entry(vertex).or_default();
            *largest = largest.max(radius);
        }
        spheres
    }
}

/// Sides of a circle.
fn sides(radius_mm: f64) -> usize {
    let half = real::acos((1.0 - CHORD_MM / radius_mm).max(0.0));
    let quarter = (PI / half / 4.0).ceil().clamp(SIDES[0] as f64 / 4.0, SIDES[1] as f64 / 4.0);
    4 * quarter as usize
}

/// The radius of a polygon that has the area of a circle.
fn widened(radius: f64, sides: usize) -> f64 {
    let step = TAU / sides as f64;
    radius * (step / real::sin(step)).sqrt()
}

fn sphere_count(sides: usize) -> usize {
    sides * (sides - 2)
}

/// A ball of the volume that it should have.
fn sphere(radius: f64, sides: usize) -> Profile {
    let rings = sides / 2;
    let at = |k: usize| {
        let (sine, cosine) = real::sin_cos(PI * k as f64 / rings as f64);
        [-cosine, if k.is_multiple_of(rings) { 0.0 } else { sine }]
    };
    let points: Vec<[f64; 2]> = (0..=rings).map(at).collect();
    let cones = points.windows(2).map(|pair| {
        let ([low, a], [high, b]) = (pair[0], pair[1]);
        (high - low) * (a * a + a * b + b * b) / 3.0
    });
    let step = TAU / sides as f64;
    let volume = cones.sum::<f64>() * real::sin(step) * sides as f64 / 2.0;
    let factor = radius * real::cbrt(4.0 / 3.0 * PI / volume);
    Profile { sides, points: points.into_iter().map(|p| p.map(|x| x * factor)).collect() }
}

fn strut(beam: &Beam, length: f64, unit_mm: f64) -> Profile {
    let [first, last] = beam.radii;
    let sides = sides(first.max(last) * unit_mm);
    // From the rim of a half ball to its tip.
    let dome = |radius: f64| {
        (0..=sides / 4).map(move |k| {
            let (sine, cosine) = real::sin_cos(PI / 2.0 * k as f64 / (sides / 4) as f64);
            let wide = if k == sides / 4 { 0.0 } else { widened(radius, sides) * cosine };
            [radius * sine, wide]
        })
    };
    let mut points = match beam.caps[0] {
        Cap::Hemisphere => dome(first).rev().map(|[along, wide]| [-along, wide]).collect(),
        _ => vec![[0.0, widened(first, sides)]],
    };
    match beam.caps[1] {
        Cap::Hemisphere => points.extend(dome(last).map(|[along, wide]| [length + along, wide])),
        _ => points.push([length, widened(last, sides)]),
    }
    Profile { sides, points }
}

impl Profile {
    /// Gives the facets of the body about an axis, its corners turned by a part of a side.
    fn facets(
        &self,
        from: Vector3<f64>,
        axis: Unit<Vector3<f64>>,
        turn: f64,
        give: &mut impl FnMut([[f64; 3]; 3]),
    ) {
        let across = if axis.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
        let u = across.cross(&axis).normalize();
        let v = axis.cross(&u);
        let circle: Vec<Vector3<f64>> = (0..self.sides)
            .map(|i| {
                let (sine, cosine) = real::sin_cos(TAU * (i as f64 + turn.fract()) / self.sides as f64);
                u * cosine + v * sine
            })
            .collect();
        let at = |[along, radius]: [f64; 2], i: usize| -> [f64; 3] {
            (from + axis.into_inner() * along + circle[i % self.sides] * radius).into()
        };
        for pair in self.points.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            for i in 0..self.sides {
                if low[1] > 0.0 {
                    give([at(low, i), at(low, i + 1), at(high, i)]);
                }
                if high[1] > 0.0 {
                    give([at(low, i + 1), at(high, i + 1), at(high, i)]);
                }
            }
        }
        let (Some(&first), Some(&last)) = (self.points.first(), self.points.last()) else { return };
        for i in 1..self.sides - 1 {
            if first[1] > 0.0 {
                give([at(first, 0), at(first, i + 1), at(first, i)]);
            }
            if last[1] > 0.0 {
                give([at(last, 0), at(last, i), at(last, i + 1)]);
            }
        }
    }
}
