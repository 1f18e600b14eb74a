//! Models that are moved together.

use super::layout::{Item, Layout, Member, hull};
use super::options::BedShape;
use super::pack::Footprint;
use super::silhouette::{Bitmap, silhouette};
use crate::mesh::{Mesh, quarter_turned};

/// Bodies of a layout that keep their places relative to each other.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Number of the layout.
    pub layout: usize,
    /// Numbers of the bodies.
    pub bodies: Vec<usize>,
    /// Where the middle of the box around it is in the file's coordinates.
    pub middle: [f64; 2],
    pub size: [f64; 3],
    pub parts: Vec<Part>,
}

/// A member of a group at its position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub member: Member,
    /// Number of its body.
    pub body: usize,
    /// Middle of its box from that of the group's.
    pub at: [f64; 2],
    /// How high over the bed it begins.
    pub lift_mm: f64,
}

impl Layout {
    /// Each body by itself, with the names of its models: in X and Y as in the file, lowered onto z = 0.
    pub fn standing_bodies(&self) -> Vec<(String, Mesh)> {
        let all = Group::new(0, self, (0..self.bodies.len()).collect());
        let body = |body: usize| {
            let parts: Vec<&Part> = all.parts.iter().filter(|part| part.body == body).collect();
            let mut names: Vec<&str> =
                parts.iter().map(|part| self.items[part.member.item].name.as_str()).collect();
            names.dedup();
            let mut whole = Mesh::new(Vec::new(), Vec::new());
            for part in &parts {
                let item = &self.items[part.member.item];
                let [x, y, _] = item.positions[part.member.position];
                let mut mesh = item.mesh.clone();
                mesh.shift([x, y, part.lift_mm - item.bounds[0][2]]);
                whole = if whole.triangles().is_empty() { mesh } else { whole.with(&mesh) };
            }
            (names.join(" + "), whole)
        };
        (0..self.bodies.len()).map(body).collect()
    }
}

impl Group {
    /// Bodies of a layout; those that do not stand over another are lowered onto the bed.
    pub fn new(number: usize, layout: &Layout, bodies: Vec<usize>) -> Self {
        let foot = |m: Member| layout.items[m.item].foot(m.position);
        let members = |body: usize| layout.bodies[body].iter().copied();
        let floor = |column: usize| {
            let members_of = bodies.iter().filter(|&&body| layout.columns[body] == column);
            members_of.flat_map(|&body| members(body)).map(|m| foot(m)[2]).fold(f64::INFINITY, f64::min)
        };
        let mut parts: Vec<Part> = Vec::new();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut height_mm = 0.0_f64;
        for &body in &bodies {
            let floor_mm = floor(layout.columns[body]);
            for member in members(body) {
                let ([x, y, z], size) = (foot(member), layout.items[member.item].size());
                let lift_mm = z - floor_mm;
                height_mm = height_mm.max(lift_mm + size[2]);
                for (i, x) in [x, y].into_iter().enumerate() {
                    low[i] = low[i].min(x - size[i] / 2.0);
                    high[i] = high[i].max(x + size[i] / 2.0);
                }
                parts.push(Part { member, body, at: [x, y], lift_mm });
            }
        }
        // Of one model alone the middle is its own, to the last bit.
        let middle = match parts.as_slice() {
            [only] => only.at,
            _ => [0, 1].map(|i| (low[i] + high[i]) / 2.0),
        };
        let size = match parts.as_slice() {
            [only] => layout.items[only.member.item].size(),
            _ => [high[0] - low[0], high[1] - low[1], height_mm],
        };
        parts.iter_mut().for_each(|part| part.at = [part.at[0] - middle[0], part.at[1] - middle[1]]);
        Self { layout: number, bodies, middle, size, parts }
    }

    /// What messages call one of its copies.
    pub fn name(&self, layout: &Layout, copy: usize) -> String {
        let mut items: Vec<usize> = self.parts.iter().map(|part| part.member.item).collect();
        items.dedup();
        let name = match items.as_slice() {
            _ if self.bodies.len() == layout.bodies.len() && self.parts.len() > 1 => layout.name.clone(),
            [item] => layout.items[*item].name.clone(),
            [first, ..] => format!("{} and what it interlocks with", layout.items[*first].name),
            [] => layout.name.clone(),
        };
        let number = match (self.parts.as_slice(), items.as_slice()) {
            ([only], [item]) => copy * layout.items[*item].positions.len() + only.member.position,
            _ => copy,
        };
        if number == 0 { name } else { format!("{name} ({})", number + 1) }
    }

    /// Seen from above, turned by quarters.
    pub fn footprint(&self, layout: &Layout, shape: BedShape, quarters: u32) -> Footprint {
        let of_part =
            |part: &Part| corners(&layout.items[part.member.item], part.member.position, self.middle);
        footprint(self.size, shape, quarters, || self.parts.iter().flat_map(of_part).collect())
    }

    /// The area that it covers, grown by `reach_mm`; the convex hull of each body where `convex`.
    pub fn silhouette(
        &self,
        layout: &Layout,
        quarters: u32,
        convex: bool,
        reach_mm: f64,
        cell_mm: f64,
    ) -> Bitmap {
        let bodies = self.bodies.iter().map(|&body| {
            let parts = self.parts.iter().filter(move |part| part.body == body);
            parts.flat_map(|part| {
                let item = &layout.items[part.member.item];
                let [dx, dy, _] = item.positions[part.member.position];
                let at = move |v: u32| {
                    let [x, y, _] = item.mesh.vertices()[v as usize];
                    quarter_turned([x + dx - self.middle[0], y + dy - self.middle[1]], quarters)
                };
                item.mesh.triangles().iter().map(move |triangle| triangle.map(at))
            })
        });
        silhouette(bodies, convex, reach_mm, cell_mm)
    }
}

/// Corners of the convex hull of an item in one of its positions, seen from above, from a middle.
pub(super) fn corners(item: &Item, position: usize, middle: [f64; 2]) -> Vec<[f64; 2]> {
    hull(item, position).exterior().points().map(|p| [p.x() - middle[0], p.y() - middle[1]]).collect()
}

/// What is of this size seen from above, turned by quarters; its corners matter on a round bed.
pub(super) fn footprint(
    [width, depth, height]: [f64; 3],
    shape: BedShape,
    quarters: u32,
    corners: impl FnOnce() -> Vec<[f64; 2]>,
) -> Footprint {
    let size = if quarters.is_multiple_of(2) { [width, depth, height] } else { [depth, width, height] };
    let rim = match shape {
        BedShape::Rectangular => None,
        BedShape::Round => Some(corners().into_iter().map(|p| quarter_turned(p, quarters)).collect()),
    };
    Footprint::new(size, rim)
}
