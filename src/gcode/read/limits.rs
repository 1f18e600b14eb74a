//! What a file says about speeds and accelerations, as the firmware that it is for takes it.

use super::lexer::{Line, Words};
use crate::estimate::{Firmware, Machine};

/// What is in force between lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Accelerations of printing, travel and the extruder alone.
    print: f64,
    travel: f64,
    extruder: f64,
    /// Factor of all speeds (M220).
    pub speed: f64,
}

/// The effect of a command on the time.
pub(super) enum Effect {
    /// The moves before it are brought to an end, then the machine waits this many seconds.
    Wait(f64),
    /// Nothing.
    None,
}

impl Limits {
    pub fn new(machine: &Machine) -> Self {
        Self {
            print: machine.acceleration,
            travel: machine.acceleration,
            extruder: f64::INFINITY,
            speed: 1.0,
        }
    }

    /// The acceleration of a move that only feeds or retracts filament.
    pub fn acceleration(&self, firmware: Firmware, in_space: bool, e_mm: f64) -> f64 {
        let prints = match firmware {
            Firmware::Marlin | Firmware::MarlinClassic => e_mm != 0.0,
            Firmware::Klipper | Firmware::RepRapFirmware => e_mm > 0.0,
        };
        match (in_space, prints) {
            (false, _) => self.extruder,
            (true, true) => self.print,
            (true, false) => self.travel,
        }
    }

    /// Processes a line that is no move.
    pub fn apply(&mut self, line: &Line<'_>, machine: &mut Machine) -> Effect {
        let Some(code) = line.code else {
            if machine.firmware == Firmware::Klipper {
                self.extended(line, machine);
            }
            return Effect::None;
        };
        match (code.letter, code.number) {
            (b'G', 4) => {
                let words = line.words();
                let milliseconds = words.get(b'P').unwrap_or(0.0).max(0.0);
                let seconds = words.get(b'S').filter(|_| machine.firmware != Firmware::Klipper);
                return Effect::Wait(seconds.map_or(milliseconds / 1000.0, |s| s.max(0.0)));
            }
            (b'G', 28) | (b'M', 0 | 1 | 109 | 116 | 190 | 191 | 226 | 400 | 600) => return Effect::Wait(0.0),
            (b'M', 204) => self.accelerations(&line.words(), machine.firmware),
            (b'M', 220) => {
                self.speed = line.words().get(b'S').filter(|s| *s > 0.0).map_or(1.0, |s| s / 100.0)
            }
            (b'M', 201 | 203 | 205 | 566) => axes(code.number, &line.words(), machine),
            (b'M', 207 | 208) => retraction(code.number, &line.words(), machine),
            _ => {}
        }
        Effect::None
    }

    /// M204. Klipper has one acceleration: S, or else the lesser of P and T.
    fn accelerations(&mut self, words: &Words, firmware: Firmware) {
        let given = |letter| words.get(letter).filter(|a| *a > 0.0);
        let (all, print, travel) = (given(b'S'), given(b'P'), given(b'T'));
        if firmware == Firmware::Klipper {
            let one = all.or_else(|| Some(print?.min(travel?)));
            (self.print, self.travel) = (one.unwrap_or(self.print), one.unwrap_or(self.travel));
            return;
        }
        // Marlin 1: S for printing and travel, T for retractions.
        if let (Firmware::MarlinClassic, Some(one), None) = (firmware, all, print) {
            (self.print, self.travel) = (one, one);
            self.extruder = travel.unwrap_or(self.extruder);
            return;
        }
        self.print = print.or(all).unwrap_or(self.print);
        self.travel = travel.or(all).unwrap_or(self.travel);
        if firmware != Firmware::RepRapFirmware {
            self.extruder = given(b'R').unwrap_or(self.extruder);
        }
    }

    /// Klipper's commands with names.
    fn extended(&mut self, line: &Line<'_>, machine: &mut Machine) {
        let text = line.text.split(|b| *b == b';').next().unwrap_or_default();
        let mut words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let Some(command) = words.next() else { return };
        let limits = command.eq_ignore_ascii_case(b"SET_VELOCITY_LIMIT");
        if !limits && !command.eq_ignore_ascii_case(b"SET_RETRACTION") {
            return;
        }
        for word in words {
            let Some(at) = word.iter().position(|b| *b == b'=') else { continue };
            let (key, value) = (word[..at].to_ascii_uppercase(), std::str::from_utf8(&word[at + 1..]));
            let Some(value) = value.ok().and_then(|v| v.parse::<f64>().ok()).filter(|v| *v >= 0.0) else {
                continue;
            };
            match key.as_slice() {
                b"ACCEL" if value > 0.0 => (self.print, self.travel) = (value, value),
                b"VELOCITY" if value > 0.0 => machine.max_speed[0] = value,
                b"SQUARE_CORNER_VELOCITY" => machine.square_corner_velocity = value,
                b"MINIMUM_CRUISE_RATIO" => machine.min_cruise_ratio = value.min(0.99),
                b"RETRACT_LENGTH" => machine.retraction.length_mm = value,
                b"UNRETRACT_EXTRA_LENGTH" => machine.retraction.extra_mm = value,
                b"RETRACT_SPEED" if value > 0.0 => machine.retraction.speed = value,
                b"UNRETRACT_SPEED" if value > 0.0 => machine.retraction.unretract_speed = value,
                _ => {}
            }
        }
    }
}

/// Limits of axes: accelerations (M201), speeds (M203), and what they may step by (M205, M566). Klipper knows none of
/// these commands.
fn axes(number: u32, words: &Words, machine: &mut Machine) {
    if machine.firmware == Firmware::Klipper {
        return;
    }
    // RepRapFirmware's speeds are a minute's.
    let per_minute = machine.firmware == Firmware::RepRapFirmware && number != 201 && number != 205;
    let scale = if per_minute { 1.0 / 60.0 } else { 1.0 };
    if number == 205 {
        machine.junction_deviation_mm =
            words.get(b'J').filter(|j| *j > 0.0).unwrap_or(machine.junction_deviation_mm);
    }
    if number == 566 {
        machine.jerk_everywhere = words.get(b'P').map_or(machine.jerk_everywhere, |policy| policy > 0.0);
    }
    let values = match number {
        201 => &mut machine.max_acceleration,
        203 => &mut machine.max_speed,
        _ => &mut machine.jerk,
    };
    for (value, letter) in values.iter_mut().zip(*b"XYZE") {
        *value = words.get(letter).filter(|v| *v > 0.0).map_or(*value, |v| v * scale);
    }
}

/// Firmware retraction: M207, and M208 for the unretraction. Speeds are a minute's.
fn retraction(number: u32, words: &Words, machine: &mut Machine) {
    let retraction = &mut machine.retraction;
    let length = words.get(b'S').filter(|s| *s >= 0.0);
    let speed = words.get(b'F').filter(|f| *f > 0.0).map(|f| f / 60.0);
    if number == 208 {
        retraction.extra_mm = length.unwrap_or(retraction.extra_mm);
        retraction.unretract_speed = speed.unwrap_or(retraction.unretract_speed);
        return;
    }
    retraction.length_mm = length.unwrap_or(retraction.length_mm);
    retraction.speed = speed.unwrap_or(retraction.speed);
    if machine.firmware == Firmware::RepRapFirmware {
        // There is no M208: R is what goes beyond, T the speed forward.
        retraction.extra_mm = words.get(b'R').unwrap_or(retraction.extra_mm);
        let forward = words.get(b'T').filter(|t| *t > 0.0).map(|t| t / 60.0);
        retraction.unretract_speed = forward.or(speed).unwrap_or(retraction.unretract_speed);
    }
}

#[cfg(test)]
mod tests {
    use super::super::lexer::lines;
    use super::*;
    use crate::profile::Settings;

    fn after(firmware: Firmware, text: &str) -> (Limits, Machine) {
        let mut machine = Machine::under(firmware, &Settings::default());
        let mut limits = Limits::new(&machine);
        for line in lines(text.as_bytes()) {
            limits.apply(&line, &mut machine);
        }
        (limits, machine)
    }

    #[test]
    fn each_firmware_has_its_own_command_for_accelerations() {
        let text = "M204 P500 T700 R900\nSET_VELOCITY_LIMIT ACCEL=1234 SQUARE_CORNER_VELOCITY=7 ; no=1";
        let (marlin, _) = after(Firmware::Marlin, text);
        assert_eq!((marlin.print, marlin.travel, marlin.extruder), (500.0, 700.0, 900.0));
        let (klipper, machine) = after(Firmware::Klipper, text);
        assert_eq!((klipper.print, klipper.travel), (1234.0, 1234.0));
        assert_eq!(machine.square_corner_velocity, 7.0);
        assert_eq!(after(Firmware::Klipper, "M204 P500 T700").0.travel, 500.0);
        assert_eq!(after(Firmware::Klipper, "M204 P500").0.travel, 3000.0);
        assert_eq!(after(Firmware::RepRapFirmware, "M204 S800").0.travel, 800.0);
    }

    #[test]
    fn limits_of_axes_are_a_minutes_in_reprapfirmware_and_unknown_to_klipper() {
        let text = "M203 X6000 E120:120\nM566 X600\nM201 Z50";
        let (_, machine) = after(Firmware::RepRapFirmware, text);
        assert_eq!((machine.max_speed[0], machine.max_speed[3], machine.jerk[0]), (100.0, 2.0, 10.0));
        assert_eq!(machine.max_acceleration[2], 50.0);
        let (_, untouched) = after(Firmware::Klipper, text);
        assert_eq!(untouched, Machine::under(Firmware::Klipper, &Settings::default()));
    }

    #[test]
    fn what_makes_no_sense_is_ignored() {
        let text = "M204 P0 T-5\nM203 X0\nSET_VELOCITY_LIMIT ACCEL=NaN\nSET_VELOCITY_LIMIT\nM220 S0\nM207 F0";
        for (_, firmware) in Firmware::ALL {
            let (limits, machine) = after(firmware, text);
            assert_eq!(machine, Machine::under(firmware, &Settings::default()));
            assert_eq!((limits.print, limits.speed), (machine.acceleration, 1.0));
        }
    }
}
