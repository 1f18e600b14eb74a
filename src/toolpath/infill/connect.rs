//! Joins the ends of infill lines along the boundary, so that a line ends where the next one begins.

use geometry::real;
use geometry::{Boundary, BoundaryPos, Point, Region};

use super::caps::{self, Cap, Caps};
use super::spec::{Chord, Joins, Stop};
use crate::toolpath::bead::Line;

/// Chords of solid fills shorter than this many line distances touch an extreme of the boundary, which a bead along
/// it fills better.
const SHORTEST: f64 = 0.5;

/// Where a line turns back sharply, it leaves its line this many line distances before the boundary.
const BACK: f64 = 0.75;

/// Ratio of how far such a line runs sideways into the wedge to how far it runs beyond the boundary.
const SIDEWAYS: f64 = 1.2;

/// Lines that meet the boundary steeper than this reach beyond it beside a cap, too: sine of the angle.
const STEEP: f64 = 0.65;

/// A line ends this many of its widths before a narrow bead beside its end, to which it goes on.
const OVERLAP: f64 = 0.15;

/// Turns of nearly a right angle: cosine of the angle,
const SQUARE: f64 = 0.2;

/// are pressed this many line distances into the wall, so that their round corners leave no void there.
const PRESSED: f64 = 0.08;

/// Where the boundary goes this many line distances further than the lines on both sides of it, one of them follows it.
const NOTCH: f64 = 0.6;

/// The share of their width that lines have there and back.
const IN_NOTCH: f32 = 0.4;

/// Positions on the boundary are points of the grid, off by less than this.
const ROUNDING_MM: f64 = 2e-5;

/// Ends are followed in so many steps.
const STEPS: u32 = 8;

/// Anchors take up less than half of the distance to the next end, whose own may come towards them.
const ANCHOR: f64 = 0.45;

/// Joins chords into longer lines.
///
/// A line continues from its end to the neighbouring end on the boundary, in either direction, if the distance there is
/// at most as long as allowed; the nearer one where both are free. Chords are taken in the order given, each line
/// grows at both ends. O(n log n).
pub fn connect(region: &Region, mut chords: Vec<Chord>, joins: &Joins) -> Vec<Line> {
    if let Some(hatch) = joins.hatch {
        chords.retain(|c| c.end(0).distance_mm(c.end(1)) >= SHORTEST * hatch.distance_mm);
    }
    let boundary = Boundary::new(region);
    merge(&mut chords, &boundary, joins);
    let around = Around::new(&boundary, &chords);
    let caps =
        joins.hatch.map_or_else(Vec::new, |hatch| caps::find(&boundary, &around.stops, &chords, hatch));
    let caps = Caps::new(caps);
    let mut joiner =
        Joiner { boundary, around, chords: &chords, joins, caps, used: vec![false; chords.len()] };
    let mut lines: Vec<Line> = (0..chords.len()).filter_map(|first| joiner.line(first)).collect();
    let distance_mm = joins.distance_mm();
    lines.extend(joiner.caps.into_unused(distance_mm).filter_map(|bead| {
        let (points, spacing_mm) = bead.into_iter().unzip();
        Line { points, spacing_mm, closed: false }.sound()
    }));
    lines
}

/// Makes one chord of straight ones in line whose ends would meet beyond the boundary, as where a line passes a corner.
fn merge(chords: &mut Vec<Chord>, boundary: &Boundary<'_>, joins: &Joins) {
    chords.dedup_by(|next, last| {
        let ([a, b], [c, d]) = (&last.points[..], &next.points[..]) else { return false };
        // A curve may bend beyond the boundary.
        let on_line = |p: Point| geometry::to_segment_mm(p.mm(), a.mm(), d.mm()) <= ROUNDING_MM;
        if last.line != next.line || !on_line(*b) || !on_line(*c) {
            return false;
        }
        let gap_mm = b.distance_mm(*c);
        if gap_mm > 2.0 * joins.furthest_mm() {
            return false;
        }
        let reach_mm = |on: Option<BoundaryPos>, from: Point, end: Point| {
            on.and_then(|on| boundary.direction(on).map(|edge| (on, edge))).map_or(0.0, |(on, edge)| {
                let out = (end - from).mm();
                let length = real::hypot(out[0], out[1]).max(f64::MIN_POSITIVE);
                let out = out.map(|w| w / length);
                within(boundary, on, end.mm(), out, joins.reach_mm, joins.along_mm(joins.reach_mm, out, edge))
            })
        };
        let meet = gap_mm <= reach_mm(last.ends[1], *a, *b) + reach_mm(next.ends[0], *d, *c);
        if meet {
            last.points[1] = *d;
            last.ends[1] = next.ends[1];
        }
        meet
    });
}

/// How much of the distance `by_mm` from an end on the boundary, in a direction, is at most `across_mm` outside of all edges
/// there: a line that meets an edge at a small angle just before a corner would go on through the wall beyond that.
fn within(
    boundary: &Boundary<'_>,
    on: BoundaryPos,
    [x, y]: [f64; 2],
    out: [f64; 2],
    across_mm: f64,
    by_mm: f64,
) -> f64 {
    let reaches = |mm: f64| boundary.reaches(on, [x + mm * out[0], y + mm * out[1]], across_mm + ROUNDING_MM);
    // Beyond a narrow wall it may be near the boundary again.
    let step_mm = by_mm / f64::from(STEPS);
    let Some(beyond_mm) = (1..=STEPS).map(|step| f64::from(step) * step_mm).find(|&mm| !reaches(mm)) else {
        return by_mm;
    };
    let [mut least_mm, mut most_mm] = [beyond_mm - step_mm, beyond_mm];
    while most_mm - least_mm > ROUNDING_MM {
        let middle_mm = f64::midpoint(least_mm, most_mm);
        *(if reaches(middle_mm) { &mut least_mm } else { &mut most_mm }) = middle_mm;
    }
    least_mm
}

struct Joiner<'a> {
    boundary: Boundary<'a>,
    around: Around,
    chords: &'a [Chord],
    joins: &'a Joins,
    caps: Caps,
    used: Vec<bool>,
}

/// A line in the making: vertices with their spacing.
type Bead = Vec<(Point, f32)>;

impl Joiner<'_> {
    /// The line that grows from a chord; `None` of one that another line has taken up.
    fn line(&mut self, first: usize) -> Option<Line> {
        if std::mem::replace(&mut self.used[first], true) {
            return None;
        }
        let nominal = self.joins.distance_mm() as f32;
        let mut bead: Bead = self.chords[first].points.iter().map(|&p| (p, nominal)).collect();
        for side in [1, 0] {
            let mut at = (first, side);
            while let Some((join, next)) = self.over_a_cap(at).or_else(|| {
                let (join, next) =
                    self.around.next(&self.boundary, self.chords, &self.used, at, self.joins)?;
                Some((join.into_iter().map(|p| (p, nominal)).collect(), next))
            }) {
                self.used[next.0] = true;
                let chord = &self.chords[next.0].points;
                let mut onward: Bead = chord.iter().map(|&p| (p, nominal)).collect();
                if next.1 == 1 {
                    onward.reverse();
                }
                let ahead = *join.first().unwrap_or(&onward[0]);
                let behind = *join.last().or(bead.last()).unwrap_or(&ahead);
                self.reach(&mut bead, at, Some(ahead));
                onward.reverse();
                self.reach(&mut onward, next, Some(behind));
                onward.reverse();
                bead.extend(join);
                bead.extend(onward);
                at = (next.0, 1 - next.1);
            }
            if !self.end_in_a_cap(&mut bead, at) && !self.anchor(&mut bead, at, nominal) {
                self.reach(&mut bead, at, None);
            }
            bead.reverse();
        }
        bead.dedup_by_key(|v| v.0);
        let (points, spacing_mm): (Vec<Point>, Vec<f32>) = bead.into_iter().unzip();
        let varies = spacing_mm.iter().any(|&s| s != nominal);
        Line { points, spacing_mm: if varies { spacing_mm } else { Vec::new() }, closed: false }.sound()
    }

    /// The join over a cap that leads to a chord, where that is free.
    fn over_a_cap(&mut self, (chord, side): (usize, usize)) -> Option<(Bead, (usize, usize))> {
        if self.joins.longest_mm <= 0.0 {
            return None;
        }
        let end = (chord as u32, side as u8);
        let used = &self.used;
        let beyond = |cap: &Cap| cap.ends[usize::from(cap.ends[0] == end)];
        let cap = self.caps.free_beside(end, |cap| used.get(beyond(cap).0 as usize) == Some(&false))?;
        let (next, next_side) = beyond(cap);
        Some((cap.take(end), (next as usize, next_side as usize)))
    }

    /// Lets a line that ends here fill the cap beside its end.
    fn end_in_a_cap(&mut self, bead: &mut Bead, (chord, side): (usize, usize)) -> bool {
        let end = (chord as u32, side as u8);
        let Some(cap) = self.caps.free_beside(end, |_| true) else {
            return false;
        };
        let beyond = cap.take(end);
        let ahead = beyond.first().copied();
        self.reach(bead, (chord, side), ahead);
        bead.extend(beyond);
        true
    }

    /// Leads a bead on along the boundary, where it is longer free.
    fn anchor(&self, bead: &mut Bead, (chord, side): (usize, usize), spacing_mm: f32) -> bool {
        let Some(on) = self.chords[chord].ends[side].filter(|_| self.joins.anchor_mm > 0.0) else {
            return false;
        };
        let free_mm = self.around.beside(chord, side).map(|(stop, ahead)| {
            let (from, to) = if ahead { (on, stop.on) } else { (stop.on, on) };
            let length_mm = self.boundary.forward_mm(from, to).filter(|&mm| mm > 0.0);
            (length_mm.unwrap_or(self.boundary.ring_length_mm(on.ring)), ahead)
        });
        let (longest_mm, ahead) = if free_mm[1].0 > free_mm[0].0 { free_mm[1] } else { free_mm[0] };
        let anchor = self.boundary.walk(on, self.joins.anchor_mm.min(ANCHOR * longest_mm), ahead);
        bead.extend(anchor.into_iter().map(|p| (p, spacing_mm)));
        true
    }

    /// Moves the last point of a bead on along its line, beyond the boundary, if it is a free end or turns back
    /// sharply to `ahead`; in the latter case also away from there along the boundary, into the wedge. At a square turn it is
    /// moved a little, beside a narrow bead that it goes on to a little back, and where the boundary has a notch, into that.
    fn reach(&self, bead: &mut Bead, (chord, side): (usize, usize), ahead: Option<(Point, f32)>) {
        let (Some(on), [.., before, last]) = (self.chords[chord].ends[side], bead.as_mut_slice()) else {
            return;
        };
        let Some(edge) = self.boundary.direction(on) else {
            return;
        };
        let from = before.0.mm();
        let [x, y] = last.0.mm();
        let length = real::hypot(x - from[0], y - from[1]);
        if let Some(deepest) = self.notch((chord, side), ahead.map(|v| v.0)) {
            let (end, spacing_mm) = (last.0, last.1);
            bead.push((deepest, IN_NOTCH * spacing_mm));
            if ahead.is_some() {
                bead.push((end, IN_NOTCH * spacing_mm));
            }
            return;
        }
        let beside_cap = || self.caps.any_beside((chord as u32, side as u8));
        let across_mm = if ahead.is_some() { self.joins.turn_reach_mm } else { self.joins.reach_mm };
        if across_mm <= 0.0 || length <= 0.0 {
            return;
        }
        let out = [(x - from[0]) / length, (y - from[1]) / length];
        if (out[0] * edge[1] - out[1] * edge[0]).abs() < STEEP && beside_cap() {
            let by_mm = OVERLAP * f64::from(last.1);
            if by_mm < length / 2.0 && ahead.is_some_and(|(_, spacing_mm)| spacing_mm < 0.5 * last.1) {
                last.0 = Point::from_mm(x - by_mm * out[0], y - by_mm * out[1]);
            }
            return;
        }
        if let Some(ahead) = ahead.map(|v| v.0.mm()) {
            let to = [ahead[0] - x, ahead[1] - y];
            let cosine = (to[0] * out[0] + to[1] * out[1]) / real::hypot(to[0], to[1]);
            if cosine.is_nan() || cosine > -SQUARE {
                if cosine < SQUARE {
                    let by_mm = PRESSED * self.joins.distance_mm();
                    last.0 = Point::from_mm(x + by_mm * out[0], y + by_mm * out[1]);
                }
                return;
            }
        }
        let by = self.joins.along_mm(across_mm, out, edge);
        let by = within(&self.boundary, on, [x, y], out, across_mm, by);
        let mut tip = [0, 1].map(|k| [x, y][k] + by * out[k]);
        if let Some(ahead) = ahead.map(|v| v.0.mm()) {
            // The join comes from one side; the wedge is on the other.
            let back_mm = BACK * self.joins.distance_mm();
            let from_ahead = edge[0] * (x - ahead[0]) + edge[1] * (y - ahead[1]);
            tip = [0, 1].map(|k| tip[k] + SIDEWAYS * across_mm * edge[k] * from_ahead.signum());
            if back_mm < length / 2.0 {
                let spacing_mm = last.1;
                last.0 = Point::from_mm(x - back_mm * out[0], y - back_mm * out[1]);
                bead.push((Point::from_mm(tip[0], tip[1]), spacing_mm));
                return;
            }
        }
        last.0 = Point::from_mm(tip[0], tip[1]);
    }

    /// The deepest position of a notch in the boundary between this end and one of a neighbouring line that it is not joined
    /// to, if this end is the nearer one.
    fn notch(&self, (chord, side): (usize, usize), ahead: Option<Point>) -> Option<Point> {
        let hatch = self.joins.hatch?;
        let own = &self.chords[chord];
        let on = own.ends[side]?;
        let sign = if side == 1 { 1.0 } else { -1.0 };
        let depth_mm = |p: Point, end: Point| sign * hatch.direction().along_mm(p - end);
        let end = own.end(side);
        self.around.beside(chord, side).into_iter().find_map(|(stop, is_ahead)| {
            let other = &self.chords[stop.chord as usize];
            if usize::from(stop.side) != side || (other.line - own.line).abs() != 1 {
                return None;
            }
            let other_end = other.end(side);
            let arc = self.boundary.vertices_between(on, stop.on, is_ahead);
            if ahead.is_some_and(|ahead| arc.contains(&ahead)) {
                return None;
            }
            let deep_mm = |p: &Point| depth_mm(*p, end).min(depth_mm(*p, other_end));
            let deepest = arc.into_iter().max_by(|a, b| deep_mm(a).total_cmp(&deep_mm(b)))?;
            let is_own = deepest.distance_mm(end) <= deepest.distance_mm(other_end);
            (is_own && deep_mm(&deepest) > NOTCH * hatch.distance_mm).then_some(deepest)
        })
    }
}

/// The ends of all chords, sorted along the boundary.
struct Around {
    stops: Vec<Stop>,
    /// Index into `stops` of both ends of each chord.
    index_of: Vec<[u32; 2]>,
}

impl Around {
    fn new(boundary: &Boundary<'_>, chords: &[Chord]) -> Self {
        let mut stops: Vec<Stop> = chords
            .iter()
            .enumerate()
            .flat_map(|(chord, c)| {
                (0..2).filter_map(move |side| {
                    c.ends[side].map(|on| Stop { chord: chord as u32, side: side as u8, on })
                })
            })
            .collect();
        let key = |s: &Stop| (s.on.ring, boundary.distance_mm(s.on));
        stops.sort_by(|a, b| {
            let (a_key, b_key) = (key(a), key(b));
            a_key
                .0
                .cmp(&b_key.0)
                .then(a_key.1.total_cmp(&b_key.1))
                .then((a.chord, a.side).cmp(&(b.chord, b.side)))
        });
        let mut index_of = vec![[u32::MAX; 2]; chords.len()];
        for (i, stop) in stops.iter().enumerate() {
            index_of[stop.chord as usize][stop.side as usize] = i as u32;
        }
        Self { stops, index_of }
    }

    /// The chord end to continue to, with the join along the boundary.
    fn next(
        &self,
        boundary: &Boundary<'_>,
        chords: &[Chord],
        used: &[bool],
        (chord, side): (usize, usize),
        joins: &Joins,
    ) -> Option<(Vec<Point>, (usize, usize))> {
        let here = self.stops.get(self.index_of[chord][side] as usize)?;
        self.beside(chord, side)
            .into_iter()
            .filter_map(|(stop, ahead)| {
                let (from, until) = if ahead { (here.on, stop.on) } else { (stop.on, here.on) };
                let length_mm = boundary.forward_mm(from, until)?;
                let itself = (stop.chord as usize, stop.side as usize) == (chord, side);
                let free = !itself && !used[stop.chord as usize];
                // Two ends of one line side by side on the boundary are the pattern's own edge, not a neighbour.
                let apart =
                    chords[stop.chord as usize].line != chords[chord].line || chords[chord].points.len() > 2;
                (free && apart && length_mm <= joins.longest_mm).then_some((length_mm, ahead, stop))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, ahead, stop)| {
                let join = boundary.vertices_between(here.on, stop.on, ahead);
                (join, (stop.chord as usize, stop.side as usize))
            })
    }

    /// The ends beside one that is on the boundary: ahead along the ring, and back. On a ring of its own it is both.
    fn beside(&self, chord: usize, side: usize) -> [(&Stop, bool); 2] {
        let at = self.index_of[chord][side] as usize;
        let ring = self.stops[at].on.ring;
        let forward = if at + 1 < self.stops.len() && self.stops[at + 1].on.ring == ring {
            at + 1
        } else {
            self.stops.partition_point(|s| s.on.ring < ring)
        };
        let backward = if at > 0 && self.stops[at - 1].on.ring == ring {
            at - 1
        } else {
            self.stops.partition_point(|s| s.on.ring <= ring) - 1
        };
        [(&self.stops[forward], true), (&self.stops[backward], false)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::lines::parallel;
    use super::super::spec::LineSet;
    use super::*;
    use geometry::Polygon;

    #[test]
    fn no_end_reaches_further_beyond_a_corner_than_beyond_an_edge() {
        let (side_mm, reach_mm) = (10.0, 0.3);
        let corners = [(0.0, 0.0), (side_mm, 0.0), (side_mm, side_mm), (0.0, side_mm)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        let room = Region::from(Polygon { outer, holes: Vec::new() });
        let joins = Joins { reach_mm, ..Joins::default() };
        let beyond_mm = |degrees: u32| {
            let lines = parallel(&room, f64::from(degrees).to_radians(), 0.07, 0.0, &joins);
            let ends = lines.iter().flat_map(|line| &line.points).flat_map(|p| p.mm());
            ends.map(|x| (x - side_mm).max(-x)).fold(f64::MIN, f64::max)
        };
        for degrees in (0..180).step_by(5) {
            let mm = beyond_mm(degrees);
            assert!((mm - reach_mm).abs() < 1e-4, "{degrees}°: {mm} mm");
        }
    }

    #[test]
    fn parts_of_a_line_that_bends_between_them_stay_apart() {
        let square = |x: f64| {
            let corners = [(x, 0.0), (x + 4.0, 0.0), (x + 4.0, 4.0), (x, 4.0)];
            Polygon { outer: corners.map(|(x, y)| Point::from_mm(x, y)).to_vec(), holes: Vec::new() }
        };
        let room = Region::disjoint([square(0.0), square(4.4)]);
        let joins = Joins { reach_mm: 0.3, ..Joins::default() };
        let count = |bend_mm: f64| {
            let y = 2.0 + bend_mm;
            let chord = |a: (f64, f64), b: (f64, f64), ends| {
                let points = vec![Point::from_mm(a.0, a.1), Point::from_mm(b.0, b.1)];
                Chord { points, ends, line: 0 }
            };
            let at = |ring, edge, along_mm| Some(BoundaryPos { ring, edge, along_mm });
            let first = chord((1.0, 2.0), (4.0, 2.0), [None, at(0, 1, 2.0)]);
            let second = chord((4.4, y), (7.4, y), [at(1, 3, 4.0 - y), None]);
            connect(&room, vec![first, second], &joins).len()
        };
        assert_eq!([count(0.0), count(0.2)], [1, 2]);
    }

    #[test]
    fn each_end_of_a_line_goes_on_beside_itself() {
        // Above the uppermost line and below the lowest one there is room at both sides, none in the middle.
        let outer = [(0.0, 0.0), (5.0, 0.2), (10.0, 0.0), (10.0, 4.4), (5.0, 4.2), (0.0, 4.4)];
        let outer = outer.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        let room = Region::from(Polygon { outer, holes: Vec::new() });
        let hatch = LineSet::new(0.0, 0.4, 0.2);
        let joins = Joins { hatch: Some(hatch), ..Joins::default() };
        let lines = parallel(&room, 0.0, 0.4, 0.2, &joins);
        let beside: Vec<&Line> = lines.iter().filter(|line| line.points.len() > 2).collect();
        assert_eq!(beside.len(), 2);
        for line in beside {
            let length_mm = geometry::polyline_length_mm(&line.points);
            assert!((18.0..20.0).contains(&length_mm), "there and back: {length_mm} mm");
        }
    }
}
