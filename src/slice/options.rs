//! Layer heights and where the sections lie.

use crate::options::section;
use crate::units::{Mm, Ratio};

section! {
    /// `[layer]`: heights and where the sections lie.
    LayerSettings {
        /// Height of the layers from the second on.
        height: Mm = Mm(0.2); 0.01..=2.0,
        /// Height of the first layer.
        first_height: Mm = Mm(0.2); 0.01..=2.0,
        /// Heights follow the surface, thinner where it is nearly level; `height` then applies to rafts only.
        adaptive: bool = false,
        /// How fine adaptive heights are: at 0 all are `max_height`, at 1 nearly level surfaces get `min_height`.
        quality: Ratio = Ratio(0.5); 0.0..=1.0,
        /// Least height of an adaptive layer.
        min_height: Mm = Mm(0.08); 0.01..=2.0,
        /// Greatest height of an adaptive layer.
        max_height: Mm = Mm(0.28); 0.01..=2.0,
        /// Heights by height over the bed, such as `0:0.2, 10:0.1` for layers of 0.1 mm from 10 mm on; empty: `height` throughout.
        heights: String = String::new(),
        /// Added to every Z in the G-code.
        z_offset: Mm = Mm(0.0); -5.0..=5.0,
        /// Sections grow (+) or shrink (−) by this on every side.
        xy_compensation: Mm = Mm(0.0); -2.0..=2.0,
        /// The first layer shrinks by this on every side (elephant foot).
        elephant_foot: Mm = Mm(0.0); 0.0..=2.0,
        /// Gaps between bodies that are narrower than twice this are closed, so that they become one.
        closing_radius: Mm = Mm(0.02); 0.0..=0.5,
        /// Vertices that move the outline less than this are dropped.
        resolution: Mm = Mm(0.0125); 0.0..=0.5,
    }
}
