//! 3MF: a ZIP archive of XML parts. Core specification 1.3 and the production extension 1.1 (objects in parts of their
//! own), as far as they say what is printed: meshes, components, transforms, units, build items. Beam lattices (1.2) become
//! meshes.
//!
//! The reader is our own, on `zip` and `quick-xml`: of the crates for 3MF, `threemf2` needs a later compiler than we do
//! and `lib3mf` builds a second geometry kernel; neither says where in a file a mistake is, nor bounds what an archive
//! may unpack to.

mod affine;
mod archive;
mod lattice;
mod made_of;
mod materials;
mod model;
mod paint;
mod saved;
mod struts;
mod xml;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use affine::Affine;
use archive::Archive;
use model::{Instance, Object, Part, Use, extension_name};
use saved::{Purpose, SavedObject, Volume};

use super::format::{Contents, FileModifier, FileObject, Format, bad_coordinate, has_extension};
use crate::limits;
use crate::mesh::effect::{Effect, SavedSettings};
use crate::mesh::error::{Location, MeshError};
use crate::mesh::paint::Paint;
use crate::mesh::weld::Welder;
use xml::MEND;

/// DisjointSets may stand in components so deep.
const DEEPEST: usize = 64;

/// DisjointSets of components multiply: no more facets than this are made of a file.
const MOST_FACETS: usize = 50_000_000;

/// And no more uses of objects than this.
const MOST_USES: usize = 1_000_000;

/// Objects with more facets than this are checked for sufficient memory.
const UNSUSPECTED: usize = 1_000_000;

/// Bytes that a facet takes until it is repaired.
const BYTES_PER_FACET: u64 = 50 * limits::BYTES_PER_BYTE;

/// Other parts of a package than those of the model.
pub(crate) struct Parts<'a>(Archive<'a>);

impl<'a> Parts<'a> {
    /// The parts of a package; `None`: it is no ZIP archive.
    pub(crate) fn open(path: &Path, data: &'a [u8]) -> Option<Self> {
        let is_archive = data.starts_with(b"PK\x03\x04") || data.starts_with(b"PK\x05\x06");
        is_archive.then(|| Archive::open(path, data).ok().map(Self)).flatten()
    }

    /// The contents of a part of so many bytes at most; `None`: there is no such part.
    ///
    /// # Errors
    /// It is larger, cannot be unpacked, or unpacks to far more than its packed size.
    pub(crate) fn bytes(&mut self, name: &str, most: u64) -> Result<Option<Vec<u8>>, MeshError> {
        self.0.bytes(name, most)
    }

    /// An error in a part.
    pub(crate) fn error(&self, name: &str, problem: String) -> MeshError {
        self.0.error(name, problem, "save the project again")
    }
}

pub(super) struct ThreeMf;

impl Format for ThreeMf {
    fn recognises(&self, path: &Path, data: &[u8]) -> bool {
        data.starts_with(b"PK\x03\x04") || data.starts_with(b"PK\x05\x06") || has_extension(path, "3mf")
    }

    /// One object for each object that the build names, with the positions of all items that differ by a shift alone.
    fn read(&self, path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
        let mut package = Package::open(path, data)?;
        let root = package.root.clone();
        let items = std::mem::take(&mut package.parts.get_mut(&root).expect("it was read").items);
        if items.is_empty() {
            return Err(package.archive.error(&root, "the build holds nothing to print", MEND));
        }
        let mut groups: Vec<(Use, Vec<[f64; 3]>)> = Vec::new();
        for item in items {
            let (transform, position) = item.transform.split();
            let item = Use { transform, ..item };
            match groups.iter_mut().find(|(same, _)| *same == item) {
                Some((_, positions)) => positions.push(position),
                None => groups.push((item, vec![position])),
            }
        }
        let saved = package.saved();
        let used = if saved.is_empty() { package.materials(&groups, &root) } else { Vec::new() };
        let mut objects = Vec::with_capacity(groups.len());
        let (mut empty, mut unknown) = (0, 0);
        let mut budget = Budget { facets: MOST_FACETS, uses: MOST_USES, skipped: 0 };
        for (item, positions) in groups {
            let (mut instances, skipped) = (Vec::new(), budget.skipped);
            let told = saved.get(&item.object);
            package.gather(&item, &root, &Affine::NONE, told, 0, &mut budget, &mut instances)?;
            if instances.is_empty() {
                empty += usize::from(budget.skipped == skipped);
                continue;
            }
            let make = |keep: &dyn Fn(u32, usize) -> bool| {
                package.object(&item, &root, &instances, positions.clone(), keep)
            };
            let is_printed =
                |object: u32, facet: usize| told.is_none_or(|told| told.tool(object, facet).is_some());
            let mut object = make(&is_printed)?;
            object.materials = made_of::of(&package.parts, &used, &instances);
            let of_bodies = made_of::of_bodies(&package.parts, &used, &instances);
            for tool in of_bodies.values().collect::<BTreeSet<_>>() {
                let part = make(&|object, _| of_bodies.get(&object) == Some(tool))?;
                if !part.soup.triangles.is_empty() {
                    object.parts.push(FileObject { tool: Some(*tool), ..part });
                }
            }
            if let Some(told) = told {
                let used = told.tools();
                for tool in used.iter().filter(|_| used.len() > 1) {
                    let part = make(&|object, facet| told.tool(object, facet) == Some(*tool))?;
                    if !part.soup.triangles.is_empty() {
                        object.parts.push(FileObject { tool: Some(*tool), ..part });
                    }
                }
                object.tool = told.only_tool();
                object.saved = told.own().clone();
                for (number, volume) in told.volumes().iter().enumerate() {
                    let Some(effect) = effect(volume, told) else {
                        unknown += usize::from(volume.purpose == Purpose::Other);
                        continue;
                    };
                    let body = make(&|object, facet| told.volume(object, facet) == Some(number))?;
                    if !body.soup.triangles.is_empty() {
                        let (name, soup, facets) = (volume.name.clone(), body.soup, body.facets);
                        object.modifiers.push(FileModifier { name, soup, facets, effect });
                    }
                }
            }
            if object.soup.triangles.is_empty() {
                empty += 1;
                continue;
            }
            objects.push(object);
        }
        if objects.is_empty() && empty > 0 {
            return Err(MeshError::NoFacets { path: path.to_path_buf() });
        }
        let mut notes = package.notes(&root, budget.skipped);
        if unknown > 0 {
            notes.push(format!("{unknown} parts of objects, of a kind that is not known, were left out"));
        }
        if empty > 0 {
            notes.push(format!("{empty} objects without a facet were left out"));
        }
        Ok(Contents { objects, format: "3MF", notes })
    }
}

/// What a part does to its object; `None`: it is a part of it that is printed as the object is, or of no known kind.
fn effect(volume: &Volume, told: &SavedObject) -> Option<Effect> {
    match volume.purpose {
        Purpose::Cut => Some(Effect::Cut),
        Purpose::Modify => Some(Effect::Settings(volume.saved.clone())),
        Purpose::Support(wish) => Some(Effect::Support(wish)),
        // Its extruder is that of a part of the object.
        Purpose::Print if told.parts_differ() => {
            Some(Effect::Settings(SavedSettings { tool: None, ..volume.saved.clone() }))
        }
        Purpose::Print | Purpose::Other => None,
    }
}

/// The memory that a file may still use.
struct Budget {
    facets: usize,
    uses: usize,
    /// Objects that are no solids.
    skipped: usize,
}

/// All parts of a package that its build needs.
struct Package<'a> {
    archive: Archive<'a>,
    root: String,
    parts: BTreeMap<String, Part>,
}

impl<'a> Package<'a> {
    fn open(path: &Path, data: &'a [u8]) -> Result<Self, MeshError> {
        let mut archive = Archive::open(path, data)?;
        let root = archive.root()?;
        let mut package = Self { archive, root, parts: BTreeMap::new() };
        let mut wanted = vec![package.root.clone()];
        while let Some(name) = wanted.pop() {
            if package.parts.contains_key(&name) {
                continue;
            }
            let read = model::read(package.archive.part(&name)?);
            let part = read.map_err(|refusal| package.archive.error(&name, refusal.problem, refusal.mend))?;
            let own = if name == package.root { part.items.as_slice() } else { &[] };
            let uses = own.iter().chain(part.objects.values().flat_map(|object| &object.components));
            wanted.extend(uses.filter_map(|used| used.part.clone()));
            package.parts.insert(name, part);
        }
        Ok(package)
    }

    /// The object that is used in a part, and the part that holds it.
    fn find(&self, used: &Use, from: &str) -> Result<(&Object, String), MeshError> {
        let name = used.part.clone().unwrap_or_else(|| from.to_owned());
        match self.parts.get(&name).and_then(|part| part.objects.get(&used.object)) {
            Some(object) => Ok((object, name)),
            None => {
                let problem = format!("it uses object {}, which {name} does not hold", used.object);
                Err(self.archive.error(from, problem, MEND))
            }
        }
    }

    /// The meshes that an object is made of, at their positions, in the order of the file. `told` is what is saved of it.
    #[allow(
        clippy::too_many_arguments,
        reason = "what goes down with the components, and what comes of them"
    )]
    fn gather(
        &self,
        used: &Use,
        from: &str,
        outer: &Affine,
        told: Option<&SavedObject>,
        depth: usize,
        budget: &mut Budget,
        found: &mut Vec<Instance>,
    ) -> Result<(), MeshError> {
        let (object, part) = self.find(used, from)?;
        let refuse = |problem: String| Err(self.archive.error(&part, problem, MEND));
        if depth >= DEEPEST {
            return refuse(format!(
                "object {}: its components contain each other, or stand more than {DEEPEST} deep",
                used.object
            ));
        }
        let transform = used.transform.then(outer);
        let unit_mm = self.parts.get(&part).map_or(1.0, |part| part.unit_mm) * transform.stretch();
        let count = if object.solid { object.facet_count(unit_mm) } else { object.triangles.len() };
        let left = (budget.uses.checked_sub(1), budget.facets.checked_sub(count));
        let (Some(uses), Some(facets)) = left else {
            return refuse(format!(
                "object {}: its components or struts multiply to more than {MOST_FACETS} facets or {MOST_USES} objects",
                used.object
            ));
        };
        (budget.uses, budget.facets) = (uses, facets);
        // OrcaSlicer and its kin call modifiers and the like "other".
        if !object.solid && !told.is_some_and(|told| told.has_modifier(used.object)) {
            budget.skipped += 1;
            return Ok(());
        }
        for component in &object.components {
            self.gather(component, &part, &transform, told, depth + 1, budget, found)?;
        }
        if count > 0 {
            found.push(Instance { part, object: used.object, transform });
        }
        Ok(())
    }

    /// The facets of an object that are to be kept, by the object that holds them and their number there, welded; it is where its own transform without the shift puts it.
    fn object(
        &self,
        item: &Use,
        root: &str,
        instances: &[Instance],
        positions: Vec<[f64; 3]>,
        keep: &dyn Fn(u32, usize) -> bool,
    ) -> Result<FileObject, MeshError> {
        let (named, _) = self.find(item, root)?;
        let meshes = instances.iter().filter_map(|instance| {
            let part = self.parts.get(&instance.part)?;
            Some((
                part.objects.get(&instance.object)?,
                Affine::scaled(part.unit_mm).then(&instance.transform),
                instance.object,
            ))
        });
        let meshes: Vec<(&Object, Affine, u32)> = meshes.collect();
        let facets: usize =
            meshes.iter().map(|(mesh, transform, _)| mesh.facet_count(transform.stretch())).sum();
        if facets > UNSUSPECTED {
            let path = || self.archive.path().to_path_buf();
            limits::check_memory(facets as u64 * BYTES_PER_FACET)
                .map_err(|problem| MeshError::TooLarge { path: path(), problem })?;
        }
        let only = if let [(mesh, ..)] = meshes.as_slice() { mesh.name.clone() } else { None };
        let mut welder = Welder::with_capacity(facets);
        let mut number = 0;
        let mut paint = Paint::default();
        for (mesh, transform, id) in meshes {
            paint.add(&mesh.paint, |corner| transform.apply(corner));
            let vertices: Vec<[f32; 3]> =
                mesh.vertices.iter().map(|v| transform.apply(*v).map(|x| x as f32)).collect();
            let mirrored = transform.determinant() < 0.0;
            let all = || vertices.iter().copied();
            for (facet, &[a, b, c]) in mesh.triangles.iter().enumerate() {
                number += 1;
                if !keep(id, facet) {
                    continue;
                }
                let triangle = if mirrored { [a, c, b] } else { [a, b, c] };
                let bad = |value| bad_coordinate(self.archive.path(), Location::Facet(number), value, all());
                welder.push(triangle.map(|v| vertices[v as usize])).map_err(bad)?;
            }
            if let Some(lattice) = mesh.lattice.as_ref().filter(|_| keep(id, 0)) {
                let mut damaged = None;
                lattice.facets(&mesh.vertices, transform.stretch(), |[a, b, c]| {
                    number += 1;
                    let triangle = if mirrored { [a, c, b] } else { [a, b, c] };
                    let pushed = welder.push(triangle.map(|p| transform.apply(p).map(|x| x as f32)));
                    damaged = damaged.or(pushed.err().map(|value| (number, value)));
                });
                if let Some((number, value)) = damaged {
                    return Err(bad_coordinate(self.archive.path(), Location::Facet(number), value, all()));
                }
            }
        }
        let (name, soup) = (named.name.clone().or(only), welder.finish());
        Ok(FileObject { name, paint, ..FileObject::plain(soup, facets, positions) })
    }

    /// The materials of all that is built, in words.
    fn materials(&self, groups: &[(Use, Vec<[f64; 3]>)], root: &str) -> Vec<String> {
        let mut budget = Budget { facets: MOST_FACETS, uses: MOST_USES, skipped: 0 };
        let mut instances = Vec::new();
        for (item, _) in groups {
            // What is wrong with it is told when it is read.
            let _ = self.gather(item, root, &Affine::NONE, None, 0, &mut budget, &mut instances);
        }
        made_of::in_use(&self.parts, &instances)
    }

    /// What other slicers have saved with the objects.
    fn saved(&mut self) -> BTreeMap<u32, SavedObject> {
        let mut parts = saved::PARTS.iter();
        let read = |(name, words): &(&str, _)| Some(saved::read(self.archive.part(name).ok()?, *words));
        parts.find_map(read).unwrap_or_default()
    }

    /// What was passed over.
    fn notes(&self, root: &str, skipped: usize) -> Vec<String> {
        let mut unknown: Vec<&String> = self.parts.values().flat_map(|part| &part.unknown).collect();
        unknown.sort_unstable();
        unknown.dedup();
        let mut notes: Vec<String> = unknown
            .iter()
            .map(|address| {
                format!("the extension {} is not understood and was passed over", extension_name(address))
            })
            .collect();
        if skipped > 0 {
            notes.push(format!("{skipped} objects that are no solids, such as supports, were left out"));
        }
        match self.parts.get(root).map_or(0, |part| part.unprinted) {
            0 => {}
            count => {
                notes.push(format!("{count} objects that are marked as not to be printed were left out"))
            }
        }
        notes
    }
}
