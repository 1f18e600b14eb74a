//! A piece of a section.

use crate::toolpath::ToolId;
use geometry::Region;

/// A piece of a section that one tool prints with the same settings throughout.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    pub tool: ToolId,
    /// The number of its settings; `None`: those of its object.
    pub style: Option<usize>,
    pub region: Region,
}
