//! What can be chosen.

/// An enum whose variants stand beside their names.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $text:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum $name {
            $($(#[$vdoc])* #[cfg_attr(feature = "serde", serde(rename = $text))] $variant,)*
        }

        impl $name {
            /// Every value with its name.
            pub const ALL: &'static [(&'static str, $name)] = &[$(($text, $name::$variant),)*];

            /// The names alone.
            pub const NAMES: &'static [&'static str] = &[$($text,)*];

            /// Its name.
            pub fn name(self) -> &'static str {
                Self::NAMES[self as usize]
            }
        }
    };
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
