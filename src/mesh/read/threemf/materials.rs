//! Materials and colours: base materials of the core specification (1.3, chapter 5), and colour groups of the materials extension
//! (1.2, chapter 3).

use quick_xml::events::BytesStart;

use super::xml::value;

/// The namespace of colour groups.
pub(super) const MATERIALS: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

/// A list of materials: a resource of a part.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub id: u32,
    /// In words.
    pub names: Vec<String>,
}

/// Where a material is listed: the group, and the place in it.
pub(super) type Listed = (u32, u32);

/// Takes up what a tag says of materials, after those before it.
pub(super) fn read(tag: &BytesStart<'_>, groups: &mut Vec<Group>) {
    let text = |key: &str| value(tag, key).map(|text| text.trim().to_owned()).filter(|text| !text.is_empty());
    match tag.local_name().into_inner() {
        "basematerials" | "colorgroup" => {
            let id = text("id").and_then(|id| id.parse().ok());
            groups.extend(id.map(|id| Group { id, names: Vec::new() }));
        }
        "base" => {
            let (name, color) = (text("name"), text("displaycolor").map(|color| opaque(&color)));
            let name = match (name, color) {
                (Some(name), Some(color)) => format!("{name} ({color})"),
                (name, color) => name.or(color).unwrap_or_else(|| "without a name".into()),
            };
            groups.iter_mut().last().into_iter().for_each(|group| group.names.push(name.clone()));
        }
        "color" => {
            let name = text("color").map_or_else(|| "without a color".into(), |color| opaque(&color));
            groups.iter_mut().last().into_iter().for_each(|group| group.names.push(name.clone()));
        }
        _ => {}
    }
}

/// A colour without its opacity: `#RRGGBB`.
fn opaque(color: &str) -> String {
    color.get(..7).unwrap_or(color).to_uppercase()
}

/// What the attributes of a triangle say of its material.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MadeOf {
    pub group: Option<u32>,
    /// Of its corners; the first holds for those without.
    pub places: [Option<u32>; 3],
}

impl MadeOf {
    /// The materials of its corners, where those of an object are the usual ones.
    pub fn corners(self, usual: Option<Listed>) -> Option<[Listed; 3]> {
        let of = |place: Option<u32>| listed(self.group, place.or(self.places[0]), usual);
        let [a, b, c] = self.places.map(of);
        Some([a?, b?, c?])
    }
}

/// The material that attributes name; `pid` without a place means the first.
pub(super) fn listed(pid: Option<u32>, place: Option<u32>, usual: Option<Listed>) -> Option<Listed> {
    match (pid, place) {
        (None, None) => usual,
        (None, Some(place)) => usual.map(|(pid, _)| (pid, place)),
        (Some(pid), place) => Some((pid, place.unwrap_or(0))),
    }
}
