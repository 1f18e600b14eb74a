//! Points at which loops may begin.

use super::{Path, Width};
use geometry::Point;

/// Loops can be begun at least so often, whatever their vertices.
const SPACING_MM: f64 = 1.0;

/// Adds vertices on the long edges of closed paths, so that ordering can begin a loop opposite to where the path
/// before ends: a travel below `retract.min_travel` needs no retraction. They move the outline by no more than rounding
/// does and are dropped again where nothing begins. The first vertex stays the first.
pub(super) fn add(paths: &mut [Path]) {
    let (mut points, mut widths) = (Vec::new(), Vec::new());
    for path in paths.iter_mut().filter(|path| path.closed) {
        points.clear();
        widths.clear();
        for (i, &a) in path.points.iter().enumerate() {
            let b = path.points[(i + 1) % path.points.len()];
            points.push(a);
            let parts = (a.distance_mm(b) / SPACING_MM).ceil();
            let between = |part: f64| {
                let along = |a: i32, b: i32| f64::from(a) + (f64::from(b) - f64::from(a)) * part / parts;
                Point::new(along(a.x, b.x).round() as i32, along(a.y, b.y).round() as i32)
            };
            points.extend((1..parts as u32).map(|part| between(f64::from(part))));
            if let Width::PerVertex(at) = &path.width {
                let (from, to) = (at[i], at[(i + 1) % at.len()]);
                widths.extend(
                    (0..points.len() - widths.len())
                        .map(|k| from + (to - from) * k as f32 / parts.max(1.0) as f32),
                );
            }
        }
        path.points.clone_from(&points);
        if let Width::PerVertex(at) = &mut path.width {
            at.clone_from(&widths);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{IslandId, Phase, Role};
    use super::*;

    #[test]
    fn a_square_can_be_begun_at_every_millimetre() {
        let corners = [(0.0, 0.0), (10.0, 0.0), (10.0, 9.6), (0.0, 9.6)];
        let mut paths = [Path {
            role: Role::Perimeter,
            closed: true,
            points: corners.map(|(x, y)| Point::from_mm(x, y)).to_vec(),
            width: Width::Constant(0.45),
            height_mm: 0.2,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        }];
        add(&mut paths);
        let points = &paths[0].points;
        assert_eq!((points.len(), points[0]), (40, Point::new(0, 0)));
        assert!(corners.iter().all(|&(x, y)| points.contains(&Point::from_mm(x, y))));
        assert!(points.windows(2).all(|p| p[0].distance_mm(p[1]) <= SPACING_MM + 1e-4));
    }
}
