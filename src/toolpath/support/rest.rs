//! Beads of support begin on something: on a bead of the layer below, or on the part.

use std::cell::OnceCell;

use super::beads::SHORTEST_MM;
use crate::toolpath::{Path, Width};
use geometry::{EdgeGrid, Point, Polygon, Region};

/// A bead is carried by another if their middles are at most this many widths apart: half of it at least is carried.
const CARRIED: f64 = 1.0;

/// Positions along a bead are tried this far apart, in millimetres.
const STEP_MM: f64 = 0.1;

/// The base of a layer of support.
pub struct Ground<'a> {
    beads: EdgeGrid,
    part: &'a [Region],
    grids: OnceCell<Vec<EdgeGrid>>,
}

impl<'a> Ground<'a> {
    /// The support's beads one layer down, and the part's sections near enough below.
    pub fn new(beads: &[Path], part: &'a [Region]) -> Self {
        // Open beads go to and fro.
        let outline = |path: &Path| {
            let back = path.points.iter().rev().skip(1).filter(|_| !path.closed);
            Polygon { outer: path.points.iter().chain(back).copied().collect(), holes: Vec::new() }
        };
        let beads = EdgeGrid::new(&Region::disjoint(beads.iter().map(outline)));
        Self { beads, part, grids: OnceCell::new() }
    }

    /// Beads made to begin, from whichever end they are drawn, where they are carried. Loops that are not carried
    /// everywhere are opened where they are; other beads lose the ends that are not. What is carried nowhere vanishes.
    pub fn carry(&self, beads: Vec<Path>) -> Vec<Path> {
        beads
            .into_iter()
            .filter_map(|bead| if bead.closed { self.opened(bead) } else { self.cut(bead) })
            .collect()
    }

    fn opened(&self, mut bead: Path) -> Option<Path> {
        if bead.points.iter().all(|&p| self.carries(p, &bead)) {
            return Some(bead);
        }
        bead.closed = false;
        bead.points.push(bead.points[0]);
        let (next, first) = self.first_carried(&bead)?;
        bead.points.pop();
        let count = bead.points.len();
        bead.points.rotate_left(next % count);
        bead.points.insert(0, first);
        bead.points.push(first);
        bead.points.dedup();
        Some(bead)
    }

    fn cut(&self, mut bead: Path) -> Option<Path> {
        for _ in 0..2 {
            let (next, first) = self.first_carried(&bead)?;
            bead.points.drain(..next);
            bead.points.insert(0, first);
            bead.points.reverse();
        }
        bead.points.dedup();
        (geometry::polyline_length_mm(&bead.points) >= SHORTEST_MM).then_some(bead)
    }

    /// The first place of an open bead that is carried, and the index of the vertex after it.
    fn first_carried(&self, bead: &Path) -> Option<(usize, Point)> {
        bead.points.windows(2).enumerate().find_map(|(i, ends)| {
            let ([ax, ay], [bx, by]) = (ends[0].mm(), ends[1].mm());
            let steps = (ends[0].distance_mm(ends[1]) / STEP_MM).ceil();
            let points = (0..=steps as usize).map(|k| {
                let t = k as f64 / steps.max(1.0);
                Point::from_mm(ax + t * (bx - ax), ay + t * (by - ay))
            });
            points.into_iter().find(|&p| self.carries(p, bead)).map(|p| (i + 1, p))
        })
    }

    fn carries(&self, p: Point, bead: &Path) -> bool {
        let Width::Constant(width_mm) = bead.width else { return true };
        let near_mm = CARRIED * width_mm;
        let is_near = |grid: &EdgeGrid| grid.distance_mm(p, near_mm) <= near_mm;
        let grids = || self.grids.get_or_init(|| self.part.iter().map(EdgeGrid::new).collect());
        is_near(&self.beads) || grids().iter().any(|grid| grid.contains(p) || is_near(grid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::{Phase, Role};

    fn bead(closed: bool, points: &[(f64, f64)]) -> Path {
        let points = points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect();
        let width = Width::Constant(0.4);
        Path {
            role: Role::Support,
            closed,
            points,
            width,
            height_mm: 0.2,
            island: None,
            phase: Phase::Support,
            tool: None,
        }
    }

    #[test]
    fn ends_over_nothing_are_cut_off() {
        let below = [bead(false, &[(0.0, 0.0), (0.0, 10.0)]), bead(false, &[(5.0, 0.0), (5.0, 10.0)])];
        let ground = Ground::new(&below, &[]);
        let [cut] = &ground.carry(vec![bead(false, &[(-3.0, 5.0), (9.0, 5.0)])])[..] else {
            panic!("one bead")
        };
        let [from, to] = [cut.points[0].mm()[0], cut.points[1].mm()[0]];
        assert!((from + 0.4).abs() < 0.11 && (to - 5.4).abs() < 0.11, "{from} to {to}");
        assert!(ground.carry(vec![bead(false, &[(2.0, 0.0), (3.0, 5.0)])]).is_empty());
    }

    #[test]
    fn a_loop_begins_over_the_part_if_only_that_carries_it_or_not_at_all() {
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 10.0), (0.0, 10.0)];
        let outer = corners.map(|(x, y)| Point::from_mm(x, y)).to_vec();
        let part = [Region::from(Polygon { outer, holes: Vec::new() })];
        let ground = Ground::new(&[], &part);
        let [opened] = &ground.carry(vec![bead(true, &[(6.0, 1.0), (6.0, 4.0), (1.0, 4.0), (1.0, 1.0)])])[..]
        else {
            panic!("one bead")
        };
        let (first, last) = (opened.points[0], opened.points[opened.points.len() - 1]);
        assert!(!opened.closed && first == last);
        // Just where it comes over the part, half a bead early at most, and then all around.
        let [x, y] = first.mm();
        assert!((2.0..2.5).contains(&x) && y == 4.0, "{x} {y}");
        assert!((geometry::polyline_length_mm(&opened.points) - 16.0).abs() < 1e-6);
        assert!(ground.carry(vec![bead(true, &[(6.0, 1.0), (6.0, 4.0), (4.0, 4.0)])]).is_empty());
    }
}
