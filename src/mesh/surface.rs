//! A surface of triangles.

use std::sync::Arc;

use geometry::real::{greater, lesser};

use super::edges::{Edges, NO_TWIN};
use super::effect::Effect;
use super::measure::facet_measures;
use super::paint::Paint;

/// A surface of triangles over shared vertices.
///
/// Corners run counter-clockwise seen from outside. Half-edge `3 t + k` runs from corner `k` of triangle `t` to the
/// next corner. Clones share everything but the vertices, and so do meshes that were moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) triangles: Arc<Vec<[u32; 3]>>,
    pub(super) twins: Arc<Vec<u32>>,
    pub(super) oriented: bool,
    pub(super) paint: Paint,
    pub(super) modifiers: Vec<Modifier>,
}

/// A body that changes what is inside of it of the mesh that it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct Modifier {
    /// As the file calls it, if it does.
    pub name: Option<String>,
    /// The body, in the coordinates of the mesh that it belongs to.
    pub mesh: Mesh,
    /// What it does.
    pub effect: Effect,
}

impl Mesh {
    /// A mesh from vertices (in millimetres) and triangles, taken as they are: nothing is repaired. O(triangles).
    ///
    /// # Panics
    /// If a triangle names a vertex that does not exist.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        let edges = Edges::new(&triangles, vertices.len());
        Self {
            vertices,
            triangles: triangles.into(),
            twins: edges.twins.into(),
            oriented: edges.matches.clashing == 0,
            paint: Paint::default(),
            modifiers: Vec::new(),
        }
    }

    /// Both meshes as one; facets keep their neighbours.
    #[must_use]
    pub fn with(mut self, other: &Self) -> Self {
        let (vertices, halves) = (self.vertices.len() as u32, self.twins.len() as u32);
        self.vertices.extend_from_slice(&other.vertices);
        Arc::make_mut(&mut self.triangles).extend(other.triangles.iter().map(|t| t.map(|v| v + vertices)));
        let moved = |&twin: &u32| if twin == NO_TWIN { NO_TWIN } else { twin + halves };
        Arc::make_mut(&mut self.twins).extend(other.twins.iter().map(moved));
        self.oriented &= other.oriented;
        self.paint.add(&other.paint, |corner| corner);
        self.modifiers.extend_from_slice(&other.modifiers);
        self
    }

    /// The mesh with something painted on it instead of what was.
    #[must_use]
    pub fn painted(mut self, paint: Paint) -> Self {
        self.paint = paint;
        self
    }

    /// What is painted on it.
    pub fn paint(&self) -> &Paint {
        &self.paint
    }

    /// The mesh with bodies that change what is inside of them, instead of those that it had.
    #[must_use]
    pub fn modified(mut self, modifiers: Vec<Modifier>) -> Self {
        self.modifiers = modifiers;
        self
    }

    /// Bodies that change what is inside of them, in the order in which they do.
    pub fn modifiers(&self) -> &[Modifier] {
        &self.modifiers
    }

    /// Vertices in millimetres.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Vertex indices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// For each half-edge its partner in the neighbouring triangle, or `u32::MAX` on an open edge.
    pub fn twins(&self) -> &[u32] {
        &self.twins
    }

    /// Whether it is the same mesh, of one reading, in the same place.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        let shared = Arc::ptr_eq(&self.triangles, &other.triangles) && Arc::ptr_eq(&self.twins, &other.twins);
        shared
            && self.oriented == other.oriented
            && self.vertices == other.vertices
            && self.paint == other.paint
            && self.modifiers == other.modifiers
    }

    /// Moves every vertex; facets keep their neighbours.
    pub(crate) fn moved(&mut self, to: impl Fn([f64; 3]) -> [f64; 3]) {
        self.vertices.iter_mut().for_each(|vertex| *vertex = to(*vertex));
        let bodies = self.modifiers.iter_mut().flat_map(|modifier| &mut modifier.mesh.vertices);
        bodies.for_each(|vertex| *vertex = to(*vertex));
        self.paint.moved(to);
    }

    /// Whether neighbouring triangles agree on which side is outside. If not, a point is inside where a ray from it
    /// crosses the surface an odd number of times.
    pub fn is_oriented(&self) -> bool {
        self.oriented
    }

    /// Whether every edge has a facet on either side.
    pub(crate) fn is_closed(&self) -> bool {
        !self.twins.contains(&NO_TWIN)
    }

    /// Smallest box around the vertices, as its lower and upper corner; zeros of an empty mesh.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let Some(&first) = self.vertices.first() else {
            return [[0.0; 3]; 2];
        };
        let [mut min, mut max] = [first; 2];
        for &[x, y, z] in &self.vertices {
            min = [lesser(min[0], x), lesser(min[1], y), lesser(min[2], z)];
            max = [greater(max[0], x), greater(max[1], y), greater(max[2], z)];
        }
        [min, max]
    }

    /// Extent along each axis in millimetres.
    pub fn size(&self) -> [f64; 3] {
        let [min, max] = self.bounds();
        std::array::from_fn(|i| max[i] - min[i])
    }

    /// Enclosed volume (mm³) and surface (mm²). Of an open mesh the volume is an estimate: that of the cone from the
    /// middle of its box.
    pub fn volume_and_area(&self) -> (f64, f64) {
        let [min, max] = self.bounds();
        let middle = std::array::from_fn(|i| (min[i] + max[i]) / 2.0);
        self.triangles.iter().fold((0.0, 0.0), |(volume, area), t| {
            let (v, a) = facet_measures(t.map(|v| self.vertices[v as usize]), middle);
            (volume + v, area + a)
        })
    }
}
