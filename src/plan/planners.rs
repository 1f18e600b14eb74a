//! The planners of toolpaths that follow from the settings of a plate and its objects.

use std::sync::Arc;

use crate::profile::Settings;
use crate::toolpath::infill::FillPattern;
use crate::toolpath::{
    Island, IslandId, LayerPaths, LayerWalls, ObjectLayer, Planner, PlateLayer, ToolpathSettings,
};
use crate::units::Mm;
use geometry::{Polygon, Region};

use super::styles::Styles;
use crate::parallel::Workers;

/// Layers that sparse infill is calibrated on.
const SAMPLES: usize = 12;

/// Infill that was planned for a whole print, and the number of the settings that it is for; `None`: the plate's.
pub(crate) type Planned = (Option<usize>, Arc<dyn FillPattern>);

/// The planners of a plate: one for the plate, and one for each set of settings of its own.
pub(crate) struct Planners {
    /// Lays also what belongs to no object.
    pub main: Planner,
    /// With the number of the settings.
    others: Vec<(usize, Planner)>,
}

impl Planners {
    /// Planners for objects that stand on `footprint`.
    pub fn new(settings: &Settings, styles: &Styles<'_>, footprint: &Region, first_height_mm: f64) -> Self {
        let main = Planner::new(settings.into(), footprint, first_height_mm);
        let other = |style: usize| {
            let mut own = ToolpathSettings::from(styles.numbered(style));
            (own.skirt.loops, own.brim.width) = (0, Mm(0.0));
            (style, Planner::new(own, Region::EMPTY, first_height_mm))
        };
        let others = styles.used().into_iter().map(other).collect();
        Self { main, others }
    }

    /// Fills with patterns that were planned for the whole print.
    pub fn use_patterns(&mut self, planned: &[Planned]) {
        for (style, pattern) in planned {
            if let Some((_, planner)) = self.all().find(|(number, _)| number == style) {
                planner.use_pattern(pattern.clone());
            }
        }
    }

    /// All planners, to be changed, with the number of their settings.
    fn all(&mut self) -> impl Iterator<Item = (Option<usize>, &mut Planner)> {
        let others = self.others.iter_mut().map(|(style, planner)| (Some(*style), planner));
        std::iter::once((None, &mut self.main)).chain(others)
    }

    /// Takes the skirt around part, brim and more.
    pub fn enclose<'p>(&mut self, more: impl IntoIterator<Item = &'p Polygon>, first_height_mm: f64) {
        self.main.enclose(more, first_height_mm);
    }

    /// Calibrates sparse infill on some of the layers `first..layers`.
    pub fn calibrate<'l>(
        &mut self,
        workers: Workers<'_>,
        layer: impl Fn(usize) -> PlateLayer<'l> + Sync + Send,
        first: usize,
        layers: usize,
        height_mm: f64,
    ) {
        let last = layers - 1;
        let mut chosen: Vec<usize> = (0..SAMPLES).map(|k| last * k / (SAMPLES - 1)).collect();
        chosen.dedup();
        chosen.retain(|&i| i >= first);
        for (style, planner) in self.all().filter(|(_, planner)| planner.calibrates()) {
            let samples =
                workers.map(chosen.len(), |k| planner.sparse_sample(&part(layer(chosen[k]), style)));
            planner.calibrate(&samples, height_mm);
        }
    }

    /// Combines the sparse infill of layers if the settings require it.
    pub fn combine<'l>(
        &mut self,
        workers: Workers<'_>,
        layer: impl Fn(usize) -> PlateLayer<'l> + Sync + Send,
        layers: usize,
    ) {
        for (style, planner) in self.all().filter(|(_, planner)| planner.combines()) {
            let areas = workers.map(layers, |i| {
                let layer = part(layer(i), style);
                (layer.height_mm, planner.sparse_area(&layer))
            });
            planner.combine(&areas);
        }
    }

    /// Whether the walls that others make of the same outlines are those of these.
    pub fn has_walls_of(&self, other: &Self) -> bool {
        let own = |planners: &Self| planners.others.iter().map(|(style, _)| *style).collect::<Vec<_>>();
        let each = |(a, b): (&(usize, Planner), &(usize, Planner))| a.1.has_walls_of(&b.1);
        self.main.has_walls_of(&other.main)
            && own(self) == own(other)
            && self.others.iter().zip(&other.others).all(each)
    }

    /// The walls of a layer: those of each planner.
    pub fn walls(&self, layer: &PlateLayer<'_>) -> Vec<LayerWalls> {
        self.each().map(|(style, planner)| planner.walls(&part(layer.clone(), style))).collect()
    }

    /// All planners, with the number of their settings.
    fn each(&self) -> impl Iterator<Item = (Option<usize>, &Planner)> {
        let others = self.others.iter().map(|(style, planner)| (Some(*style), planner));
        std::iter::once((None, &self.main)).chain(others)
    }

    /// All paths of a layer, the walls of each planner being known.
    pub fn filled(&self, layer: PlateLayer<'_>, walls: Vec<LayerWalls>) -> LayerPaths {
        let mut walls = walls.into_iter();
        let mut islands = Islands::default();
        let mut all: Option<LayerPaths> = None;
        for (style, planner) in self.each() {
            let own = part(layer.clone(), style);
            let mut more = planner.filled(&own, walls.next().unwrap_or_default());
            let numbers = islands.add(&own.objects, std::mem::take(&mut more.islands));
            for path in &mut more.paths {
                path.island = path.island.map(|island| numbers[island.0 as usize]);
            }
            match &mut all {
                None => all = Some(more),
                Some(all) => {
                    all.paths.append(&mut more.paths);
                    all.outline.add_disjoint(more.outline.into_polygons());
                    all.beneath = all.beneath.take().zip(more.beneath).map(|(mut all, more)| {
                        all.add_disjoint(more.into_polygons());
                        all
                    });
                }
            }
        }
        let all = all.expect("there is a planner of the plate");
        LayerPaths { islands: islands.all, ..all }
    }
}

/// The islands of a layer that several planners share: parts that have walls in common are on the same ones.
#[derive(Default)]
struct Islands<'l> {
    all: Vec<Island>,
    /// Sections, and the number of the first island of each.
    first: Vec<(&'l Region, u32)>,
}

impl<'l> Islands<'l> {
    /// Adds those of a planner; what number each has here.
    fn add(&mut self, objects: &[ObjectLayer<'l>], islands: Vec<Island>) -> Vec<IslandId> {
        let mut islands = islands.into_iter();
        let mut numbers = Vec::with_capacity(islands.len());
        for object in objects {
            let count = object.section.polygons().len();
            let own = islands.by_ref().take(count);
            let shared = object.share.and_then(|_| {
                let known = self.first.iter().find(|(section, _)| std::ptr::eq(*section, object.section));
                known.map(|(_, first)| *first)
            });
            let first = match shared {
                Some(first) => {
                    own.for_each(drop);
                    first
                }
                None => {
                    let first = self.all.len() as u32;
                    self.all.extend(own);
                    self.first.push((object.section, first));
                    first
                }
            };
            numbers.extend((0..count as u32).map(|k| IslandId(first + k)));
        }
        numbers
    }
}

/// The parts of a layer that have certain settings.
fn part<'l>(mut layer: PlateLayer<'l>, style: Option<usize>) -> PlateLayer<'l> {
    layer.objects.retain(|part| part.style == style);
    layer
}
