//! What objects are made of, as tools: the materials in use, in the order of the file.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::affine::Affine;
use super::materials::{Group, Listed};
use super::model::{Instance, Part};
use crate::mesh::materials::Materials;
use crate::mesh::paint::PaintedFacet;

/// The materials of the meshes of a build in words, in the order of the file; one alone is none.
pub(super) fn in_use(parts: &BTreeMap<String, Part>, instances: &[Instance]) -> Vec<String> {
    let mut listed: BTreeSet<(&str, Listed)> = BTreeSet::new();
    for Instance { part, object, .. } in instances {
        let Some(found) = parts.get(part).and_then(|part| part.objects.get(object)) else {
            continue;
        };
        let all_differ = found.materials.len() == found.triangles.len();
        let own = found.material.filter(|_| !all_differ);
        let materials = own.into_iter().chain(found.materials.iter().flat_map(|(_, corners)| *corners));
        listed.extend(materials.map(|listed| (part.as_str(), listed)));
    }
    let mut names: Vec<String> = Vec::new();
    for (part, found) in parts {
        for Group { id, names: of_group } in &found.materials {
            let is_used = |place: &usize| listed.contains(&(part.as_str(), (*id, *place as u32)));
            for place in (0..of_group.len()).filter(is_used) {
                if !names.contains(&of_group[place]) {
                    names.push(of_group[place].clone());
                }
            }
        }
    }
    if names.len() > 1 { names } else { Vec::new() }
}

/// The tools of the bodies of an object, by their number, where each is of one material, and not all of the same.
pub(super) fn of_bodies(
    parts: &BTreeMap<String, Part>,
    names: &[String],
    instances: &[Instance],
) -> BTreeMap<u32, u32> {
    let mut tools = BTreeMap::new();
    for instance in instances {
        let Materials { tool, facets, .. } = self::of(parts, names, std::slice::from_ref(instance));
        match tool.filter(|_| facets.is_empty()) {
            Some(tool) => {
                tools.insert(instance.object, tool);
            }
            None => return BTreeMap::new(),
        }
    }
    let mut all = tools.values();
    let first = all.next().copied();
    if all.all(|tool| Some(*tool) == first) { BTreeMap::new() } else { tools }
}

/// A triangle of a gradient, in pieces: each place has what the corner has whose share of it is the largest.
fn by_corner(
    corners: [[f64; 3]; 3],
    tools: [Option<u8>; 3],
) -> impl Iterator<Item = (Option<u8>, [[f64; 3]; 3])> {
    let middle = |of: &[[f64; 3]]| [0, 1, 2].map(|i| of.iter().map(|p| p[i]).sum::<f64>() / of.len() as f64);
    let center = middle(&corners);
    (0..3).flat_map(move |k| {
        let [own, next, last] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| corners[k]);
        let [ahead, behind] = [middle(&[own, next]), middle(&[last, own])];
        [[own, ahead, center], [own, center, behind]].map(|piece| (tools[k], piece))
    })
}

/// What an object is made of, of the materials in use. One material of all its facets is that of the object.
pub(super) fn of(parts: &BTreeMap<String, Part>, names: &[String], instances: &[Instance]) -> Materials {
    let mut facets: Vec<(Option<u8>, [[f64; 3]; 3])> = Vec::new();
    if names.is_empty() {
        return Materials::default();
    }
    for Instance { part, object, transform } in instances {
        let Some(of) = parts.get(part) else { continue };
        let Some(object) = of.objects.get(object) else { continue };
        let transform = Affine::scaled(of.unit_mm).then(transform);
        let tool = |(id, place): Listed| {
            let name = of.materials.iter().find(|group| group.id == id)?.names.get(place as usize)?;
            let number = names.iter().position(|known| known == name)?;
            u8::try_from(number + 1).ok()
        };
        let mut own: Vec<[Option<u8>; 3]> = vec![[object.material.and_then(tool); 3]; object.triangles.len()];
        object.materials.iter().for_each(|(facet, corners)| own[*facet as usize] = corners.map(tool));
        for (triangle, tools) in object.triangles.iter().zip(own) {
            let corners = triangle.map(|v| transform.apply(object.vertices[v as usize]));
            match tools {
                [a, b, c] if a == b && b == c => facets.push((a, corners)),
                _ => facets.extend(by_corner(corners, tools)),
            }
        }
    }
    // What most facets are made of is not painted on.
    let mut counts: BTreeMap<Option<u8>, usize> = BTreeMap::new();
    facets.iter().for_each(|(tool, _)| *counts.entry(*tool).or_default() += 1);
    let usual = counts.iter().max_by_key(|(tool, count)| (**count, Reverse(**tool)));
    let usual = usual.and_then(|(tool, _)| *tool);
    let painted = facets.into_iter().filter(|(tool, _)| tool.is_some() && *tool != usual);
    Materials {
        names: names.to_vec(),
        tool: usual.map(u32::from),
        facets: painted.filter_map(|(tool, corners)| Some(PaintedFacet { corners, paint: tool? })).collect(),
    }
}
