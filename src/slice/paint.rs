//! Where cuts cross what is painted on a mesh.

use super::plan::LayerSpan;
use crate::mesh::{Mesh, Paint, PaintedFacet};
use geometry::{Point, Ring};

/// A line of an outline with what is painted there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintedLine<T> {
    /// Index into [`Plate::objects`](crate::plate::Plate::objects).
    pub object: usize,
    /// Its ends, in bed coordinates.
    pub ends: [Point; 2],
    /// What is painted.
    pub paint: T,
}

/// Painted facets of a kind, sorted by the layers that cross them.
#[derive(Debug)]
pub(super) struct PaintCutter<'a, T> {
    facets: &'a [PaintedFacet<T>],
    cuts_mm: Vec<f64>,
    /// For each layer the facets that it crosses.
    crossing: Vec<Vec<u32>>,
}

impl<'a, T: Copy> PaintCutter<'a, T> {
    /// Of one kind of what is painted on a mesh. O(facets + crossings).
    pub fn new(mesh: &'a Mesh, spans: &[LayerSpan], kind: impl Fn(&Paint) -> &[PaintedFacet<T>]) -> Self {
        let facets = kind(mesh.paint());
        let cuts_mm: Vec<f64> = spans.iter().map(|span| span.cut_mm).collect();
        let mut crossing = vec![Vec::new(); if facets.is_empty() { 0 } else { cuts_mm.len() }];
        for (number, facet) in (0..).zip(facets) {
            let [low, high] = heights(facet.corners);
            let first = cuts_mm.partition_point(|&cut| cut < low);
            let last = cuts_mm.partition_point(|&cut| cut < high);
            crossing[first..last].iter_mut().for_each(|layer| layer.push(number));
        }
        Self { facets, cuts_mm, crossing }
    }

    /// The lines of a layer, in the mesh's coordinates.
    pub fn lines(&self, layer: usize) -> impl Iterator<Item = ([Point; 2], T)> {
        let facets =
            self.crossing.get(layer).into_iter().flatten().map(|&number| &self.facets[number as usize]);
        facets.filter_map(move |facet| Some((crossed(facet.corners, self.cuts_mm[layer])?, facet.paint)))
    }
}

/// The lowest and the highest of a triangle.
fn heights(corners: [[f64; 3]; 3]) -> [f64; 2] {
    let heights = corners.map(|corner| corner[2]);
    [heights.into_iter().fold(f64::INFINITY, f64::min), heights.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

/// Where a level plane passes through a triangle; a corner on it is above it.
fn crossed(corners: [[f64; 3]; 3], z_mm: f64) -> Option<[Point; 2]> {
    let mut points = (0..3).filter_map(|k| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (low, high) = if a[2] < b[2] { (a, b) } else { (b, a) };
        let share = (z_mm - low[2]) / (high[2] - low[2]);
        let at = |i: usize| low[i] + share * (high[i] - low[i]);
        (low[2] < z_mm && z_mm <= high[2]).then(|| Point::from_mm(at(0), at(1)))
    });
    Some([points.next()?, points.next()?])
}

/// A part of a surface that is nearly level, seen from above, with what is painted there.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedArea<T> {
    /// Its outline, counter-clockwise, in the coordinates of the mesh.
    pub ring: Ring,
    /// What is painted.
    pub paint: T,
}

/// Steeper surfaces are narrower than a line between two cuts: the outlines say what is painted on them. Cosine of 60°.
const STEEPEST: f64 = 0.5;

/// Painted surfaces that are not steep, between cuts, as [`paint_between`] gives them.
pub fn level_paint<T: Copy>(facets: &[PaintedFacet<T>], cuts_mm: &[f64]) -> Vec<Vec<PaintedArea<T>>> {
    paint_between(facets.iter().filter(|facet| !is_steep(&facet.corners)), cuts_mm)
}

/// Whether a triangle is narrower than a line between two cuts.
pub(crate) fn is_steep(corners: &[[f64; 3]; 3]) -> bool {
    let normal = normal(corners);
    normal.z.abs() < STEEPEST * normal.norm()
}

fn normal(corners: &[[f64; 3]; 3]) -> nalgebra::Vector3<f64> {
    let [a, b, c] = corners.map(nalgebra::Vector3::from);
    (b - a).cross(&(c - a))
}

/// Painted surfaces that are not upright, between cuts: below the first, between it and the second, and so on, then above the last.
pub(crate) fn paint_between<'f, T: Copy + 'f>(
    facets: impl IntoIterator<Item = &'f PaintedFacet<T>>,
    cuts_mm: &[f64],
) -> Vec<Vec<PaintedArea<T>>> {
    let mut slabs = vec![Vec::new(); cuts_mm.len() + 1];
    for PaintedFacet { corners, paint } in facets {
        let normal = normal(corners);
        if normal.z == 0.0 {
            continue;
        }
        let [low, high] = heights(*corners);
        let first = cuts_mm.partition_point(|&cut| cut <= low);
        let last = cuts_mm.partition_point(|&cut| cut < high);
        for (slab, areas) in slabs.iter_mut().enumerate().take(last.max(first) + 1).skip(first) {
            let from = slab.checked_sub(1).map_or(f64::NEG_INFINITY, |below| cuts_mm[below]);
            let to = cuts_mm.get(slab).copied().unwrap_or(f64::INFINITY);
            let above = clipped(&corners[..], |corner| corner[2] - from);
            let between = clipped(&above, |corner| to - corner[2]);
            let mut ring: Ring = between.iter().map(|corner| Point::from_mm(corner[0], corner[1])).collect();
            ring.dedup();
            if normal.z < 0.0 {
                ring.reverse();
            }
            if ring.len() >= 3 {
                areas.push(PaintedArea { ring, paint: *paint });
            }
        }
    }
    slabs
}

/// What is left of a convex polygon where a linear function is not negative (Sutherland & Hodgman 1974,
/// <https://doi.org/10.1145/360767.360802>).
fn clipped(corners: &[[f64; 3]], keep: impl Fn(&[f64; 3]) -> f64) -> Vec<[f64; 3]> {
    let mut left = Vec::with_capacity(corners.len() + 1);
    for (k, a) in corners.iter().enumerate() {
        let b = &corners[(k + 1) % corners.len()];
        let (at_a, at_b) = (keep(a), keep(b));
        if at_a >= 0.0 {
            left.push(*a);
        }
        if (at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0) {
            let share = at_a / (at_a - at_b);
            left.push([0, 1, 2].map(|i| a[i] + share * (b[i] - a[i])));
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_divided_between_the_cuts() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [0.0, 4.0, 0.0]];
        let slabs = level_paint(&[PaintedFacet { corners, paint: 3u8 }], &[0.5, 2.0]);
        let area = |slab: usize| slabs[slab].iter().map(|area| geometry::ring_area(&area.ring)).sum::<f64>();
        assert_eq!([area(0), area(1), area(2) + 0.0], [6.0, 2.0, 0.0]);
        let wall = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.1, 4.0]];
        assert!(level_paint(&[PaintedFacet { corners: wall, paint: 3u8 }], &[0.5]).concat().is_empty());
    }
}
