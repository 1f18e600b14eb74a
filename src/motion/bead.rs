//! How much a bead holds, and paths as beads: vertices with the cross-section there.

use std::f64::consts::PI;

use crate::toolpath::bead::area_mm2;
use crate::toolpath::{Path, Role, Width};
use geometry::distance_mm;

/// A vertex of a bead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    /// Where it is, millimetres.
    pub at: [f64; 2],
    /// Cross-section here, multipliers included.
    pub area_mm2: f64,
}

impl Vertex {
    /// The vertex at a share of the distance to another; that one from 1 on.
    pub(super) fn towards(self, to: Self, share: f64) -> Self {
        if share >= 1.0 {
            return to;
        }
        Self {
            at: [0, 1].map(|i| self.at[i] + share * (to.at[i] - self.at[i])),
            area_mm2: self.area_mm2 + share * (to.area_mm2 - self.area_mm2),
        }
    }
}

/// Length along vertices.
pub(super) fn length_mm(vertices: &[Vertex]) -> f64 {
    vertices.windows(2).map(|v| distance_mm(v[0].at, v[1].at)).sum()
}

/// Writes the path's vertices, in the order in which they are drawn, over what `out` held. A closed path
/// begins and ends with the same vertex. `entry` as in [`PathVisit`](crate::order::PathVisit).
pub(super) fn trace(path: &Path, entry: u32, flow: f64, out: &mut Vec<Vertex>) {
    out.clear();
    let area = |width_mm: f64| {
        flow * match path.role {
            // A bridge is not pressed onto anything: it stays a round line.
            Role::BridgeInfill => PI / 4.0 * width_mm * width_mm,
            _ => area_mm2(width_mm, path.height_mm),
        }
    };
    let constant = match &path.width {
        Width::Constant(width_mm) => Some(area(*width_mm)),
        Width::PerVertex(_) => None,
    };
    let vertex = |i: usize| {
        let area_mm2 = constant.unwrap_or_else(|| match &path.width {
            Width::Constant(width_mm) => area(*width_mm),
            Width::PerVertex(widths) => {
                area(widths.get(i).or(widths.last()).map_or(path.height_mm, |w| f64::from(*w)))
            }
        });
        Vertex { at: path.points[i].mm(), area_mm2 }
    };
    let n = path.points.len();
    if n == 0 {
        return;
    }
    if path.closed {
        let start = entry as usize % n;
        out.extend((start..n).chain(0..=start).map(vertex));
    } else if entry == 0 {
        out.extend((0..n).map(vertex));
    } else {
        out.extend((0..n).rev().map(vertex));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::{IslandId, Phase};
    use geometry::Point;

    #[test]
    fn beads_laid_at_their_spacing_fill_the_layer() {
        let (width, height) = (0.45, 0.2);
        let spacing = width - height * (1.0 - PI / 4.0);
        assert!((area_mm2(width, height) - spacing * height).abs() < 1e-12);
        assert_eq!(area_mm2(0.01, 0.2), 0.0);
    }

    #[test]
    fn a_loop_is_entered_where_told_and_returns_there() {
        let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)].map(|(x, y)| Point::from_mm(x, y)).to_vec();
        let path = Path {
            role: Role::Perimeter,
            closed: true,
            points,
            width: Width::Constant(0.4),
            height_mm: 0.2,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        };
        let mut out = Vec::new();
        trace(&path, 2, 1.0, &mut out);
        assert_eq!(
            out.iter().map(|v| v.at).collect::<Vec<_>>(),
            [[4.0, 3.0], [0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]
        );
    }
}
