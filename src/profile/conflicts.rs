//! Settings that are allowed alone but not together.

use std::collections::BTreeMap;

use super::error::{Origin, Problem};
use super::script::{ScriptRun, WholePrint};
use super::settings::Settings;
use crate::gcode::{PrintFacts, thumbnail_list};
use crate::order::strategy;
use crate::plate::{BedShape, Sequence};
use crate::slice::layer_heights;
use crate::toolpath::{FuzzyWalls, tool_heights};

/// Contradictions between settings, and warnings.
pub(super) struct Conflicts {
    pub errors: Vec<Conflict>,
    pub warnings: Vec<Problem>,
}

/// An error, with every key that takes part in it.
pub(super) struct Conflict {
    pub keys: Vec<&'static str>,
    pub problem: Problem,
}

/// Looks at the settings as a whole. `origins` says where each was written.
pub(super) fn find(settings: &Settings, origins: &BTreeMap<String, Origin>) -> Conflicts {
    let found = Conflicts { errors: Vec::new(), warnings: Vec::new() };
    let mut check = Check { settings, origins, found };
    heights_and_widths(settings, &mut check);
    varied_heights(settings, &mut check);
    spiral(settings, &mut check);
    amounts(settings, &mut check);
    machine(settings, &mut check);
    retraction(settings, &mut check);
    tools(settings, &mut check);
    scripts(settings, &mut check);
    if let Err(message) = thumbnail_list(&settings.gcode.thumbnails) {
        check.error(&["gcode.thumbnails"], &message);
    }
    check.found
}

struct Check<'a> {
    settings: &'a Settings,
    origins: &'a BTreeMap<String, Origin>,
    found: Conflicts,
}

impl Check<'_> {
    /// The first key is the one to change; the others are named with their values and places.
    fn error(&mut self, keys: &[&'static str], message: &str) {
        let problem = self.problem(keys, message);
        self.found.errors.push(Conflict { keys: keys.to_vec(), problem });
    }

    fn warn(&mut self, keys: &[&'static str], message: &str) {
        let problem = self.problem(keys, message);
        self.found.warnings.push(problem);
    }

    fn problem(&self, keys: &[&'static str], message: &str) -> Problem {
        let others: Vec<String> = keys[1..]
            .iter()
            .map(|key| format!("{key} = {} ({})", self.value(key), self.origin(key)))
            .collect();
        let beside = if others.is_empty() { String::new() } else { format!("; with {}", others.join(", ")) };
        Problem {
            origin: self.origin(keys[0]),
            setting: Some((keys[0].to_owned(), self.value(keys[0]))),
            message: format!("{message}{beside}"),
        }
    }

    fn value(&self, key: &str) -> String {
        let values = toml::Table::try_from(self.settings).expect("settings are a table");
        let value = key.split_once('.').and_then(|(section, name)| values.get(section)?.get(name));
        match value {
            Some(toml::Value::String(text)) if text.contains('\n') => "…".into(),
            Some(value) => value.to_string(),
            None => String::new(),
        }
    }

    fn origin(&self, key: &str) -> Origin {
        self.origins.get(key).cloned().unwrap_or_else(|| Origin::Embedded(super::embedded::DEFAULT.into()))
    }
}

fn heights_and_widths(settings: &Settings, check: &mut Check) {
    let nozzle = settings.printer.nozzle_diameter;
    let layer = &settings.layer;
    let heights = [("layer.height", layer.height), ("layer.first_height", layer.first_height)];
    for (key, height) in heights {
        let keys = [key, "printer.nozzle_diameter"];
        if height > nozzle {
            check.error(
                &keys,
                "a layer higher than the nozzle is wide does not stick; use 0.25 to 0.8 of the nozzle",
            );
        } else if height > nozzle * 0.8 {
            check.warn(&keys, "layers above 0.8 of the nozzle bond badly");
        }
    }
    let first_width = settings.first_layer.width;
    let widths = [
        ("walls.width", settings.walls.width, "layer.height", layer.height),
        ("walls.external_width", settings.walls.external_width, "layer.height", layer.height),
        ("shell.width", settings.shell.width, "layer.height", layer.height),
        ("shell.top_width", settings.shell.top_width, "layer.height", layer.height),
        ("infill.width", settings.infill.width, "layer.height", layer.height),
        ("first_layer.width", first_width, "layer.first_height", layer.first_height),
    ];
    for (key, width, height_key, height) in widths {
        if key == "first_layer.width" && width.0 == 0.0 {
            continue;
        }
        if width < height {
            check.error(&[key, height_key], "a line must be at least as wide as its layer is high");
        } else if width > nozzle * 2.5 || width < nozzle * 0.6 {
            check.warn(&[key, "printer.nozzle_diameter"], "lines are best 0.6 to 2.5 nozzles wide");
        }
    }
    if layer.first_height.0 + layer.z_offset.0 <= 0.0 {
        check.error(
            &["layer.z_offset", "layer.first_height"],
            "the first layer would be printed below the bed; raise one of them",
        );
    }
    if layer.first_height > settings.bed.height {
        check.error(&["bed.height", "layer.first_height"], "not even the first layer fits");
    }
}

fn amounts(settings: &Settings, check: &mut Check) {
    let (walls, shell, infill) = (&settings.walls, &settings.shell, &settings.infill);
    if walls.count == 0 && shell.top_layers == 0 && shell.bottom_layers == 0 && infill.density.0 == 0.0 {
        check.error(
            &["walls.count", "shell.top_layers", "shell.bottom_layers", "infill.density"],
            "nothing is left to print; give at least one of them a value",
        );
    }
    if infill.combine_layers > 1 && settings.layer.height * 2.0 > settings.printer.nozzle_diameter {
        check.warn(
            &["infill.combine_layers", "layer.height", "printer.nozzle_diameter"],
            "no layers are combined: two of them are higher than the nozzle's diameter",
        );
    }
    let margin = settings.brim.width + settings.brim.gap + settings.skirt.distance;
    if margin * 2.0 >= settings.bed.size[0] || margin * 2.0 >= settings.bed.size[1] {
        check.error(
            &["brim.width", "brim.gap", "skirt.distance", "bed.size"],
            "brim and skirt leave no room for a part on the bed",
        );
    }
    if settings.raft.layers > 0 && settings.brim.width.0 > 0.0 {
        check.error(&["brim.width", "raft.layers"], "on a raft the part has no brim; set one of them to 0");
    }
    if settings.plate.orient && !settings.plate.arrange {
        check.error(
            &["plate.orient", "plate.arrange"],
            "a model that is turned over cannot stay where its file puts it; set one of them to the other value",
        );
    }
    if settings.print.sequence == Sequence::Object && settings.skirt.draft_shield {
        check.error(
            &["skirt.draft_shield", "print.sequence"],
            "a draft shield around all objects would obstruct the print head; set it to false",
        );
    }
    let temperature = &settings.temperature;
    if (temperature.nozzle.0 == 0.0) != (temperature.nozzle_first_layer.0 == 0.0) {
        check.error(
            &["temperature.nozzle_first_layer", "temperature.nozzle"],
            "the nozzle is heated on some layers only; give both a value, or both 0 to leave the heater alone",
        );
    }
    for (key, value) in [
        ("temperature.nozzle", temperature.nozzle),
        ("temperature.nozzle_first_layer", temperature.nozzle_first_layer),
    ] {
        if value.0 > 0.0 && value.0 < 150.0 {
            check.warn(&[key], "no usual filament melts below 150 °C, and most firmware refuses to extrude");
        }
    }
    if settings.cooling.full_fan_layer < settings.cooling.fan_off_layers {
        check.error(
            &["cooling.full_fan_layer", "cooling.fan_off_layers"],
            "the fan cannot be at its full value on a layer that has it off",
        );
    }
    let cooling = &settings.cooling;
    if cooling.short_layer_fan.iter().any(|fan| fan.0 > 0.0) && cooling.short_layer_time.0 == 0.0 {
        check.warn(
            &["cooling.short_layer_fan", "cooling.short_layer_time"],
            "no layer is shorter than 0 s; give the time below which layers are short",
        );
    }
    if settings.order.layer_distance.0 > 0.0 && !settings.order.chain {
        check.error(
            &["order.layer_distance", "order.chain"],
            "a distance between the end of a layer and the start of the next needs order.chain = true",
        );
    } else if settings.order.layer_distance.0 > 0.0 && strategy(settings.order.strategy).looks_ahead() {
        check.warn(
            &["order.layer_distance", "order.strategy"],
            "layers are then ordered one by one instead of together, which makes travels longer",
        );
    }
}

fn varied_heights(settings: &Settings, check: &mut Check) {
    let (layer, nozzle) = (&settings.layer, settings.printer.nozzle_diameter);
    let thinnest = [&settings.walls.width, &settings.walls.external_width, &settings.infill.width]
        .into_iter()
        .chain([&settings.shell.width, &settings.shell.top_width])
        .fold(f64::INFINITY, |least, width| least.min(width.0));
    let too_high = "a layer higher than the nozzle or a line is wide does not stick";
    match layer_heights(&layer.heights) {
        Err(message) => check.error(&["layer.heights"], &message),
        Ok(table) => {
            if table.iter().any(|[_, mm]| *mm > nozzle.0.min(thinnest)) {
                check.error(&["layer.heights", "printer.nozzle_diameter"], too_high);
            }
            if layer.adaptive && !table.is_empty() {
                check.error(
                    &["layer.heights", "layer.adaptive"],
                    "heights follow either a table or the surface; set one of them to \"\" or false",
                );
            }
        }
    }
    if !layer.adaptive {
        return;
    }
    if layer.min_height > layer.max_height {
        check.error(&["layer.min_height", "layer.max_height"], "no height is between them");
    }
    if layer.max_height.0 > nozzle.0.min(thinnest) {
        check.error(&["layer.max_height", "printer.nozzle_diameter"], too_high);
    }
}

fn spiral(settings: &Settings, check: &mut Check) {
    if !settings.spiral.enabled {
        return;
    }
    let leaves = "a line that never stops cannot leave for it; set one of them to false";
    if settings.support.enabled {
        check.error(&["spiral.enabled", "support.enabled"], leaves);
    }
    if settings.skirt.draft_shield {
        check.error(&["spiral.enabled", "skirt.draft_shield"], leaves);
    }
    if settings.fuzzy.walls != FuzzyWalls::None {
        check.warn(&["fuzzy.walls", "spiral.enabled"], "only the bottom of a spiral is rough");
    }
}

fn machine(settings: &Settings, check: &mut Check) {
    let (bed, machine) = (&settings.bed, &settings.machine);
    if bed.shape == BedShape::Round && bed.size[0] != bed.size[1] {
        check.error(&["bed.size", "bed.shape"], "a round bed needs its diameter twice, such as [200, 200]");
    }
    if !bed.excluded.len().is_multiple_of(4) {
        check
            .error(&["bed.excluded"], "four numbers are expected for each rectangle, such as [0, 0, 18, 28]");
    }
    let speed = &settings.speed;
    let top = machine.max_speed[0].0.max(machine.max_speed[1].0);
    let speeds = [
        ("speed.external_perimeter", speed.external_perimeter),
        ("speed.perimeter", speed.perimeter),
        ("speed.small_perimeter", speed.small_perimeter),
        ("speed.infill", speed.infill),
        ("speed.solid", speed.solid),
        ("speed.top", speed.top),
        ("speed.bridge", speed.bridge),
        ("speed.gap_fill", speed.gap_fill),
        ("speed.support", speed.support),
        ("speed.support_interface", speed.support_interface),
        ("speed.skirt", speed.skirt),
        ("speed.travel", speed.travel),
        ("first_layer.speed", settings.first_layer.speed),
        ("first_layer.infill_speed", settings.first_layer.infill_speed),
    ];
    for (key, speed) in speeds {
        if speed.0 > top {
            check.warn(&[key, "machine.max_speed"], "the machine does not move that fast");
        }
    }
    if speed.z > machine.max_speed[2] {
        check.warn(&["speed.z", "machine.max_speed"], "the machine does not move that fast");
    }
    let top = machine.max_acceleration[0].0.max(machine.max_acceleration[1].0);
    let accelerations = [
        ("acceleration.default", settings.acceleration.default),
        ("acceleration.external_perimeter", settings.acceleration.external_perimeter),
        ("acceleration.perimeter", settings.acceleration.perimeter),
        ("acceleration.infill", settings.acceleration.infill),
        ("acceleration.solid", settings.acceleration.solid),
        ("acceleration.top", settings.acceleration.top),
        ("acceleration.bridge", settings.acceleration.bridge),
        ("acceleration.travel", settings.acceleration.travel),
        ("first_layer.acceleration", settings.first_layer.acceleration),
    ];
    for (key, acceleration) in accelerations {
        if acceleration.0 > top {
            check.warn(&[key, "machine.max_acceleration"], "the machine does not accelerate that fast");
        }
    }
}

fn retraction(settings: &Settings, check: &mut Check) {
    let retract = &settings.retract;
    if retract.wipe.0 > 0.0 && retract.firmware {
        check.error(
            &["retract.wipe", "retract.firmware"],
            "a wipe pulls filament back while it moves, which G10 cannot; set one of them to 0 or false",
        );
    }
    if retract.wipe.0 > 0.0 && retract.length.0 == 0.0 {
        check.warn(&["retract.wipe", "retract.length"], "no wipe without a retraction");
    }
    if retract.length.0 > 0.0 && retract.extra.0 < -retract.length.0 {
        check.error(&["retract.extra", "retract.length"], "an un-retraction cannot pull back");
    }
}

fn tools(settings: &Settings, check: &mut Check) {
    let (of, change, tower) = (&settings.tool_of, &settings.tool_change, &settings.prime_tower);
    let count = settings.tool_count();
    let there = match count {
        1 => "the printer has one tool; `[[tools]]` of a profile lists several".to_owned(),
        count => format!("the printer has {count} tools"),
    };
    let numbers = [
        ("tool_of.object", of.object),
        ("tool_of.walls", of.walls),
        ("tool_of.infill", of.infill),
        ("tool_of.solid_infill", of.solid_infill),
        ("tool_of.support", of.support),
        ("tool_of.support_interface", of.support_interface),
    ];
    for (key, _) in numbers.iter().filter(|(_, number)| *number as usize > count) {
        check.error(&[key], &format!("there is no such tool: {there}"));
    }
    match tool_heights(&of.heights) {
        Err(message) => check.error(&["tool_of.heights"], &message),
        Ok(heights) if heights.iter().any(|at| usize::from(at.tool) >= count) => {
            check.error(&["tool_of.heights"], &format!("there is no such tool: {there}"));
        }
        Ok(_) => {}
    }
    let listed = change.flush_volumes.len();
    if listed > 0 && listed != settings.tools.len().pow(2) {
        check.error(
            &["tool_change.flush_volumes"],
            &format!(
                "{listed} volumes are listed, but {count} tools need {}: one from each tool to each",
                count * count
            ),
        );
    }
    if !matches!(tower.position.len(), 0 | 2) {
        check.error(&["prime_tower.position"], "X and Y are expected, such as [200, 180]");
    }
    if settings.tools.len() > 1 && tower.enabled && settings.print.sequence == Sequence::Object {
        check.warn(
            &["prime_tower.enabled", "print.sequence"],
            "a prime tower grows with all objects; of several that are printed one after the other there is none, and nothing is flushed",
        );
    }
    for tool in 0..settings.tools.len() {
        let own = settings.of_tool(tool);
        let (height, nozzle) = (settings.layer.height, own.printer.nozzle_diameter);
        if height > nozzle && nozzle != settings.printer.nozzle_diameter {
            let message = format!("a layer is higher than the nozzle of tool {}, {nozzle}", tool + 1);
            check.error(&["layer.height"], &message);
        }
        let Some(own) = settings.with_widths_of(tool) else { continue };
        let widths = [own.walls.width, own.walls.external_width, own.shell.width, own.infill.width];
        if widths.iter().any(|width| *width < height) {
            let message = format!("lines of tool {} would be narrower than a layer is high", tool + 1);
            check.error(&["layer.height"], &message);
        } else if widths.iter().any(|width| *width > nozzle * 2.5 || *width < nozzle * 0.6) {
            let message =
                format!("lines of tool {} are best 0.6 to 2.5 of its nozzle wide, {nozzle}", tool + 1);
            check.warn(&["walls.width"], &message);
        }
    }
}

/// Scripts are tried on a print in the middle of the bed.
fn scripts(settings: &Settings, check: &mut Check) {
    let gcode = &settings.gcode;
    let scripts = [
        ("gcode.start", &gcode.start),
        ("gcode.filament_start", &gcode.filament_start),
        ("gcode.before_layer", &gcode.before_layer),
        ("gcode.after_layer", &gcode.after_layer),
        ("gcode.between_objects", &gcode.between_objects),
        ("gcode.pause", &gcode.pause),
        ("gcode.color_change", &gcode.color_change),
        ("tool_change.script", &settings.tool_change.script),
        ("gcode.filament_end", &gcode.filament_end),
        ("gcode.end", &gcode.end),
        ("gcode.file_name", &gcode.file_name),
    ];
    let (low, high) = (settings.bed.low_mm(), settings.bed.high_mm());
    let at = |share: f64| [0, 1].map(|i| low[i] + share * (high[i] - low[i]));
    let layers = 100;
    let max_z_mm = settings.layer.first_height.0 + (layers - 1) as f64 * settings.layer.height.0;
    let print = PrintFacts {
        layers,
        min_mm: at(0.4),
        max_mm: at(0.6),
        max_z_mm,
        objects: 1,
        instances: 1,
        input_name: "model".into(),
        ..PrintFacts::default()
    };
    let mut run = ScriptRun::new(settings, &print);
    for (key, script) in scripts {
        if key == "gcode.before_layer" {
            run.moment.layer = Some(1);
            run.moment.layer_z_mm = settings.layer.first_height.0 + settings.layer.height.0;
            run.moment.max_z_mm = run.moment.layer_z_mm;
            run.moment.extruded_mm3 = 100.0;
        }
        if key == "gcode.filament_end" {
            run.moment.totals = Some(WholePrint { time_s: 600.0, volume_mm3: 1000.0 });
        }
        if let Err(mistake) = run.text(script) {
            match gcode.ignore_scripts {
                true => check.warn(&[key], &format!("{mistake}; the script is left out")),
                false => check.error(&[key], &format!("{mistake}; --ignore-scripts leaves such scripts out")),
            }
        }
    }
}
