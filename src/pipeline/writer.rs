//! Finished layers on their way out: scripts put in, checked, added up and written.

use std::ops::Range;

use crate::estimate::Machine;
use crate::gcode::{self, LayerText, Pending, Slot};
use crate::job::JobError;
use crate::motion::{LayerMoves, ToolChange};
use crate::output::Output;
use crate::parallel::Workers;
use crate::profile::{ScriptRun, Settings};
use crate::units::Seconds;

use super::finished::{FinishedLayer, LayerEntry};
use super::inspect::Inspector;
use super::kept::PrintLayer;
use super::preheat::{Heat, Heating, Preheater};
use super::statistics::Statistics;

/// Takes the moves of a finished layer.
pub(super) type OnMoves<'a> = dyn FnMut(LayerMoves) + Send + 'a;

/// What is put into the text of a layer.
#[derive(Clone, Copy)]
enum Spliced<'a> {
    /// A script, with its key.
    Script(&'a str, &'a str),
    /// What is run at a change of tool.
    Change(ToolChange),
    /// A tool is heated, whose turn comes.
    Heat(Heat),
    /// A tool whose turn comes soon does not cool down.
    KeptHot,
}

/// Writes finished layers, checks the text and adds up the statistics.
pub(super) struct PrintWriter<'a> {
    pub output: &'a mut Output,
    pub inspector: Inspector,
    /// What is known at the end only.
    pub slots: Vec<Slot>,
    pub statistics: Statistics,
    pub kept: Option<&'a mut Vec<PrintLayer>>,
    pub moves: Option<Box<OnMoves<'a>>>,
    pub scripts: ScriptRun<'a>,
    pub settings: &'a Settings,
    pub machine: Machine,
    pub workers: Workers<'a>,
    pub preheater: Preheater,
}

impl PrintWriter<'_> {
    /// Writes the script between objects that are printed one after the other.
    pub fn between_objects(&mut self, finished: usize) -> Result<(), JobError> {
        self.scripts.moment.objects_done = finished;
        if finished > 0 {
            let script = &self.settings.gcode.between_objects;
            let text = self.scripts.expand(script).map_err(|e| of_script("gcode.between_objects", &e))?;
            self.output.write(text.as_bytes())?;
        }
        Ok(())
    }

    /// The text of a layer with the scripts of its change, and how long those of tools take beyond what is planned.
    pub fn with_scripts(
        &mut self,
        layer: &LayerText,
        entry: &LayerEntry,
        heating: &Heating,
    ) -> Result<Option<(Vec<u8>, Seconds)>, JobError> {
        let options = &self.settings.gcode;
        let moment = &mut self.scripts.moment;
        moment.layer = Some(entry.index);
        moment.layer_z_mm = entry.z_mm - self.settings.layer.z_offset.0;
        moment.max_z_mm = moment.max_z_mm.max(moment.layer_z_mm);
        moment.extruded_mm3 = self.statistics.layers_mm3;
        moment.by_tool_mm3.clone_from(&self.statistics.tools_mm3);
        moment.position_mm = entry.position_mm;
        let layer_places = [
            (layer.before, "gcode.before_layer", &options.before_layer),
            (layer.after, "gcode.after_layer", &options.after_layer),
        ];
        let places = layer_places.into_iter().filter_map(|(place, key, script)| {
            place.map(|place| (place..place, Spliced::Script(key, script)))
        });
        let changes = layer.changes.iter().map(|mark| (mark.line.clone(), Spliced::Change(mark.change)));
        let heats = heating.heats.iter().map(|heat| (heat.place..heat.place, Spliced::Heat(*heat)));
        let kept_hot = heating.kept_hot.iter().map(|line| (line.clone(), Spliced::KeptHot));
        let mut places: Vec<(Range<usize>, Spliced<'_>)> =
            places.chain(changes).chain(heats).chain(kept_hot).collect();
        if places.is_empty() {
            return Ok(None);
        }
        // A script of the layer comes before a change at the same place.
        places.sort_by_key(|(place, _)| place.start);
        let (mut text, mut from) = (Vec::with_capacity(layer.bytes.len() + 256), 0);
        let mut more = Seconds(0.0);
        for (place, spliced) in places {
            text.extend_from_slice(&layer.bytes[from..place.start]);
            let script = match spliced {
                Spliced::Script(key, script) => {
                    self.scripts.expand(script).map_err(|e| of_script(key, &e))?
                }
                Spliced::KeptHot => String::new(),
                Spliced::Heat(Heat { tool, nozzle, .. }) => gcode::preheating(tool, nozzle),
                Spliced::Change(change) => {
                    self.scripts.moment.position_mm = change.at_mm;
                    let script = self.scripts.change(change.to.into());
                    let script = script.map_err(|mistake| script_error(vec![mistake]))?;
                    more += gcode::script_time(
                        &script,
                        change.at_mm,
                        self.settings.gcode.relative_e,
                        &self.machine,
                    );
                    script
                }
            };
            text.extend_from_slice(script.as_bytes());
            from = place.end;
        }
        text.extend_from_slice(&layer.bytes[from..]);
        Ok(Some((text, more)))
    }

    /// Writes text, checking it.
    pub fn write(&mut self, text: &[u8]) -> Result<(), JobError> {
        self.inspector.take(text);
        Ok(self.output.write(text)?)
    }

    /// Takes layers, and writes those that are complete.
    pub fn add(&mut self, layers: Vec<FinishedLayer>) -> Result<(), JobError> {
        for layer in layers {
            self.preheater.take(layer);
            while let Some((layer, heating)) = self.preheater.ready(false) {
                self.write_layer(layer, &heating)?;
            }
        }
        Ok(())
    }

    /// Writes the layers that are left.
    pub fn finish(&mut self) -> Result<(), JobError> {
        while let Some((layer, heating)) = self.preheater.ready(true) {
            self.write_layer(layer, &heating)?;
        }
        Ok(())
    }

    /// Writes a layer, checking it.
    fn write_layer(&mut self, layer: FinishedLayer, heating: &Heating) -> Result<(), JobError> {
        let FinishedLayer { text, mut summary, layer, moves, entry, tools, .. } = layer;
        self.workers.go_on();
        let base = self.output.written() as usize;
        let value = Pending::Progress { layer: self.statistics.part_starts.len() };
        self.slots.extend(text.progress.map(|slot| Slot { offset: base + slot.offset, value, ..slot }));
        let with_scripts = self.with_scripts(&text, &entry, heating)?;
        // What a script does is its own affair, and undone after it.
        self.inspector.layer(entry.index, &text.bytes, moves.as_ref());
        if let Some((_, more)) = &with_scripts {
            summary.measures.total_s += more.0;
        }
        self.output.write(with_scripts.as_ref().map_or(&text.bytes, |(text, _)| text))?;
        self.statistics.add(entry.index, summary, &tools);
        if let Some(kept) = &mut self.kept {
            kept.extend(layer);
        }
        if let (Some(tell), Some(moves)) = (&mut self.moves, moves) {
            tell(moves);
        }
        self.workers.observer.layer_done();
        Ok(())
    }
}

pub(super) fn script_error(mistakes: Vec<String>) -> JobError {
    JobError::Script { mistakes }
}

pub(super) fn of_script(key: &str, mistake: &macros::Error) -> JobError {
    script_error(vec![format!("{key}: {mistake}")])
}
