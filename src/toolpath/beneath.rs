//! The layer beneath walls and gap beads: over air, beads are extended to where they are held, and loops wait for those
//! that are held.

use std::cell::{LazyCell, OnceCell};

use geometry::real;
use geometry::{Boxes, EdgeGrid, Point, Polygon, Region};

use super::Path;
use super::path::{Role, Width};

/// Distance between the points looked at.
const STEP_MM: f64 = 0.5;

/// What hangs over less than this holds by itself.
const DANGLE_MM: f64 = 1.5;

/// Beyond an end, an anchor is searched in this many steps of this many bead widths: behind the loops that turn before it.
const PROBES: u32 = 16;
const PROBE: f64 = 0.25;

/// A gap bead that nothing holds may go on so far between the walls that span the same air.
const GAP_REACH_MM: f64 = 6.0;

/// Directions beyond an end: so many to each side, so far from each other, and how many steps are looked at in them.
#[derive(Clone, Copy)]
struct Ways {
    turns: i32,
    probes: u32,
}
const TURN_RAD: f64 = std::f64::consts::FRAC_PI_8;
const ASIDE: Ways = Ways { turns: 4, probes: 10 };

/// A bead over air between ends nearer than this share of it is a loop that turns there, not a bridge.
const TURN: f64 = 0.5;

/// The end of a path that hangs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LooseEnd {
    pub path: usize,
    /// Whether it is the path's first vertex, not its last.
    pub is_start: bool,
}

/// The end of a bead that hangs, and a point before it.
struct Onward {
    behind: [f64; 2],
    end: [f64; 2],
}

/// The layer beneath.
#[derive(Debug)]
pub(super) struct Beneath<'a> {
    pub region: &'a Region,
    /// The same, for looking up samples.
    grid: OnceCell<EdgeGrid>,
    boxes: OnceCell<Boxes>,
}

impl<'a> Beneath<'a> {
    pub fn new(region: &'a Region) -> Self {
        Self { region, grid: OnceCell::new(), boxes: OnceCell::new() }
    }

    /// Whether it has exactly this polygon.
    pub fn has(&self, polygon: &Polygon) -> bool {
        self.boxes.get_or_init(|| Boxes::of(self.region)).find(self.region, polygon)
    }

    /// Whether there is something right under a point.
    pub fn holds(&self, point: Point) -> bool {
        self.grid.get_or_init(|| EdgeGrid::new(self.region)).contains(point)
    }

    fn holds_at(&self, [x, y]: [f64; 2]) -> bool {
        self.holds(Point::from_mm(x, y))
    }

    /// Extends single beads that end over air, just before an anchor, until they lie on it; those in gaps that nothing holds go
    /// on to one further away. The ends that still hang.
    pub fn reach(&self, paths: &mut [Path], island: &Polygon) -> Vec<LooseEnd> {
        let inside = LazyCell::new(|| EdgeGrid::of(island));
        let mut loose = Vec::new();
        for (index, path) in paths.iter_mut().enumerate().filter(|(_, path)| !path.closed) {
            let Width::PerVertex(widths) = &mut path.width else { continue };
            let mut floats = None;
            for is_start in [false, true] {
                let width_mm = f64::from(widths.last().copied().unwrap_or_default());
                if let Some(onward) = self.onward(&path.points) {
                    let floats = *floats
                        .get_or_insert_with(|| path.role == Role::GapFill && self.floats(&path.points));
                    let probes = if floats { (GAP_REACH_MM / (PROBE * width_mm)) as u32 } else { PROBES };
                    let is_free = |tip| self.is_inside(&inside, onward.end, tip);
                    match self.beyond(&onward, Ways { turns: 0, probes }, width_mm, is_free) {
                        Some(tip) => {
                            path.points.push(tip);
                            widths.push(width_mm as f32);
                        }
                        None => loose.push(LooseEnd { path: index, is_start }),
                    }
                }
                path.points.reverse();
                widths.reverse();
            }
        }
        loose
    }

    /// Extends lines that end over air beside an anchor until they lie on it, whichever way, but not into the outermost wall
    /// of the island.
    pub fn reach_aside(&self, paths: &mut [Path], island: &Polygon) {
        let edge = LazyCell::new(|| EdgeGrid::of(island));
        for path in paths.iter_mut().filter(|path| !path.closed) {
            let width_mm = path.width.widest_mm();
            let is_free = |tip| edge.contains(tip) && edge.distance_mm(tip, width_mm) >= width_mm;
            for _ in 0..2 {
                let onward = self.onward(&path.points);
                if let Some(tip) = onward.and_then(|onward| self.beyond(&onward, ASIDE, width_mm, is_free)) {
                    path.points.push(tip);
                    if let Width::PerVertex(widths) = &mut path.width {
                        widths.extend(widths.last().copied());
                    }
                }
                path.points.reverse();
                if let Width::PerVertex(widths) = &mut path.width {
                    widths.reverse();
                }
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

    /// Whether nothing is under a bead.
    fn floats(&self, points: &[Point]) -> bool {
        !along(points.iter().map(|p| p.mm()), STEP_MM).any(|(at, _)| self.holds_at(at))
    }

    /// Whether the way from a bead's end to a tip lies within the island.
    fn is_inside(&self, island: &EdgeGrid, end: [f64; 2], tip: Point) -> bool {
        let mut way = along([end, tip.mm()].into_iter(), STEP_MM).skip(1);
        island.contains(tip) && way.all(|([x, y], _)| island.contains(Point::from_mm(x, y)))
    }

    /// The end of a bead, if it hangs there, and a point further back of what hangs.
    fn onward(&self, points: &[Point]) -> Option<Onward> {
        let end = points.last()?.mm();
        let mut back =
            along(points.iter().rev().map(|p| p.mm()), STEP_MM).take_while(|(at, _)| !self.holds_at(*at));
        let (behind, _) = back.find(|&(_, along_mm)| along_mm >= DANGLE_MM)?;
        Some(Onward { behind, end })
    }

    /// Where a bead that hangs at its end would lie on what is beyond that.
    fn beyond(
        &self,
        Onward { behind, end }: &Onward,
        ways: Ways,
        width_mm: f64,
        is_free: impl Fn(Point) -> bool,
    ) -> Option<Point> {
        let length_mm = geometry::distance_mm(*behind, *end);
        if length_mm <= 0.0 {
            return None;
        }
        let ahead = [0, 1].map(|k| (end[k] - behind[k]) / length_mm);
        let tip = |probe: u32, turn: i32| {
            let (sine, cosine) = real::sin_cos(f64::from(turn) * TURN_RAD);
            let way = [ahead[0] * cosine - ahead[1] * sine, ahead[1] * cosine + ahead[0] * sine];
            let at = |mm: f64| [0, 1].map(|k| end[k] + mm * way[k]);
            let probe_mm = f64::from(probe) * PROBE * width_mm;
            let [x, y] = at(probe_mm + width_mm / 2.0);
            self.holds_at(at(probe_mm)).then(|| Point::from_mm(x, y))
        };
        let turns =
            |probe| (-ways.turns..=ways.turns).filter_map(move |turn| Some((turn, tip(probe, turn)?)));
        let nearest = (1..=ways.probes).find_map(|probe| turns(probe).min_by_key(|(turn, _)| turn.abs()));
        nearest.map(|(_, tip)| tip).filter(|&tip| is_free(tip))
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
