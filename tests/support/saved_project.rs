//! 3MF files with what other slicers save with the parts of an object.

use std::path::PathBuf;

use super::mesh_shapes::{Facets, model_xml, package, painted_xml};

/// Whose way of saving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Saved {
    Prusa,
    Orca,
}

/// A part of an object: facets, what it is for (in PrusaSlicer's words), and keys with values.
pub struct Part<'a> {
    pub facets: Facets,
    pub purpose: &'a str,
    pub keys: &'a [(&'a str, &'a str)],
}

/// A part.
pub fn part<'a>(facets: Facets, purpose: &'a str, keys: &'a [(&'a str, &'a str)]) -> Part<'a> {
    Part { facets, purpose, keys }
}

fn entries(kind: &str, keys: &[(&str, &str)]) -> String {
    let entry =
        |(key, value): &(&str, &str)| format!("<metadata type=\"{kind}\" key=\"{key}\" value=\"{value}\"/>");
    keys.iter().map(entry).collect()
}

fn orca_word(purpose: &str) -> &str {
    match purpose {
        "NegativeVolume" => "negative_part",
        "ParameterModifier" => "modifier_part",
        "SupportEnforcer" => "support_enforcer",
        "SupportBlocker" => "support_blocker",
        _ => "normal_part",
    }
}

/// One object of these parts, and its own keys with values, in a file.
pub fn project(
    folder: &tempfile::TempDir,
    saved: Saved,
    own: &[(&str, &str)],
    parts: &[Part<'_>],
) -> PathBuf {
    let path = folder.path().join("parts.3mf");
    let bytes = match saved {
        Saved::Prusa => {
            let all: Facets = parts.iter().flat_map(|part| part.facets.iter().copied()).collect();
            let mut first = 0;
            let volume = |part: &Part<'_>| {
                let last = first + part.facets.len();
                let text = format!(
                    "<volume firstid=\"{first}\" lastid=\"{}\"><metadata type=\"volume\" key=\"volume_type\" value=\"{}\"/>{}\
                     </volume>",
                    last - 1,
                    part.purpose,
                    entries("volume", part.keys)
                );
                first = last;
                text
            };
            let volumes: String = parts.iter().map(volume).collect();
            let config =
                format!("<config><object id=\"1\">{}{volumes}</object></config>", entries("object", own));
            let object = format!("<object id=\"1\">{}</object>", painted_xml(&all, |_| String::new()));
            let model = model_xml("", &object, "<item objectid=\"1\"/>");
            package(&[("3D/3dmodel.model", &model), ("Metadata/Slic3r_PE_model.config", &config)])
        }
        Saved::Orca => {
            let object = |(id, part): (usize, &Part<'_>)| {
                let kind = if part.purpose == "ModelPart" { "model" } else { "other" };
                let mesh = painted_xml(&part.facets, |_| String::new());
                format!("<object id=\"{id}\" type=\"{kind}\">{mesh}</object>")
            };
            let bodies: String = (1..).zip(parts).map(object).collect();
            let components: String =
                (1..=parts.len()).map(|id| format!("<component objectid=\"{id}\"/>")).collect();
            let whole = format!("{bodies}<object id=\"99\"><components>{components}</components></object>");
            let volume = |(id, part): (usize, &Part<'_>)| {
                let (word, keys) = (orca_word(part.purpose), entries("", part.keys));
                format!("<part id=\"{id}\" subtype=\"{word}\">{}</part>", keys.replace("type=\"\" ", ""))
            };
            let volumes: String = (1..).zip(parts).map(volume).collect();
            let own = entries("", own).replace("type=\"\" ", "");
            let config = format!("<config><object id=\"99\">{own}{volumes}</object></config>");
            let model = model_xml("", &whole, "<item objectid=\"99\"/>");
            package(&[("3D/3dmodel.model", &model), ("Metadata/model_settings.config", &config)])
        }
    };
    std::fs::write(&path, bytes).expect("written");
    path
}
