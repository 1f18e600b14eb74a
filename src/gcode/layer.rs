//! One layer's moves as bytes.

use super::extruder::{E_DECIMALS, Extruder};
use super::flavor::{Dialect, Purpose, dialect, line};
use super::header::label_comments;
use super::number::{push_fixed, push_word, text, ticks};
use super::settings::{BEFORE_LAYER_CHANGE, WriterSettings};
use super::slot::{PROGRESS_WIDTH, Pending, Slot};
use super::tool::{self, ToolMark};
use crate::motion::filament_area_mm2;
use crate::motion::{LayerMoves, Move, SwapStep, ToolChange};
use crate::toolpath::{Role, ToolId};
use crate::units::{Celsius, Mm3, MmPerS, MmPerS2};

/// Digits behind the point of X, Y, Z, I and J: a micrometre, a tenth of what a machine resolves.
const XYZ_DECIMALS: u32 = 3;
/// A coordinate that the layer has not stated yet.
const UNKNOWN: i64 = i64::MIN;

/// The bytes of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerText {
    /// The bytes for the file.
    pub bytes: Vec<u8>,
    /// Where the layer's M73 goes, if wanted; offset into `bytes`.
    pub progress: Option<Slot>,
    /// Where the script before the change of layer goes, if there is one; offset into `bytes`.
    pub before: Option<usize>,
    /// Where the script after it goes, if there is one; not before the other.
    pub after: Option<usize>,
    /// Changes of tool, in their order; their lines are places in `bytes`.
    pub changes: Vec<ToolMark>,
    /// Where the text of each move ends, where tools cool down while others print; offsets into `bytes`.
    pub ends: Vec<usize>,
}

/// Formats a layer. It depends on nothing but its arguments: position, feed rate and acceleration are stated
/// anew, and absolute E begins at 0, so layers can be formatted in any order.
///
/// Positions are rounded one by one (they do not drift); what rounding E leaves over goes into the next
/// extrusion, so that the layer's total is right to half a digit. A move too short to be written at all gives
/// its filament to the next one. Words that do not change are left out.
pub fn format_layer(layer: &LayerMoves, settings: &WriterSettings) -> LayerText {
    let mut writer = Writer::new(layer, settings);
    let progress = writer.open(layer);
    let change = LayerChange::new(layer, settings);
    let before = change.before.then_some(writer.change_mark);
    let mut after = None;
    // What heats waits for the script after the change of layer, which may heat as well.
    let mut heating = Vec::new();
    let cools = settings.tools.iter().any(|tool| tool.idle.0 > 0.0);
    let mut ends = Vec::with_capacity(if cools { layer.moves.len() } else { 0 });
    for step in &layer.moves {
        if change.after && after.is_none() {
            if matches!(step, Move::Nozzle(_) | Move::Bed(_)) {
                heating.push(step);
                ends.extend(cools.then_some(writer.out.len()));
                continue;
            }
            if writer.z >= change.z || is_bead(step) {
                after = Some(writer.after_layer_change(layer));
                heating.drain(..).for_each(|step| writer.step(step));
            }
        }
        writer.step(step);
        ends.extend(cools.then_some(writer.out.len()));
    }
    if change.after && after.is_none() {
        after = Some(writer.out.len());
        heating.drain(..).for_each(|step| writer.step(step));
    }
    LayerText { bytes: writer.out, progress, before, after, changes: writer.changes, ends }
}

/// Which scripts there are at the change to a layer.
struct LayerChange {
    before: bool,
    after: bool,
    /// Height from which on the layer has changed.
    z: i64,
}

impl LayerChange {
    fn new(layer: &LayerMoves, settings: &WriterSettings) -> Self {
        let scripts = &settings.layer_scripts;
        let runs = layer.index > 0 || scripts.on_first;
        Self {
            before: runs && scripts.before,
            after: runs && scripts.after,
            z: ticks(layer.z_mm, XYZ_DECIMALS),
        }
    }
}

/// Whether a move is part of the print, or right before it.
fn is_bead(step: &Move) -> bool {
    use Move::{Arc, Extrude, Ramp, Unretract};
    matches!(step, Extrude { .. } | Ramp { .. } | Arc { .. } | Unretract { .. })
}

struct Writer<'a> {
    out: Vec<u8>,
    settings: &'a WriterSettings,
    dialect: &'static dyn Dialect,
    x: i64,
    y: i64,
    z: i64,
    /// Feed rate, mm/min.
    f: i64,
    extruder: Extruder,
    /// The requested acceleration, and the ones in force for printing and travel.
    asked: Option<f64>,
    in_force: [Option<f64>; 2],
    /// The current object, where labels are wanted.
    object: Option<u32>,
    /// The height to be stated with the next move: an object before may have been cancelled, its moves with it.
    z_again: Option<i64>,
    type_name: &'static str,
    width: i64,
    height: i64,
    /// Where the script before the change of layer goes.
    change_mark: usize,
    /// The tool in use, where its nozzle is, and the filament of the others.
    tool: ToolId,
    offset_mm: [f64; 2],
    parked: Vec<(ToolId, Extruder)>,
    changes: Vec<ToolMark>,
}

impl<'a> Writer<'a> {
    fn new(layer: &LayerMoves, settings: &'a WriterSettings) -> Self {
        let tool = settings.tools.get(usize::from(layer.from.tool));
        let diameter = tool.map_or(settings.filament_diameter, |tool| tool.filament_diameter);
        Self {
            // A line is some 28 bytes long.
            out: Vec::with_capacity(256 + 32 * layer.moves.len()),
            settings,
            dialect: dialect(settings.flavor),
            x: UNKNOWN,
            y: UNKNOWN,
            z: UNKNOWN,
            f: UNKNOWN,
            extruder: Extruder::new(filament_area_mm2(diameter)),
            asked: None,
            in_force: [None; 2],
            object: None,
            z_again: None,
            type_name: "",
            width: UNKNOWN,
            height: ticks(layer.height_mm, XYZ_DECIMALS),
            change_mark: 0,
            tool: layer.from.tool,
            offset_mm: tool.map_or([0.0; 2], |tool| tool.offset_mm),
            parked: Vec::new(),
            changes: Vec::new(),
        }
    }

    /// The comments at the top, the slot for M73, and E's origin. By `BEFORE_LAYER_CHANGE` and the height after it Moonraker
    /// finds the height of the print; scripts of presets may have them already.
    fn open(&mut self, layer: &LayerMoves) -> Option<Slot> {
        let (z, height) = (text(layer.z_mm, XYZ_DECIMALS), text(layer.height_mm, XYZ_DECIMALS));
        let mut top = format!(";LAYER_CHANGE\n;Z:{z}\n;HEIGHT:{height}\n;LAYER:{}\n", layer.index);
        let scripts = &self.settings.layer_scripts;
        if !scripts.before_is_marked || (layer.index == 0 && !scripts.on_first) {
            top += &format!("{BEFORE_LAYER_CHANGE}\n;{z}\n");
        }
        self.out.extend_from_slice(top.as_bytes());
        self.dialect.layer_begins(&mut self.out, layer.index + 1);
        let slot = self.settings.progress.then(|| {
            let offset = self.out.len();
            self.out.resize(offset + PROGRESS_WIDTH, b' ');
            self.out.push(b'\n');
            Slot { offset, width: PROGRESS_WIDTH, value: Pending::Progress { layer: layer.index } }
        });
        self.change_mark = self.out.len();
        if !self.settings.relative_e {
            self.out.extend_from_slice(b"G92 E0\n");
        }
        slot
    }

    /// Returns where the script after the change of layer goes, and states everything anew that it may have changed.
    fn after_layer_change(&mut self, layer: &LayerMoves) -> usize {
        let mark = self.out.len();
        let scripts = &self.settings.layer_scripts;
        if scripts.modes {
            self.modes();
        } else if !self.settings.relative_e {
            self.origin();
        }
        // Limits may be others now.
        self.in_force = [None; 2];
        if scripts.moves {
            let [x, y, z] = [self.x, self.y, self.z];
            self.forget_position();
            let from = layer.from.xy.map(|xy| self.placed(xy));
            let known = if x == UNKNOWN { from } else { Some([x, y]) };
            if let Some(back) = known {
                self.out.extend_from_slice(b"G1");
                self.xy(back);
                self.feed(scripts.travel_speed);
                self.end_line();
            }
            if z != UNKNOWN {
                self.z = z;
                self.out.extend_from_slice(b"G1");
                push_word(&mut self.out, b'Z', z, XYZ_DECIMALS);
                self.feed(scripts.z_speed);
                self.end_line();
            }
        }
        mark
    }

    /// States how positions and E are counted.
    fn modes(&mut self) {
        self.out.extend_from_slice(b"G90\n");
        if self.settings.relative_e {
            self.out.extend_from_slice(b"M83\n");
        } else {
            self.out.extend_from_slice(b"M82\n");
            self.origin();
        }
    }

    /// States absolute E.
    fn origin(&mut self) {
        self.out.extend_from_slice(b"G92");
        push_word(&mut self.out, b'E', self.extruder.position, E_DECIMALS);
        self.end_line();
    }

    fn forget_position(&mut self) {
        (self.x, self.y, self.z, self.f) = (UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN);
        self.in_force = [None; 2];
    }

    fn step(&mut self, step: &Move) {
        match *step {
            Move::Bead { role, width_mm, height_mm } => self.bead(role, width_mm, height_mm),
            Move::Travel { to, speed } => self.travel(to, 0, speed),
            Move::Climb { to, z_mm, speed } => self.climb(to, z_mm, speed),
            Move::Lift { z_mm, speed } => self.lift(z_mm, speed),
            Move::Extrude { to, volume, speed } => self.draw(to, None, volume, speed),
            Move::Ramp { to, z_mm, volume, speed } => self.ramp(to, z_mm, volume, speed),
            Move::Arc { to, center, clockwise, volume, speed } => {
                self.draw(to, Some((center, clockwise)), volume, speed);
            }
            Move::Retract { .. } if self.settings.firmware_retraction => self.out.extend_from_slice(b"G10\n"),
            Move::Unretract { .. } if self.settings.firmware_retraction => {
                self.out.extend_from_slice(b"G11\n");
            }
            Move::Retract { length_mm, speed } => {
                let retracted = self.extruder.retract(length_mm);
                self.e_only(retracted, speed);
            }
            Move::Unretract { length_mm, speed } => {
                let unretracted = self.extruder.unretract(length_mm);
                self.e_only(unretracted, speed);
            }
            Move::Wipe { to, length_mm, speed } => {
                let retracted = self.extruder.retract(length_mm);
                self.travel(to, retracted, speed);
            }
            Move::Fan(share) => self.dialect.fan(&mut self.out, share),
            Move::Acceleration(acceleration) => self.asked = Some(acceleration.0),
            Move::Nozzle(celsius) => self.heat(b"M104", celsius),
            Move::Bed(celsius) => self.heat(b"M140", celsius),
            Move::Object(object) => self.object(object),
            Move::Pause => self.stop(&self.settings.pause),
            Move::ColorChange if self.settings.color_change.trim().is_empty() => {
                self.stop(&self.settings.pause)
            }
            Move::ColorChange => self.stop(&self.settings.color_change),
            Move::ToolChange(ref change) => self.change_tool(change),
            Move::Swap(step) => self.swap(step),
        }
    }

    fn swap(&mut self, step: SwapStep) {
        match step {
            SwapStep::Take(tool) => line(&mut self.out, &format!("T{tool}")),
            SwapStep::Filament { length_mm, speed } => {
                let fed = self.extruder.feed(length_mm);
                self.e_only(fed, speed);
            }
            SwapStep::Wait(time) => line(&mut self.out, &format!("G4 P{}", text(1000.0 * time.0, 0))),
            SwapStep::PressureAdvance { tool, seconds } => {
                self.dialect.pressure_advance(&mut self.out, tool, seconds);
            }
            SwapStep::Sensor(heeded) => {
                self.out.extend_from_slice(if heeded { b"M591 R\n" } else { b"M591 S0\n" });
            }
            SwapStep::HighCurrent(high) => {
                self.out.extend_from_slice(if high { b"M907 E750\n" } else { b"M907 E550\n" });
            }
        }
    }

    /// Ends the current object and begins another, which depends on no move of the one before: firmware that leaves out a
    /// cancelled object stays where that began.
    fn object(&mut self, object: Option<u32>) {
        let settings = self.settings;
        let name = |object: u32| settings.objects.get(object as usize).map_or("", String::as_str);
        if let Some(before) = self.object.take() {
            if settings.label_commands {
                self.dialect.object_ends(&mut self.out, name(before));
            }
            if settings.label_comments {
                line(&mut self.out, &label_comments(name(before), before as usize)[1]);
            }
        }
        if let Some(now) = object {
            if settings.label_comments {
                line(&mut self.out, &label_comments(name(now), now as usize)[0]);
            }
            if settings.label_commands {
                self.dialect.object_begins(&mut self.out, now, name(now));
            }
            self.z_again = Some(self.z).filter(|z| *z != UNKNOWN).or(self.z_again);
            self.forget_position();
        }
        self.object = object;
    }

    /// Moves in X and Y, feeding this many ticks of filament (for a wipe, negative).
    fn travel(&mut self, to: [f64; 2], fed: i64, speed: MmPerS) {
        let Some(to) = self.onward(to) else { return self.e_only(fed, speed) };
        self.accelerate(Purpose::Travel);
        self.out.extend_from_slice(b"G1");
        self.xy(to);
        self.height_again();
        self.e(fed);
        self.feed(speed);
        self.end_line();
    }

    fn climb(&mut self, to: [f64; 2], z_mm: f64, speed: MmPerS) {
        let (onward, z) = (self.onward(to), ticks(z_mm, XYZ_DECIMALS));
        let Some(to) = onward.filter(|_| z != self.z) else {
            self.lift(z_mm, speed);
            return self.travel(to, 0, speed);
        };
        self.accelerate(Purpose::Travel);
        self.out.extend_from_slice(b"G1");
        self.xy(to);
        self.height(z);
        self.feed(speed);
        self.end_line();
    }

    fn lift(&mut self, z_mm: f64, speed: MmPerS) {
        let z = ticks(z_mm, XYZ_DECIMALS);
        if z != self.z {
            self.out.extend_from_slice(b"G1");
            self.height(z);
            self.feed(speed);
            self.end_line();
        }
    }

    fn height(&mut self, z: i64) {
        (self.z, self.z_again) = (z, None);
        push_word(&mut self.out, b'Z', z, XYZ_DECIMALS);
    }

    fn height_again(&mut self) {
        if let Some(z) = self.z_again {
            self.height(z);
        }
    }

    /// Extrudes on a line, or on an arc around a centre (clockwise or not).
    fn draw(&mut self, to: [f64; 2], arc: Option<([f64; 2], bool)>, volume: Mm3, speed: MmPerS) {
        self.extruder.add(volume.0);
        let Some(to) = self.onward(to) else { return };
        self.accelerate(Purpose::Print);
        if let Some((center, clockwise)) = arc {
            let center = self.placed(center);
            let [i, j] = [center[0] - self.x, center[1] - self.y];
            self.out.extend_from_slice(if clockwise { b"G2" } else { b"G3" });
            self.xy(to);
            push_word(&mut self.out, b'I', i, XYZ_DECIMALS);
            push_word(&mut self.out, b'J', j, XYZ_DECIMALS);
        } else {
            self.out.extend_from_slice(b"G1");
            self.xy(to);
        }
        self.height_again();
        let fed = self.extruder.take();
        self.e(fed);
        self.feed(speed);
        self.end_line();
    }

    /// Extrudes on a line that ends at another height.
    fn ramp(&mut self, to: [f64; 2], z_mm: f64, volume: Mm3, speed: MmPerS) {
        self.extruder.add(volume.0);
        let Some(to) = self.onward(to) else { return self.lift(z_mm, speed) };
        self.accelerate(Purpose::Print);
        self.out.extend_from_slice(b"G1");
        self.xy(to);
        let z = ticks(z_mm, XYZ_DECIMALS);
        if z != self.z {
            self.height(z);
        }
        let fed = self.extruder.take();
        self.e(fed);
        self.feed(speed);
        self.end_line();
    }

    /// Where the machine is told to go for the nozzle to be there.
    fn placed(&self, to: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|i| ticks(to[i] - self.offset_mm[i], XYZ_DECIMALS))
    }

    /// The rounded position, if it differs from the present one.
    fn onward(&self, to: [f64; 2]) -> Option<[i64; 2]> {
        let [x, y] = self.placed(to);
        (x != self.x || y != self.y).then_some([x, y])
    }

    fn xy(&mut self, [x, y]: [i64; 2]) {
        if x != self.x {
            push_word(&mut self.out, b'X', x, XYZ_DECIMALS);
            self.x = x;
        }
        if y != self.y {
            push_word(&mut self.out, b'Y', y, XYZ_DECIMALS);
            self.y = y;
        }
    }

    /// E by `delta` ticks, which the extruder has already counted.
    fn e(&mut self, delta: i64) {
        if delta != 0 {
            let value = if self.settings.relative_e { delta } else { self.extruder.position };
            push_word(&mut self.out, b'E', value, E_DECIMALS);
        }
    }

    fn e_only(&mut self, delta: i64, speed: MmPerS) {
        if delta != 0 {
            self.out.extend_from_slice(b"G1");
            self.e(delta);
            self.feed(speed);
            self.end_line();
        }
    }

    /// F in whole millimetres per minute, rounded down: limits are kept.
    fn feed(&mut self, speed: MmPerS) {
        let f = ((speed.0 * 60.0 + 1e-6) as i64).max(1);
        if f != self.f {
            push_word(&mut self.out, b'F', f, 0);
            self.f = f;
        }
    }

    fn end_line(&mut self) {
        self.out.push(b'\n');
    }

    /// States the requested acceleration, where it is not in force.
    fn accelerate(&mut self, purpose: Purpose) {
        let Some(asked) = self.asked else { return };
        let kept_apart = self.dialect.has_travel_acceleration();
        let slot = &mut self.in_force[usize::from(kept_apart && purpose == Purpose::Travel)];
        if *slot != Some(asked) {
            *slot = Some(asked);
            self.dialect.acceleration(&mut self.out, purpose, MmPerS2(asked));
        }
    }

    fn heat(&mut self, command: &[u8], celsius: Celsius) {
        self.out.extend_from_slice(command);
        push_word(&mut self.out, b'S', ticks(celsius.0, 1), 1);
        self.end_line();
    }

    fn bead(&mut self, role: Role, width_mm: f64, height_mm: f64) {
        let name = role.type_name();
        if name != self.type_name {
            self.type_name = name;
            self.out.extend_from_slice(b";TYPE:");
            self.out.extend_from_slice(name.as_bytes());
            self.end_line();
        }
        let (width, height) = (ticks(width_mm, XYZ_DECIMALS), ticks(height_mm, XYZ_DECIMALS));
        for (label, now, before) in
            [(&b";WIDTH:"[..], width, &mut self.width), (&b";HEIGHT:"[..], height, &mut self.height)]
        {
            if now != *before {
                *before = now;
                self.out.extend_from_slice(label);
                if (0..1000).contains(&now) {
                    self.out.push(b'0');
                }
                if now != 0 {
                    push_fixed(&mut self.out, now, XYZ_DECIMALS);
                }
                self.out.push(b'\n');
            }
        }
    }

    /// The change, then everything that a script may have changed.
    fn change_tool(&mut self, change: &ToolChange) {
        let mark = tool::change(&mut self.out, change, self.settings);
        self.changes.push(mark);
        let own = self.settings.tools.get(usize::from(change.to));
        let place = self.parked.iter().position(|(tool, _)| *tool == change.to);
        let diameter = own.map_or(self.settings.filament_diameter, |own| own.filament_diameter);
        let extruder = match place {
            Some(place) => self.parked.swap_remove(place).1,
            None => Extruder::new(filament_area_mm2(diameter)),
        };
        let before = std::mem::replace(&mut self.extruder, extruder);
        self.parked.push((self.tool, before));
        self.offset_mm = own.map_or([0.0; 2], |own| own.offset_mm);
        self.tool = change.to;
        self.modes();
        self.forget_position();
        self.type_name = "";
    }

    /// The pause, then everything that a script may have changed.
    fn stop(&mut self, script: &str) {
        let own = script.trim_end();
        let lines = if own.is_empty() { self.dialect.pause() } else { own };
        self.out.extend_from_slice(lines.as_bytes());
        self.end_line();
        self.modes();
        self.forget_position();
    }
}
