//! The sides of a model's convex hull: it can lie on them.

use geo::{ConvexHull, MultiPoint, Point};
use nalgebra::{UnitVector3, Vector3};
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;
use serde::Serialize;

use crate::mesh::Mesh;

/// Facets of the hull within 1° are one side.
const SAME_SIDE: f64 = 0.99985;

/// Facets of a convex hull that lie in one plane.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Outwards.
    pub normal: Vector3<f64>,
    /// Twice the area, mm².
    pub twice_mm2: f64,
    corners: Vec<Vector3<f64>>,
}

/// A flat side of a model's convex hull.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Face {
    /// Outwards, of length 1.
    pub normal: [f64; 3],
    /// Area, mm².
    pub area_mm2: f64,
    /// Corners one after the other, in the mesh's coordinates, millimetres.
    pub outline: Vec<[f64; 3]>,
}

/// The largest flat sides of a mesh's convex hull, at most so many.
pub fn faces(mesh: &Mesh, most: usize) -> Vec<Face> {
    sides(mesh).into_iter().take(most).map(face).collect()
}

/// All sides, the largest first.
pub(super) fn sides(mesh: &Mesh) -> Vec<Side> {
    let points: Vec<Vector> =
        mesh.vertices().iter().map(|v| Vector::new(v[0] as f32, v[1] as f32, v[2] as f32)).collect();
    let mut sides: Vec<Side> = Vec::new();
    if let Ok((points, facets)) = try_convex_hull(&points) {
        let at = |i: u32| {
            let p = points[i as usize];
            Vector3::new(f64::from(p.x), f64::from(p.y), f64::from(p.z))
        };
        for facet in facets {
            let [a, b, c] = facet.map(at);
            let normal = (b - a).cross(&(c - a));
            let twice_mm2 = normal.norm();
            let Some(normal) = UnitVector3::try_new(normal, 1e-9) else { continue };
            match sides.iter_mut().find(|side| side.normal.dot(&normal) > SAME_SIDE) {
                Some(side) => {
                    side.twice_mm2 += twice_mm2;
                    side.corners.extend([a, b, c]);
                }
                None => sides.push(Side { normal: *normal, twice_mm2, corners: vec![a, b, c] }),
            }
        }
    }
    sides.sort_by(|a, b| b.twice_mm2.total_cmp(&a.twice_mm2));
    sides
}

fn face(side: Side) -> Face {
    let normal = side.normal;
    let helper = if normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let u = normal.cross(&helper).normalize();
    let v = normal.cross(&u);
    let away_mm = side.corners.iter().map(|p| p.dot(&normal)).sum::<f64>() / side.corners.len().max(1) as f64;
    let flat: MultiPoint<f64> = side.corners.iter().map(|p| Point::new(p.dot(&u), p.dot(&v))).collect();
    let hull = flat.convex_hull();
    let corner = |p: Point<f64>| (u * p.x() + v * p.y() + normal * away_mm).into();
    // The first corner is repeated at the end.
    let outline = hull.exterior().points().skip(1).map(corner).collect();
    Face { normal: normal.into(), area_mm2: side.twice_mm2 / 2.0, outline }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::load_objects;

    #[test]
    fn a_cube_has_six_square_faces() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/models/calibration_cube.stl");
        let mesh = load_objects(path.as_ref()).unwrap().remove(0).mesh;
        let faces = faces(&mesh, 40);
        let areas: Vec<f64> = faces.iter().take(6).map(|face| face.area_mm2).collect();
        assert!(areas.iter().all(|area| (area - 400.0).abs() < 1e-3), "{areas:?}");
        let down = faces.iter().find(|face| face.normal[2] < -0.99).expect("a bottom");
        assert_eq!(down.outline.len(), 4);
        assert!(down.outline.iter().all(|p| p[2].abs() < 1e-4));
    }
}
