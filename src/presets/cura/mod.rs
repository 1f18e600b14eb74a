//! Cura's machines, qualities and materials, as far as one extruder goes.
//!
//! A machine is a definition (`.def.json`) on top of those it inherits from, its extruder's, its preferred nozzle; print presets are
//! the qualities that its definition has, filament presets the materials of its diameter. Formulas are worked out.

mod definition;
mod folder;
mod formula;
mod instance;
mod script;
mod stack;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

pub(super) use folder::{is_file, is_preset};

use super::config::{Config, Dialect, Place};
use super::error::PresetError;
use super::family::{Family, Kind, Listed, Source};
use super::files::Files;
use super::value::{Scalar, Shape, Type, escaped, join_texts};
use definition::Definition;
use folder::{Folder, Machine};
use formula::Value;
use instance::Instance;
use stack::Stack;

/// Definitions inherit from each other no deeper than this.
const DEEPEST: usize = 64;

/// The definition at the bottom of all, and the one whose qualities hold where a machine has none.
const BOTTOM: &str = "fdmprinter";

/// What stands for a machine's own values where there is no quality for it.
const OWN: &str = "as defined";

/// All presets of Cura.
#[derive(Debug)]
pub(super) struct Cura {
    folder: Folder,
    listed: [OnceLock<Vec<Listed>>; 3],
}

/// A machine with all that it inherits.
struct Resolved<'a> {
    machine: &'a Machine,
    /// From the machine down to the bottom.
    chain: Vec<(&'a str, &'a Definition)>,
}

impl Resolved<'_> {
    /// What the first of the chain says of it.
    fn about(&self, key: &str) -> Option<&serde_json::Value> {
        self.chain.iter().find_map(|(_, definition)| definition.about(key))
    }

    fn text(&self, key: &str) -> &str {
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

    fn machine(&self, name: &str) -> Result<Resolved<'_>, PresetError> {
        let found = self.folder.machines().find(|machine| machine.is_visible() && machine.name() == name);
        let machine = found.ok_or_else(|| PresetError::of(format!("there is no printer preset `{name}`")))?;
        Ok(Resolved { machine, chain: self.chain(machine, |id| self.folder.machine(id))? })
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
    fn stack(&self, machine: &Resolved<'_>) -> Result<Stack, PresetError> {
        let mut stack = Stack::default();
        for (id, definition) in machine.chain.iter().rev() {
            stack.add_definition(&definition.settings, *id != BOTTOM);
        }
        let trains = machine.about("machine_extruder_trains").and_then(serde_json::Value::as_object);
        let train = trains.and_then(|trains| trains.get("0")).and_then(serde_json::Value::as_str);
        if let Some(extruder) = train.and_then(|id| self.folder.extruder(id)) {
            // What extruders inherit from may lie among the machines.
            let find = |id: &str| self.folder.extruder(id).or_else(|| self.folder.machine(id));
            for (id, definition) in self.chain(extruder, find)?.iter().rev() {
                stack.add_definition(&definition.settings, *id != "fdmextruder");
            }
        }
        if let Some(nozzle) = self.nozzle(machine)? {
            stack.add_values(&nozzle.values);
        }
        Ok(stack)
    }

    /// The nozzle that a machine comes with.
    fn nozzle(&self, machine: &Resolved<'_>) -> Result<Option<&Instance>, PresetError> {
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
    fn qualities<'a>(
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

    /// The material of that name; of several the one of that diameter.
    fn material(&self, name: &str, diameter_mm: Option<f64>) -> Result<&Instance, PresetError> {
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
    fn with(
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
        if print == OWN {
            return Ok(());
        }
        let of_name: Vec<&Instance> = self.qualities(machine, Some(material))?.collect();
        let kind =
            of_name.iter().find(|quality| quality.name == print).map(|quality| quality.about("quality_type"));
        let kind = kind.ok_or_else(|| {
            PresetError::of(format!(
                "there is no print preset `{print}` for `{name}` and `{}`",
                material.name
            ))
        })?;
        // Those for all materials and nozzles are beneath.
        let mut kinds: Vec<&&Instance> =
            of_name.iter().filter(|quality| quality.about("quality_type") == kind).collect();
        kinds.sort_by_key(|quality| {
            (
                quality.about("global_quality") != "True",
                !quality.about("material").is_empty(),
                quality.about("material").len(),
            )
        });
        for quality in kinds {
            stack.add_values(&quality.values);
        }
        Ok(())
    }
}

/// The configuration that settings amount to.
fn config(stack: &Stack) -> Config {
    let mut config = Config { dialect: Dialect::Cura, ..Config::default() };
    let mut told = BTreeSet::new();
    for (theirs, key, rule) in table::TABLE {
        if stack.place(theirs).is_none() {
            continue;
        }
        told.insert(*theirs);
        match stack.value(theirs) {
            Ok(_) => {
                let place =
                    stack.own_place(theirs).cloned().unwrap_or_else(|| Place::built_in(Dialect::Cura));
                if let Some(value) = table::said(rule, theirs, stack) {
                    config.set(key, &value, place);
                }
            }
            Err(_) => {
                told.remove(theirs);
            }
        }
    }
    for key in stack.keys() {
        match stack.value(key) {
            Ok(value) => config.set_raw(key, &raw(&value), Some(kind(&value))),
            Err(reason) => {
                // What is not worked out is told by its name, with the formula.
                if let (Some(place), Some(formula)) = (stack.own_place(key), stack.formula(key)) {
                    config.set(key, &format!("= {formula} ({reason})"), place.clone());
                }
                continue;
            }
        }
        let is_new = !told.contains(key) && !table::IDLE.contains(&key);
        if let (true, Some(place)) = (is_new, stack.own_place(key)) {
            let value = stack.text(key);
            if !matches!(value.as_str(), "" | "False" | "0" | "none") && super::keys::find(key).is_none() {
                config.set(key, &escaped(&value), place.clone());
            }
        }
    }
    config
}

/// Whether a material is as thick as that, in whole millimetres as in Cura; what is not stated fits.
fn is_of_diameter(material: &Instance, diameter_mm: Option<f64>) -> bool {
    let own_mm: Option<f64> = material.about("diameter").parse().ok();
    own_mm.zip(diameter_mm).is_none_or(|(own, wanted)| own.round() == wanted.round())
}

fn raw(value: &Value) -> String {
    match value {
        Value::Text(text) => escaped(text),
        Value::List(list) => join_texts(&list.iter().map(Value::written).collect::<Vec<_>>()),
        other => other.written(),
    }
}

fn kind(value: &Value) -> Type {
    let (scalar, shape) = match value {
        Value::Number(number) if number.fract() == 0.0 => (Scalar::Integer, Shape::One),
        Value::Number(_) => (Scalar::Real, Shape::One),
        // Scripts show `True` and `False`.
        Value::Flag(_) | Value::Nothing | Value::Text(_) => (Scalar::Text, Shape::One),
        Value::List(_) => (Scalar::Text, Shape::List),
    };
    Type { scalar, shape }
}

fn at(kind: Kind) -> usize {
    match kind {
        Kind::Printer => 0,
        Kind::Print => 1,
        Kind::Filament => 2,
    }
}

impl Family for Cura {
    fn listed(&self, kind: Kind) -> Vec<&Listed> {
        let listed = |name: &str, place: Place| Listed {
            name: name.to_owned(),
            dialect: Dialect::Cura,
            is_user: false,
            place,
        };
        let instance = |one: &Instance| listed(&one.name, Place::new(one.file.clone(), 1, one.name.as_str()));
        let list = || match kind {
            Kind::Printer => {
                let shown = self.folder.machines().filter(|machine| machine.is_visible());
                shown.map(|m| listed(m.name(), Place::new(m.file.clone(), 1, m.name()))).collect()
            }
            Kind::Print => {
                let mut all: Vec<Listed> =
                    self.folder.qualities().unwrap_or_default().iter().map(instance).collect();
                if self.folder.machines().next().is_some() {
                    all.push(listed(OWN, Place::built_in(Dialect::Cura)));
                }
                let mut seen = BTreeSet::new();
                all.retain(|one| seen.insert(one.name.clone()));
                all
            }
            Kind::Filament => self.folder.materials().unwrap_or_default().iter().map(instance).collect(),
        };
        self.listed[at(kind)].get_or_init(list).iter().collect()
    }

    fn named(&self, kind: Kind, name: &str) -> Vec<&Listed> {
        self.listed(kind).into_iter().filter(|listed| listed.name == name).collect()
    }

    fn renamed(&self, _: Kind, _: &str) -> Option<&str> {
        None
    }

    fn preset(&self, kind: Kind, name: &str) -> Result<Config, PresetError> {
        let mut stack = Stack::default();
        match kind {
            Kind::Printer => stack = self.stack(&self.machine(name)?)?,
            Kind::Print => {
                let quality = self.folder.qualities()?.iter().find(|quality| quality.name == name);
                stack.add_values(quality.map_or(&BTreeMap::new(), |quality| &quality.values));
            }
            Kind::Filament => stack.add_values(&self.material(name, None)?.values),
        }
        Ok(config(&stack))
    }

    fn compatible(&self, kind: Kind, printer: &str, print: Option<&str>) -> Result<Vec<String>, PresetError> {
        let machine = self.machine(printer)?;
        let mut seen = BTreeSet::new();
        let mut names: Vec<String> = Vec::new();
        let mut add = |name: &str| {
            if seen.insert(name.to_owned()) {
                names.push(name.to_owned());
            }
        };
        if kind == Kind::Print {
            self.qualities(&machine, None)?.for_each(|quality| add(&quality.name));
            add(OWN);
            return Ok(names);
        }
        let diameter_mm = self.stack(&machine)?.number("material_diameter");
        let excluded = machine.about("exclude_materials").and_then(serde_json::Value::as_array);
        let is_excluded = |material: &Instance| {
            excluded.is_some_and(|list| list.iter().any(|id| id.as_str() == Some(&material.id)))
        };
        for material in self.folder.materials()? {
            let fits = is_of_diameter(material, diameter_mm);
            let has_quality = match print {
                Some(print) if print != OWN => {
                    self.qualities(&machine, Some(material))?.any(|quality| quality.name == print)
                }
                _ => true,
            };
            if fits && has_quality && !is_excluded(material) {
                add(&material.name);
            }
        }
        Ok(names)
    }

    fn preferred(&self, kind: Kind, printer: &str, _: Option<&str>) -> Result<Vec<String>, PresetError> {
        let machine = self.machine(printer)?;
        Ok(match kind {
            Kind::Printer => Vec::new(),
            Kind::Print => {
                let wanted = machine.text("preferred_quality_type");
                let of_type =
                    self.qualities(&machine, None)?.filter(|quality| quality.about("quality_type") == wanted);
                of_type.map(|quality| quality.name.clone()).collect()
            }
            Kind::Filament => {
                // Those of the usual diameter have it in their names.
                let wanted = machine.text("preferred_material");
                let ids = [
                    wanted.to_owned(),
                    format!("{}_175", wanted.trim_end_matches("_175")),
                    "generic_pla".into(),
                    "generic_pla_175".into(),
                ];
                let materials = self.folder.materials()?;
                let of_id = |id: &String| materials.iter().find(|material| material.id == *id);
                ids.iter().filter_map(of_id).map(|material| material.name.clone()).collect()
            }
        })
    }

    fn resolve(&self, printer: &str, print: &str, filament: &str) -> Result<Config, PresetError> {
        let machine = self.machine(printer)?;
        let mut stack = self.stack(&machine)?;
        let material = self.material(filament, stack.number("material_diameter"))?;
        self.with(&mut stack, &machine, print, material)?;
        let mut config = config(&stack);
        let place = Place::new(material.file.clone(), 1, material.name.as_str());
        let about = |key: &str| Some(material.about(key)).filter(|text| !text.is_empty());
        if let Some(kind) = about("material") {
            config.set("filament_type", &join_texts(&[kind]), place.clone());
        }
        if let Some(density) = about("density") {
            config.set("filament_density", density, place.clone());
        }
        let text = Type { scalar: Scalar::Text, shape: Shape::One };
        let number = Type { scalar: Scalar::Integer, shape: Shape::One };
        for name in table::OF_EXTRUDERS {
            config.set_raw(name, "0", Some(number));
        }
        for (key, name) in [("printer_settings_id", printer), ("print_settings_id", print)] {
            config.set(key, &escaped(name), Place::new(machine.machine.file.clone(), 1, printer));
            config.set_raw(key, &escaped(name), Some(text));
        }
        config.set("filament_settings_id", &join_texts(&[filament]), place);
        Ok(config)
    }
}
