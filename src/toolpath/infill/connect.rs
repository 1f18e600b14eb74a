//! Joins the ends of infill lines along the boundary, so that a line ends where the next one begins.

use crate::geom::{Boundary, BoundaryPos, Point, Region};

use super::FillLine;

/// A piece of a pattern inside the region.
#[derive(Clone, Debug, PartialEq)]
pub struct Chord {
    /// Vertices, at least two.
    pub points: Vec<Point>,
    /// Where it starts and ends on the boundary.
    pub ends: [Option<BoundaryPos>; 2],
    /// Which line of the pattern it is part of: neighbours differ by one.
    pub line: i64,
}

/// One end of a chord, in its place on the boundary.
#[derive(Clone, Copy)]
struct Stop {
    chord: u32,
    side: u8,
    on: BoundaryPos,
}

/// Joins chords into longer lines.
///
/// A line goes on from its end to the neighbouring end on the boundary, either way round, if the way there is
/// at most `longest_mm`; the nearer one where both are free. Chords are taken in the order given, each line grows
/// at both ends. O(n log n).
pub fn connect(region: &Region, chords: Vec<Chord>, longest_mm: f64) -> Vec<FillLine> {
    if longest_mm <= 0.0 || chords.len() < 2 {
        return chords.into_iter().map(|c| FillLine { points: c.points, closed: false }).collect();
    }
    let boundary = Boundary::new(region);
    let around = Around::new(&boundary, &chords);
    let mut used = vec![false; chords.len()];
    let mut lines = Vec::new();
    for first in 0..chords.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let mut points = chords[first].points.clone();
        for side in [1, 0] {
            let mut at = (first, side);
            while let Some((way, next)) = around.next(&boundary, &chords, &used, at, longest_mm) {
                used[next.0] = true;
                points.extend(way);
                let chord = &chords[next.0].points;
                if next.1 == 0 {
                    points.extend(chord)
                } else {
                    points.extend(chord.iter().rev())
                }
                at = (next.0, 1 - next.1);
            }
            points.reverse();
        }
        points.dedup();
        lines.push(FillLine { points, closed: false });
    }
    lines
}

/// The ends of all chords, sorted along the boundary.
struct Around {
    stops: Vec<Stop>,
    /// Index into `stops` of both ends of each chord.
    place: Vec<[u32; 2]>,
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
        let mut place = vec![[u32::MAX; 2]; chords.len()];
        for (i, stop) in stops.iter().enumerate() {
            place[stop.chord as usize][stop.side as usize] = i as u32;
        }
        Self { stops, place }
    }

    /// The chord end to go on to, with the way there along the boundary.
    fn next(
        &self,
        boundary: &Boundary<'_>,
        chords: &[Chord],
        used: &[bool],
        (chord, side): (usize, usize),
        longest_mm: f64,
    ) -> Option<(Vec<Point>, (usize, usize))> {
        let at = self.place[chord][side] as usize;
        let here = self.stops.get(at)?;
        let ring = here.on.ring;
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
        [(forward, true), (backward, false)]
            .into_iter()
            .filter_map(|(to, ahead)| {
                let stop = &self.stops[to];
                let (from, until) = if ahead { (here.on, stop.on) } else { (stop.on, here.on) };
                let way_mm = boundary.way_mm(from, until)?;
                let free = to != at && !used[stop.chord as usize];
                // Two ends of one line side by side on the boundary are the pattern's own edge, not a neighbour.
                let apart =
                    chords[stop.chord as usize].line != chords[chord].line || chords[chord].points.len() > 2;
                (free && apart && way_mm <= longest_mm).then_some((way_mm, ahead, stop))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, ahead, stop)| {
                let way = boundary.vertices_between(here.on, stop.on, ahead);
                (way, (stop.chord as usize, stop.side as usize))
            })
    }
}
