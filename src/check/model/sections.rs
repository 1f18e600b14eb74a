//! Sections of what was printed at the bottom, in the middle and at the top of every layer.

use super::levels::{Level, Levels};
use crate::mesh::Mesh;
use crate::profile::Settings;
use crate::slice::{Cutter, LayerSpan};
use geometry::{Point, Region, Ring, intersection, offset, union, union_all};

/// A layer is cut at these shares of its height.
const CUTS: [f64; 3] = [0.1, 0.5, 0.9];
/// No bead is expected where the model is thinner than twice this.
const HALF_BEAD_MM: f64 = 0.25;
/// Nor that one layer more is printed for what is thinner than twice this.
const HALF_TIP_MM: f64 = 0.15;
/// Outlines are looked at every so often.
const STEP_MM: f64 = 0.4;
/// Beads may lie so far outside the section.
const AROUND_MM: f64 = 0.6;

/// Bodies at their positions, cut.
pub(super) struct Sections<'a> {
    /// Each with its positions on the bed.
    bodies: Vec<(Cutter<'a>, Vec<Point>)>,
    count: usize,
    top_mm: f64,
}

impl<'a> Sections<'a> {
    /// Cuts at the heights that were printed. The bodies stand on z = 0, which is at `bottom_mm` in the print.
    pub fn new(
        bodies: impl IntoIterator<Item = (&'a Mesh, Vec<Point>)>,
        levels: &Levels,
        bottom_mm: f64,
        settings: &Settings,
    ) -> Self {
        let levels = levels.all();
        let above = levels.last().map(|last| Level { z_mm: last.z_mm + last.height_mm, ..*last });
        let cuts_mm = levels
            .iter()
            .chain(&above)
            .flat_map(|level| CUTS.map(|share| level.z_mm - bottom_mm - level.height_mm * (1.0 - share)));
        let spans: Vec<LayerSpan> = cuts_mm
            .enumerate()
            .map(|(index, cut_mm)| LayerSpan {
                index,
                bottom_mm: cut_mm,
                top_mm: cut_mm,
                height_mm: 0.0,
                cut_mm,
            })
            .collect();
        let bodies: Vec<(&Mesh, Vec<Point>)> = bodies.into_iter().collect();
        let tops = bodies.iter().map(|(mesh, _)| bottom_mm + mesh.bounds()[1][2]);
        let top_mm = tops.fold(bottom_mm, f64::max);
        let cutter = |(mesh, positions): (&'a Mesh, Vec<Point>)| {
            (Cutter::new(mesh, &spans, &settings.layer), positions)
        };
        let bodies = bodies.into_iter().map(cutter).collect();
        Self { bodies, count: levels.len(), top_mm }
    }

    /// Where the highest body ends.
    pub fn top_mm(&self) -> f64 {
        self.top_mm
    }

    /// What is missing above the last layer.
    pub fn above(&self) -> Region {
        if self.count == 0 {
            return Region::default();
        }
        let [low, high] = [0, 2].map(|cut| self.cut(self.count, cut));
        offset(&intersection(&low, &high), -HALF_TIP_MM)
    }

    /// Middle lines of the outermost beads that a layer must have, and where beads may be.
    pub fn layer(&self, index: usize) -> (Region, Region) {
        let [low, high] = [0, 2].map(|cut| self.cut(index, cut));
        (offset(&intersection(&low, &high), -HALF_BEAD_MM), offset(&union(&low, &high), AROUND_MM))
    }

    /// Where beads may be for the sake of the middle of a layer alone: a sheet between two hollows may be nowhere else.
    pub fn middle(&self, index: usize) -> Region {
        offset(&self.cut(index, 1), AROUND_MM)
    }

    /// One of the [`CUTS`] through a layer.
    fn cut(&self, index: usize, which: usize) -> Region {
        let parts = self.bodies.iter().flat_map(|(cutter, positions)| {
            let section = cutter.section(CUTS.len() * index + which).0;
            positions.iter().map(move |position| section.translated(*position)).collect::<Vec<_>>()
        });
        let mut parts: Vec<Region> = parts.collect();
        if parts.len() == 1 { parts.swap_remove(0) } else { union_all(&parts) }
    }
}

/// Points along a ring, close enough for a test of what lies on it.
pub(super) fn along(ring: &Ring) -> Vec<Point> {
    let mut points = Vec::new();
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let count = (a.distance_mm(b) / STEP_MM).ceil().max(1.0) as usize;
        let ([ax, ay], [bx, by]) = (a.mm(), b.mm());
        points.extend((0..count).map(|k| {
            let share = k as f64 / count as f64;
            Point::from_mm(ax + (bx - ax) * share, ay + (by - ay) * share)
        }));
    }
    points
}
