//! Writes 3MF packages (core specification 1.3) that every slicer opens.

use std::fmt::Write as _;
use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::surface::Mesh;

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
 <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
 <Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
 <Relationship Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;
const MODEL: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
 <metadata name="Application">Pathwright "#;

/// An object of a package.
pub(crate) struct PackageObject<'a> {
    pub name: &'a str,
    pub mesh: &'a Mesh,
    /// Whether it is not printed itself.
    pub is_support: bool,
}

/// An object at its position.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PackageItem {
    /// Index of the object.
    pub object: usize,
    /// Where the unit vectors and the origin go, millimetres.
    pub columns: [[f64; 3]; 4],
}

/// A package with objects at their positions and other parts, each with its name. Numbers read back to the same bits; the same
/// input gives the same bytes.
pub(crate) fn write_package(
    objects: &[PackageObject<'_>],
    items: &[PackageItem],
    parts: &[(String, &[u8])],
) -> zip::result::ZipResult<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let mut types = CONTENT_TYPES.to_owned();
    for (name, _) in parts {
        let name = escaped(name);
        types += &format!(" <Override PartName=\"/{name}\" ContentType=\"application/octet-stream\"/>\n");
    }
    types += "</Types>\n";
    let model = model(objects, items);
    let own = [
        ("[Content_Types].xml", types.as_bytes()),
        ("_rels/.rels", RELATIONS.as_bytes()),
        ("3D/3dmodel.model", model.as_bytes()),
    ];
    for (name, bytes) in own.into_iter().chain(parts.iter().map(|(name, bytes)| (name.as_str(), *bytes))) {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .large_file(bytes.len() as u64 >= u64::from(u32::MAX));
        zip.start_file(name, options)?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

fn model(objects: &[PackageObject<'_>], items: &[PackageItem]) -> String {
    let mut out = MODEL.to_owned() + env!("CARGO_PKG_VERSION") + "</metadata>\n <resources>\n";
    // Writing to a text does not fail.
    for (number, PackageObject { name, mesh, is_support }) in (1..).zip(objects) {
        let kind = if *is_support { "support" } else { "model" };
        let name = escaped(name);
        let _ = writeln!(out, "  <object id=\"{number}\" name=\"{name}\" type=\"{kind}\"><mesh><vertices>");
        for [x, y, z] in mesh.vertices().iter().map(|v| v.map(Number)) {
            let _ = writeln!(out, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        }
        out += "</vertices><triangles>\n";
        for [a, b, c] in mesh.triangles() {
            let _ = writeln!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
        }
        out += "</triangles></mesh></object>\n";
    }
    out += " </resources>\n <build>\n";
    for PackageItem { object, columns } in items {
        let numbers: Vec<String> = columns.as_flattened().iter().map(ToString::to_string).collect();
        let (id, transform) = (object + 1, numbers.join(" "));
        let _ = writeln!(out, "  <item objectid=\"{id}\" transform=\"{transform}\"/>");
    }
    out + " </build>\n</model>\n"
}

/// A coordinate in as few digits as read back to its bits: those of a file have 32.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let single = self.0 as f32;
        if f64::from(single) == self.0 { single.fmt(f) } else { self.0.fmt(f) }
    }
}

/// A text as XML.
fn escaped(text: &str) -> String {
    let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    quick_xml::escape::escape(text).into_owned()
}
