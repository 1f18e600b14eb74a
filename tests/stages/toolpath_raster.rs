//! Beads and sections as pixels: how much of a section is left open, and how much is covered twice.

use pathwright::geometry::{Point, Region, UNITS_PER_MM};
use pathwright::toolpath::{Path, Width, bead};

/// Edge of a pixel.
const PIXEL_MM: f64 = 0.02;

/// By how much two beads may come too near before it counts: two pixels.
const SLACK_MM: f64 = 2.0 * PIXEL_MM;

/// Shares of a section's area.
#[derive(Debug)]
pub struct Coverage {
    /// In no bead.
    pub void: f64,
    /// In two or more beads, taken as wide as what they fill.
    pub double: f64,
    /// Area of beads outside the section.
    pub outside: f64,
}

/// Paints the paths over the section.
pub fn coverage<'a>(section: &Region, paths: impl IntoIterator<Item = &'a Path>) -> Coverage {
    let bounds = section.bounds().expect("a section");
    let origin = [bounds.min, bounds.max].map(|p| p.mm());
    let size = [0, 1].map(|k| ((origin[1][k] - origin[0][k]) / PIXEL_MM) as usize + 100);
    let canvas = Canvas { origin: origin[0].map(|v| v - 50.0 * PIXEL_MM), size };
    let mut covered = vec![false; size[0] * size[1]];
    let mut times = vec![0_u8; size[0] * size[1]];
    for path in paths {
        let mut own = vec![false; size[0] * size[1]];
        let rounding_mm = bead::rounding_mm(path.height_mm);
        for (a, b) in edges(path) {
            canvas.paint(a, b, 0.0, true, &mut covered);
            canvas.paint(a, b, rounding_mm + SLACK_MM, false, &mut own);
        }
        own.iter().zip(&mut times).for_each(|(own, times)| *times += u8::from(*own));
    }
    let inside: Vec<bool> = (0..covered.len()).map(|i| section.contains(canvas.point(i))).collect();
    let count = |f: &dyn Fn(usize) -> bool| (0..covered.len()).filter(|&i| f(i)).count() as f64;
    let area = count(&|i| inside[i]);
    Coverage {
        void: count(&|i| inside[i] && !covered[i]) / area,
        double: count(&|i| inside[i] && times[i] > 1) / area,
        outside: count(&|i| !inside[i] && covered[i]) / area,
    }
}

/// A vertex and the bead's width there.
type Vertex = ([f64; 2], f64);

fn edges(path: &Path) -> impl Iterator<Item = (Vertex, Vertex)> {
    let n = path.points.len();
    let vertex = move |i: usize| {
        let width_mm = match &path.width {
            Width::Constant(width_mm) => *width_mm,
            Width::PerVertex(widths) => f64::from(widths[i]),
        };
        (path.points[i].mm(), width_mm)
    };
    (0..if path.closed { n } else { n - 1 }).map(move |i| (vertex(i), vertex((i + 1) % n)))
}

struct Canvas {
    origin: [f64; 2],
    size: [usize; 2],
}

impl Canvas {
    fn point(&self, i: usize) -> Point {
        let [column, row] = [i % self.size[0], i / self.size[0]];
        let at = [column, row].map(|v| (v as f64 + 0.5) * PIXEL_MM * UNITS_PER_MM);
        let [x, y] = self.origin.map(|v| v * UNITS_PER_MM);
        Point::new((x + at[0]) as i32, (y + at[1]) as i32)
    }

    /// Marks the pixels of a bead's edge, its width less a margin, with round ends or cut straight.
    fn paint(&self, (a, wa): Vertex, (b, wb): Vertex, less_mm: f64, round: bool, pixels: &mut [bool]) {
        let (d, reach) = ([b[0] - a[0], b[1] - a[1]], wa.max(wb) / 2.0);
        let length2 = (d[0] * d[0] + d[1] * d[1]).max(1e-12);
        let range = |k: usize| {
            let low = (a[k].min(b[k]) - reach - self.origin[k]) / PIXEL_MM;
            let high = (a[k].max(b[k]) + reach - self.origin[k]) / PIXEL_MM;
            low.max(0.0) as usize..(high.max(0.0) as usize + 1).min(self.size[k])
        };
        for row in range(1) {
            for column in range(0) {
                let x = self.origin[0] + (column as f64 + 0.5) * PIXEL_MM - a[0];
                let y = self.origin[1] + (row as f64 + 0.5) * PIXEL_MM - a[1];
                let along = (x * d[0] + y * d[1]) / length2;
                if !round && !(0.0..=1.0).contains(&along) {
                    continue;
                }
                let t = along.clamp(0.0, 1.0);
                let radius = (wa + t * (wb - wa) - less_mm) / 2.0;
                if (x - t * d[0]).hypot(y - t * d[1]) <= radius {
                    pixels[row * self.size[0] + column] = true;
                }
            }
        }
    }
}
