//! The layer beneath walls and gap beads: over air, beads are extended to where they are held, and loops wait for those
//! that are held.

use std::cell::{LazyCell, OnceCell};

use geometry::{EdgeGrid, Point, Polygon, Region};

use super::Path;
use super::path::{Role, Width};

/// Distance between the points looked at.
const STEP_MM: f64 = 0.5;

/// What hangs over less than this holds by itself.
const DANGLE_MM: f64 = 1.5;

/// Beyond an end, an anchor is searched in this many steps of this many bead widths: behind the loops that turn before it.
const PROBES: u32 = 16;
const PROBE: f64 = 0.25;

/// A bead over air between ends nearer than this share of it is a loop that turns there, not a bridge.
const TURN: f64 = 0.5;

/// The layer beneath.
#[derive(Debug)]
pub(super) struct Beneath<'a> {
    pub region: &'a Region,
    /// The same, for looking up samples.
    grid: OnceCell<EdgeGrid>,
}

impl<'a> Beneath<'a> {
    pub fn new(region: &'a Region) -> Self {
        Self { region, grid: OnceCell::new() }
    }

    /// Whether there is something right under a point.
    pub fn holds(&self, point: Point) -> bool {
        self.grid.get_or_init(|| EdgeGrid::new(self.region)).contains(point)
    }

    fn holds_at(&self, [x, y]: [f64; 2]) -> bool {
        self.holds(Point::from_mm(x, y))
    }

    /// Extends single beads that end over air, just before an anchor, until they lie on it.
    pub fn reach(&self, paths: &mut [Path], island: &Polygon) {
        let inside = LazyCell::new(|| EdgeGrid::of(island));
        for path in paths.iter_mut().filter(|path| !path.closed) {
            let Width::PerVertex(widths) = &mut path.width else { continue };
            for _ in 0..2 {
                let width_mm = widths.last().copied().unwrap_or_default();
                if let Some(tip) = self.beyond(&path.points, f64::from(width_mm))
                    && inside.contains(tip)
                {
                    path.points.push(tip);
                    widths.push(width_mm);
                }
                path.points.reverse();
                widths.reverse();
            }
        }
    }

    /// Whether an inner loop of an island hangs over air, while the outer ones are held, as in a narrow strip between thin
    /// walls: it has to wait for them.
    pub fn outer_first(&self, paths: &[Path]) -> bool {
        let loops = |role| paths.iter().filter(move |path| path.role == role && path.closed);
        let leaves = |path: &Path| along(round(path), 2.0 * DANGLE_MM).any(|(at, _)| !self.holds_at(at));
        let hangs = |role| loops(role).any(|path| self.hangs(path));
        loops(Role::Perimeter).next().is_some()
            && loops(Role::ExternalPerimeter).any(leaves)
            && hangs(Role::Perimeter)
            && !hangs(Role::ExternalPerimeter)
    }

    /// Where a bead that hangs at its end would lie on what is beyond that.
    fn beyond(&self, points: &[Point], width_mm: f64) -> Option<Point> {
        let end = points.last()?.mm();
        let mut back =
            along(points.iter().rev().map(|p| p.mm()), STEP_MM).take_while(|(at, _)| !self.holds_at(*at));
        let (behind, _) = back.find(|&(_, along_mm)| along_mm >= DANGLE_MM)?;
        let length_mm = geometry::distance_mm(behind, end);
        let extended = |mm: f64| [0, 1].map(|k| end[k] + mm * (end[k] - behind[k]) / length_mm);
        let mut probes = (1..=PROBES).map(|i| f64::from(i) * PROBE * width_mm);
        let [x, y] = extended(probes.find(|&mm| self.holds_at(extended(mm)))? + width_mm / 2.0);
        (length_mm > 0.0).then(|| Point::from_mm(x, y))
    }

    /// Whether a loop runs over air without being a bridge: no part of it is supported, or it turns back over air.
    fn hangs(&self, path: &Path) -> bool {
        let samples: Vec<([f64; 2], bool)> =
            along(round(path), STEP_MM).map(|(at, _)| (at, self.holds_at(at))).collect();
        let length_mm = STEP_MM * samples.len() as f64;
        let Some(start) = samples.iter().position(|sample| sample.1) else { return length_mm > DANGLE_MM };
        let mut run: Vec<[f64; 2]> = Vec::new();
        for &(at, held) in samples[start..].iter().chain(&samples[..=start]) {
            if !held {
                run.push(at);
                continue;
            }
            if let [from, .., to] = run[..] {
                let run_mm = STEP_MM * run.len() as f64;
                if run_mm > 2.0 * DANGLE_MM && geometry::distance_mm(from, to) < TURN * run_mm {
                    return true;
                }
            }
            run.clear();
        }
        false
    }
}

/// The vertices of a loop, the first one again at the end.
fn round(path: &Path) -> impl Iterator<Item = [f64; 2]> {
    path.points.iter().chain(path.points.first()).map(|p| p.mm())
}

/// Points along a polyline at a spacing, with their distance from its start.
fn along(points: impl Iterator<Item = [f64; 2]>, step_mm: f64) -> impl Iterator<Item = ([f64; 2], f64)> {
    let mut last: Option<[f64; 2]> = None;
    let (mut along_mm, mut count) = (0.0, 0_u32);
    points.flat_map(move |to| {
        let from = last.replace(to).unwrap_or(to);
        let length_mm = geometry::distance_mm(from, to);
        let start_mm = along_mm;
        along_mm += length_mm;
        let first = count;
        count = (along_mm / step_mm) as u32 + 1;
        (first..count).map(move |i| {
            let at_mm = f64::from(i) * step_mm;
            let share = if length_mm > 0.0 { (at_mm - start_mm) / length_mm } else { 0.0 };
            ([0, 1].map(|k| from[k] + (to[k] - from[k]) * share), at_mm)
        })
    })
}
