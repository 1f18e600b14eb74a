//! Cutting a mesh by horizontal planes.

use super::Gaps;
use super::fill;
use super::options::LayerSettings;
use super::plan::LayerSpan;
use super::simplify::simplify;
use super::stitch::stitch;
use crate::mesh::{Effect, Mesh, NO_TWIN};
use geometry::{Point, Region, Ring};

/// A mesh with its triangles sorted by the layers that cross them. A vertex on a cut is above it, so no cut ever passes through
/// a vertex.
#[derive(Debug)]
pub struct Cutter<'a> {
    mesh: &'a Mesh,
    cuts_mm: Vec<f64>,
    /// `crossing[start[i]..start[i + 1]]` are the triangles that cut `i` crosses, ascending.
    start: Vec<u32>,
    crossing: Vec<u32>,
    /// Whether the mesh has no open edges.
    is_closed: bool,
    resolution_mm: f64,
    closing_mm: f64,
    /// Of bodies that are cut out.
    cut_out: Vec<Cutter<'a>>,
}

impl<'a> Cutter<'a> {
    /// Sorts the triangles by layer; of the settings it needs those of outlines. O(triangles + crossings).
    ///
    /// # Panics
    /// If layers cross more triangles than 32 bits number, which [`limits::CROSSINGS`](crate::limits::CROSSINGS) forbids.
    pub fn new(mesh: &'a Mesh, spans: &[LayerSpan], settings: &LayerSettings) -> Self {
        let cuts_mm: Vec<f64> = spans.iter().map(|s| s.cut_mm).collect();
        let ranks: Vec<u32> = mesh.vertices().iter().map(|at_mm| rank(&cuts_mm, at_mm[2])).collect();
        let range = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| ranks[v as usize]);
            (a.min(b).min(c) as usize, a.max(b).max(c) as usize)
        };
        // Two passes of a counting sort by layer. First, by how much the counts change from layer to layer.
        let mut start = vec![0u32; cuts_mm.len() + 3];
        for triangle in mesh.triangles() {
            let (low, high) = range(triangle);
            start[low + 2] = start[low + 2].wrapping_add(1);
            start[high + 2] = start[high + 2].wrapping_sub(1);
        }
        start.pop();
        let (mut count, mut sum) = (0_u32, 0_u32);
        for entry in &mut start[2..] {
            count = count.wrapping_add(*entry);
            sum = u32::checked_add(sum, count)
                .expect("crossings are numbered in 32 bits: see limits::CROSSINGS");
            *entry = sum;
        }
        let mut crossing = vec![0; start.last().map_or(0, |&n| n as usize)];
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let (low, high) = range(triangle);
            for entry in &mut start[low + 1..high + 1] {
                crossing[*entry as usize] = t as u32;
                *entry += 1;
            }
        }
        let (resolution_mm, closing_mm) = (settings.resolution.0, settings.closing_radius.0);
        let cut_out = mesh.modifiers().iter().filter(|modifier| modifier.effect == Effect::Cut);
        let cut_out = cut_out.map(|modifier| Self::new(&modifier.mesh, spans, settings)).collect();
        let is_closed = mesh.is_closed();
        Self { mesh, cuts_mm, start, crossing, is_closed, resolution_mm, closing_mm, cut_out }
    }

    /// The section at a layer's cut, without bodies that are cut out, and what had to be repaired. Cost grows with the triangles that the layer crosses.
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn section(&self, layer: usize) -> (Region, Gaps) {
        let (mut rings, chains) = self.outlines(layer);
        let mut gaps = stitch(chains, self.mesh.is_oriented(), &mut rings);
        for ring in &mut rings {
            simplify(ring, self.resolution_mm);
        }
        rings.retain(|ring| ring.len() >= 3);
        let mut region = if self.mesh.is_oriented() {
            fill::non_zero(&rings, self.closing_mm)
        } else {
            fill::even_odd(&rings)
        };
        for body in &self.cut_out {
            let (hole, found) = body.section(layer);
            region = geometry::difference(&region, &hole);
            gaps += found;
        }
        (region, gaps)
    }

    /// Closed outlines, and chains that end at open edges. The solid lies to the left.
    fn outlines(&self, layer: usize) -> (Vec<Ring>, Vec<Vec<Point>>) {
        let crossing = &self.crossing[self.start[layer] as usize..self.start[layer + 1] as usize];
        let (Some(&first), Some(&last)) = (crossing.first(), crossing.last()) else {
            return (Vec::new(), Vec::new());
        };
        let mut seen = Bits::new(first, last);
        let mut chains = Vec::new();
        let ends = if self.is_closed { &[] } else { crossing };
        for &triangle in ends {
            let (down, _) = self.entry_and_exit(triangle, layer);
            if self.mesh.twins()[down as usize] == NO_TWIN {
                let mut chain = vec![self.point(down, layer)];
                self.follow(triangle, layer, &mut seen, &mut chain);
                chains.push(chain);
            }
        }
        let mut rings = Vec::new();
        for &triangle in crossing {
            if !seen.contains(triangle) {
                let mut ring = Vec::new();
                self.follow(triangle, layer, &mut seen, &mut ring);
                rings.push(ring);
            }
        }
        (rings, chains)
    }

    /// Walks from triangle to triangle, adding the point where it leaves each, until it meets an open edge or a
    /// triangle that it has seen.
    fn follow(&self, from: u32, layer: usize, seen: &mut Bits, points: &mut Vec<Point>) {
        let mut triangle = from;
        while seen.insert(triangle) {
            let (_, up) = self.entry_and_exit(triangle, layer);
            let point = self.point(up, layer);
            if points.last() != Some(&point) {
                points.push(point);
            }
            match self.mesh.twins()[up as usize] {
                NO_TWIN => break,
                twin => triangle = twin / 3,
            }
        }
    }

    /// The half-edges where an outline enters and leaves a triangle: those that run down and up through the cut.
    #[inline]
    fn entry_and_exit(&self, triangle: u32, layer: usize) -> (u32, u32) {
        let cut_mm = self.cuts_mm[layer];
        let [a, b, c] =
            self.mesh.triangles()[triangle as usize].map(|v| self.mesh.vertices()[v as usize][2] >= cut_mm);
        let (down, up) = match (a, b, c) {
            (true, false, false) => (0, 2),
            (false, true, false) => (1, 0),
            (false, false, true) => (2, 1),
            (false, true, true) => (2, 0),
            (true, false, true) => (0, 1),
            _ => (1, 2),
        };
        (3 * triangle + down, 3 * triangle + up)
    }

    /// Where an edge passes through the cut: computed from the lower to the upper end, so that both triangles of an
    /// edge get the same point.
    #[inline]
    fn point(&self, half: u32, layer: usize) -> Point {
        let (triangle, k) = (self.mesh.triangles()[half as usize / 3], half as usize % 3);
        let corner = |k: usize| self.mesh.vertices()[triangle[k] as usize];
        let (from, to) = (corner(k), corner(if k == 2 { 0 } else { k + 1 }));
        let cut_mm = self.cuts_mm[layer];
        let (low, high) = if from[2] < cut_mm { (from, to) } else { (to, from) };
        let share = (cut_mm - low[2]) / (high[2] - low[2]);
        Point::from_mm(low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]))
    }
}

/// Counts the cuts at or below a height: guessed from the even spacing, then corrected.
#[inline]
fn rank(cuts_mm: &[f64], z_mm: f64) -> u32 {
    let mut rank = match *cuts_mm {
        [_, second, third, ..] => ((z_mm - second) / (third - second) + 2.0).max(0.0) as usize,
        _ => 0,
    };
    rank = rank.min(cuts_mm.len());
    while rank > 0 && cuts_mm[rank - 1] > z_mm {
        rank -= 1;
    }
    while rank < cuts_mm.len() && cuts_mm[rank] <= z_mm {
        rank += 1;
    }
    rank as u32
}

/// A set of triangles between two numbers.
struct Bits {
    base: u32,
    words: Vec<u64>,
}

impl Bits {
    fn new(first: u32, last: u32) -> Self {
        let base = first & !63;
        Self { base, words: vec![0; (last - base) as usize / 64 + 1] }
    }

    fn contains(&self, triangle: u32) -> bool {
        let at = triangle - self.base;
        self.words[at as usize / 64] >> (at % 64) & 1 == 1
    }

    /// Adds a member; false if it was one before.
    fn insert(&mut self, triangle: u32) -> bool {
        let at = triangle - self.base;
        let (word, bit) = (&mut self.words[at as usize / 64], 1u64 << (at % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }
}
