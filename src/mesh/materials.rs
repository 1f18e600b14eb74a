//! What the parts of an object are made of, where a file says so.

use super::paint::PaintedFacet;

/// What an object and the facets of it are made of, as tools.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Materials {
    /// What the materials in use in the file are called, that of the first tool first.
    pub names: Vec<String>,
    /// The tool of the object, from 1.
    pub tool: Option<u32>,
    /// Facets of other materials, with their tools.
    pub facets: Vec<PaintedFacet<u8>>,
}
