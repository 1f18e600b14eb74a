//! Cura's containers of values: qualities, nozzles, changes (`.inst.cfg`), materials (`.xml.fdm_material`); and stacks of containers
//! (`.global.cfg`, `.extruder.cfg`).

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use percent_encoding::percent_decode_str;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use super::said::Said;
use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// A container of values.
#[derive(Debug, Default)]
pub(super) struct Instance {
    pub name: String,
    /// By which others name it: its file without endings.
    pub id: String,
    /// The definition that it is for.
    pub definition: String,
    pub metadata: BTreeMap<String, String>,
    pub values: BTreeMap<String, Said>,
    /// Values for machines of these names alone.
    pub of_machines: Vec<(Vec<String>, BTreeMap<String, Said>)>,
    /// Of a stack: by their ids, what it is made of, the top one first.
    pub containers: Vec<String>,
    pub file: Arc<str>,
}

impl Instance {
    /// What is said of the container itself; empty: nothing.
    pub fn about(&self, key: &str) -> &str {
        self.metadata.get(key).map_or("", String::as_str)
    }

    /// Reads an `.inst.cfg` or a stack.
    ///
    /// # Errors
    /// It cannot be read, or a line is neither a section nor `key = value`.
    pub fn read(files: &Files, path: &Path) -> Result<Vec<Self>, PresetError> {
        let (file, text) = text(files, path)?;
        Ok(vec![Self::parse(file, &text)?])
    }

    /// Reads the lines of an `.inst.cfg` or a stack of that name.
    ///
    /// # Errors
    /// A line is neither a section nor `key = value`.
    pub fn parse(file: Arc<str>, text: &str) -> Result<Self, PresetError> {
        let mut read = Self { id: id(&file), file: file.clone(), ..Self::default() };
        let mut section = "";
        // A line that is indented goes on with what the one before began, be there empty lines in between.
        let mut last: Option<String> = None;
        let mut empty = 0;
        for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let is_continued = line.starts_with([' ', '\t']);
            let line = line.trim();
            if line.is_empty() {
                empty += 1;
                continue;
            }
            let skipped = std::mem::take(&mut empty);
            if let (true, Some(said)) = (is_continued, last.as_ref().and_then(|key| read.values.get_mut(key)))
            {
                said.go_on(skipped, line);
                continue;
            }
            if line.starts_with(['#', ';']) {
                continue;
            }
            if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
                section = name.trim();
                last = None;
                continue;
            }
            let Some((key, value)) = line.split_once('=').map(|(key, value)| (key.trim(), value.trim()))
            else {
                let place = Place::new(file, index + 1, section);
                return Err(PresetError::at(place, format!("`{line}` is no `key = value`")));
            };
            match section {
                "values" => {
                    let place = Place::new(file.clone(), index + 1, read.name.as_str());
                    read.values.insert(key.to_owned(), Said::of_text(value, place));
                    last = Some(key.to_owned());
                }
                "containers" => read.containers.push(value.to_owned()),
                "general" if key == "id" => read.id = value.to_owned(),
                "general" if key == "name" => read.name = value.to_owned(),
                "general" if key == "definition" => read.definition = value.to_owned(),
                _ => {
                    read.metadata.insert(key.to_owned(), value.to_owned());
                }
            }
        }
        Ok(read)
    }

    /// Reads an `.xml.fdm_material`.
    ///
    /// # Errors
    /// It cannot be read, or is no XML.
    pub fn read_material(files: &Files, path: &Path) -> Result<Vec<Self>, PresetError> {
        let (file, text) = text(files, path)?;
        Ok(vec![Self::parse_material(file, &text)?])
    }

    fn parse_material(file: Arc<str>, text: &str) -> Result<Self, PresetError> {
        let mut read = Self { id: id(&file), file: file.clone(), ..Self::default() };
        let mut reader = Reader::from_str(text);
        // Names of the elements that are open, and the text of the innermost.
        let mut open: Vec<String> = Vec::new();
        let (mut key, mut inside) = (String::new(), String::new());
        let mut machines: Option<(Vec<String>, BTreeMap<String, Said>)> = None;
        let mut hotends = 0_usize;
        loop {
            let event = reader.read_event().map_err(|error| {
                let place = Place::new(file.clone(), line(text, reader.error_position()), read.name.as_str());
                PresetError::at(place, format!("is damaged XML: {error}"))
            })?;
            match event {
                Event::Start(tag) => {
                    let name = local(tag.name().0).to_owned();
                    inside.clear();
                    match name.as_str() {
                        "setting" => key = attribute(&tag, "key").unwrap_or_default(),
                        "machine" => machines = Some(Default::default()),
                        "hotend" | "buildplate" => hotends += 1,
                        "machine_identifier" => identified(&tag, &mut machines),
                        _ => {}
                    }
                    open.push(name);
                }
                Event::Empty(tag) if local(tag.name().0) == "machine_identifier" => {
                    identified(&tag, &mut machines)
                }
                Event::Text(part) => inside += &part.xml_content(quick_xml::XmlVersion::Implicit1_0),
                Event::GeneralRef(entity) => {
                    let known = [("amp", "&"), ("lt", "<"), ("gt", ">"), ("quot", "\""), ("apos", "'")];
                    inside += known.iter().find(|(name, _)| *name == &*entity).map_or("", |(_, text)| text);
                }
                Event::End(_) => {
                    let name = open.pop().unwrap_or_default();
                    let parent = open.last().map_or("", String::as_str);
                    let value = inside.trim();
                    match (parent, name.as_str()) {
                        ("name" | "properties", about) => {
                            read.metadata.insert(about.to_owned(), value.to_owned());
                        }
                        // What is for one nozzle alone would need its name.
                        (_, "setting") if hotends == 0 && is_for_printing(&key) => {
                            let setting = MATERIAL.iter().find(|(theirs, _)| *theirs == key);
                            let setting = setting.map_or(key.as_str(), |(_, setting)| setting).to_owned();
                            let values = machines.as_mut().map_or(&mut read.values, |(_, values)| values);
                            let place = Place::new(file.clone(), line(text, reader.buffer_position()), "");
                            values.insert(setting, Said::of_text(value, place));
                        }
                        (_, "hotend" | "buildplate") => hotends = hotends.saturating_sub(1),
                        (_, "machine") => read.of_machines.extend(machines.take()),
                        _ => {}
                    }
                    inside.clear();
                }
                Event::Eof => break,
                _ => {}
            }
        }
        let [brand, material, color, label] =
            ["brand", "material", "color", "label"].map(|key| read.about(key));
        read.name = match (label, color) {
            ("", "" | "Generic") => format!("{brand} {material}"),
            ("", color) => format!("{brand} {material} {color}"),
            (label, _) => format!("{brand} {label}"),
        };
        Ok(read)
    }
}

/// What materials call settings, and what definitions do.
static MATERIAL: &[(&str, &str)] = &[
    ("print temperature", "default_material_print_temperature"),
    ("heated bed temperature", "default_material_bed_temperature"),
    ("standby temperature", "material_standby_temperature"),
    ("build volume temperature", "build_volume_temperature"),
    ("print cooling", "cool_fan_speed"),
    ("retraction amount", "retraction_amount"),
    ("retraction speed", "retraction_speed"),
    ("adhesion tendency", "material_adhesion_tendency"),
    ("surface energy", "material_surface_energy"),
    ("shrinkage percentage", "material_shrinkage_percentage"),
];

/// The line that a byte stands on, from 1.
fn line(text: &str, offset: u64) -> usize {
    let before = usize::try_from(offset).unwrap_or(usize::MAX).min(text.len());
    memchr::memchr_iter(b'\n', &text.as_bytes()[..before]).count() + 1
}

/// A name without its prefix.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// Whether a material's setting has a name among settings; others are of stations that load it.
fn is_for_printing(key: &str) -> bool {
    !key.contains(' ') || MATERIAL.iter().any(|(theirs, _)| *theirs == key)
}

fn identified(tag: &BytesStart<'_>, machines: &mut Option<(Vec<String>, BTreeMap<String, Said>)>) {
    if let (Some((names, _)), Some(product)) = (machines, attribute(tag, "product")) {
        names.push(product);
    }
}

fn attribute(tag: &BytesStart<'_>, key: &str) -> Option<String> {
    let attribute = tag.attributes().flatten().find(|attribute| local(attribute.key.0) == key)?;
    attribute.normalized_value(quick_xml::XmlVersion::Implicit1_0).ok().map(|value| value.into_owned())
}

fn text(files: &Files, path: &Path) -> Result<(Arc<str>, String), PresetError> {
    let file: Arc<str> = path.display().to_string().into();
    let text =
        files.text(path).map_err(|message| PresetError::at(Place::new(file.clone(), 0, ""), message))?;
    Ok((file, text))
}

/// Endings of files of containers and stacks.
pub(super) const ENDINGS: [&str; 4] = [".inst.cfg", ".global.cfg", ".extruder.cfg", ".xml.fdm_material"];

/// By which others name a container: its file without folder and ending, the web's escapes undone.
fn id(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let name = ENDINGS.iter().find_map(|ending| name.strip_suffix(ending)).unwrap_or(name);
    percent_decode_str(&name.replace('+', " ")).decode_utf8_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::cura::formula::Value;

    #[test]
    fn qualities_are_values_and_formulas() {
        let text = "[general]\nname = Fine\ndefinition = m\n[metadata]\ntype = quality\nquality_type = fine\n\n[values]\n\
                    layer_height = 0.1\nspeed_wall = =speed_print / 2\n    + 1\nadhesion_type = brim\n";
        let read = Instance::parse("q/m_fine.inst.cfg".into(), text).unwrap();
        assert_eq!((read.name.as_str(), read.id.as_str(), read.definition.as_str()), ("Fine", "m_fine", "m"));
        assert_eq!(read.about("quality_type"), "fine");
        assert_eq!(read.values["layer_height"].plain, Some(Value::Number(0.1)));
        assert_eq!(read.values["speed_wall"].formula.as_deref(), Some("speed_print / 2 + 1"));
        assert_eq!(read.values["adhesion_type"].place.to_string(), "q/m_fine.inst.cfg:12 [Fine]");
        let error = Instance::parse("q.inst.cfg".into(), "[values]\nwhat\n").unwrap_err();
        assert!(error.to_string().starts_with("q.inst.cfg:2 [values]: `what`"), "{error}");
    }

    #[test]
    fn texts_have_lines_and_stacks_have_containers() {
        let text = "[general]\r\nname = M\r\nid = M #2\r\n[values]\r\nscript = G28\r\n\t; home\r\n\t\r\n\tG1 X0\r\n\r\na = 1\r\n\
                    [containers]\r\n0 = M_user\r\n1 = m\r\n";
        let read = Instance::parse("M.global.cfg".into(), text).unwrap();
        assert_eq!(read.values["script"].plain, Some(Value::Text("G28\n; home\n\nG1 X0".into())));
        assert_eq!(read.values["a"].plain, Some(Value::Number(1.0)));
        assert_eq!((read.id.as_str(), read.containers), ("M #2", vec!["M_user".into(), "m".into()]));
        assert_eq!(id("user/creality_%232+x%zz.inst.cfg"), "creality_#2 x%zz");
    }

    #[test]
    fn materials_say_what_they_are_and_what_machines_need() {
        let text = "<?xml version=\"1.0\"?>\n<fdmmaterial xmlns:cura=\"c\"><metadata><name><brand>A &amp; B</brand>\
                    <material>PLA</material><color>Red</color></name></metadata><properties><diameter>1.75</diameter>\
                    </properties><settings>\n<setting key=\"print temperature\">205</setting>\
                    <cura:setting key=\"cool_min_speed\">7</cura:setting><machine><machine_identifier product=\"M\"/>\
                    <setting key=\"heated bed temperature\">55</setting><hotend id=\"x\"><setting key=\"print temperature\">\
                    9</setting></hotend></machine></settings></fdmmaterial>";
        let read = Instance::parse_material("a_pla.xml.fdm_material".into(), text).unwrap();
        assert_eq!(
            (read.name.as_str(), read.about("diameter"), read.id.as_str()),
            ("A & B PLA Red", "1.75", "a_pla")
        );
        assert_eq!(read.values["default_material_print_temperature"].plain, Some(Value::Number(205.0)));
        assert_eq!(read.values["cool_min_speed"].plain, Some(Value::Number(7.0)));
        let (names, values) = &read.of_machines[0];
        assert_eq!(names, &["M"]);
        assert_eq!(values.len(), 1);
        assert!(Instance::parse_material("a".into(), "<a><b></a>").is_err());
    }
}
