//! Machines, qualities and materials by name, and what they come to together.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use super::added::{Added, Slot};
use super::definition::Definition;
use super::folder::{Folder, Machine};
use super::formula::Value;
use super::instance::Instance;
use super::stack::Stack;
use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::family::{Listed, Source};
use crate::presets::files::Files;

/// Definitions inherit from each other no deeper than this.
const DEEPEST: usize = 64;

/// The definition at the bottom of all, and the one whose qualities hold where a machine has none.
const BOTTOM: &str = "fdmprinter";

/// What stands for a machine's own values where there is no quality for it.
pub(super) const OWN: &str = "as defined";

/// What stands for all that a user has set for a machine, saved as a profile or not.
pub(super) const SET: &str = "as set in Cura";

/// All presets of Cura.
#[derive(Debug)]
pub(in crate::presets) struct Cura {
    pub(super) folder: Folder,
    pub(super) listed: [OnceLock<Vec<Listed>>; 3],
}

/// A machine with all that it inherits, and one of its extruders.
#[derive(Clone)]
pub(super) struct Resolved<'a> {
    pub machine: &'a Machine,
    /// From the machine down to the bottom.
    chain: Vec<(&'a str, &'a Definition)>,
    /// What a user has made of it.
    pub added: Option<Added<'a>>,
    /// Which of its extruders is looked at, from 0.
    pub extruder: usize,
}

/// What a print preset comes to.
struct Quality<'a> {
    /// Of which kind the qualities beneath are, and the intents.
    kind: &'a str,
    intent: &'a str,
    /// What a user has changed, the top one last.
    changes: Vec<&'a Instance>,
}

impl Resolved<'_> {
    /// What the first of the chain says of it.
    pub fn about(&self, key: &str) -> Option<&serde_json::Value> {
        self.chain.iter().find_map(|(_, definition)| definition.about(key))
    }

    /// Its extruders by their numbers, if it names any.
    fn extruder_trains(&self) -> Option<&serde_json::Map<String, serde_json::Value>> {
        self.about("machine_extruder_trains")?.as_object()
    }

    pub fn text(&self, key: &str) -> &str {
        self.about(key).and_then(serde_json::Value::as_str).unwrap_or_default()
    }

    fn is(&self, key: &str) -> bool {
        self.about(key).and_then(serde_json::Value::as_bool).unwrap_or(false)
    }

    /// The definition whose qualities it has.
    fn quality_definition(&self) -> &str {
        match (self.is("has_machine_quality"), self.text("quality_definition")) {
            (false, _) => BOTTOM,
            (true, "") => &self.machine.id,
            (true, other) => other,
        }
    }
}

impl Cura {
    /// Reads which presets there are.
    pub fn read(files: &Files, sources: &[&Source]) -> Self {
        let mut folder = Folder::of(files);
        for source in sources {
            folder.add(&source.path);
        }
        Self { folder, listed: Default::default() }
    }

    pub(super) fn machine(&self, name: &str) -> Result<Resolved<'_>, PresetError> {
        let mut all = Added::all(self.folder.stacks()?);
        if let Some(added) = all.find(|added| added.machine.name == name) {
            let id = added.at(Slot::Definition).next().unwrap_or_default();
            let machine = self.folder.machine(id).ok_or_else(|| {
                let place = Place::new(added.machine.file.clone(), 0, name);
                PresetError::at(place, format!("is made from the definition `{id}`, which is not there; name Cura's folder of resources, too"))
            })?;
            return self.resolved(machine, Some(added));
        }
        let found = self.folder.machines().find(|machine| machine.is_visible() && machine.name() == name);
        let machine = found.ok_or_else(|| PresetError::of(format!("there is no printer preset `{name}`")))?;
        self.resolved(machine, None)
    }

    fn resolved<'a>(
        &'a self,
        machine: &'a Machine,
        added: Option<Added<'a>>,
    ) -> Result<Resolved<'a>, PresetError> {
        Ok(Resolved {
            machine,
            chain: self.chain(machine, |id| self.folder.machine(id))?,
            added,
            extruder: 0,
        })
    }

    /// The same machine, with each of its extruders.
    pub(super) fn extruders<'a>(&'a self, machine: &Resolved<'a>) -> Result<Vec<Resolved<'a>>, PresetError> {
        let stacks = self.folder.stacks()?;
        let of = |extruder: usize| {
            let added = machine.added.map(|added| added.of_extruder(stacks, extruder));
            Resolved { added, extruder, ..machine.clone() }
        };
        let known = machine.extruder_trains();
        let count = self.stack(machine)?.number("machine_extruder_count").unwrap_or(1.0);
        let count = (count as usize).min(known.map_or(1, serde_json::Map::len)).max(1);
        Ok((0..count).map(of).collect())
    }

    /// A definition and all that it inherits from, the last one first.
    fn chain<'a>(
        &'a self,
        first: &'a Machine,
        find: impl Fn(&str) -> Option<&'a Machine>,
    ) -> Result<Vec<(&'a str, &'a Definition)>, PresetError> {
        let mut chain: Vec<(&str, &Definition)> = Vec::new();
        let mut next = Some(first);
        while let Some(machine) = next {
            let definition = machine.definition()?;
            chain.push((&machine.id, definition));
            let place = || Place::new(machine.file.clone(), 1, definition.name.as_str());
            next = match &definition.inherits {
                None => None,
                Some(parent) if chain.len() > DEEPEST || chain.iter().any(|(id, _)| id == parent) => {
                    return Err(PresetError::at(
                        place(),
                        format!("inherits from itself, by way of `{parent}`"),
                    ));
                }
                Some(parent) => Some(find(parent).ok_or_else(|| {
                    PresetError::at(place(), format!("inherits from `{parent}`, which is not there"))
                })?),
            };
        }
        Ok(chain)
    }

    /// The machine's settings, with its extruder and its nozzle.
    pub(super) fn stack(&self, machine: &Resolved<'_>) -> Result<Stack, PresetError> {
        let mut stack = Stack::default();
        // What inherits from nothing is the slicer's own.
        for (_, definition) in machine.chain.iter().rev() {
            stack.add_definition(&definition.settings, definition.inherits.is_some());
        }
        let trains = machine.extruder_trains();
        let number = machine.extruder.to_string();
        let train = trains.and_then(|trains| trains.get(&number)).and_then(serde_json::Value::as_str);
        let train = machine.added.and_then(|added| added.at(Slot::Definition).nth(1)).or(train);
        if let Some(extruder) = train.and_then(|id| self.folder.extruder(id)) {
            // What extruders inherit from may lie among the machines.
            let find = |id: &str| self.folder.extruder(id).or_else(|| self.folder.machine(id));
            for (_, definition) in self.chain(extruder, find)?.iter().rev() {
                stack.add_definition(&definition.settings, definition.inherits.is_some());
            }
        }
        for changes in self.changed(machine, Slot::DefinitionChanges)? {
            stack.add_values(&changes.values);
        }
        if let Some(nozzle) = self.nozzle(machine)? {
            stack.add_values(&nozzle.values);
        }
        Ok(stack)
    }

    /// What a user has changed at a place of an added machine's stacks.
    fn changed(&self, machine: &Resolved<'_>, slot: Slot) -> Result<Vec<&Instance>, PresetError> {
        let Some(added) = machine.added else { return Ok(Vec::new()) };
        let all = self.folder.changes()?;
        Ok(added.at(slot).filter_map(|id| all.iter().find(|changes| changes.id == id)).collect())
    }

    /// The nozzle that a machine has, or comes with.
    fn nozzle(&self, machine: &Resolved<'_>) -> Result<Option<&Instance>, PresetError> {
        if let Some(added) = machine.added {
            let nozzles = self.folder.nozzles()?;
            return Ok(added.at(Slot::Nozzle).find_map(|id| nozzles.iter().find(|nozzle| nozzle.id == id)));
        }
        let wanted = machine.text("preferred_variant_name");
        if wanted.is_empty() || !machine.is("has_variants") {
            return Ok(None);
        }
        let fits = |nozzle: &&Instance| {
            nozzle.name == wanted && machine.chain.iter().any(|(id, _)| *id == nozzle.definition)
        };
        Ok(self.folder.nozzles()?.iter().find(fits))
    }

    /// The qualities of a machine and its nozzle; with a material, those for it and for any.
    pub(super) fn qualities<'a>(
        &'a self,
        machine: &'a Resolved<'_>,
        material: Option<&'a Instance>,
    ) -> Result<impl Iterator<Item = &'a Instance>, PresetError> {
        let definition = machine.quality_definition();
        let nozzle = self.nozzle(machine)?.map(|nozzle| nozzle.name.as_str());
        Ok(self.folder.qualities()?.iter().filter(move |quality| {
            let for_nozzle = quality.about("variant");
            quality.definition == definition
                && quality.about("type") == "quality"
                && (for_nozzle.is_empty() || Some(for_nozzle) == nozzle)
                && material.is_none_or(|material| self.is_for(quality, material))
        }))
    }

    /// What users have made of qualities, for a machine: changes that have one name belong together, those of its extruder after
    /// those of the machine.
    pub(super) fn profiles<'a>(
        &'a self,
        machine: &'a Resolved<'_>,
    ) -> Result<Vec<&'a Instance>, PresetError> {
        let definition = machine.quality_definition();
        let of_all =
            self.folder.changes()?.iter().filter(|changes| changes.about("type") == "quality_changes");
        let names: BTreeSet<&str> = of_all
            .clone()
            .filter(|changes| changes.definition == definition)
            .map(|changes| changes.name.as_str())
            .collect();
        let mut all: Vec<&Instance> = of_all
            .filter(|changes| names.contains(changes.name.as_str()))
            .filter(|changes| changes.definition == definition || changes.definition == BOTTOM)
            .filter(|changes| {
                let position = changes.about("position");
                position.is_empty() || position == machine.extruder.to_string()
            })
            .collect();
        all.sort_by_key(|changes| !changes.about("position").is_empty());
        Ok(all)
    }

    /// What a print preset comes to; `None`: it adds nothing.
    fn quality<'a>(
        &'a self,
        machine: &'a Resolved<'_>,
        print: &str,
        material: &'a Instance,
    ) -> Result<Option<Quality<'a>>, PresetError> {
        if print == OWN {
            return Ok(None);
        }
        if let (SET, Some(added)) = (print, machine.added) {
            let mut changes = self.changed(machine, Slot::QualityChanges)?;
            let of_id =
                |all: &'a [Instance], slot| added.at(slot).find_map(|id| all.iter().find(|one| one.id == id));
            let quality = of_id(self.folder.qualities()?, Slot::Quality).or(changes.first().copied());
            let intent = of_id(self.folder.intents()?, Slot::Intent);
            changes.extend(self.changed(machine, Slot::User)?);
            return Ok(Some(Quality {
                kind: quality.map_or("", |quality| quality.about("quality_type")),
                intent: intent.map_or("", |intent| intent.about("intent_category")),
                changes,
            }));
        }
        let changes: Vec<&Instance> =
            self.profiles(machine)?.into_iter().filter(|changes| changes.name == print).collect();
        if let Some(first) = changes.first() {
            let mut intents = changes.iter().map(|changes| changes.about("intent_category"));
            let intent = intents.rfind(|intent| !intent.is_empty()).unwrap_or_default();
            return Ok(Some(Quality { kind: first.about("quality_type"), intent, changes }));
        }
        let of_name = self.qualities(machine, Some(material))?.find(|quality| quality.name == print);
        let of_name = of_name.ok_or_else(|| {
            let (name, material) = (machine.machine.name(), &material.name);
            PresetError::of(format!("there is no print preset `{print}` for `{name}` and `{material}`"))
        })?;
        Ok(Some(Quality { kind: of_name.about("quality_type"), intent: "", changes: Vec::new() }))
    }

    /// The material that an added machine has.
    pub(super) fn loaded(&self, machine: &Resolved<'_>) -> Result<Option<&Instance>, PresetError> {
        let Some(added) = machine.added else { return Ok(None) };
        let materials = self.folder.materials()?;
        // Materials for machines and nozzles are named after the one that they are of.
        let of_id = |id: &str| {
            materials.iter().filter(|m| id.starts_with(&m.id)).max_by_key(|material| material.id.len())
        };
        Ok(added.at(Slot::Material).find_map(of_id))
    }

    /// The material of that name; of several the one of that diameter.
    pub(super) fn material(&self, name: &str, diameter_mm: Option<f64>) -> Result<&Instance, PresetError> {
        let missing = || PresetError::of(format!("there is no filament preset `{name}`"));
        let of_name =
            || self.folder.materials().map(|all| all.iter().filter(|material| material.name == name));
        let fitting = of_name()?.find(|material| is_of_diameter(material, diameter_mm));
        fitting.or(of_name()?.next()).ok_or_else(missing)
    }

    /// Whether a quality for a material is for this one, too: it is named so, or of the same kind of plastic.
    fn is_for(&self, quality: &Instance, material: &Instance) -> bool {
        let wanted = quality.about("material");
        let kind = |id: &str| {
            let known =
                self.folder.materials().unwrap_or_default().iter().find(|material| material.id == id)?;
            Some(known.about("material"))
        };
        wanted.is_empty()
            || material.id.starts_with(wanted)
            || kind(wanted) == Some(material.about("material"))
    }

    /// Adds a material and a quality to a machine's settings.
    pub(super) fn with(
        &self,
        stack: &mut Stack,
        machine: &Resolved<'_>,
        print: &str,
        material: &Instance,
    ) -> Result<(), PresetError> {
        stack.add_values(&material.values);
        let name = machine.machine.name();
        for (names, values) in &material.of_machines {
            if names.iter().any(|known| known == name) {
                stack.add_values(values);
            }
        }
        let place = Place::new(material.file.clone(), 1, material.name.as_str());
        for (key, about) in
            [("material_brand", "brand"), ("material_type", "material"), ("material_name", "material")]
        {
            stack.add_value(key, Value::Text(material.about(about).to_owned()), place.clone());
        }
        let Some(Quality { kind, intent, changes }) = self.quality(machine, print, material)? else {
            return Ok(());
        };
        // Those for all materials and nozzles are beneath.
        let of_kind = |quality: &&Instance| quality.about("quality_type") == kind;
        let mut kinds: Vec<&Instance> = self.qualities(machine, Some(material))?.filter(of_kind).collect();
        kinds.sort_by_key(|quality| {
            (
                quality.about("global_quality") != "True",
                !quality.about("material").is_empty(),
                quality.about("material").len(),
            )
        });
        let nozzle = self.nozzle(machine)?.map_or("", |nozzle| nozzle.name.as_str());
        let intents = self.folder.intents()?.iter().filter(|one| {
            !intent.is_empty()
                && one.about("intent_category") == intent
                && one.definition == machine.quality_definition()
                && one.about("variant") == nozzle
                && self.is_for(one, material)
        });
        for container in kinds.into_iter().chain(intents.filter(of_kind)).chain(changes) {
            stack.add_values(&container.values);
        }
        Ok(())
    }
}

/// Whether a material is as thick as that, in whole millimetres as in Cura; what is not stated fits.
pub(super) fn is_of_diameter(material: &Instance, diameter_mm: Option<f64>) -> bool {
    let own_mm: Option<f64> = material.about("diameter").parse().ok();
    own_mm.zip(diameter_mm).is_none_or(|(own, wanted)| own.round() == wanted.round())
}
