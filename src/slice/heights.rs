//! Layers of different heights: after the surface, or after a table.
//!
//! The stairs that layers make of a slope leave it by at most their height times |n_z|, the vertical part of the
//! surface's unit normal: the *cusp height* of Dolenc & Mäkelä, Slicing procedures for layered manufacturing techniques,
//! 1994, <https://doi.org/10.1016/0010-4485(94)90032-9>. A layer is made as high as a limit on it allows over all facets
//! that it meets. Level facets, which have no stairs, are where layers end, if that makes none too thin.

use super::plan::{LayerSpan, NOISE_MM, plan};
use crate::mesh::Mesh;
use crate::plate::Plate;
use crate::slice::{LayerSettings, layer_heights};

/// The surface is looked at in slices of this height, and layers end on whole ones but for level surfaces.
const CELL_MM: f64 = 0.01;

/// Facets whose normal is this near to the vertical are level.
const LEVEL: f64 = 0.9999;

/// Facets that cover less of the bed than this, in square millimetres, are noise of the mesh.
const CRUMB_MM2: f64 = 1e-4;

/// Layers shorter than this share of what a table says are not made where it changes.
const SHORTEST: f64 = 0.5;

/// Whether all layers but the first have one height.
pub fn is_uniform(settings: &LayerSettings) -> bool {
    !settings.adaptive && settings.heights.trim().is_empty()
}

/// The heights of layers as numbers of layers are counted by them: where they are uniform, the usual one also for the
/// first layer.
pub fn heights_mm(spans: &[LayerSpan], settings: &LayerSettings) -> Vec<f64> {
    let uniform = is_uniform(settings);
    spans.iter().map(|span| if uniform { settings.height.0 } else { span.height_mm }).collect()
}

/// How far stairs may leave the surface, in millimetres: from the greatest height, which any slope then may have, to the
/// least.
pub fn cusp_limit_mm(settings: &LayerSettings) -> f64 {
    let (least_mm, most_mm) = (settings.min_height.0, settings.max_height.0);
    most_mm - settings.quality.0 * (most_mm - least_mm)
}

/// Where the layers of a plate lie.
pub fn spans(plate: &Plate, settings: &LayerSettings) -> Vec<LayerSpan> {
    let height_mm = plate.meshes.iter().map(|m| m.bounds()[1][2]).fold(0.0, f64::max);
    if settings.adaptive {
        let surface = Surface::of(&plate.meshes, height_mm, settings);
        return stacked(height_mm, settings.first_height.0, |bottom_mm| surface.next_mm(bottom_mm));
    }
    // The profile has checked the table.
    match layer_heights(&settings.heights).unwrap_or_default().as_slice() {
        [] => plan(height_mm, settings),
        table => stacked(height_mm, settings.first_height.0, |bottom_mm| {
            tabled_mm(table, settings.height.0, bottom_mm)
        }),
    }
}

/// Layers on top of each other, each as high as `next_mm` says of where it begins, as long as their middle is inside.
fn stacked(height_mm: f64, first_mm: f64, next_mm: impl Fn(f64) -> f64) -> Vec<LayerSpan> {
    let mut spans: Vec<LayerSpan> = Vec::new();
    let mut bottom_mm = 0.0;
    loop {
        let layer_mm = if spans.is_empty() { first_mm } else { next_mm(bottom_mm) };
        // Tops are written with three digits, so that nothing is rounded later.
        let top_mm = ((bottom_mm + layer_mm) * 1e3).round() / 1e3;
        let cut_mm = (bottom_mm + top_mm) / 2.0;
        let goes_on = top_mm > bottom_mm && cut_mm < height_mm - NOISE_MM;
        if !goes_on {
            return spans;
        }
        let (index, height_mm) = (spans.len(), top_mm - bottom_mm);
        spans.push(LayerSpan { index, bottom_mm, top_mm, height_mm, cut_mm });
        bottom_mm = top_mm;
    }
}

/// The height that a table, by rising `z`, has at the bottom of a layer; one more layer ends where the next line begins
/// unless it would be thin.
fn tabled_mm(table: &[[f64; 2]], usual_mm: f64, bottom_mm: f64) -> f64 {
    let begun = table.iter().rev().find(|[from_mm, _]| *from_mm <= bottom_mm + NOISE_MM);
    let layer_mm = begun.map_or(usual_mm, |line| line[1]);
    let left_mm = table.iter().map(|line| line[0] - bottom_mm).find(|left_mm| *left_mm > NOISE_MM);
    match left_mm {
        Some(left_mm) if left_mm < layer_mm && left_mm >= SHORTEST * layer_mm => left_mm,
        _ => layer_mm,
    }
}

/// The slope of the surface at every height.
struct Surface {
    /// Greatest |n_z| in each slice, of facets that are steeper than level ones.
    slopes: Vec<f32>,
    /// Heights of level facets, rising.
    levels_mm: Vec<f64>,
    limit_mm: f64,
    least_mm: f64,
    most_mm: f64,
}

impl Surface {
    fn of(meshes: &[Mesh], height_mm: f64, settings: &LayerSettings) -> Self {
        let (least_mm, most_mm) = (settings.min_height.0, settings.max_height.0.max(settings.min_height.0));
        let limit_mm = cusp_limit_mm(settings).max(least_mm);
        let cells = (height_mm.max(0.0) / CELL_MM) as usize + 2;
        let (mut slopes, mut levels_mm) = (vec![0.0_f32; cells], Vec::new());
        for mesh in meshes {
            for triangle in mesh.triangles() {
                let corners = triangle.map(|v| mesh.vertices()[v as usize]);
                let Some(slope) = slope(&corners) else { continue };
                let [low, high] =
                    [f64::min, f64::max].map(|f| corners.iter().map(|c| c[2]).reduce(f).unwrap_or_default());
                if slope >= LEVEL {
                    levels_mm.push(high);
                } else if slope * most_mm > limit_mm {
                    // Facets that only touch a slice do not meet it.
                    let cell = |z: f64| ((z.max(0.0) / CELL_MM) as usize).min(cells - 1);
                    for own in
                        &mut slopes[cell(low + NOISE_MM)..=cell(high - NOISE_MM).max(cell(low + NOISE_MM))]
                    {
                        *own = own.max(slope as f32);
                    }
                }
            }
        }
        levels_mm.sort_unstable_by(f64::total_cmp);
        levels_mm.dedup();
        Self { slopes, levels_mm, limit_mm, least_mm, most_mm }
    }

    /// Height of the layer that begins here.
    fn next_mm(&self, bottom_mm: f64) -> f64 {
        let first = ((bottom_mm + NOISE_MM) / CELL_MM) as usize;
        let mut layer_mm = self.most_mm;
        for (cell, &slope) in self.slopes.iter().enumerate().skip(first) {
            let below_mm = cell as f64 * CELL_MM - bottom_mm;
            if below_mm >= layer_mm {
                break;
            }
            if slope > 0.0 {
                // It may end where the slope begins.
                layer_mm = layer_mm.min((self.limit_mm / f64::from(slope)).max(below_mm));
            }
        }
        // Whole slices, but for the rounding of their number.
        let whole = |mm: f64| ((bottom_mm + mm) / CELL_MM + 1e-6).floor() * CELL_MM - bottom_mm;
        let layer_mm = whole(layer_mm).max(self.least_mm);
        self.to_level(bottom_mm, layer_mm)
    }

    /// A layer that would pass a level surface ends there; one that would leave too little for the next is shortened.
    fn to_level(&self, bottom_mm: f64, layer_mm: f64) -> f64 {
        let next = self.levels_mm.partition_point(|z| *z < bottom_mm + self.least_mm - NOISE_MM);
        let Some(left_mm) = self.levels_mm.get(next).map(|z| z - bottom_mm) else { return layer_mm };
        if left_mm <= layer_mm {
            left_mm
        } else if left_mm < layer_mm + self.least_mm && left_mm >= 2.0 * self.least_mm {
            left_mm - self.least_mm
        } else {
            layer_mm
        }
    }
}

/// |n_z| of a facet; `None`: it covers next to nothing.
fn slope([a, b, c]: &[[f64; 3]; 3]) -> Option<f64> {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|i| p[i] - a[i]));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
    (0.5 * normal[2].abs() >= CRUMB_MM2).then(|| normal[2].abs() / length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Mm, Ratio};

    fn adaptive(quality: f64) -> LayerSettings {
        LayerSettings {
            adaptive: true,
            quality: Ratio(quality),
            min_height: Mm(0.08),
            max_height: Mm(0.3),
            ..LayerSettings::default()
        }
    }

    /// A ball of facets, its lowest point on the bed.
    fn ball(radius_mm: f64) -> Plate {
        const N: u32 = 48;
        let ring = |i: u32| std::f64::consts::PI * f64::from(i) / f64::from(N);
        let at = |i: u32, k: u32| {
            let (theta, phi) = (ring(i), 2.0 * ring(k % N));
            let (r, z) = (radius_mm * theta.sin(), radius_mm * (1.0 - theta.cos()));
            [100.0 + r * phi.cos(), 100.0 + r * phi.sin(), z]
        };
        let vertices = (0..=N).flat_map(|i| (0..N).map(move |k| at(i, k))).collect();
        let quad = |i: u32, k: u32| {
            let [a, b, c, d] = [i * N + k, i * N + (k + 1) % N, (i + 1) * N + (k + 1) % N, (i + 1) * N + k];
            [[a, c, b], [a, d, c]]
        };
        let triangles = (0..N).flat_map(|i| (0..N).flat_map(move |k| quad(i, k))).collect();
        Plate { meshes: vec![Mesh::new(vertices, triangles)], objects: Vec::new(), notes: Vec::new() }
    }

    fn of_box(height_mm: f64) -> Surface {
        let settings = adaptive(0.5);
        Surface {
            slopes: vec![0.0; (height_mm / CELL_MM) as usize + 2],
            levels_mm: vec![0.0, height_mm],
            limit_mm: cusp_limit_mm(&settings),
            least_mm: 0.08,
            most_mm: 0.3,
        }
    }

    #[test]
    fn stairs_stay_below_the_limit_and_heights_within_theirs() {
        let plate = ball(10.0);
        for quality in [0.0, 0.5, 1.0] {
            let settings = adaptive(quality);
            let spans = spans(&plate, &settings);
            let limit_mm = cusp_limit_mm(&settings);
            let mesh = &plate.meshes[0];
            for triangle in mesh.triangles() {
                let corners = triangle.map(|v| mesh.vertices()[v as usize]);
                let Some(slope) = slope(&corners).filter(|s| *s < LEVEL) else { continue };
                let low = corners.iter().map(|c| c[2]).fold(f64::INFINITY, f64::min);
                let high = corners.iter().map(|c| c[2]).fold(0.0, f64::max);
                for span in &spans[1..] {
                    if span.top_mm > low + 0.001 && span.bottom_mm < high - 0.001 {
                        let cusp_mm = span.height_mm * slope;
                        assert!(cusp_mm <= limit_mm + 1e-6 || span.height_mm < 0.0801, "{cusp_mm} {span:?}");
                    }
                }
            }
            assert!(spans[1..].iter().all(|s| (0.0799..=0.3001).contains(&s.height_mm)), "{spans:?}");
            assert!(spans.windows(2).all(|w| w[0].top_mm == w[1].bottom_mm));
        }
    }

    #[test]
    fn a_higher_quality_makes_more_layers() {
        let counts: Vec<usize> =
            [0.0, 0.3, 0.6, 1.0].iter().map(|q| spans(&ball(10.0), &adaptive(*q)).len()).collect();
        assert!(counts.windows(2).all(|w| w[0] < w[1]), "{counts:?}");
        assert_eq!(counts[0], 67, "at 0 all but the first and the last are as high as may be");
    }

    #[test]
    fn between_upright_walls_layers_are_as_high_as_may_be_and_end_at_the_top() {
        let surface = of_box(10.0);
        let spans = stacked(10.0, 0.2, |z| surface.next_mm(z));
        let low: Vec<f64> = spans[1..].iter().map(|s| s.height_mm).filter(|h| *h < 0.2999).collect();
        assert!(low.len() <= 2, "{low:?}");
        assert!((spans.last().unwrap().top_mm - 10.0).abs() < 1e-6);
    }

    #[test]
    fn a_table_holds_from_its_heights_on() {
        let table = [[2.0, 0.1], [4.0, 0.3]];
        let spans = stacked(6.0, 0.3, |z| tabled_mm(&table, 0.2, z));
        for span in &spans[1..] {
            let expected =
                [0.2, 0.1, 0.3][usize::from(span.bottom_mm > 1.999) + usize::from(span.bottom_mm > 3.999)];
            let shorter = span.height_mm < expected && (span.top_mm - 2.0).abs() < 1e-9;
            assert!((span.height_mm - expected).abs() < 1e-9 || shorter, "{span:?}");
        }
        assert!(spans.iter().any(|s| (s.top_mm - 2.0).abs() < 1e-9), "a layer ends where the table changes");
    }
}
