//! STL, binary and text, as users have it.
//!
//! Binary facets come through `stl_io`. Text has a reader of its own: the one of `stl_io` refuses files without a
//! name after `solid`, with leading blanks, upper case, a byte order mark, lone carriage returns or no
//! `endsolid`, stops in silence at the second solid, and is slower than this one.

use std::io::Cursor;
use std::path::Path;

use super::error::{MeshError, Place};
use super::weld::{Soup, Welder};

const HEADER: usize = 84;
const FACET: usize = 50;

/// Facets of a file with what had to be overlooked to read them.
pub(super) struct Reading {
    pub soup: Soup,
    pub format: &'static str,
    /// Facets in the file, before any was left out.
    pub facets: usize,
    pub notes: Vec<String>,
}

/// Reads either kind. The size decides: a binary file of n facets has 84 + 50 n bytes, whatever its header says.
pub(super) fn read(path: &Path, mut data: Vec<u8>) -> Result<Reading, MeshError> {
    let owned = || path.to_path_buf();
    if data.is_empty() {
        return Err(MeshError::EmptyFile { path: owned() });
    }
    let promised = data.get(80..HEADER).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]) as usize);
    if promised.is_some_and(|n| n.checked_mul(FACET).is_some_and(|bytes| bytes + HEADER == data.len())) {
        return read_binary(path, data, Vec::new());
    }
    let text = trimmed(&data);
    if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && is_text(text) {
        return read_text(path, &data);
    }
    let Some(promised) = promised.filter(|_| data.len() >= HEADER + FACET && is_facet(&data[HEADER..]))
    else {
        let found = if is_text(&data) { "text without `solid`" } else { "neither text nor facets" };
        let cut_short = promised.is_none() && !is_text(&data);
        let found = if cut_short { "shorter than the header of one" } else { found };
        return Err(MeshError::NotStl { path: owned(), found });
    };
    let whole = (data.len() - HEADER) / FACET;
    let unknown = promised == 0 || promised == u32::MAX as usize;
    if promised > whole && !unknown {
        let needed = HEADER as u64 + FACET as u64 * promised as u64;
        return Err(MeshError::Truncated { path: owned(), promised, needed, got: data.len() as u64, whole });
    }
    let rest = (data.len() - HEADER) % FACET;
    let note = if rest == 0 || unknown {
        data[80..HEADER].copy_from_slice(&(whole as u32).to_le_bytes());
        format!("the header promises {promised} facets, the file has {whole}: all were read")
    } else {
        format!("{} bytes after the last facet were ignored", data.len() - HEADER - promised * FACET)
    };
    read_binary(path, data, vec![note])
}

fn read_binary(path: &Path, mut data: Vec<u8>, notes: Vec<String>) -> Result<Reading, MeshError> {
    // A header that begins with "solid" would make `stl_io` take the file for text.
    data[..80].fill(0);
    let facets = (data.len() - HEADER) / FACET;
    let mut welder = Welder::with_capacity(facets);
    let mut cursor = Cursor::new(data.as_slice());
    let unreadable = |source| MeshError::Read { path: path.to_path_buf(), source };
    for (n, facet) in stl_io::create_stl_reader(&mut cursor).map_err(unreadable)?.enumerate() {
        let corners = facet.map_err(unreadable)?.vertices.map(|v| v.0);
        welder.push(corners).map_err(|value| bad_coordinate(path, Place::Facet(n + 1), value))?;
    }
    Ok(Reading { soup: welder.finish(), format: "binary STL", facets, notes })
}

fn bad_coordinate(path: &Path, place: Place, value: f32) -> MeshError {
    let path = path.to_path_buf();
    if value.is_finite() {
        MeshError::TooFar { path, place, value }
    } else {
        MeshError::NotFinite { path, place, value }
    }
}

/// Without byte order mark and leading blanks.
fn trimmed(data: &[u8]) -> &[u8] {
    data.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(data).trim_ascii_start()
}

/// Whether the first kilobyte is free of control characters; binary facets are full of zeros.
fn is_text(data: &[u8]) -> bool {
    data.iter().take(1024).all(|&b| b >= b' ' || b.is_ascii_whitespace())
}

/// Whether what follows a binary header can be a facet: a normal of at most unit length, corners within 10 m.
fn is_facet(data: &[u8]) -> bool {
    let numbers = data[..48].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b));
    numbers.enumerate().all(|(i, x)| if i < 3 { x.is_nan() || x.abs() < 1.01 } else { !(x.abs() > 1e4) })
}

/// Reads text word by word: only `solid`, `facet`, `vertex`, `endfacet` and `endsolid` matter, in any case.
fn read_text(path: &Path, data: &[u8]) -> Result<Reading, MeshError> {
    let mut words = Words { data: data.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(data), at: 0, line: 1 };
    let mut welder = Welder::with_capacity(data.len() / 250);
    let mut corners: Vec<[f32; 3]> = Vec::with_capacity(4);
    let (mut facets, mut solids, mut ends, mut polygons) = (0, 0, 0, 0);
    let mut inside = false;
    let syntax =
        |line, problem| MeshError::Syntax { path: path.to_path_buf(), place: Place::Line(line), problem };
    while let Some(word) = words.next() {
        let line = words.line;
        if word.eq_ignore_ascii_case(b"vertex") {
            if !inside {
                return Err(syntax(line, "a vertex outside of a facet".into()));
            }
            let mut corner = [0.0; 3];
            for coordinate in &mut corner {
                let Some(word) = words.next() else {
                    return Err(MeshError::EndsInFacet {
                        path: path.to_path_buf(),
                        place: Place::Line(line),
                    });
                };
                *coordinate = number(word).ok_or_else(|| {
                    syntax(line, format!("`{}` is not a number", String::from_utf8_lossy(word)))
                })?;
            }
            corners.push(corner);
        } else if word.eq_ignore_ascii_case(b"facet") {
            if inside {
                return Err(syntax(line, "a facet begins inside of another".into()));
            }
            inside = true;
            corners.clear();
        } else if word.eq_ignore_ascii_case(b"endfacet") {
            if corners.len() < 3 || !inside {
                return Err(syntax(line, format!("a facet has {} corners instead of 3", corners.len())));
            }
            inside = false;
            facets += 1;
            polygons += usize::from(corners.len() > 3);
            for pair in corners[1..].windows(2) {
                let bad = |value| bad_coordinate(path, Place::Line(line), value);
                welder.push([corners[0], pair[0], pair[1]]).map_err(bad)?;
            }
        } else if word.eq_ignore_ascii_case(b"solid") {
            solids += 1;
            words.skip_line();
        } else if word.eq_ignore_ascii_case(b"endsolid") {
            ends += 1;
            words.skip_line();
        }
    }
    if inside {
        return Err(MeshError::EndsInFacet { path: path.to_path_buf(), place: Place::Line(words.line) });
    }
    let mut notes = Vec::new();
    if solids > 1 {
        notes.push(format!("{solids} solids in the file were taken together"));
    }
    if ends < solids {
        notes.push("`endsolid` is missing: the file may have lost its end".into());
    }
    if polygons > 0 {
        notes.push(format!("{polygons} facets with more than 3 corners were split"));
    }
    Ok(Reading { soup: welder.finish(), format: "ASCII STL", facets, notes })
}

/// A number, with a decimal comma if need be.
fn number(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.replace(',', ".").parse().ok())
}

/// Blank-separated words with the line they stand on; lines end with LF, CR LF or CR.
struct Words<'a> {
    data: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        while self.data.get(self.at)?.is_ascii_whitespace() {
            self.line += usize::from(self.ends_line());
            self.at += 1;
        }
        let rest = &self.data[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        Some(&rest[..length])
    }

    fn skip_line(&mut self) {
        let rest = &self.data[self.at..];
        self.at += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
    }

    fn ends_line(&self) -> bool {
        match self.data[self.at] {
            b'\n' => true,
            b'\r' => self.data.get(self.at + 1) != Some(&b'\n'),
            _ => false,
        }
    }
}
