//! Which tools print the parts of an object.

use crate::profile::Settings;
use crate::slice::{Layer, Section};
use crate::toolpath::ToolId;
use geometry::Region;

use super::styles::Styles;

/// What one tool prints of a section.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub tool: ToolId,
    pub region: Region,
}

/// The parts of a section, which make up the whole and do not overlap; empty: all of it has its object's tool.
pub(crate) type Parts = Vec<Part>;

/// What objects have in common.
pub(crate) struct Kinds {
    /// Objects with equal numbers have the same settings, but for their tool.
    alike: Vec<usize>,
    tools: Vec<ToolId>,
}

impl Kinds {
    /// Those of so many objects.
    pub fn new(count: usize, styles: &Styles<'_>, settings: &Settings) -> Self {
        let style = |object: usize| styles.of_objects().get(object).copied().flatten();
        let tool = |object: usize| {
            let own = styles.settings(object, settings).tool_of.base();
            styles.tool(object).unwrap_or(own)
        };
        let tools = (0..count).map(tool).collect();
        let mut seen: Vec<(Option<usize>, Settings)> = Vec::new();
        let number = |object: usize| {
            if let Some(known) = seen.iter().position(|(known, _)| *known == style(object)) {
                return known;
            }
            let mut own = styles.settings(object, settings).for_toolpaths();
            own.tool_of.object = 1;
            // Where there is one tool, what has settings of its own is kept apart.
            let several = settings.tools.len() > 1;
            let like = seen.iter().position(|(_, other)| several && *other == own);
            seen.push((style(object), own));
            like.unwrap_or(seen.len() - 1)
        };
        let alike: Vec<usize> = (0..count).map(number).collect();
        Self { alike, tools }
    }

    /// Whether two objects have the same settings, but for their tool.
    pub fn are_alike(&self, [a, b]: [usize; 2]) -> bool {
        self.alike[a] == self.alike[b]
    }

    /// Whether two objects have the same tool.
    pub fn share_tool(&self, [a, b]: [usize; 2]) -> bool {
        self.tools[a] == self.tools[b]
    }

    /// The parts of the sections of a layer, `united` being what became of them: of several objects that are one, of which
    /// `first` is each one's, the later ones take what they share.
    pub fn parts(&self, layer: &Layer, united: &[Section], first: &[usize]) -> Vec<Parts> {
        let of = |section: &Section| {
            let mut parts: Parts = Vec::new();
            let mut taken = Region::default();
            for member in layer.sections.iter().rev().filter(|other| first[other.object] == section.object) {
                let tool = self.tools[member.object];
                let region = geometry::difference(&member.region, &taken);
                taken = geometry::union(&taken, &member.region);
                add(&mut parts, Part { tool, region });
            }
            settled(parts, self.tools[section.object])
        };
        united.iter().map(of).collect()
    }

    /// Lays what is painted over the parts of sections, in which painted parts do not overlap.
    pub fn lay_over(&self, layers: &[Layer], parts: &mut Vec<Vec<Parts>>, painted: &[Vec<Part>]) {
        if painted.is_empty() {
            return;
        }
        parts.resize(layers.len(), Vec::new());
        for ((layer, of_layer), painted) in layers.iter().zip(parts).zip(painted) {
            of_layer.resize(layer.sections.len(), Parts::new());
            for (section, parts) in layer.sections.iter().zip(of_layer) {
                let own = self.tools[section.object];
                if parts.is_empty() {
                    parts.push(Part { tool: own, region: section.region.clone() });
                }
                for Part { tool, region } in painted {
                    let here = geometry::intersection(region, &section.region);
                    if here.is_empty() {
                        continue;
                    }
                    for part in parts.iter_mut() {
                        part.region = geometry::difference(&part.region, &here);
                    }
                    add(parts, Part { tool: *tool, region: here });
                }
                parts.retain(|part| !part.region.is_empty());
                *parts = settled(std::mem::take(parts), own);
            }
        }
    }
}

/// Adds what a tool prints, unless it is nothing.
fn add(parts: &mut Parts, more: Part) {
    match parts.iter_mut().find(|part| part.tool == more.tool) {
        _ if more.region.is_empty() => {}
        Some(part) => part.region = geometry::union(&part.region, &more.region),
        None => parts.push(more),
    }
}

/// The parts by tool; none where all of them have the object's own.
fn settled(mut parts: Parts, own: ToolId) -> Parts {
    if parts.iter().all(|part| part.tool == own) {
        parts.clear();
    }
    parts.sort_by_key(|part| part.tool);
    parts
}
