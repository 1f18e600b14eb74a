//! What lasts from one script to the next.

use std::collections::BTreeMap;

use crate::Value;

/// What lasts from one script to the next: global variables, random numbers, what was written.
///
/// ```
/// use std::collections::BTreeMap;
/// use pathwright_macros::{State, expand};
///
/// let names = BTreeMap::new();
/// let mut state = State::default();
/// expand("{global layers = 0}", &names, &mut state)?;
/// for _ in 0..3 {
///     expand("{layers = layers + 1}", &names, &mut state)?;
/// }
/// assert_eq!(expand("{layers}", &names, &mut state)?, "3");
/// # Ok::<(), pathwright_macros::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct State {
    globals: BTreeMap<String, Value>,
    /// How many bytes they take.
    size: usize,
    pub(crate) written: BTreeMap<String, Value>,
    pub(crate) random: Random,
}

impl State {
    /// The same seed gives the same random numbers.
    pub fn new(seed: u64) -> Self {
        Self { globals: BTreeMap::new(), size: 0, written: BTreeMap::new(), random: Random(seed) }
    }

    /// What the last script assigned to placeholders that it may write.
    pub fn written(&self) -> &BTreeMap<String, Value> {
        &self.written
    }

    /// The global variables.
    pub fn globals(&self) -> &BTreeMap<String, Value> {
        &self.globals
    }
}

impl State {
    /// Sets a global variable, if they do not take more than so many bytes then.
    pub(crate) fn set_global(&mut self, name: &str, value: Value, most: usize) -> bool {
        let old = self.globals.get(name).map_or(0, |old| name.len() + old.size());
        let size = self.size - old + name.len() + value.size();
        let fits = size <= most;
        if fits {
            self.size = size;
            self.globals.insert(name.to_owned(), value);
        }
        fits
    }
}

impl Default for State {
    fn default() -> Self {
        Self::new(0)
    }
}

/// SplitMix64 (Steele, Lea & Flood 2014, <https://doi.org/10.1145/2660193.2660195>).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number from the first to the last, which must not be less.
    pub fn integer(&mut self, first: i64, last: i64) -> i64 {
        let count = last.abs_diff(first) as u128 + 1;
        let step = (u128::from(self.bits()) * count) >> 64;
        first.wrapping_add(step as i64)
    }

    /// A number from the first to below the last.
    pub fn real(&mut self, first: f64, last: f64) -> f64 {
        let share = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        first + (last - first) * share
    }
}
