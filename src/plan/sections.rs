//! The sections of a plate, and what must be known of all layers before any is planned.

use std::sync::Arc;

use geo::{ConvexHull, MultiPoint, Simplify};

use crate::job::JobError;
use crate::plate::Plate;
use crate::profile::Settings;
use crate::slice::{self, Gaps, Layer, LayerSpan, Slicer};
use crate::toolpath::SupportStyle;
use crate::toolpath::infill::FillPattern;
use crate::toolpath::support::{self, BeadSpec, Outlines};
use crate::toolpath::{self, LayerPaths, ObjectLayer, Planner, PlateLayer, Role, ShellWindows, Shells};
use geometry::{Bounds, Point, Polygon, Region};

use super::contact;
use super::infill;
use super::overlaps;
use super::spiral::Spiral;
use super::styles::{Planned, Planners, Styles};
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
    /// On objects that overlap.
    notes: Vec<String>,
}

impl Sections {
    /// Cuts the objects of a slicer, which have these numbers on the whole plate, and plans what depends on several
    /// layers.
    ///
    /// # Errors
    /// They cannot be printed as one spiral, if that is asked for.
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
        let notes = overlaps::resolve(&mut cut, slicer.plate(), styles, workers);
        let layers = raised(cut, settings);
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
                || !geometry::offset(&Region { polygons: vec![polygon.clone()] }, -thin_mm / 2.0).is_empty()
        };
        let beneath = supports::section(&self.layers[index - 1]);
        let islands = self.layers[index].sections.iter().flat_map(|section| &section.region.polygons);
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
        let objects = sections.iter().map(|s| ObjectLayer {
            object: s.object as u32,
            section: &s.region,
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

    /// All paths of a layer; support comes before what it carries.
    pub fn paths(&self, planners: &Planners, index: usize, settings: &Settings) -> LayerPaths {
        let turn = self.spiral.as_ref().and_then(|spiral| {
            let below = index.checked_sub(1).map_or(Region::EMPTY, |below| self.of(0, below));
            spiral.layer(&self.layers[index].span, self.of(0, index), below)
        });
        let is_turn = turn.is_some();
        let mut layer = turn.unwrap_or_else(|| planners.layer(self.plate_layer(index)));
        for island in &mut layer.islands {
            island.object = self.objects[island.object as usize] as u32;
        }
        if is_turn {
            return layer;
        }
        let beads = match (index.checked_sub(self.raft_layers), &self.supports) {
            (None, _) => {
                let width_mm =
                    [settings.walls.width.0, settings.first_layer.width.0][usize::from(index == 0)];
                let width_mm = if width_mm > 0.0 { width_mm } else { settings.walls.width.0 };
                let area = planners.main.covered();
                toolpath::raft(area, index as u32, &settings.raft, width_mm, layer.height_mm)
            }
            (Some(_), None) => return layer,
            (Some(above_raft), Some(supports)) => supports.beads(above_raft).to_vec(),
        };
        let around = |role| matches!(role, Role::Skirt | Role::Brim);
        let place = layer.paths.iter().position(|p| !around(p.role)).unwrap_or(layer.paths.len());
        layer.paths.splice(place..place, beads);
        layer
    }

    /// Lays the beads of supports, beside what the planner lays on the bed.
    pub fn lay_supports(&mut self, planner: &Planner, settings: &Settings, workers: Workers<'_>) {
        let Some(supports) = &mut self.supports else { return };
        let (part, on_raft) = (&self.layers[self.raft_layers..], self.raft_layers > 0);
        let lay = |outlines: &Outlines, above_raft: usize| {
            let (first, layer) = (above_raft == 0, &part[above_raft]);
            // Support stands on the raft, over which the part floats.
            let gap_mm = if first && on_raft { settings.raft.gap.0 } else { 0.0 };
            // Trees are clear of the part already, though not of what surrounds it on the bed.
            let tree = settings.support.style == SupportStyle::Tree;
            let spec = BeadSpec {
                part: match first && !on_raft {
                    true => planner.covered(),
                    false if tree => Region::EMPTY,
                    false => &geometry::simplify(&supports::section(layer), support::ROUGH_MM),
                },
                height_mm: layer.span.height_mm + gap_mm,
                usual_height_mm: settings.layer.height.0,
                on_bed: first,
            };
            support::lay(outlines, &spec, &settings.support)
        };
        supports.lay(lay, part, workers);
    }

    /// The toolpath planners, their sparse infill calibrated on sample layers. The skirt goes also around `around`.
    pub fn planners(
        &self,
        styles: &Styles<'_>,
        settings: &Settings,
        around: &[Polygon],
        workers: Workers<'_>,
    ) -> Planners {
        let mut footprint = supports::section(&self.layers[self.raft_layers]);
        let standing = self.supports.as_ref().map_or(Region::EMPTY, |supports| &supports.outlines(0).all);
        if self.raft_layers > 0 {
            footprint = toolpath::raft_area(&geometry::union(&footprint, standing), &settings.raft);
        }
        let first_height_mm = self.layers[0].span.height_mm;
        let mut planners = Planners::new(settings, styles, &footprint, first_height_mm);
        planners.use_patterns(&self.infill);
        let shielded = if settings.skirt.draft_shield { self.layers.len() } else { 0 };
        let sections = self.layers[..shielded].iter().flat_map(|l| &l.sections).map(|s| &s.region);
        let supports = self.supports.iter().flat_map(|s| s.all_outlines(shielded.max(1)));
        let enclosed = sections.chain(supports).flat_map(|region| &region.polygons).chain(around);
        planners.enclose(enclosed, first_height_mm);
        let height_mm = self.layers.last().map_or(first_height_mm, |last| last.span.height_mm);
        let layer = |i: usize| self.plate_layer(i);
        planners.calibrate(workers, layer, self.raft_layers + 1, self.layers.len(), height_mm);
        planners.combine(workers, layer, self.layers.len());
        planners
    }

    /// What is printed on the bed: the objects with brim and raft, and their supports.
    pub fn on_bed(&self, planners: &Planners) -> Vec<Polygon> {
        let supports = self.supports.iter().flat_map(|supports| supports.all_outlines(1));
        let regions = std::iter::once(planners.main.covered()).chain(supports);
        regions.flat_map(|region| region.polygons.iter().cloned()).collect()
    }

    /// Outlines of what the first layer prints: section, brim, supports and skirt, millimetres; all larger by `more_mm`.
    pub fn first_layer_outlines(&self, planners: &Planners, more_mm: f64) -> Vec<Vec<[f64; 2]>> {
        let outer = |polygon: &Polygon| polygon.outer.iter().map(|p| p.mm()).collect();
        let around = planners.main.skirt_outline(self.layers[0].span.height_mm);
        let all = Region { polygons: self.on_bed(planners).into_iter().chain(around).collect() };
        geometry::offset(&all, more_mm).polygons.iter().map(outer).collect()
    }

    /// Box around everything that is printed, without skirt and brim.
    pub fn bounds(&self) -> Option<Bounds> {
        let regions = self.layers.iter().flat_map(|l| &l.sections);
        regions.filter_map(|s| s.region.bounds()).reduce(|a, b| a.joined(&b))
    }

    /// The convex hull of each object, with its number on the plate; empty where no layer holds anything of it.
    pub fn hulls(&self, workers: Workers<'_>) -> Vec<(usize, Vec<[f64; 2]>)> {
        let hull = |object: usize| {
            let regions = (0..self.layers.len()).map(|layer| self.of(object, layer));
            let outers = regions.flat_map(|region| &region.polygons).flat_map(|polygon| &polygon.outer);
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

/// The layers of a raft, and on them those of the part.
fn raised(cut: Vec<Layer>, settings: &Settings) -> Vec<Layer> {
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
        Layer { span, sections: Vec::new(), gaps: Gaps::default() }
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
