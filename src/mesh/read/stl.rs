//! STL, binary and text, as users have it.
//!
//! Binary facets come through `stl_io`. Text has a reader of its own: the one of `stl_io` refuses files without a
//! name after `solid`, with leading blanks, upper case, a byte order mark, lone carriage returns or no
//! `endsolid`, stops in silence at the second solid, and is slower than this one.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use super::format::{Contents, Format, bad_coordinate, is_text, trimmed};
use super::polygon;
use super::words::{Words, number};
use crate::mesh::error::{Location, MeshError};
use crate::mesh::weld::{FARTHEST, Soup, Welder};

const HEADER: usize = 84;
const FACET: usize = 50;

/// STL: any file of no other format.
pub(super) struct Stl;

impl Format for Stl {
    fn recognises(&self, _path: &Path, _data: &[u8]) -> bool {
        true
    }

    fn read(&self, path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
        read(path, data)
    }
}

/// Reads either kind. The size decides: a binary file of n facets has 84 + 50 n bytes, whatever its header says.
fn read(path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
    let owned = || path.to_path_buf();
    let promised = data.get(80..HEADER).map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]) as usize);
    if promised.is_some_and(|n| n.checked_mul(FACET).is_some_and(|bytes| bytes + HEADER == data.len())) {
        return read_binary(path, data, (data.len() - HEADER) / FACET, Vec::new());
    }
    let text = trimmed(data);
    if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && is_text(text) {
        return read_text(path, data);
    }
    let Some(promised) = promised.filter(|_| data.len() >= HEADER + FACET && is_facet(&data[HEADER..]))
    else {
        let found = if is_text(data) { "text without `solid`" } else { "neither text nor facets" };
        let cut_short = promised.is_none() && !is_text(data);
        let found = if cut_short { "shorter than the header of one" } else { found };
        return Err(MeshError::NotStl { path: owned(), found });
    };
    let whole = (data.len() - HEADER) / FACET;
    let unknown = promised == 0 || promised == u32::MAX as usize;
    if promised > whole && !unknown {
        let needed = HEADER as u64 + FACET as u64 * promised as u64;
        return Err(MeshError::Truncated { path: owned(), promised, needed, got: data.len() as u64, whole });
    }
    let are_facets = |from: usize| data[HEADER + from * FACET..].chunks_exact(FACET).all(is_facet);
    let rest = (data.len() - HEADER) % FACET;
    let (facets, note) = if unknown || rest == 0 && are_facets(promised) {
        (whole, format!("the header promises {promised} facets, the file has {whole}: all were read"))
    } else {
        let extra = data.len() - HEADER - promised * FACET;
        (
            promised,
            format!("the header promises {promised} facets: {extra} bytes after the last were ignored"),
        )
    };
    read_binary(path, data, facets, vec![note]).map_err(|error| match error {
        // Where the count is wrong, what is read as a facet may be none.
        MeshError::Damaged { path, location, .. } if !unknown => {
            let needed = HEADER as u64 + FACET as u64 * promised as u64;
            MeshError::Count { path, promised, needed, got: data.len() as u64, location }
        }
        error => error,
    })
}

/// Facets from which reading by two threads pays.
const PARALLEL: usize = 20_000;

/// Facets of a large file that a thread has in memory at once: .1 MB.
const BLOCK: usize = 1 << 11;

/// As reports call it.
const FORMAT: &str = "binary STL";

fn read_binary(path: &Path, data: &[u8], facets: usize, notes: Vec<String>) -> Result<Contents, MeshError> {
    let body = &data[HEADER..HEADER + facets * FACET];
    let part = |part: Range<usize>, welder: &mut Welder| {
        weld(path, &body[part.start * FACET..part.end * FACET], part.start, welder)
    };
    Ok(Contents::single(welded(facets, part)?, FORMAT, facets, notes))
}

/// Reads a large binary file of the size that its header promises, without having all of it in memory. `None` of any other file, and
/// of one in which there is something to tell of; `is_stl`: whether one that begins so is of no other format.
pub(super) fn read_large(path: &Path, is_stl: impl Fn(&[u8]) -> bool) -> Option<Contents> {
    let mut header = [0; HEADER];
    let mut file = File::open(path).ok()?;
    let length = file.metadata().ok()?.len();
    file.read_exact(&mut header).ok()?;
    let promised = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let is_whole = length == HEADER as u64 + FACET as u64 * u64::from(promised);
    let facets = promised as usize;
    if facets < PARALLEL || !is_whole || !is_stl(&header) {
        return None;
    }
    let part = |part: Range<usize>, welder: &mut Welder| weld_file(path, part, welder);
    Some(Contents::single(welded(facets, part).ok()?, FORMAT, facets, Vec::new()))
}

/// Welds some facets of a file, block by block.
fn weld_file(path: &Path, part: Range<usize>, welder: &mut Welder) -> Result<(), MeshError> {
    let unreadable = |source| MeshError::Read { path: path.to_path_buf(), source };
    let mut file = File::open(path).map_err(unreadable)?;
    file.seek(SeekFrom::Start((HEADER + part.start * FACET) as u64)).map_err(unreadable)?;
    let mut bytes = vec![0; FACET * BLOCK.min(part.len())];
    for first in part.clone().step_by(BLOCK) {
        let block = &mut bytes[..FACET * BLOCK.min(part.end - first)];
        file.read_exact(block).map_err(unreadable)?;
        weld(path, block, first, welder)?;
    }
    Ok(())
}

/// Welds facets with a function that adds some of them, on two threads if there are many: halves by themselves and then together, with
/// the same vertices in the same order as in one go.
fn welded(
    facets: usize,
    part: impl Fn(Range<usize>, &mut Welder) -> Result<(), MeshError> + Sync,
) -> Result<Soup, MeshError> {
    let mut welder = Welder::with_capacity(facets);
    if facets < PARALLEL {
        part(0..facets, &mut welder)?;
    } else {
        let half = facets / 2;
        let later = || {
            let mut welder = Welder::with_capacity(facets - half);
            part(half..facets, &mut welder).map(|()| welder.finish())
        };
        let (first, later) = crate::parallel::join(|| part(0..half, &mut welder), later);
        first?;
        welder.append(later?);
    }
    Ok(welder.finish())
}

/// Welds the facets of a part of the file, the first of which is number `offset + 1`.
fn weld(path: &Path, body: &[u8], offset: usize, welder: &mut Welder) -> Result<(), MeshError> {
    let mut header = [0; HEADER];
    header[80..].copy_from_slice(&((body.len() / FACET) as u32).to_le_bytes());
    let mut part = Part { header, body, at: 0 };
    let unreadable = |source| MeshError::Read { path: path.to_path_buf(), source };
    for (n, facet) in stl_io::create_stl_reader(&mut part).map_err(unreadable)?.enumerate() {
        let corners = facet.map_err(unreadable)?.vertices.map(|v| v.0);
        let bad = |value| bad_coordinate(path, Location::Facet(offset + n + 1), value, corners_of(body));
        welder.push(corners).map_err(bad)?;
    }
    Ok(())
}

/// The corners of binary facets.
fn corners_of(body: &[u8]) -> impl Iterator<Item = [f32; 3]> {
    body.as_chunks::<FACET>().0.iter().flat_map(|facet| {
        let numbers = facet[12..48].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b));
        let numbers: Vec<f32> = numbers.collect();
        [[0, 1, 2], [3, 4, 5], [6, 7, 8]].map(|corner| corner.map(|i| numbers[i]))
    })
}

/// A part of a binary file with a header of its own, which never begins with "solid": `stl_io` would take it for text.
struct Part<'a> {
    header: [u8; HEADER],
    body: &'a [u8],
    at: usize,
}

impl Read for Part<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let rest = match self.at.checked_sub(HEADER) {
            None => &self.header[self.at..],
            Some(at) => self.body.get(at..).unwrap_or_default(),
        };
        let count = rest.len().min(into.len());
        into[..count].copy_from_slice(&rest[..count]);
        self.at += count;
        Ok(count)
    }
}

impl Seek for Part<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (base, by) = match to {
            SeekFrom::Start(at) => (at, 0),
            SeekFrom::Current(by) => (self.at as u64, by),
            SeekFrom::End(by) => ((HEADER + self.body.len()) as u64, by),
        };
        let at = base.checked_add_signed(by).ok_or(io::ErrorKind::InvalidInput)?;
        self.at = at as usize;
        Ok(at)
    }
}

/// Whether the bytes after a binary header can be a facet: a normal of at most unit length, corners that can be
/// meant.
fn is_facet(data: &[u8]) -> bool {
    let numbers = data[..48].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b));
    numbers.enumerate().all(|(i, x)| x.is_nan() || x.abs() <= if i < 3 { 1.01 } else { FARTHEST })
}

/// The corners in a text, as far as they can be read.
fn vertices(data: &[u8]) -> impl Iterator<Item = [f32; 3]> {
    let mut words = Words::new(data);
    std::iter::from_fn(move || {
        while !words.next()?.eq_ignore_ascii_case(b"vertex") {}
        Some([(); 3].map(|()| words.next().and_then(number).unwrap_or(f32::NAN)))
    })
}

/// Reads text word by word: only `solid`, `facet`, `vertex`, `endfacet` and `endsolid` matter, in any case.
fn read_text(path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
    let mut words = Words::new(data);
    let mut welder = Welder::with_capacity(data.len() / 250);
    let mut corners: Vec<[f32; 3]> = Vec::with_capacity(4);
    let mut split = Vec::with_capacity(2);
    let (mut facets, mut solids, mut ends, mut polygons) = (0, 0, 0, 0);
    let mut inside = false;
    let syntax = |line, problem| MeshError::Syntax {
        path: path.to_path_buf(),
        location: Location::Line(line),
        problem,
    };
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
                        location: Location::Line(line),
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
            polygon::split(&corners, &mut split);
            for facet in &split {
                let bad = |value| bad_coordinate(path, Location::Line(line), value, vertices(data));
                welder.push(facet.map(|corner| corners[corner as usize])).map_err(bad)?;
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
        return Err(MeshError::EndsInFacet {
            path: path.to_path_buf(),
            location: Location::Line(words.line),
        });
    }
    let mut notes = Vec::new();
    if solids > 1 {
        notes.push(format!("{solids} solids in the file were taken together"));
    }
    if ends < solids {
        notes.push("`endsolid` is missing: the file may have lost its end".into());
    }
    if polygons > 0 {
        notes.push(polygon::note(polygons, "facet"));
    }
    Ok(Contents::single(welder.finish(), "ASCII STL", facets, notes))
}
