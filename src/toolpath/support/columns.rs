//! Straight columns under everything that is to be held.

use super::bitmap::Bitmap;

/// Columns narrower than this are widened downwards.
const FIRM_MM: f64 = 4.0;

/// Height over which a narrow column gains one cell on every side.
const WIDEN_EVERY_MM: f64 = 2.0;

/// Height over which columns widen by one cell, upwards, to carry support that stands on nothing.
const LEAN_EVERY_MM: f64 = 0.8;

/// How far, in cells, a corner may lie from the largest square that fits.
const CORNER: usize = 3;

/// Gaps between columns up to twice this are filled: one column stands better than two.
const MERGE_MM: f64 = 0.8;

/// Narrower remains, cut off by the part, are left out, in cells.
const NARROWEST: usize = 2;

/// One layer of support.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Everywhere that support stands.
    pub all: Bitmap,
    /// Where the part lies close above.
    pub interface: Bitmap,
}

/// The input of columns.
#[derive(Clone, Debug)]
pub struct ColumnSpec {
    /// For each layer how many under it are left free between the part and support, whichever is above.
    pub gap_layers: Vec<usize>,
    /// Layers at the top that are dense.
    pub interface_layers: usize,
    /// How near to the part's sides columns come, in cells.
    pub gap_cells: usize,
    /// Only columns that stand on the bed.
    pub from_bed_only: bool,
    /// Height of a layer, the least one where they differ.
    pub height_mm: f64,
}

/// Stands columns under `held`: for each layer the cells that must be held from below. `solid` are the part's cells.
/// Returns the cells of each layer's support.
///
/// Top down, each layer has what the one above it has, and the pads under what is held over it, less the part. What
/// ends on the part rests there. Last, bottom up, whatever rests on nothing is taken out, but for what a column beside
/// it can lean out to: a flank too steep to stand on cuts columns off at its foot. O(layers · cells).
pub fn stand(held: &[Bitmap], solid: &[&Bitmap], spec: &ColumnSpec) -> Vec<Cells> {
    let Some(first) = solid.first() else { return Vec::new() };
    let grid = first.grid();
    let pads = pads(held, solid, spec);
    let widen_every = ((WIDEN_EVERY_MM / spec.height_mm) as usize).max(1);
    let mut all: Vec<Bitmap> = vec![Bitmap::empty(grid); solid.len()];
    let mut column = Bitmap::empty(grid);
    for layer in (0..solid.len()).rev() {
        let begins = !pads[layer].is_empty();
        if !begins && column.is_empty() {
            continue;
        }
        column.add(&pads[layer]);
        let widens = layer % widen_every == 0;
        if widens {
            let mut narrow = column.clone();
            // The corners of wide columns are not narrow.
            narrow.remove(&column.opened(grid.cells(FIRM_MM)).grown(CORNER));
            column.add(&narrow.grown(1));
        }
        if begins || widens {
            column = column.closed(grid.cells(MERGE_MM));
        }
        column.remove(&kept_free(solid, layer, spec));
        column = column.opened(NARROWEST);
        all[layer] = column.clone();
    }
    rest(&mut all, solid, spec);
    let shallow = |layer: usize| {
        let mut interface = Bitmap::empty(grid);
        pads.iter().skip(layer).take(spec.interface_layers).for_each(|pad| interface.add(pad));
        interface.keep(&all[layer]);
        interface.opened(NARROWEST)
    };
    let interfaces: Vec<Bitmap> = (0..all.len()).map(shallow).collect();
    all.into_iter().zip(interfaces).map(|(all, interface)| Cells { all, interface }).collect()
}

/// For each layer, where support ends under what is held above it.
pub(super) fn pads(held: &[Bitmap], solid: &[&Bitmap], spec: &ColumnSpec) -> Vec<Bitmap> {
    let mut pads: Vec<Bitmap> = solid.iter().map(|solid| Bitmap::empty(solid.grid())).collect();
    for (layer, held) in held.iter().enumerate().filter(|(_, held)| !held.is_empty()) {
        if let Some(top) = layer.checked_sub(1 + spec.gap_layers[layer]) {
            pads[top].add(&held.grown(1));
        }
    }
    pads
}

/// The cells too near to the part.
pub(super) fn kept_free(solid: &[&Bitmap], layer: usize, spec: &ColumnSpec) -> Bitmap {
    let mut free = solid[layer].grown(spec.gap_cells);
    (1..=spec.gap_layers[layer].min(layer)).for_each(|down| free.add(solid[layer - down]));
    free
}

/// Takes out what stands neither on the bed nor on support nor, where that is allowed, on the part.
fn rest(all: &mut [Bitmap], solid: &[&Bitmap], spec: &ColumnSpec) {
    // What may not stand on the part does not hang over it either.
    let leans = !spec.from_bed_only;
    let lean_every = ((LEAN_EVERY_MM / spec.height_mm) as usize).max(1);
    for layer in 1..all.len() {
        if all[layer].is_empty() {
            continue;
        }
        let mut under = all[layer - 1].grown(usize::from(leans && layer % lean_every == 0));
        if !spec.from_bed_only {
            let nearest = layer.saturating_sub(spec.gap_layers[layer] + 1);
            solid[nearest..layer].iter().for_each(|solid| under.add(&solid.grown(1)));
        }
        all[layer].keep(&under);
        all[layer] = all[layer].opened(NARROWEST);
    }
}
