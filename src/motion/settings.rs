//! What the motion stage needs of the settings.

use super::PauseAt;
use super::SwapSettings;
use super::options::{
    AccelerationSettings, CoolingSettings, RetractSettings, RoleFlowSettings, SpeedSettings,
    TemperatureSettings, TravelSettings,
};
use crate::order::SeamSettings;
use crate::toolpath::{FirstLayerSettings, ToolId};
use crate::units::{Celsius, Mm, Mm3PerS, MmPerS, MmPerS2, Seconds};

/// How much is extruded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowSettings {
    /// Multiplier of everything.
    pub multiplier: f64,
    /// Cross-section of the filament, square millimetres.
    pub filament_area_mm2: f64,
    /// Largest flow the hot end melts; 0: not limited.
    pub max_flow: Mm3PerS,
}

/// The settings of [`plan_layer`](super::plan_layer).
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct MotionSettings {
    pub flow: FlowSettings,
    pub role_flow: RoleFlowSettings,
    pub first_layer: FirstLayerSettings,
    pub speed: SpeedSettings,
    pub acceleration: AccelerationSettings,
    /// What the firmware uses where `acceleration` says 0.
    pub firmware_acceleration: MmPerS2,
    /// Speed at which the machine takes a right-angled corner.
    pub square_corner_velocity: MmPerS,
    pub seam: SeamSettings,
    /// Loops that hang over run the other way round on every other layer.
    pub reverse_overhangs: bool,
    pub retract: RetractSettings,
    pub travel: TravelSettings,
    /// Width of the outermost wall.
    pub wall_width: Mm,
    pub cooling: CoolingSettings,
    pub temperature: TemperatureSettings,
    /// Added to every height.
    pub z_offset: Mm,
    /// Write arcs that leave the path by at most this.
    pub arcs: Option<Mm>,
    /// Say which object a bead belongs to.
    pub labels: bool,
    /// Where to stop for a filament change.
    pub pauses: Vec<PauseAt>,
    /// Where to change to filament of another color.
    pub color_changes: Vec<PauseAt>,
    /// The first layer states its temperatures, for the start script may leave them to a macro.
    pub heat_first_layer: bool,
    /// The settings of each tool, where there are several; they have none themselves.
    pub tools: Vec<MotionSettings>,
    /// How long it takes to change to this tool.
    pub change_time: Seconds,
    /// Filament that the start script leaves pulled back of this tool, where it is not the first, millimetres.
    pub left_back_mm: f64,
    /// Temperature while another tool prints, 0: as while this one does; and how quickly it is heated again, °C/s.
    pub idle: Celsius,
    /// See `idle`.
    pub heating_rate: f64,
    /// What a filament that is taken out goes through.
    pub swap: SwapSettings,
    /// Pressure advance, 0: the firmware's own; and whether it is stated again after a change.
    pub pressure_advance: f64,
    /// See `pressure_advance`.
    pub advance_returns: bool,
    /// A tool that is put away keeps its filament; that of a single nozzle is taken out.
    pub keeps_filament: bool,
}

impl MotionSettings {
    /// Whether a filament is taken out here, and not by a script.
    pub(crate) fn swaps(&self) -> bool {
        !self.keeps_filament && self.swap.parking.0 > 0.0
    }

    /// Whether any tool cools down while others print.
    pub(crate) fn cool_down(&self) -> bool {
        self.tools.iter().any(|tool| tool.idle.0 > 0.0)
    }

    /// The settings while a tool prints.
    pub fn of_tool(&self, tool: ToolId) -> &Self {
        self.tools.get(usize::from(tool)).unwrap_or(self)
    }

    /// How long it takes to heat this tool again from where it was left while others printed, seconds; 0: it has not cooled
    /// down, or how quickly it heats is not known.
    pub fn reheating_s(&self, nozzle: Celsius) -> f64 {
        if self.idle.0 > 0.0 { self.heating_s(self.idle, nozzle) } else { 0.0 }
    }

    /// How long it takes to heat a nozzle that all filaments share from the temperature of the one before, seconds.
    pub fn shared_heating_s(&self, before: Celsius, nozzle: Celsius) -> f64 {
        if self.keeps_filament { 0.0 } else { self.heating_s(before, nozzle) }
    }

    fn heating_s(&self, from: Celsius, to: Celsius) -> f64 {
        if self.heating_rate > 0.0 { (to.0 - from.0).max(0.0) / self.heating_rate } else { 0.0 }
    }
}
