//! Enters loops and open paths where the nozzle goes straight on: a travel without retraction is a corner like any other.
//!
//! The order is kept, so this is a shortest path through layers of candidates, as in the search for entries
//! (Fischetti, Salazar & Toth 1997, doi:10.1287/opre.45.3.378), with links that know directions.

use super::layer::{PathOrder, PathVisit};
use crate::toolpath::{Entries, LayerPaths, Path};
use geometry::real;
use geometry::{Router, distance_mm};
use ordering::{Cost, DetourRule, LinkKind, TravelTime, ramped_s};

/// Loops are tried at vertices this far apart, up to so many on either side of where they are entered.
const STEP_MM: f64 = 0.45;
const EITHER_SIDE: usize = 6;

/// A bead's direction is that of this much of its end.
const END_MM: f64 = 0.1;

/// How often entries are taken back whose links turn out to lead round something.
const ROUNDS: usize = 3;

/// What the corners between beads and travels depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners {
    /// Travel from rest to rest, and retraction.
    pub travel: TravelTime,
    /// Speed of beads, mm/s.
    pub bead_mm_s: f64,
    /// Acceleration of beads, mm/s².
    pub bead_mm_s2: f64,
    /// Square of the speed at a right angle, times √2 − 1, mm²/s².
    pub corner_v2: f64,
    /// Speed at which the extruder starts and stops at once, as that of the nozzle, mm/s.
    pub extruder_mm_s: f64,
}

impl Corners {
    /// Seconds lost by speeding up to a bead's speed, or slowing down from it.
    fn lost_s(&self, corner: f64) -> f64 {
        let less = (self.bead_mm_s - corner).max(0.0);
        less * less / (2.0 * self.bead_mm_s2 * self.bead_mm_s)
    }

    /// The speed of a corner between a bead and a travel, of this cosine: as firmware with a square corner velocity.
    fn corner_mm_s(&self, cosine: f64, travel_mm: f64) -> f64 {
        let half_sine = (0.5 * (1.0 + cosine)).max(0.0).sqrt();
        let half_cosine = (0.5 * (1.0 - cosine)).max(0.0).sqrt();
        let most = self.extruder_mm_s.min(self.bead_mm_s);
        if half_cosine < 1e-4 {
            return most;
        }
        let arc_v2 = self.corner_v2 * half_sine / (1.0 - half_sine);
        let reach_v2 = 0.5 * half_sine / half_cosine * travel_mm * self.travel.acceleration_mm_s2;
        arc_v2.min(reach_v2).sqrt().min(most)
    }

    /// Seconds lost in the corner between an end and a start at the same place, if the nozzle does not stop to extrude.
    fn passed_s(&self, from: &End, to: &End) -> f64 {
        let cosine = from.direction[0] * to.direction[0] + from.direction[1] * to.direction[1];
        let corners = Self { extruder_mm_s: f64::INFINITY, ..*self };
        2.0 * self.lost_s(corners.corner_mm_s(cosine, f64::INFINITY))
    }

    /// Seconds that a path takes less for being entered where it is: a loop that begins in a corner does not pass it.
    fn saved_s(&self, candidate: &Candidate, closed: bool) -> f64 {
        if closed { self.passed_s(&candidate.end, &candidate.begin) } else { 0.0 }
    }

    /// Seconds from the end of one bead to the start of the next.
    fn link_s(&self, from: &End, to: &End, inside: bool) -> f64 {
        let (dx, dy) = (to.at[0] - from.at[0], to.at[1] - from.at[1]);
        let length_mm = real::hypot(dx, dy);
        let travel = &self.travel;
        let retract_from_mm = if inside { travel.retract_inside_from_mm } else { travel.retract_from_mm };
        if length_mm <= 0.0 {
            return self.passed_s(from, to);
        }
        if length_mm > retract_from_mm {
            return travel.of(length_mm, LinkKind { inside, climbs: false });
        }
        let cosine = |end: &End| (dx * end.direction[0] + dy * end.direction[1]) / length_mm;
        let (leave, arrive) =
            (self.corner_mm_s(cosine(from), length_mm), self.corner_mm_s(cosine(to), length_mm));
        self.lost_s(leave)
            + self.lost_s(arrive)
            + ramped_s(
                length_mm,
                [leave, arrive],
                travel.speed_mm_s,
                travel.acceleration_mm_s2,
                travel.cruise_ratio,
            )
    }
}

/// Where a bead begins or ends, and which way it goes there.
#[derive(Clone, Copy, Debug)]
struct End {
    at: [f64; 2],
    direction: [f64; 2],
}

/// One way to draw a path.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    entry: u32,
    begin: End,
    end: End,
}

impl Candidate {
    fn new(path: &Path, entry: u32) -> Self {
        let n = path.points.len();
        let point = |i: usize| path.points[i % n].mm();
        // Along the path from a vertex, forwards or backwards, until far enough to tell the direction.
        let towards = |from: usize, forwards: bool| {
            let at = point(from);
            let steps = if path.closed { n - 1 } else { n - 1 - if forwards { from } else { n - 1 - from } };
            let mut there = at;
            for k in 1..=steps {
                there = point(if forwards { from + k } else { from + n - k });
                if distance_mm(at, there) >= END_MM {
                    break;
                }
            }
            let length_mm = distance_mm(at, there).max(f64::MIN_POSITIVE);
            (at, [0, 1].map(|i| (there[i] - at[i]) / length_mm))
        };
        let begins = |(at, direction)| End { at, direction };
        let ends = |(at, direction): ([f64; 2], [f64; 2])| End { at, direction: direction.map(|d| -d) };
        if path.closed {
            let from = entry as usize;
            return Self { entry, begin: begins(towards(from, true)), end: ends(towards(from, false)) };
        }
        let forwards = entry == 0;
        let (first, last) = if forwards { (0, n - 1) } else { (n - 1, 0) };
        Self { entry, begin: begins(towards(first, forwards)), end: ends(towards(last, !forwards)) }
    }

    /// How a path may be drawn: open ones in both directions, loops from vertices around the one now chosen, which is the
    /// first candidate.
    fn all(path: &Path, entry: u32, allowed: Option<&Entries>, found: &mut Vec<Self>) {
        found.push(Self::new(path, entry));
        if !path.closed {
            found.push(Self::new(path, 1 - entry));
            return;
        }
        let n = path.points.len();
        let mut left = n - 1;
        for forwards in [true, false] {
            let (mut at, mut last) = (entry as usize, path.points[entry as usize]);
            let mut count = 0;
            while count < EITHER_SIDE && left > 0 {
                at = if forwards { at + 1 } else { at + n - 1 } % n;
                left -= 1;
                let is_allowed = || allowed.is_none_or(|a| a.vertices.binary_search(&(at as u32)).is_ok());
                if path.points[at].distance_mm(last) >= STEP_MM && is_allowed() {
                    last = path.points[at];
                    found.push(Self::new(path, at as u32));
                    count += 1;
                }
            }
        }
    }
}

/// How layers are led.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightOn {
    pub corners: Corners,
    pub detours: Option<DetourRule>,
}

impl StraightOn {
    /// A layer's order with entries that take less time. The first and the last path are entered as they are, for the sake of the
    /// layers below and above.
    pub fn enter(&self, layer: &LayerPaths, order: PathOrder) -> PathOrder {
        let count = order.len();
        let mut from = Vec::with_capacity(count + 1);
        let mut all = Vec::with_capacity(8 * count);
        for (i, visit) in order.iter().enumerate() {
            from.push(all.len());
            let path = &layer.paths[visit.path as usize];
            if i == 0 || i + 1 == count {
                all.push(Candidate::new(path, visit.entry));
            } else {
                Candidate::all(path, visit.entry, layer.entries.get(&visit.path), &mut all);
            }
        }
        from.push(all.len());
        let saved: Vec<f64> = (0..count)
            .flat_map(|i| all[from[i]..from[i + 1]].iter().map(move |candidate| (i, candidate)))
            .map(|(i, candidate)| self.corners.saved_s(candidate, layer.paths[order[i].path as usize].closed))
            .collect();
        let island = |i: usize| layer.paths[order[i].path as usize].island;
        let inside: Vec<bool> = (0..count).map(|i| i > 0 && island(i) == island(i - 1)).collect();
        let mut fixed = vec![false; count];
        let mut router = None;
        for _ in 0..ROUNDS {
            let chosen = self.cheapest(&all, &saved, &from, &inside, &fixed);
            let mut again = false;
            for i in 1..count {
                if !inside[i] || (chosen[i] == from[i] && chosen[i - 1] == from[i - 1]) {
                    continue;
                }
                let now = [all[chosen[i - 1]].end.at, all[chosen[i]].begin.at];
                let before = [all[from[i - 1]].end.at, all[from[i]].begin.at];
                let Some(rule) = self.detours else { continue };
                let router = router
                    .get_or_insert_with(|| Router::new(&layer.outline, rule.wall_width_mm, rule.max_mm));
                if self.surcharge_s(rule, router, now) > self.surcharge_s(rule, router, before) + 1e-9 {
                    again |= !(fixed[i] && fixed[i - 1]);
                    (fixed[i - 1], fixed[i]) = (true, true);
                }
            }
            if !again {
                let visits = order.iter().zip(chosen);
                return visits.map(|(visit, at)| PathVisit { entry: all[at].entry, ..*visit }).collect();
            }
        }
        order
    }

    /// How much longer a travel takes than in a straight line.
    fn surcharge_s(&self, rule: DetourRule, router: &Router<'_>, [from, to]: [[f64; 2]; 2]) -> f64 {
        let cost = Cost::Time(self.corners.travel);
        rule.cost(router, &cost, [from, to], false) - cost.of(distance_mm(from, to), LinkKind::INSIDE)
    }

    /// The candidate of each path on the quickest way through all of them; of equal ones the first.
    fn cheapest(
        &self,
        all: &[Candidate],
        saved: &[f64],
        from: &[usize],
        inside: &[bool],
        fixed: &[bool],
    ) -> Vec<usize> {
        let count = inside.len();
        let mut total = vec![0.0; all.len()];
        let mut before = vec![0usize; all.len()];
        let range = |i: usize| from[i]..if fixed[i] { from[i] + 1 } else { from[i + 1] };
        for i in 1..count {
            for to in range(i) {
                let mut best = (f64::INFINITY, from[i - 1]);
                for last in range(i - 1) {
                    let seconds =
                        total[last] + self.corners.link_s(&all[last].end, &all[to].begin, inside[i]);
                    if seconds < best.0 {
                        best = (seconds, last);
                    }
                }
                (total[to], before[to]) = (best.0 - saved[to], best.1);
            }
        }
        let mut chosen = vec![0; count];
        if let Some(last) = count.checked_sub(1) {
            chosen[last] = from[last];
            for i in (0..last).rev() {
                chosen[i] = before[chosen[i + 1]];
            }
        }
        chosen
    }
}
