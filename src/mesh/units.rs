//! Sizes that are rarely meant, and the unit that they come from.

use std::path::Path;

use geometry::real;
use serde::Serialize;

use super::error::MeshError;
use super::measure::extend;
use super::surface::Mesh;
use super::transform::Transform;
use super::weld::{FARTHEST, LIMIT_MM};

/// Units of models by their names, with the factor that makes them millimetres.
pub const UNITS: [(&str, f64); 5] = [("mm", 1.0), ("inch", 25.4), ("m", 1000.0), ("cm", 10.0), ("um", 1e-3)];

/// A unit that a model was probably made in, as its size says.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UnitHint {
    /// The unit, as `--unit` takes it: `inch`, `m`, `cm` or `um`.
    pub unit: &'static str,
    /// The same in words: `inches`.
    pub words: &'static str,
    /// What makes it millimetres.
    pub factor: f64,
}

const fn foreign(unit: &'static str, words: &'static str, factor: f64) -> UnitHint {
    UnitHint { unit, words, factor }
}

/// Units that programs export in.
const FOREIGN: [UnitHint; 4] = [
    foreign("inch", "inches", 25.4),
    foreign("m", "metres", 1000.0),
    foreign("cm", "centimetres", 10.0),
    foreign("um", "micrometres", 1e-3),
];

/// The length of most parts, on a logarithmic scale, mm.
const USUAL_MM: f64 = 50.0;
/// Longest sides that are rarely meant: below and above.
const RARE_MM: [f64; 2] = [1.0, 2000.0];
/// A part is rarely so short in all directions. An M3 nut is 6.4 mm long, a 5 mm cube is 5.
const SHORT_MM: f64 = 4.5;
/// Nor has it so little volume, unless it is slender. PrusaSlicer takes what is smaller for inches.
const LITTLE_MM3: f64 = 9.0;
const SLENDER_MM: f64 = 12.0;
/// Or a sheet.
const THIN_MM: f64 = 0.2;

impl UnitHint {
    /// The unit that a model of this size was probably made in; `None` if it is millimetres.
    pub fn of(size_mm: [f64; 3], volume_mm3: f64) -> Option<Self> {
        let longest_mm = size_mm.into_iter().fold(0.0, f64::max);
        if longest_mm == 0.0 {
            return None;
        }
        if (RARE_MM[0]..=RARE_MM[1]).contains(&longest_mm) {
            let thinnest_mm = size_mm.into_iter().fold(f64::INFINITY, f64::min);
            let little = volume_mm3.abs() < LITTLE_MM3 && longest_mm < SLENDER_MM && thinnest_mm > THIN_MM;
            let tiny = longest_mm < SHORT_MM || little;
            return tiny.then_some(FOREIGN[0]);
        }
        let distance = |unit: &Self| real::ln(longest_mm * unit.factor / USUAL_MM).abs();
        FOREIGN.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// The size of a model that was scaled by `scale`, the unit and the option that mends it.
    pub fn told(&self, size_mm: [f64; 3], scale: [f64; 3]) -> String {
        let Self { unit, words, factor } = self;
        let option = match scale {
            [1.0, 1.0, 1.0] => format!("use --unit {unit}"),
            [x, y, z] if x == y && y == z => format!("use --scale {}", x * factor),
            _ => format!("scale it {factor} times as much"),
        };
        format!("it is {}; if it was made in {words}, {option}", in_words(size_mm))
    }
}

/// A size, with as many decimals as it takes.
pub(super) fn in_words(size_mm: [f64; 3]) -> String {
    let decimals = if size_mm.into_iter().fold(0.0, f64::max) < 1.0 { 4 } else { 2 };
    let [x, y, z] = size_mm;
    format!("{x:.decimals$} × {y:.decimals$} × {z:.decimals$} mm")
}

/// Extents of the points that have a position; `None`: none has.
pub(super) fn size_of(points: impl Iterator<Item = [f32; 3]>) -> Option<[f64; 3]> {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for p in points.filter(|p| p.iter().all(|x| x.abs() <= FARTHEST)) {
        extend(&mut low, &mut high, p);
    }
    (low[0] <= high[0]).then(|| [0, 1, 2].map(|i| f64::from(high[i]) - f64::from(low[i])))
}

/// A mesh that can be transformed and cut: where it lies far away it is brought to the origin. Returns it with where it was.
///
/// # Errors
/// Scaled, it is longer than 10 m.
pub(crate) fn moved_near_origin(
    path: &Path,
    mut mesh: Mesh,
    transform: &Transform,
) -> Result<(Mesh, [f64; 3]), MeshError> {
    let limit_mm = f64::from(LIMIT_MM);
    let [min, max] = mesh.bounds();
    let reach_mm =
        |point: [f64; 3]| (0..3).map(|i| (point[i] * transform.scale[i]).powi(2)).sum::<f64>().sqrt();
    if reach_mm(min).max(reach_mm(max)) * 2.0 <= limit_mm {
        return Ok((mesh, [0.0; 3]));
    }
    if reach_mm([0, 1, 2].map(|i| max[i] - min[i])) > limit_mm {
        return Err(too_large(path, &mesh, transform.scale));
    }
    let middle = [0, 1, 2].map(|i| (min[i] + max[i]) / 2.0);
    mesh.shift(middle.map(|x| -x));
    Ok((mesh, middle))
}

/// Numbers of 24 bits that are farther apart blur a shape, millimetres.
const BLUR_MM: f64 = 4e-3;

/// The warning about a model so far from the origin that its file's numbers are coarse; `None` if they are not.
pub(crate) fn precision_warning(was_at: [f64; 3]) -> Option<String> {
    let far_mm = was_at.iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    let apart_mm = far_mm * f64::from(f32::EPSILON);
    (apart_mm > BLUR_MM).then(|| {
        format!(
            "it lies {:.0} m from the origin, where coordinates are up to {apart_mm:.3} mm apart; export it at the origin",
            far_mm / 1000.0
        )
    })
}

/// That a mesh is longer than 10 m, or a few of its corners lie far from the others.
pub(super) fn too_large(path: &Path, mesh: &Mesh, scale: [f64; 3]) -> MeshError {
    let path = path.to_path_buf();
    let [min, max] = mesh.bounds();
    let size = [0, 1, 2].map(|i| (max[i] - min[i]) * scale[i].abs());
    if let Some((count, rest)) = stray_vertices(mesh) {
        let rest = [0, 1, 2].map(|i| rest[i] * scale[i].abs());
        return MeshError::Stray { path, count, rest: in_words(rest) };
    }
    let hint = UnitHint::of(size, f64::INFINITY).map(|hint| hint.told(size, scale));
    let hint = hint.unwrap_or_else(|| format!("it is {}", in_words(size)));
    MeshError::TooLong { path, hint }
}

/// Corners far from nearly all others: how many, and the size of the rest.
fn stray_vertices(mesh: &Mesh) -> Option<(usize, [f64; 3])> {
    /// Corners this many times farther from the middle one than three of four are stray, if they are few.
    const FAR: f64 = 100.0;
    let near = [0, 1, 2].map(|axis| {
        let mut values: Vec<f64> = mesh.vertices.iter().map(|v| v[axis]).collect();
        values.sort_by(f64::total_cmp);
        let middle = values[values.len() / 2];
        let mut distances: Vec<f64> = values.iter().map(|x| (x - middle).abs()).collect();
        distances.sort_by(f64::total_cmp);
        (middle, FAR * distances[distances.len() * 3 / 4].max(1.0))
    });
    let is_near = |v: &&[f64; 3]| (0..3).all(|i| (v[i] - near[i].0).abs() <= near[i].1);
    let rest: Vec<&[f64; 3]> = mesh.vertices.iter().filter(is_near).collect();
    let count = mesh.vertices.len() - rest.len();
    let extent = |axis: usize| {
        let values = || rest.iter().map(|v| v[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    (count > 0 && count * 4 <= mesh.vertices.len()).then(|| (count, [0, 1, 2].map(extent)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_parts_are_in_millimetres_and_smaller_ones_in_inches() {
        let unit_of = |size: [f64; 3], share: f64| {
            UnitHint::of(size, share * size.iter().product::<f64>()).map(|hint| hint.words)
        };
        assert_eq!(unit_of([5.5, 6.4, 2.4], 0.6), None, "an M3 nut");
        assert_eq!(unit_of([5.0; 3], 1.0), None, "a cube");
        assert_eq!(unit_of([3.0, 3.0, 10.0], 0.5), None, "a screw");
        assert_eq!(unit_of([0.8, 0.8, 20.0], 1.0), None, "a pin");
        assert_eq!(unit_of([3.6, 2.0, 1.0], 0.5), Some("inches"));
        assert_eq!(unit_of([8.0, 2.0, 0.5], 0.7), Some("inches"));
        assert_eq!(unit_of([0.05; 3], 1.0), Some("metres"));
        assert_eq!(unit_of([30_000.0; 3], 1.0), Some("micrometres"));
    }

    #[test]
    fn far_from_the_origin_numbers_are_coarse() {
        assert_eq!(precision_warning([30_000.0, 0.0, 0.0]), None);
        let said = precision_warning([0.0, -1e6, 0.0]).expect("coarse");
        assert!(said.contains("1000 m from the origin") && said.contains("0.119 mm apart"), "{said}");
    }
}
