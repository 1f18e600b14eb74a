//! What ordering minimises.

use super::{Problem, Visit};
use crate::geom::Point;
use crate::profile::{AccelerationSettings, CostKind, RetractSettings, SpeedSettings};

/// Cost of the travel between two paths, a non-decreasing function of its straight-line length with
/// `cost(0) = 0`, so a nearer point is never dearer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cost {
    /// The length, millimetres. A metric.
    Length,
    /// The time, seconds. No metric: two travels just below the retraction's threshold can take less than
    /// one travel above it.
    Time(TravelTime),
}

/// What the time of a travel depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TravelTime {
    /// Top speed, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration from and to rest, mm/s²; 0: none known, the top speed is there at once.
    pub acceleration_mm_s2: f64,
    /// Travels at least this long are retracted, mm.
    pub retract_from_mm: f64,
    /// Pulling back, lifting, lowering and pushing forward again, seconds.
    pub retract_s: f64,
}

impl TravelTime {
    /// Duration of a travel in seconds: a trapezoid of speed from rest to rest, and the retraction where
    /// it is due. Staying in place takes no time.
    #[inline]
    pub fn of(&self, length_mm: f64) -> f64 {
        if length_mm <= 0.0 {
            return 0.0;
        }
        let (speed, acceleration) = (self.speed_mm_s, self.acceleration_mm_s2);
        let moving_s = if acceleration <= 0.0 {
            length_mm / speed
        } else if length_mm * acceleration < speed * speed {
            2.0 * (length_mm / acceleration).sqrt()
        } else {
            length_mm / speed + speed / acceleration
        };
        if length_mm >= self.retract_from_mm { moving_s + self.retract_s } else { moving_s }
    }
}

impl Cost {
    /// The cost that the settings ask for. With firmware retraction, whose lengths and speeds the firmware
    /// keeps, the profile's values are the best guess.
    pub fn new(
        kind: CostKind,
        speed: &SpeedSettings,
        acceleration: &AccelerationSettings,
        retract: &RetractSettings,
    ) -> Self {
        let seconds = |way_mm: f64, speed_mm_s: f64| if speed_mm_s > 0.0 { way_mm / speed_mm_s } else { 0.0 };
        let retracted_mm = retract.length.0;
        let retract_s = if retracted_mm > 0.0 {
            seconds(retracted_mm, retract.speed.0)
                + seconds(retracted_mm + retract.extra.0, retract.unretract_speed.0)
                + 2.0 * seconds(retract.z_hop.0, speed.z.0)
        } else {
            0.0
        };
        match kind {
            CostKind::Length => Self::Length,
            CostKind::Time => Self::Time(TravelTime {
                speed_mm_s: speed.travel.0,
                acceleration_mm_s2: if acceleration.travel.0 > 0.0 {
                    acceleration.travel.0
                } else {
                    acceleration.default.0
                },
                retract_from_mm: retract.min_travel.0,
                retract_s,
            }),
        }
    }

    /// Cost of a travel of this length: millimetres or seconds.
    #[inline]
    pub fn of(&self, length_mm: f64) -> f64 {
        match self {
            Self::Length => length_mm,
            Self::Time(time) => time.of(length_mm),
        }
    }

    /// Cost of the straight travel between two points.
    #[inline]
    pub fn link(&self, from: Point, to: Point) -> f64 {
        self.of(from.distance_mm(to))
    }
}

/// Total cost of a solution's links: from the start (where it is known) to the first path, between paths, and
/// to the end (where it is known). Summed in the order of the walk, so equal walks give equal bits.
///
/// Every visit must refer to an item and an entry of the problem.
pub fn evaluate(problem: &Problem, sequence: &[Visit], cost: &Cost) -> f64 {
    let mut total = 0.0;
    let mut at = problem.start;
    for visit in sequence {
        let (enter, leave) = problem.items[visit.item as usize].ends(visit.entry);
        total += at.map_or(0.0, |from| cost.link(from, enter));
        at = Some(leave);
    }
    match (at, problem.end) {
        (Some(from), Some(to)) => total + cost.link(from, to),
        _ => total,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIME: TravelTime =
        TravelTime { speed_mm_s: 150.0, acceleration_mm_s2: 3000.0, retract_from_mm: 1.5, retract_s: 0.05 };

    #[test]
    fn a_long_travel_cruises_and_is_retracted() {
        assert!((TIME.of(150.0) - (1.0 + 0.05 + 0.05)).abs() < 1e-12);
    }

    #[test]
    fn a_short_travel_never_reaches_top_speed() {
        assert!((TIME.of(0.75) - 2.0 * (0.75f64 / 3000.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn cost_never_falls_with_length() {
        let mut last = 0.0;
        for step in 0..4000 {
            let now = TIME.of(f64::from(step) * 0.01);
            assert!(now >= last);
            last = now;
        }
    }
}
