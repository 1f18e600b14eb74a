//! Combined infill: layers whose sparse infill is laid once, in beads as high as all of them.

use geometry::Region;

/// Neighbouring layers that are filled at the height of the last one.
#[derive(Clone, Debug)]
pub(super) struct CombinedLayers {
    /// Index of the lowest layer.
    pub(super) first: usize,
    /// Index of the highest layer.
    pub(super) last: usize,
    /// Height of all of them in millimetres.
    pub(super) height_mm: f64,
    /// Where all of them are sparse.
    pub(super) area: Region,
}

/// All groups of layers with combined infill of a print, bottom up.
#[derive(Clone, Debug, Default)]
pub(super) struct CombinedInfill {
    all: Vec<CombinedLayers>,
}

impl CombinedInfill {
    /// Groups of at most `most` layers that together are at most `highest_mm` high. `areas` are the heights of all layers
    /// and where they are sparse; the first layer is in no group.
    pub(super) fn new(areas: &[(f64, Region)], most: usize, highest_mm: f64) -> Self {
        let mut all: Vec<CombinedLayers> = Vec::new();
        for (index, (height_mm, area)) in areas.iter().enumerate().skip(1) {
            let last = all.last_mut().filter(|group| {
                let fits = group.height_mm + height_mm <= highest_mm + 1e-6;
                group.last + 1 == index && index - group.first < most && fits
            });
            if let Some(group) = last {
                let shared = geometry::intersection(&group.area, area);
                if !shared.is_empty() {
                    (group.last, group.area) = (index, shared);
                    group.height_mm += height_mm;
                    continue;
                }
            }
            if !area.is_empty() {
                all.push(CombinedLayers {
                    first: index,
                    last: index,
                    height_mm: *height_mm,
                    area: area.clone(),
                });
            }
        }
        all.retain(|group| group.last > group.first);
        Self { all }
    }

    /// The group that a layer is in, and its number.
    pub(super) fn of(&self, layer: usize) -> Option<(&CombinedLayers, usize)> {
        let number = self.all.partition_point(|group| group.last < layer);
        self.all.get(number).filter(|group| group.first <= layer).map(|group| (group, number))
    }
}
