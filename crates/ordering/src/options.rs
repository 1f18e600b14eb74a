//! What can be chosen.

/// An enum whose variants stand beside their names. (Pathwright makes its own options by it.)
#[doc(hidden)]
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident { $($(#[$vmeta:meta])* $variant:ident = $text:literal,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$vmeta])* $variant,)* }

        impl $name {
            /// Every value with its name, as profiles and command lines have it.
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

/// The one of these values that has a name; if there is none, the message for the user. `what` they are, such as `strategy`.
pub fn chosen<T: Copy>(all: &[(&str, T)], what: &str, name: &str) -> Result<T, String> {
    let known = all.iter().find(|(known, _)| *known == name);
    known.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        format!("there is no {what} `{name}`; there are: {}", names.join(", "))
    })
}

choice! {
    /// How the order of paths in a layer is found.
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
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
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
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
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    #[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
    Effort {
        /// At most about 1 ms per 100 paths.
        Fast = "fast",
        /// The default.
        Normal = "normal",
        /// For the last percent.
        High = "high",
    }
}
