//! Supports of a plate: found and stood before any layer is planned, laid as beads layer by layer.

use std::borrow::Cow;

use crate::profile::Settings;
use crate::report::Overhangs;
use crate::slice::{self, Layer, LayerSpan};
use crate::toolpath::Path;
use crate::toolpath::support::{self, Bitmap, ColumnSpec, Grid, Ground, Outlines, Overhang, Slab};
use crate::toolpath::{SupportSettings, SupportStyle};
use geometry::{Bounds, Region, offset, union_all};

use super::wishes::Wishes;
use crate::parallel::Workers;

/// How far supports may reach beyond the part, in millimetres.
pub(crate) const REACH_MM: f64 = 4.0;

/// Distances that are short by less are kept, in millimetres.
const NOISE_MM: f64 = 1e-6;

/// The outlines of support on every layer.
pub(crate) struct Supports {
    /// Each different from the one before.
    outlines: Vec<Outlines>,
    /// For each layer its outlines.
    of_layer: Vec<usize>,
    /// The beads of each layer, once they are [laid](Self::lay).
    beads: Vec<Vec<Path>>,
    /// For each layer, how many beneath it the part may be that its support stands on.
    stands_on: Vec<usize>,
}

impl Supports {
    /// Finds overhangs and plans supports under them.
    ///
    /// `layers` are the part's, without a raft.
    pub fn plan(
        layers: &[Layer],
        bounds: Bounds,
        wishes: &Wishes,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Self {
        let (count, support) = (layers.len(), &settings.support);
        let Unsupported { grid, slabs, held, heights_mm, height_mm } =
            Unsupported::find(layers, bounds, wishes, settings, support, workers);
        let spec = ColumnSpec {
            gap_layers: (0..count).map(|i| gap_layers(&heights_mm[..i], support.z_gap.0)).collect(),
            interface_layers: support.interface_layers as usize,
            gap_cells: (support.xy_gap.0 / grid.cell_mm() - 1e-6).ceil() as usize,
            from_bed_only: support.from_bed_only,
            height_mm,
        };
        let stands_on = spec.gap_layers.iter().map(|gap| gap + 1).collect();
        let solid = workers.map(count, |i| slabs[i].solid());
        if support.style == SupportStyle::Tree {
            let discs = support::grow(&held, &solid, &spec, support);
            let outlines = workers.map(count, |i| {
                if discs[i].is_empty() {
                    return Outlines::default();
                }
                let near = &slabs[i.saturating_sub(spec.gap_layers[i])..=i];
                let kept_free = offset(&union_all(near.iter().map(Slab::rough)), support.xy_gap.0);
                let (all, interface) = support::outline(&discs[i], &kept_free);
                Outlines { all, interface }
            });
            return Self { outlines, of_layer: (0..count).collect(), beads: Vec::new(), stands_on };
        }
        let cells = support::stand(&held, &solid, &spec);
        let mut distinct: Vec<usize> = Vec::new();
        let of_layer = (0..count)
            .map(|i| {
                if i == 0 || cells[i] != cells[i - 1] {
                    distinct.push(i);
                }
                distinct.len() - 1
            })
            .collect();
        let outlines = workers.map(distinct.len(), |k| Outlines::of(&cells[distinct[k]]));
        Self { outlines, of_layer, beads: Vec::new(), stands_on }
    }

    /// The outlines of a layer's support, the part's first layer being 0.
    pub fn outlines(&self, layer: usize) -> &Outlines {
        &self.outlines[self.of_layer[layer]]
    }

    /// Lays all beads. `bare` lays those of a layer into its outlines; they begin where they rest on those of the layer
    /// below or on the part, whose sections are in `layers`.
    pub fn lay(
        &mut self,
        bare: impl Fn(&Outlines, usize) -> Vec<Path> + Sync + Send,
        layers: &[Layer],
        workers: Workers<'_>,
    ) {
        let count = self.of_layer.len();
        let laid = workers.map(count, |i| bare(self.outlines(i), i));
        let carried = |i: usize, below: &[Path]| {
            let near: Vec<Region> =
                layers[i.saturating_sub(self.stands_on[i])..i].iter().map(section).collect();
            Ground::new(below, &near).carry(laid[i].clone())
        };
        let on_laid = workers.map(count, |i| match i {
            0 => laid[0].clone(),
            _ if laid[i].is_empty() => Vec::new(),
            _ => carried(i, &laid[i - 1]),
        });
        // Again above layers that have changed.
        let mut beads: Vec<Vec<Path>> = Vec::with_capacity(count);
        for (i, on_laid) in on_laid.into_iter().enumerate() {
            let beads_here = match beads.last() {
                Some(below) if *below != laid[i - 1] && !on_laid.is_empty() => carried(i, below),
                _ => on_laid,
            };
            beads.push(beads_here);
        }
        self.beads = beads;
    }

    /// The beads of a layer, the part's first layer being 0.
    pub fn beads(&self, layer: usize) -> &[Path] {
        &self.beads[layer]
    }

    /// The outlines of support on the layers that may carry this one, the part's first layer being 0.
    pub fn under(&self, layer: usize) -> impl Iterator<Item = &Region> {
        let first = layer.saturating_sub(self.stands_on.get(layer).copied().unwrap_or(1) + 1);
        (first..layer).map(|below| &self.outlines(below).all)
    }

    /// Where support stands on the lowest layers.
    pub fn all_outlines(&self, layers: usize) -> impl Iterator<Item = &Region> {
        let last = self.of_layer.iter().take(layers).max().copied().unwrap_or(0);
        self.outlines.iter().take(last + 1).map(|outlines| &outlines.all)
    }
}

/// The unsupported areas of the parts on the plate.
struct Unsupported<'a> {
    grid: Grid,
    slabs: Vec<Slab<'a>>,
    /// The areas that need support.
    held: Vec<Bitmap>,
    heights_mm: Vec<f64>,
    /// The least of them.
    height_mm: f64,
}

impl<'a> Unsupported<'a> {
    fn find(
        layers: &'a [Layer],
        bounds: Bounds,
        wishes: &Wishes,
        settings: &Settings,
        support: &SupportSettings,
        workers: Workers<'_>,
    ) -> Self {
        let count = layers.len();
        let grid = Grid::new(bounds, REACH_MM, support::CELL_MM);
        let slabs = workers.map(count, |i| {
            let section = match layers[i].sections.as_slice() {
                [only] => Cow::Borrowed(&only.region),
                _ => Cow::Owned(section(&layers[i])),
            };
            Slab::new(grid, section)
        });
        let enforced = wishes.any();
        // What lies on the bed hangs nowhere, nor does what lies on its like.
        let found: Vec<Overhang> = workers.map(count, |i| {
            let (slab, below) = (&slabs[i], &slabs[i.saturating_sub(1)]);
            if !enforced && slab.section() == below.section() {
                return Overhang { leaning: Bitmap::empty(grid), must: Bitmap::empty(grid) };
            }
            let height_mm = layers[i].span.height_mm;
            support::find(slab, below, height_mm, wishes.of(i), support)
        });
        let spans: Vec<LayerSpan> = layers.iter().map(|layer| layer.span).collect();
        let heights_mm = slice::heights_mm(&spans, &settings.layer);
        let height_mm = heights_mm.iter().copied().fold(f64::INFINITY, f64::min);
        let window = support::window(height_mm, support);
        let held = workers.map(count, |i| {
            let around = &found[i.saturating_sub(window)..(i + window + 1).min(count)];
            support::lasting(&found[i], around.iter(), support)
        });
        Self { grid, slabs, held, heights_mm, height_mm }
    }
}

/// What support would hold, if it were enabled.
///
/// `layers` are the part's, without a raft.
pub(crate) fn overhangs(
    layers: &[Layer],
    bounds: Bounds,
    settings: &Settings,
    workers: Workers<'_>,
) -> Overhangs {
    let support = SupportSettings { enabled: true, ..settings.support.clone() };
    let Unsupported { held, .. } =
        Unsupported::find(layers, bounds, &Wishes::default(), settings, &support, workers);
    let mut overhangs = Overhangs::default();
    for (i, cells) in held.iter().enumerate().filter(|(_, cells)| !cells.is_empty()) {
        let mut new = cells.clone();
        if let Some(below) = i.checked_sub(1).map(|below| &held[below]) {
            new.remove(below);
            overhangs.count += cells.parts_apart(&below.grown(1));
        } else {
            overhangs.count += cells.parts_apart(&Bitmap::empty(cells.grid()));
        }
        overhangs.area_mm2 += new.area_mm2();
        overhangs.lowest_mm.get_or_insert(layers[i].span.bottom_mm);
    }
    overhangs
}

/// All sections of a layer as one region.
pub(crate) fn section(layer: &Layer) -> Region {
    Region::disjoint(layer.sections.iter().flat_map(|s| s.region.polygons().iter().cloned()))
}

/// How many layers, of those below one, are left free to keep a distance.
fn gap_layers(below_mm: &[f64], gap_mm: f64) -> usize {
    let mut kept_mm = 0.0;
    let short = |height_mm: &&f64| {
        let is_short = kept_mm < gap_mm - NOISE_MM;
        kept_mm += **height_mm;
        is_short
    };
    below_mm.iter().rev().take_while(short).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_is_kept_by_as_many_layers_as_it_takes() {
        assert_eq!(gap_layers(&[0.2, 0.1, 0.1], 0.2), 2);
        assert_eq!(gap_layers(&[0.1, 0.1, 0.28], 0.2), 1);
        assert_eq!((gap_layers(&[0.2; 9], 0.3), gap_layers(&[0.2; 9], 0.0), gap_layers(&[], 0.3)), (2, 0, 0));
    }
}
