//! What PrusaSlicer and OrcaSlicer with its kin save with the objects of a project: extruders, settings, and what parts are for.

use std::collections::BTreeMap;
use std::io::BufRead;

use quick_xml::events::Event;
use quick_xml::reader::NsReader;

use super::xml::value;
use crate::mesh::effect::{SavedSettings, Words};
use crate::mesh::paint::Wish;

/// Where PrusaSlicer and OrcaSlicer with its kin keep it.
pub(super) const PARTS: [(&str, Words); 2] =
    [("Metadata/Slic3r_PE_model.config", Words::Prusa), ("Metadata/model_settings.config", Words::Orca)];

/// What is said of an object that is no setting.
const ABOUT: [&str; 14] = [
    "extruder",
    "face_count",
    "gcode_file",
    "locked",
    "matrix",
    "mesh_stat",
    "modifier",
    "name",
    "part_type",
    "plater_id",
    "plater_name",
    "text_info",
    "thumbnail_file",
    "volume_type",
];

/// What is saved of one object.
#[derive(Debug, Default)]
pub(super) struct SavedObject {
    own: SavedSettings,
    volumes: Vec<Volume>,
}

/// A part of an object.
#[derive(Debug, Default)]
pub(super) struct Volume {
    pub name: Option<String>,
    /// Its facets, first and last (PrusaSlicer).
    facets: Option<[usize; 2]>,
    /// The object that holds them (OrcaSlicer).
    object: Option<u32>,
    pub saved: SavedSettings,
    pub purpose: Purpose,
}

/// What a part is for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Purpose {
    /// To be printed.
    #[default]
    Print,
    /// To be cut off the others.
    Cut,
    /// To change settings of what is inside of it.
    Modify,
    /// To say where supports are wanted.
    Support(Wish),
    /// Not known.
    Other,
}

impl Purpose {
    /// PrusaSlicer's word, or OrcaSlicer's.
    fn of(word: &str) -> Self {
        match word {
            "ModelPart" | "normal_part" => Self::Print,
            "NegativeVolume" | "negative_part" => Self::Cut,
            "ParameterModifier" | "modifier_part" => Self::Modify,
            "SupportEnforcer" | "support_enforcer" => Self::Support(Wish::Enforced),
            "SupportBlocker" | "support_blocker" => Self::Support(Wish::Blocked),
            _ => Self::Other,
        }
    }
}

impl Volume {
    fn holds(&self, object: u32, facet: usize) -> bool {
        match self.facets {
            Some([first, last]) => (first..=last).contains(&facet),
            None => self.object == Some(object),
        }
    }
}

impl SavedObject {
    /// Its parts, in the order of the file.
    pub fn volumes(&self) -> &[Volume] {
        &self.volumes
    }

    /// The part that a facet of a mesh belongs to; `None`: to no part that is told of.
    pub fn volume(&self, object: u32, facet: usize) -> Option<usize> {
        self.volumes.iter().position(|volume| volume.holds(object, facet))
    }

    /// Whether a part that changes others is an object of this number.
    pub fn has_modifier(&self, object: u32) -> bool {
        let mut changing = self.volumes.iter().filter(|volume| volume.purpose != Purpose::Print);
        changing.any(|volume| volume.facets.is_none() && volume.object == Some(object))
    }

    /// The settings of the object.
    pub fn own(&self) -> &SavedSettings {
        &self.own
    }

    /// The extruder of a facet of a mesh; `None`: it is not printed.
    pub fn tool(&self, object: u32, facet: usize) -> Option<u32> {
        match self.volume(object, facet).map(|volume| &self.volumes[volume]) {
            Some(volume) => (volume.purpose == Purpose::Print).then(|| self.tool_of(volume)),
            None => Some(self.own.tool.unwrap_or(1)),
        }
    }

    fn tool_of(&self, volume: &Volume) -> u32 {
        volume.saved.tool.or(self.own.tool).unwrap_or(1)
    }

    /// The extruder that prints all of it, if one is named and no other is.
    pub fn only_tool(&self) -> Option<u32> {
        let is_named = self.own.tool.is_some() || self.printed().any(|volume| volume.saved.tool.is_some());
        match self.tools()[..] {
            [only] if is_named => Some(only),
            _ => None,
        }
    }

    fn printed(&self) -> impl Iterator<Item = &Volume> {
        self.volumes.iter().filter(|volume| volume.purpose == Purpose::Print)
    }

    /// Every extruder that prints some of it, in ascending order.
    pub fn tools(&self) -> Vec<u32> {
        let mut all: Vec<u32> = self.printed().map(|volume| self.tool_of(volume)).collect();
        if all.is_empty() {
            all.push(self.own.tool.unwrap_or(1));
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether parts that are printed have settings of their own.
    pub fn parts_differ(&self) -> bool {
        self.printed().any(|volume| !volume.saved.entries.is_empty())
    }

    /// Takes up what is said of the object, or of its last part.
    fn say(&mut self, of_volume: bool, words: Words, key: String, told: &str) {
        let volume = self.volumes.last_mut().filter(|_| of_volume);
        match (key.as_str(), volume) {
            // 0: that of the object.
            ("extruder", volume) => {
                let saved = volume.map_or(&mut self.own, |volume| &mut volume.saved);
                saved.tool = told.trim().parse().ok().filter(|tool| *tool > 0);
            }
            ("volume_type", Some(volume)) => volume.purpose = Purpose::of(told),
            ("modifier", Some(volume)) if told == "1" && volume.purpose == Purpose::Print => {
                volume.purpose = Purpose::Modify;
            }
            ("name", Some(volume)) => volume.name = Some(told.to_owned()).filter(|name| !name.is_empty()),
            (_, volume) if is_setting(&key) => {
                let saved = volume.map_or(&mut self.own, |volume| &mut volume.saved);
                saved.words = words;
                saved.entries.insert(key, told.to_owned());
            }
            _ => {}
        }
    }
}

/// Whether it is how something is printed, and not where it comes from.
fn is_setting(key: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !key.is_empty() && key.chars().all(is_letter) && !ABOUT.contains(&key) && !key.starts_with("source_")
}

/// What is saved of each object, by its number.
pub(super) fn read<R: BufRead>(mut reader: NsReader<R>, words: Words) -> BTreeMap<u32, SavedObject> {
    let mut buffer = Vec::new();
    let mut objects: BTreeMap<u32, SavedObject> = BTreeMap::new();
    let (mut object, mut in_volume) = (None, false);
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(tag) | Event::Empty(tag)) => {
                let number = |name: &str| value(&tag, name).and_then(|text| text.trim().parse::<u32>().ok());
                match tag.local_name().into_inner() {
                    "object" => (object, in_volume) = (number("id"), false),
                    "plate" | "assemble" => (object, in_volume) = (None, false),
                    "volume" | "part" => {
                        let Some(saved) = object.map(|id| objects.entry(id).or_default()) else { continue };
                        let facets = number("firstid").zip(number("lastid"));
                        let kind = value(&tag, "subtype");
                        saved.volumes.push(Volume {
                            facets: facets.map(|(first, last)| [first as usize, last as usize]),
                            object: number("id"),
                            purpose: kind.map_or_else(Purpose::default, |kind| Purpose::of(&kind)),
                            ..Volume::default()
                        });
                        in_volume = true;
                    }
                    "metadata" => {
                        let Some(saved) = object.map(|id| objects.entry(id).or_default()) else { continue };
                        let key = value(&tag, "key").unwrap_or_default();
                        let told = value(&tag, "value").unwrap_or_default();
                        let of_volume = in_volume && value(&tag, "type").is_none_or(|kind| kind == "volume");
                        saved.say(of_volume, words, key, &told);
                    }
                    _ => {}
                }
            }
            Ok(Event::End(tag)) => match tag.local_name().into_inner() {
                "volume" | "part" => in_volume = false,
                "object" => (object, in_volume) = (None, false),
                _ => {}
            },
            Ok(Event::Eof) | Err(_) => return objects,
            Ok(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(text: &str, words: Words) -> SavedObject {
        read(NsReader::from_reader(text.as_bytes()), words).into_values().next().unwrap_or_default()
    }

    #[test]
    fn prusaslicer_names_facets_and_orcaslicer_objects() {
        let prusa = first(
            "<config><object id=\"3\"><metadata type=\"object\" key=\"extruder\" value=\"2\"/>\
             <volume firstid=\"0\" lastid=\"11\"><metadata type=\"volume\" key=\"volume_type\" value=\"ModelPart\"/>\
             <metadata type=\"volume\" key=\"extruder\" value=\"0\"/></volume>\
             <volume firstid=\"12\" lastid=\"23\"><metadata type=\"volume\" key=\"extruder\" value=\"4\"/></volume>\
             <volume firstid=\"24\" lastid=\"35\"><metadata type=\"volume\" key=\"volume_type\" value=\"NegativeVolume\"/>\
             </volume></object></config>",
            Words::Prusa,
        );
        assert_eq!([0, 11, 12, 24].map(|facet| prusa.tool(9, facet)), [Some(2), Some(2), Some(4), None]);
        assert_eq!((prusa.tools(), prusa.only_tool()), (vec![2, 4], None));
        assert_eq!(prusa.volumes()[2].purpose, Purpose::Cut);
        let orca = first(
            "<config><object id=\"3\"><metadata key=\"extruder\" value=\"1\"/><part id=\"1\" subtype=\"normal_part\">\
             <metadata key=\"extruder\" value=\"3\"/></part><part id=\"2\" subtype=\"modifier_part\"></part></object></config>",
            Words::Orca,
        );
        assert_eq!([1, 2, 7].map(|object| orca.tool(object, 0)), [Some(3), None, Some(1)]);
        assert_eq!((orca.tools(), orca.only_tool()), (vec![3], Some(3)));
        assert_eq!(orca.volumes()[1].purpose, Purpose::Modify);
    }

    #[test]
    fn settings_of_objects_and_parts_are_told_and_what_is_none_is_not() {
        let orca = first(
            "<config><object id=\"2\"><metadata key=\"name\" value=\"A\"/><metadata key=\"extruder\" value=\"1\"/>\
             <metadata key=\"wall_loops\" value=\"4\"/><part id=\"1\"><metadata key=\"source_file\" value=\"x\"/>\
             <metadata key=\"name\" value=\"B\"/><metadata key=\"layer_height\" value=\"0.1\"/></part></object>\
             <plate><metadata key=\"other\" value=\"1\"/></plate></config>",
            Words::Orca,
        );
        let entry = |key: &str, value: &str| BTreeMap::from([(key.to_owned(), value.to_owned())]);
        assert_eq!(orca.own().entries, entry("wall_loops", "4"));
        assert_eq!(orca.volumes()[0].saved.entries, entry("layer_height", "0.1"));
        assert_eq!(orca.volumes()[0].name.as_deref(), Some("B"));
        assert!(orca.parts_differ());
    }

    #[test]
    fn a_file_that_names_no_extruder_asks_for_none() {
        let plain = "<config><object id=\"1\"><volume firstid=\"0\" lastid=\"3\"/></object></config>";
        assert_eq!(first(plain, Words::Prusa).only_tool(), None);
        assert!(read(NsReader::from_reader("<config><obj".as_bytes()), Words::Orca).is_empty());
    }
}
