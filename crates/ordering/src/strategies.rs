//! Every strategy, by name. Adding one is a file, a name in `options.rs` and a line here.

use super::options::OrderStrategy;
use super::strategy::Strategy;
use super::{AsSliced, Christofides, ChristofidesOpen, Greedy, Nearest, Optimized};

/// The strategy that a setting names.
pub fn strategy(name: OrderStrategy) -> &'static dyn Strategy {
    match name {
        OrderStrategy::AsSliced => &AsSliced,
        OrderStrategy::Nearest => &Nearest,
        OrderStrategy::Greedy => &Greedy,
        OrderStrategy::Christofides => &Christofides,
        OrderStrategy::ChristofidesOpen => &ChristofidesOpen,
        OrderStrategy::Optimized => &Optimized,
    }
}
