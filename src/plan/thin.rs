//! What of a print is too thin to be printed.

use crate::toolpath::{LayerKind, LayerPaths};

/// What is smaller is no part: the crumbs of a mesh's faults.
const CRUMB_MM2: f64 = 0.02;

/// The islands that no path was made for, counted layer by layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ThinParts {
    layers: usize,
    /// Top of the lowest.
    lowest_mm: f64,
    /// Area of all of them together.
    area_mm2: f64,
}

impl ThinParts {
    /// Adds a layer.
    pub fn take(&mut self, layer: &LayerPaths) {
        let sections = layer.outline.polygons();
        if layer.kind != LayerKind::Flat || sections.len() != layer.islands.len() {
            return;
        }
        let mut printed = vec![false; sections.len()];
        for island in layer.paths.iter().filter_map(|path| path.island) {
            if let Some(printed) = printed.get_mut(island.index()) {
                *printed = true;
            }
        }
        let left_out = sections.iter().zip(printed).filter(|(_, printed)| !printed);
        let areas_mm2 = left_out.map(|(section, _)| section.area_mm2()).filter(|mm2| *mm2 > CRUMB_MM2);
        let area_mm2: f64 = areas_mm2.sum();
        if area_mm2 > 0.0 {
            if self.layers == 0 {
                self.lowest_mm = layer.top_mm;
            }
            self.layers += 1;
            self.area_mm2 += area_mm2;
        }
    }

    /// The warning for the user; `None` if everything was printed.
    pub fn warning(&self) -> Option<String> {
        let Self { layers, lowest_mm, area_mm2 } = self;
        let on = if *layers == 1 { "1 layer".to_owned() } else { format!("{layers} layers") };
        (*layers > 0).then(|| {
            format!(
                "parts of {on} are too thin to be printed ({area_mm2:.1} mm²), the lowest at Z {lowest_mm:.2}; make \
                 them thicker, or set walls.min_feature lower"
            )
        })
    }
}
