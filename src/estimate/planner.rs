//! The look-ahead planner: a sequence of straight moves, at rest before and after, and how long they take.
//!
//! Corner speeds follow from junction deviation: the arc that leaves the corner by a fixed distance, taken at
//! the acceleration in force (S. K. Jeon, "Improving Grbl: Cornering Algorithm", 2011), the distance chosen so that a
//! right angle is taken at the square corner velocity (<https://www.klipper3d.org/Kinematics.html>).

use super::Machine;

/// One straight move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Way in X, Y, Z and E, millimetres.
    pub delta: [f64; 4],
    /// Speed asked for, mm/s: along the way in space, or of E where there is none.
    pub speed: f64,
    /// Acceleration asked for, mm/s².
    pub acceleration: f64,
    /// What its time is booked on: one of the planner's accounts.
    pub account: usize,
}

/// Plans moves and adds up their seconds on accounts.
///
/// Only the moves since the machine last stood still are kept, so memory stays small on files of any length.
#[derive(Clone, Debug)]
pub struct Planner<const ACCOUNTS: usize> {
    machine: Machine,
    /// Junction deviation × acceleration of a machine with this square corner velocity.
    corner_v2: f64,
    /// Share of the acceleration that the cruise ratio leaves.
    keep: f64,
    blocks: Vec<Block>,
    last: Option<Last>,
    seconds: [f64; ACCOUNTS],
}

/// Squares of speeds (v2), since v² grows linearly along the way.
#[derive(Clone, Copy, Debug)]
struct Block {
    length_mm: f64,
    acceleration: f64,
    cruise_v2: f64,
    /// How much v² can change on the way, and how much it should where the cruise ratio has a say.
    delta_v2: f64,
    smooth_delta_v2: f64,
    /// Highest speed at its start, first as far as the moves before allow, in the end really.
    start_v2: f64,
    /// The same under the reduced acceleration of the cruise ratio.
    smooth_start_v2: f64,
    account: usize,
}

/// The move before, as far as the next corner needs it.
#[derive(Clone, Copy, Debug)]
struct Last {
    direction: [f64; 3],
    e_per_mm: f64,
    in_space: bool,
}

impl<const ACCOUNTS: usize> Planner<ACCOUNTS> {
    /// A planner for a machine.
    pub fn new(machine: &Machine) -> Self {
        let corner_v2 =
            machine.square_corner_velocity * machine.square_corner_velocity * (2.0_f64.sqrt() - 1.0);
        let keep = 1.0 - machine.min_cruise_ratio.clamp(0.0, 1.0);
        Self { machine: *machine, corner_v2, keep, blocks: Vec::new(), last: None, seconds: [0.0; ACCOUNTS] }
    }

    /// Adds a move. One that goes nowhere is nothing, one on an unknown account takes no time.
    pub fn push(&mut self, segment: &Segment) {
        let [x, y, z, e] = segment.delta;
        let way_mm = (x * x + y * y + z * z).sqrt();
        let in_space = way_mm > 1e-9;
        let length_mm = if in_space { way_mm } else { e.abs() };
        if length_mm <= 1e-9 || !(segment.speed > 0.0 && segment.acceleration > 0.0) {
            return;
        }
        let per_mm = 1.0 / length_mm;
        let unit = segment.delta.map(|d| d * per_mm);
        let (mut speed, mut acceleration) = (segment.speed, segment.acceleration);
        for ((unit, max_speed), max_acceleration) in
            unit.iter().zip(self.machine.max_speed).zip(self.machine.max_acceleration)
        {
            let share = unit.abs();
            if speed * share > max_speed {
                speed = max_speed / share;
            }
            if acceleration * share > max_acceleration {
                acceleration = max_acceleration / share;
            }
        }
        let now = Last { direction: [unit[0], unit[1], unit[2]], e_per_mm: unit[3], in_space };
        let mut block = Block {
            length_mm,
            acceleration,
            cruise_v2: speed * speed,
            delta_v2: 2.0 * length_mm * acceleration,
            // An axis whose limit is lower anyway is not slowed any further.
            smooth_delta_v2: 2.0 * length_mm * acceleration.min(segment.acceleration * self.keep),
            start_v2: 0.0,
            smooth_start_v2: 0.0,
            account: segment.account,
        };
        if !(in_space && self.last.is_some_and(|last| last.in_space)) {
            self.rest();
        } else if let (Some(last), Some(before)) = (self.last, self.blocks.last()) {
            let corner_v2 = self.corner_v2(&last, &now, before, &block);
            block.start_v2 = corner_v2.min(before.start_v2 + before.delta_v2);
            block.smooth_start_v2 = block.start_v2.min(before.smooth_start_v2 + before.smooth_delta_v2);
        }
        self.last = Some(now);
        self.blocks.push(block);
    }

    /// The square of the speed at which the corner between two moves can be taken.
    fn corner_v2(&self, last: &Last, now: &Last, before: &Block, block: &Block) -> f64 {
        let mut v2 = before.cruise_v2.min(block.cruise_v2);
        let e_step = (now.e_per_mm - last.e_per_mm).abs();
        if e_step * e_step * v2
            > self.machine.extruder_corner_velocity * self.machine.extruder_corner_velocity
        {
            v2 = (self.machine.extruder_corner_velocity / e_step).powi(2);
        }
        let (a, b) = (last.direction, now.direction);
        let straightness = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // Half the angle between the two ways seen from the corner: 90° when straight on, 0 when turning back.
        let sine = (0.5 * (1.0 + straightness)).max(0.0).sqrt();
        let cosine = (0.5 * (1.0 - straightness)).max(0.0).sqrt();
        if cosine < 1e-4 {
            return v2;
        }
        let deviation = sine / (1.0 - sine) * self.corner_v2;
        // The arc must not begin before the middle of either move.
        let tangent = 0.5 * sine / cosine;
        let middle = |b: &Block| tangent * b.length_mm * b.acceleration;
        v2.min(deviation).min(middle(before)).min(middle(block))
    }

    /// The seconds on every account, once the machine has come to rest after the last move.
    pub fn finish(mut self) -> [f64; ACCOUNTS] {
        self.rest();
        self.seconds
    }

    /// The machine stands still after the moves so far: books their seconds and forgets them.
    fn rest(&mut self) {
        self.look_back();
        let peaks = self.peaks();
        let (mut before_v2, mut before) = (0.0, 0.0);
        for (i, block) in self.blocks.iter().enumerate() {
            let end_v2 = self.blocks.get(i + 1).map_or(0.0, |next| next.start_v2);
            let reached_v2 = 0.5 * (block.start_v2 + end_v2 + block.delta_v2);
            let limit_v2 = peaks.as_ref().map_or(block.cruise_v2, |peaks| block.cruise_v2.min(peaks[i]));
            let cruise_v2 = reached_v2.min(limit_v2);
            let cruise = cruise_v2.sqrt();
            let (start_v2, end_v2) = (block.start_v2.min(cruise_v2), end_v2.min(cruise_v2));
            let start = if start_v2 == before_v2 { before } else { start_v2.sqrt() };
            let end = if end_v2 == cruise_v2 { cruise } else { end_v2.sqrt() };
            (before_v2, before) = (end_v2, end);
            // Up to cruising speed, along, and down: a ramp is as long as v² changes on it.
            let ramps = (2.0 * cruise_v2 - start_v2 - end_v2) / block.delta_v2;
            let seconds = (2.0 * cruise - start - end) / block.acceleration
                + block.length_mm * (1.0 - ramps).max(0.0) / cruise;
            if let Some(account) = self.seconds.get_mut(block.account) {
                *account += seconds;
            }
        }
        self.blocks.clear();
    }

    /// Lowers start speeds until every move can brake to the next one's, and the last to rest.
    fn look_back(&mut self) {
        let (mut end_v2, mut smooth_end_v2) = (0.0_f64, 0.0_f64);
        for block in self.blocks.iter_mut().rev() {
            block.start_v2 = block.start_v2.min(end_v2 + block.delta_v2);
            block.smooth_start_v2 = block.smooth_start_v2.min(smooth_end_v2 + block.smooth_delta_v2);
            (end_v2, smooth_end_v2) = (block.start_v2, block.smooth_start_v2);
        }
    }

    /// The cruise ratio's limit for each move: the top of the hill of speeds, under reduced acceleration, that
    /// the move is on the slope of.
    fn peaks(&self) -> Option<Vec<f64>> {
        if self.machine.min_cruise_ratio <= 0.0 {
            return None;
        }
        let smooth_end = |i: usize| self.blocks.get(i + 1).map_or(0.0, |next| next.smooth_start_v2);
        let mut peaks: Vec<f64> = Vec::with_capacity(self.blocks.len());
        for (i, block) in self.blocks.iter().enumerate() {
            let delta_v2 = block.smooth_delta_v2;
            let own = 0.5 * (block.smooth_start_v2 + smooth_end(i) + delta_v2);
            let braking = block.smooth_start_v2 >= smooth_end(i) + delta_v2 - 1e-9;
            peaks.push(if braking && i > 0 { peaks[i - 1] } else { own });
        }
        for i in (0..peaks.len().saturating_sub(1)).rev() {
            let block = &self.blocks[i];
            let speeding_up = smooth_end(i) >= block.smooth_start_v2 + block.smooth_delta_v2 - 1e-9;
            if speeding_up {
                peaks[i] = peaks[i + 1];
            }
        }
        Some(peaks)
    }
}

/// Seconds of a straight way from rest to rest: a trapezoid, or a triangle where the top speed is not reached.
pub fn travel_time(distance_mm: f64, speed: f64, acceleration: f64) -> f64 {
    let ramps_mm = speed * speed / acceleration;
    if distance_mm >= ramps_mm {
        speed / acceleration + distance_mm / speed
    } else {
        2.0 * (distance_mm / acceleration).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Settings;
    use proptest::prelude::*;

    fn seconds(machine: &Machine, ways: &[[f64; 4]], speed: f64) -> f64 {
        let mut planner = Planner::<1>::new(machine);
        for &delta in ways {
            planner.push(&Segment { delta, speed, acceleration: 1000.0, account: 0 });
        }
        planner.finish()[0]
    }

    fn machine() -> Machine {
        Machine::new(&Settings::default())
    }

    #[test]
    fn one_move_takes_the_time_of_its_trapezoid() {
        let long = seconds(&machine(), &[[100.0, 0.0, 0.0, 0.0]], 100.0);
        assert!((long - (0.1 + 1.0)).abs() < 1e-12, "{long}");
        assert!((long - travel_time(100.0, 100.0, 1000.0)).abs() < 1e-12);
        let short = seconds(&machine(), &[[4.0, 0.0, 0.0, 0.0]], 100.0);
        assert!((short - travel_time(4.0, 100.0, 1000.0)).abs() < 1e-12);
    }

    #[test]
    fn cutting_a_straight_line_changes_nothing() {
        let whole = seconds(&machine(), &[[100.0, 0.0, 0.0, 2.0]], 100.0);
        let cut = seconds(&machine(), &[[0.5, 0.0, 0.0, 0.01]; 200], 100.0);
        assert!((whole - cut).abs() < 1e-9, "{whole} {cut}");
    }

    #[test]
    fn a_right_angle_is_taken_at_the_square_corner_velocity() {
        let corner = seconds(&machine(), &[[50.0, 0.0, 0.0, 0.0], [0.0, 50.0, 0.0, 0.0]], 100.0);
        // From rest to 100, down to 5, up to 100, to rest again.
        let ramps_s = (100.0 + 95.0 + 95.0 + 100.0) / 1000.0;
        let ramps_mm = (2.0 * 100.0 * 100.0 + 2.0 * (100.0 * 100.0 - 25.0)) / 2000.0;
        assert!((corner - (ramps_s + (100.0 - ramps_mm) / 100.0)).abs() < 1e-9, "{corner}");
    }

    #[test]
    fn axes_keep_their_limits() {
        let machine = machine();
        let lift_s = seconds(&machine, &[[0.0, 0.0, 10.0, 0.0]], 100.0);
        assert!((lift_s - travel_time(10.0, 15.0, 100.0)).abs() < 1e-9);
        let retraction_s = seconds(&machine, &[[0.0, 0.0, 0.0, -6.0]], 60.0);
        assert!((retraction_s - travel_time(6.0, 60.0, 800.0)).abs() < 1e-9);
    }

    #[test]
    fn short_zigzags_are_slower_with_a_cruise_ratio() {
        let zigzag: Vec<[f64; 4]> =
            (0..100).map(|i| [2.0, if i % 2 == 0 { 1.5 } else { -1.5 }, 0.0, 0.1]).collect();
        let free = Machine { min_cruise_ratio: 0.0, ..machine() };
        let smooth = Machine { min_cruise_ratio: 0.5, ..free };
        assert!(seconds(&smooth, &zigzag, 200.0) > 1.05 * seconds(&free, &zigzag, 200.0));
    }

    proptest! {
        #[test]
        fn no_move_is_faster_than_asked_and_slower_speeds_take_longer(
            ways in prop::collection::vec((-5.0..5.0f64, -5.0..5.0f64, 0.0..0.2f64), 1..50),
            ratio in 0.0..0.9f64,
        ) {
            let ways: Vec<[f64; 4]> = ways.into_iter().map(|(x, y, e)| [x, y, 0.0, e]).collect();
            let machine = Machine { min_cruise_ratio: ratio, ..machine() };
            let length: f64 = ways.iter().map(|d| d[0].hypot(d[1])).sum();
            let fast = seconds(&machine, &ways, 100.0);
            prop_assert!(fast.is_finite() && fast >= length / 100.0 - 1e-9);
            prop_assert!(seconds(&machine, &ways, 20.0) >= fast - 1e-9);
        }
    }
}
