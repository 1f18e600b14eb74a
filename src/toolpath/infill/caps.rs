//! Beads in the gaps that parallel lines leave where the boundary runs along them.

use geometry::{Boundary, Point};

use super::spec::{Chord, LineSet, Stop};

/// Beads narrower than this, as a share of the lines' distance, are not laid.
const NARROWEST: f64 = 0.12;

/// Beads shorter than this many distances are laid only where a line ends beside them.
const SHORTEST: f64 = 1.2;

/// A wedge is filled by a bead of its own that is at least this many distances long, which means that the lines meet the
/// boundary at less than 34°; steeper ends are joined with beads of full width.
const SHORTEST_WEDGE: f64 = 1.5;

/// Between the ends of two neighbouring lines the boundary is at most this many distances beyond the longer one,
const WIDEST: f64 = 1.1;

/// and at least this many, where that passes a corner outside.
const OUTSIDE: f64 = -0.5;

impl LineSet {
    /// How far a point lies beyond a line, along the normal, in millimetres.
    fn over_mm(&self, line: i64, p: Point) -> f64 {
        self.direction().across_mm(p) - (line as f64 * self.distance_mm + self.phase_mm)
    }

    /// Middle and width of the gap on one side (±1) of a line; `outer`: the gap to the boundary, else to the next
    /// line.
    fn gap(&self, line: i64, side: f64, outer: bool, p: Point) -> (Point, f64) {
        let over_mm = side * self.over_mm(line, p);
        let (away_mm, width_mm) = if outer {
            ((self.distance_mm - over_mm) / 2.0, over_mm)
        } else {
            (-over_mm / 2.0, self.distance_mm - over_mm)
        };
        (self.direction().from(p, 0.0, side * away_mm), width_mm)
    }
}

/// Of no chord.
const NO_END: (u32, u8) = (u32::MAX, 0);

/// A bead beside an extreme of the boundary.
pub(super) struct Cap {
    /// Vertices with the spacing there.
    pub(super) bead: Vec<(Point, f32)>,
    /// The chord ends (chord, side) that the bead starts and ends beside; [`NO_END`] where it is not reached.
    pub(super) ends: [(u32, u8); 2],
    pub(super) used: bool,
}

impl Cap {
    /// Its bead, to be drawn from a chord end beside it.
    pub(super) fn take(&mut self, from: (u32, u8)) -> Vec<(Point, f32)> {
        self.used = true;
        let mut bead = std::mem::take(&mut self.bead);
        if self.ends[0] != from {
            bead.reverse();
        }
        bead
    }
}

/// The caps of a fill, to be found by the chord ends beside them.
#[derive(Default)]
pub(super) struct Caps {
    all: Vec<Cap>,
    /// Chord, side, and index of a cap beside that end; sorted.
    beside: Vec<(u32, u8, u32)>,
}

impl Caps {
    pub(super) fn new(all: Vec<Cap>) -> Self {
        let ends =
            all.iter().enumerate().flat_map(|(i, cap)| cap.ends.map(|(chord, side)| (chord, side, i as u32)));
        let mut beside: Vec<(u32, u8, u32)> = ends.collect();
        beside.sort_unstable();
        Self { all, beside }
    }

    fn beside(&self, (chord, side): (u32, u8)) -> impl Iterator<Item = usize> {
        let first = self.beside.partition_point(|&(c, s, _)| (c, s) < (chord, side));
        let same = self.beside[first..].iter().take_while(move |&&(c, s, _)| (c, s) == (chord, side));
        same.map(|&(.., cap)| cap as usize)
    }

    /// Whether there is a cap beside a chord's end, used or not.
    pub(super) fn any_beside(&self, end: (u32, u8)) -> bool {
        self.beside(end).next().is_some()
    }

    /// A cap beside a chord's end that is not used yet and fits.
    pub(super) fn free_beside(&mut self, end: (u32, u8), fits: impl Fn(&Cap) -> bool) -> Option<&mut Cap> {
        let found = self.beside(end).find(|&i| !self.all[i].used && fits(&self.all[i]))?;
        self.all.get_mut(found)
    }

    /// The beads of the caps that no line took up, unless they are short.
    pub(super) fn into_unused(self, distance_mm: f64) -> impl Iterator<Item = Vec<(Point, f32)>> {
        let length_mm =
            |bead: &[(Point, f32)]| bead.windows(2).map(|w| w[0].0.distance_mm(w[1].0)).sum::<f64>();
        let unused = self.all.into_iter().filter(|cap| !cap.used).map(|cap| cap.bead);
        unused.filter(move |bead| length_mm(bead) >= SHORTEST * distance_mm)
    }
}

/// All caps along the boundary. Between two neighbouring ends of the same line the boundary stays within one distance
/// of it. If both are ends of one chord, the cap lies between that chord and the boundary; else a hole or notch
/// interrupts the line, and the cap lies between it and the next line.
pub(super) fn find(boundary: &Boundary<'_>, stops: &[Stop], chords: &[Chord], hatch: LineSet) -> Vec<Cap> {
    let distance_mm = hatch.distance_mm;
    let mut caps = Vec::new();
    for ring in stops.chunk_by(|a, b| a.on.ring == b.on.ring) {
        for (i, from) in ring.iter().enumerate() {
            let to = &ring[(i + 1) % ring.len()];
            let (a, b) = (&chords[from.chord as usize], &chords[to.chord as usize]);
            if a.line != b.line || ring.len() < 2 {
                let arc = || boundary.vertices_between(from.on, to.on, true);
                caps.extend(wedge([(a, from), (b, to)], arc, hatch));
                continue;
            }
            let arc = boundary.vertices_between(from.on, to.on, true);
            let outer = from.chord == to.chord;
            let side = arc.iter().map(|&p| hatch.over_mm(a.line, p)).sum::<f64>().signum();
            // Vertex, and the width of the gap beside it.
            let profile: Vec<(Point, f64)> = std::iter::once(a.end(from.side.into()))
                .chain(arc.iter().copied())
                .chain(std::iter::once(b.end(to.side.into())))
                .map(|p| hatch.gap(a.line, side, outer, p))
                .collect();
            let ends = [(from.chord, from.side), (to.chord, to.side)];
            let parts = wide_parts(&profile, NARROWEST * distance_mm);
            let whole = parts.first().is_some_and(|part| outer || part.len() >= profile.len());
            caps.extend(beside(parts, ends, whole));
        }
    }
    caps
}

/// The caps from one chord's end to another's. Where there are several, or one that is not `whole`, the first and the last are
/// each reached from the end on its own side.
fn beside(parts: Vec<Vec<(Point, f32)>>, ends: [(u32, u8); 2], whole: bool) -> impl Iterator<Item = Cap> {
    let count = parts.len();
    parts.into_iter().enumerate().map(move |(k, mut bead)| {
        let ends = match k {
            0 if whole && count == 1 => ends,
            0 => [ends[0], NO_END],
            _ if k + 1 == count => {
                bead.reverse();
                [ends[1], NO_END]
            }
            _ => [NO_END; 2],
        };
        Cap { bead, ends, used: false }
    })
}

/// The beads between two neighbouring lines where the boundary runs from the end of one to that of the other at a small
/// angle: the shorter line continues along the boundary and narrows until it meets the longer one's end, or the boundary.
fn wedge(
    [(a, from), (b, to)]: [(&Chord, &Stop); 2],
    arc: impl FnOnce() -> Vec<Point>,
    hatch: LineSet,
) -> Vec<Cap> {
    let (distance_mm, direction) = (hatch.distance_mm, hatch.direction());
    // Both lines end in the same direction.
    if (a.line - b.line).abs() != 1 || from.side != to.side {
        return Vec::new();
    }
    let (at_a, at_b) = (a.end(from.side.into()), b.end(to.side.into()));
    let inwards = if from.side == 0 { 1.0 } else { -1.0 };
    let shorter_mm = inwards * (direction.along_mm(at_b) - direction.along_mm(at_a));
    if shorter_mm.abs() < SHORTEST_WEDGE * distance_mm {
        return Vec::new();
    }
    let is_forward = shorter_mm < 0.0;
    let (long, short) = if is_forward { (b, a) } else { (a, b) };
    if long.end(0).distance_mm(long.end(1)) < shorter_mm.abs() {
        return Vec::new();
    }
    let side = (short.line - long.line) as f64;
    let profile: Vec<(Point, f64)> = std::iter::once(at_a)
        .chain(arc())
        .chain(std::iter::once(at_b))
        .map(|p| hatch.gap(long.line, side, true, p))
        .collect();
    let room_mm = OUTSIDE * distance_mm..=WIDEST * distance_mm;
    if profile.iter().any(|&(_, mm)| !room_mm.contains(&mm)) {
        return Vec::new();
    }
    let ends = [(from.chord, from.side), (to.chord, to.side)];
    beside(wide_parts(&profile, NARROWEST * distance_mm), ends, true).collect()
}

/// The parts of a polyline at least `least_mm` wide, cut where the width, linear in between, passes that.
fn wide_parts(profile: &[(Point, f64)], least_mm: f64) -> Vec<Vec<(Point, f32)>> {
    let mut parts: Vec<Vec<(Point, f32)>> = Vec::new();
    let mut part = Vec::new();
    for (i, &(p, width_mm)) in profile.iter().enumerate() {
        let wide = width_mm >= least_mm;
        if let Some(&(before, before_mm)) = i.checked_sub(1).and_then(|i| profile.get(i))
            && (before_mm >= least_mm) != wide
        {
            let t = (least_mm - before_mm) / (width_mm - before_mm);
            let ([ax, ay], [bx, by]) = (before.mm(), p.mm());
            part.push((Point::from_mm(ax + t * (bx - ax), ay + t * (by - ay)), least_mm as f32));
        }
        if wide {
            part.push((p, width_mm as f32));
        } else if !part.is_empty() {
            parts.push(std::mem::take(&mut part));
        }
    }
    if !part.is_empty() {
        parts.push(part);
    }
    parts.retain(|part| part.len() > 1);
    parts
}
