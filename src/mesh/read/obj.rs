//! Wavefront OBJ: vertices and faces. Texture, normals, colours and materials mean nothing to a print.
//!
//! The reader is our own, on the words of the STL reader: `tobj` says neither which line is wrong nor which index,
//! refuses a file for a texture index or a comment that is not UTF-8, and holds all faces twice.

use std::path::Path;

use super::format::{Contents, Format, bad_coordinate, has_extension, is_text};
use super::polygon;
use super::words::{Words, number};
use crate::mesh::error::{Location, MeshError};
use crate::mesh::weld::Welder;

pub(super) struct Obj;

impl Format for Obj {
    /// By name, as no word has to stand in an OBJ file; or by a vertex on the first line that is no comment.
    fn recognises(&self, path: &Path, data: &[u8]) -> bool {
        let mut lines = data.split(|b| matches!(b, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
        let first = lines.find(|line| !line.is_empty() && line[0] != b'#');
        is_text(data) && (has_extension(path, "obj") || first.is_some_and(|line| line.starts_with(b"v ")))
    }

    /// All objects and groups of the file together, as they are parts of one model.
    fn read(&self, path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
        let syntax = |line, problem| MeshError::Syntax {
            path: path.to_path_buf(),
            location: Location::Line(line),
            problem,
        };
        let mut words = Words::new(data);
        let mut vertices: Vec<[f32; 3]> = Vec::new();
        let mut welder = Welder::with_capacity(data.len() / 40);
        let (mut facets, mut polygons, mut objects) = (0, 0, 0);
        let mut corners: Vec<[f32; 3]> = Vec::with_capacity(4);
        let mut split = Vec::with_capacity(2);
        while let Some(word) = words.next() {
            let line = words.line;
            match word {
                b"v" => {
                    let mut vertex = [0.0; 3];
                    for coordinate in &mut vertex {
                        let word = words
                            .next_on_line()
                            .ok_or_else(|| syntax(line, "a vertex has fewer than 3 coordinates".into()))?;
                        *coordinate = number(word).ok_or_else(|| {
                            syntax(line, format!("`{}` is not a number", String::from_utf8_lossy(word)))
                        })?;
                    }
                    vertices.push(vertex);
                }
                b"f" => {
                    corners.clear();
                    while let Some(word) = words.next_on_joined_lines() {
                        let corner = vertex(word, &vertices).map_err(|problem| syntax(line, problem))?;
                        corners.push(corner);
                    }
                    if corners.len() < 3 {
                        return Err(syntax(
                            line,
                            format!("a face has {} corners instead of 3", corners.len()),
                        ));
                    }
                    facets += 1;
                    polygons += usize::from(corners.len() > 3);
                    polygon::split(&corners, &mut split);
                    for facet in &split {
                        let bad = |value| {
                            bad_coordinate(path, Location::Line(line), value, vertices.iter().copied())
                        };
                        welder.push(facet.map(|corner| corners[corner as usize])).map_err(bad)?;
                    }
                }
                b"o" => objects += 1,
                _ => {}
            }
            words.skip_line();
        }
        let mut notes = Vec::new();
        if objects > 1 {
            notes.push(format!("{objects} objects in the file were taken together"));
        }
        if polygons > 0 {
            notes.push(polygon::note(polygons, "face"));
        }
        Ok(Contents::single(welder.finish(), "OBJ", facets, notes))
    }
}

/// The vertex that a corner such as `7`, `7/1/3` or `-1` names: counted from 1, or from the last one back.
fn vertex(corner: &[u8], vertices: &[[f32; 3]]) -> Result<[f32; 3], String> {
    let index = corner.split(|b| *b == b'/').next().unwrap_or_default();
    let shown = || String::from_utf8_lossy(index);
    let parsed = std::str::from_utf8(index).ok().and_then(|text| text.parse::<i64>().ok());
    let number = parsed.ok_or_else(|| format!("`{}` is not the number of a vertex", shown()))?;
    let index = if number > 0 { number - 1 } else { (vertices.len() as i64).saturating_add(number) };
    let found = usize::try_from(index).ok().and_then(|index| vertices.get(index));
    found
        .copied()
        .ok_or_else(|| format!("a face names vertex {number}, and {} were given before it", vertices.len()))
}
