//! The layers of a print, as given by its beads.

use super::survey::Survey;
use crate::profile::Settings;

/// A layer of the print.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// Height of the nozzle.
    pub z_mm: f64,
    /// Thickness.
    pub height_mm: f64,
}

/// Layers from the bed up.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    levels: Vec<Level>,
    /// Where the model may begin, the likeliest first.
    bottoms_mm: Vec<f64>,
    /// The printer's Z of the bed's surface.
    pub bed_mm: f64,
}

impl Levels {
    /// The heights that were printed. On a raft, or in mid-air, the model begins where its first layer does, unless what is
    /// beneath was too thin to be printed.
    pub fn new(survey: &Survey, settings: &Settings) -> Self {
        let heights_mm = survey.heights_mm();
        let bed_mm = settings.layer.z_offset.0;
        let first_mm = heights_mm.first().copied().unwrap_or(0.0);
        let on_bed_mm = bed_mm.min(first_mm);
        let raised = first_mm > survey.lowest_mm() + 1e-3 || first_mm - on_bed_mm > HIGHEST_FIRST_MM;
        let bottoms_mm = match heights_mm.get(1) {
            Some(second_mm) if raised => vec![first_mm - (second_mm - first_mm), on_bed_mm],
            _ => vec![on_bed_mm],
        };
        let mut below_mm = bottoms_mm[0];
        let levels = heights_mm.into_iter().map(|z_mm| {
            let height_mm = (z_mm - below_mm).max(1e-3);
            below_mm = z_mm;
            Level { z_mm, height_mm }
        });
        Self { levels: levels.collect(), bottoms_mm, bed_mm }
    }

    /// All layers.
    pub fn all(&self) -> &[Level] {
        &self.levels
    }

    /// See the field.
    pub fn bottoms_mm(&self) -> &[f64] {
        &self.bottoms_mm
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
}

/// No first layer is thicker.
const HIGHEST_FIRST_MM: f64 = 1.0;
