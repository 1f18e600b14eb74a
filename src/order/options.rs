//! How paths are ordered and where loops start.

use crate::options::{FieldType, Kind, choice, section};
use crate::units::Mm;

pub use ordering::tools::ToolOrder;
pub use ordering::{Effort, OrderStrategy, Scope};

macro_rules! named {
    ($($name:ident)*) => {$(
        impl FieldType for $name {
            const KIND: Kind = Kind::Choice($name::NAMES);
        }
    )*};
}

named! { Effort OrderStrategy Scope ToolOrder }

choice! {
    /// Where loops start and end.
    SeamPosition {
        /// Anywhere: ordering decides.
        Free = "free",
        /// The first vertex as sliced.
        Pinned = "pinned",
        /// In line with the layer below, in a corner where there is one.
        Aligned = "aligned",
        /// The rearmost vertex.
        Rear = "rear",
        /// The vertex nearest to where the nozzle is.
        Nearest = "nearest",
        /// Another vertex on each layer.
        Random = "random",
    }
}
choice! {
    /// What ordering minimises.
    CostKind {
        /// Straight-line length of the links.
        Length = "length",
        /// Time of the travels, with retraction.
        Time = "time",
    }
}
section! {
    /// `[seam]`
    SeamSettings {
        /// Position of seams.
        position: SeamPosition = SeamPosition::Free,
        /// Loops end this far before they close, so that the ends leave no blob.
        gap: Mm = Mm(0.05); 0.0..=2.0,
        /// Scarf length: distance over which the outermost wall rises from nothing at its start, and fades out over itself; 0: none.
        scarf: Mm = Mm(0.0); 0.0..=100.0,
        /// Scarfs only where the wall goes on straight or in a curve: a seam in a corner is hidden there.
        scarf_smooth_only: bool = false,
    }
}
section! {
    /// `[order]`
    OrderSettings {
        /// Algorithm that finds the order.
        strategy: OrderStrategy = OrderStrategy::Optimized,
        /// How far paths may mix.
        scope: Scope = Scope::Feature,
        /// Cost that is minimised.
        cost: CostKind = CostKind::Time,
        /// Duration of the search.
        effort: Effort = Effort::Normal,
        /// Each layer starts where the last one ended.
        chain: bool = true,
        /// Least distance from the end of one layer to the start of the next; 0: none.
        layer_distance: Mm = Mm(0.0); 0.0..=1000.0,
    }
}
