//! The moves of the machine.

use crate::toolpath::{Role, ToolId};
use crate::units::{Celsius, Mm3, MmPerS, MmPerS2, Ratio, Seconds};

/// One instruction. Positions are in bed coordinates (millimetres), speeds along the path.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Move {
    /// The role and bead of what follows; becomes `;TYPE:`, `;WIDTH:`, `;HEIGHT:` where they change.
    Bead { role: Role, width_mm: f64, height_mm: f64 },
    /// Move in X and Y without extruding.
    Travel { to: [f64; 2], speed: MmPerS },
    /// Move in X, Y and Z at once.
    Climb { to: [f64; 2], z_mm: f64, speed: MmPerS },
    /// Move to a height.
    Lift { z_mm: f64, speed: MmPerS },
    /// Extrude straight to a point.
    Extrude { to: [f64; 2], volume: Mm3, speed: MmPerS },
    /// Extrude straight to a point while changing height.
    Ramp { to: [f64; 2], z_mm: f64, volume: Mm3, speed: MmPerS },
    /// Extrude along an arc around a centre.
    Arc { to: [f64; 2], center: [f64; 2], clockwise: bool, volume: Mm3, speed: MmPerS },
    /// Retract filament (`length_mm` > 0) in place; with firmware retraction a plain G10.
    Retract { length_mm: f64, speed: MmPerS },
    /// Push it forward again.
    Unretract { length_mm: f64, speed: MmPerS },
    /// Move in X and Y while retracting.
    Wipe { to: [f64; 2], length_mm: f64, speed: MmPerS },
    /// Part-cooling fan.
    Fan(Ratio),
    /// Acceleration of what follows.
    Acceleration(MmPerS2),
    /// Nozzle temperature, without waiting.
    Nozzle(Celsius),
    /// Bed temperature, without waiting.
    Bed(Celsius),
    /// The object on the plate that the following moves belong to, or none; only with labels.
    Object(Option<u32>),
    /// A pause or filament change, by the profile's script.
    Pause,
    /// A change to filament of another color, by the profile's script.
    ColorChange,
    /// A change to another tool, by its script, and what heats it.
    ToolChange(Box<ToolChange>),
    /// What is done with the filament before and after a change.
    Swap(SwapStep),
}

/// A step of taking a filament out or putting it in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum SwapStep {
    /// Says which filament is put in, where none is.
    Take(ToolId),
    /// Moves filament in place: forward, or back where the length is less than 0.
    Filament { length_mm: f64, speed: MmPerS },
    /// Stands still.
    Wait(Seconds),
    /// Another pressure advance.
    PressureAdvance { tool: ToolId, seconds: f64 },
    /// Whether the filament sensor is heeded.
    Sensor(bool),
    /// Whether the motor of the extruder has a higher current than usual.
    HighCurrent(bool),
}

/// A change from one tool to another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ToolChange {
    pub from: ToolId,
    pub to: ToolId,
    /// Temperature of the one before while it printed.
    pub before: Celsius,
    /// Temperature of the new one.
    pub nozzle: Celsius,
    /// How long it takes.
    pub time: Seconds,
    /// How long is waited after that for the nozzle to be hot.
    pub wait: Seconds,
    /// Where the nozzle is: X and Y of the bead drawn last, and the height that it was lifted to.
    pub at_mm: [f64; 3],
}

/// Where the nozzle is when a layer begins, in bed coordinates (millimetres, Z offset included).
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct Entry {
    /// `None`: wherever the start script left it.
    pub xy: Option<[f64; 2]>,
    pub z_mm: f64,
    /// The wipe before leaving, from `xy` on; empty without one.
    pub wipe: Vec<[f64; 2]>,
    /// Filament that is pulled back already, by a script.
    pub retracted_mm: f64,
    /// The first travel keeps above this, as finished objects may obstruct it; 0: none do.
    pub over_mm: f64,
    /// The tool in use.
    pub tool: ToolId,
    /// The tools that were put away with their filament pulled back, a bit each.
    pub parked: u32,
}

/// The moves of one layer. It starts and ends un-retracted.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct LayerMoves {
    pub index: usize,
    /// Height of the nozzle, Z offset included.
    pub z_mm: f64,
    pub height_mm: f64,
    /// Where the layer below ended.
    pub from: Entry,
    pub moves: Vec<Move>,
}
