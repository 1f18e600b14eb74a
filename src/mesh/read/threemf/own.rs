//! Settings that other slicers save with the objects of a project: told, as models hold shapes alone.

use std::collections::BTreeSet;
use std::io::BufRead;

use quick_xml::events::Event;
use quick_xml::reader::NsReader;

use super::xml::value;

/// Where PrusaSlicer and OrcaSlicer with its kin keep them.
pub(super) const PARTS: [&str; 2] = ["Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"];

/// What a project says of an object that is no setting.
const ABOUT: [&str; 14] = [
    "extruder",
    "face_count",
    "gcode_file",
    "locked",
    "matrix",
    "mesh_stat",
    "name",
    "part_type",
    "plater_id",
    "plater_name",
    "subtype",
    "text_info",
    "thumbnail_file",
    "volume_type",
];

/// How many settings a note names.
const NAMED: usize = 5;

/// What is to be known of the settings of objects in such a part; `None`: there are none, or it is no XML.
pub(super) fn note<R: BufRead>(mut reader: NsReader<R>) -> Option<String> {
    let mut buffer = Vec::new();
    let mut keys: BTreeSet<String> = BTreeSet::new();
    let mut is_own = false;
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(tag) | Event::Empty(tag)) => match tag.local_name().into_inner() {
                "object" | "part" | "volume" => is_own = true,
                "plate" | "assemble" => is_own = false,
                "metadata" if is_own => {
                    let key = value(&tag, "key").unwrap_or_default();
                    let is_setting = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                    // Where a part comes from, not how it is printed.
                    let is_about = ABOUT.contains(&key.as_str()) || key.starts_with("source_");
                    if !key.is_empty() && key.chars().all(is_setting) && !is_about {
                        keys.insert(key);
                    }
                }
                _ => {}
            },
            Ok(Event::Eof) | Err(_) => break,
            Ok(_) => {}
        }
    }
    let named: Vec<&str> = keys.iter().take(NAMED).map(String::as_str).collect();
    let more = keys.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    (!keys.is_empty()).then(|| {
        format!(
            "settings of single objects are not taken over ({}{more}); give them with --object",
            named.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_objects_are_told_and_what_is_none_is_not() {
        let orca = "<config><object id=\"2\"><metadata key=\"name\" value=\"A\"/><metadata key=\"extruder\" value=\"1\"/>\
                    <metadata key=\"wall_loops\" value=\"4\"/><part id=\"1\"><metadata key=\"source_file\" value=\"x\"/>\
                    <metadata key=\"layer_height\" value=\"0.1\"/></part></object><plate><metadata key=\"other\" value=\"1\"/>\
                    </plate></config>";
        let said = note(NsReader::from_reader(orca.as_bytes())).unwrap();
        assert!(said.contains("(layer_height, wall_loops)"), "{said}");
        let plain =
            "<config><object id=\"1\"><metadata type=\"object\" key=\"name\" value=\"A\"/></object></config>";
        assert_eq!(note(NsReader::from_reader(plain.as_bytes())), None);
        assert_eq!(note(NsReader::from_reader("<config><obj".as_bytes())), None);
    }
}
