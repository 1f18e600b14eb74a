//! Solid patches over sparse infill: each of their lines lies on one of the lines beneath.
//!
//! The lowest layer of a top shell rests on sparse infill alone. Where it is but a patch between the sparse lines, as over
//! the tip of a hill or under a small pocket, its lines would hang in mid-air. They grow to the nearest line beneath.

use std::cell::LazyCell;

use geometry::real;
use geometry::{Direction, EdgeGrid, Point, Region, Ring};

use super::hollow::Hollow;
use super::infill;

/// Distance of the chords that are looked at, in solid lines.
const STEP: f64 = 0.5;

/// What one chord needs, this many beside it get too: beads lie side by side.
const BESIDE: i64 = 2;

/// Sparse lines that run nearly as the solid ones are not reached for: sine of the angle between them.
const ALONG: f64 = 0.3;

/// A patch of whose loose chords less than this share hang, the others being held by a wall or by solid infill, stays as
/// it is.
const HANGING: f64 = 0.25;

/// What the solid lines of a layer lie on, and their directions.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    /// What is beneath.
    pub hollow: &'a Hollow<'a>,
    /// Usual direction of the solid lines, radians from the X axis.
    pub angle_rad: f64,
    /// Whether they have another one in patches where that saves turns.
    pub fit_angle: bool,
}

/// A part of a line through a patch, along and across the solid lines.
#[derive(Clone, Copy, Debug)]
struct Chord {
    index: i64,
    from_mm: f64,
    to_mm: f64,
    across_mm: f64,
}

impl Reach<'_> {
    /// Extends patches of lines `line_mm` apart by the area that they must also cover; they may reach over the edge
    /// of `inside` by a line. Where there are walls before a line beneath, they hold the patch.
    pub fn grow(&self, patches: Region, inside: &Region, line_mm: f64) -> Region {
        if self.hollow.sparse.is_empty() {
            return patches;
        }
        let area = LazyCell::new(|| EdgeGrid::new(inside));
        let (is_hollow, is_free) = (|p: Point| self.hollow.contains(p), |p: Point| area.contains(p));
        let mut stripes = Vec::new();
        for polygon in patches.polygons() {
            let patch = Region::from(polygon.clone());
            stripes.extend(self.along(&patch).stripes(&patch, line_mm, is_hollow, is_free));
        }
        if stripes.is_empty() {
            return patches;
        }
        geometry::union(&patches, &geometry::unite_rings(&stripes))
    }

    /// The same in the direction that the solid lines have in a patch.
    fn along(&self, patch: &Region) -> Self {
        let mut own = *self;
        if self.fit_angle {
            own.angle_rad = infill::fewest_turns(patch, self.angle_rad);
        }
        own
    }

    /// The stripes by which a patch grows.
    fn stripes(
        &self,
        patch: &Region,
        line_mm: f64,
        is_hollow: impl Fn(Point) -> bool,
        is_free: impl Fn(Point) -> bool,
    ) -> Vec<Ring> {
        let free = |along_mm: f64, across_mm: f64| is_free(self.point(along_mm, across_mm));
        let hangs = |chord: &Chord| {
            let Chord { from_mm, to_mm, across_mm, .. } = *chord;
            let count = ((to_mm - from_mm) / line_mm).ceil().max(1.0);
            let sample = |i: u32| self.point(from_mm + (to_mm - from_mm) * f64::from(i) / count, across_mm);
            free(from_mm - line_mm, across_mm)
                && free(to_mm + line_mm, across_mm)
                && (0..=count as u32).map(sample).all(&is_hollow)
        };
        let mut chords = self.loose(patch, line_mm);
        let least = HANGING * chords.len() as f64;
        chords.retain(hangs);
        if chords.is_empty() || (chords.len() as f64) < least || self.is_held_loop(patch, line_mm) {
            return Vec::new();
        }
        for chord in &mut chords {
            self.extend(chord, line_mm / 2.0, free);
        }
        chords.iter().map(|chord| self.stripe(chord, &chords, line_mm)).collect()
    }

    /// Chords of a patch without a sparse line beneath, by their index.
    fn loose(&self, patch: &Region, line_mm: f64) -> Vec<Chord> {
        let (step_mm, direction) = (STEP * line_mm, Direction::of(self.angle_rad));
        let chords = geometry::scan_lines(patch, self.angle_rad, step_mm, 0.0);
        let loose = chords.iter().filter(|chord| !self.is_held(chord.ends.map(|end| end.point)));
        loose
            .map(|chord| {
                let [from_mm, to_mm] = chord.ends.map(|end| direction.along_mm(end.point));
                Chord { index: chord.line, from_mm, to_mm, across_mm: chord.line as f64 * step_mm }
            })
            .collect()
    }

    /// Whether there is a sparse line between points.
    fn is_held(&self, points: impl IntoIterator<Item = Point, IntoIter: Clone>) -> bool {
        let points = points.into_iter();
        self.hollow.sparse.iter().any(|set| {
            let mut between = points.clone().map(|point| set.lines_to(point).floor());
            let first = between.next();
            between.any(|gap| Some(gap) != first)
        })
    }

    /// Whether a patch is so narrow that one loop along its edge fills it, and that crosses a sparse line.
    fn is_held_loop(&self, patch: &Region, line_mm: f64) -> bool {
        let outers = patch.polygons().iter().flat_map(|polygon| polygon.outer.iter().copied());
        self.is_held(outers) && geometry::offset(patch, -line_mm / 2.0).is_empty()
    }

    /// Makes a chord longer, until it reaches over the nearest sparse line by `over_mm`.
    fn extend(&self, chord: &mut Chord, over_mm: f64, free: impl Fn(f64, f64) -> bool) {
        let Chord { from_mm, to_mm, across_mm, .. } = *chord;
        let (mut back_mm, mut on_mm) = (f64::INFINITY, f64::INFINITY);
        for set in &self.hollow.sparse {
            let sine = real::sin(set.angle_rad - self.angle_rad);
            if sine.abs() < ALONG {
                continue;
            }
            // Counted so that the number grows along the chord.
            let lines = |along_mm: f64| -sine.signum() * set.lines_to(self.point(along_mm, across_mm));
            let per_line_mm = set.distance_mm / sine.abs();
            back_mm = back_mm.min((lines(from_mm) - lines(from_mm).floor()) * per_line_mm);
            on_mm = on_mm.min((lines(to_mm).ceil() - lines(to_mm)) * per_line_mm);
        }
        let (before_mm, behind_mm) = (from_mm - back_mm - over_mm, to_mm + on_mm + over_mm);
        let (is_before, is_behind) = (free(before_mm, across_mm), free(behind_mm, across_mm));
        if is_before && (back_mm < on_mm || !is_behind) {
            chord.from_mm = before_mm;
        } else if is_behind {
            chord.to_mm = behind_mm;
        }
    }

    /// A stripe around a chord, as long as all near it.
    fn stripe(&self, chord: &Chord, chords: &[Chord], line_mm: f64) -> Ring {
        let Chord { index, from_mm, to_mm, across_mm } = *chord;
        let first = chords.partition_point(|other| other.index < index - BESIDE);
        let near = chords[first..].iter().take_while(|other| other.index <= index + BESIDE);
        let (mut low_mm, mut high_mm) = (from_mm, to_mm);
        for other in near.filter(|other| other.from_mm < to_mm && other.to_mm > from_mm) {
            (low_mm, high_mm) = (low_mm.min(other.from_mm), high_mm.max(other.to_mm));
        }
        let corners = [(low_mm, -line_mm), (high_mm, -line_mm), (high_mm, line_mm), (low_mm, line_mm)];
        corners.map(|(along_mm, beside_mm)| self.point(along_mm, across_mm + beside_mm)).to_vec()
    }

    fn point(&self, along_mm: f64, across_mm: f64) -> Point {
        Direction::of(self.angle_rad).from(Point::default(), along_mm, across_mm)
    }
}
