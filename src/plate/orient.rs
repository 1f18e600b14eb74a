//! Which side of a model goes down.
//!
//! Candidates are the large facets of the convex hull, on which a part can lie, as in C. Schranz, "Tweaker: Auto Rotation
//! Module for FDM 3D Printing" (2016), which weighs overhangs against the area that touches the bed. What is weighed here is
//! what printing costs: the volume under overhangs that supports would fill, less what lies firmly on the bed.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::faces::sides;
use crate::mesh::Mesh;

/// Sides that are tried: the largest ones.
const CANDIDATES: usize = 40;

/// Facets that look down more steeply than this hang over: 45°.
const OVERHANG: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// What lies so near to the lowest point touches the bed, mm.
const CONTACT_MM: f64 = 0.05;

/// A square millimetre that touches the bed is worth this many cubic millimetres of support: a layer's height or two.
const CONTACT_WORTH_MM: f64 = 0.5;

/// A millimetre less in height is worth this many cubic millimetres of support, as a share of the side of the contact.
const HEIGHT_WORTH_MM2: f64 = 1.0;

/// Rotates the mesh to stand stably and need the least support; unchanged where nothing is better.
///
/// Support is measured as the volume between overhanging facets (more than 45°) and the bed. A part whose middle is not over
/// what touches the bed falls over, and is turned so only if there is no alternative. Deterministic. O(40 · triangles).
pub fn orient(mut mesh: Mesh) -> Mesh {
    if let Some(turn) = upright(&mesh) {
        mesh.moved(|vertex| (turn * Vector3::from(vertex)).into());
    }
    mesh
}

/// The rotation of [`orient`], as a matrix; `None` where nothing is better.
pub(crate) fn upright(mesh: &Mesh) -> Option<Matrix3<f64>> {
    let middle = center_of_mass(mesh);
    let downs = downs(mesh);
    let costs = downs.iter().map(|down| cost(mesh, *down, middle));
    // A tenth of a percent is no reason to turn a part.
    let better =
        |a: [f64; 2], b: [f64; 2]| a[0] < b[0] || (a[0] == b[0] && a[1] < b[1] - 1e-3 * b[1].abs().max(1.0));
    let best = costs.enumerate().reduce(|best, next| if better(next.1, best.1) { next } else { best });
    best.filter(|(index, _)| *index > 0).map(|(index, _)| turn_down(downs[index]))
}

/// The rotation after which a direction points down.
fn turn_down(down: Vector3<f64>) -> Matrix3<f64> {
    let half_turn = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let turn = Rotation3::rotation_between(&down, &-Vector3::z()).unwrap_or_else(half_turn).into_inner();
    // Sides along an axis turn exactly.
    let exact = turn.iter().all(|x| (x - x.round()).abs() < 1e-6);
    if exact { turn.map(f64::round) } else { turn }
}

/// Directions that may point down: as it is, then the sides of the hull by falling area.
fn downs(mesh: &Mesh) -> Vec<Vector3<f64>> {
    let found = sides(mesh).into_iter().take(CANDIDATES).map(|side| side.normal);
    std::iter::once(-Vector3::z()).chain(found).collect()
}

/// Whether it falls over (1 or 0), and what it costs to print it with a direction down.
fn cost(mesh: &Mesh, down: Vector3<f64>, middle: Vector3<f64>) -> [f64; 2] {
    let height = |v: &[f64; 3]| -down.dot(&Vector3::from(*v));
    let heights: Vec<f64> = mesh.vertices().iter().map(height).collect();
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut support_mm3, mut contact_mm2) = (0.0, 0.0);
    let mut touching: Vec<Vector3<f64>> = Vec::new();
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| Vector3::from(mesh.vertices()[v as usize]));
        let normal = (b - a).cross(&(c - a)) / 2.0;
        let projected_mm2 = normal.dot(&down);
        if projected_mm2 <= OVERHANG * normal.norm() {
            continue;
        }
        let over = t.map(|v| heights[v as usize] - lowest);
        if over.iter().all(|h| *h < CONTACT_MM) {
            contact_mm2 += projected_mm2;
            touching.extend([a, b, c]);
        } else {
            support_mm3 += projected_mm2 * over.iter().sum::<f64>() / 3.0;
        }
    }
    let falls = f64::from(u8::from(!stands(&touching, middle, down)));
    [falls, support_mm3 - CONTACT_WORTH_MM * contact_mm2 + HEIGHT_WORTH_MM2 * (highest - lowest)]
}

/// Whether the middle is over the convex hull of what touches the bed.
fn stands(touching: &[Vector3<f64>], middle: Vector3<f64>, down: Vector3<f64>) -> bool {
    use geo::{Contains, ConvexHull, MultiPoint, Point};
    let helper = if down.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let u = down.cross(&helper).normalize();
    let v = down.cross(&u);
    let flat = |p: &Vector3<f64>| Point::new(p.dot(&u), p.dot(&v));
    let points: MultiPoint<f64> = touching.iter().map(flat).collect();
    points.convex_hull().contains(&flat(&middle))
}

/// The middle of the enclosed volume; of an open mesh an estimate, as its volume is.
fn center_of_mass(mesh: &Mesh) -> Vector3<f64> {
    let [min, max] = mesh.bounds();
    let apex = Vector3::from([0, 1, 2].map(|i| (min[i] + max[i]) / 2.0));
    let (mut sum, mut volume) = (Vector3::zeros(), 0.0);
    for t in mesh.triangles() {
        let [a, b, c] = t.map(|v| Vector3::from(mesh.vertices()[v as usize]) - apex);
        let part = a.dot(&b.cross(&c)) / 6.0;
        volume += part;
        sum += (a + b + c) / 4.0 * part;
    }
    if volume.abs() > 1e-9 { apex + sum / volume } else { apex }
}
