//! Bundles of PrusaSlicer and SuperSlicer as a family: what fits what, and three presets as one configuration.

use std::collections::{BTreeMap, BTreeSet};

use macros::{Names, Value};

use super::bundle::{Bundles, Found, Preset};
use super::config::{Config, Dialect, Place, Raw};
use super::error::PresetError;
use super::family::{Family, Kind, Listed, Source};
use super::files::Files;
use super::ini;
use super::keys::{self, FORGOTTEN, KEYS, Key, RENAMED};
use super::names::script_value;
use super::superslicer;
use super::value::{Type, for_all, join_texts, texts, unescaped, written_alike};

/// Keys that say how presets belong together, and are no settings.
const BELONGING: [&str; 7] = [
    "inherits",
    "renamed_from",
    "alias",
    "compatible_printers",
    "compatible_printers_condition",
    "compatible_prints",
    "compatible_prints_condition",
];

/// Keys that ask for other presets: scripts may read them, but they are no settings.
const ASKING: [&str; 2] = ["default_filament_profile", "default_print_profile"];

/// The vendor whose filaments are for the printers of all others.
const TEMPLATES: &str = "Templates";

/// Most extruders of a printer.
const MOST_EXTRUDERS: usize = 256;

/// Presets of PrusaSlicer and SuperSlicer.
#[derive(Debug, Default)]
pub(super) struct Prusa {
    bundles: Bundles,
}

impl Prusa {
    /// Reads what sources hold of such presets: bundles, folders of them, folders of a slicer's settings. What cannot be read
    /// is added to the problems.
    pub fn read(files: &Files, sources: &[&Source], problems: &mut Vec<PresetError>) -> Self {
        let mut bundles = Bundles::default();
        let mut read = |done: Result<(), PresetError>| problems.extend(done.err());
        for Source { path, dialect } in sources {
            if files.is_file(path) {
                read(bundles.add_file(files, path, *dialect));
                continue;
            }
            for file in ini::files(files, path).into_iter().chain(ini::files(files, &path.join("vendor"))) {
                read(bundles.add_file(files, &file, *dialect));
            }
            for kind in [Kind::Printer, Kind::Print, Kind::Filament] {
                for file in ini::files(files, &path.join(kind.name())) {
                    read(bundles.add_preset(files, kind, &file, *dialect));
                }
            }
        }
        Self { bundles }
    }

    fn find(&self, kind: Kind, name: &str) -> Result<&Preset, PresetError> {
        let missing = || PresetError::of(format!("there is no {} preset `{name}`", kind.name()));
        self.bundles.find(kind, name).ok_or_else(missing)
    }

    /// Whether it is not of a printer that hardens resin.
    fn melts(&self, preset: &Preset) -> bool {
        preset.kind != Kind::Printer || self.bundles.value(preset, "printer_technology") != Some("SLA")
    }

    /// The names in a key, with or without quotes.
    fn list(&self, preset: &Preset, key: &str) -> Vec<String> {
        let value = self.bundles.value(preset, key).unwrap_or_default();
        texts(value).into_iter().filter(|text| !text.is_empty()).map(|text| text.into_owned()).collect()
    }

    /// What conditions on a preset are decided with.
    fn facts(&self, preset: &Preset) -> Result<Facts<'_>, PresetError> {
        let found = self.bundles.values(preset)?;
        let values: BTreeMap<&str, &str> = found.iter().map(|found| (found.key, found.value)).collect();
        let extruders = values.get("nozzle_diameter").map_or(1, |value| extruders(value));
        Ok(Facts { values, dialect: preset.listed.dialect, preset: preset.name.clone(), extruders })
    }

    /// Whether a preset is for another, as the list of names in the key `compatible_…` or the condition in
    /// `compatible_…_condition` says.
    fn fits(&self, preset: &Preset, key: &str, with: &mut Decided<'_>) -> bool {
        let names = self.list(preset, key);
        if !names.is_empty() {
            return names.iter().any(|name| *name == with.facts.preset || *name == with.made_from);
        }
        let condition = self.condition(preset, &format!("{key}_condition"));
        condition.trim().is_empty() || with.holds(&condition)
    }

    fn condition(&self, preset: &Preset, key: &str) -> String {
        unescaped(self.bundles.value(preset, key).unwrap_or_default())
    }

    fn same_vendor(&self, preset: &Preset, printer: &Preset) -> bool {
        match self.bundles.vendor(preset) {
            Some(TEMPLATES) | None => true,
            vendor => vendor == self.bundles.vendor(printer),
        }
    }

    /// What is built in, if that is asked for, and what the presets say: place and value as PrusaSlicer would write it. Extruders: as many as there are
    /// nozzles.
    fn combined(&self, presets: &[&Preset], built_in: bool) -> Result<Config, PresetError> {
        let mut config = Config { dialect: presets[0].listed.dialect, ..Config::default() };
        let mut found: BTreeMap<&str, Found<'_>> = BTreeMap::new();
        for preset in presets {
            found.extend(self.bundles.values(preset)?.into_iter().map(|found| (found.key, found)));
        }
        if config.dialect == Dialect::Super {
            let said = found.into_values().map(|Found { key, value, place }| (key, value, place));
            let today = superslicer::called_today(said).into_iter();
            found = today.map(|(key, value, place)| (key, Found { key, value, place })).collect();
        }
        let extruders = found.get("nozzle_diameter").map_or(1, |found| extruders(found.value));
        if built_in {
            let built_in = Place::built_in(config.dialect);
            for key in all_keys(config.dialect).into_iter().filter(|key| !found.contains_key(key.name)) {
                let value = for_all(key.kind, key.default, extruders, key.default);
                if !ASKING.contains(&key.name) {
                    config.set_known(key.name, &value, Some(key.kind), built_in.clone());
                }
                config.set_raw(key.name, &value, Some(key.kind));
            }
        }
        for (key, Found { value, place, .. }) in found {
            if BELONGING.contains(&key) || (FORGOTTEN.contains(&key) && config.dialect == Dialect::Prusa) {
                continue;
            }
            let known = find_key(config.dialect, key);
            let value = match known {
                Some(known) => {
                    let renamed = RENAMED.iter().find(|(name, old, _)| *name == key && *old == value);
                    let value = renamed.filter(|_| config.dialect == Dialect::Prusa).map_or(value, |r| r.2);
                    for_all(known.kind, &written_alike(known.kind, value), extruders, known.default)
                }
                None => value.to_owned(),
            };
            let kind = known.map(|known| known.kind);
            if !ASKING.contains(&key) {
                config.set_known(key, &value, kind, place);
            }
            config.set_raw(key, &value, kind);
        }
        if config.dialect == Dialect::Super {
            superslicer::translate(&mut config);
        }
        Ok(config)
    }

    /// Keys that say what a configuration was made of.
    fn add_names(&self, config: &mut Config, [printer, print, filament]: [&Preset; 3]) {
        let count = config.raw.get("nozzle_diameter").map_or(1, |raw| extruders(&raw.value));
        let each = |text: &str| join_texts(&vec![text; count]);
        let place = |preset: &Preset| preset.listed.place.clone();
        let mut set = |key: &str, value: &str, place| config.set_both(key, value, keys::key_type(key), place);
        set("printer_settings_id", &printer.name, place(printer));
        set("print_settings_id", &print.name, place(print));
        set("filament_settings_id", &each(&filament.name), place(filament));
        let condition = |preset| self.condition(preset, "compatible_printers_condition");
        let all = |print: &str, filament: &str, printer: Option<&str>| {
            let filaments = std::iter::repeat_n(filament, count);
            let all: Vec<&str> = std::iter::once(print).chain(filaments).chain(printer).collect();
            all.iter().any(|text| !text.is_empty()).then(|| join_texts(&all))
        };
        if let Some(all) = all(&condition(print), &condition(filament), None) {
            set("compatible_printers_condition_cummulative", &all, place(print));
        }
        let from = [print, filament, printer].map(|preset| self.bundles.made_from(preset));
        if let Some(all) = all(from[0], from[1], Some(from[2])) {
            set("inherits_cummulative", &all, place(print));
        }
    }
}

impl Config {
    /// Whether a key of SuperSlicer's own says what is built in there.
    pub fn is_as_built_in(&self, key: &str) -> bool {
        let known = superslicer::find_key(key).filter(|_| self.dialect == Dialect::Super);
        known.is_some_and(|known| {
            let own = self.text(key).map(|text| written_alike(known.kind, text));
            own.is_none_or(|own| own == for_all(known.kind, known.default, 1, known.default))
        })
    }

    /// Adds a value that the slicer's scripts call as PrusaSlicer does.
    pub(super) fn set_both(&mut self, key: &str, value: &str, kind: Option<Type>, place: Place) {
        self.set_known(key, value, kind, place);
        self.set_raw(key, value, kind);
    }
}

impl Family for Prusa {
    fn listed(&self, kind: Kind) -> Vec<&Listed> {
        self.bundles.chosable(kind).filter(|preset| self.melts(preset)).map(|preset| &preset.listed).collect()
    }

    fn named(&self, kind: Kind, name: &str) -> Vec<&Listed> {
        let named = self.bundles.named(kind, name).filter(|preset| !preset.name.starts_with('*'));
        named.filter(|preset| self.melts(preset)).map(|preset| &preset.listed).collect()
    }

    fn renamed(&self, kind: Kind, formerly: &str) -> Option<&str> {
        self.bundles.formerly(kind, formerly).map(|preset| preset.name.as_str())
    }

    fn preset(&self, kind: Kind, name: &str) -> Result<Config, PresetError> {
        self.combined(&[self.find(kind, name)?], kind == Kind::Printer)
    }

    fn compatible(&self, kind: Kind, printer: &str, print: Option<&str>) -> Result<Vec<String>, PresetError> {
        let printer = self.find(Kind::Printer, printer)?;
        let print = print.map(|print| self.find(Kind::Print, print)).transpose()?;
        let decided = |preset| {
            let made_from = self.bundles.made_from(preset).to_owned();
            Ok(Decided { facts: self.facts(preset)?, made_from, known: BTreeMap::new() })
        };
        let mut with_printer = decided(printer)?;
        let mut with_print = print.map(decided).transpose()?;
        let mut names = BTreeSet::new();
        for preset in self.bundles.chosable(kind) {
            let is_taken = || self.bundles.find(kind, &preset.name).is_some_and(|p| std::ptr::eq(p, preset));
            let fits = self.same_vendor(preset, printer)
                && is_taken()
                && self.fits(preset, "compatible_printers", &mut with_printer)
                && with_print.as_mut().is_none_or(|with| self.fits(preset, "compatible_prints", with));
            if fits {
                names.insert(preset.name.clone());
            }
        }
        Ok(names.into_iter().collect())
    }

    fn preferred(&self, kind: Kind, printer: &str, _print: Option<&str>) -> Result<Vec<String>, PresetError> {
        let printer = self.find(Kind::Printer, printer)?;
        let key = match kind {
            Kind::Printer => return Ok(Vec::new()),
            Kind::Print => "default_print_profile",
            Kind::Filament => "default_filament_profile",
        };
        // Some vendors put the names of all extruders between the same quotes.
        let names = self.list(printer, key);
        Ok(names.iter().flat_map(|names| names.split(';')).map(|name| name.trim().to_owned()).collect())
    }

    fn is_own(&self, kind: Kind, printer: &str, name: &str) -> bool {
        let vendor = |kind, name| self.find(kind, name).ok().and_then(|preset| self.bundles.vendor(preset));
        vendor(kind, name).is_none_or(|its| Some(its) == vendor(Kind::Printer, printer))
    }

    /// Layers half as high as the nozzle is wide; a filament of the printer's own vendor, and PLA.
    fn unlike(&self, kind: Kind, printer: &str, name: &str) -> u64 {
        let (Ok(machine), Ok(preset)) = (self.find(Kind::Printer, printer), self.find(kind, name)) else {
            return 0;
        };
        let number = |preset, key, default: f64| {
            let value = self.bundles.value(preset, key).and_then(|text| text.split(',').next());
            value.and_then(|text| text.trim().parse().ok()).unwrap_or(default)
        };
        match kind {
            Kind::Printer => 0,
            Kind::Print => {
                let wanted_mm = number(machine, "nozzle_diameter", 0.4) / 2.0;
                (1000.0 * (number(preset, "layer_height", 0.3) - wanted_mm).abs()).round() as u64
            }
            Kind::Filament => {
                let material = self.bundles.value(preset, "filament_type");
                let is_pla = material.is_none_or(|material| material == "PLA");
                2 * u64::from(!self.is_own(kind, printer, name)) + u64::from(!is_pla)
            }
        }
    }

    fn resolve(&self, printer: &str, print: &str, filament: &str) -> Result<Config, PresetError> {
        let print = self.find(Kind::Print, print)?;
        let filament = self.find(Kind::Filament, filament)?;
        let presets = [self.find(Kind::Printer, printer)?, print, filament];
        let mut config = self.combined(&presets, true)?;
        self.add_names(&mut config, presets);
        Ok(config)
    }
}

/// All keys that a slicer has built in.
fn all_keys(dialect: Dialect) -> Vec<&'static Key> {
    match dialect {
        Dialect::Super => superslicer::all_keys().collect(),
        _ => KEYS.iter().collect(),
    }
}

/// The key of that name, as a slicer has it.
fn find_key(dialect: Dialect, name: &str) -> Option<&'static Key> {
    match dialect {
        Dialect::Super => superslicer::find_key(name),
        _ => keys::find(name),
    }
}

/// How many extruders nozzles are of.
fn extruders(nozzle_diameter: &str) -> usize {
    nozzle_diameter.split(',').count().min(MOST_EXTRUDERS)
}

/// A preset's values as conditions see them.
struct Facts<'a> {
    values: BTreeMap<&'a str, &'a str>,
    dialect: Dialect,
    preset: String,
    extruders: usize,
}

impl Names for Facts<'_> {
    fn value(&self, name: &str) -> Option<Value> {
        match name {
            "printer_preset" => return Some(Value::Text(self.preset.clone())),
            "num_extruders" => return i64::try_from(self.extruders).ok().map(Value::Integer),
            _ => {}
        }
        let known = find_key(self.dialect, name);
        let written = self.values.get(name).copied().or(known.map(|known| known.default))?;
        let value = known.map_or_else(
            || written.to_owned(),
            |known| for_all(known.kind, written, self.extruders, known.default),
        );
        Some(script_value(&Raw { value, kind: known.map(|known| known.kind) }))
    }

    fn names(&self) -> Vec<String> {
        self.values.keys().map(|name| (*name).to_owned()).collect()
    }
}

/// Conditions on a preset, each decided once.
struct Decided<'a> {
    facts: Facts<'a>,
    /// A list that names what a user's preset was made from means that one, too.
    made_from: String,
    known: BTreeMap<String, bool>,
}

impl Decided<'_> {
    /// Like in the slicer, what cannot be decided keeps nobody out.
    fn holds(&mut self, condition: &str) -> bool {
        if let Some(&holds) = self.known.get(condition) {
            return holds;
        }
        let holds = macros::holds(condition, &self.facts).unwrap_or(true);
        self.known.insert(condition.to_owned(), holds);
        holds
    }
}
