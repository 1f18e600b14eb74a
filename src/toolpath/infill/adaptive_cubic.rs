//! Cubes that stand on a corner, small near the surface of the part and twice, four times … as large further inside.
//!
//! An octree of cubes: one that the surface comes into is divided by its three middle planes, and so are its parts, down
//! to the finest. The planes are printed where the layer cuts them. Every plane ends on those of a larger cube around it,
//! so no bead ends in the air. The finest cubes are those of [`Cubic`](super::cubic::Cubic) at the requested density.
//!
//! Octrees: D. Meagher, "Geometric modeling using octree encoding", Computer Graphics and Image Processing 19 (1982),
//! DOI 10.1016/0146-664X(82)90104-6. Cubes on a corner as infill whose walls need no support: J. Wu, C. C. L. Wang,
//! X. Zhang, R. Westermann, "Self-supporting rhombic infill structures for additive manufacturing", Computer-Aided Design
//! 80 (2016), DOI 10.1016/j.cad.2016.07.006.

use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};

use geometry::real;
use geometry::{Clipper, Point, Region};

use super::super::bead::Line;
use super::connect::connect;
use super::pattern::FillPattern;
use super::spec::Chord;
use super::spec::FillSpec;

/// Halvings from the cube around everything to the finest that are divided: those are at least 1.9 mm wide, it spans
/// 62 m.
const LEVELS: u32 = 15;

/// The corner of the bed is the middle of the cube around everything, this many of the finest ones from its corner.
const MIDDLE: f64 = (1_u32 << (LEVELS - 1)) as f64;

/// The surface is felt this far around it, in sides of the finest divided cubes: everything nearer is fine.
const NEAR: f64 = 0.5;

/// Distance of the finest planes in mean line distances: each of the three sets has a third of the lines, √(3/2) times
/// as far apart in the layer as in space.
const PLANES: f64 = 2.449_489_742_783_178;

/// Parts of a plane this near to each other are one.
const TOUCHING_MM: f64 = 1e-6;

/// A cube by its position among those of its level, along the three axes.
type Cube = [i32; 3];

/// See the module. The default knows of no surface and has no cubes.
#[derive(Debug, Default)]
pub struct AdaptiveCubic {
    /// Edges of the cubes as unit vectors of the bed.
    axes: [[f64; 3]; 3],
    /// Side of the finest divided cubes in millimetres.
    finest_mm: f64,
    /// The divided cubes of each level, finest first, by the sum of their places, which is their height.
    levels: Vec<Vec<Cube>>,
}

impl AdaptiveCubic {
    /// Cubes for a surface: triangles in the bed's coordinates, in millimetres. `line_distance_mm` is the mean distance of
    /// beads where the cubes are finest, `angle_rad` the direction of one set of lines.
    pub fn new(surface: impl Iterator<Item = [[f64; 3]; 3]>, line_distance_mm: f64, angle_rad: f64) -> Self {
        let (upright, level) = (1.0 / 3.0_f64.sqrt(), (2.0 / 3.0_f64).sqrt());
        let axes = [0.0, 1.0, 2.0].map(|k| {
            let (sin, cos) = real::sin_cos(angle_rad + FRAC_PI_2 + k * TAU / 3.0);
            [level * cos, level * sin, upright]
        });
        let mut cubes = Self { axes, finest_mm: 2.0 * PLANES * line_distance_mm, levels: Vec::new() };
        let mut finest: Vec<Cube> = Vec::new();
        for triangle in surface {
            let corners =
                triangle.map(|corner| cubes.axes.map(|axis| MIDDLE + dot(axis, corner) / cubes.finest_mm));
            Facet::new(corners).mark(&mut finest);
        }
        for _ in 0..=LEVELS {
            finest.sort_unstable_by_key(|cube| (height(cube), *cube));
            finest.dedup();
            let coarser = finest.iter().map(|cube| cube.map(|index| index >> 1)).collect();
            cubes.levels.push(std::mem::replace(&mut finest, coarser));
        }
        cubes
    }

    /// Where the planes at right angles to an axis meet a height: for each plane, by its number, parts of a line from one
    /// difference of the other two coordinates to another.
    fn traces(&self, axis: usize, z_mm: f64) -> Vec<(i64, [f64; 2])> {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        let mut traces = Vec::new();
        for (level, cubes) in self.levels.iter().enumerate() {
            let side_mm = self.finest_mm * f64::from(1_u32 << level);
            // Where the sum of the coordinates is, from the lowest corner of a cube whose places sum up to 0.
            let sum = (z_mm * 3.0_f64.sqrt() + 3.0 * MIDDLE * self.finest_mm) / side_mm;
            let from = cubes.partition_point(|cube| f64::from(height(cube)) + 2.5 <= sum);
            let cut = cubes[from..].iter().take_while(|cube| f64::from(height(cube)) + 0.5 < sum);
            for cube in cut {
                // The middle plane is a square with coordinates α and β from 0 to 1, cut where they sum up to this.
                let rest = sum - f64::from(height(cube)) - 0.5;
                let alpha = [(rest - 1.0).max(0.0), rest.min(1.0)];
                let base = f64::from(cube[i]) - f64::from(cube[j]);
                let number = (2 * i64::from(cube[axis]) + 1) << level;
                traces.push((number, alpha.map(|alpha| side_mm * (base + 2.0 * alpha - rest))));
            }
        }
        traces.sort_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
        traces.dedup_by(|next, last| {
            let joins = next.0 == last.0 && next.1[0] <= last.1[1] + TOUCHING_MM;
            if joins {
                last.1[1] = last.1[1].max(next.1[1]);
            }
            joins
        });
        traces
    }

    /// The part of a plane's trace within a disc of the bed.
    fn within(
        &self,
        disc: &Disc,
        axis: usize,
        (number, ends): (i64, [f64; 2]),
        z_mm: f64,
    ) -> Option<[Point; 2]> {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        let [x, y] = disc.middle;
        let middle = self.axes[i][0] * x + self.axes[i][1] * y - self.axes[j][0] * x - self.axes[j][1] * y;
        let [mx, my] = self.place_mm(axis, number, middle, z_mm);
        // Along the trace the difference changes by √2 in a millimetre.
        let reach = SQRT_2 * disc.radius_mm;
        let ends = [ends[0].max(middle - reach), ends[1].min(middle + reach)];
        let crosses = real::hypot(mx - x, my - y) < disc.radius_mm && ends[0] < ends[1];
        crosses.then(|| {
            ends.map(|difference_mm| {
                let [x, y] = self.place_mm(axis, number, difference_mm, z_mm);
                Point::from_mm(x, y)
            })
        })
    }

    /// The position on the bed of a point of a plane.
    fn place_mm(&self, axis: usize, number: i64, difference_mm: f64, z_mm: f64) -> [f64; 2] {
        let along_mm = (number as f64 / 2.0 - MIDDLE) * self.finest_mm;
        let sum_mm = z_mm * 3.0_f64.sqrt() - along_mm;
        let mut at = [along_mm; 3];
        at[(axis + 1) % 3] = (sum_mm + difference_mm) / 2.0;
        at[(axis + 2) % 3] = (sum_mm - difference_mm) / 2.0;
        [0, 1].map(|k| (0..3).map(|a| at[a] * self.axes[a][k]).sum())
    }
}

impl FillPattern for AdaptiveCubic {
    fn fill(&self, region: &Region, spec: &FillSpec) -> Vec<Line> {
        let Some(disc) = Disc::around(region) else {
            return Vec::new();
        };
        let clipper = Clipper::new(region);
        let mut chords = Vec::new();
        for axis in 0..3 {
            for trace in self.traces(axis, spec.z_mm) {
                let number = trace.0;
                let Some(trace) = self.within(&disc, axis, trace, spec.z_mm) else { continue };
                chords.extend(clipper.clip(&trace).into_iter().map(|piece| Chord {
                    points: piece.points,
                    ends: piece.ends,
                    line: 3 * number + axis as i64,
                }));
            }
        }
        connect(region, chords, &spec.joins)
    }

    fn is_uniform(&self) -> bool {
        false
    }
}

/// A circle around a region.
struct Disc {
    middle: [f64; 2],
    radius_mm: f64,
}

impl Disc {
    fn around(region: &Region) -> Option<Self> {
        let bounds = region.bounds()?;
        let ([x0, y0], [x1, y1]) = (bounds.min.mm(), bounds.max.mm());
        Some(Self {
            middle: [x0.midpoint(x1), y0.midpoint(y1)],
            radius_mm: real::hypot(x1 - x0, y1 - y0) / 2.0 + 1.0,
        })
    }
}

/// Height of a cube among those of its level.
fn height(cube: &Cube) -> i32 {
    cube.iter().sum()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// A triangle of the surface, its corners in sides of the finest divided cubes.
struct Facet {
    low: [f64; 3],
    high: [f64; 3],
    normal: [f64; 3],
    corner: [f64; 3],
}

impl Facet {
    fn new(corners: [[f64; 3]; 3]) -> Self {
        let [a, b, c] = corners;
        let bound = |pick: fn(f64, f64) -> f64| [0, 1, 2].map(|i| pick(pick(a[i], b[i]), c[i]));
        let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let normal = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            u[j] * v[k] - u[k] * v[j]
        });
        Self {
            low: bound(f64::min).map(|v| v - NEAR),
            high: bound(f64::max).map(|v| v + NEAR),
            normal,
            corner: a,
        }
    }

    /// Adds the finest cubes near it.
    fn mark(&self, cubes: &mut Vec<Cube>) {
        let [low, high] = [self.low, self.high].map(|corner| corner.map(|v| v.floor() as i32));
        let level = (0..32).find(|&level| (0..3).all(|i| low[i] >> level == high[i] >> level));
        if let Some(level) = level {
            self.mark_in(low.map(|index| index >> level), level, cubes);
        }
    }

    fn mark_in(&self, cube: Cube, level: u32, cubes: &mut Vec<Cube>) {
        if !self.is_near(cube, level) {
            return;
        }
        if level > 0 {
            let parts = (0..8).map(|part| [0, 1, 2].map(|i| 2 * cube[i] + (part >> i & 1)));
            parts.for_each(|part| self.mark_in(part, level - 1, cubes));
        } else if cubes.last() != Some(&cube) {
            cubes.push(cube);
        }
    }

    /// Whether a cube, grown by [`NEAR`], meets the box around the triangle and the plane through it: every cube near the
    /// triangle does, and a few more beside its edges.
    fn is_near(&self, cube: Cube, level: u32) -> bool {
        let side = f64::from(1_u32 << level);
        let from = cube.map(|index| f64::from(index) * side);
        let boxed = (0..3).all(|i| from[i] <= self.high[i] && from[i] + side >= self.low[i]);
        let middle = [0, 1, 2].map(|i| from[i] + side / 2.0 - self.corner[i]);
        let reach = (side / 2.0 + NEAR) * self.normal.iter().map(|v| v.abs()).sum::<f64>();
        boxed && dot(middle, self.normal).abs() <= reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::infill::{Joins, cubic::Cubic};
    use geometry::{Polygon, polyline_length_mm, to_segment_mm};

    fn square(side_mm: f64) -> Region {
        let corners = [(0.0, 0.0), (side_mm, 0.0), (side_mm, side_mm), (0.0, side_mm)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    fn spec(z_mm: f64) -> FillSpec {
        let joins = Joins::default();
        FillSpec { line_distance_mm: 2.0, spacing_mm: 0.4, angle_rad: 0.0, layer: 0, z_mm, joins }
    }

    fn length_mm(lines: &[Line]) -> f64 {
        lines.iter().map(|line| polyline_length_mm(&line.points)).sum()
    }

    /// A level square of two triangles, 60 mm wide.
    fn floor(z: f64) -> [[[f64; 3]; 3]; 2] {
        let [a, b, c, d] = [[0.0, 0.0, z], [60.0, 0.0, z], [60.0, 60.0, z], [0.0, 60.0, z]];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn at_the_surface_it_is_cubic_infill_and_further_away_half_and_a_quarter_of_it() {
        let region = square(60.0);
        let adaptive = AdaptiveCubic::new(floor(50.0).into_iter(), 2.0, 0.0);
        let share = |z_mm: f64| {
            let of = |pattern: &dyn FillPattern| length_mm(&pattern.fill(&region, &spec(z_mm)));
            of(&adaptive) / of(&Cubic)
        };
        let mean = |from: i32| (from..from + 8).map(|z| share(f64::from(z))).sum::<f64>() / 8.0;
        assert!((mean(46) - 1.0).abs() < 0.02, "{}", mean(46));
        assert!(mean(30) < 0.8 && mean(0) < 0.45 && mean(0) > 0.05, "{} {}", mean(30), mean(0));
    }

    #[test]
    fn no_line_ends_in_the_air() {
        let region = square(60.0);
        let adaptive = AdaptiveCubic::new(floor(50.0).into_iter(), 2.0, 0.3);
        for z_mm in [3.0, 17.0, 29.0, 41.0, 48.0] {
            let lines = adaptive.fill(&region, &spec(z_mm));
            for (own, line) in lines.iter().enumerate() {
                for end in [line.points[0], line.points[line.points.len() - 1]] {
                    let [x, y] = end.mm();
                    let at_wall = x.min(y).min(60.0 - x).min(60.0 - y) < 1e-3;
                    let others = lines.iter().enumerate().filter(|(i, _)| *i != own);
                    let mut edges = others.flat_map(|(_, line)| line.points.windows(2));
                    let held = edges.any(|e| to_segment_mm([x, y], e[0].mm(), e[1].mm()) < 1e-3);
                    assert!(at_wall || held, "{x} {y} at {z_mm}");
                }
            }
        }
    }
}
