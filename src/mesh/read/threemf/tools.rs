//! Which extruder prints what of an object, as PrusaSlicer and OrcaSlicer with its kin save it.

use std::collections::BTreeMap;
use std::io::BufRead;

use quick_xml::events::Event;
use quick_xml::reader::NsReader;

use super::xml::value;

/// What is saved of the extruders of one object.
#[derive(Debug, Default)]
pub(super) struct ObjectTools {
    /// Its extruder, from 1.
    pub own: Option<u32>,
    volumes: Vec<Volume>,
}

/// A part of an object.
#[derive(Debug, Default)]
struct Volume {
    /// Its facets, first and last (PrusaSlicer).
    facets: Option<[usize; 2]>,
    /// The object that holds them (OrcaSlicer).
    object: Option<u32>,
    tool: Option<u32>,
    /// Whether it is printed: it may change settings of others, or be cut off them.
    is_printed: bool,
}

impl ObjectTools {
    /// The extruder of a facet of a mesh; `None`: it is not printed.
    pub fn of(&self, object: u32, facet: usize) -> Option<u32> {
        let holds = |volume: &&Volume| match volume.facets {
            Some([first, last]) => (first..=last).contains(&facet),
            None => volume.object == Some(object),
        };
        let usual = self.own.unwrap_or(1);
        match self.volumes.iter().find(holds) {
            Some(volume) => volume.is_printed.then(|| volume.tool.unwrap_or(usual)),
            None => Some(usual),
        }
    }

    /// The extruder that prints all of it, if one is named and no other is.
    pub fn only(&self) -> Option<u32> {
        let is_named = self.own.is_some() || self.volumes.iter().any(|volume| volume.tool.is_some());
        match self.all()[..] {
            [only] if is_named => Some(only),
            _ => None,
        }
    }

    /// How many of its parts are not printed.
    pub fn unprinted(&self) -> usize {
        self.volumes.iter().filter(|volume| !volume.is_printed).count()
    }

    /// Every extruder that prints some of it, in ascending order.
    pub fn all(&self) -> Vec<u32> {
        let usual = self.own.unwrap_or(1);
        let printed = self.volumes.iter().filter(|volume| volume.is_printed);
        let mut all: Vec<u32> = printed.map(|volume| volume.tool.unwrap_or(usual)).collect();
        if all.is_empty() {
            all.push(usual);
        }
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// The extruders of each object, by its number.
pub(super) fn read<R: BufRead>(mut reader: NsReader<R>) -> BTreeMap<u32, ObjectTools> {
    let mut buffer = Vec::new();
    let mut objects: BTreeMap<u32, ObjectTools> = BTreeMap::new();
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
                        let Some(tools) = object.map(|id| objects.entry(id).or_default()) else { continue };
                        let facets = number("firstid").zip(number("lastid"));
                        let kind = value(&tag, "subtype");
                        tools.volumes.push(Volume {
                            facets: facets.map(|(first, last)| [first as usize, last as usize]),
                            object: number("id"),
                            tool: None,
                            is_printed: kind.is_none_or(|kind| kind == "normal_part"),
                        });
                        in_volume = true;
                    }
                    "metadata" => {
                        let Some(tools) = object.map(|id| objects.entry(id).or_default()) else { continue };
                        let key = value(&tag, "key").unwrap_or_default();
                        let told = value(&tag, "value").unwrap_or_default();
                        // 0: that of the object.
                        let tool = told.trim().parse::<u32>().ok().filter(|tool| *tool > 0);
                        let of_volume = in_volume && value(&tag, "type").is_none_or(|kind| kind == "volume");
                        match (key.as_str(), tools.volumes.last_mut().filter(|_| of_volume)) {
                            ("extruder", Some(volume)) => volume.tool = tool,
                            ("extruder", None) => tools.own = tool,
                            ("volume_type", Some(volume)) => volume.is_printed = told == "ModelPart",
                            ("modifier", Some(volume)) => volume.is_printed &= told != "1",
                            _ => {}
                        }
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

    fn first(text: &str) -> ObjectTools {
        read(NsReader::from_reader(text.as_bytes())).into_values().next().unwrap_or_default()
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
        );
        assert_eq!([0, 11, 12, 24].map(|facet| prusa.of(9, facet)), [Some(2), Some(2), Some(4), None]);
        assert_eq!((prusa.all(), prusa.only(), prusa.unprinted()), (vec![2, 4], None, 1));
        let orca = first(
            "<config><object id=\"3\"><metadata key=\"extruder\" value=\"1\"/><part id=\"1\" subtype=\"normal_part\">\
             <metadata key=\"extruder\" value=\"3\"/></part><part id=\"2\" subtype=\"modifier_part\"></part></object></config>",
        );
        assert_eq!([1, 2, 7].map(|object| orca.of(object, 0)), [Some(3), None, Some(1)]);
        assert_eq!((orca.all(), orca.only()), (vec![3], Some(3)));
    }

    #[test]
    fn a_file_that_names_no_extruder_asks_for_none() {
        assert_eq!(
            first("<config><object id=\"1\"><volume firstid=\"0\" lastid=\"3\"/></object></config>").only(),
            None
        );
        assert!(read(NsReader::from_reader("<config><obj".as_bytes())).is_empty());
    }
}
