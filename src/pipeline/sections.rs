//! The sections of a plate, and what must be known of all layers before any is planned.

use crate::geom::{Bounds, Region};
use crate::profile::Settings;
use crate::slice::{Layer, Slicer};
use crate::toolpath::support::{self, BeadSpec};
use crate::toolpath::{LayerPaths, ObjectLayer, Planner, PlateLayer, Role, Shells};

use super::parallel;
use super::supports::{self, Supports};

/// Layers that sparse infill is calibrated on.
const SAMPLES: usize = 12;

/// Runs of support among the paths that belong to no island, after skirt and brim.
const SUPPORT_RANK: u32 = 2;

/// The sections of all layers, and the shells that follow from them.
pub(super) struct Sections {
    pub layers: Vec<Layer>,
    /// For each object its section in each layer, as an index into the layer's sections.
    places: Vec<Vec<Option<usize>>>,
    shells: Vec<Shells>,
    supports: Option<Supports>,
}

impl Sections {
    pub fn cut(slicer: &Slicer<'_>, objects: usize, settings: &Settings) -> Self {
        let layers = parallel::map(slicer.spans().len(), |i| slicer.layer(i));
        let places: Vec<Vec<Option<usize>>> = (0..objects)
            .map(|object| layers.iter().map(|l| l.sections.iter().position(|s| s.object == object)).collect())
            .collect();
        let mut sections = Self { layers, places, shells: Vec::new(), supports: None };
        let (top, bottom) = (settings.shell.top_layers, settings.shell.bottom_layers);
        sections.shells = (0..objects)
            .map(|object| {
                let own: Vec<&Region> = (0..sections.layers.len()).map(|i| sections.of(object, i)).collect();
                Shells::build(&own, top, bottom, &|n, f| parallel::map(n, f))
            })
            .collect();
        if settings.support.enabled {
            let bounds = sections.bounds();
            sections.supports = bounds.map(|bounds| Supports::plan(&sections.layers, bounds, settings));
        }
        sections
    }

    /// An object's section in a layer; nothing above its top.
    fn of(&self, object: usize, layer: usize) -> &Region {
        let place = self.places[object].get(layer).copied().flatten();
        place.map_or(Region::EMPTY, |place| &self.layers[layer].sections[place].region)
    }

    pub fn plate_layer(&self, index: usize) -> PlateLayer<'_> {
        let Layer { span, sections, .. } = &self.layers[index];
        let objects = sections.iter().map(|s| ObjectLayer {
            object: s.object as u32,
            section: &s.region,
            next: self.of(s.object, index + 1),
            above: self.shells[s.object].above(index),
            below: self.shells[s.object].below(index),
        });
        PlateLayer { index, top_mm: span.top_mm, height_mm: span.height_mm, objects: objects.collect() }
    }

    /// All paths of a layer; support comes before what it carries.
    pub fn paths(&self, planner: &Planner, index: usize, settings: &Settings) -> LayerPaths {
        let mut layer = planner.layer(&self.plate_layer(index));
        if let Some(supports) = &self.supports {
            let outlines = supports.outlines(index);
            let spec = BeadSpec {
                part: &layer.outline,
                height_mm: layer.height_mm,
                on_bed: index == 0,
                rank: SUPPORT_RANK,
            };
            let beads = support::lay(outlines, &spec, &settings.support);
            let around = |role| matches!(role, Role::Skirt | Role::Brim);
            let place = layer.paths.iter().position(|p| !around(p.role)).unwrap_or(layer.paths.len());
            layer.paths.splice(place..place, beads);
        }
        layer
    }

    /// The toolpath planner, its sparse infill calibrated on sample layers.
    pub fn planner(&self, settings: &Settings) -> Planner {
        let footprint = supports::section(&self.layers[0]);
        let first_height_mm = self.layers[0].span.height_mm;
        let mut planner = Planner::new(settings.into(), &footprint, first_height_mm);
        if let Some(supports) = &self.supports {
            planner.enclose(&supports.outlines(0).all, first_height_mm);
        }
        let last = self.layers.len() - 1;
        let mut chosen: Vec<usize> = (0..SAMPLES).map(|k| last * k / (SAMPLES - 1)).collect();
        chosen.dedup();
        chosen.retain(|&i| i > 0);
        let samples = parallel::map(chosen.len(), |k| planner.sparse_sample(&self.plate_layer(chosen[k])));
        planner.calibrate(&samples, self.layers[last].span.height_mm);
        planner
    }

    /// Box around everything that is printed, without skirt and brim.
    pub fn bounds(&self) -> Option<Bounds> {
        let regions = self.layers.iter().flat_map(|l| &l.sections);
        regions.filter_map(|s| s.region.bounds()).reduce(|a, b| a.joined(&b))
    }

    /// What the user should know of outlines that were not closed.
    pub fn warning(&self) -> Option<String> {
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
