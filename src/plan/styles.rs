//! Settings that some objects have of their own.

use std::borrow::Cow;
use std::sync::Arc;

use crate::job::{JobError, ObjectSettings};
use crate::mesh::SavedSettings;
use crate::plate::Plate;
use crate::profile::{Origin, Problem, ProfileError, Settings};
use crate::toolpath::ToolId;

use super::modifiers::{self, Changes};

/// The settings of each object.
#[derive(Clone, Debug, Default)]
pub(crate) struct Styles<'a> {
    /// For each object its own settings, as an index; `None`: it has those of the plate.
    of_object: Vec<Option<usize>>,
    own: Vec<Cow<'a, Settings>>,
    /// The tool of each object that its file has one for; empty: none has.
    tools: Vec<Option<ToolId>>,
    /// What changes inside of each object; empty: nothing in any.
    changes: Vec<Arc<Changes>>,
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
            self.of_object[object] = Some(self.number(own));
        }
    }

    /// The tool that an object's file has for it.
    pub fn tool(&self, object: usize) -> Option<ToolId> {
        self.tools.get(object).copied().flatten()
    }

    /// Takes over what files have saved of settings with their objects, as far as the user has not said otherwise. Returns what
    /// the user should know.
    pub fn take_saved(
        &mut self,
        of_files: &[SavedSettings],
        names: &[Vec<String>],
        plate: &Settings,
    ) -> Option<String> {
        let mut left = Vec::new();
        for (object, saved) in of_files.iter().enumerate().filter(|(_, saved)| !saved.entries.is_empty()) {
            let own = self.settings(object, plate);
            let is_free = |key: &str| own.agrees(plate, key);
            let (settings, refused) = modifiers::inside(own, saved, &is_free);
            if settings != *own {
                self.of_object[object] = Some(self.number(settings));
            }
            if !refused.is_empty() {
                left.push(format!("{}: {}", names[object][0], refused.join(", ")));
            }
        }
        not_taken(left)
    }

    /// Finds out what changes inside of the objects of a plate. Returns what the user should know.
    pub fn take_modifiers(&mut self, plate: &Plate, settings: &Settings) -> Option<String> {
        let is_modified = |object: &crate::plate::Object| !plate.meshes[object.mesh].modifiers().is_empty();
        if !plate.objects.iter().any(is_modified) {
            return None;
        }
        let mut left = Vec::new();
        let mut known: Vec<(usize, Option<usize>, Arc<Changes>)> = Vec::new();
        for (object, placed) in plate.objects.iter().enumerate() {
            let style = self.of_object[object];
            let same = known.iter().find(|(mesh, of, _)| (*mesh, *of) == (placed.mesh, style));
            let changes = same.map(|(.., changes)| changes.clone()).unwrap_or_else(|| {
                let own = self.settings(object, settings).clone();
                let number = |inside| Some(self.number(inside));
                let mesh = &plate.meshes[placed.mesh];
                Arc::new(Changes::new(mesh, &own, settings, number, &mut left))
            });
            known.push((placed.mesh, style, changes.clone()));
            self.changes.push(changes);
        }
        left.dedup();
        not_taken(left)
    }

    /// The number of settings.
    fn number(&mut self, settings: Settings) -> usize {
        self.own.iter().position(|known| **known == settings).unwrap_or_else(|| {
            self.own.push(Cow::Owned(settings));
            self.own.len() - 1
        })
    }

    /// The settings of a number.
    pub fn numbered(&self, style: usize) -> &Settings {
        &self.own[style]
    }

    /// What changes inside of an object.
    pub fn changes(&self, object: usize) -> &Arc<Changes> {
        static NONE: std::sync::OnceLock<Arc<Changes>> = std::sync::OnceLock::new();
        self.changes.get(object).unwrap_or_else(|| NONE.get_or_init(Arc::default))
    }

    /// The settings of a part of an object; `None`: the object's.
    pub fn inside<'s>(&'s self, object: usize, style: Option<usize>, plate: &'s Settings) -> &'s Settings {
        style.map_or_else(|| self.settings(object, plate), |style| &self.own[style])
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
        let mut all: Vec<Cow<'a, Settings>> = own.iter().map(|own| Cow::Borrowed(&own.settings)).collect();
        for (of_object, settings) in of_object.iter_mut().zip(of_models) {
            let (None, Some(settings)) = (&of_object, settings) else { continue };
            let known = all.iter().position(|known| std::ptr::eq(&**known, *settings));
            *of_object = known.or(Some(all.len()));
            if known.is_none() {
                all.push(Cow::Borrowed(settings));
            }
        }
        Ok(Self { of_object, own: all, tools: Vec::new(), changes: Vec::new() })
    }

    /// The same for some of the objects, numbered anew.
    pub fn of(&self, objects: &[usize]) -> Self {
        let of_object = objects.iter().map(|&object| self.of_object.get(object).copied().flatten()).collect();
        let tools = objects.iter().map(|&object| self.tool(object)).collect();
        let changes = objects.iter().map(|&object| self.changes(object).clone()).collect();
        Self { of_object, own: self.own.clone(), tools, changes }
    }

    /// The settings of an object.
    pub fn settings<'s>(&'s self, object: usize, plate: &'s Settings) -> &'s Settings {
        let style = self.of_object.get(object).copied().flatten();
        style.map_or(plate, |style| &self.own[style])
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
        Styles {
            of_object: self.of_object.clone(),
            own: own.iter().map(Cow::Borrowed).collect(),
            tools: self.tools.clone(),
            changes: self.changes.clone(),
        }
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
    pub fn used(&self) -> Vec<usize> {
        let inside = self.changes.iter().flat_map(|changes| changes.styles());
        let mut used: Vec<usize> = self.of_object.iter().copied().flatten().chain(inside).collect();
        used.sort_unstable();
        used.dedup();
        used
    }
}

/// That settings were left out.
fn not_taken(left: Vec<String>) -> Option<String> {
    (!left.is_empty()).then(|| {
        let left = left.join("; ");
        format!("settings saved with objects that are not taken over: {left}")
    })
}
