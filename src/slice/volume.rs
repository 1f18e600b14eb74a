//! The volume that is printed: that of the union of all bodies of a mesh.

use super::cutter::Cutter;
use super::options::LayerSettings;
use super::plan::LayerSpan;
use crate::mesh::{Effect, Mesh, NO_TWIN};
use crate::units::Mm;

/// Pieces that the height is divided into, besides those that level facets make.
const PIECES: f64 = 64.0;

/// Of the heights with level facets this many make breaks: those with most of them.
const MOST_BREAKS: usize = 256;

/// Facets whose corners differ by less in height are level, mm.
const LEVEL_MM: f64 = 1e-6;

/// The two points of Gauss's rule, as shares of an interval.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Sums of signed volumes that agree so well with the sections are exact, the sections are not.
const EXACT: f64 = 1e-3;

/// Where more than one edge in this many is open, sections are as much guessed as the signed volume, and take long.
const HOPELESS: usize = 20;

/// Volume that a mesh encloses, mm³: where bodies overlap it counts once, and bodies that are cut out do not count.
///
/// A closed mesh of one shell, or of shells whose boxes are apart, has its signed volume, which is exact. Else areas of
/// sections are integrated, to about 0.1 %. O(triangles), and then some hundred sections.
pub fn volume_mm3(mesh: &Mesh) -> f64 {
    let (signed_mm3, _) = mesh.volume_and_area();
    let open = mesh.twins().iter().filter(|twin| **twin == NO_TWIN).count();
    let closed = mesh.is_oriented() && open == 0;
    if cut_out(mesh).next().is_some() {
        return integrated(mesh);
    }
    if (closed && !boxes_meet(&mut shell_boxes(mesh))) || open * HOPELESS > mesh.twins().len() {
        return signed_mm3;
    }
    let sections_mm3 = integrated(mesh);
    let agree = (sections_mm3 - signed_mm3).abs() <= EXACT * signed_mm3.abs();
    if closed && agree { signed_mm3 } else { sections_mm3 }
}

/// Bodies that are cut out of a mesh.
fn cut_out(mesh: &Mesh) -> impl Iterator<Item = &Mesh> {
    mesh.modifiers().iter().filter(|body| body.effect == Effect::Cut).map(|body| &body.mesh)
}

/// Areas of sections times heights: between level facets, where sections jump, by Gauss's rule.
fn integrated(mesh: &Mesh) -> f64 {
    let [low, high] = mesh.bounds();
    let mut heights: Vec<f64> = std::iter::once(mesh).chain(cut_out(mesh)).flat_map(level_heights).collect();
    heights.retain(|z_mm| (low[2]..=high[2]).contains(z_mm));
    heights.extend([low[2], high[2]]);
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|b, a| *b - *a < LEVEL_MM);
    let longest_mm = (high[2] - low[2]) / PIECES;
    let mut pieces: Vec<[f64; 2]> = Vec::new();
    for part in heights.windows(2) {
        let count = ((part[1] - part[0]) / longest_mm).ceil().max(1.0);
        let step_mm = (part[1] - part[0]) / count;
        pieces.extend((0..count as usize).map(|i| [part[0] + i as f64 * step_mm, step_mm]));
    }
    let cuts = pieces.iter().flat_map(|[from_mm, step_mm]| GAUSS.map(|share| from_mm + share * step_mm));
    let spans: Vec<LayerSpan> = cuts
        .enumerate()
        .map(|(index, cut_mm)| LayerSpan { index, bottom_mm: cut_mm, top_mm: cut_mm, height_mm: 0.0, cut_mm })
        .collect();
    let settings = LayerSettings { resolution: Mm(0.0), closing_radius: Mm(0.0), ..LayerSettings::default() };
    let cutter = Cutter::new(mesh, &spans, &settings);
    let area_mm2 = |cut: usize| cutter.section(cut).0.area_mm2();
    let volumes = pieces.iter().enumerate();
    volumes.map(|(i, [_, step_mm])| step_mm / 2.0 * (area_mm2(2 * i) + area_mm2(2 * i + 1))).sum()
}

/// Heights of level facets, those with the most area.
fn level_heights(mesh: &Mesh) -> Vec<f64> {
    let mut level: Vec<(f64, f64)> = Vec::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|v| mesh.vertices()[v as usize]);
        if spread([a[2], b[2], c[2]]) < LEVEL_MM {
            let twice_mm2 = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            level.push((a[2], twice_mm2.abs()));
        }
    }
    level.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut heights: Vec<(f64, f64)> = Vec::new();
    for (z_mm, area) in level {
        match heights.last_mut().filter(|last| z_mm - last.0 < LEVEL_MM) {
            Some(last) => last.1 += area,
            None => heights.push((z_mm, area)),
        }
    }
    heights.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    heights.into_iter().take(MOST_BREAKS).map(|(z_mm, _)| z_mm).collect()
}

fn spread([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c) - a.min(b).min(c)
}

/// Box around every part connected by edges.
fn shell_boxes(mesh: &Mesh) -> Vec<[[f64; 3]; 2]> {
    let mut seen = vec![false; mesh.triangles().len()];
    let mut boxes = Vec::new();
    let mut next = Vec::new();
    for first in 0..seen.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut around = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        next.push(first);
        while let Some(t) = next.pop() {
            for v in mesh.triangles()[t] {
                let at = mesh.vertices()[v as usize];
                for i in 0..3 {
                    around[0][i] = around[0][i].min(at[i]);
                    around[1][i] = around[1][i].max(at[i]);
                }
            }
            for &twin in mesh.twins()[3 * t..3 * t + 3].iter().filter(|twin| **twin != NO_TWIN) {
                let other = twin as usize / 3;
                if !std::mem::replace(&mut seen[other], true) {
                    next.push(other);
                }
            }
        }
        boxes.push(around);
    }
    boxes
}

/// Whether any two boxes have a point in common. O(n log n) for boxes beside few others along x.
fn boxes_meet(boxes: &mut [[[f64; 3]; 2]]) -> bool {
    boxes.sort_by(|a, b| a[0][0].total_cmp(&b[0][0]));
    boxes.iter().enumerate().any(|(i, a)| {
        let near = boxes[i + 1..].iter().take_while(|b| b[0][0] <= a[1][0]);
        near.into_iter().any(|b| (1..3).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    type Body = (Vec<[f64; 3]>, Vec<[u32; 3]>);

    fn cuboid(low: [f64; 3], high: [f64; 3], outwards: bool) -> Body {
        let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 0 { low[k] } else { high[k] });
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let turned = facets.map(|[a, b, c]| if outwards { [a, b, c] } else { [a, c, b] });
        ((0..8).map(corner).collect(), turned.collect())
    }

    fn volume(bodies: &[Body]) -> f64 {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (corners, facets) in bodies {
            let first = vertices.len() as u32;
            vertices.extend(corners);
            triangles.extend(facets.iter().map(|t| t.map(|v| v + first)));
        }
        volume_mm3(&Mesh::new(vertices, triangles))
    }

    #[test]
    fn bodies_that_overlap_have_the_volume_of_their_union() {
        let a = cuboid([0.0; 3], [10.0; 3], true);
        let b = cuboid([5.0, 5.0, 5.0], [15.0, 15.0, 12.5], true);
        assert!((volume(&[a.clone(), b]) - (1000.0 + 750.0 - 125.0)).abs() < 1e-3);
        let within = cuboid([2.0; 3], [4.0; 3], true);
        assert!((volume(&[a, within]) - 1000.0).abs() < 1e-3);
    }

    #[test]
    fn what_is_cut_out_does_not_count() {
        let mesh = |(vertices, triangles): Body| Mesh::new(vertices, triangles);
        let body = mesh(cuboid([2.0, 2.0, 3.0], [4.0, 4.0, 12.0], true));
        let cut = crate::mesh::Modifier { name: None, mesh: body, effect: Effect::Cut };
        let whole = mesh(cuboid([0.0; 3], [10.0; 3], true));
        assert!((volume_mm3(&whole.modified(vec![cut])) - (1000.0 - 4.0 * 7.0)).abs() < 1e-3);
    }

    #[test]
    fn cavities_and_bodies_apart_keep_their_exact_sums() {
        let a = cuboid([0.0; 3], [10.0; 3], true);
        let cavity = cuboid([2.0; 3], [4.0; 3], false);
        let apart = cuboid([20.0; 3], [21.0; 3], true);
        assert_eq!(volume(&[a, cavity, apart]).round(), 993.0);
    }
}
