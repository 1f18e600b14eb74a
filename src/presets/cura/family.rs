//! What Cura's presets can be asked for.

use std::collections::{BTreeMap, BTreeSet};

use super::added::Added;
use super::config::config;
use super::instance::Instance;
use super::presets::{Cura, OWN, Resolved, SET, is_of_diameter};
use super::several;
use super::stack::Stack;
use super::table;
use crate::presets::config::{Config, Dialect, Place};
use crate::presets::error::PresetError;
use crate::presets::family::{Family, Kind, Listed};
use crate::presets::value::{Scalar, Shape, Type, escaped, join_texts};

fn at(kind: Kind) -> usize {
    match kind {
        Kind::Printer => 0,
        Kind::Print => 1,
        Kind::Filament => 2,
    }
}

impl Family for Cura {
    fn listed(&self, kind: Kind) -> Vec<&Listed> {
        let listed = |name: &str, place: Place, is_user: bool| Listed {
            name: name.to_owned(),
            dialect: Dialect::Cura,
            is_user,
            place,
        };
        let instance = |one: &Instance, is_user: bool| {
            listed(&one.name, Place::new(one.file.clone(), 1, one.name.as_str()), is_user)
        };
        let stacks = self.folder.stacks().unwrap_or_default();
        let list = || match kind {
            Kind::Printer => {
                let added = Added::all(stacks).map(|added| instance(added.machine, true));
                let shown = self.folder.machines().filter(|machine| machine.is_visible());
                added
                    .chain(shown.map(|m| listed(m.name(), Place::new(m.file.clone(), 1, m.name()), false)))
                    .collect()
            }
            Kind::Print => {
                let changes = self.folder.changes().unwrap_or_default().iter();
                let changes = changes.filter(|changes| changes.about("type") == "quality_changes");
                let qualities = self.folder.qualities().unwrap_or_default().iter();
                let mut all: Vec<Listed> = changes.map(|changes| instance(changes, true)).collect();
                all.extend(qualities.map(|quality| instance(quality, false)));
                if Added::all(stacks).next().is_some() {
                    all.push(listed(SET, Place::built_in(Dialect::Cura), true));
                }
                if self.folder.machines().next().is_some() {
                    all.push(listed(OWN, Place::built_in(Dialect::Cura), false));
                }
                let mut seen = BTreeSet::new();
                all.retain(|one| seen.insert(one.name.clone()));
                all
            }
            Kind::Filament => {
                self.folder.materials().unwrap_or_default().iter().map(|one| instance(one, false)).collect()
            }
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
                let all = self.folder.changes()?.iter().chain(self.folder.qualities()?);
                let quality = all.into_iter().find(|quality| quality.name == name);
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
            machine.added.is_some().then(|| add(SET));
            self.profiles(&machine)?.iter().for_each(|changes| add(&changes.name));
            self.qualities(&machine, None)?.for_each(|quality| add(&quality.name));
            add(OWN);
            return Ok(names);
        }
        let diameter_mm = self.stack(&machine)?.number("material_diameter");
        let of_users = self.profiles(&machine)?;
        let is_of_vendor =
            |print: &str| print != OWN && print != SET && of_users.iter().all(|own| own.name != print);
        let excluded = machine.about("exclude_materials").and_then(serde_json::Value::as_array);
        let is_excluded = |material: &Instance| {
            excluded.is_some_and(|list| list.iter().any(|id| id.as_str() == Some(&material.id)))
        };
        for material in self.folder.materials()? {
            let fits = is_of_diameter(material, diameter_mm);
            let has_quality = match print {
                Some(print) if is_of_vendor(print) => {
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
            Kind::Print if machine.added.is_some() => vec![SET.to_owned()],
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
                let loaded = self.loaded(&machine)?.into_iter();
                loaded.chain(ids.iter().filter_map(of_id)).map(|material| material.name.clone()).collect()
            }
        })
    }

    fn resolve(&self, printer: &str, print: &str, filament: &str) -> Result<Config, PresetError> {
        let machine = self.machine(printer)?;
        let extruders = self.extruders(&machine)?;
        let is_loaded = self.loaded(&machine)?.is_some_and(|loaded| loaded.name == filament);
        let own = extruders
            .iter()
            .map(|own| self.of_extruder(own, [printer, print, filament], is_loaded, extruders.len()));
        Ok(several::joined(own.collect::<Result<_, _>>()?))
    }
}

impl Cura {
    /// What the presets of these names amount to for one of so many extruders; `is_loaded`: each has the filament that is in it.
    fn of_extruder(
        &self,
        machine: &Resolved<'_>,
        [printer, print, filament]: [&str; 3],
        is_loaded: bool,
        extruders: usize,
    ) -> Result<Config, PresetError> {
        let mut stack = self.stack(machine)?;
        stack.extruders = extruders;
        let material = match self.loaded(machine)?.filter(|_| is_loaded) {
            Some(loaded) => loaded,
            None => self.material(filament, stack.number("material_diameter"))?,
        };
        self.with(&mut stack, machine, print, material)?;
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
        for (name, extruder) in table::OF_EXTRUDERS.into_iter().zip([0, machine.extruder]) {
            config.set_raw(name, &extruder.to_string(), Some(number));
        }
        for (key, name) in [("printer_settings_id", printer), ("print_settings_id", print)] {
            config.set(key, &escaped(name), Place::new(machine.machine.file.clone(), 1, printer));
            config.set_raw(key, &escaped(name), Some(text));
        }
        config.set("filament_settings_id", &join_texts(&[&material.name]), place);
        Ok(config)
    }
}
