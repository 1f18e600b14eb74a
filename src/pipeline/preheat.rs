//! Tools that have cooled down are heated so long before their turn as it takes, in the layers before as well.

use std::collections::VecDeque;
use std::ops::Range;

use crate::gcode::ToolMark;
use crate::motion::MotionSettings;
use crate::toolpath::ToolId;
use crate::units::Celsius;

use super::finished::{FinishedLayer, Timeline};

/// A command to heat, to be put into the text of a layer.
#[derive(Clone, Copy)]
pub(super) struct Heat {
    pub place: usize,
    pub tool: ToolId,
    pub nozzle: Celsius,
}

/// What is put into the text of a layer, and which of its lines are left out: tools whose turn comes again before they would be hot
/// do not cool down.
#[derive(Default)]
pub(super) struct Heating {
    pub heats: Vec<Heat>,
    pub kept_hot: Vec<Range<usize>>,
}

/// A finished layer, with when it begins and what is heated in it.
struct Held {
    layer: FinishedLayer,
    begins_s: f64,
    heating: Heating,
}

/// When a tool was put away: from when on it cools down, when the change ended, and in which layer, counted from the first, and
/// where its line is that lets it cool.
#[derive(Clone)]
struct Left {
    left_s: f64,
    changed_s: f64,
    layer: usize,
    idle: Range<usize>,
}

/// Holds layers back for as long as tools of later ones may have to be heated in them.
pub(super) struct Preheater {
    /// The settings of each tool; empty: none cools down.
    tools: Vec<MotionSettings>,
    held: VecDeque<Held>,
    /// How long before the end of a change its tool may have to be heated.
    lead_s: f64,
    /// Where the print is.
    now_s: f64,
    /// Whether the script of a change waits for the tool before it takes it.
    waits_first: bool,
    /// Layers taken.
    taken: usize,
    /// When each tool was put away last, if it was in use before.
    left: Vec<Option<Left>>,
}

impl Preheater {
    pub fn new(settings: &MotionSettings, change_script: &str) -> Self {
        let cools = settings.cool_down();
        let tools = if cools { settings.tools.clone() } else { Vec::new() };
        let lead_s = |own: &MotionSettings| {
            let hottest = own.temperature.nozzle.0.max(own.temperature.nozzle_first_layer.0);
            own.reheating_s(Celsius(hottest)) + own.change_time.0
        };
        Self {
            lead_s: tools.iter().map(lead_s).fold(0.0, f64::max),
            waits_first: change_script.contains("M109"),
            taken: 0,
            left: vec![None; tools.len()],
            tools,
            held: VecDeque::new(),
            now_s: 0.0,
        }
    }

    /// Takes the next layer; what is waited for heat is added to its time.
    pub fn take(&mut self, mut layer: FinishedLayer) {
        let begins_s = self.now_s;
        let first_s = self.held.front().map_or(begins_s, |held| held.begins_s);
        // So many layers are written.
        let written = self.taken - self.held.len();
        let (mut heats, mut kept_hot) = (Vec::new(), Vec::new());
        if let Some(Timeline { ends_s, changes }) = &mut layer.timeline {
            for (ToolMark { change, idle, .. }, &index) in layer.text.changes.iter().zip(&*changes) {
                let end_s = begins_s + ends_s[index];
                let begin_s = end_s - change.time.0;
                let needed_s = if self.waits_first { begin_s } else { end_s };
                let heating_s = self.tools[usize::from(change.to)].reheating_s(change.nozzle);
                if heating_s > 0.0 {
                    // It is hot before the change begins, if it can be. A tool that was put away late has not cooled down all the
                    // way: no nozzle does so faster than it heats.
                    let left = self.left[usize::from(change.to)].as_ref();
                    let earliest_s = left.map_or(first_s, |left| {
                        f64::midpoint(left.left_s, needed_s).max(left.changed_s).max(first_s)
                    });
                    let start_s = (begin_s - heating_s).max(earliest_s);
                    let cooled_s = left.map_or(f64::INFINITY, |left| start_s - left.left_s);
                    let wait_s = (heating_s.min(cooled_s) - (needed_s - start_s)).max(0.0);
                    match left.filter(|left| wait_s > 0.0 && left.layer >= written) {
                        Some(left) => kept_hot.push((left.layer, left.idle.clone())),
                        None => {
                            ends_s[index..].iter_mut().for_each(|end_s| *end_s += wait_s);
                            layer.summary.measures.total_s += wait_s;
                            heats.push((start_s, needed_s, change.to, change.nozzle));
                        }
                    }
                }
                let (layer, idle) = (self.taken, idle.clone());
                let changed_s = begins_s + ends_s[index];
                self.left[usize::from(change.from)] = Some(Left { left_s: begin_s, changed_s, layer, idle });
            }
            self.now_s += ends_s.last().copied().unwrap_or(0.0);
        }
        self.held.push_back(Held { layer, begins_s, heating: Heating::default() });
        self.taken += 1;
        for (layer, idle) in kept_hot {
            self.held[layer - written].heating.kept_hot.push(idle);
        }
        for (start_s, needed_s, tool, nozzle) in heats {
            self.heat(start_s, needed_s, tool, nozzle);
        }
    }

    /// Heats a tool from a time on: after the last move that has ended then, and not within the change of other tools.
    fn heat(&mut self, start_s: f64, needed_s: f64, tool: ToolId, nozzle: Celsius) {
        let ended = |held: &Held| {
            let timeline = held.layer.timeline.as_ref()?;
            timeline.ends_s.partition_point(|end_s| held.begins_s + end_s <= start_s).checked_sub(1)
        };
        let last = self.held.iter().enumerate().rev().find_map(|(number, held)| Some((number, ended(held)?)));
        let (number, index) = last.unwrap_or_default();
        let Some(held) = self.held.get_mut(number) else { return };
        let Some(timeline) = &held.layer.timeline else { return };
        let Some((&at_s, &place)) = timeline.ends_s.get(index).zip(held.layer.text.ends.get(index)) else {
            return;
        };
        if held.begins_s + at_s < needed_s {
            held.heating.heats.push(Heat { place, tool, nozzle });
        }
    }

    /// The next layer into which nothing is put any more; at the `end` every one.
    pub fn ready(&mut self, end: bool) -> Option<(FinishedLayer, Heating)> {
        let next_s = self.held.get(1).map_or(self.now_s, |held| held.begins_s);
        if end || next_s <= self.now_s - self.lead_s {
            self.held.pop_front().map(|held| (held.layer, held.heating))
        } else {
            None
        }
    }
}
