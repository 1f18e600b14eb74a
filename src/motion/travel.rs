//! Travels from the end of one bead to the start of the next: inside the part where that is possible, retracted where
//! it is long.

use super::nozzle::Nozzle;
use super::{MotionSettings, Move, Stop};
use crate::toolpath::IslandId;
use crate::units::{Mm3, MmPerS};
use geometry::real;
use geometry::{Clipper, Point, Route, distance_mm, polyline_length_mm};

/// Heights are sums of layers, and positions rounded.
const TOLERANCE_MM: f64 = 1e-4;

/// Shorter ways are too short to rise on: the nozzle goes straight up.
const SHORTEST_SLOPE_MM: f64 = 0.5;

impl Nozzle<'_> {
    /// Moves to where the next bead, one of this island, starts, at the height of the layer.
    ///
    /// A travel *longer* than `retract.min_travel`, or inside the part than `travel.retract_inside`, or from an
    /// unknown place, is retracted, but not within the prime tower. The nozzle climbs to the next layer while it
    /// travels, or before where the travel is no longer than high; never does it go down, or to where something may
    /// obstruct it, before it is above.
    pub(super) fn travel(&mut self, to: [f64; 2], island: Option<IslandId>, stop: Option<Stop>) {
        let pause = stop.is_some();
        let (retract, travel) = (&self.settings.retract, &self.settings.travel);
        let arriving = !self.positioned || self.z_mm != self.layer_z_mm;
        // An object depends on no move of another, which may be cancelled.
        let begins = matches!(self.moves.last(), Some(Move::Object(_)));
        if self.at == Some(to) && !arriving && !pause && !begins {
            return;
        }
        let same_island = self.island.is_none_or(|last| last == island);
        self.island = Some(island);
        let mut route = self.route(to, same_island);
        let far = self.at.is_none_or(|at| match route {
            _ if self.within_tower => false,
            Route::Inside(_, length_mm) => length_mm > travel.retract_inside.0.max(retract.min_travel.0),
            Route::Across => distance_mm(at, to) > retract.min_travel.0,
        });
        let leaves = self.beside_mm > 0.0 && (!self.positioned || !same_island);
        let beside_mm = if leaves { self.beside_mm + self.hop_mm() } else { 0.0 };
        let over_mm = (std::mem::take(&mut self.over_mm).max(beside_mm) - self.layer_z_mm).max(0.0);
        if over_mm > 0.0 {
            route = Route::Across;
        }
        let rises =
            retract.layer_change && !self.positioned && self.layer_z_mm > self.z_mm && self.rules.index() > 0;
        let before_mm = std::mem::take(&mut self.retracted_mm);
        let retracted = (far || rises || pause || over_mm > 0.0) && retract.length.0 > 0.0 || before_mm > 0.0;
        if before_mm > 0.0 {
            let length_mm = retract.length.0 - before_mm;
            if length_mm > 0.0 {
                self.moves.push(Move::Retract { length_mm, speed: retract.speed });
            }
        } else if retracted && self.retract() && over_mm <= 0.0 {
            route = self.route(to, same_island);
        }
        if let Some(stop) = stop {
            self.moves.push(match stop {
                Stop::Pause => Move::Pause,
                Stop::ColorChange => Move::ColorChange,
            });
            route = Route::Across;
        }
        let hops = retracted && (route == Route::Across || retract.z_hop_inside);
        let hop_mm = if hops { self.hop_mm().max(over_mm) } else { over_mm };
        let mut stops = match route {
            Route::Inside(between, _) => between,
            Route::Across => Vec::new(),
        };
        stops.push(to);
        let climb_mm = self.layer_z_mm - self.z_mm;
        let first_mm = self.at.map_or(0.0, |at| distance_mm(at, stops[0]));
        let climbs = climb_mm > 0.0 && first_mm > climb_mm && hop_mm <= 0.0 && !pause;
        let slope = (hop_mm > 0.0 && over_mm <= 0.0 && !pause).then(|| self.slope(&stops, hop_mm)).flatten();
        if slope.is_none() && !climbs && (arriving || pause || hop_mm > 0.0) {
            self.lift(self.layer_z_mm + hop_mm);
        }
        self.accelerate(None);
        let (speed, z_mm) = (self.settings.speed.travel, self.layer_z_mm);
        if let Some(slope) = slope {
            self.moves.extend(slope);
        } else {
            let mut climb = climbs.then(|| self.climb_speed(first_mm, climb_mm));
            self.moves.extend(stops.into_iter().map(|to| match climb.take() {
                Some(speed) => Move::Climb { to, z_mm, speed },
                None => Move::Travel { to, speed },
            }));
        }
        self.positioned = true;
        if hop_mm > 0.0 {
            self.lift(self.layer_z_mm);
        }
        if retracted {
            let length_mm = retract.length.0.max(before_mm);
            self.moves.push(Move::Unretract { length_mm, speed: retract.unretract_speed });
            if !retract.firmware {
                self.extra_mm3 = retract.extra.0 * self.settings.flow.filament_area_mm2;
            }
        }
        self.at = Some(to);
        self.z_mm = self.layer_z_mm;
    }

    /// How to get from where the nozzle is to a place, on the same island or another. Not called where nothing
    /// depends on it.
    fn route(&self, to: [f64; 2], same_island: bool) -> Route {
        let MotionSettings { travel, retract, .. } = self.settings;
        let matters = travel.avoid_crossing
            || travel.retract_inside > retract.min_travel
            || (retract.z_hop.0 > 0.0 && !retract.z_hop_inside);
        match self.at {
            Some(at) if matters && same_island => self.router.route(at, to),
            _ => Route::Across,
        }
    }

    /// How far travels lift the nozzle on this layer.
    pub(super) fn hop_mm(&self) -> f64 {
        let retract = &self.settings.retract;
        let z_mm = self.layer_z_mm - self.settings.z_offset.0;
        let (low_mm, high_mm) = (retract.z_hop_above.0, retract.z_hop_below.0);
        let lifts = z_mm + TOLERANCE_MM >= low_mm && (high_mm <= 0.0 || z_mm <= high_mm + TOLERANCE_MM);
        if lifts { retract.z_hop.0 } else { 0.0 }
    }

    /// A travel over these stops that rises at an angle, as long as it is inside the part where that is wanted; `None`: straight up.
    fn slope(&self, stops: &[[f64; 2]], hop_mm: f64) -> Option<Vec<Move>> {
        let degrees = self.settings.retract.z_hop_slope;
        let at = self.at.filter(|_| degrees < 90.0)?;
        let rise_mm = self.layer_z_mm + hop_mm - self.z_mm;
        let way: Vec<[f64; 2]> = std::iter::once(at).chain(stops.iter().copied()).collect();
        let way_mm: f64 = way.windows(2).map(|w| distance_mm(w[0], w[1])).sum();
        let inside_mm =
            if self.settings.retract.z_hop_before_leaving { self.inside_mm(&way) } else { way_mm };
        let angled_mm = rise_mm / real::tan(degrees.to_radians());
        // A way that ends before is not risen to the top, but to the layer at least.
        let climb_mm = self.layer_z_mm - self.z_mm;
        let slope_mm = match inside_mm + TOLERANCE_MM < way_mm {
            true => inside_mm.min(angled_mm),
            false if climb_mm > 0.0 => angled_mm.min(way_mm * rise_mm / climb_mm),
            false => angled_mm,
        };
        (rise_mm > 0.0 && slope_mm.min(way_mm) >= SHORTEST_SLOPE_MM)
            .then(|| self.sloped(&way, slope_mm, rise_mm))
    }

    /// How far a way stays inside the part, from its beginning on.
    fn inside_mm(&self, way: &[[f64; 2]]) -> f64 {
        let points: Vec<Point> = way.iter().map(|&[x, y]| Point::from_mm(x, y)).collect();
        let clipper = self.clipper.get_or_init(|| Clipper::new(self.outline));
        let first = clipper.clip(&points).into_iter().next();
        let begins = first.filter(|piece| piece.points.first() == points.first());
        begins.map_or(0.0, |piece| polyline_length_mm(&piece.points))
    }

    /// The moves along a way whose first `slope_mm` rise by `rise_mm`.
    fn sloped(&self, way: &[[f64; 2]], slope_mm: f64, rise_mm: f64) -> Vec<Move> {
        let (mut moves, mut gone_mm) = (Vec::new(), 0.0);
        let (travel, climb) = (self.settings.speed.travel, self.climb_speed(slope_mm, rise_mm));
        let z_mm = |gone_mm: f64| self.z_mm + rise_mm * (gone_mm / slope_mm).min(1.0);
        for pair in way.windows(2) {
            let (left_mm, length_mm) = (slope_mm - gone_mm, distance_mm(pair[0], pair[1]));
            gone_mm += length_mm;
            if left_mm <= 0.0 {
                moves.push(Move::Travel { to: pair[1], speed: travel });
            } else if length_mm <= left_mm {
                moves.push(Move::Climb { to: pair[1], z_mm: z_mm(gone_mm), speed: climb });
            } else {
                let to = [0, 1].map(|i| pair[0][i] + left_mm / length_mm * (pair[1][i] - pair[0][i]));
                moves.push(Move::Climb { to, z_mm: z_mm(slope_mm), speed: climb });
                moves.push(Move::Travel { to: pair[1], speed: travel });
            }
        }
        moves
    }

    /// The travel speed, unless Z would be faster than it may.
    fn climb_speed(&self, length_mm: f64, climb_mm: f64) -> MmPerS {
        let speed = &self.settings.speed;
        MmPerS(speed.travel.0.min(speed.z.0 * real::hypot(length_mm, climb_mm) / climb_mm))
    }

    pub(super) fn lift(&mut self, z_mm: f64) {
        self.moves.push(Move::Lift { z_mm, speed: self.settings.speed.z });
    }

    /// Pulls the filament back, no faster than `retract.speed`: while wiping, as far as `retract.wipe` says, or in
    /// place. Whether it moved.
    pub(super) fn retract(&mut self) -> bool {
        let retract = &self.settings.retract;
        let (length_mm, speed) = (retract.length.0, retract.speed);
        coast(&mut self.moves, retract.coast.0);
        let is_wiped = !retract.firmware && retract.before_wipe.0 < 1.0;
        let wipe = if is_wiped { std::mem::take(&mut self.wipe) } else { Vec::new() };
        let wipe_mm: f64 = wipe.windows(2).map(|w| distance_mm(w[0], w[1])).sum();
        if wipe_mm <= 0.0 {
            self.moves.push(Move::Retract { length_mm, speed });
            return false;
        }
        let before_mm = retract.before_wipe.0 * length_mm;
        if before_mm > 0.0 {
            self.moves.push(Move::Retract { length_mm: before_mm, speed });
        }
        let left_mm = length_mm - before_mm;
        let wipe_speed = wipe_speed(self.settings, wipe_mm, left_mm);
        for w in wipe.windows(2) {
            let share = distance_mm(w[0], w[1]) / wipe_mm;
            self.moves.push(Move::Wipe { to: w[1], length_mm: left_mm * share, speed: wipe_speed });
        }
        self.at = wipe.last().copied();
        true
    }
}

/// The nozzle's speed that takes as long over the wipe as pulling back the rest of the filament would take in place, at
/// most the travel speed.
fn wipe_speed(settings: &MotionSettings, wipe_mm: f64, left_mm: f64) -> MmPerS {
    let speed = wipe_mm * settings.retract.speed.0 / left_mm;
    MmPerS(speed.min(settings.speed.travel.0))
}

/// The first `wipe_mm` of a path; all of it where it is shorter.
pub(super) fn wipe_path(points: impl Iterator<Item = [f64; 2]>, wipe_mm: f64) -> Vec<[f64; 2]> {
    let mut path: Vec<[f64; 2]> = Vec::new();
    let mut left_mm = wipe_mm;
    for p in points {
        let Some(&from) = path.last() else {
            path.push(p);
            continue;
        };
        if left_mm <= 0.0 {
            break;
        }
        let length_mm = distance_mm(from, p);
        if length_mm > left_mm {
            let t = left_mm / length_mm;
            path.push([from[0] + t * (p[0] - from[0]), from[1] + t * (p[1] - from[1])]);
            break;
        }
        if length_mm > 0.0 {
            path.push(p);
            left_mm -= length_mm;
        }
    }
    path
}

/// Stops feeding on the last `coast_mm` of the lines drawn last; a line that begins before is cut there.
fn coast(moves: &mut Vec<Move>, coast_mm: f64) {
    let (mut left_mm, mut on) = (coast_mm, Vec::new());
    while left_mm > 0.0 {
        let Some(&Move::Extrude { to, volume, speed }) = moves.last() else { break };
        let Some(from) = moves[..moves.len() - 1].iter().rev().find_map(end_of) else { break };
        moves.pop();
        let length_mm = distance_mm(from, to);
        on.push(Move::Travel { to, speed });
        if length_mm > left_mm {
            let share = 1.0 - left_mm / length_mm;
            let cut = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
            moves.push(Move::Extrude { to: cut, volume: Mm3(share * volume.0), speed });
        }
        left_mm -= length_mm;
    }
    moves.extend(on.into_iter().rev());
}

/// Where a move ends, if it goes anywhere.
fn end_of(step: &Move) -> Option<[f64; 2]> {
    match step {
        Move::Travel { to, .. }
        | Move::Climb { to, .. }
        | Move::Wipe { to, .. }
        | Move::Extrude { to, .. }
        | Move::Ramp { to, .. }
        | Move::Arc { to, .. } => Some(*to),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wipe_goes_as_far_as_it_is_long() {
        let path = [[3.0, 1.0], [3.0, 0.0], [0.0, 0.0]];
        assert_eq!(wipe_path(path.into_iter(), 2.0), [[3.0, 1.0], [3.0, 0.0], [2.0, 0.0]]);
        assert_eq!(wipe_path(path.into_iter(), 99.0), path);
        assert!(wipe_path([].into_iter(), 1.0).is_empty());
    }

    #[test]
    fn coasting_feeds_nothing_on_the_last_stretch() {
        let speed = MmPerS(40.0);
        let line = |x: f64| Move::Extrude { to: [x, 0.0], volume: Mm3(1.0), speed };
        let mut moves = vec![Move::Travel { to: [0.0; 2], speed }, line(10.0), line(10.5)];
        coast(&mut moves, 1.5);
        assert_eq!(
            moves[1..],
            [
                Move::Extrude { to: [9.0, 0.0], volume: Mm3(0.9), speed },
                Move::Travel { to: [10.0, 0.0], speed },
                Move::Travel { to: [10.5, 0.0], speed },
            ]
        );
    }
}
