//! The same mesh as OBJ and as 3MF: vertices in the order of their first facet, facets as they come.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Facets over shared vertices.
pub struct Mesh {
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// Facets whose equal corners are shared.
    pub fn of(facets: &[stl_io::Triangle]) -> Self {
        let mut mesh = Self { vertices: Vec::new(), triangles: Vec::new() };
        for facet in facets {
            let corners = facet.vertices.map(|corner| corner.0);
            let triangle = corners.map(|corner| match mesh.vertices.iter().position(|v| *v == corner) {
                Some(known) => known,
                None => {
                    mesh.vertices.push(corner);
                    mesh.vertices.len() - 1
                }
            });
            mesh.triangles.push(triangle);
        }
        mesh
    }

    pub fn obj(&self) -> String {
        let mut text = String::new();
        for [x, y, z] in &self.vertices {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| v + 1);
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        text
    }

    /// One object, used once.
    pub fn threemf(&self) -> std::io::Result<Vec<u8>> {
        const TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
            <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
            <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
            <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
        const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
            <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
            <Relationship Target=\"/3D/3dmodel.model\" Id=\"model\" \
            Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
        let mut model = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" \
             xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n\
             <object id=\"1\" type=\"model\"><mesh>\n<vertices>\n",
        );
        for [x, y, z] in &self.vertices {
            let _ = writeln!(model, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        }
        model.push_str("</vertices>\n<triangles>\n");
        for [a, b, c] in &self.triangles {
            let _ = writeln!(model, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
        }
        model.push_str(
            "</triangles>\n</mesh></object>\n</resources>\n<build><item objectid=\"1\"/></build>\n</model>\n",
        );
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in
            [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS), ("3D/3dmodel.model", &model)]
        {
            zip.start_file(name, SimpleFileOptions::default())?;
            zip.write_all(text.as_bytes())?;
        }
        Ok(zip.finish()?.into_inner())
    }
}
