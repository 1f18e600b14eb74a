//! What ordering minimises.

use super::{Problem, Run, Visit};
use pathwright_geometry::real;

/// What a link leads over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkKind {
    /// It stays inside an island, or leads from one to that above it.
    pub inside: bool,
    /// It leads to another layer, or from or to a place that belongs to none.
    pub climbs: bool,
}

impl LinkKind {
    /// From one island to another of the same layer.
    pub const ACROSS: Self = Self { inside: false, climbs: false };
    /// To another layer, and another island.
    pub const UP: Self = Self { inside: false, climbs: true };
    /// Inside an island.
    pub const INSIDE: Self = Self { inside: true, climbs: false };

    /// From a path of one run to one of another, or of the same.
    pub fn between(from: &Run, to: &Run) -> Self {
        Self::joining(from.place(), to.place())
    }

    #[inline]
    pub(crate) fn joining(from: Place, to: Place) -> Self {
        Self { inside: from.island == to.island, climbs: from.layer != to.layer }
    }
}

/// Where a path is, as far as links depend on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub island: u32,
    pub layer: u32,
}

impl Run {
    pub(crate) fn place(&self) -> Place {
        Place { island: self.island, layer: self.layer }
    }
}

/// Cost of the travel between two paths, a non-decreasing function of its straight-line length that is 0 for none within a
/// layer, so a nearer point of the same island is never more expensive, nor one elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// The length, millimetres. A metric.
    Length,
    /// The time, seconds. No metric: two travels just below the retraction's threshold can take less than
    /// one travel above it.
    Time(TravelTime),
}

/// The parameters of a travel's time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TravelTime {
    /// Top speed, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration from and to rest, mm/s²; 0: none known, the top speed is there at once.
    pub acceleration_mm_s2: f64,
    /// Share of every travel that is not spent on speeding up and slowing down (Klipper's minimum cruise ratio).
    pub cruise_ratio: f64,
    /// Time to stop one bead and start the next, seconds; a bead that continues the last one costs none.
    pub stop_s: f64,
    /// Travels from one island to another that are longer than this are retracted, mm.
    pub retract_from_mm: f64,
    /// Travels inside an island that are longer than this are retracted, mm: no less than the other.
    pub retract_inside_from_mm: f64,
    /// Retracting, lifting, lowering and unretracting, seconds.
    pub retract_s: f64,
    /// Climbing to the next layer, which a travel does on its way, seconds.
    pub climb_s: f64,
}

impl TravelTime {
    /// Duration of a travel in seconds: a trapezoid of speed from rest to rest, the stop and the start of the beads
    /// that it joins, and the retraction where it is due: inside an island or from one to another. Staying in place
    /// takes no time, unless the nozzle climbs.
    #[inline]
    pub fn of(&self, length_mm: f64, kind: LinkKind) -> f64 {
        self.with(&self.moves(), length_mm, kind)
    }

    fn moves(&self) -> Moves {
        Moves::new(self.speed_mm_s, self.acceleration_mm_s2, self.cruise_ratio)
    }

    #[inline]
    fn with(&self, moves: &Moves, length_mm: f64, kind: LinkKind) -> f64 {
        let climb_s = if kind.climbs { self.climb_s } else { 0.0 };
        if length_mm <= 0.0 {
            return if climb_s > 0.0 { self.stop_s + climb_s } else { 0.0 };
        }
        let moving_s = self.stop_s + real::greater(moves.seconds(length_mm), climb_s);
        let retract_from_mm = if kind.inside { self.retract_inside_from_mm } else { self.retract_from_mm };
        if length_mm > retract_from_mm { moving_s + self.retract_s } else { moving_s }
    }
}

/// Seconds from rest to rest, of which at least a share of the distance is cruised.
#[inline]
pub fn trapezoid_s(length_mm: f64, speed: f64, acceleration: f64, cruise_ratio: f64) -> f64 {
    Moves::new(speed, acceleration, cruise_ratio).seconds(length_mm)
}

/// Moves from rest to rest, of any length: what their durations have in common.
#[derive(Clone, Copy, Debug)]
struct Moves {
    /// Of moves that do not reach the top speed, in seconds per root of a millimetre.
    s_per_root_mm: f64,
    /// Length of the shortest that does, millimetres.
    reaches_mm: f64,
    /// What those take more than at top speed all the way, seconds.
    ramps_s: f64,
    /// Top speed, the other way round.
    s_per_mm: f64,
}

impl Moves {
    fn new(speed: f64, acceleration: f64, cruise_ratio: f64) -> Self {
        let s_per_mm = 1.0 / speed;
        if acceleration <= 0.0 {
            return Self { s_per_root_mm: 0.0, reaches_mm: 0.0, ramps_s: 0.0, s_per_mm };
        }
        let ramped = 1.0 - cruise_ratio;
        Self {
            s_per_root_mm: (ramped / acceleration).sqrt() + 1.0 / (acceleration * ramped).sqrt(),
            reaches_mm: speed * speed / (acceleration * ramped),
            ramps_s: speed / acceleration,
            s_per_mm,
        }
    }

    #[inline]
    fn seconds(&self, length_mm: f64) -> f64 {
        if length_mm < self.reaches_mm {
            self.s_per_root_mm * length_mm.sqrt()
        } else {
            self.ramps_s + self.s_per_mm * length_mm
        }
    }
}

/// Seconds of a straight move that begins and ends at these speeds, of which at least a share of the distance is cruised.
pub fn ramped_s(length_mm: f64, ends: [f64; 2], speed: f64, acceleration: f64, cruise_ratio: f64) -> f64 {
    if acceleration <= 0.0 {
        return length_mm / speed;
    }
    let reach_v2 = 2.0 * acceleration * length_mm;
    let [begin, end] = ends;
    let (begin, end) = (begin.min((end * end + reach_v2).sqrt()), end.min((begin * begin + reach_v2).sqrt()));
    let ends_v2 = 0.5 * (begin * begin + end * end);
    let reached_v2 = ends_v2 + 0.5 * reach_v2 * (1.0 - cruise_ratio);
    let reached = speed.min(reached_v2.sqrt()).max(begin).max(end);
    let ramps_mm = (reached * reached - ends_v2) / acceleration;
    (2.0 * reached - begin - end) / acceleration + (length_mm - ramps_mm).max(0.0) / reached
}

impl Cost {
    /// Cost of a travel of this length: millimetres or seconds.
    #[inline]
    pub fn of(&self, length_mm: f64, kind: LinkKind) -> f64 {
        LinkCosts::from(*self).of(length_mm, kind)
    }

    /// The least that a travel of this length can cost.
    #[inline]
    pub fn least(&self, length_mm: f64) -> f64 {
        LinkCosts::from(*self).least(length_mm)
    }
}

/// A cost that is asked for many links: to the bit the same.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LinkCosts {
    /// The length, millimetres.
    Length,
    /// The time, seconds.
    Time(PreparedTime),
}

/// A travel's time with what all travels have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedTime {
    time: TravelTime,
    moves: Moves,
}

impl PreparedTime {
    /// As [`TravelTime::of`].
    #[inline]
    pub fn of(&self, length_mm: f64, kind: LinkKind) -> f64 {
        self.time.with(&self.moves, length_mm, kind)
    }
}

impl From<Cost> for LinkCosts {
    fn from(cost: Cost) -> Self {
        match cost {
            Cost::Length => Self::Length,
            Cost::Time(time) => Self::Time(PreparedTime { time, moves: time.moves() }),
        }
    }
}

impl LinkCosts {
    /// As [`Cost::of`].
    #[inline]
    pub fn of(&self, length_mm: f64, kind: LinkKind) -> f64 {
        match self {
            Self::Length => length_mm,
            Self::Time(time) => time.of(length_mm, kind),
        }
    }

    /// As [`Cost::least`].
    #[inline]
    pub fn least(&self, length_mm: f64) -> f64 {
        self.of(length_mm, LinkKind::INSIDE)
    }
}

/// Total cost of a solution's links: from the start (where it is known) to the first path, between paths, and
/// to the end (where it is known); these two belong to no island and no layer. Summed in the order of the walk, so equal walks give
/// equal bits.
///
/// Every visit must refer to an item and an entry of the problem.
pub fn evaluate(problem: &Problem, sequence: &[Visit], cost: &Cost) -> f64 {
    let links = links(problem, sequence).map(|(length_mm, kind)| cost.of(length_mm, kind));
    let last = sequence.last().map(|visit| problem.items[visit.item as usize].ends(visit.entry).1);
    let end =
        last.or(problem.start).zip(problem.end).map(|(from, to)| cost.of(from.distance_mm(to), LinkKind::UP));
    links.chain(end).sum()
}

/// Length of the link to each visit of a solution, in millimetres, and what it leads over. None leads from anywhere.
pub fn links(problem: &Problem, sequence: &[Visit]) -> impl Iterator<Item = (f64, LinkKind)> {
    let mut at = (problem.start, None);
    sequence.iter().map(move |visit| {
        let item = &problem.items[visit.item as usize];
        let (enter, leave) = item.ends(visit.entry);
        let run = &problem.runs[item.run as usize];
        let (from, left) = std::mem::replace(&mut at, (Some(leave), Some(run)));
        let Some(from) = from else { return (0.0, LinkKind::ACROSS) };
        (from.distance_mm(enter), left.map_or(LinkKind::UP, |left| LinkKind::between(left, run)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIME: TravelTime = TravelTime {
        speed_mm_s: 150.0,
        acceleration_mm_s2: 3000.0,
        cruise_ratio: 0.0,
        stop_s: 0.0,
        retract_from_mm: 1.5,
        retract_inside_from_mm: 5.0,
        retract_s: 0.05,
        climb_s: 0.0,
    };

    #[test]
    fn a_long_travel_cruises_and_is_retracted() {
        assert!((TIME.of(150.0, LinkKind::INSIDE) - (1.0 + 0.05 + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn a_short_travel_never_reaches_top_speed() {
        assert!((TIME.of(0.75, LinkKind::ACROSS) - 2.0 * (0.75f64 / 3000.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_travel_is_free_while_the_nozzle_climbs() {
        let climbing = TravelTime { climb_s: 0.1, stop_s: 0.01, ..TIME };
        let up = |length_mm| climbing.of(length_mm, LinkKind { inside: true, climbs: true });
        assert_eq!([up(0.0), up(1.0)], [0.11, 0.11]);
        assert!(up(15.0) > 0.2);
    }

    #[test]
    fn a_travel_that_need_not_stop_takes_less() {
        let between = |ends| ramped_s(2.0, ends, 150.0, 3000.0, 0.5);
        assert!((between([0.0; 2]) - trapezoid_s(2.0, 150.0, 3000.0, 0.5)).abs() < 1e-12);
        assert!(between([20.0, 0.0]) < between([0.0; 2]) && between([20.0; 2]) < between([20.0, 0.0]));
        assert!((between([20.0, 0.0]) - between([0.0, 20.0])).abs() < 1e-12);
        assert!((ramped_s(30.0, [150.0; 2], 150.0, 3000.0, 0.5) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn half_of_a_short_travel_is_cruised_at_a_cruise_ratio_of_a_half() {
        let half = TravelTime { cruise_ratio: 0.5, ..TIME };
        // Up to 30 mm/s in 0.15 mm and 10 ms, 0.3 mm along in 10 ms, and down.
        assert!((half.of(0.6, LinkKind::ACROSS) - 0.03).abs() < 1e-12, "{}", half.of(0.6, LinkKind::ACROSS));
    }

    #[test]
    fn inside_of_an_island_longer_travels_go_without_retraction() {
        assert_eq!(TIME.of(1.5, LinkKind::ACROSS), TIME.of(1.5, LinkKind::INSIDE));
        assert!((TIME.of(5.0, LinkKind::ACROSS) - TIME.of(5.0, LinkKind::INSIDE) - 0.05).abs() < 1e-12);
        assert_eq!(TIME.of(5.1, LinkKind::ACROSS), TIME.of(5.1, LinkKind::INSIDE));
    }

    #[test]
    fn cost_never_falls_with_length() {
        for inside in [LinkKind::ACROSS, LinkKind::INSIDE] {
            let mut last = 0.0;
            for step in 0..4000 {
                let now = TIME.of(f64::from(step) * 0.01, inside);
                assert!(now >= last);
                last = now;
            }
        }
    }
}
