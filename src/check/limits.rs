//! What the machine can do: speeds and accelerations.

use geometry::real;

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::estimate::{Firmware, Machine};
use crate::gcode::Stroke;
use crate::profile::Settings;

/// Speeds are rounded.
const SLACK: f64 = 1.01;
const AXES: [char; 4] = ['X', 'Y', 'Z', 'E'];

/// Compares speeds and accelerations of the file with the limits of the machine.
pub(super) struct Limits {
    machine: Machine,
    /// Factor of all speeds (M220).
    speed: f64,
}

impl Limits {
    pub fn new(settings: &Settings) -> Self {
        Self { machine: Machine::new(settings), speed: 1.0 }
    }

    fn stroke(&self, stroke: &Stroke, seen: &LineContext<'_>, found: &mut Found) {
        let e_mm = if stroke.volumetric { stroke.e_mm / self.machine.filament_area_mm2 } else { stroke.e_mm };
        let [dx, dy, dz] = [0, 1, 2].map(|i| (stroke.to[i] - stroke.from[i]).abs());
        let xy_mm = stroke.xy_mm;
        let ahead = if stroke.arc.is_some() { [xy_mm, xy_mm] } else { [dx, dy] };
        let distance_mm = if xy_mm > 0.0 || dz > 0.0 { real::hypot(xy_mm, dz) } else { e_mm.abs() };
        if distance_mm <= 1e-9 {
            return;
        }
        let rate = stroke.feed_mm_s * self.speed / distance_mm;
        for (i, part_mm) in [ahead[0], ahead[1], dz, e_mm.abs()].into_iter().enumerate() {
            let (speed, most) = (part_mm * rate, self.machine.max_speed[i]);
            // Height and filament beside a bead so short that they are mostly rounding say nothing.
            if speed > most * SLACK && (i < 2 || xy_mm == 0.0 || xy_mm > 0.2) {
                let axis = AXES[i];
                seen.fault(found, Kind::Speed, || {
                    format!("{axis} at {speed:.1} mm/s; it reaches {most} mm/s")
                });
                return;
            }
        }
    }

    fn accelerations(
        &self,
        given: impl IntoIterator<Item = (f64, f64)>,
        seen: &LineContext<'_>,
        found: &mut Found,
    ) {
        for (asked, most) in given {
            if asked > most * SLACK {
                seen.fault(found, Kind::Acceleration, || {
                    format!("{asked:.0} mm/s²; the machine has {most:.0}: {}", seen.text())
                });
                return;
            }
        }
    }
}

impl Rule for Limits {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        if let Some(stroke) = seen.stroke() {
            return self.stroke(stroke, seen, found);
        }
        let most = self.machine.max_acceleration;
        let level = most[0].max(most[1]);
        let Some(code) = seen.line.code else {
            if seen.named().is_some_and(|name| name.eq_ignore_ascii_case(b"SET_VELOCITY_LIMIT")) {
                let text = String::from_utf8_lossy(seen.line.text).to_ascii_uppercase();
                let asked = text.split_whitespace().find_map(|word| word.strip_prefix("ACCEL="));
                let asked = asked.and_then(|value| value.parse().ok());
                self.accelerations(asked.map(|asked| (asked, level)), seen, found);
            }
            return;
        };
        let words = || seen.line.words();
        match (code.letter, code.number) {
            (b'M', 220) => self.speed = words().get(b'S').filter(|s| *s > 0.0).map_or(1.0, |s| s / 100.0),
            (b'M', 204) => {
                let words = words();
                // Marlin 1: T for retractions.
                let legacy = self.machine.firmware == Firmware::MarlinClassic && words.get(b'S').is_some();
                let [level_letters, extruder_letter] =
                    if legacy { [&b"SP"[..], b"T"] } else { [&b"SPT"[..], b"R"] };
                let asked = level_letters.iter().filter_map(|letter| Some((words.get(*letter)?, level)));
                let extruder = words.get(extruder_letter[0]).map(|asked| (asked, most[3]));
                self.accelerations(asked.chain(extruder), seen, found);
            }
            (b'M', 201) if self.machine.firmware != Firmware::Klipper => {
                let words = words();
                let asked =
                    b"XYZE".iter().zip(most).filter_map(|(letter, most)| Some((words.get(*letter)?, most)));
                self.accelerations(asked, seen, found);
            }
            _ => {}
        }
    }
}
