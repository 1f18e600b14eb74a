//! The sections of a plate, and what must be known of all layers before any is planned.

mod paths;
mod raft;

use std::sync::Arc;

use geo::{ConvexHull, MultiPoint, Simplify};

use crate::job::JobError;
use crate::plate::Plate;
use crate::profile::Settings;
use crate::slice::{self, Layer, LayerSpan, Slicer};
use crate::toolpath::infill::FillPattern;
use crate::toolpath::{self, ObjectLayer, PlateLayer, ShellWindows, Shells, ToolId};
use geometry::{Bounds, Point, Polygon, Region};

use super::contact;
use super::infill;
use super::overlaps::{self, Resolved};
use super::paint;
use super::parts::{Kinds, Parts};
use super::spiral::Spiral;
use super::styles::{Planned, Styles};
use super::supports::{self, Supports};
use crate::parallel::Workers;

/// How far the outline of a label may differ from the object's hull, millimetres.
const LABEL_TOLERANCE_MM: f64 = 0.05;

/// The sections of all layers, and the shells that follow from them.
pub(crate) struct Sections {
    /// Those of a raft first; they have no section.
    pub layers: Vec<Layer>,
    /// How many are a raft's.
    raft_layers: usize,
    /// Numbers of the objects on the plate.
    objects: Vec<usize>,
    /// For each object its section in each layer, as an index into the layer's sections.
    places: Vec<Vec<Option<usize>>>,
    shells: Vec<Shells>,
    supports: Option<Supports>,
    spiral: Option<Spiral>,
    /// Infill that was planned for all layers at once, by the settings that it is for.
    infill: Vec<Planned>,
    /// For each layer, and each of its sections, the parts that different tools print; empty: none has any.
    parts: Vec<Vec<Parts>>,
    /// The tool of each object that its file has one for.
    tools: Vec<Option<ToolId>>,
    /// On objects that overlap.
    notes: Vec<String>,
}

impl Sections {
    /// Cuts the objects of a slicer, which have these numbers on the whole plate, and plans what depends on several
    /// layers.
    ///
    /// # Errors
    /// They cannot be printed as one spiral, if requested.
    pub fn cut(
        slicer: &Slicer<'_>,
        objects: Vec<usize>,
        styles: &Styles<'_>,
        modifiers: &[Plate; 2],
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Self, JobError> {
        let count = objects.len();
        let mut cut = workers.map(slicer.spans().len(), |i| slicer.layer(i));
        let kinds = Kinds::new(count, styles, settings);
        let painted = paint::parts(&cut, slicer.plate(), settings, workers);
        let Resolved { mut notes, mut parts } = overlaps::resolve(&mut cut, slicer.plate(), &kinds, workers);
        kinds.lay_over(&cut, &mut parts, &painted);
        notes.extend(paint::note(slicer.plate(), settings));
        let layers = raft::raised(cut, settings);
        if !parts.is_empty() {
            parts.splice(0..0, std::iter::repeat_n(Vec::new(), settings.raft.layers as usize));
        }
        let places: Vec<Vec<Option<usize>>> = (0..count)
            .map(|object| layers.iter().map(|l| l.sections.iter().position(|s| s.object == object)).collect())
            .collect();
        let raft_layers = settings.raft.layers as usize;
        let spans: Vec<LayerSpan> = layers.iter().map(|layer| layer.span).collect();
        let heights_mm = slice::heights_mm(&spans, &settings.layer);
        let mut sections = Self {
            layers,
            raft_layers,
            objects,
            places,
            shells: Vec::new(),
            supports: None,
            spiral: None,
            infill: Vec::new(),
            parts,
            tools: (0..count).map(|object| styles.tool(object)).collect(),
            notes,
        };
        if settings.spiral.enabled {
            // The lowest layer is level in any case: the nozzle cannot begin in the bed.
            let part_mm = heights_mm.get(raft_layers..).unwrap_or_default();
            let first = raft_layers + toolpath::bottom_layers(part_mm, &settings.shell).max(1);
            sections.spiral = Some(Spiral::new(&sections.layers, count, first, settings, workers)?);
        }
        sections.shells = (0..count)
            .map(|object| {
                let shell = &styles.settings(object, settings).shell;
                let own: Vec<&Region> = (0..sections.layers.len()).map(|i| sections.of(object, i)).collect();
                Shells::build(&own, &heights_mm, shell, &|n, f| workers.map(n, f))
            })
            .collect();
        if settings.support.enabled || !modifiers[0].meshes.is_empty() {
            let bounds = sections.bounds();
            let part = &sections.layers[raft_layers.min(sections.layers.len())..];
            sections.supports =
                bounds.map(|bounds| Supports::plan(part, bounds, modifiers, settings, workers));
        }
        sections.infill = styles
            .each(settings)
            .filter_map(|(style, settings)| {
                Some((style, sections.infill_pattern(slicer.plate(), settings, workers)?))
            })
            .collect();
        Ok(sections)
    }

    /// The infill pattern, where it must know all layers.
    fn infill_pattern(
        &self,
        plate: &Plate,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Option<Arc<dyn FillPattern>> {
        let layer = |i: usize| self.plate_layer(i);
        infill::plan(plate, self.bottom_mm(), self.layers.len(), layer, settings, workers)
    }

    /// Where the part begins over the bed.
    pub fn bottom_mm(&self) -> f64 {
        self.layers.get(self.raft_layers).map_or(0.0, |layer| layer.span.bottom_mm)
    }

    /// The part's first layer.
    pub fn first_layer(&self) -> usize {
        self.raft_layers
    }

    /// Numbers of the objects on the plate.
    pub fn objects(&self) -> &[usize] {
        &self.objects
    }

    /// The number here of an object of the plate.
    pub fn local(&self, object: usize) -> Option<usize> {
        self.objects.iter().position(|&number| number == object)
    }

    /// Outlines of the supports that may carry a layer.
    pub fn supports_under(&self, index: usize) -> impl Iterator<Item = &Region> {
        let supports = self.supports.iter();
        supports.flat_map(move |supports| supports.under(index.saturating_sub(self.raft_layers)))
    }

    /// Areas of the islands of a layer that neither the section beneath nor support carries, mm². What is thinner than
    /// `thin_mm` neither counts nor carries.
    pub fn begun_in_air(&self, index: usize, thin_mm: f64) -> Vec<f64> {
        let holds_line = |polygon: &Polygon| {
            let length_mm: f64 = polygon.rings().map(|ring| geometry::ring_length_mm(ring)).sum();
            2.0 * polygon.area_mm2() >= 2.0 * thin_mm * length_mm
                || !geometry::offset(&Region::from(polygon.clone()), -thin_mm / 2.0).is_empty()
        };
        let beneath = supports::section(&self.layers[index - 1]);
        let islands = self.layers[index].sections.iter().flat_map(|section| section.region.polygons());
        let begun = islands.filter(|island| {
            !contact::lies_on(island, &beneath)
                && !self.supports_under(index).any(|under| contact::lies_on(island, under))
                && holds_line(island)
        });
        begun.map(Polygon::area_mm2).collect()
    }

    /// An object's section in a layer; nothing above its top.
    pub fn of(&self, object: usize, layer: usize) -> &Region {
        let place = self.places[object].get(layer).copied().flatten();
        place.map_or(Region::EMPTY, |place| &self.layers[layer].sections[place].region)
    }

    pub fn plate_layer(&self, index: usize) -> PlateLayer<'_> {
        let Layer { span, sections, .. } = &self.layers[index];
        let parts = |place: usize| {
            let parts =
                self.parts.get(index).and_then(|parts| parts.get(place)).map_or(&[][..], Vec::as_slice);
            let section = &sections[place];
            let whole = parts.is_empty().then(|| (&section.region, self.tools[section.object]));
            whole.into_iter().chain(parts.iter().map(|part| (&part.region, Some(part.tool))))
        };
        let pieces = (0..sections.len())
            .flat_map(|place| parts(place).map(move |(region, tool)| (&sections[place], region, tool)));
        let objects = pieces.map(|(s, section, tool)| ObjectLayer {
            object: s.object as u32,
            section,
            tool,
            above: self.of(s.object, index + 1),
            beneath: index
                .checked_sub(1)
                .filter(|&below| below >= self.raft_layers)
                .map(|below| self.of(s.object, below)),
            windows: self.shells[s.object].windows(index),
            windows_beneath: index
                .checked_sub(1)
                .map_or_else(ShellWindows::default, |beneath| self.shells[s.object].windows(beneath)),
        });
        PlateLayer { index, top_mm: span.top_mm, height_mm: span.height_mm, objects: objects.collect() }
    }

    /// Whether the outlines are those of others, and so are the layers that a spiral has.
    pub fn has_outlines_of(&self, other: &Self) -> bool {
        let spiral = |sections: &Self| {
            let spiral = sections.spiral.as_ref();
            spiral.map(|spiral| (0..sections.layers.len()).position(|i| spiral.has(i)))
        };
        self.objects == other.objects
            && self.raft_layers == other.raft_layers
            && spiral(self) == spiral(other)
            && self.layers == other.layers
            && self.parts == other.parts
            && self.tools == other.tools
    }

    /// Box around everything that is printed, without skirt and brim.
    pub fn bounds(&self) -> Option<Bounds> {
        let regions = self.layers.iter().flat_map(|l| &l.sections);
        regions.filter_map(|s| s.region.bounds()).reduce(|a, b| a.joined(&b))
    }

    /// The convex hull of each object, with its number on the plate; empty if no layer holds any of it.
    pub fn hulls(&self, workers: Workers<'_>) -> Vec<(usize, Vec<[f64; 2]>)> {
        let hull = |object: usize| {
            let regions = (0..self.layers.len()).map(|layer| self.of(object, layer));
            let outers = regions.flat_map(|region| region.polygons()).flat_map(|polygon| &polygon.outer);
            hull_mm(outers.map(|p: &Point| p.mm()), LABEL_TOLERANCE_MM)
        };
        let hulls = workers.map(self.objects.len(), hull);
        self.objects.iter().copied().zip(hulls).collect()
    }

    /// What the user should know.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let notes = self.notes.iter().cloned();
        notes
            .chain(self.open_outlines())
            .chain(self.spiral.as_ref().and_then(|spiral| spiral.warning.clone()))
    }

    /// Of outlines that were not closed.
    fn open_outlines(&self) -> Option<String> {
        let mut forced = self.layers.iter().filter(|l| l.gaps.forced > 0);
        let first = forced.next()?;
        Some(format!(
            "{} layers, the first at {:.2} mm, have outlines with wide gaps, which were closed by straight lines; \
             repair the model if the preview shows walls where there should be none",
            1 + forced.count(),
            first.span.top_mm
        ))
    }
}

/// Corners of the convex hull of points, millimetres; it may differ by a tolerance.
pub(crate) fn hull_mm(points: impl Iterator<Item = [f64; 2]>, tolerance_mm: f64) -> Vec<[f64; 2]> {
    let points: MultiPoint<f64> = points.map(|[x, y]| (x, y)).collect();
    let hull = points.convex_hull().simplify(tolerance_mm);
    // The first corner is repeated at the end.
    hull.exterior().points().map(|p| [p.x(), p.y()]).skip(1).collect()
}
