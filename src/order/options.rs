//! How paths are ordered and where loops start.

use crate::options::{choice, section};
use crate::units::Mm;

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
    /// How the order of paths in a layer is found.
    OrderStrategy {
        /// As the toolpath stage made them.
        AsSliced = "as-sliced",
        /// Nearest reachable end next.
        Nearest = "nearest",
        /// Multi-fragment: shortest link first.
        Greedy = "greedy",
        /// The 2016 algorithm.
        Christofides = "christofides",
        /// Christofides with no return leg.
        ChristofidesOpen = "christofides-open",
        /// Local search, then iterated local search.
        Optimized = "optimized",
    }
}
choice! {
    /// How far ordering may mix paths.
    Scope {
        /// Anywhere in the layer.
        Layer = "layer",
        /// A run (one role in one island) is never interrupted; roles of an island in order.
        Feature = "feature",
        /// As `feature`, and all runs of an island are consecutive.
        Island = "island",
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
choice! {
    /// How long ordering may search.
    Effort {
        /// At most about 1 ms per 100 paths.
        Fast = "fast",
        /// The default.
        Normal = "normal",
        /// For the last percent.
        High = "high",
    }
}
section! {
    /// `[seam]`
    SeamSettings {
        /// The rule.
        position: SeamPosition = SeamPosition::Free,
        /// Loops end this much before they would close, so that the ends leave no blob.
        gap: Mm = Mm(0.05); 0.0..=2.0,
        /// Way on which the outermost wall rises from nothing at its start, and fades out on top of that; 0: none.
        scarf: Mm = Mm(0.0); 0.0..=100.0,
    }
}
section! {
    /// `[order]`
    OrderSettings {
        /// How the order is found.
        strategy: OrderStrategy = OrderStrategy::Optimized,
        /// How far paths may mix.
        scope: Scope = Scope::Feature,
        /// What is minimised.
        cost: CostKind = CostKind::Length,
        /// How long is searched.
        effort: Effort = Effort::Normal,
        /// Each layer starts where the last one ended.
        chain: bool = true,
        /// Least distance from the end of one layer to the start of the next; 0: none.
        layer_distance: Mm = Mm(0.0); 0.0..=1000.0,
    }
}
