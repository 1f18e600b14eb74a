//! Scaling and turning a mesh.

use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::surface::Mesh;
use super::weld::LIMIT_MM;

/// A transformation of a mesh, in this order: scaled, then turned about X, Y and Z. Moving is up to
/// [`place()`](crate::plate::place()).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Factors along X, Y and Z; a negative one mirrors.
    pub scale: [f64; 3],
    /// Angles about X, Y and Z in degrees, counter-clockwise seen from the tip of the axis.
    pub rotate_deg: [f64; 3],
}

impl Default for Transform {
    fn default() -> Self {
        Self { scale: [1.0; 3], rotate_deg: [0.0; 3] }
    }
}

/// A transformation that leaves no printable mesh (exit code 2: the arguments are at fault).
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum TransformError {
    #[error("a scale of {0} flattens the model; give factors other than 0")]
    Singular(f64),
    #[error("the transformed model reaches to {0} mm; nothing beyond 10 m from the origin can be sliced")]
    TooFar(f64),
}

impl Transform {
    /// The mesh transformed. Mirroring turns the facets over, so that they face outwards still. O(vertices).
    ///
    /// # Errors
    /// A factor of zero or that is not finite, and coordinates beyond 10 m.
    pub fn apply(&self, mut mesh: Mesh) -> Result<Mesh, TransformError> {
        if let Some(&factor) = self.scale.iter().find(|f| !f.is_finite() || **f == 0.0) {
            return Err(TransformError::Singular(factor));
        }
        let linear = self.rotation() * Matrix3::from_diagonal(&Vector3::from(self.scale));
        mesh.moved(|vertex| (linear * Vector3::from(vertex)).into());
        let far = |x: &&f64| x.is_nan() || x.abs() > f64::from(LIMIT_MM);
        if let Some(&x) = mesh.vertices.as_flattened().iter().find(far) {
            return Err(TransformError::TooFar(x));
        }
        if self.scale.iter().filter(|f| **f < 0.0).count() % 2 == 1 {
            mesh.turn_over();
        }
        Ok(mesh)
    }

    /// Where a point goes.
    pub fn of_point(&self, point: [f64; 3]) -> [f64; 3] {
        (self.rotation() * Vector3::from([0, 1, 2].map(|i| self.scale[i] * point[i]))).into()
    }

    /// Quarter turns are exact: a turned box keeps faces parallel to the layers.
    fn rotation(&self) -> Matrix3<f64> {
        let turn = |axis, degrees: f64| {
            let matrix = Rotation3::from_axis_angle(&axis, degrees.to_radians()).into_inner();
            if degrees % 90.0 == 0.0 { matrix.map(f64::round) } else { matrix }
        };
        let [x, y, z] = self.rotate_deg;
        turn(Vector3::z_axis(), z) * turn(Vector3::y_axis(), y) * turn(Vector3::x_axis(), x)
    }
}

/// A position turned counter-clockwise about the origin by quarters; exact.
pub(crate) fn quarter_turned([x, y]: [f64; 2], quarters: u32) -> [f64; 2] {
    match quarters % 4 {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

impl Mesh {
    /// Every facet turned over.
    fn turn_over(&mut self) {
        let (triangles, twins) = (Arc::make_mut(&mut self.triangles), Arc::make_mut(&mut self.twins));
        super::repair::turn_facets(triangles, twins, |_| true);
        self.modifiers.iter_mut().for_each(|modifier| modifier.mesh.turn_over());
    }

    /// The mesh moved so that the middle of its box lies over the origin and its lowest point at z = 0.
    pub fn centered(self) -> Mesh {
        let bounds = self.bounds();
        self.standing(bounds)
    }

    /// The mesh moved so that the middle of a box lies over the origin and its bottom at z = 0.
    pub(crate) fn standing(mut self, [min, max]: [[f64; 3]; 2]) -> Mesh {
        self.shift([-(min[0] + max[0]) / 2.0, -(min[1] + max[1]) / 2.0, -min[2]]);
        self
    }

    /// The mesh turned about Z by quarters, counter-clockwise seen from above; exact.
    pub fn quarter_turned(mut self, quarters: u32) -> Mesh {
        if !quarters.is_multiple_of(4) {
            self.moved(|[x, y, z]| {
                let [x, y] = quarter_turned([x, y], quarters);
                [x, y, z]
            });
        }
        self
    }

    /// Moves the mesh, in millimetres.
    pub fn shift(&mut self, by_mm: [f64; 3]) {
        self.moved(|vertex| std::array::from_fn(|i| vertex[i] + by_mm[i]));
    }
}
