//! Bodies in which an object has settings of its own (modifiers): which settings hold where they overlap.

use std::collections::BTreeMap;

use crate::job::ObjectSettings;
use crate::mesh::{Effect, Mesh, Modifier, SavedSettings};
use crate::profile::{Refused, Settings};
use crate::slice::Layer;
use crate::toolpath::ToolId;
use geometry::Region;

/// An object has no more different settings inside.
const MOST_STYLES: usize = 100;

/// Where a modifier holds in a layer of an object.
pub(crate) struct Modified {
    pub object: usize,
    pub modifier: usize,
    pub region: Region,
}

/// What the modifiers of an object change.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Changes {
    /// The tools that modifiers ask for.
    tools: BTreeMap<usize, ToolId>,
    /// The settings that hold where a modifier meets settings; `None`: the object's.
    styles: BTreeMap<(usize, Option<usize>), usize>,
}

impl Changes {
    /// Tool and settings in a modifier, from those around it.
    pub fn of(&self, modifier: usize, tool: ToolId, style: Option<usize>) -> (ToolId, Option<usize>) {
        let tool = self.tools.get(&modifier).copied().unwrap_or(tool);
        (tool, self.styles.get(&(modifier, style)).copied().or(style))
    }

    /// The numbers of all settings that there are inside.
    pub fn styles(&self) -> impl Iterator<Item = usize> {
        self.styles.values().copied()
    }

    /// Those of a mesh, on an object with these settings. `number` gives settings a number; `left` gets what is not taken over.
    ///
    /// Modifiers take effect one after the other, each on what those before it have left, as in PrusaSlicer.
    pub fn new(
        mesh: &Mesh,
        own: &Settings,
        plate: &Settings,
        mut number: impl FnMut(Settings) -> Option<usize>,
        left: &mut Vec<String>,
    ) -> Self {
        let mut changes = Self::default();
        // Settings inside of the object, with the box that they hold in.
        let mut found: Vec<(Option<usize>, Settings, [[f64; 3]; 2])> =
            vec![(None, own.clone(), mesh.bounds())];
        for (index, Modifier { name, mesh, effect }) in mesh.modifiers().iter().enumerate() {
            let Effect::Settings(saved) = effect else { continue };
            let tools = plate.tools.len();
            match saved.tool.filter(|_| tools > 1) {
                Some(tool) if tool as usize <= tools => {
                    changes.tools.insert(index, (tool - 1) as ToolId);
                }
                Some(tool) => {
                    left.push(format!("{}: extruder {tool}, which the printer does not have", called(name)));
                }
                None => {}
            }
            let mut refused = Vec::new();
            let mut more = Vec::new();
            for (style, settings, within) in &found {
                let Some(within) = shared(within, &mesh.bounds()) else { continue };
                let (inside, not_taken) = inside(settings, saved, &|_| true);
                refused = not_taken;
                if inside == *settings || found.len() + more.len() > MOST_STYLES {
                    continue;
                }
                let to = if inside == *own { None } else { number(inside.clone()) };
                if let Some(to) = to {
                    changes.styles.insert((index, *style), to);
                    more.push((Some(to), inside, within));
                }
            }
            if !refused.is_empty() {
                left.push(format!("{}: {}", called(name), refused.join(", ")));
            }
            found.extend(more);
        }
        changes
    }
}

/// Settings with what is saved with a body, and the keys that are not taken over.
pub(super) fn inside(
    settings: &Settings,
    saved: &SavedSettings,
    is_free: &dyn Fn(&str) -> bool,
) -> (Settings, Vec<String>) {
    settings.with_saved(saved, |key| match ObjectSettings::refusal(key) {
        Some(_) => Err(Refused::Told),
        None if is_free(key) => Ok(()),
        None => Err(Refused::Silently),
    })
}

fn called(name: &Option<String>) -> &str {
    name.as_deref().unwrap_or("a modifier")
}

/// What two boxes share.
fn shared(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]) -> Option<[[f64; 3]; 2]> {
    let low = [0, 1, 2].map(|i| a[0][i].max(b[0][i]));
    let high = [0, 1, 2].map(|i| a[1][i].min(b[1][i]));
    (0..3).all(|i| low[i] <= high[i]).then_some([low, high])
}

/// Where modifiers hold in a layer: within the sections of their objects.
pub(super) fn of_layer(layer: &Layer) -> Vec<Modified> {
    let inside = |area: &crate::slice::ModifiedArea| {
        let section = layer.sections.iter().find(|section| section.object == area.object)?;
        let region = geometry::intersection(&area.region, &section.region);
        (!region.is_empty()).then_some(Modified { object: area.object, modifier: area.modifier, region })
    };
    layer.modified.iter().filter_map(inside).collect()
}
