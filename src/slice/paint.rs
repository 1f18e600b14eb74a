//! Where cuts cross what is painted on a mesh.

use super::plan::LayerSpan;
use crate::mesh::{Mesh, Paint, PaintedFacet};
use geometry::Point;

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
            let heights = facet.corners.map(|corner| corner[2]);
            let low = heights.into_iter().fold(f64::INFINITY, f64::min);
            let high = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
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
