//! Presets of OrcaSlicer and its kin (Bambu Studio, Creality Print, the slicers of other makers of printers): JSON files, by
//! vendor, in which presets inherit from others by name.

mod convert;
mod folder;
mod json;
mod keys;
mod legacy;
mod project;
mod rules;
mod values;

use std::collections::BTreeSet;
use std::sync::OnceLock;

pub(super) use folder::is_preset;
pub(super) use project::{of_object, project};

use super::config::{Config, Dialect, Place};
use super::error::PresetError;
use super::family::{Family, Kind, Listed, Source};
use super::files::Files;
use super::value::{Scalar, Shape, Type};
use folder::{Folder, Preset};
use json::Written;
use values::Values;

/// Presets inherit from each other no deeper than this.
const DEEPEST: usize = 64;

/// All presets of these slicers.
#[derive(Debug)]
pub(super) struct Orca {
    /// Users' first.
    folders: Vec<Folder>,
    listed: [OnceLock<Vec<Listed>>; 3],
}

/// A preset with whom it belongs to.
#[derive(Clone, Copy)]
struct Found<'a> {
    folder: &'a Folder,
    preset: &'a Preset,
}

impl Orca {
    /// Reads which presets there are.
    pub fn read(files: &Files, sources: &[&Source], problems: &mut Vec<PresetError>) -> Self {
        let found = sources.iter().flat_map(|source| folder::find(files, &source.path, problems));
        let mut folders: Vec<Folder> = found.collect();
        folders.sort_by_key(|folder| !folder.is_user);
        Self { folders, listed: Default::default() }
    }

    fn all(&self, kind: Kind) -> impl Iterator<Item = Found<'_>> {
        self.folders
            .iter()
            .flat_map(move |folder| folder.presets(kind).iter().map(move |preset| Found { folder, preset }))
    }

    /// A preset that can be chosen.
    fn find(&self, kind: Kind, name: &str) -> Result<Found<'_>, PresetError> {
        let mut of_name = self.folders.iter().filter_map(|folder| {
            let preset = folder.find(kind, name)?;
            preset.can_be_chosen().then_some(Found { folder, preset })
        });
        of_name.next().ok_or_else(|| PresetError::of(format!("there is no {} preset `{name}`", kind.name())))
    }

    /// The preset that another one inherits from: of the same vendor, of the filaments that all share, or of any vendor if it is
    /// a user's.
    fn parent<'a>(&'a self, kind: Kind, name: &str, of: Found<'a>) -> Option<Found<'a>> {
        let is_open = |folder: &&Folder| match kind {
            Kind::Filament if folder.is_library => true,
            _ => of.folder.is_user,
        };
        let own = std::iter::once(of.folder);
        let others = self.folders.iter().filter(is_open);
        let mut found = own.chain(others).filter_map(|folder| {
            let preset = folder.find(kind, name)?;
            (!std::ptr::eq(preset, of.preset)).then_some(Found { folder, preset })
        });
        // A preset that is called like its parent has it elsewhere, or is its own.
        found.next().or_else(|| (of.preset.name == name).then_some(of))
    }

    /// What a preset inherits from.
    fn above<'a>(&'a self, kind: Kind, of: Found<'a>) -> Result<Option<Found<'a>>, PresetError> {
        let file = of.preset.file()?;
        let Some(written) = file.get("inherits").filter(|written| !written.first().is_empty()) else {
            return Ok(None);
        };
        let name = written.first();
        let missing = || {
            let place = Place::new(file.path.clone(), written.line, of.preset.name.as_str());
            PresetError::at(place, format!("inherits from `{name}`, which is not there"))
        };
        self.parent(kind, name, of).map(Some).ok_or_else(missing)
    }

    /// A preset and all that it inherits from, the last one first.
    fn chain<'a>(&'a self, kind: Kind, preset: Found<'a>) -> Result<Vec<Found<'a>>, PresetError> {
        let mut chain = vec![preset];
        loop {
            let last = chain[chain.len() - 1];
            let Some(parent) = self.above(kind, last)? else { return Ok(chain) };
            let is_known = chain.iter().any(|known| std::ptr::eq(known.preset, parent.preset));
            chain.push(parent);
            if chain.len() > DEEPEST || is_known {
                let names: Vec<&str> = chain.iter().map(|found| found.preset.name.as_str()).collect();
                let message = format!("inherits from itself: {}", names.join(" → "));
                return Err(PresetError::at(last.preset.place(), message));
            }
        }
    }

    /// Adds what a preset says, what it inherits first.
    fn gather(&self, kind: Kind, preset: Found<'_>, values: &mut Values) -> Result<(), PresetError> {
        let chain = self.chain(kind, preset)?;
        if kind == Kind::Printer {
            model(&chain, values);
        }
        for found in chain.iter().rev() {
            let file = found.preset.file()?;
            for (key, written) in &file.entries {
                if keys::ABOUT.contains(&key.as_str()) || key == "inherits" {
                    continue;
                }
                let place = Place::new(file.path.clone(), written.line, found.preset.name.as_str());
                values.set(key, written.clone(), place);
            }
        }
        Ok(())
    }

    /// The names that the first of a chain has for a key. What is above is not looked at: it may be damaged.
    fn inherited(&self, kind: Kind, preset: Found<'_>, key: &str) -> Result<Vec<String>, PresetError> {
        let mut next = Some(preset);
        for _ in 0..=DEEPEST {
            let Some(found) = next else { break };
            if let Some(written) = found.preset.file()?.get(key) {
                return Ok(split(written));
            }
            next = self.above(kind, found)?;
        }
        Ok(Vec::new())
    }

    /// A printer as conditions of others see it.
    fn printer_config(&self, printer: Found<'_>) -> Result<Config, PresetError> {
        let mut values = Values::new(keys::built_in);
        self.gather(Kind::Printer, printer, &mut values)?;
        let mut config = convert::config(&values);
        let nozzles = values.all("nozzle_diameter").len();
        set_text(&mut config, "printer_preset", &printer.preset.name);
        let count = Type { scalar: Scalar::Integer, shape: Shape::One };
        config.set_raw("num_extruders", &nozzles.to_string(), Some(count));
        Ok(config)
    }

    /// Whether a preset is for a printer (or a print) of one of these names.
    fn fits(
        &self,
        kind: Kind,
        preset: Found<'_>,
        key: &str,
        names: &BTreeSet<&str>,
        facts: &Config,
    ) -> Result<bool, PresetError> {
        let listed = self.inherited(kind, preset, key)?;
        if !listed.is_empty() {
            return Ok(listed.iter().any(|name| names.contains(name.as_str())));
        }
        let condition = self.inherited(kind, preset, &format!("{key}_condition"))?.join(";");
        // Like in the slicer, what cannot be decided keeps nobody out.
        Ok(condition.trim().is_empty() || macros::holds(&condition, facts).unwrap_or(true))
    }
}

/// What the model of a machine says of it: the plate it comes with.
fn model(chain: &[Found<'_>], values: &mut Values) {
    const KEY: &str = "default_bed_type";
    let Some(model) = model_of(chain) else { return };
    if let Ok(file) = model.file()
        && let Some(written) = file.get(KEY)
    {
        values.set(KEY, written.clone(), Place::new(file.path.clone(), written.line, model.name.as_str()));
    }
}

/// The names in a value: in a list, or with `;` between them.
fn split(written: &Written) -> Vec<String> {
    let split = |text: &String| text.split(';').map(str::to_owned).collect::<Vec<_>>();
    let names = match written.is_list {
        true => written.values.clone(),
        false => written.values.iter().flat_map(split).collect(),
    };
    names.iter().map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

/// The model of a machine.
fn model_of<'a>(chain: &[Found<'a>]) -> Option<&'a Preset> {
    let name =
        chain.iter().find_map(|found| Some(found.preset.file().ok()?.get("printer_model")?.first()))?;
    chain.iter().find_map(|found| found.folder.model(name))
}

fn set_text(config: &mut Config, name: &str, text: &str) {
    let kind = Type { scalar: Scalar::Text, shape: Shape::One };
    config.set_raw(name, &super::value::escaped(text), Some(kind));
}

/// What a filament is called without what it is for.
fn alias(name: &str) -> &str {
    name.split('@').next().unwrap_or_default().trim()
}

fn at(kind: Kind) -> usize {
    match kind {
        Kind::Printer => 0,
        Kind::Print => 1,
        Kind::Filament => 2,
    }
}

impl Family for Orca {
    fn listed(&self, kind: Kind) -> Vec<&Listed> {
        let listed = |found: Found<'_>| Listed {
            name: found.preset.name.clone(),
            dialect: Dialect::Orca,
            is_user: found.folder.is_user,
            place: found.preset.place(),
        };
        let can_be_chosen = |found: &Found<'_>| found.preset.can_be_chosen();
        let list = || self.all(kind).filter(can_be_chosen).map(listed).collect();
        self.listed[at(kind)].get_or_init(list).iter().collect()
    }

    fn named(&self, kind: Kind, name: &str) -> Vec<&Listed> {
        self.listed(kind).into_iter().filter(|listed| listed.name == name).collect()
    }

    fn renamed(&self, kind: Kind, formerly: &str) -> Option<&str> {
        let was_called_so = |found: &Found<'_>| {
            let former = found.preset.file().ok().and_then(|file| file.get("renamed_from"));
            former.is_some_and(|written| {
                written.values.iter().flat_map(|names| names.split(';')).any(|name| name.trim() == formerly)
            })
        };
        self.all(kind)
            .find(|found| was_called_so(found) && found.preset.can_be_chosen())
            .map(|found| found.preset.name.as_str())
    }

    fn preset(&self, kind: Kind, name: &str) -> Result<Config, PresetError> {
        let mut values = Values::new(keys::built_in);
        self.gather(kind, self.find(kind, name)?, &mut values)?;
        Ok(convert::config(&values))
    }

    fn compatible(&self, kind: Kind, printer: &str, print: Option<&str>) -> Result<Vec<String>, PresetError> {
        let printer = self.find(Kind::Printer, printer)?;
        let lineage = self.chain(Kind::Printer, printer)?;
        // A user's printer is also what it was made from, with all that fits that.
        let stem = lineage.iter().find(|found| !found.folder.is_user).unwrap_or(&printer);
        let names = BTreeSet::from([printer.preset.name.as_str(), stem.preset.name.as_str()]);
        let facts = self.printer_config(printer)?;
        let print = print.map(|print| self.find(Kind::Print, print)).transpose()?;
        let print_names = print.map(|print| BTreeSet::from([print.preset.name.as_str()]));
        let mut fitting: Vec<Found<'_>> = Vec::new();
        for found in self.all(kind) {
            let is_near =
                found.folder.is_user || found.folder.is_library || std::ptr::eq(found.folder, stem.folder);
            if !is_near || !found.preset.can_be_chosen() {
                continue;
            }
            // One that does not resolve fits nothing; it must not keep others from being found.
            let fits = self.fits(kind, found, "compatible_printers", &names, &facts);
            let with_print = match &print_names {
                Some(names) if kind == Kind::Filament => {
                    self.inherited(kind, found, "compatible_prints").map(|listed| {
                        listed.is_empty() || listed.iter().any(|name| names.contains(name.as_str()))
                    })
                }
                _ => Ok(true),
            };
            let resolves = || self.chain(kind, found).is_ok();
            if fits.unwrap_or(false) && with_print.unwrap_or(false) && resolves() {
                fitting.push(found);
            }
        }
        // A vendor's own filament stands for the shared one of that name.
        let own: BTreeSet<&str> = fitting
            .iter()
            .filter(|found| !found.folder.is_library)
            .map(|found| alias(&found.preset.name))
            .collect();
        fitting.retain(|found| !found.folder.is_library || !own.contains(alias(&found.preset.name)));
        fitting.sort_by_key(|found| (!found.folder.is_user, found.folder.is_library));
        let mut seen = BTreeSet::new();
        let names = fitting.iter().map(|found| found.preset.name.as_str());
        Ok(names.filter(|name| seen.insert(*name)).map(str::to_owned).collect())
    }

    fn preferred(&self, kind: Kind, printer: &str, _: Option<&str>) -> Result<Vec<String>, PresetError> {
        let key = match kind {
            Kind::Printer => return Ok(Vec::new()),
            Kind::Print => "default_print_profile",
            Kind::Filament => "default_filament_profile",
        };
        let printer = self.find(Kind::Printer, printer)?;
        let mut names = self.inherited(Kind::Printer, printer, key)?;
        // Its model may name materials, too.
        let chain = self.chain(Kind::Printer, printer)?;
        let model = model_of(&chain).filter(|_| kind == Kind::Filament).and_then(|model| model.file().ok());
        if let Some(materials) = model.and_then(|file| file.get("default_materials")) {
            names.extend(split(materials));
        }
        Ok(names)
    }

    /// Layers half as high as the nozzle is wide; PLA.
    fn unlike(&self, kind: Kind, printer: &str, name: &str) -> u64 {
        let (Ok(printer), Ok(found)) = (self.find(Kind::Printer, printer), self.find(kind, name)) else {
            return 0;
        };
        let first = |kind: Kind, found: Found<'_>, key: &str| {
            self.inherited(kind, found, key).ok().and_then(|all| all.into_iter().next())
        };
        let number = |kind: Kind, found: Found<'_>, key: &str| first(kind, found, key)?.parse::<f64>().ok();
        match kind {
            Kind::Printer => 0,
            Kind::Print => {
                let wanted_mm = number(Kind::Printer, printer, "nozzle_diameter").unwrap_or(0.4) / 2.0;
                let height_mm = number(kind, found, "layer_height").unwrap_or(0.2);
                (1000.0 * (height_mm - wanted_mm).abs()).round() as u64
            }
            Kind::Filament => {
                u64::from(first(kind, found, "filament_type").is_some_and(|material| material != "PLA"))
            }
        }
    }

    fn resolve(&self, printer: &str, print: &str, filament: &str) -> Result<Config, PresetError> {
        let mut values = Values::new(keys::built_in);
        let chosen = [(Kind::Printer, printer), (Kind::Print, print), (Kind::Filament, filament)];
        for (kind, name) in chosen {
            self.gather(kind, self.find(kind, name)?, &mut values)?;
        }
        let mut config = convert::config(&values);
        for (kind, name) in chosen {
            set_text(&mut config, &format!("{}_preset", kind.name()), name);
            let (id, is_list) = match kind {
                Kind::Printer => ("printer_settings_id", false),
                Kind::Print => ("print_settings_id", false),
                Kind::Filament => ("filament_settings_id", true),
            };
            let value = if is_list { super::value::join_texts(&[name]) } else { super::value::escaped(name) };
            let place = self.find(kind, name)?.preset.place();
            config.set(id, &value, place);
            let shape = if is_list { Shape::Each } else { Shape::One };
            config.set_raw(id, &value, Some(Type { scalar: Scalar::Text, shape }));
        }
        Ok(config)
    }
}
