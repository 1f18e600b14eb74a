//! What stands on the bed.

use crate::mesh::Mesh;
use geometry::Point;

/// One model on the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The item's name; copies are numbered, `part (2)`.
    pub name: String,
    /// Index into [`Plate::meshes`].
    pub mesh: usize,
    /// Where the mesh's origin stands on the bed.
    pub offset: Point,
    /// Number of the body that it is a part of: objects that interlock are one.
    pub body: usize,
    /// Number of the layout that it is from.
    pub model: usize,
    /// Number of its item in that layout.
    pub item: usize,
    /// Which copy of the layout it is of, from 0.
    pub copy: usize,
    /// Quarter turns about Z that its arrangement gave it.
    pub quarters: u32,
    /// Where the middle of its box, seen from above, and its lowest point are on the bed, millimetres. Parts too thin for
    /// a line do not count.
    pub at_mm: [f64; 3],
}

/// Everything that is printed in one go. Copies share a mesh, so that it is cut once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plate {
    /// Meshes, the middle of their box over the origin, standing on z = 0 or over other parts of their body.
    pub meshes: Vec<Mesh>,
    /// What stands where, in the order of the items.
    pub objects: Vec<Object>,
    /// Layouts that were not kept, in words.
    pub notes: Vec<String>,
}
