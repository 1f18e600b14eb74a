//! What each stage needs of all settings.

use super::settings::Settings;
use crate::estimate::{Firmware, FirmwareRetraction, Machine};
use crate::gcode::{
    BEFORE_LAYER_CHANGE, Flavor, GcodeOptions, LayerScripts, PrinterSettings, Scripts, ToolOptions,
    ToolWriter, WriterSettings, sets_pressure_advance,
};
use crate::motion::{FlowSettings, MotionSettings, PauseAt};
use crate::order::{Corners, CostKind, OrderStrategy, SeamPosition, SeamSettings};
use crate::plate::Line;
use crate::toolpath::{ToolId, ToolpathSettings, bead};
use crate::units::Celsius;
use ordering::{Cost, DetourRule, TravelTime, trapezoid_s};

impl Line {
    /// The thinnest line that is printed with these settings.
    pub fn thinnest(settings: &Settings) -> Self {
        let height_mm = settings.layer.first_height.0.min(settings.layer.height.0);
        Self { width_mm: settings.walls.min_feature.0, height_mm }
    }
}

impl From<&Settings> for ToolpathSettings {
    fn from(s: &Settings) -> Self {
        Self {
            walls: s.walls.clone(),
            shell: s.shell.clone(),
            infill: s.infill.clone(),
            ironing: s.ironing.clone(),
            bridge: s.bridge.clone(),
            fuzzy: s.fuzzy.clone(),
            nozzle: s.printer.nozzle_diameter,
            first_layer: s.first_layer.clone(),
            skirt: s.skirt.clone(),
            brim: s.brim.clone(),
            free_seams: matches!(s.seam.position, SeamPosition::Free | SeamPosition::Nearest),
            tool_of: (s.tools.len() > 1).then(|| s.tool_of.clone()),
        }
    }
}

impl From<&Settings> for TravelTime {
    /// The machine and the motion of the settings. With firmware retraction, whose lengths and speeds the firmware
    /// keeps, the profile's values are the best guess.
    ///
    /// The corners between bead and travel are taken to be stops: at the speed of a corner, a tenth of the travel's or
    /// less, that is off by hundredths.
    fn from(settings: &Settings) -> Self {
        let Settings { machine, speed, acceleration, retract, travel, .. } = settings;
        let given = |values: &[f64]| values.iter().copied().find(|a| *a > 0.0).unwrap_or(0.0);
        let (max_speed, max_acceleration) =
            (machine.max_speed.map(|v| v.0), machine.max_acceleration.map(|a| a.0));
        let usual = given(&[acceleration.default.0, max_acceleration[0]]);
        let move_s = |length_mm: f64, speed: f64, axis: usize| {
            let (speed, acceleration) = (speed.min(max_speed[axis]), max_acceleration[axis]);
            if length_mm > 0.0 { trapezoid_s(length_mm, speed, acceleration, 0.0) } else { 0.0 }
        };
        let length_mm = retract.length.0;
        let retract_s = if length_mm > 0.0 {
            move_s(length_mm, retract.speed.0, 3)
                + move_s(length_mm + retract.extra.0, retract.unretract_speed.0, 3)
                + 2.0 * move_s(retract.z_hop.0, speed.z.0, 2)
        } else {
            0.0
        };
        Self {
            speed_mm_s: speed.travel.0.min(max_speed[0]),
            acceleration_mm_s2: given(&[acceleration.travel.0, usual]).min(max_acceleration[0]),
            cruise_ratio: if settings.printer.flavor == Flavor::Klipper {
                machine.min_cruise_ratio.0
            } else {
                0.0
            },
            stop_s: speed.infill.0.min(speed.perimeter.0) / usual,
            retract_from_mm: retract.min_travel.0,
            retract_inside_from_mm: travel.retract_inside.0.max(retract.min_travel.0),
            retract_s,
            climb_s: move_s(settings.layer.height.0, speed.z.0, 2),
        }
    }
}

impl Settings {
    /// What toolpaths can depend on; everything else is at its default, so that equal ones have the same toolpaths.
    #[must_use]
    pub(crate) fn for_toolpaths(&self) -> Self {
        let all = self.clone();
        Self {
            bed: all.bed,
            print: all.print,
            layer: all.layer,
            walls: all.walls,
            shell: all.shell,
            infill: all.infill,
            ironing: all.ironing,
            spiral: all.spiral,
            fuzzy: all.fuzzy,
            first_layer: all.first_layer,
            skirt: all.skirt,
            brim: all.brim,
            raft: all.raft,
            support: all.support,
            bridge: all.bridge,
            printer: PrinterSettings { nozzle_diameter: self.printer.nozzle_diameter, ..Default::default() },
            seam: SeamSettings { position: self.seam.position, ..Default::default() },
            tool_of: all.tool_of,
            prime_tower: all.prime_tower,
            tools: all.tools,
            ..Self::of_stages()
        }
    }

    /// The requested cost that ordering minimises.
    pub fn order_cost(&self, kind: CostKind) -> Cost {
        match kind {
            CostKind::Length => Cost::Length,
            CostKind::Time => Cost::Time(TravelTime::from(self)),
        }
    }
}

impl Settings {
    /// What the corners between beads and travels cost, where times count and seams are free.
    pub fn corners(&self) -> Option<Corners> {
        let Cost::Time(travel) = self.order_cost(self.order.cost) else { return None };
        let free =
            self.seam.position == SeamPosition::Free && self.order.strategy == OrderStrategy::Optimized;
        let bead_mm_s = self.speed.infill.0.min(self.speed.perimeter.0);
        let height_mm = self.layer.height.0;
        let bead_mm2 = height_mm * bead::spacing_mm(self.walls.width.0, height_mm);
        let machine = Machine::new(self);
        free.then(|| Corners {
            travel,
            bead_mm_s,
            bead_mm_s2: bead_mm_s / travel.stop_s,
            corner_v2: machine.corner_acceleration_mm(),
            extruder_mm_s: machine.extruder_corner_velocity * self.filament.area_mm2() / bead_mm2,
        })
    }

    /// How travels are led inside islands; `None`: straight.
    pub fn detour_rule(&self) -> Option<DetourRule> {
        let (travel, walls) = (&self.travel, &self.walls);
        let rule = DetourRule {
            wall_width_mm: walls.external_width.0,
            max_mm: travel.detour_mm(),
            retraction_mm: travel.retract_inside.0,
        };
        (rule.max_mm > 0.0).then_some(rule)
    }
}

impl MotionSettings {
    /// What motion needs of all settings, and where to pause.
    pub fn new(settings: &Settings, pauses: &[PauseAt]) -> Self {
        let tools = (0..settings.tools.len()).map(|tool| Self::of_one(&settings.of_tool(tool), pauses));
        Self { tools: tools.collect(), ..Self::of_one(settings, pauses) }
    }

    fn of_one(settings: &Settings, pauses: &[PauseAt]) -> Self {
        Self {
            flow: FlowSettings {
                multiplier: settings.filament.flow,
                filament_area_mm2: settings.filament.area_mm2(),
                max_flow: settings.filament.max_flow,
            },
            role_flow: settings.flow.clone(),
            first_layer: settings.first_layer.clone(),
            speed: settings.speed.clone(),
            acceleration: settings.acceleration.clone(),
            firmware_acceleration: settings.machine.max_acceleration[0],
            square_corner_velocity: settings.machine.square_corner_velocity,
            seam: settings.seam.clone(),
            reverse_overhangs: settings.walls.reverse_overhangs,
            retract: settings.retract.clone(),
            travel: settings.travel.clone(),
            wall_width: settings.walls.external_width,
            cooling: settings.cooling.clone(),
            temperature: settings.temperature.clone(),
            z_offset: settings.layer.z_offset,
            arcs: settings.gcode.arcs.then_some(settings.gcode.arc_tolerance),
            labels: settings.gcode.labels_objects(),
            pauses: pauses.to_vec(),
            color_changes: Vec::new(),
            heat_first_layer: false,
            tools: Vec::new(),
            change_time: settings.tool_change.time,
            left_back_mm: 0.0,
            idle: idle(settings),
            heating_rate: settings.tool.heating_rate,
            swap: settings.swap.clone(),
            pressure_advance: settings.filament.pressure_advance,
            advance_returns: settings.filament.pressure_advance > 0.0
                || sets_pressure_advance(&settings.gcode.filament_start),
            keeps_filament: settings.tool_change.kind.has_nozzles(),
        }
    }
}

impl Machine {
    /// The machine of the settings, under the firmware that they are for.
    pub fn new(settings: &Settings) -> Self {
        Self::under(settings.printer.flavor.into(), settings)
    }

    /// The machine of the settings under any firmware.
    pub fn under(firmware: Firmware, settings: &Settings) -> Self {
        let (machine, retract) = (&settings.machine, &settings.retract);
        let mut made = Self {
            firmware,
            max_speed: machine.max_speed.map(|v| v.0),
            max_acceleration: machine.max_acceleration.map(|a| a.0),
            acceleration: machine.max_acceleration[0].0,
            square_corner_velocity: machine.square_corner_velocity.0,
            extruder_corner_velocity: machine.extruder_corner_velocity.0,
            min_cruise_ratio: machine.min_cruise_ratio.0,
            junction_deviation_mm: machine.junction_deviation.0,
            jerk: machine.jerk.map(|v| v.0),
            jerk_everywhere: false,
            retraction: FirmwareRetraction {
                length_mm: retract.length.0,
                extra_mm: retract.extra.0.max(0.0),
                speed: retract.speed.0,
                unretract_speed: retract.unretract_speed.0,
            },
            change_s: settings.tool_change.time.0,
            change_is_fixed: false,
            heating_rate: settings.tool.heating_rate,
            filament_area_mm2: settings.filament.area_mm2(),
        };
        if made.junction_deviation_mm <= 0.0 {
            let usual = Some(settings.acceleration.default.0).filter(|a| *a > 0.0);
            made.junction_deviation_mm =
                made.corner_acceleration_mm() / usual.unwrap_or(made.acceleration).min(made.acceleration);
        }
        made
    }
}

impl WriterSettings {
    /// What the writer needs of all settings. `progress` is for outputs that can be patched later.
    pub fn new(settings: &Settings, scripts: &Scripts, progress: bool) -> Self {
        Self {
            flavor: settings.printer.flavor,
            relative_e: settings.gcode.relative_e,
            filament_diameter: settings.filament.diameter,
            firmware_retraction: settings.retract.firmware,
            pause: scripts.pause.clone(),
            color_change: scripts.color_change.clone(),
            objects: Vec::new(),
            progress,
            layer_scripts: layer_scripts(settings),
            label_commands: settings.gcode.labels,
            label_comments: settings.gcode.label_comments,
            tools: (0..settings.tools.len()).map(|tool| ToolWriter::new(&settings.of_tool(tool))).collect(),
        }
    }
}

/// Temperature of a tool while another prints; of a nozzle that all share there is none.
fn idle(own: &Settings) -> Celsius {
    if own.tool_change.kind.has_nozzles() { own.tool.idle_temperature } else { Celsius(0.0) }
}

impl ToolWriter {
    /// What the writer needs of the settings of a tool.
    fn new(own: &Settings) -> Self {
        Self {
            filament_diameter: own.filament.diameter,
            offset_mm: own.tool.offset.map(|mm| mm.0),
            idle: idle(own),
            has_heater: own.tool_change.kind.has_nozzles(),
        }
    }
}

/// What the writer needs to know of the scripts of layer changes.
fn layer_scripts(settings: &Settings) -> LayerScripts {
    let (before, after) = (settings.gcode.before_layer.trim(), settings.gcode.after_layer.trim());
    let commands = || after.lines().map(|line| line.split(';').next().unwrap_or_default().trim());
    let has = |words: &[&str]| commands().any(|line| words.iter().any(|word| line.contains(word)));
    let plain = |line: &str| line.is_empty() || line.starts_with('M') || line.starts_with("G92 E");
    LayerScripts {
        before: !before.is_empty(),
        before_is_marked: before.lines().any(|line| line.trim() == BEFORE_LAYER_CHANGE),
        after: !after.is_empty(),
        on_first: settings.gcode.first_layer_scripts,
        moves: commands().any(|line| !plain(line)),
        modes: has(&["G90", "G91", "M82", "M83"]),
        travel_speed: settings.speed.travel,
        z_speed: settings.speed.z,
    }
}

impl From<&Settings> for GcodeOptions {
    fn from(settings: &Settings) -> Self {
        Self {
            printer: settings.printer.clone(),
            filament: settings.filament.clone(),
            temperature: settings.temperature.clone(),
            layer: settings.layer.clone(),
            retract: settings.retract.clone(),
            gcode: settings.gcode.clone(),
            machine: Machine::new(settings),
            limits: settings.machine.clone(),
            tools: Vec::new(),
            tool_change: settings.tool_change.clone(),
        }
    }
}

impl GcodeOptions {
    /// The options of a print that begins with a tool.
    pub fn beginning_with(settings: &Settings, first: ToolId) -> Self {
        let count = settings.tool_list().len();
        let own = |tool: usize| {
            let flushes_mm3 =
                (0..count).map(|to| if to == tool { 0.0 } else { settings.flush_mm3(tool, to) });
            let flushes_mm3 = flushes_mm3.collect();
            let own = settings.of_tool(tool);
            ToolOptions {
                printer: own.printer.clone(),
                filament: own.filament.clone(),
                temperature: own.temperature.clone(),
                tool: own.tool.clone(),
                change: own.tool_change.time,
                flushes_mm3,
                has_heater: own.tool_change.kind.has_nozzles(),
            }
        };
        let tools = (0..count).map(own).collect();
        Self { tools, ..Self::from(&*settings.of_tool(first.into())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_settings_give_the_retraction_pair_and_the_stop() {
        let time = TravelTime::from(&Settings::default());
        // 1 mm there and back at 800 mm/s²: too short to reach 40 mm/s.
        assert!((time.retract_s - 2.0 * 2.0 * (1.0_f64 / 800.0).sqrt()).abs() < 1e-12);
        assert!((time.stop_s - 60.0 / 1500.0).abs() < 1e-12);
    }
}
