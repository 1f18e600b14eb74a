//! Settings that some objects have of their own, and the planners that follow from them.

use std::borrow::Cow;
use std::sync::Arc;

use crate::job::{JobError, ObjectSettings};
use crate::profile::{Origin, Problem, ProfileError, Settings};
use crate::toolpath::infill::FillPattern;
use crate::toolpath::{IslandId, LayerPaths, LayerWalls, Planner, PlateLayer, ToolId, ToolpathSettings};
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
    own: Vec<Cow<'a, Settings>>,
    /// The tool of each object that its file has one for; empty: none has.
    tools: Vec<Option<ToolId>>,
}

impl<'a> Styles<'a> {
    /// Takes over the tools that files have for their objects, from 1, of objects whose settings do not say otherwise. Returns
    /// what the user should know.
    pub fn take_tools(&mut self, of_files: &[Option<u32>], plate: &Settings) -> Option<String> {
        if plate.tools.len() < 2 {
            return None;
        }
        let count = plate.tools.len() as u32;
        let is_free = |object: usize| self.settings(object, plate).tool_of.object == plate.tool_of.object;
        let tool = |(object, tool): (usize, &Option<u32>)| {
            tool.filter(|tool| (1..=count).contains(tool) && is_free(object)).map(|tool| (tool - 1) as ToolId)
        };
        let tools = of_files.iter().enumerate().map(tool).collect();
        self.tools = tools;
        let most = of_files.iter().flatten().copied().max().filter(|most| *most > count)?;
        Some(format!(
            "a file has objects for extruder {most}, but the printer has {count} tools; they are printed with tool {}",
            plate.tool_of.object
        ))
    }

    /// Gives objects whose tools have other nozzles than the printer the widths that go with them.
    pub fn take_widths(&mut self, plate: &Settings) {
        if plate.tools.len() < 2 {
            return;
        }
        for object in 0..self.of_object.len() {
            let settings = self.settings(object, plate);
            let tool = self.tool(object).unwrap_or(settings.tool_of.base());
            // What has the plate's settings and tool is printed as the plate is.
            if self.of_object[object].is_none() && tool == plate.tool_of.base() {
                continue;
            }
            let Some(own) = settings.with_widths_of(tool.into()) else { continue };
            let known = self.own.iter().position(|known| **known == own);
            self.of_object[object] = known.or(Some(self.own.len()));
            if known.is_none() {
                self.own.push(Cow::Owned(own));
            }
        }
    }

    /// The tool that an object's file has for it.
    pub fn tool(&self, object: usize) -> Option<ToolId> {
        self.tools.get(object).copied().flatten()
    }

    /// Finds the objects that settings are for. `of_models[i]` are those of the model that object i is of, `names[i]` all the
    /// names by which it may be called: settings by name win.
    ///
    /// # Errors
    /// Settings for no object, or twice for one.
    pub fn new(
        own: &'a [ObjectSettings],
        of_models: &[Option<&'a Settings>],
        names: &[Vec<String>],
    ) -> Result<Self, JobError> {
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
        if !problems.is_empty() {
            return Err(ProfileError { problems }.into());
        }
        let mut all: Vec<&Settings> = own.iter().map(|own| &own.settings).collect();
        for (of_object, settings) in of_object.iter_mut().zip(of_models) {
            let (None, Some(settings)) = (&of_object, settings) else { continue };
            let known = all.iter().position(|&known| std::ptr::eq(known, *settings));
            *of_object = known.or(Some(all.len()));
            if known.is_none() {
                all.push(settings);
            }
        }
        Ok(Self { of_object, own: all.into_iter().map(Cow::Borrowed).collect(), tools: Vec::new() })
    }

    /// The same for some of the objects, numbered anew.
    pub fn of(&self, objects: &[usize]) -> Self {
        let of_object = objects.iter().map(|&object| self.of_object.get(object).copied().flatten()).collect();
        let tools = objects.iter().map(|&object| self.tool(object)).collect();
        Self { of_object, own: self.own.clone(), tools }
    }

    /// The settings of an object.
    pub fn settings<'s>(&'s self, object: usize, plate: &'s Settings) -> &'s Settings {
        let style = self.of_object.get(object).copied().flatten();
        style.map_or(plate, |style| &*self.own[style])
    }

    /// The settings of the plate, and all others that objects here have, with their numbers.
    pub fn each<'s>(&'s self, plate: &'s Settings) -> impl Iterator<Item = (Option<usize>, &'s Settings)> {
        let others = self.used().into_iter().map(|style| (Some(style), &*self.own[style]));
        std::iter::once((None, plate)).chain(others)
    }

    /// The same with all settings changed, for which `own` keeps them.
    pub fn changed<'b>(
        &self,
        own: &'b mut Vec<Settings>,
        change: impl Fn(&Settings) -> Settings,
    ) -> Styles<'b> {
        *own = self.own.iter().map(|own| change(own)).collect();
        let own = own.iter().map(Cow::Borrowed).collect();
        Styles { of_object: self.of_object.clone(), own, tools: self.tools.clone() }
    }

    /// For each object its own settings, as an index.
    pub fn of_objects(&self) -> &[Option<usize>] {
        &self.of_object
    }

    /// The settings that objects have of their own.
    pub fn own(&self) -> impl Iterator<Item = &Settings> {
        self.own.iter().map(|own| &**own)
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
            let mut own = ToolpathSettings::from(&*styles.own[style]);
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

    /// Whether the walls that others make of the same outlines are those of these.
    pub fn has_walls_of(&self, other: &Self) -> bool {
        let own = |planners: &Self| planners.others.iter().map(|(style, _)| *style).collect::<Vec<_>>();
        let each = |(a, b): (&(usize, Planner), &(usize, Planner))| a.1.has_walls_of(&b.1);
        self.of_object == other.of_object
            && self.main.has_walls_of(&other.main)
            && own(self) == own(other)
            && self.others.iter().zip(&other.others).all(each)
    }

    /// The walls of a layer: those of each planner.
    pub fn walls(&self, layer: &PlateLayer<'_>) -> Vec<LayerWalls> {
        let styles = std::iter::once((None, &self.main));
        let others = self.others.iter().map(|(style, planner)| (Some(*style), planner));
        let walls =
            |(style, planner): (_, &Planner)| planner.walls(&part(layer.clone(), &self.of_object, style));
        styles.chain(others).map(walls).collect()
    }

    /// All paths of a layer, the walls of each planner being known.
    pub fn filled(&self, layer: PlateLayer<'_>, walls: Vec<LayerWalls>) -> LayerPaths {
        let mut walls = walls.into_iter();
        let mut next = || walls.next().unwrap_or_default();
        let mut all = self.main.filled(&part(layer.clone(), &self.of_object, None), next());
        for (style, planner) in &self.others {
            let more = planner.filled(&part(layer.clone(), &self.of_object, Some(*style)), next());
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
