//! One model part of a 3MF package: objects, components and build items.

use std::collections::BTreeMap;
use std::io::BufRead;

use quick_xml::events::{BytesStart, Event};
use quick_xml::name::{Namespace, ResolveResult};
use quick_xml::reader::NsReader;

use super::affine::Affine;
use super::lattice::{self, BALLS, BEAMS, Lattice};
use super::materials::{self, Group, Listed, MATERIALS, MadeOf};
use super::paint::Kind;
use super::xml::{MEND, text, value};
use crate::mesh::paint::Paint;

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const PRODUCTION: &str = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";

/// Extensions that are understood, or that say nothing about shapes.
const UNDERSTOOD: [&str; 9] = [
    CORE,
    PRODUCTION,
    BEAMS,
    BALLS,
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
    MATERIALS,
    "http://www.w3.org/XML/1998/namespace",
    // What PrusaSlicer and OrcaSlicer save with objects is read where it is found.
    "http://schemas.slic3r.org/3mf/2017/06",
    "http://schemas.bambulab.com/package/2021",
];

/// What extensions that are not understood are called, by a part of their address.
const NAMES: [(&str, &str); 6] = [
    ("/volumetric/", "volumetric"),
    ("/implicit/", "implicit"),
    ("/booleanoperations/", "boolean operations"),
    ("/displacement/", "displacement"),
    ("/securecontent/", "secure content"),
    ("/slice/", "slice"),
];

const PLAIN_MESH: &str = "export it as a plain mesh: 3MF without extensions, or STL";

/// Why a part is refused, and the remedy.
#[derive(Debug)]
pub(super) struct Refusal {
    pub problem: String,
    pub mend: &'static str,
}

impl From<String> for Refusal {
    fn from(problem: String) -> Self {
        Self { problem, mend: MEND }
    }
}

/// A model part.
#[derive(Debug)]
pub(super) struct Part {
    /// Millimetres in a unit of its coordinates.
    pub unit_mm: f64,
    pub objects: BTreeMap<u32, Object>,
    /// Its lists of materials, in the order of the file.
    pub materials: Vec<Group>,
    /// The build items; only those of the root part count.
    pub items: Vec<Use>,
    /// Items that are not to be printed.
    pub unprinted: usize,
    /// Extensions that are not understood, by address.
    pub unknown: Vec<String>,
}

/// A mesh, or other objects put together.
#[derive(Debug, Default)]
pub(super) struct Object {
    pub name: Option<String>,
    /// Whether it is something to print; supports and the like are not.
    pub solid: bool,
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// What is painted on them.
    pub paint: Paint,
    /// The material of what says nothing else.
    pub material: Option<Listed>,
    /// Triangles with a material of their own.
    pub materials: Vec<(u32, [Listed; 3])>,
    /// Struts and balls besides the triangles.
    pub lattice: Option<Lattice>,
    pub components: Vec<Use>,
}

/// An object used somewhere: a component or a build item.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Use {
    pub object: u32,
    /// The part that holds it, where that is another.
    pub part: Option<String>,
    pub transform: Affine,
}

/// A mesh at its position.
pub(super) struct Instance {
    pub part: String,
    pub object: u32,
    pub transform: Affine,
}

/// Reads a part to its end. Extensions are listed unless the model requires one that is not understood.
///
/// # Errors
/// What is wrong, and where.
pub(super) fn read(mut reader: NsReader<impl BufRead>) -> Result<Part, Refusal> {
    let mut part = Part {
        unit_mm: 1.0,
        objects: BTreeMap::new(),
        materials: Vec::new(),
        items: Vec::new(),
        unprinted: 0,
        unknown: Vec::new(),
    };
    let mut buffer = Vec::new();
    let mut current: Option<(u32, Object)> = None;
    let mut painted = Vec::new();
    let (mut begun, mut ended) = (false, false);
    loop {
        buffer.clear();
        let at = reader.buffer_position();
        let (namespace, event) =
            reader.read_resolved_event_into(&mut buffer).map_err(|e| located(at, &e.to_string()))?;
        let within = |address: &str| matches!(namespace, ResolveResult::Bound(Namespace(n)) if n == address);
        let (core, lattice) = (within(CORE), within(BEAMS) || within(BALLS));
        match event {
            Event::Start(tag) | Event::Empty(tag) if lattice => {
                if let Some((id, object)) = &mut current {
                    if let Some(mode) = lattice::clipping(&tag) {
                        let problem = format!(
                            "object {id}: its beam lattice is clipped by another mesh (clippingmode \"{mode}\"), which \
                             is not understood"
                        );
                        return Err(Refusal { problem, mend: PLAIN_MESH });
                    }
                    object
                        .lattice(&tag)
                        .map_err(|problem| located(at, &format!("object {id}: {problem}")))?;
                }
            }
            Event::Start(tag) | Event::Empty(tag) if within(MATERIALS) => {
                materials::read(&tag, &mut part.materials);
            }
            Event::Start(tag) | Event::Empty(tag) if core => {
                let done = match tag.local_name().into_inner() {
                    "model" => {
                        begun = true;
                        part.root(&tag)?;
                        Ok(())
                    }
                    "object" => object(&tag).map(|new| {
                        let before = current.replace(new);
                        part.objects.extend(before.map(complete));
                    }),
                    "vertex" => corner(&tag).map(|vertex| {
                        if let Some((_, object)) = &mut current {
                            object.vertices.push(vertex);
                        }
                    }),
                    "triangle" => {
                        let mut made_of = MadeOf::default();
                        triangle(&tag, &mut painted, &mut made_of).and_then(|triangle| match &mut current {
                            Some((_, object)) => object.add(triangle, painted.drain(..), made_of),
                            None => Ok(()),
                        })
                    }
                    "basematerials" | "base" => {
                        materials::read(&tag, &mut part.materials);
                        Ok(())
                    }
                    "component" => usage(&tag, part.unit_mm).map(|used| {
                        if let Some((_, object)) = &mut current {
                            object.components.push(used);
                        }
                    }),
                    "item" if value(&tag, "printable").is_some_and(|v| v == "0" || v == "false") => {
                        part.unprinted += 1;
                        Ok(())
                    }
                    "item" => usage(&tag, part.unit_mm).map(|used| part.items.push(used)),
                    _ => Ok(()),
                };
                done.map_err(|problem| located(at, &problem))?;
            }
            Event::End(tag) if core => match tag.local_name().into_inner() {
                "object" => part.objects.extend(current.take().map(complete)),
                "model" => ended = true,
                _ => {}
            },
            Event::DocType(_) => {
                return Err(located(at, "it has a document type, which 3MF does not allow").into());
            }
            Event::Eof if !begun => return Err(String::from("it holds no model").into()),
            Event::Eof if !ended => return Err(located(at, "it ends early").into()),
            Event::Eof => {
                part.objects.extend(current.map(complete));
                return Ok(part);
            }
            _ => {}
        }
    }
}

/// An object after its last tag.
fn complete((id, mut object): (u32, Object)) -> (u32, Object) {
    if let Some(lattice) = &mut object.lattice {
        lattice.complete();
    }
    (id, object)
}

/// An extension in words.
pub(super) fn extension_name(address: &str) -> String {
    match NAMES.iter().find(|(part, _)| address.contains(part)) {
        Some((_, name)) => format!("\"{name}\" ({address})"),
        None => address.to_owned(),
    }
}

fn located(at: u64, problem: &str) -> String {
    format!("byte {at}: {problem}")
}

impl Part {
    /// Unit and extensions.
    fn root(&mut self, tag: &BytesStart<'_>) -> Result<(), Refusal> {
        let unit = value(tag, "unit").unwrap_or_else(|| "millimeter".into());
        self.unit_mm = match unit.as_str() {
            "micron" => 0.001,
            "millimeter" => 1.0,
            "centimeter" => 10.0,
            "inch" => 25.4,
            "foot" => 304.8,
            "meter" => 1000.0,
            _ => return Err(format!("`{unit}` is no unit of length").into()),
        };
        let address = |prefix: &str| value(tag, &format!("xmlns:{prefix}"));
        let listed = |key: &str| -> Vec<String> {
            let prefixes = value(tag, key).unwrap_or_default();
            prefixes.split_ascii_whitespace().map(|p| address(p).unwrap_or_else(|| p.to_owned())).collect()
        };
        let unknown = |address: &String| !UNDERSTOOD.contains(&address.as_str());
        if let Some(required) = listed("requiredextensions").into_iter().find(unknown) {
            let name = extension_name(&required);
            let problem = format!("it requires the extension {name}, which is not understood");
            return Err(Refusal { problem, mend: PLAIN_MESH });
        }
        let declared = tag.attributes().flatten().filter(|a| a.key.0.starts_with("xmlns:"));
        self.unknown = declared.filter_map(|a| text(&a)).filter(unknown).collect();
        Ok(())
    }
}

impl Object {
    /// Facets of it; `unit_mm` is the longest that a unit of its coordinates gets, millimetres.
    pub fn facet_count(&self, unit_mm: f64) -> usize {
        let lattice = self.lattice.as_ref().map_or(0, |lattice| lattice.facet_count(unit_mm));
        self.triangles.len().saturating_add(lattice)
    }

    /// Adds what a tag says of the lattice.
    fn lattice(&mut self, tag: &BytesStart<'_>) -> Result<(), String> {
        let vertices = self.vertices.len();
        match (tag.local_name().into_inner(), &mut self.lattice) {
            ("beamlattice", lattice) => *lattice = Some(Lattice::new(tag)?),
            ("beam", Some(lattice)) => lattice.add_beam(tag, vertices)?,
            ("ball", Some(lattice)) => lattice.add_ball(tag, vertices)?,
            _ => {}
        }
        Ok(())
    }

    /// Adds a triangle, whose corners stand before it in the file, and what is painted on it.
    fn add(
        &mut self,
        triangle: [u32; 3],
        painted: impl Iterator<Item = (Kind, String)>,
        made_of: MadeOf,
    ) -> Result<(), String> {
        match triangle.iter().find(|&&v| v as usize >= self.vertices.len()) {
            Some(v) => Err(format!(
                "triangle {} names vertex {v}, but there are only {} (counted from 0)",
                self.triangles.len() + 1,
                self.vertices.len()
            )),
            None => {
                let own = made_of
                    .corners(self.material)
                    .filter(|own| own.iter().any(|own| self.material != Some(*own)));
                self.materials.extend(own.map(|own| (self.triangles.len() as u32, own)));
                self.triangles.push(triangle);
                let corners = || triangle.map(|v| self.vertices[v as usize]);
                for (kind, digits) in painted {
                    let number = self.triangles.len();
                    kind.read(&digits, corners(), &mut self.paint)
                        .map_err(|problem| format!("triangle {number}: {problem}"))?;
                }
                Ok(())
            }
        }
    }
}

/// The attribute of the production extension, whatever its prefix.
fn path_of(tag: &BytesStart<'_>) -> Option<String> {
    tag.attributes().flatten().find(|a| a.key.0.ends_with(":path")).as_ref().and_then(text)
}

fn id(tag: &BytesStart<'_>, key: &str) -> Result<u32, String> {
    let text = value(tag, key).unwrap_or_default();
    text.parse().map_err(|_| format!("`{text}` is no valid {key}"))
}

fn object(tag: &BytesStart<'_>) -> Result<(u32, Object), String> {
    let kind = value(tag, "type").unwrap_or_else(|| "model".into());
    let name = value(tag, "name").map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
    let solid = matches!(kind.as_str(), "model" | "solidsupport");
    let number = |key: &str| value(tag, key).and_then(|text| text.trim().parse().ok());
    let material = materials::listed(number("pid"), number("pindex"), None);
    Ok((id(tag, "id")?, Object { name, solid, material, ..Object::default() }))
}

fn usage(tag: &BytesStart<'_>, unit_mm: f64) -> Result<Use, String> {
    let transform = match value(tag, "transform") {
        None => Affine::NONE,
        Some(text) => Affine::parse(&text, unit_mm).ok_or_else(|| {
            format!("`{text}` is no transform: 12 numbers that do not flatten are expected")
        })?,
    };
    Ok(Use { object: id(tag, "objectid")?, part: path_of(tag), transform })
}

/// Three attributes of a tag that has little else, parsed without a copy: a model is mostly these.
/// `other` gets those with other keys.
fn three<T: std::str::FromStr>(
    tag: &BytesStart<'_>,
    keys: [&str; 3],
    mut other: impl FnMut(&str, &str),
) -> Result<[T; 3], String> {
    let mut found = [None, None, None];
    for attribute in tag.attributes().with_checks(false).flatten() {
        if let Some(i) = keys.iter().position(|key| attribute.key.0 == *key) {
            found[i] = attribute.value.trim().parse().ok();
        } else {
            other(attribute.key.0, &attribute.value);
        }
    }
    match found {
        [Some(a), Some(b), Some(c)] => Ok([a, b, c]),
        _ => Err(format!(
            "<{}> is not a tag with three numbers {}",
            tag.attributes_raw().trim(),
            keys.join(", ")
        )),
    }
}

fn corner(tag: &BytesStart<'_>) -> Result<[f64; 3], String> {
    let vertex: [f64; 3] = three(tag, ["x", "y", "z"], |_, _| ())?;
    match vertex.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(format!("coordinate {x} is not a finite number")),
        None => Ok(vertex),
    }
}

/// A triangle; `painted` gets what is painted on it, `made_of` where its material is.
fn triangle(
    tag: &BytesStart<'_>,
    painted: &mut Vec<(Kind, String)>,
    made_of: &mut MadeOf,
) -> Result<[u32; 3], String> {
    three(tag, ["v1", "v2", "v3"], |key, value| match key {
        "pid" => made_of.group = value.trim().parse().ok(),
        "p1" => made_of.places[0] = value.trim().parse().ok(),
        "p2" => made_of.places[1] = value.trim().parse().ok(),
        "p3" => made_of.places[2] = value.trim().parse().ok(),
        _ => painted
            .extend(Kind::of(key).filter(|_| !value.trim().is_empty()).map(|kind| (kind, value.to_owned()))),
    })
}
