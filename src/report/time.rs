//! How long a file takes: the answer of `pathwright time`.

use std::fmt;

use serde::{Serialize, Serializer};

use super::summary::duration;
use crate::estimate::Firmware;
use crate::gcode::Timetable;

/// Seconds by name, in order. JSON has them as an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seconds(pub Vec<(&'static str, f64)>);

impl Serialize for Seconds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

/// The time of one file. `Display` gives the text for people, `Serialize` the JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrintTime {
    /// As named on the command line.
    pub file: String,
    /// The firmware whose rules were used.
    pub machine: &'static str,
    /// Total time, without what is left out.
    pub total_s: f64,
    /// Commands whose duration is unknown.
    pub left_out: [&'static str; 3],
    /// Before the first layer: the start script's moves.
    pub before_s: f64,
    /// Time by activity: travel, retraction (all moves of filament in place), waits, changes of tool, and each role.
    pub by_role: Seconds,
    /// Number of layers.
    pub layer_count: usize,
    /// Each layer, from the bed up.
    pub layers: Vec<LayerTime>,
}

/// The time of one layer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayerTime {
    /// Height of its beads.
    pub z_mm: f64,
    /// All of it.
    pub total_s: f64,
    /// What it is spent on.
    pub by_role: Seconds,
}

impl PrintTime {
    /// The report on a file.
    pub fn new(file: String, firmware: Firmware, times: &Timetable) -> Self {
        let layers = (0..times.layers()).map(|index| {
            let (z_mm, total_s, roles) = times.layer(index);
            LayerTime { z_mm: (z_mm * 1e6).round() / 1e6, total_s, by_role: Seconds(roles) }
        });
        Self {
            file,
            machine: firmware.name(),
            total_s: times.total_s(),
            left_out: ["heating up", "homing", "pauses"],
            before_s: times.before_s(),
            by_role: Seconds(times.roles()),
            layer_count: times.layers(),
            layers: layers.collect(),
        }
    }
}

impl fmt::Display for PrintTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.file)?;
        let left_out = self.left_out.join(", ");
        writeln!(f, "  time      {} on {} (without {left_out})", duration(self.total_s), self.machine)?;
        for (name, seconds) in &self.by_role.0 {
            let share = 100.0 * seconds / self.total_s.max(f64::MIN_POSITIVE);
            writeln!(f, "    {name:<28} {seconds:>9.1} s {share:>5.1} %")?;
        }
        let slowest = self.layers.iter().map(|layer| layer.total_s).fold(0.0, f64::max);
        let quickest = self.layers.iter().map(|layer| layer.total_s).fold(f64::INFINITY, f64::min);
        match self.layer_count {
            0 => writeln!(f, "  layers    none"),
            count => writeln!(f, "  layers    {count}, of {quickest:.1} to {slowest:.1} s"),
        }
    }
}
