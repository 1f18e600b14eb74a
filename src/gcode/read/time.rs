//! How long a file takes.

use super::changes::Changes;
use super::lexer::Line;
use super::limits::{Effect, Limits};
use super::replay::{Action, Replay, Stroke, replay};
use crate::estimate::{Machine, Planner, Segment};
use crate::units::Seconds;

/// Arcs are planned as chords of this length, as firmwares do.
const CHORD_MM: f64 = 1.0;

/// The time of all moves, dwells and changes of tool, by the machine's limits and those that the file sets. Homing and pauses take
/// none, heating only after a change.
pub fn file_time(text: &[u8], machine: &Machine) -> Seconds {
    time_on(replay(text), machine)
}

/// The time of what is left of a replay, as [`file_time`].
pub fn time_on(steps: Replay<'_>, machine: &Machine) -> Seconds {
    let mut clock = Clock::new(machine);
    for step in steps {
        clock.step(&step.line, &step.action, 0);
    }
    Seconds(clock.finish().iter().sum())
}

/// Follows a file with the planner, and books the time of every line on an account.
#[derive(Clone, Debug)]
pub struct Clock {
    planner: Planner,
    limits: Limits,
    changes: Changes,
    filament_area_mm2: f64,
}

impl Clock {
    /// A clock for a machine at rest.
    pub fn new(machine: &Machine) -> Self {
        Self {
            planner: Planner::new(machine),
            limits: Limits::new(machine),
            changes: Changes::default(),
            filament_area_mm2: machine.filament_area_mm2,
        }
    }

    /// Processes a line and adds its time to an account.
    pub fn step(&mut self, line: &Line<'_>, action: &Action<'_>, account: usize) {
        match action {
            Action::Stroke(stroke) => self.go(stroke, account),
            Action::FirmwareRetract => {
                let retraction = self.planner.machine().retraction;
                self.feed(-retraction.length_mm, retraction.speed, account);
            }
            Action::FirmwareUnretract => {
                let retraction = self.planner.machine().retraction;
                self.feed(retraction.length_mm + retraction.extra_mm, retraction.unretract_speed, account);
            }
            Action::Type(_) => {}
            Action::Other => {
                if let Effect::Wait(seconds) = self.limits.apply(line, self.planner.machine()) {
                    self.planner.dwell(seconds, account);
                }
                self.changes.line(line, &mut self.planner, account);
            }
        }
    }

    /// The seconds on every account that was used.
    pub fn finish(mut self) -> Vec<f64> {
        let machine = *self.planner.machine();
        let mut seconds = self.planner.finish();
        self.changes.book(&mut seconds, &machine);
        seconds
    }

    fn feed(&mut self, e_mm: f64, speed: f64, account: usize) {
        let acceleration = self.limits.acceleration(self.planner.machine().firmware, false, e_mm);
        self.planner.push(&Segment { delta: [0.0, 0.0, 0.0, e_mm], speed, acceleration, account });
    }

    fn go(&mut self, stroke: &Stroke, account: usize) {
        if stroke.extrudes() {
            self.changes.printed();
        }
        let speed = stroke.feed_mm_s * self.limits.speed;
        let e_mm = if stroke.volumetric { stroke.e_mm / self.filament_area_mm2 } else { stroke.e_mm };
        let in_space = stroke.xy_mm > 0.0 || stroke.from[2] != stroke.to[2];
        let acceleration = self.limits.acceleration(self.planner.machine().firmware, in_space, e_mm);
        let mut from = stroke.from;
        if stroke.arc.is_none() {
            let to = stroke.to;
            let delta = [to[0] - from[0], to[1] - from[1], to[2] - from[2], e_mm];
            return self.planner.push(&Segment { delta, speed, acceleration, account });
        }
        let chords = (stroke.xy_mm / CHORD_MM).ceil().clamp(1.0, 1e5);
        for chord in 1..=chords as u32 {
            let to = stroke.at(f64::from(chord) / chords);
            let delta = [to[0] - from[0], to[1] - from[1], to[2] - from[2], e_mm / chords];
            self.planner.push(&Segment { delta, speed, acceleration, account });
            from = to;
        }
    }
}
