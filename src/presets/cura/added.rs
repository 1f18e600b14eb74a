//! Machines that a user has added to Cura: a stack of containers for the machine, and one for each of its extruders.

use super::instance::Instance;

/// What a container is in a stack, counted from its bottom or its top; intents came later, beneath the changes of a quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Definition,
    DefinitionChanges,
    Nozzle,
    Material,
    Quality,
    Intent,
    QualityChanges,
    User,
}

/// How many containers a stack has that knows intents.
const WITH_INTENT: usize = 8;

/// A machine that a user has added, with one of its extruders.
#[derive(Clone, Copy, Debug)]
pub(super) struct Added<'a> {
    pub machine: &'a Instance,
    pub extruder: Option<&'a Instance>,
}

impl<'a> Added<'a> {
    /// Those among stacks, in the order of their files. A group of machines in a network has one that is shown.
    pub fn all(stacks: &'a [Instance]) -> impl Iterator<Item = Self> {
        let machines = stacks.iter().filter(|stack| stack.about("type") == "machine");
        let shown = machines.filter(|stack| stack.about("hidden") != "True");
        shown.map(|machine| Self { machine, extruder: None }.of_extruder(stacks, 0))
    }

    /// The same with another extruder, counted from 0.
    pub fn of_extruder(self, stacks: &'a [Instance], extruder: usize) -> Self {
        let is_wanted = |stack: &&Instance| {
            stack.about("type") == "extruder_train"
                && stack.about("machine") == self.machine.id
                && stack.about("position") == extruder.to_string()
        };
        Self { extruder: stacks.iter().find(is_wanted), ..self }
    }

    /// The containers at a place of the machine's stack and then of its extruder's, by their ids.
    pub fn at(self, slot: Slot) -> impl Iterator<Item = &'a str> {
        let stacks = [Some(self.machine), self.extruder];
        stacks.into_iter().flatten().filter_map(move |stack| {
            let all = &stack.containers;
            let place = match slot {
                Slot::User => 0,
                Slot::QualityChanges => 1,
                Slot::Intent if all.len() < WITH_INTENT => return None,
                Slot::Intent => 2,
                Slot::Quality => all.len().checked_sub(5)?,
                Slot::Material => all.len().checked_sub(4)?,
                Slot::Nozzle => all.len().checked_sub(3)?,
                Slot::DefinitionChanges => all.len().checked_sub(2)?,
                Slot::Definition => all.len().checked_sub(1)?,
            };
            all.get(place).map(String::as_str)
        })
    }
}
