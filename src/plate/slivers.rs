//! Shells too thin for a line: they do not say where a model stands.

use crate::mesh::{Mesh, NO_TWIN, facet_measures};
use geometry::DisjointSets;

/// The thinnest line that is printed; thinner parts of a model are ignored in positioning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Width, millimetres.
    pub width_mm: f64,
    /// Height of a layer, millimetres.
    pub height_mm: f64,
}

/// The measures of a shell.
#[derive(Clone, Copy)]
struct Shell {
    min: [f64; 3],
    max: [f64; 3],
    volume_mm3: f64,
    /// Surface seen from the side.
    side_mm2: f64,
}

impl Shell {
    /// Whether there is room in it for a line. The mean width of its sections is twice its volume by its side.
    fn holds(&self, line: Line) -> bool {
        let height_mm = self.max[2] - self.min[2];
        let volume_mm3 = self.volume_mm3.abs();
        height_mm >= line.height_mm / 2.0
            && 2.0 * volume_mm3 >= line.width_mm * self.side_mm2
            && volume_mm3 >= line.width_mm * line.width_mm * line.height_mm
    }
}

/// The box around the shells that hold a line; around all, if none does. O(triangles).
pub(super) fn printable_bounds(mesh: &Mesh, line: Line) -> [[f64; 3]; 2] {
    let mut parts = DisjointSets::new(mesh.triangles().len());
    // Open patches may make up a body together: they count as one shell.
    let mut open = None;
    for (half, &twin) in mesh.twins().iter().enumerate() {
        let triangle = half as u32 / 3;
        if twin == NO_TWIN {
            parts.join(triangle, *open.get_or_insert(triangle));
        } else if (half as u32) < twin {
            parts.join(triangle, twin / 3);
        }
    }
    let (shell_of, count) = parts.number();
    let nothing =
        Shell { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3], volume_mm3: 0.0, side_mm2: 0.0 };
    let mut shells = vec![nothing; count];
    for (triangle, &shell) in mesh.triangles().iter().zip(&shell_of) {
        let shell = &mut shells[shell as usize];
        for corner in triangle.map(|v| mesh.vertices()[v as usize]) {
            shell.min = std::array::from_fn(|i| shell.min[i].min(corner[i]));
            shell.max = std::array::from_fn(|i| shell.max[i].max(corner[i]));
        }
    }
    for (triangle, &shell) in mesh.triangles().iter().zip(&shell_of) {
        let shell = &mut shells[shell as usize];
        let middle = [0, 1, 2].map(|i| (shell.min[i] + shell.max[i]) / 2.0);
        let corners = triangle.map(|v| mesh.vertices()[v as usize]);
        let (volume_mm3, area_mm2) = facet_measures(corners, middle);
        let [a, b, c] = corners;
        let level_mm2 = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0;
        shell.volume_mm3 += volume_mm3;
        shell.side_mm2 += (area_mm2 * area_mm2 - level_mm2 * level_mm2).max(0.0).sqrt();
    }
    let counted = shells.iter().filter(|shell| shell.holds(line)).map(|shell| [shell.min, shell.max]);
    let joined = counted.reduce(|[low, high], [min, max]| {
        [[0, 1, 2].map(|i| low[i].min(min[i])), [0, 1, 2].map(|i| high[i].max(max[i]))]
    });
    joined.unwrap_or_else(|| mesh.bounds())
}
