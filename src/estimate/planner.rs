//! The look-ahead planner: a sequence of straight moves, at rest before and after, and how long they take.

use geometry::real::{greater, lesser};

use super::corner::CornerMove;
use super::{Firmware, Machine};

/// One straight move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Displacement in X, Y, Z and E, millimetres.
    pub delta: [f64; 4],
    /// Requested speed, mm/s: along the path in space, or of E where there is none.
    pub speed: f64,
    /// Requested acceleration, mm/s².
    pub acceleration: f64,
    /// What its time is booked on, counted from 0.
    pub account: usize,
}

/// This many moves are collected before the planner tries to settle some of them …
const PATIENCE: usize = 256;
/// … and this many at most before it takes the machine to stop.
const MOST_BLOCKS: usize = 1 << 20;

/// Plans moves and adds up their seconds on accounts.
///
/// Moves are forgotten as soon as nothing that follows can change their speeds, so memory stays small on files of
/// any length. The result does not depend on when that is.
#[derive(Clone, Debug)]
pub struct Planner {
    machine: Machine,
    blocks: Vec<Block>,
    last: Option<CornerMove>,
    /// The hill of speeds that the last settled move is on (of the cruise ratio).
    hill_v2: f64,
    hills: Vec<f64>,
    /// Number of moves at which to settle next.
    patience: usize,
    seconds: Vec<f64>,
    /// The seconds on all accounts.
    elapsed_s: f64,
    /// Number of moves that are settled.
    settled: u64,
    /// Marks that are not reached yet: the move that they precede, what is added to their time, and their place.
    ahead: Vec<(u64, f64, usize)>,
    /// When each mark was reached, seconds.
    marks: Vec<f64>,
}

/// Squares of speeds (v2), since v² grows linearly along the path.
#[derive(Clone, Copy, Debug)]
struct Block {
    length_mm: f64,
    acceleration: f64,
    cruise_v2: f64,
    /// How much v² can change along the move, and how much it should where the cruise ratio has a say.
    delta_v2: f64,
    smooth_delta_v2: f64,
    /// Highest speed at its start, first as far as the moves before allow, in the end really.
    start_v2: f64,
    /// The same under the reduced acceleration of the cruise ratio.
    smooth_start_v2: f64,
    /// Speed at which it may end in rest.
    rest_v2: f64,
    account: usize,
}

impl Block {
    /// Whether, under reduced acceleration, it is faster at its end by all that it can gain.
    fn speeds_up_to(&self, smooth_end_v2: f64) -> bool {
        smooth_end_v2 >= self.smooth_start_v2 + self.smooth_delta_v2 - 1e-9
    }

    /// Whether it is slower at its end by all that it can lose.
    fn brakes_to(&self, smooth_end_v2: f64) -> bool {
        self.smooth_start_v2 >= smooth_end_v2 + self.smooth_delta_v2 - 1e-9
    }
}

impl Planner {
    /// A planner for a machine.
    pub fn new(machine: &Machine) -> Self {
        Self {
            machine: *machine,
            blocks: Vec::with_capacity(PATIENCE),
            last: None,
            hill_v2: f64::INFINITY,
            hills: Vec::new(),
            patience: PATIENCE,
            seconds: Vec::new(),
            elapsed_s: 0.0,
            settled: 0,
            ahead: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// The machine, whose limits may be changed for the moves to come.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// Adds a move. One that goes nowhere is nothing.
    pub fn push(&mut self, segment: &Segment) {
        let [x, y, z, e] = segment.delta;
        let space_mm = (x * x + y * y + z * z).sqrt();
        let in_space = space_mm > 1e-9;
        let length_mm = if in_space { space_mm } else { e.abs() };
        if !(length_mm > 1e-9 && segment.speed > 0.0 && segment.acceleration > 0.0) {
            return;
        }
        let per_mm = 1.0 / length_mm;
        let unit = segment.delta.map(|d| d * per_mm);
        let machine = &self.machine;
        let (speed, acceleration) = machine.limited(&unit, in_space, segment.speed, segment.acceleration);
        let now = CornerMove {
            unit,
            direction: machine.direction(segment.delta, unit),
            length_mm,
            in_space,
            speed,
            acceleration,
            asked_acceleration: segment.acceleration,
            rest_speed: machine.rest_speed(&unit, speed),
        };
        // An axis whose limit is lower anyway is not slowed any further.
        let smooth = (segment.acceleration * (1.0 - machine.min_cruise_ratio)).min(acceleration);
        let rest_v2 = now.rest_speed * now.rest_speed;
        let mut block = Block {
            length_mm,
            acceleration,
            cruise_v2: speed * speed,
            delta_v2: 2.0 * length_mm * acceleration,
            smooth_delta_v2: 2.0 * length_mm * smooth,
            start_v2: rest_v2,
            smooth_start_v2: rest_v2,
            rest_v2,
            account: segment.account,
        };
        let corner_v2 = self.last.as_ref().map_or(0.0, |last| machine.corner_v2(last, &now));
        self.last = Some(now);
        match self.blocks.last() {
            Some(before) if corner_v2 > 0.0 => {
                block.start_v2 = lesser(corner_v2, before.start_v2 + before.delta_v2);
                block.smooth_start_v2 =
                    lesser(block.start_v2, before.smooth_start_v2 + before.smooth_delta_v2);
                if self.blocks.len() >= self.patience {
                    self.settle_some();
                }
            }
            Some(_) => self.settle(self.blocks.len()),
            None => {}
        }
        self.blocks.push(block);
    }

    /// The machine stands still for some seconds, after it has come to rest.
    pub fn dwell(&mut self, seconds: f64, account: usize) {
        self.settle(self.blocks.len());
        self.last = None;
        if !self.ahead.is_empty() {
            self.pass();
        }
        self.book(account, seconds);
    }

    /// Marks the moment after the moves so far. `more_s`: seconds up to here that are booked elsewhere.
    pub fn mark(&mut self, place: usize, more_s: f64) {
        self.ahead.push((self.settled + self.blocks.len() as u64, more_s, place));
    }

    /// How long ago a mark was, by the moves that are certain by now; of a machine at rest, by all.
    pub fn since_s(&mut self, place: usize, more_s: f64) -> f64 {
        self.pass();
        if self.ahead.iter().any(|(_, _, ahead)| *ahead == place) {
            return 0.0;
        }
        self.marks.get(place).map_or(0.0, |marked_s| self.elapsed_s + more_s - marked_s)
    }

    /// Notes when the marks are passed that are reached.
    fn pass(&mut self) {
        let (settled, elapsed_s, marks) = (self.settled, self.elapsed_s, &mut self.marks);
        self.ahead.retain(|&(at, more_s, place)| {
            if at <= settled {
                marks.resize(marks.len().max(place + 1), 0.0);
                marks[place] = elapsed_s + more_s;
            }
            at > settled
        });
    }

    /// The seconds of every account, after the machine has stopped behind the last move.
    pub fn finish(mut self) -> Vec<f64> {
        self.settle(self.blocks.len());
        self.seconds
    }

    fn book(&mut self, account: usize, seconds: f64) {
        if account >= self.seconds.len() {
            self.seconds.resize(account + 1, 0.0);
        }
        self.seconds[account] += seconds;
        self.elapsed_s += seconds;
    }

    /// Fixes the speeds of the moves that no later move can change.
    fn settle_some(&mut self) {
        let (mut end_v2, mut smooth_end_v2) =
            self.blocks.last().map_or((0.0, 0.0), |b| (b.rest_v2, b.rest_v2));
        let mut certain = 0;
        for (i, block) in self.blocks.iter().enumerate().skip(1).rev() {
            let (reach_v2, smooth_reach_v2) =
                (end_v2 + block.delta_v2, smooth_end_v2 + block.smooth_delta_v2);
            if block.start_v2 <= reach_v2
                && block.smooth_start_v2 <= smooth_reach_v2
                && !self.blocks[i - 1].speeds_up_to(block.smooth_start_v2)
            {
                certain = i;
                break;
            }
            (end_v2, smooth_end_v2) =
                (lesser(block.start_v2, reach_v2), lesser(block.smooth_start_v2, smooth_reach_v2));
        }
        if certain == 0 && self.blocks.len() >= MOST_BLOCKS {
            certain = self.blocks.len();
        }
        self.settle(certain);
        self.patience = PATIENCE.max(2 * self.blocks.len());
    }

    /// Books the seconds of the first moves and forgets them. If they are all, the machine comes to rest.
    fn settle(&mut self, count: usize) {
        let Some(last) = count.checked_sub(1) else { return };
        let rest_v2 = self.blocks[last].rest_v2;
        let (end_v2, smooth_end_v2) =
            self.blocks.get(count).map_or((rest_v2, rest_v2), |next| (next.start_v2, next.smooth_start_v2));
        self.look_back(count, end_v2, smooth_end_v2);
        if self.machine.min_cruise_ratio > 0.0 && self.machine.firmware == Firmware::Klipper {
            self.climb(count, smooth_end_v2);
        } else {
            self.hills.clear();
            self.hills.resize(count, f64::INFINITY);
        }
        let (mut before_v2, mut before) = (0.0, 0.0);
        for i in 0..count {
            let block = self.blocks[i];
            if !self.ahead.is_empty() {
                self.pass();
            }
            self.settled += 1;
            let end_v2 = if i == last { end_v2 } else { self.blocks[i + 1].start_v2 };
            let reached_v2 = 0.5 * (block.start_v2 + end_v2 + block.delta_v2);
            let cruise_v2 = lesser(lesser(reached_v2, block.cruise_v2), self.hills[i]);
            let cruise = cruise_v2.sqrt();
            let (start_v2, end_v2) = (lesser(block.start_v2, cruise_v2), lesser(end_v2, cruise_v2));
            let start = if start_v2 == before_v2 { before } else { start_v2.sqrt() };
            let end = if end_v2 == cruise_v2 { cruise } else { end_v2.sqrt() };
            (before_v2, before) = (end_v2, end);
            // Up to cruising speed, along, and down: a ramp is as long as v² changes on it.
            let ramps = (2.0 * cruise_v2 - start_v2 - end_v2) / block.delta_v2;
            let seconds = (2.0 * cruise - start - end) / block.acceleration
                + block.length_mm * greater(1.0 - ramps, 0.0) / cruise;
            self.book(block.account, seconds);
        }
        self.hill_v2 = if count == self.blocks.len() { f64::INFINITY } else { self.hills[last] };
        self.blocks.drain(..count);
    }

    /// Lowers start speeds until every one of the first moves can brake to the next one's.
    fn look_back(&mut self, count: usize, mut end_v2: f64, mut smooth_end_v2: f64) {
        for block in self.blocks[..count].iter_mut().rev() {
            block.start_v2 = lesser(block.start_v2, end_v2 + block.delta_v2);
            block.smooth_start_v2 = lesser(block.smooth_start_v2, smooth_end_v2 + block.smooth_delta_v2);
            (end_v2, smooth_end_v2) = (block.start_v2, block.smooth_start_v2);
        }
    }

    /// The cruise ratio's limit for each of the first moves: the top of the hill of speeds, under reduced
    /// acceleration, that the move is on the slope of.
    fn climb(&mut self, count: usize, smooth_end_v2: f64) {
        let ends = |blocks: &[Block], i: usize| {
            if i + 1 == count { smooth_end_v2 } else { blocks[i + 1].smooth_start_v2 }
        };
        self.hills.clear();
        for (i, block) in self.blocks[..count].iter().enumerate() {
            let end_v2 = ends(&self.blocks, i);
            let own = 0.5 * (block.smooth_start_v2 + end_v2 + block.smooth_delta_v2);
            let before = self.hills.last().copied().unwrap_or(self.hill_v2);
            self.hills.push(if block.brakes_to(end_v2) && before.is_finite() { before } else { own });
        }
        for i in (0..count.saturating_sub(1)).rev() {
            if self.blocks[i].speeds_up_to(ends(&self.blocks, i)) {
                self.hills[i] = self.hills[i + 1];
            }
        }
    }
}

/// Seconds of a straight move from rest to rest: a trapezoid, or a triangle where the top speed is not reached.
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

    fn seconds(machine: &Machine, moves: &[[f64; 4]], speed: f64) -> f64 {
        let mut planner = Planner::new(machine);
        for &delta in moves {
            planner.push(&Segment { delta, speed, acceleration: 1000.0, account: 0 });
        }
        planner.finish()[0]
    }

    fn under(firmware: Firmware) -> Machine {
        Machine { min_cruise_ratio: 0.0, ..Machine::under(firmware, &Settings::default()) }
    }

    fn machine() -> Machine {
        under(Firmware::Klipper)
    }

    /// 50 mm and 50 mm more at 100 mm/s and 1000 mm/s², begun, joined and ended at these speeds.
    fn two_moves(ends: f64, corner: f64) -> f64 {
        let ramps_s = 2.0 * (100.0 - ends + 100.0 - corner) / 1000.0;
        let ramps_mm = 2.0 * (2.0 * 100.0 * 100.0 - ends * ends - corner * corner) / 2000.0;
        ramps_s + (100.0 - ramps_mm) / 100.0
    }

    #[test]
    fn each_firmware_takes_a_right_angle_by_its_own_rule() {
        let moves = [[50.0, 0.0, 0.0, 0.0], [0.0, 50.0, 0.0, 0.0]];
        // The default machine: 5 mm/s at 1500 mm/s², so at 1000 mm/s² Marlin's arc allows less.
        let deviation = 5.0 * (1000.0_f64 / 1500.0).sqrt();
        for (firmware, ends, corner) in [
            (Firmware::Klipper, 0.0, 5.0),
            (Firmware::Marlin, 0.0, deviation),
            (Firmware::MarlinClassic, 10.0, 10.0),
            (Firmware::RepRapFirmware, 0.0, 10.0),
        ] {
            let (got, wanted) = (seconds(&under(firmware), &moves, 100.0), two_moves(ends, corner));
            assert!((got - wanted).abs() < 1e-6, "{firmware:?}: {got} {wanted}");
        }
    }

    #[test]
    fn turning_back_is_a_stop_or_as_fast_as_jerk_allows() {
        let moves = [[50.0, 0.0, 0.0, 0.0], [-50.0, 0.0, 0.0, 0.0]];
        for (firmware, ends, corner) in [
            (Firmware::Klipper, 0.0, 0.0),
            (Firmware::Marlin, 0.0, 0.0),
            (Firmware::MarlinClassic, 10.0, 10.0),
            // Jerk is the whole step of an axis here, and half of it is each move's.
            (Firmware::RepRapFirmware, 0.0, 5.0),
        ] {
            let (got, wanted) = (seconds(&under(firmware), &moves, 100.0), two_moves(ends, corner));
            assert!((got - wanted).abs() < 1e-6, "{firmware:?}: {got} {wanted}");
        }
    }

    #[test]
    fn a_dwell_adds_its_seconds_and_two_stops() {
        let mut planner = Planner::new(&machine());
        let segment =
            Segment { delta: [50.0, 0.0, 0.0, 0.0], speed: 100.0, acceleration: 1000.0, account: 0 };
        planner.push(&segment);
        planner.dwell(2.5, 1);
        planner.push(&segment);
        let seconds = planner.finish();
        assert!((seconds[0] - two_moves(0.0, 0.0)).abs() < 1e-9 && seconds[1] == 2.5, "{seconds:?}");
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
        fn settling_early_changes_nothing(
            moves in prop::collection::vec((-2.0..2.0f64, -0.5..2.0f64, 0.0..0.2f64), 600..1500),
            firmware in 0..4usize,
        ) {
            let machine = Machine::under(Firmware::ALL[firmware].1, &Settings::default());
            let (mut early, mut late) = (Planner::new(&machine), Planner::new(&machine));
            (early.patience, late.patience) = (8, usize::MAX);
            for (x, y, e) in moves {
                let segment = Segment { delta: [x, y, 0.0, e], speed: 80.0, acceleration: 500.0, account: 0 };
                early.push(&segment);
                late.push(&segment);
            }
            prop_assert!(early.blocks.len() < late.blocks.len());
            let (early, late) = (early.finish()[0], late.finish()[0]);
            prop_assert!((early - late).abs() < 1e-9 * late, "{early} {late}");
        }

        #[test]
        fn no_move_is_faster_than_asked_and_slower_speeds_take_longer(
            moves in prop::collection::vec((-5.0..5.0f64, -5.0..5.0f64, 0.0..0.2f64), 1..50),
            ratio in 0.0..0.9f64,
        ) {
            let moves: Vec<[f64; 4]> = moves.into_iter().map(|(x, y, e)| [x, y, 0.0, e]).collect();
            let machine = Machine { min_cruise_ratio: ratio, ..machine() };
            let length: f64 = moves.iter().map(|d| d[0].hypot(d[1])).sum();
            let fast = seconds(&machine, &moves, 100.0);
            prop_assert!(fast.is_finite() && fast >= length / 100.0 - 1e-9);
            prop_assert!(seconds(&machine, &moves, 20.0) >= fast - 1e-9);
        }
    }
}
