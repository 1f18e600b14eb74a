//! How long a file takes.

use super::lexer::Line;
use super::replay::{Action, Replay, Stroke, replay};
use crate::estimate::{Machine, Planner, Segment};
use crate::units::Seconds;

/// Arcs are planned as chords of this length, as firmwares do.
const CHORD_MM: f64 = 1.0;

/// The time of all moves, by the machine's limits and the accelerations that the file sets. Heating, homing and
/// pauses take none.
pub fn file_time(text: &[u8], machine: &Machine) -> Seconds {
    time_on(replay(text), machine)
}

/// The time of what is left of a replay, as [`file_time`].
pub fn time_on(steps: Replay<'_>, machine: &Machine) -> Seconds {
    let mut clock = Clock::new(machine);
    for step in steps {
        clock.step(&step.line, &step.action);
    }
    clock.lap()
}

/// Times lines as they come.
#[derive(Clone, Debug)]
pub struct Clock {
    machine: Machine,
    planner: Planner<1>,
    /// Accelerations of printing and travel in force.
    acceleration: [f64; 2],
}

impl Clock {
    /// A clock for a machine at rest.
    pub fn new(machine: &Machine) -> Self {
        Self { machine: *machine, planner: Planner::new(machine), acceleration: [machine.acceleration; 2] }
    }

    /// Takes up a line and what it does.
    pub fn step(&mut self, line: &Line<'_>, action: &Action<'_>) {
        match action {
            Action::Stroke(stroke) => self.push(stroke),
            Action::Other => accelerations(line, &mut self.acceleration),
            _ => {}
        }
    }

    /// The time since the lap before, at the end of which the machine is taken to come to rest.
    pub fn lap(&mut self) -> Seconds {
        let planner = std::mem::replace(&mut self.planner, Planner::new(&self.machine));
        Seconds(planner.finish()[0])
    }

    fn push(&mut self, stroke: &Stroke) {
        let acceleration = self.acceleration[usize::from(stroke.e_mm <= 0.0)];
        let chords =
            if stroke.arc.is_some() { (stroke.xy_mm / CHORD_MM).ceil().clamp(1.0, 1e5) } else { 1.0 };
        let mut from = stroke.from;
        for chord in 1..=chords as u32 {
            let to = stroke.at(f64::from(chord) / chords);
            let delta = [to[0] - from[0], to[1] - from[1], to[2] - from[2], stroke.e_mm / chords];
            self.planner.push(&Segment { delta, speed: stroke.feed_mm_s, acceleration, account: 0 });
            from = to;
        }
    }
}

/// Takes up M204 and Klipper's SET_VELOCITY_LIMIT: accelerations of printing and travel.
fn accelerations(line: &Line<'_>, set: &mut [f64; 2]) {
    if line.code.is_some_and(|c| (c.letter, c.number) == (b'M', 204)) {
        let words = line.words();
        for (letters, value) in [b"SP", b"ST"].into_iter().zip(set) {
            for letter in letters {
                *value = words.get(*letter).filter(|a| *a > 0.0).unwrap_or(*value);
            }
        }
    } else if line.text.starts_with(b"SET_VELOCITY_LIMIT") {
        let text = String::from_utf8_lossy(line.text);
        let given = text.split_whitespace().find_map(|word| word.strip_prefix("ACCEL=")?.parse::<f64>().ok());
        if let Some(acceleration) = given.filter(|a| *a > 0.0) {
            *set = [acceleration; 2];
        }
    }
}
