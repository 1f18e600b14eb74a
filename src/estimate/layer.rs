//! The time of one layer, by what it is spent on.

use super::Machine;
use super::chords::chords;
use super::planner::{Planner, Segment};
use crate::motion::{LayerMoves, Move, SwapStep};
use crate::toolpath::Role;
use crate::units::Seconds;

const TRAVEL: usize = 0;
const RETRACTION: usize = 1;
const CHANGES: usize = 2;
const ROLES: usize = 3;
/// Travel, retraction, changes of tool, and every role.
const ACCOUNTS: usize = ROLES + Role::ALL.len();

/// How long a layer takes, and where the time goes. Pauses take none, heating only where a tool is waited for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayerTime {
    accounts: [f64; ACCOUNTS],
}

impl LayerTime {
    /// All of it.
    pub fn total(&self) -> Seconds {
        Seconds(self.accounts.iter().sum())
    }

    /// Moves without extrusion, in X, Y and Z.
    pub fn travel(&self) -> Seconds {
        Seconds(self.accounts[TRAVEL])
    }

    /// Retracting and unretracting in place.
    pub fn retraction(&self) -> Seconds {
        Seconds(self.accounts[RETRACTION])
    }

    /// Changes of tool.
    pub fn changes(&self) -> Seconds {
        Seconds(self.accounts[CHANGES])
    }

    /// Extruding a role.
    pub fn role(&self, role: Role) -> Seconds {
        Seconds(self.accounts[ROLES + role as usize])
    }

    /// Extruding.
    pub fn printing(&self) -> Seconds {
        Seconds(self.accounts[ROLES..].iter().sum())
    }
}

impl std::ops::AddAssign for LayerTime {
    fn add_assign(&mut self, other: Self) {
        for (mine, theirs) in self.accounts.iter_mut().zip(other.accounts) {
            *mine += theirs;
        }
    }
}

/// The time of a layer, at rest at its start and end. O(moves).
pub fn layer_time(layer: &LayerMoves, machine: &Machine) -> LayerTime {
    let mut walk = Walk::new(layer, machine);
    for step in &layer.moves {
        walk.step(step);
    }
    let mut time = LayerTime::default();
    for (account, seconds) in time.accounts.iter_mut().zip(walk.planner.finish()) {
        *account = seconds;
    }
    time.accounts[CHANGES] += changes_s(&layer.moves);
    time
}

/// How long changes of tool take, and waiting for tools that were changed to.
fn changes_s(moves: &[Move]) -> f64 {
    let changes =
        moves.iter().filter_map(|step| if let Move::ToolChange(change) = step { Some(change) } else { None });
    changes.map(|change| change.time.0 + change.wait.0).sum()
}

/// How long each move of a layer takes, at rest at its start and end, seconds. O(moves).
pub fn move_times_s(layer: &LayerMoves, machine: &Machine) -> Vec<f64> {
    let mut walk = Walk::new(layer, machine);
    for (index, step) in layer.moves.iter().enumerate() {
        walk.only = Some(index);
        walk.step(step);
    }
    let mut seconds = walk.planner.finish();
    seconds.resize(layer.moves.len(), 0.0);
    for (seconds, step) in seconds.iter_mut().zip(&layer.moves) {
        *seconds += changes_s(std::slice::from_ref(step));
    }
    seconds
}

/// The machine's state along the layer.
struct Walk {
    planner: Planner,
    at: Option<[f64; 2]>,
    z_mm: f64,
    acceleration: f64,
    /// Account of the role being extruded.
    account: usize,
    /// The account for everything, whatever it is.
    only: Option<usize>,
    e_per_mm3: f64,
}

impl Walk {
    fn new(layer: &LayerMoves, machine: &Machine) -> Self {
        Self {
            planner: Planner::new(machine),
            at: layer.from.xy,
            z_mm: layer.from.z_mm,
            acceleration: machine.acceleration,
            account: ROLES,
            only: None,
            e_per_mm3: 1.0 / machine.filament_area_mm2,
        }
    }

    fn step(&mut self, step: &Move) {
        match *step {
            Move::Bead { role, .. } => self.account = ROLES + role as usize,
            Move::Travel { to, speed } => self.go(to, 0.0, speed.0, TRAVEL),
            Move::Climb { to, z_mm, speed } => {
                let at = self.at.unwrap_or(to);
                self.push([to[0] - at[0], to[1] - at[1], z_mm - self.z_mm, 0.0], speed.0, TRAVEL);
                (self.at, self.z_mm) = (Some(to), z_mm);
            }
            Move::Wipe { to, length_mm, speed } => self.go(to, -length_mm, speed.0, TRAVEL),
            Move::Extrude { to, volume, speed } => {
                self.go(to, volume.0 * self.e_per_mm3, speed.0, self.account)
            }
            Move::Ramp { to, z_mm, volume, speed } => self.ramp(to, z_mm, volume.0 * self.e_per_mm3, speed.0),
            Move::Arc { to, center, clockwise, volume, speed } => {
                self.arc(to, center, clockwise, volume.0 * self.e_per_mm3, speed.0);
            }
            Move::Lift { z_mm, speed } => {
                self.push([0.0, 0.0, z_mm - self.z_mm, 0.0], speed.0, TRAVEL);
                self.z_mm = z_mm;
            }
            Move::Retract { length_mm, speed } => self.feed(-length_mm, speed.0),
            Move::Unretract { length_mm, speed } => self.feed(length_mm, speed.0),
            Move::Acceleration(acceleration) => self.acceleration = acceleration.0,
            Move::Fan(_) | Move::Nozzle(_) | Move::Bed(_) | Move::Object(_) => {}
            Move::Pause | Move::ColorChange | Move::ToolChange(_) => {}
            Move::Swap(SwapStep::Filament { length_mm, speed }) => self.feed(length_mm, speed.0),
            Move::Swap(SwapStep::Wait(time)) => self.planner.dwell(time.0, self.only.unwrap_or(RETRACTION)),
            Move::Swap(
                SwapStep::Take(_)
                | SwapStep::PressureAdvance { .. }
                | SwapStep::Sensor(_)
                | SwapStep::HighCurrent(_),
            ) => {}
        }
    }

    fn push(&mut self, delta: [f64; 4], speed: f64, account: usize) {
        let account = self.only.unwrap_or(account);
        self.planner.push(&Segment { delta, speed, acceleration: self.acceleration, account });
    }

    /// Moves filament alone, as fast as the extruder allows.
    fn feed(&mut self, e_mm: f64, speed: f64) {
        let delta = [0.0, 0.0, 0.0, e_mm];
        let account = self.only.unwrap_or(RETRACTION);
        self.planner.push(&Segment { delta, speed, acceleration: f64::INFINITY, account });
    }

    fn go(&mut self, to: [f64; 2], e_mm: f64, speed: f64, account: usize) {
        // A move from an unknown position takes no time that could be known.
        if let Some(at) = self.at {
            self.push([to[0] - at[0], to[1] - at[1], 0.0, e_mm], speed, account);
        }
        self.at = Some(to);
    }

    fn ramp(&mut self, to: [f64; 2], z_mm: f64, e_mm: f64, speed: f64) {
        if let Some(at) = self.at {
            self.push([to[0] - at[0], to[1] - at[1], z_mm - self.z_mm, e_mm], speed, self.account);
        }
        (self.at, self.z_mm) = (Some(to), z_mm);
    }

    fn arc(&mut self, to: [f64; 2], center: [f64; 2], clockwise: bool, e_mm: f64, speed: f64) {
        let Some(at) = self.at else {
            self.at = Some(to);
            return;
        };
        let (count, ends) = chords(at, to, center, clockwise);
        for end in ends {
            self.go(end, e_mm / count, speed, self.account);
        }
    }
}
