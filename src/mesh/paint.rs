//! What users paint on a surface: which tool prints it, where seams go, and where support stands.

/// A part of a facet with what was painted on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintedFacet<T> {
    /// Its corners in millimetres, in the coordinates of the mesh.
    pub corners: [[f64; 3]; 3],
    /// What was painted.
    pub paint: T,
}

/// Whether something is wanted at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Wish {
    /// It is to be here.
    Enforced,
    /// It is not.
    Blocked,
}

/// All that is painted on a surface. It lies in space by itself, so that repairs of the mesh do not touch it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paint {
    /// The tools that print parts of the surface, counted from 1.
    pub tools: Vec<PaintedFacet<u8>>,
    /// Where seams are wanted.
    pub seams: Vec<PaintedFacet<Wish>>,
    /// Where support is wanted.
    pub supports: Vec<PaintedFacet<Wish>>,
}

impl Paint {
    /// Whether nothing is painted.
    pub fn is_empty(&self) -> bool {
        self.tools.is_empty() && self.seams.is_empty() && self.supports.is_empty()
    }

    /// Moves every corner.
    pub(super) fn moved(&mut self, to: impl Fn([f64; 3]) -> [f64; 3]) {
        let all = self.tools.iter_mut().map(|facet| &mut facet.corners);
        let all = all.chain(self.seams.iter_mut().map(|facet| &mut facet.corners));
        let all = all.chain(self.supports.iter_mut().map(|facet| &mut facet.corners));
        all.flatten().for_each(|corner| *corner = to(*corner));
    }

    /// Adds what is painted elsewhere, moved.
    pub(super) fn add(&mut self, other: &Self, to: impl Fn([f64; 3]) -> [f64; 3]) {
        let mut other = other.clone();
        other.moved(to);
        self.tools.append(&mut other.tools);
        self.seams.append(&mut other.seams);
        self.supports.append(&mut other.supports);
    }
}
