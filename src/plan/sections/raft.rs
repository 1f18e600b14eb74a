//! Layers beneath the part.

use crate::profile::Settings;
use crate::slice::{Gaps, Layer, LayerSpan};

/// The layers of a raft, and on them those of the part.
pub(super) fn raised(cut: Vec<Layer>, settings: &Settings) -> Vec<Layer> {
    let count = settings.raft.layers as usize;
    if count == 0 || cut.is_empty() {
        return cut;
    }
    let (first_mm, other_mm) = (settings.layer.first_height.0, settings.layer.height.0);
    let raft_mm = |layers: usize| first_mm + (layers - 1) as f64 * other_mm;
    let raft = (0..count).map(|index| {
        let (bottom_mm, top_mm) = (if index == 0 { 0.0 } else { raft_mm(index) }, raft_mm(index + 1));
        let (height_mm, cut_mm) = (top_mm - bottom_mm, (bottom_mm + top_mm) / 2.0);
        let span = LayerSpan { index, bottom_mm, top_mm, height_mm, cut_mm };
        Layer {
            span,
            sections: Vec::new(),
            seams: Vec::new(),
            tools: Vec::new(),
            modified: Vec::new(),
            gaps: Gaps::default(),
        }
    });
    let up_mm = raft_mm(count) + settings.raft.gap.0;
    let part = cut.into_iter().map(|layer| {
        let span = LayerSpan {
            index: layer.span.index + count,
            bottom_mm: layer.span.bottom_mm + up_mm,
            top_mm: layer.span.top_mm + up_mm,
            cut_mm: layer.span.cut_mm + up_mm,
            ..layer.span
        };
        Layer { span, ..layer }
    });
    raft.chain(part).collect()
}
