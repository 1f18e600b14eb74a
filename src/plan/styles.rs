//! Settings that some objects have of their own, and the planners that follow from them.

use std::sync::Arc;

use crate::job::{JobError, ObjectSettings};
use crate::profile::{Origin, Problem, ProfileError, Settings};
use crate::toolpath::infill::FillPattern;
use crate::toolpath::{IslandId, LayerPaths, Planner, PlateLayer, ToolpathSettings};
use crate::units::Mm;
use geometry::{Polygon, Region};

use crate::parallel::Workers;

/// Layers that sparse infill is calibrated on.
const SAMPLES: usize = 12;

/// Infill that was planned for a whole print, and the number of the settings that it is for; `None`: the plate's.
pub(crate) type Planned = (Option<usize>, Arc<dyn FillPattern>);

/// The settings of each object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Styles<'a> {
    /// For each object its own settings, as an index; `None`: it has those of the plate.
    of_object: Vec<Option<usize>>,
    own: &'a [ObjectSettings],
}

impl<'a> Styles<'a> {
    /// Finds the objects that settings are for. `names[i]` are all the names by which object i may be called.
    ///
    /// # Errors
    /// Settings for no object, or twice for one.
    pub fn new(own: &'a [ObjectSettings], names: &[Vec<String>]) -> Result<Self, JobError> {
        let mut of_object: Vec<Option<usize>> = vec![None; names.len()];
        let mut problems = Vec::new();
        let mut problem = |message| {
            problems.push(Problem { origin: Origin::Option("--object"), setting: None, message });
        };
        for (style, ObjectSettings { object: wanted, .. }) in own.iter().enumerate() {
            let meant: Vec<usize> = (0..names.len()).filter(|&i| names[i].contains(wanted)).collect();
            if meant.is_empty() {
                let mut known: Vec<&str> = names.iter().filter_map(|n| Some(n.first()?.as_str())).collect();
                known.dedup();
                problem(format!("there is no object `{wanted}`; there are: {}", known.join(", ")));
            }
            for object in meant {
                if let Some(before) = of_object[object].replace(style) {
                    let (name, other) = (&names[object][0], &own[before].object);
                    problem(format!(
                        "{name} is named twice, as `{other}` and as `{wanted}`; use one of them"
                    ));
                }
            }
        }
        match problems.is_empty() {
            true => Ok(Self { of_object, own }),
            false => Err(ProfileError { problems }.into()),
        }
    }

    /// The same for some of the objects, numbered anew.
    pub fn of(&self, objects: &[usize]) -> Self {
        let of_object = objects.iter().map(|&object| self.of_object.get(object).copied().flatten()).collect();
        Self { of_object, own: self.own }
    }

    /// Whether two objects have the same settings.
    pub fn are_equal(&self, [a, b]: [usize; 2]) -> bool {
        let style = |object: usize| self.of_object.get(object).copied().flatten();
        style(a) == style(b)
    }

    /// The settings of an object.
    pub fn settings<'s>(&self, object: usize, plate: &'s Settings) -> &'s Settings
    where
        'a: 's,
    {
        let style = self.of_object.get(object).copied().flatten();
        style.map_or(plate, |style| &self.own[style].settings)
    }

    /// The settings of the plate, and all others that objects here have, with their numbers.
    pub fn each<'s>(&'s self, plate: &'s Settings) -> impl Iterator<Item = (Option<usize>, &'s Settings)> {
        let others = self.used().into_iter().map(|style| (Some(style), &self.own[style].settings));
        std::iter::once((None, plate)).chain(others)
    }

    /// The numbers of settings that objects here have.
    fn used(&self) -> Vec<usize> {
        let mut used: Vec<usize> = self.of_object.iter().copied().flatten().collect();
        used.sort_unstable();
        used.dedup();
        used
    }
}

/// The planners of a plate: one for the plate, and one for each set of settings of its own.
pub(crate) struct Planners {
    /// Lays also what belongs to no object.
    pub main: Planner,
    /// With the number of the settings.
    others: Vec<(usize, Planner)>,
    of_object: Vec<Option<usize>>,
}

impl Planners {
    /// Planners for objects that stand on `footprint`.
    pub fn new(settings: &Settings, styles: &Styles<'_>, footprint: &Region, first_height_mm: f64) -> Self {
        let main = Planner::new(settings.into(), footprint, first_height_mm);
        let other = |style: usize| {
            let mut own = ToolpathSettings::from(&styles.own[style].settings);
            (own.skirt.loops, own.brim.width) = (0, Mm(0.0));
            (style, Planner::new(own, Region::EMPTY, first_height_mm))
        };
        let others = styles.used().into_iter().map(other).collect();
        Self { main, others, of_object: styles.of_object.clone() }
    }

    /// Fills with patterns that were planned for the whole print.
    pub fn use_patterns(&mut self, planned: &[Planned]) {
        for (style, pattern) in planned {
            if let Some((_, planner)) = self.all().find(|(number, _)| number == style) {
                planner.use_pattern(pattern.clone());
            }
        }
    }

    /// All planners, with the number of their settings.
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
        let of_object = self.of_object.clone();
        for (style, planner) in self.all() {
            let samples = workers
                .map(chosen.len(), |k| planner.sparse_sample(&part(layer(chosen[k]), &of_object, style)));
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
        let of_object = self.of_object.clone();
        for (style, planner) in self.all().filter(|(_, planner)| planner.combines()) {
            let areas = workers.map(layers, |i| {
                let layer = part(layer(i), &of_object, style);
                (layer.height_mm, planner.sparse_area(&layer))
            });
            planner.combine(&areas);
        }
    }

    /// All paths of a layer.
    pub fn layer(&self, layer: PlateLayer<'_>) -> LayerPaths {
        let mut all = self.main.layer(&part(layer.clone(), &self.of_object, None));
        for (style, planner) in &self.others {
            let more = planner.layer(&part(layer.clone(), &self.of_object, Some(*style)));
            let first = all.islands.len() as u32;
            all.islands.extend(more.islands);
            all.paths.extend(more.paths.into_iter().map(|mut path| {
                path.island = path.island.map(|island| IslandId(island.0 + first));
                path
            }));
            all.outline.add_disjoint(more.outline.into_polygons());
            all.beneath = all.beneath.zip(more.beneath).map(|(mut all, more)| {
                all.add_disjoint(more.into_polygons());
                all
            });
        }
        all
    }
}

/// The objects of a layer that have certain settings.
fn part<'l>(mut layer: PlateLayer<'l>, of_object: &[Option<usize>], style: Option<usize>) -> PlateLayer<'l> {
    layer.objects.retain(|o| of_object.get(o.object as usize).copied().flatten() == style);
    layer
}
