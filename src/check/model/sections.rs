//! Sections of the model at the bottom and the top of every printed layer.

use super::survey::Survey;
use crate::geom::{Region, intersection, offset, union};
use crate::mesh::Mesh;
use crate::profile::Settings;
use crate::slice::{Cutter, LayerSpan};

/// A layer is cut at these shares of its height.
const CUTS: [f64; 2] = [0.1, 0.9];
/// No bead is expected where the model is thinner than twice this.
const HALF_BEAD_MM: f64 = 0.25;
/// Nor that one layer more is printed for what is thinner than twice this.
const HALF_TIP_MM: f64 = 0.15;
/// Beads may lie so far outside of the section.
const AROUND_MM: f64 = 0.6;

/// A layer of the print.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// Height of the nozzle.
    pub z_mm: f64,
    /// Thickness.
    pub height_mm: f64,
}

/// The model, cut.
pub(super) struct Sections<'a> {
    cutter: Cutter<'a>,
    levels: Vec<Level>,
    bottom_mm: f64,
    top_mm: f64,
    bed_mm: f64,
}

impl<'a> Sections<'a> {
    /// Cuts at the heights that were printed. On a raft the model begins where its first layer does.
    pub fn new(mesh: &'a Mesh, survey: &Survey, settings: &Settings) -> Self {
        let heights_mm = survey.heights_mm();
        let first_mm = heights_mm.first().copied().unwrap_or(0.0);
        let raised = first_mm > survey.lowest_mm() + 1e-3;
        let bottom_mm = match heights_mm.get(1) {
            Some(second_mm) if raised => first_mm - (second_mm - first_mm),
            _ => settings.layer.z_offset.0.min(first_mm),
        };
        let mut below_mm = bottom_mm;
        let levels: Vec<Level> = heights_mm
            .into_iter()
            .map(|z_mm| {
                let height_mm = (z_mm - below_mm).max(1e-3);
                below_mm = z_mm;
                Level { z_mm, height_mm }
            })
            .collect();
        let [low, high] = mesh.bounds();
        let above = levels.last().map(|last| Level { z_mm: last.z_mm + last.height_mm, ..*last });
        let cuts_mm = levels.iter().chain(&above).flat_map(|level| {
            CUTS.map(|share| level.z_mm - bottom_mm - level.height_mm * (1.0 - share) + low[2])
        });
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
        Self {
            cutter: Cutter::new(mesh, &spans, &settings.layer),
            levels,
            bottom_mm,
            top_mm: bottom_mm + high[2] - low[2],
            bed_mm: settings.layer.z_offset.0,
        }
    }

    /// Layers from the bed up.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Where the model begins and ends.
    pub fn bottom_mm(&self) -> f64 {
        self.bottom_mm
    }

    /// See [`Sections::bottom_mm`].
    pub fn top_mm(&self) -> f64 {
        self.top_mm
    }

    /// The printer's Z of the bed's surface.
    pub fn bed_mm(&self) -> f64 {
        self.bed_mm
    }

    /// The layer at a height.
    pub fn find(&self, z_mm: f64) -> Option<usize> {
        let at = self.not_below(z_mm);
        self.levels.get(at).is_some_and(|level| level.z_mm < z_mm + 1e-3).then_some(at)
    }

    /// The height of the layer in which a bead rises to here.
    pub fn rises_to_mm(&self, z_mm: f64) -> f64 {
        self.levels.get(self.not_below(z_mm)).map_or(z_mm, |level| level.z_mm)
    }

    /// The lowest layer that is at a height or above it.
    fn not_below(&self, z_mm: f64) -> usize {
        self.levels.partition_point(|level| level.z_mm < z_mm - 1e-3)
    }

    /// What is missing above the last layer.
    pub fn above(&self) -> Region {
        if self.levels.is_empty() {
            return Region::default();
        }
        let [low, high] = self.cuts(self.levels.len());
        offset(&intersection(&low, &high), -HALF_TIP_MM)
    }

    /// Middle lines of the outermost beads that a layer must have, and where beads may be; in the model's place.
    pub fn layer(&self, index: usize) -> (Region, Region) {
        let [low, high] = self.cuts(index);
        (offset(&intersection(&low, &high), -HALF_BEAD_MM), offset(&union(&low, &high), AROUND_MM))
    }

    fn cuts(&self, index: usize) -> [Region; 2] {
        [2 * index, 2 * index + 1].map(|cut| self.cutter.section(cut).0)
    }
}
