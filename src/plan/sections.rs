//! The sections of a plate, and what must be known of all layers before any is planned.

mod paths;
mod raft;

use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use geo::{ConvexHull, MultiPoint, Simplify};

use crate::job::JobError;
use crate::plate::Plate;
use crate::profile::Settings;
use crate::slice::{self, Layer, LayerSpan, Section, Slicer};
use crate::toolpath::infill::FillPattern;
use crate::toolpath::{self, ObjectLayer, PlateLayer, Share, ShellWindows, Shells, ToolId};
use geometry::{Bounds, Point, Polygon, Region};

use super::contact::Under;
use super::infill;
use super::modifiers;
use super::overlaps::{self, Resolved};
use super::paint;
use super::parts::{Kinds, Part, Parts};
use super::planners::Planned;
use super::spiral::Spiral;
use super::styles::Styles;
use super::supports::{self, Supports};
use super::wishes::Wishes;
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
    /// Those of other settings inside of an object, by its number and theirs.
    shells_inside: BTreeMap<(usize, usize), Shells>,
    supports: Option<Supports>,
    spiral: Option<Spiral>,
    /// Infill that was planned for all layers at once, by the settings that it is for.
    infill: Vec<Planned>,
    /// For each layer, and each of its sections, the parts that different tools print; empty: none has any.
    parts: Vec<Vec<Parts>>,
    /// The tool of each object that its file has one for.
    tools: Vec<Option<ToolId>>,
    /// The settings of each object, by their number.
    styles: Vec<Option<usize>>,
    /// Whether parts have tools of their own.
    several_tools: bool,
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
        let modified = workers.map(cut.len(), |i| modifiers::of_layer(&cut[i]));
        let Resolved { mut notes, pieces } = overlaps::resolve(&mut cut, slicer.plate(), &kinds, workers);
        let parts = |i: usize| -> Vec<Parts> {
            let painted = painted.get(i).map_or(&[][..], Vec::as_slice);
            let parts = |(place, section): (usize, &Section)| {
                let pieces = pieces.get(i).map_or_else(Vec::new, |pieces| pieces[place].clone());
                kinds.parts((section, cut[i].span.height_mm), pieces, &modified[i], painted, styles, settings)
            };
            cut[i].sections.iter().enumerate().map(parts).collect()
        };
        let mut parts = workers.map(cut.len(), parts);
        if parts.iter().flatten().all(Parts::is_empty) {
            parts.clear();
        }
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
            shells_inside: BTreeMap::new(),
            supports: None,
            spiral: None,
            infill: Vec::new(),
            parts,
            tools: (0..count).map(|object| styles.tool(object)).collect(),
            styles: (0..count).map(|object| styles.of_objects().get(object).copied().flatten()).collect(),
            several_tools: settings.tools.len() > 1,
            notes,
        };
        if settings.spiral.enabled {
            // The lowest layer is level in any case: the nozzle cannot begin in the bed.
            let part_mm = heights_mm.get(raft_layers..).unwrap_or_default();
            let first = raft_layers + toolpath::bottom_layers(part_mm, &settings.shell).max(1);
            sections.spiral = Some(Spiral::new(&sections.layers, count, first, settings, workers)?);
        }
        let shells = |object: usize, style: Option<usize>| {
            let shell = &styles.inside(object, style, settings).shell;
            let own: Vec<&Region> = (0..sections.layers.len()).map(|i| sections.of(object, i)).collect();
            Shells::build(&own, &heights_mm, shell, &|n, f| workers.map(n, f))
        };
        let of_objects = (0..count).map(|object| shells(object, None)).collect();
        let inside = sections.styles_inside().into_iter();
        let inside = inside.map(|(object, style)| ((object, style), shells(object, Some(style)))).collect();
        (sections.shells, sections.shells_inside) = (of_objects, inside);
        let part = &sections.layers[raft_layers.min(sections.layers.len())..];
        let wishes = Wishes::new(part, slicer.plate(), modifiers, settings, workers);
        if settings.support.enabled || wishes.any() {
            let bounds = sections.bounds();
            sections.supports = bounds.map(|bounds| Supports::plan(part, bounds, &wishes, settings, workers));
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
        let part = Under::new(&beneath);
        let supports: LazyCell<Vec<Under<'_>>, _> =
            LazyCell::new(|| self.supports_under(index).map(Under::new).collect());
        let islands = self.layers[index].sections.iter().flat_map(|section| section.region.polygons());
        let begun = islands.filter(|island| {
            !part.carries(island)
                && !supports.iter().any(|support| support.carries(island))
                && holds_line(island)
        });
        begun.map(Polygon::area_mm2).collect()
    }

    /// An object's section in a layer; nothing above its top.
    pub fn of(&self, object: usize, layer: usize) -> &Region {
        let place = self.places[object].get(layer).copied().flatten();
        place.map_or(Region::EMPTY, |place| &self.layers[layer].sections[place].region)
    }

    /// The parts of the section of a layer that has this place.
    fn parts(&self, index: usize, place: usize) -> &[Part] {
        self.parts.get(index).and_then(|parts| parts.get(place)).map_or(&[], Vec::as_slice)
    }

    /// The objects that have other settings inside, with these.
    fn styles_inside(&self) -> BTreeSet<(usize, usize)> {
        let mut found = BTreeSet::new();
        for (layer, of_layer) in self.layers.iter().zip(&self.parts) {
            for (section, part) in
                layer.sections.iter().zip(of_layer).flat_map(|(s, parts)| parts.iter().map(move |p| (s, p)))
            {
                let styles = part.fills.iter().map(|(style, _)| *style).chain([part.style]).flatten();
                found.extend(styles.map(|style| (section.object, style)));
            }
        }
        found
    }

    pub fn plate_layer(&self, index: usize) -> PlateLayer<'_> {
        let Layer { span, sections, .. } = &self.layers[index];
        let mut objects = Vec::with_capacity(sections.len());
        for (place, Section { object, region }) in sections.iter().enumerate() {
            let first = objects.len();
            let whole = self.piece(index, *object, region, self.tools[*object], None);
            match self.parts(index, place) {
                [] => objects.push(whole),
                parts => objects.extend(parts.iter().flat_map(|part| self.of_part(index, *object, part))),
            }
            objects[first].is_first = true;
        }
        PlateLayer { index, top_mm: span.top_mm, height_mm: span.height_mm, objects }
    }

    /// A part of an object at a layer, by the settings that fill it.
    fn of_part<'s>(
        &'s self,
        index: usize,
        object: usize,
        part: &'s Part,
    ) -> impl Iterator<Item = ObjectLayer<'s>> {
        let tool = self.several_tools.then_some(part.tool);
        let whole = part.fills.is_empty().then(|| self.piece(index, object, &part.region, tool, part.style));
        let shared = part.fills.iter().enumerate().map(move |(number, (style, filled))| ObjectLayer {
            share: Some(Share { filled, has_walls: number == 0 }),
            ..self.piece(index, object, &part.region, tool, *style)
        });
        whole.into_iter().chain(shared)
    }

    /// A piece of an object at a layer; `style`: settings inside of it.
    fn piece<'s>(
        &'s self,
        index: usize,
        object: usize,
        section: &'s Region,
        tool: Option<ToolId>,
        style: Option<usize>,
    ) -> ObjectLayer<'s> {
        let shells =
            style.and_then(|style| self.shells_inside.get(&(object, style))).unwrap_or(&self.shells[object]);
        let beneath = index.checked_sub(1);
        ObjectLayer {
            object: object as u32,
            section,
            tool,
            style: style.or(self.styles[object]),
            share: None,
            is_first: false,
            above: self.of(object, index + 1),
            beneath: beneath.filter(|&below| below >= self.raft_layers).map(|below| self.of(object, below)),
            windows: shells.windows(index),
            windows_beneath: beneath.map_or_else(ShellWindows::default, |beneath| shells.windows(beneath)),
        }
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
            && self.styles == other.styles
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
