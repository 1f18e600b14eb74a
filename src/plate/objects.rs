//! What stands on the bed.

use crate::mesh::Mesh;
use geometry::Point;

/// One model on the plate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Object {
    /// The item's name; copies are numbered, `part (2)`.
    pub name: String,
    /// Index into [`Plate::meshes`].
    pub mesh: usize,
    /// Where the mesh's origin stands on the bed.
    pub offset: Point,
    /// Number of the body that it is a part of: objects that interlock are one.
    pub body: usize,
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
