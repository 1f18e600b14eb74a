//! Growing and shrinking regions.
//!
//! Each ring is moved by itself, without the edges that shrink to nothing; where the moved rings touch nothing, as is the rule,
//! they are the result already. Else the overlaps are taken out by winding number.

use std::cell::RefCell;

use super::boolean::{clusters, difference, positive};
use super::raw_offset::{Join, RingOffset};
use super::simplify::simplify_into;
use super::{Bounds, Point, Polygon, Region, Ring, UNITS_PER_MM, ring_area};

/// Offsetting may move the boundary by this much, in millimetres, to save vertices: a quarter of the finest
/// step of common motion systems (80 steps/mm). Half is spent on the input, half on the result.
const TOLERANCE_MM: f64 = 0.0025;

/// A part is taken out of a region with so much to spare: twice what offsetting may have moved the boundary.
const KERF_MM: f64 = 2.0 * TOLERANCE_MM;

/// Parts of a result smaller than this many square millimetres (a square of 5 µm) are dropped.
const MIN_AREA_MM2: f64 = 2.5e-5;

/// The region grown (`by_mm` > 0) or shrunk (`by_mm` < 0) by a distance; corners sharper than 60° are cut square.
///
/// See [`offset_with`].
pub fn offset(region: &Region, by_mm: f64) -> Region {
    offset_with(region, by_mm, Join::DEFAULT)
}

/// The region grown (`by_mm` > 0) or shrunk (`by_mm` < 0) by a distance.
///
/// A shrunk region lies inside its input, a grown one covers it. The boundary is within 2.5 µm (for distances
/// below 20 µm, an eighth of the distance) of where the joins put it; in exchange the result has hardly more
/// vertices than its input, mostly fewer. Outer rings and holes are recognised by their position in the polygon,
/// whatever their orientation. Parts smaller than 25 µm² or narrower
/// than 2.5 µm may vanish. A distance that is not a number or below the
/// grid's unit changes nothing, one beyond 5 m is taken as 5 m; results are cut off at ±10.7 m.
///
/// O(n) for n vertices where no parts meet or split; else O(n log n) of the polygons concerned.
pub fn offset_with(region: &Region, by_mm: f64, join: Join) -> Region {
    moved(region, by_mm, join).0
}

/// A region shrunk by a radius.
#[derive(Clone, Debug)]
pub struct Core {
    /// What is left.
    pub region: Region,
    /// Whether it is known that this, grown by the radius, covers the region again: nothing is narrower than twice the radius, and
    /// no corner is sharper than 67°. It costs nothing to find out, and holds where the shrunk outlines meet nowhere and lost no
    /// edges but those of convex curves.
    pub is_whole: bool,
    /// How corners are closed where it grows again.
    pub corners: Join,
}

impl Core {
    /// What is left, grown again by up to the radius.
    pub fn grown(&self, by_mm: f64) -> Region {
        offset_with(&self.region, by_mm, self.corners)
    }
}

/// The region shrunk by a radius as [`offset`] does.
pub fn core(region: &Region, radius_mm: f64) -> Core {
    let (region, is_whole) = moved(region, -radius_mm, Join::DEFAULT);
    Core { region, is_whole, corners: Join::DEFAULT }
}

/// [`offset_with`], and whether all rings surely move back to where they were.
fn moved(region: &Region, by_mm: f64, join: Join) -> (Region, bool) {
    let by = (by_mm * UNITS_PER_MM).round().clamp(-5e8, 5e8);
    if by.is_nan() || by == 0.0 || region.is_empty() {
        return (region.clone(), true);
    }
    let mut task = LAST.take();
    task.by = by;
    task.tolerance = (TOLERANCE_MM * UNITS_PER_MM).min(by.abs() / 8.0) / 2.0;
    task.rings.set(by, join);
    task.is_whole = true;
    let mut result = Region::default();
    if by < 0.0 {
        for polygon in &region.polygons {
            task.together(&[polygon], &mut result);
        }
    } else {
        for group in groups(region, by * join.reach()) {
            let polygons: Vec<&Polygon> = group.iter().map(|&i| &region.polygons[i]).collect();
            task.together(&polygons, &mut result);
        }
    }
    let is_whole = task.is_whole;
    LAST.set(task);
    (result, is_whole)
}

/// What is left after shrinking and growing back: parts narrower than twice the radius vanish. Mitred corners may
/// stick out of the input where two unconnected edges meet; intersect where that matters.
pub fn opening(region: &Region, radius_mm: f64) -> Region {
    offset(&offset(region, -radius_mm), radius_mm)
}

/// The region grown and shrunk back: gaps and holes narrower than twice the radius are filled.
pub fn closing(region: &Region, radius_mm: f64) -> Region {
    offset(&offset(region, radius_mm), -radius_mm)
}

/// Fills gaps narrower than twice the radius between the polygons of a region, and everything else that a [`closing`]
/// fills of polygons with others near. The rest stays as it is.
pub fn close_between(region: &Region, radius_mm: f64) -> Region {
    let mut result = Region::default();
    for group in groups(region, radius_mm * UNITS_PER_MM) {
        let near = Region { polygons: group.iter().map(|&i| region.polygons[i].clone()).collect() };
        let closed = if group.len() > 1 { closing(&near, radius_mm) } else { near };
        result.polygons.extend(closed.polygons);
    }
    result
}

/// A region without a part of it whose boundary is, or nearly is, the region's own over long stretches. The part is
/// taken out with 5 µm to spare, which leaves no slivers.
pub fn remainder(region: &Region, part: &Region) -> Region {
    // Nor do outlines share edges then, which take much longer to sort out than crossings.
    difference(region, &offset(part, KERF_MM))
}

/// The part of a region that an opening removes, where it is at least `least_mm` wide, a multiple of the tolerance: `core` is the
/// region shrunk by the radius.
pub fn narrower(region: &Region, core: &Core, radius_mm: f64, least_mm: f64) -> Region {
    if core.is_whole {
        return Region::default();
    }
    opening(&difference(region, &core.grown(radius_mm + KERF_MM)), least_mm / 2.0)
}

/// The polygons of a region in groups that may meet when each grows by `reach` units, as their numbers.
fn groups(region: &Region, reach: f64) -> Vec<Vec<usize>> {
    let boxes: Vec<Bounds> = region.polygons.iter().map(|p| p.bounds().grown(reach.ceil() as i32)).collect();
    clusters(&boxes, |_, _| true)
}

thread_local! {
    /// The last offset, whose buffers the next one uses.
    static LAST: RefCell<Offset> = RefCell::default();
}

#[derive(Default)]
struct Offset {
    by: f64,
    tolerance: f64,
    rings: RingOffset,
    /// Whether all rings so far move back to where they were.
    is_whole: bool,
    /// A ring, simplified; outer ones counter-clockwise, holes clockwise.
    ring: Ring,
    /// The same, moved.
    front: Ring,
    /// Moved rings, whose points of positive winding are the offset; then some that were.
    curves: Vec<Ring>,
}

impl Offset {
    /// Offsets polygons that may meet.
    fn together(&mut self, polygons: &[&Polygon], result: &mut Region) {
        let mut count = 0;
        for polygon in polygons {
            for (i, ring) in polygon.rings().enumerate() {
                if self.prepare(ring, i == 0) {
                    self.add_curve(count);
                    count += 1;
                    continue;
                }
                self.is_whole = false;
                if i == 0 {
                    break;
                }
            }
        }
        let (mut region, are_all) = positive(&self.curves[..count]);
        let count = region.polygons.len();
        region.polygons.retain(|polygon| ring_area(&polygon.outer) > MIN_AREA_MM2);
        self.is_whole &= are_all && region.polygons.len() == count;
        result.polygons.append(&mut region.polygons);
    }

    /// Moves the ring that was taken up, to the curve of this number.
    fn add_curve(&mut self, number: usize) {
        if number == self.curves.len() {
            self.curves.push(Ring::new());
        }
        let curve = &mut self.curves[number];
        let mut is_front = false;
        if self.rings.front(&self.ring, &mut self.front).is_some() {
            simplify_into(&self.front, self.tolerance, curve);
            is_front = !curve.is_empty();
        }
        self.is_whole &= is_front && self.rings.is_whole;
        if !is_front {
            self.rings.raw(&self.ring, curve);
        }
    }

    /// Takes up a ring, unless it surely vanishes.
    fn prepare(&mut self, ring: &Ring, is_outer: bool) -> bool {
        simplify_into(ring, self.tolerance, &mut self.ring);
        let shrinks = is_outer == (self.by < 0.0);
        if self.ring.is_empty() || shrinks && self.swallows(&self.ring) {
            return false;
        }
        if (ring_area(&self.ring) > 0.0) != is_outer {
            self.ring.reverse();
        }
        true
    }

    /// Whether nothing is left of the ring's inside, because the distance is more than half its width.
    fn swallows(&self, ring: &[Point]) -> bool {
        Bounds::of(ring.iter().copied()).is_none_or(|b| {
            let width = i64::from(b.max.x) - i64::from(b.min.x);
            let height = i64::from(b.max.y) - i64::from(b.min.y);
            width.min(height) as f64 <= 2.0 * self.by.abs()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Random, real};

    /// A ring of many corners whose distance from the origin varies.
    fn star(random: &mut Random, corners: u32, lengths_mm: [f64; 2]) -> Ring {
        let corner = |i: u32| {
            let share = f64::from(random.below(1000)) / 1000.0;
            let length_mm = lengths_mm[0] + share * (lengths_mm[1] - lengths_mm[0]);
            let (sin, cos) = real::sin_cos(std::f64::consts::TAU * f64::from(i) / f64::from(corners));
            Point::from_mm(length_mm * cos, length_mm * sin)
        };
        (0..corners).map(corner).collect()
    }

    #[test]
    fn nothing_of_a_region_with_a_whole_core_is_narrower() {
        let mut random = Random::new(5);
        let mut whole = 0;
        for round in 0..2000 {
            let corners = 5 + random.below(60);
            let least_mm = 3.0 + f64::from(random.below(20)) / 10.0;
            let ring = star(&mut random, corners, [least_mm, 5.0]);
            let hole: Ring = star(&mut random, 12, [0.3, 0.5]).into_iter().rev().collect();
            let region = Region::from(Polygon { outer: ring, holes: vec![hole] });
            let radius_mm = f64::from(5 + random.below(150)) / 100.0;
            let core = core(&region, radius_mm);
            if !core.is_whole {
                continue;
            }
            whole += 1;
            let in_doubt = Core { is_whole: false, ..core };
            let narrow = narrower(&region, &in_doubt, radius_mm, 0.03);
            assert!(narrow.is_empty(), "{round}: {radius_mm} mm, {narrow:?}");
        }
        assert!(whole > 100, "{whole}");
    }

    #[test]
    fn what_has_shrunk_to_nothing_makes_no_difference_to_the_offset() {
        let mut random = Random::new(3);
        for round in 0..400 {
            let corners = 6 + random.below(60);
            let least_mm = 0.5 + f64::from(random.below(40)) / 10.0;
            let ring = star(&mut random, corners, [least_mm, 5.0]);
            let by_mm = f64::from(random.below(200)) / 100.0 - 1.0;
            if by_mm.abs() < 0.02 {
                continue;
            }
            let (mut rings, mut raw) = (RingOffset::default(), Ring::new());
            rings.set(by_mm * UNITS_PER_MM, Join::DEFAULT);
            rings.raw(&ring, &mut raw);
            let whole = positive(&[raw]).0;
            let moved = offset(&Region::from(Polygon { outer: ring.clone(), holes: Vec::new() }), by_mm);
            for (a, b) in [(&whole, &moved), (&moved, &whole)] {
                let more = opening(&difference(a, b), 3.0 * TOLERANCE_MM);
                assert!(
                    more.is_empty(),
                    "{round}: {by_mm} mm: {:?}",
                    more.polygons().iter().map(Polygon::area_mm2).collect::<Vec<_>>()
                );
            }
        }
    }
}
