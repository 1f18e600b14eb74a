//! What scripts may know of a print: its statistics, and how far it has come.

use macros::Value;

use crate::gcode::{PrintFacts, calendar};
use crate::motion::filament_area_mm2;
use crate::profile::settings::Settings;
use crate::toolpath::bead::area_mm2;

/// How far a print has come when a script runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// Layers before the one that is printed or begins; `None`: before the first.
    pub layer: Option<usize>,
    /// Height of that layer over the bed, without the Z offset, millimetres.
    pub layer_z_mm: f64,
    /// The greatest height so far, without the Z offset, millimetres.
    pub max_z_mm: f64,
    /// Filament extruded so far, mm³.
    pub extruded_mm3: f64,
    /// Where the nozzle is, Z offset included, millimetres.
    pub position_mm: [f64; 3],
    /// Objects finished so far, where they are printed one after the other.
    pub objects_done: usize,
    /// The extruder whose filament's script runs.
    pub filament_extruder: usize,
    /// The tool in use, counted from 0.
    pub tool: usize,
    /// The tool before the one in use or, where a script changes it, that in use.
    pub before: Option<usize>,
    /// The tool that a script changes to.
    pub next: Option<usize>,
    /// Changes of tool so far.
    pub changes: usize,
    /// Of each tool the filament extruded so far, mm³; empty: the printer has one.
    pub by_tool_mm3: Vec<f64>,
    /// What is known of the whole at its end only.
    pub totals: Option<WholePrint>,
}

/// What is known of a print at its end only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WholePrint {
    /// Print time without heating, seconds.
    pub time_s: f64,
    /// Filament, mm³.
    pub volume_mm3: f64,
}

/// All that a name may depend on.
pub(super) struct Context<'a> {
    /// Those of the tool in use.
    pub settings: &'a Settings,
    /// Those of each tool, where there are several.
    pub tools: &'a [Settings],
    pub print: &'a PrintFacts,
    pub moment: &'a Moment,
}

/// A print of one layer as high as this, on this area, may warp off where the chamber is cold, as Bambu Studio has it.
const FLAT_MM: f64 = 0.3;
const WIDE_MM2: f64 = 40_000.0;

impl Context<'_> {
    fn grams(&self, volume_mm3: f64) -> f64 {
        volume_mm3 / 1000.0 * self.settings.filament.density
    }

    /// A value for each extruder, of its filament so far.
    fn of_each(&self, value: fn(&Settings, f64) -> f64) -> Value {
        if self.tools.is_empty() {
            return self.of_first(value(self.settings, self.moment.extruded_mm3));
        }
        let so_far = |tool: usize| self.moment.by_tool_mm3.get(tool).copied().unwrap_or(0.0);
        Value::List((0..).zip(self.tools).map(|(i, own)| Value::Real(value(own, so_far(i)))).collect())
    }

    /// The settings of the tool before and of the one after a change.
    fn changing(&self) -> [&Settings; 2] {
        let own = |tool: usize| self.tools.get(tool).unwrap_or(self.settings);
        [self.moment.tool, self.moment.next.unwrap_or(self.moment.tool)].map(own)
    }

    /// What is flushed at a change, mm³.
    fn flush_mm3(&self) -> f64 {
        let Moment { tool, next, .. } = *self.moment;
        next.map_or(0.0, |next| self.settings.flush_mm3(tool, next))
    }

    /// Length of filament of one of the pulses in which that is done.
    fn flush_mm(&self, pulse: usize) -> f64 {
        /// As OrcaSlicer divides it.
        const ONE_TIME_MM3: f64 = 135.0;
        let volume_mm3 = self.flush_mm3();
        let pulses = (volume_mm3 / ONE_TIME_MM3).round().clamp(1.0, 4.0);
        let length_mm = volume_mm3 / self.changing()[1].filament.area_mm2();
        if (pulse as f64) < pulses { length_mm / pulses } else { 0.0 }
    }

    /// A value for each extruder, of which the first is used.
    fn of_first(&self, value: f64) -> Value {
        Value::List(
            (0..extruders(self.settings)).map(|i| Value::Real(if i == 0 { value } else { 0.0 })).collect(),
        )
    }

    fn bed(&self) -> [[f64; 2]; 2] {
        [self.settings.bed.low_mm(), self.settings.bed.high_mm()]
    }

    /// Flow of the outermost walls, mm³/s.
    fn outer_wall_flow(&self) -> f64 {
        let Settings { walls, layer, speed, filament, .. } = self.settings;
        let flow = area_mm2(walls.external_width.0, layer.height.0) * speed.external_perimeter.0;
        if filament.max_flow.0 > 0.0 { flow.min(filament.max_flow.0) } else { flow }
    }

    /// The points of a variable that is one, or a list of some.
    fn points_of(&self, name: &str) -> Vec<[f64; 2]> {
        let number = |value: &toml::Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
        let point = |value: &toml::Value| match value.as_array()?.as_slice() {
            [x, y] => Some([number(x)?, number(y)?]),
            _ => None,
        };
        let Some(value) = self.settings.variables.get(name) else { return Vec::new() };
        let several = || value.as_array().into_iter().flatten().filter_map(point).collect();
        point(value).map_or_else(several, |point| vec![point])
    }

    fn point_of(&self, name: &str) -> Option<[f64; 2]> {
        self.points_of(name).first().copied()
    }

    /// The part of the bed to probe: the first layer and a margin, within what the printer can reach; for printers whose
    /// presets say that.
    fn mesh(&self) -> Option<[[f64; 2]; 2]> {
        let (low, high) = (self.point_of("bed_mesh_min")?, self.point_of("bed_mesh_max")?);
        let margin = self.settings.variables.get("adaptive_bed_mesh_margin");
        let margin_mm =
            margin.and_then(|m| m.as_float().or(m.as_integer().map(|whole| whole as f64))).unwrap_or(0.0);
        let [first, last] = self.print.first_layer_box();
        Some([
            [0, 1].map(|i| (first[i] - margin_mm).max(low[i])),
            [0, 1].map(|i| (last[i] + margin_mm).min(high[i])),
        ])
    }

    /// How many probes lie on it along X and Y: at least three, no further apart than the presets say.
    fn probes(&self) -> Option<[usize; 2]> {
        let ([low, high], apart) = (self.mesh()?, self.point_of("bed_mesh_probe_distance")?);
        Some([0, 1].map(|i| {
            let steps = ((high[i] - low[i]) / apart[i].max(1.0)).ceil().clamp(2.0, 100.0);
            steps as usize + 1
        }))
    }

    /// Whether the box around the print meets the one around the points of a variable.
    fn is_printed_on(&self, zone: &str) -> bool {
        let corners = self.points_of(zone);
        [0, 1].into_iter().all(|axis| {
            let at = corners.iter().map(|corner| corner[axis]);
            let (low, high) =
                (at.clone().fold(f64::INFINITY, f64::min), at.fold(f64::NEG_INFINITY, f64::max));
            self.print.min_mm[axis] < high && self.print.max_mm[axis] > low
        })
    }

    /// Area within the corners around the first layer, mm².
    fn first_layer_mm2(&self) -> f64 {
        let hull = &self.print.first_layer_hull_mm;
        let next = hull.iter().cycle().skip(1);
        hull.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs() / 2.0
    }

    /// The chamber's temperature, as the presets have it.
    fn chamber(&self) -> Value {
        let first = |value: &toml::Value| match value {
            toml::Value::Array(values) => values.first().and_then(toml::Value::as_integer),
            value => value.as_integer(),
        };
        Value::Integer(self.settings.variables.get("chamber_temperature").and_then(first).unwrap_or(0))
    }

    fn celsius(&self, of: usize) -> Value {
        let temperature = &self.changing()[of].temperature;
        let first = self.moment.layer.is_none_or(|layer| layer == 0);
        let celsius = if first { temperature.nozzle_first_layer } else { temperature.nozzle };
        Value::Integer(celsius.0.round() as i64)
    }

    fn feed(&self, of: usize) -> Value {
        /// Where the greatest flow is not known.
        const USUAL_MM3_S: f64 = 2.0;
        let filament = &self.changing()[of].filament;
        let flow = if filament.max_flow.0 > 0.0 { filament.max_flow.0 } else { USUAL_MM3_S };
        Value::Integer((flow / filament.area_mm2() * 60.0).round() as i64)
    }

    /// The tool that the print begins with.
    fn first(&self) -> usize {
        self.print.tools.first.into()
    }

    fn whole(&self, value: fn(&Self, &WholePrint) -> Value) -> Option<Value> {
        self.moment.totals.as_ref().map(|whole| value(self, whole))
    }

    fn date(&self, part: usize) -> Option<Value> {
        Some(whole(calendar(self.print.dated)[part] as usize))
    }
}

/// How many extruders the printer has: as many as it has nozzles.
pub(super) fn extruders(settings: &Settings) -> usize {
    if !settings.tools.is_empty() {
        return settings.tools.len();
    }
    match settings.variables.get("nozzle_diameter") {
        Some(toml::Value::Array(nozzles)) => nozzles.len().max(1),
        _ => 1,
    }
}

fn whole(count: usize) -> Value {
    Value::Integer(count as i64)
}

fn point(point: [f64; 2]) -> Value {
    Value::List(point.map(Value::Real).to_vec())
}

fn micrometres(mm: f64) -> Value {
    Value::Real((mm * 1000.0).round() / 1000.0 + 0.0)
}

/// `1h2m`, `12m`, `34s`: as file names have it.
fn short_time(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    let minutes = (whole + 30) / 60;
    match (minutes / 1440, minutes / 60 % 24, minutes % 60) {
        _ if whole < 60 => format!("{whole}s"),
        (0, 0, minutes) => format!("{minutes}m"),
        (0, hours, minutes) => format!("{hours}h{minutes}m"),
        (days, hours, minutes) => format!("{days}d{hours}h{minutes}m"),
    }
}

macro_rules! names {
    ($($name:literal, $doc:literal: $value:expr;)*) => {
        /// Every name that scripts have for the print and its progress, with its meaning.
        pub static PRINT_NAMES: &[(&str, &str)] = &[$(($name, $doc),)*];

        /// The value of a name, where it is known at this moment.
        pub(super) fn value(name: &str, context: &Context) -> Option<Value> {
            match name {
                $($name => {
                    let of: fn(&Context) -> Option<Value> = $value;
                    of(context)
                })*
                _ => None,
            }
        }
    };
}

names! {
    "layer_num", "index of the layer, from 0; -1 before the first": |c| Some(Value::Integer(c.moment.layer.map_or(-1, |l| l as i64)));
    "layer_z", "height of the layer over the bed, mm": |c| Some(micrometres(c.moment.layer_z_mm));
    "max_layer_z", "greatest height so far, mm": |c| Some(micrometres(c.moment.max_z_mm));
    "total_layer_count", "number of layers": |c| Some(whole(c.print.layers));
    "extruded_volume", "filament so far by extruder, mm³": |c| Some(c.of_each(|_, mm3| mm3));
    "extruded_volume_total", "filament so far, mm³": |c| Some(Value::Real(c.moment.extruded_mm3));
    "extruded_weight", "filament so far by extruder, g": |c| Some(c.of_each(|own, mm3| mm3 / 1000.0 * own.filament.density));
    "extruded_weight_total", "filament so far, g": |c| Some(Value::Real(c.grams(c.moment.extruded_mm3)));
    "position", "where the nozzle is: X, Y, Z, mm": |c| Some(Value::List(c.moment.position_mm.map(micrometres).to_vec()));
    "e_retracted", "filament pulled back, by extruder, mm": |c| Some(c.of_first(0.0));
    "e_restart_extra", "filament to add after a retraction, by extruder, mm": |c| Some(c.of_first(0.0));
    "e_position", "position of E, by extruder, mm": |c| Some(c.of_first(0.0));
    "zhop", "how far the nozzle is lifted, mm": |_| Some(Value::Real(0.0));
    "print_time", "print time, as 1h2m; at the end only": |c| c.whole(|_, w| Value::Text(short_time(w.time_s)));
    "normal_print_time", "the same": |c| c.whole(|_, w| Value::Text(short_time(w.time_s)));
    "silent_print_time", "the same": |c| c.whole(|_, w| Value::Text(short_time(w.time_s)));
    "used_filament", "filament, m; at the end only": |c| c.whole(|c, w| {
        Value::Real(w.volume_mm3 / filament_area_mm2(c.settings.filament.diameter) / 1000.0)
    });
    "total_weight", "filament, g; at the end only": |c| c.whole(|c, w| Value::Real(c.grams(w.volume_mm3)));
    "total_cost", "price of the filament; at the end only": |c| c.whole(|c, w| {
        Value::Real(c.grams(w.volume_mm3) / 1000.0 * c.settings.filament.cost)
    });
    "total_toolchanges", "changes of tool": |c| Some(whole(c.print.tools.changes));
    "total_wipe_tower_cost", "price of a wipe tower: there is none": |_| Some(Value::Real(0.0));
    "total_wipe_tower_filament", "filament of a wipe tower, m": |_| Some(Value::Real(0.0));
    "has_wipe_tower", "whether there is a prime tower": |c| Some(Value::Flag(c.print.tools.tower));
    "has_single_extruder_multi_material_priming", "whether all tools are primed before the first layer": |c| Some(Value::Flag(c.print.tools.primed));
    "num_extruders", "extruders of the printer": |c| Some(whole(extruders(c.settings)));
    "num_printing_extruders", "extruders that print": |c| Some(whole(c.print.tools.used.len().max(1)));
    "initial_tool", "the first tool": |c| Some(whole(c.first()));
    "initial_extruder", "the first extruder": |c| Some(whole(c.first()));
    "initial_no_support_extruder", "the first extruder for the part itself": |c| Some(whole(c.first()));
    "current_extruder", "the extruder in use": |c| Some(whole(c.moment.tool));
    "filament_extruder_id", "the extruder of the filament whose script this is": |c| Some(whole(c.moment.filament_extruder));
    "next_extruder", "the extruder after a change of tool": |c| Some(whole(c.moment.next.unwrap_or(c.moment.tool)));
    "previous_extruder", "the extruder before a change of tool; -1: there is none": |c| {
        Some(Value::Integer(c.moment.before.map_or(-1, |tool| tool as i64)))
    };
    "color_change_extruder", "the extruder whose color changes": |c| Some(whole(c.moment.tool));
    "is_extruder_used", "whether an extruder prints": |c| {
        let used = &c.print.tools.used;
        let is_used = |i: usize| if used.is_empty() { i == 0 } else { used.iter().any(|tool| usize::from(*tool) == i) };
        Some(Value::List((0..256).map(|i| Value::Flag(is_used(i))).collect()))
    };
    "initial_filament_type", "material of the first extruder": |c| Some(Value::Text(c.settings.filament.material.clone()));
    "printing_filament_types", "materials that are printed": |c| Some(Value::Text(c.settings.filament.material.clone()));
    "current_object_idx", "objects finished so far, one after the other": |c| Some(whole(c.moment.objects_done));
    "num_objects", "objects on the plate, copies once": |c| Some(whole(c.print.objects));
    "num_instances", "objects on the plate": |c| Some(whole(c.print.instances));
    "scale", "scale of the objects, %": |_| Some(Value::List(vec![Value::Text("x:100% y:100% z:100%".into())]));
    "print_bed_min", "least X and Y of the bed": |c| Some(point(c.bed()[0]));
    "print_bed_max", "greatest X and Y of the bed": |c| Some(point(c.bed()[1]));
    "print_bed_size", "width and depth of the bed": |c| {
        let [low, high] = c.bed();
        Some(point([high[0] - low[0], high[1] - low[1]]))
    };
    "first_layer_print_min", "least X and Y of the first layer": |c| Some(point(c.print.first_layer_box()[0]));
    "first_layer_print_max", "greatest X and Y of the first layer": |c| Some(point(c.print.first_layer_box()[1]));
    "first_layer_print_size", "width and depth of the first layer": |c| {
        let [low, high] = c.print.first_layer_box();
        Some(point([high[0] - low[0], high[1] - low[1]]))
    };
    "first_layer_print_convex_hull", "corners around the first layer": |c| {
        Some(Value::List(c.print.first_layer_hull_mm.iter().map(|&corner| point(corner)).collect()))
    };
    "first_layer_center_no_wipe_tower", "middle of the first layer": |c| {
        let [low, high] = c.print.first_layer_box();
        Some(point([0, 1].map(|i| f64::midpoint(low[i], high[i]))))
    };
    "outer_wall_volumetric_speed", "flow of the outermost walls, mm³/s": |c| Some(Value::Real(c.outer_wall_flow()));
    "adaptive_bed_mesh_min", "least X and Y of the bed mesh to probe": |c| Some(point(c.mesh()?[0]));
    "adaptive_bed_mesh_max", "greatest X and Y of the bed mesh to probe": |c| Some(point(c.mesh()?[1]));
    "bed_mesh_probe_count", "probes of the bed mesh along X and Y": |c| Some(Value::List(c.probes()?.map(whole).to_vec()));
    "bed_mesh_algo", "how a bed mesh of so many probes is interpolated": |c| {
        let [x, y] = c.probes()?;
        Some(Value::Text(if x.min(y) < 4 { "lagrange" } else { "bicubic" }.into()))
    };
    "in_head_wrap_detect_zone", "whether it is printed where Bambu's printers look for filament around the nozzle": |c| {
        Some(Value::Flag(c.is_printed_on("head_wrap_detect_zone")))
    };
    "retraction_distance_when_cut", "retraction before filament is cut: none": |_| Some(Value::Real(0.0));
    "long_retraction_when_cut", "whether that is long": |_| Some(Value::Flag(false));
    "most_used_physical_extruder_id", "the extruder that prints most": |_| Some(whole(0));
    "curr_physical_extruder_id", "the extruder in use": |_| Some(whole(0));
    "toolchange_count", "changes of tool so far": |c| Some(whole(c.moment.changes));
    "toolchange_z", "height at which a tool is changed, mm": |c| Some(micrometres(c.moment.position_mm[2]));
    "x_after_toolchange", "X before a change of tool; after it the nozzle goes where it is needed": |c| Some(micrometres(c.moment.position_mm[0]));
    "y_after_toolchange", "the same Y": |c| Some(micrometres(c.moment.position_mm[1]));
    "z_after_toolchange", "the same Z": |c| Some(micrometres(c.moment.position_mm[2]));
    "old_retract_length", "retraction of the tool before a change, mm": |c| Some(Value::Real(c.changing()[0].retract.length.0));
    "new_retract_length", "retraction of the tool after it, mm": |c| Some(Value::Real(c.changing()[1].retract.length.0));
    "old_retract_length_toolchange", "retraction of the tool before a change, at the change, mm": |c| {
        Some(Value::Real(c.changing()[0].retract.change_length.0))
    };
    "new_retract_length_toolchange", "the same of the tool after it": |c| Some(Value::Real(c.changing()[1].retract.change_length.0));
    "old_filament_temp", "temperature of the tool before a change, °C": |c| Some(c.celsius(0));
    "new_filament_temp", "temperature of the tool after it, °C": |c| Some(c.celsius(1));
    "old_filament_e_feedrate", "feed rate of the filament before a change at its greatest flow, mm/min": |c| Some(c.feed(0));
    "new_filament_e_feedrate", "the same after it": |c| Some(c.feed(1));
    "flush_length", "filament to flush at a change, mm": |c| Some(Value::Real(c.flush_mm3() / c.changing()[1].filament.area_mm2()));
    "flush_length_1", "of that, the first pulse": |c| Some(Value::Real(c.flush_mm(0)));
    "flush_length_2", "the second": |c| Some(Value::Real(c.flush_mm(1)));
    "flush_length_3", "the third": |c| Some(Value::Real(c.flush_mm(2)));
    "flush_length_4", "the fourth": |c| Some(Value::Real(c.flush_mm(3)));
    "first_flush_volume", "half of what is flushed at a change, mm³": |c| Some(Value::Real(c.flush_mm3() / 2.0));
    "second_flush_volume", "the other half": |c| Some(Value::Real(c.flush_mm3() / 2.0));
    "relative_e_axis", "whether E is relative": |c| Some(Value::Flag(c.settings.gcode.relative_e));
    "travel_point_1_x", "X of the way to a prime tower: where the nozzle is": |c| Some(micrometres(c.moment.position_mm[0]));
    "travel_point_1_y", "the same Y": |c| Some(micrometres(c.moment.position_mm[1]));
    "travel_point_2_x", "the same, second point": |c| Some(micrometres(c.moment.position_mm[0]));
    "travel_point_2_y", "the same Y": |c| Some(micrometres(c.moment.position_mm[1]));
    "travel_point_3_x", "the same, third point": |c| Some(micrometres(c.moment.position_mm[0]));
    "travel_point_3_y", "the same Y": |c| Some(micrometres(c.moment.position_mm[1]));
    "wipe_avoid_perimeter", "whether the way to a prime tower goes round the print: not by points": |_| Some(Value::Flag(false));
    "wipe_avoid_pos_x", "X at which it would, mm": |c| Some(Value::Real(f64::midpoint(c.bed()[0][0], c.bed()[1][0])));
    "wipe_tower_center_pos_valid", "whether a place beside the prime tower is told: no": |_| Some(Value::Flag(false));
    "wipe_tower_center_pos_x", "X of that": |_| Some(Value::Real(0.0));
    "wipe_tower_center_pos_y", "Y of that": |_| Some(Value::Real(0.0));
    "is_prime_tower_interface", "whether materials that do not stick meet in the tower: not known": |_| Some(Value::Flag(false));
    "has_timelapse_safe_pos", "whether a place for pictures is told: no": |_| Some(Value::Flag(false));
    "timelapse_pos_x", "X of that": |_| Some(Value::Real(0.0));
    "timelapse_pos_y", "Y of that": |_| Some(Value::Real(0.0));
    "initial_no_support_tool", "the first tool for the part itself": |c| Some(whole(c.first()));
    "initial_filament_id", "the first filament": |c| Some(whole(c.first()));
    "initial_no_support_filament_id", "the first filament for the part itself": |c| Some(whole(c.first()));
    "first_non_support_filaments", "the first filament for the part itself of each nozzle": |c| Some(Value::List(vec![whole(c.first())]));
    "first_non_support_tools", "the same": |c| Some(Value::List(vec![whole(c.first())]));
    "first_non_support_hotend", "the nozzle of each of them": |_| Some(Value::List(vec![whole(0)]));
    "current_filament_id", "the filament in use": |c| Some(whole(c.moment.tool));
    "next_filament_id", "the filament after a change": |c| Some(whole(c.moment.next.unwrap_or(c.moment.tool)));
    "previous_filament_id", "the filament before a change; -1: there is none": |c| {
        Some(Value::Integer(c.moment.before.map_or(-1, |tool| tool as i64)))
    };
    "initial_nozzle_id", "the first nozzle of a printer whose filaments are changed": |_| Some(whole(0));
    "current_nozzle_id", "the nozzle in use": |_| Some(whole(0));
    "next_nozzle_id", "the nozzle after a change": |_| Some(whole(0));
    "current_extruder_id", "the extruder in use of a printer whose filaments are changed": |_| Some(whole(0));
    "next_extruder_id", "the extruder after a change": |_| Some(whole(0));
    "current_hotend", "the hot end in use": |_| Some(whole(0));
    "next_hotend", "the hot end after a change": |_| Some(whole(0));
    "initial_no_support_hotend", "the first hot end for the part itself": |_| Some(whole(0));
    "nozzle_diameter_at_nozzle_id", "diameters of the nozzles that a printer has in store": |c| {
        Some(Value::List(vec![Value::Real(c.settings.printer.nozzle_diameter.0)]))
    };
    "nozzle_volume_types", "kinds of these nozzles": |_| Some(Value::List(vec![Value::Text("Standard".into())]));
    "old_extruder_variant", "kind of the extruder before a change: not known": |_| Some(Value::Text(String::new()));
    "new_extruder_variant", "kind of the extruder after it": |_| Some(Value::Text(String::new()));
    "new_extruder_retracted_length", "how far the filament after a change was left back, mm": |_| Some(Value::Real(0.0));
    "retraction_distance_when_ec", "retraction before another nozzle is taken: none": |_| Some(Value::Real(0.0));
    "long_retraction_when_ec", "whether that is long": |_| Some(Value::Flag(false));
    "fan_speed", "speed of the fan: scripts of old projects ask for it": |_| Some(whole(0));
    "max_print_z", "height of the print, whole mm": |c| Some(Value::Integer(c.print.max_z_mm.ceil() as i64));
    "has_tpu_in_first_layer", "whether a flexible filament is printed": |c| {
        let is_flexible = |own: &Settings| own.filament.material == "TPU";
        Some(Value::Flag(is_flexible(c.settings) || c.tools.iter().any(is_flexible)))
    };
    "hold_chamber_temp_for_flat_print", "whether a print is so wide and flat that it needs a warm chamber": |c| {
        Some(Value::Flag(c.print.max_z_mm < FLAT_MM && c.first_layer_mm2() > WIDE_MM2))
    };
    "enable_high_low_temp_mix", "whether materials of unlike temperatures may be mixed: no": |_| Some(Value::Flag(false));
    "bbl_bed_temperature_gcode", "whether scripts heat the bed step by step: no": |_| Some(Value::Flag(false));
    "bed_temperature_initial_layer_vector", "steps of that: none": |_| Some(Value::Text(String::new()));
    "overall_chamber_temperature", "temperature of the chamber, °C; 0: not heated": |c| Some(c.chamber());
    "input_filename", "name of the model's file": |c| Some(Value::Text(format!("{}.gcode", c.print.input_name)));
    "input_filename_base", "the same without its ending": |c| Some(Value::Text(c.print.input_name.clone()));
    "model_name", "the same": |c| Some(Value::Text(c.print.input_name.clone()));
    "plate_name", "name of the plate: none": |_| Some(Value::Text(String::new()));
    "plate_number", "number of the plate": |_| Some(Value::Text("1".into()));
    "default_output_extension", "ending of G-code files": |_| Some(Value::Text(".gcode".into()));
    "version", "version of this program": |_| Some(Value::Text(env!("CARGO_PKG_VERSION").into()));
    "timestamp", "date of the print, as 20261123-184500; see SOURCE_DATE_EPOCH": |c| {
        let [year, month, day, hour, minute, second] = calendar(c.print.dated);
        Some(Value::Text(format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")))
    };
    "year", "year of the date": |c| c.date(0);
    "month", "month": |c| c.date(1);
    "day", "day": |c| c.date(2);
    "hour", "hour, UTC": |c| c.date(3);
    "minute", "minute": |c| c.date(4);
    "second", "second": |c| c.date(5);
}

#[cfg(test)]
mod tests {
    use super::short_time;

    #[test]
    fn times_in_names_of_files_are_short() {
        for (seconds, text) in
            [(33.0, "33s"), (751.0, "13m"), (3_700.0, "1h2m"), (90_061.0, "1d1h1m"), (59.6, "1m")]
        {
            assert_eq!(short_time(seconds), text);
        }
    }
}
