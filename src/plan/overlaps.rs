//! Objects that overlap, or nearly touch, where their file puts them.

use crate::plate::Plate;
use crate::slice::{Layer, Section};
use geometry::Region;

use super::parts::Kinds;
use super::piece::Piece;
use crate::parallel::Workers;

/// Objects nearer than this may fuse, millimetres: about a bead.
const NEAR_MM: f64 = 0.4;

/// What overlaps by less than twice this touches, millimetres.
const TOUCH_MM: f64 = 0.005;

/// This many pairs are named.
const NAMED: usize = 3;

/// Two objects, by their numbers here, the lower first.
type Pair = [usize; 2];

/// The overlap of a pair.
#[derive(Clone, Copy, Default)]
struct Meeting {
    overlap_mm3: f64,
    /// Height of the first layer where they overlap, or come near.
    first_mm: Option<f64>,
    near: bool,
    /// They touch, or one stands on the other.
    touching: bool,
}

/// What becomes of sections that overlap.
#[derive(Default)]
pub(crate) struct Resolved {
    /// What the user should know.
    pub notes: Vec<String>,
    /// For each layer, and each of its sections, the objects that it is made of; empty: each is one.
    pub pieces: Vec<Vec<Vec<Piece>>>,
}

/// Unites sections that overlap, so that nothing is printed twice, and reports overlaps and objects that may fuse.
///
/// Objects with the same settings become one, which is the first of them; of others, what they share belongs to the first. Those
/// that differ in their tool alone become one already where they touch, and what they share belongs to the last.
pub(crate) fn resolve(layers: &mut [Layer], plate: &Plate, kinds: &Kinds, workers: Workers<'_>) -> Resolved {
    let pairs = candidates(plate);
    if pairs.is_empty() {
        return Resolved::default();
    }
    let may_join: Vec<bool> =
        pairs.iter().map(|pair| kinds.are_alike(*pair) && !kinds.share_tool(*pair)).collect();
    let found = workers.map(layers.len(), |i| meetings(&layers[i], &pairs));
    let touching = workers.map(if may_join.contains(&true) { layers.len() } else { 0 }, |i| {
        touching(&layers[i], i.checked_sub(1).map(|below| &layers[below]), &pairs, &may_join)
    });
    let mut meetings = vec![Meeting::default(); pairs.len()];
    for (layer, found) in layers.iter().zip(&found) {
        for &(pair, overlap_mm2) in found {
            let meeting = &mut meetings[pair];
            if overlap_mm2 > 0.0 && meeting.overlap_mm3 == 0.0 {
                meeting.first_mm = None;
            }
            meeting.overlap_mm3 += overlap_mm2 * layer.span.height_mm;
            meeting.near = true;
            meeting.first_mm.get_or_insert(layer.span.top_mm);
        }
    }
    for pair in touching.into_iter().flatten() {
        meetings[pair].touching = true;
    }
    let of_pair: Vec<(Pair, Meeting)> = pairs.iter().copied().zip(meetings).collect();
    let overlapping: Vec<(Pair, Meeting)> =
        of_pair.iter().copied().filter(|(_, meeting)| meeting.overlap_mm3 > 0.0).collect();
    // The first object of what each is a part of.
    let mut first: Vec<usize> = (0..plate.objects.len()).collect();
    let joined = |(pair, meeting): &&(Pair, Meeting)| {
        kinds.are_alike(*pair) && (meeting.overlap_mm3 > 0.0 || meeting.touching)
    };
    for ([a, b], _) in of_pair.iter().filter(joined) {
        let (low, high) = (first[*a].min(first[*b]), first[*a].max(first[*b]));
        first.iter_mut().filter(|one| **one == high).for_each(|one| *one = low);
    }
    let mut pieces = Vec::new();
    if !overlapping.is_empty() || of_pair.iter().any(|(_, meeting)| meeting.touching) {
        let mended = workers.map(layers.len(), |i| {
            let united = united(&layers[i].sections, &first, &overlapping, kinds);
            let pieces = united.iter().map(|section| kinds.pieces(&layers[i], section, &first)).collect();
            (united, pieces)
        });
        for (layer, (sections, of_layer)) in layers.iter_mut().zip(mended) {
            layer.sections = sections;
            pieces.push(of_layer);
        }
    }
    let name = |object: usize| plate.objects[object].name.as_str();
    let mut notes: Vec<String> = overlapping
        .iter()
        .take(NAMED)
        .map(|([a, b], Meeting { overlap_mm3, first_mm, .. })| {
            let how = match (kinds.are_alike([*a, *b]), kinds.share_tool([*a, *b])) {
                (true, true) => "they are printed as one".to_owned(),
                (false, true) => format!("what they share is printed as a part of {}", name(*a)),
                (_, false) => format!("what they share is printed as a part of {}", name(*b)),
            };
            let (a, b, z_mm) = (name(*a), name(*b), first_mm.unwrap_or(0.0));
            format!("{a} and {b} overlap by {overlap_mm3:.1} mm³ from Z {z_mm:.2} on; {how}")
        })
        .collect();
    if let Some(more) = overlapping.len().checked_sub(NAMED).filter(|more| *more > 0) {
        notes.push(format!("{more} more pairs of objects overlap, and are treated alike"));
    }
    let apart = |(pair, meeting): &&(Pair, Meeting)| {
        meeting.near && meeting.overlap_mm3 == 0.0 && first[pair[0]] != first[pair[1]]
    };
    let near: Vec<&(Pair, Meeting)> = of_pair.iter().filter(apart).collect();
    if let Some(([a, b], Meeting { first_mm, .. })) = near.first() {
        let (a, b, z_mm) = (name(*a), name(*b), first_mm.unwrap_or(0.0));
        let others = match near.len() - 1 {
            0 => String::new(),
            1 => ", and so does another pair".to_owned(),
            more => format!(", and so do {more} other pairs"),
        };
        notes.push(format!(
            "{a} and {b} come nearer than {NEAR_MM} mm to each other at Z {z_mm:.2}{others}: they may fuse"
        ));
    }
    Resolved { notes, pieces }
}

/// The pairs, of those that may be joined, that touch in a layer, or of which one stands on the other.
fn touching(layer: &Layer, below: Option<&Layer>, pairs: &[Pair], may_join: &[bool]) -> Vec<usize> {
    let section = |layer: Option<&Layer>, object: usize| -> Region {
        let mut sections = layer.into_iter().flat_map(|layer| &layer.sections);
        sections.find(|section| section.object == object).map(|s| s.region.clone()).unwrap_or_default()
    };
    let meet = |a: &Region, b: &Region| {
        !a.is_empty()
            && !b.is_empty()
            && !geometry::intersection(&geometry::offset(a, TOUCH_MM), b).is_empty()
    };
    let here = Some(layer);
    let touches = |[a, b]: Pair| {
        let (upper_a, upper_b) = (section(here, a), section(here, b));
        meet(&upper_a, &upper_b) || meet(&section(below, a), &upper_b) || meet(&section(below, b), &upper_a)
    };
    (0..pairs.len()).filter(|&pair| may_join[pair] && touches(pairs[pair])).collect()
}

/// Pairs of objects whose boxes come near each other.
fn candidates(plate: &Plate) -> Vec<Pair> {
    let boxes: Vec<[[f64; 3]; 2]> = plate
        .objects
        .iter()
        .map(|object| {
            let [x, y] = object.offset.mm();
            plate.meshes[object.mesh].bounds().map(|corner| [corner[0] + x, corner[1] + y, corner[2]])
        })
        .collect();
    let near = |a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]| {
        (0..3).all(|i| a[0][i] <= b[1][i] + NEAR_MM && b[0][i] <= a[1][i] + NEAR_MM)
    };
    let pairs = (0..boxes.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let mut pairs: Vec<Pair> = pairs.filter(|[a, b]| near(&boxes[*a], &boxes[*b])).collect();
    pairs.sort_unstable();
    pairs
}

/// The pairs that come near each other in a layer, with the area by which they overlap, mm².
fn meetings(layer: &Layer, pairs: &[Pair]) -> Vec<(usize, f64)> {
    let section = |object: usize| layer.sections.iter().find(|section| section.object == object);
    let mut found = Vec::new();
    for (number, [a, b]) in pairs.iter().enumerate() {
        let (Some(a), Some(b)) = (section(*a), section(*b)) else { continue };
        let (Some(box_a), Some(box_b)) = (a.region.bounds(), b.region.bounds()) else { continue };
        if !box_a.grown(geometry::to_units(NEAR_MM)).touches(&box_b) {
            continue;
        }
        let shared = geometry::intersection(&a.region, &b.region);
        let overlap_mm2 = match geometry::offset(&shared, -TOUCH_MM).is_empty() {
            true => 0.0,
            false => shared.area_mm2(),
        };
        if overlap_mm2 > 0.0 || are_close(&a.region, &b.region) {
            found.push((number, overlap_mm2));
        }
    }
    found
}

fn are_close(a: &Region, b: &Region) -> bool {
    let [a, b] = [a, b].map(|region| geometry::offset(region, NEAR_MM / 2.0 - TOUCH_MM));
    !geometry::intersection(&a, &b).is_empty()
}

/// The sections of a layer with every overlap in one of them only.
fn united(
    sections: &[Section],
    first: &[usize],
    overlapping: &[(Pair, Meeting)],
    kinds: &Kinds,
) -> Vec<Section> {
    let mut united: Vec<Section> = Vec::with_capacity(sections.len());
    for Section { object, region } in sections {
        let object = first[*object];
        match united.iter_mut().find(|section| section.object == object) {
            Some(section) => section.region = geometry::union(&section.region, region),
            None => united.push(Section { object, region: region.clone() }),
        }
    }
    united.sort_by_key(|section| section.object);
    for ([a, b], _) in overlapping {
        let [a, b] = [first[*a], first[*b]];
        let [a, b] = [a.min(b), a.max(b)];
        let [a, b] = if kinds.share_tool([a, b]) { [a, b] } else { [b, a] };
        let owner = united.iter().find(|section| section.object == a).map(|section| section.region.clone());
        let other = united.iter_mut().find(|section| section.object == b && a != b);
        if let (Some(owner), Some(other)) = (owner, other) {
            other.region = geometry::difference(&other.region, &owner);
        }
    }
    united.retain(|section| !section.region.is_empty());
    united
}
