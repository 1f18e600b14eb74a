//! Meshes → cross-sections, layer by layer.
//!
//! [`spans()`] says where the layers lie, a [`Slicer`] prepares the meshes of a plate once and then cuts any layer by
//! itself, so that layers can be cut in parallel.

mod cutter;
mod fill;
mod heights;
mod nest;
mod options;
mod paint;
mod plan;
mod simplify;
mod stitch;
mod table;
mod volume;

pub use cutter::Cutter;
pub use heights::{cusp_limit_mm, heights_mm, is_uniform, spans};
pub use options::LayerSettings;
pub use paint::{PaintedArea, PaintedLine, level_paint};
pub(crate) use paint::{is_steep, paint_between};
pub use plan::{LayerSpan, plan};
pub use table::{heights_from_lines, layer_heights};
pub use volume::volume_mm3;

use crate::mesh::{Effect, Mesh, Wish};
use crate::plate::{Object, Plate};
use geometry::{Point, Region, offset};
use paint::PaintCutter;

/// The cross-section of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Index into [`Plate::objects`].
    pub object: usize,
    /// The area to print, in bed coordinates.
    pub region: Region,
}

/// The section of a body in which settings of its own hold.
#[derive(Clone, Debug, PartialEq)]
pub struct ModifiedArea {
    /// Index into [`Plate::objects`].
    pub object: usize,
    /// Index into [`Mesh::modifiers`](crate::mesh::Mesh::modifiers).
    pub modifier: usize,
    /// Its section, in bed coordinates.
    pub region: Region,
}

/// What had to be repaired in a layer's outlines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gaps {
    /// Loose ends joined across a gap within the tolerance.
    pub joined: usize,
    /// Outlines closed across a larger gap, as a last resort.
    pub forced: usize,
}

impl std::ops::AddAssign for Gaps {
    fn add_assign(&mut self, other: Self) {
        self.joined += other.joined;
        self.forced += other.forced;
    }
}

/// One layer: where it lies, and what is solid in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Number and heights.
    pub span: LayerSpan,
    /// One section for each object that is solid here, in the order of the objects.
    pub sections: Vec<Section>,
    /// Where seams are painted.
    pub seams: Vec<PaintedLine<Wish>>,
    /// Where tools are painted, counted from 1.
    pub tools: Vec<PaintedLine<u8>>,
    /// Where objects have other settings inside, in the order in which these take effect.
    pub modified: Vec<ModifiedArea>,
    /// Diagnostics; zeros for a watertight mesh.
    pub gaps: Gaps,
}

/// The meshes of a plate, prepared for cutting.
#[derive(Debug)]
pub struct Slicer<'a> {
    plate: &'a Plate,
    cutters: Vec<Cutter<'a>>,
    /// Of each mesh the bodies in which settings of their own hold, with their numbers.
    modifiers: Vec<Vec<(usize, Cutter<'a>)>>,
    seams: Vec<PaintCutter<'a, Wish>>,
    tools: Vec<PaintCutter<'a, u8>>,
    spans: Vec<LayerSpan>,
    grow_mm: f64,
    elephant_foot_mm: f64,
}

impl<'a> Slicer<'a> {
    /// Plans the layers up to the highest object, and sorts triangles by layer. O(triangles + crossings).
    pub fn new(plate: &'a Plate, settings: &LayerSettings) -> Self {
        Self::with_spans(plate, spans(plate, settings), settings)
    }

    /// The same with layers that are planned already.
    pub fn with_spans(plate: &'a Plate, spans: Vec<LayerSpan>, settings: &LayerSettings) -> Self {
        let cutters = plate.meshes.iter().map(|m| Cutter::new(m, &spans, settings)).collect();
        let meshes = || plate.meshes.iter();
        let bodies = |mesh: &'a Mesh| {
            let numbered = mesh.modifiers().iter().enumerate();
            let with_settings =
                numbered.filter(|(_, modifier)| matches!(modifier.effect, Effect::Settings(_)));
            with_settings.map(|(number, body)| (number, Cutter::new(&body.mesh, &spans, settings))).collect()
        };
        let modifiers = meshes().map(bodies).collect();
        let seams = meshes().map(|m| PaintCutter::new(m, &spans, |paint| &paint.seams)).collect();
        let tools = meshes().map(|m| PaintCutter::new(m, &spans, |paint| &paint.tools)).collect();
        Self {
            plate,
            cutters,
            modifiers,
            seams,
            tools,
            spans,
            grow_mm: settings.xy_compensation.0,
            elephant_foot_mm: settings.elephant_foot.0,
        }
    }

    /// Where the layers lie.
    pub fn spans(&self) -> &[LayerSpan] {
        &self.spans
    }

    /// The plate.
    pub fn plate(&self) -> &'a Plate {
        self.plate
    }

    /// Cuts one layer. Layers are independent of each other.
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn layer(&self, index: usize) -> Layer {
        let foot_mm = if index == 0 { self.elephant_foot_mm } else { 0.0 };
        let mut gaps = Gaps::default();
        let regions: Vec<Region> = self
            .cutters
            .iter()
            .map(|cutter| {
                let (region, found) = cutter.section(index);
                gaps += found;
                offset(&region, self.grow_mm - foot_mm)
            })
            .collect();
        let objects = self.plate.objects.iter().enumerate();
        let seams = self.painted(&self.seams, index);
        let tools = self.painted(&self.tools, index);
        let sections = objects
            .filter(|(_, object)| !regions[object.mesh].is_empty())
            .map(|(index, object)| Section {
                object: index,
                region: regions[object.mesh].translated(object.offset),
            })
            .collect();
        let modified = self.modified(index);
        Layer { span: self.spans[index], sections, seams, tools, modified, gaps }
    }

    /// Where objects have other settings inside.
    fn modified(&self, index: usize) -> Vec<ModifiedArea> {
        let of = |(object, placed): (usize, &'a Object)| {
            let area = move |(modifier, cutter): &(usize, Cutter<'_>)| ModifiedArea {
                object,
                modifier: *modifier,
                region: cutter.section(index).0.translated(placed.offset),
            };
            self.modifiers[placed.mesh].iter().map(area)
        };
        let areas = self.plate.objects.iter().enumerate().flat_map(of);
        areas.filter(|area| !area.region.is_empty()).collect()
    }

    /// What is painted on the objects where a layer's cut is.
    fn painted<T: Copy>(&self, cutters: &[PaintCutter<'_, T>], index: usize) -> Vec<PaintedLine<T>> {
        let of = |(object, of): (usize, &Object)| {
            let by = of.offset;
            let line = move |(ends, paint): ([Point; 2], T)| PaintedLine {
                object,
                ends: ends.map(|end| end + by),
                paint,
            };
            cutters[of.mesh].lines(index).map(line)
        };
        self.plate.objects.iter().enumerate().flat_map(of).collect()
    }
}

/// Every layer of a plate.
pub fn slice(plate: &Plate, settings: &LayerSettings) -> Vec<Layer> {
    let slicer = Slicer::new(plate, settings);
    (0..slicer.spans().len()).map(|index| slicer.layer(index)).collect()
}
