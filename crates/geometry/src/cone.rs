//! Straight lines from a point past others.

use super::cross;

/// The directions from the origin in which a straight line passes all of some points within a tolerance.
///
/// Cones of points that follow each other, narrowed by each, tell in O(1) how far a straight line may replace them
/// (Williams 1978, Computer Graphics and Image Processing 8, 286–293; Sklansky & Gonzalez 1980, Pattern Recognition
/// 12, 327–331).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    right: [f64; 2],
    left: [f64; 2],
}

impl Cone {
    /// Between the tangents to the circle of the tolerance around a point, in any unit; `None` where the origin lies in
    /// it: all directions will do.
    #[inline]
    pub fn around(point: [f64; 2], tolerance: f64) -> Option<Self> {
        let [x, y] = point;
        let along2 = x * x + y * y - tolerance * tolerance;
        if along2 <= 0.0 {
            return None;
        }
        let along = along2.sqrt();
        let turned = |side: f64| [x * along - y * side, y * along + x * side];
        Some(Self { right: turned(-tolerance), left: turned(tolerance) })
    }

    /// Whether the direction of a point is in the cone.
    #[inline]
    pub fn contains(&self, point: [f64; 2]) -> bool {
        let ahead = point[0] * (self.right[0] + self.left[0]) + point[1] * (self.right[1] + self.left[1]);
        ahead > 0.0 && cross(self.right, point) >= 0.0 && cross(point, self.left) >= 0.0
    }

    /// What it has in common with another, the middle of which it contains.
    #[inline]
    #[must_use]
    pub fn narrowed(self, by: Self) -> Self {
        Self {
            right: if cross(self.right, by.right) > 0.0 { by.right } else { self.right },
            left: if cross(self.left, by.left) < 0.0 { by.left } else { self.left },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_in_a_cone_pass_its_points_within_the_tolerance() {
        let points = [[2.0, 0.05], [5.0, -0.06], [9.0, 0.0]];
        let cones = points.into_iter().filter_map(|point| Cone::around(point, 0.1));
        let cone = cones.reduce(Cone::narrowed).unwrap();
        for step in -40..=40 {
            let to = [10.0, 0.01 * f64::from(step)];
            let off = |[x, y]: [f64; 2]| (cross([x, y], to) / to[0].hypot(to[1])).abs();
            assert_eq!(cone.contains(to), points.iter().all(|&point| off(point) <= 0.1), "{to:?}");
        }
        assert!(!cone.contains([-10.0, 0.0]), "backwards");
        assert_eq!(Cone::around([0.03, 0.03], 0.1), None);
    }
}
