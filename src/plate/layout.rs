//! The contents of a file: models at their relative positions, grouped into bodies.

use geo::{BoundingRect, ConvexHull, Distance, Euclidean, LineString, MultiPoint, Polygon};

use super::orient::orient;
use super::slivers::{Line, printable_bounds};
use crate::mesh::{Mesh, SavedSettings, Transform, TransformError};
use geometry::DisjointSets;

/// Models nearer than this touch, millimetres: rounding of a file's coordinates.
const TOUCH_MM: f64 = 0.01;

/// A model, as often as its file has it.
#[derive(Clone, Debug)]
pub struct Item {
    /// What messages and G-code call it.
    pub name: String,
    /// The model in its file's coordinates.
    pub mesh: Mesh,
    /// Where its origin goes: once, or several times, millimetres.
    pub positions: Vec<[f64; 3]>,
    /// The tool that its file has for it, from 1.
    pub tool: Option<u32>,
    /// The settings that its file has for it.
    pub saved: SavedSettings,
    /// The box that it is placed by.
    pub(super) bounds: [[f64; 3]; 2],
    /// Number of its layout among those that were joined, and its own there.
    pub(super) origin: [usize; 2],
}

impl Item {
    /// A model that is placed by the box around it.
    pub fn new(name: impl Into<String>, mesh: Mesh, positions: Vec<[f64; 3]>) -> Self {
        let bounds = mesh.bounds();
        Self {
            name: name.into(),
            mesh,
            positions,
            tool: None,
            saved: SavedSettings::default(),
            bounds,
            origin: [0; 2],
        }
    }

    /// The same item, placed by the box around its parts that are thick enough for a line. O(triangles).
    #[must_use]
    pub fn without_slivers(mut self, line: Line) -> Self {
        self.bounds = printable_bounds(&self.mesh, line);
        self
    }

    /// Middle of the box in X and Y, and its bottom, of the item in one of its positions.
    pub(super) fn foot(&self, position: usize) -> [f64; 3] {
        let [min, max] = self.bounds;
        let at = [(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0, min[2]];
        [0, 1, 2].map(|i| at[i] + self.positions[position][i])
    }

    /// Extents of the box.
    pub(super) fn size(&self) -> [f64; 3] {
        let [min, max] = self.bounds;
        [0, 1, 2].map(|i| max[i] - min[i])
    }
}

/// An item in one of its positions: index of the item, and of the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Member {
    pub item: usize,
    pub position: usize,
}

/// The models of a file, at their positions relative to each other.
///
/// Models that interlock (their convex hulls seen from above meet, and so do their heights) are one body: they are only
/// ever moved together.
#[derive(Clone, Debug)]
pub struct Layout {
    pub(super) name: String,
    pub(super) items: Vec<Item>,
    pub(super) copies: usize,
    pub(super) bodies: Vec<Vec<Member>>,
    /// The column of each body: bodies that stand over one another are one column, lowered onto the bed together.
    pub(super) columns: Vec<usize>,
    /// Whether bodies keep their places relative to each other where that is possible.
    pub(super) kept: bool,
    /// Where it stands, if that is decided: the middle of its box, seen from above, and its lowest point.
    pub(super) at_mm: Option<[f64; 3]>,
}

impl Layout {
    /// The models of a file, as many times as is wanted. `name` is what messages call the file.
    pub fn new(name: impl Into<String>, items: Vec<Item>, copies: usize) -> Self {
        let members: Vec<Member> = (0..items.len())
            .flat_map(|item| (0..items[item].positions.len()).map(move |position| Member { item, position }))
            .collect();
        let (bodies, columns) = match members.len() {
            1 => (vec![members], vec![0]),
            _ => bodies(&items, &members),
        };
        Self { name: name.into(), items, copies, bodies, columns, kept: true, at_mm: None }
    }

    /// One model alone.
    pub fn single(name: impl Into<String>, mesh: Mesh, copies: usize) -> Self {
        let name = name.into();
        Self::new(name.clone(), vec![Item::new(name, mesh, vec![[0.0; 3]])], copies)
    }

    /// Several files as if they were one, each model once for each of its positions.
    pub(super) fn joined(layouts: Vec<Layout>) -> Self {
        let name = layouts.first().map_or(String::new(), |layout| layout.name.clone());
        Self::new(name, layouts.into_iter().flat_map(|layout| layout.items).collect(), 1)
    }

    /// Lets every item know which layout it is of, and which item there.
    pub(super) fn number(layouts: &mut [Layout]) {
        for (model, layout) in layouts.iter_mut().enumerate() {
            let items = layout.items.iter_mut().enumerate();
            items.for_each(|(number, item)| item.origin = [model, number]);
        }
    }

    /// The same, standing somewhere on the bed: the middle of its box, seen from above, and its lowest point in the bed's
    /// coordinates, millimetres.
    #[must_use]
    pub fn standing_at(mut self, at_mm: [f64; 3]) -> Self {
        self.at_mm = Some(at_mm);
        self
    }

    /// The models.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// How many of it are wanted.
    pub fn copies(&self) -> usize {
        self.copies
    }

    /// How many objects it puts on the plate.
    pub fn object_count(&self) -> usize {
        self.copies * self.items.iter().map(|item| item.positions.len()).sum::<usize>()
    }

    /// How many bodies one copy of it has.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Turns every body of one model alone onto the side that needs the least support; the bodies lose their places.
    /// Bodies of several models stay as they are.
    #[must_use]
    pub fn oriented(mut self) -> Self {
        let alone: Vec<bool> = (0..self.items.len())
            .map(|item| self.bodies.iter().all(|body| body.len() == 1 || body.iter().all(|m| m.item != item)))
            .collect();
        for (item, _) in self.items.iter_mut().zip(&alone).filter(|(_, alone)| **alone) {
            let sliver = item.bounds != item.mesh.bounds();
            item.mesh = orient(std::mem::replace(&mut item.mesh, Mesh::new(Vec::new(), Vec::new())));
            if !sliver {
                item.bounds = item.mesh.bounds();
            }
        }
        self.kept &= !alone.contains(&true);
        self
    }

    /// The same, scaled.
    ///
    /// # Errors
    /// A factor that leaves nothing.
    pub fn scaled(mut self, factor: f64) -> Result<Self, TransformError> {
        let transform = Transform { scale: [factor; 3], ..Transform::default() };
        for item in &mut self.items {
            let mesh = std::mem::replace(&mut item.mesh, Mesh::new(Vec::new(), Vec::new()));
            item.mesh = transform.apply(mesh)?;
            item.bounds = item.bounds.map(|corner| corner.map(|x| x * factor));
            item.positions.iter_mut().for_each(|position| *position = position.map(|x| x * factor));
        }
        Ok(self)
    }
}

/// The bodies, in the order of their first members, and for each the number of its column: bodies that stand over one
/// another are in one column.
fn bodies(items: &[Item], members: &[Member]) -> (Vec<Vec<Member>>, Vec<usize>) {
    let hulls: Vec<Polygon<f64>> =
        members.iter().map(|&member| hull(&items[member.item], member.position)).collect();
    let boxes: Vec<_> = hulls.iter().map(BoundingRect::bounding_rect).collect();
    let heights = members.iter().map(|&Member { item, position }| {
        let item = &items[item];
        let low = item.foot(position)[2];
        [low, low + item.size()[2]]
    });
    let heights: Vec<[f64; 2]> = heights.collect();
    let near = |low: [f64; 2], high: [f64; 2]| low[0] <= high[1] + TOUCH_MM && high[0] <= low[1] + TOUCH_MM;
    let (mut joined, mut over) = (DisjointSets::new(members.len()), DisjointSets::new(members.len()));
    for i in 0..members.len() {
        for j in 0..i {
            let (Some(a), Some(b)) = (&boxes[i], &boxes[j]) else { continue };
            let boxes_meet = near([a.min().x, a.max().x], [b.min().x, b.max().x])
                && near([a.min().y, a.max().y], [b.min().y, b.max().y]);
            if boxes_meet && Euclidean.distance(&hulls[i], &hulls[j]) <= TOUCH_MM {
                over.join(i as u32, j as u32);
                if near(heights[i], heights[j]) {
                    joined.join(i as u32, j as u32);
                }
            }
        }
    }
    let (body_of, count) = joined.number();
    let mut bodies = vec![Vec::new(); count];
    let mut columns = vec![0; count];
    for (index, &member) in members.iter().enumerate() {
        bodies[body_of[index] as usize].push(member);
        columns[body_of[index] as usize] = over.find(index as u32) as usize;
    }
    (bodies, columns)
}

/// The convex hull of an item in one of its positions, seen from above.
pub(super) fn hull(item: &Item, position: usize) -> Polygon<f64> {
    let [dx, dy, _] = item.positions[position];
    let points: MultiPoint<f64> = item.mesh.vertices().iter().map(|v| (v[0] + dx, v[1] + dy)).collect();
    match points.0.is_empty() {
        true => Polygon::new(LineString::new(Vec::new()), Vec::new()),
        false => points.convex_hull(),
    }
}
