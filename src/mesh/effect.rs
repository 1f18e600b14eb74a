//! What bodies that are not printed themselves do to the mesh around them.

use std::collections::BTreeMap;

use super::paint::Wish;

/// What a body does to the mesh around it.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// It is cut out: nothing is printed there.
    Cut,
    /// Settings of its own hold there.
    Settings(SavedSettings),
    /// Support is wanted there, or not.
    Support(Wish),
}

/// Settings that another slicer has saved with an object, or with a part of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SavedSettings {
    /// The extruder, from 1.
    pub tool: Option<u32>,
    /// In whose words the others are.
    pub words: Words,
    /// The others, as written.
    pub entries: BTreeMap<String, String>,
}

/// Whose words a setting is written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Words {
    /// PrusaSlicer's.
    #[default]
    Prusa,
    /// Those of OrcaSlicer, Bambu Studio and their kin.
    Orca,
}
