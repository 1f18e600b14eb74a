//! What the relaxation knows of a layer: terminals at which links may end, and which links precedence permits.

use std::cmp::Ordering;

use super::super::cost::{LinkCosts, Place};
use super::super::{Cost, LinkKind, Problem, Shape};
use crate::options::Scope;
use pathwright_geometry::{Point, UNITS_PER_MM};

/// Costs and multipliers are integers, this many to a grid unit, so that sums are exact. Rounding each link down by
/// less than one of them (0.6 nm) costs a thousand links less than a micrometre.
const FINE: f64 = 16.0;

/// Pieces of a free loop that the relaxation tells apart. On layers of two prints at `layer` scope one piece left a gap of
/// 33 %, four 27 %, eight 26 %, sixteen no less in the same number of steps.
pub(super) const PIECES: usize = 8;

/// Where the pieces of each path's entries begin, the first of which is 0.
pub(super) type Pieces = Vec<Vec<u32>>;

/// As many pieces of each loop, of about equal length, as `count` says for its length in millimetres, none without a vertex; and
/// the ends of open paths.
pub(super) fn pieces(problem: &Problem, count: impl Fn(f64) -> usize) -> Pieces {
    let of = |shape: &Shape| match shape {
        Shape::Open(_) => vec![0, 1],
        Shape::Loop(vertices) => pieces_of(vertices, &count),
    };
    problem.items.iter().map(|item| of(&item.shape)).collect()
}

fn pieces_of(vertices: &[Point], count: impl Fn(f64) -> usize) -> Vec<u32> {
    if vertices.len() <= PIECES {
        return (0..vertices.len() as u32).collect();
    }
    let steps = vertices.windows(2).map(|pair| pair[0].distance_mm(pair[1]));
    let mut along = vec![0.0];
    along.extend(steps.scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    }));
    let whole_mm = along[along.len() - 1].max(f64::MIN_POSITIVE);
    let piece_mm = whole_mm / count(whole_mm) as f64;
    let number = |k: usize| (along[k] / piece_mm) as usize;
    let starts = (1..vertices.len()).filter(|&k| number(k) != number(k - 1));
    std::iter::once(0).chain(starts).map(|start| start as u32).collect()
}

/// Length of a link in fine units, rounded down. The square root errs by less than the thousandth taken off.
pub(super) fn link(a: Point, b: Point) -> i64 {
    (((a.distance2(b) as f64).sqrt() * FINE - 1e-3) as i64).max(0)
}

/// Fine units of time to a second.
const FINE_S: f64 = 1e9;

/// Cost of a link in fine units, rounded down: of a time, nanoseconds, of which more is taken off than its computation errs.
pub(super) fn price(cost: &LinkCosts, a: Point, b: Point, kind: LinkKind) -> i64 {
    match cost {
        LinkCosts::Length => link(a, b),
        LinkCosts::Time(time) => ((time.of(a.distance_mm(b), kind) * FINE_S - 1.0) as i64).max(0),
    }
}

/// The least that a link can cost, in fine units, which is as long as this or one grid unit shorter, for rounding.
pub(super) fn least_price(cost: &LinkCosts, units: f64) -> i64 {
    match cost {
        LinkCosts::Length => fine(units) - 1,
        LinkCosts::Time(_) => (cost.least((units - 1.0).max(0.0) / UNITS_PER_MM) * FINE_S - 2.0) as i64,
    }
}

/// Fine units to the unit of a cost: millimetres or seconds.
pub(super) fn from_fine(cost: &Cost, fine: i64) -> f64 {
    match cost {
        Cost::Length => to_mm(fine),
        Cost::Time(_) => fine as f64 / FINE_S,
    }
}

/// Grid units to fine units, rounded down.
pub(super) fn fine(units: f64) -> i64 {
    (units * FINE - 1e-3) as i64
}

/// Fine units to millimetres.
pub(super) fn to_mm(fine: i64) -> f64 {
    fine as f64 / (FINE * UNITS_PER_MM)
}

/// A point, or a set of points, at which links end: an end of an open path, a piece of a loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terminal {
    pub(super) item: u32,
    /// Its points: `first..last`.
    pub(super) first: u32,
    pub(super) last: u32,
}

/// A path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// Its terminals: `first..last`.
    pub(super) first: u32,
    pub(super) last: u32,
    /// An open path has one link at each terminal; a loop two at one terminal.
    pub(super) closed: bool,
    /// Nested groups: stage; run under `feature`, island under `island`; run under `island`.
    pub(super) groups: [u32; 3],
    /// Island and layer, and position of the run's rank among the ranks of its island in its stage.
    pub(super) place: Place,
    pub(super) rank: u32,
    /// Whether nothing of its stage must come before, or after.
    begins: bool,
    ends: bool,
}

impl Body {
    /// Whether it is a loop of which several pieces are distinguished.
    pub(super) fn is_split(&self) -> bool {
        self.closed && self.last - self.first > 1
    }
}

/// The depth at which two paths part: 0 in different stages, up to 3 within one run.
pub(super) const DEPTHS: usize = 4;

/// A layer.
pub(super) struct Model {
    pub(super) points: Vec<Point>,
    /// Terminal of each point.
    pub(super) owner: Vec<u32>,
    pub(super) terminals: Vec<Terminal>,
    pub(super) bodies: Vec<Body>,
    pub(super) scope: Scope,
    /// What its links cost.
    pub(super) cost: LinkCosts,
    stages: u32,
}

impl Model {
    pub(super) fn new(problem: &Problem, cost: &Cost) -> Self {
        Self::of_pieces(problem, cost, &pieces(problem, |_| PIECES))
    }

    pub(super) fn of_pieces(problem: &Problem, cost: &Cost, pieces: &Pieces) -> Self {
        let sorted = |mut values: Vec<(u32, u32, u32)>| {
            values.sort_unstable();
            values.dedup();
            values
        };
        let used: Vec<_> = problem.items.iter().map(|item| problem.runs[item.run as usize]).collect();
        let stages = sorted(used.iter().map(|run| (run.stage, 0, 0)).collect());
        let ranks = sorted(used.iter().map(|run| (run.stage, run.island, run.rank)).collect());
        let mut model = Self {
            points: Vec::new(),
            owner: Vec::new(),
            terminals: Vec::new(),
            bodies: Vec::with_capacity(problem.items.len()),
            scope: problem.scope,
            cost: LinkCosts::from(*cost),
            stages: stages.len() as u32,
        };
        for ((item, run), pieces) in problem.items.iter().zip(&used).zip(pieces) {
            let stage = stages.partition_point(|&(stage, ..)| stage < run.stage) as u32;
            let from = ranks.partition_point(|&rank| rank < (run.stage, run.island, 0));
            let to = ranks.partition_point(|&rank| rank <= (run.stage, run.island, u32::MAX));
            let at = ranks.partition_point(|&rank| rank < (run.stage, run.island, run.rank));
            let mixed = problem.scope == Scope::Layer;
            let groups = match problem.scope {
                Scope::Layer => [stage, 0, 0],
                Scope::Feature => [stage, item.run, 0],
                // The first rank of an island, by number, stands for the island.
                Scope::Island => [stage, from as u32, item.run],
            };
            let first = model.terminals.len() as u32;
            let entries = item.shape.entries();
            let ends = pieces.iter().skip(1).copied().chain([entries.len() as u32]);
            for (&from, to) in pieces.iter().zip(ends) {
                model.add_terminal(&entries[from as usize..to as usize]);
            }
            model.bodies.push(Body {
                first,
                last: model.terminals.len() as u32,
                closed: matches!(item.shape, Shape::Loop(_)),
                groups,
                place: run.place(),
                rank: (at - from) as u32,
                begins: mixed || at == from,
                ends: mixed || at + 1 == to,
            });
        }
        model
    }

    fn add_terminal(&mut self, points: &[Point]) {
        let terminal = self.terminals.len() as u32;
        let first = self.points.len() as u32;
        self.points.extend(points);
        self.owner.resize(self.points.len(), terminal);
        self.terminals.push(Terminal {
            item: self.bodies.len() as u32,
            first,
            last: self.points.len() as u32,
        });
    }

    pub(super) fn points_of(&self, terminal: u32) -> &[Point] {
        let Terminal { first, last, .. } = self.terminals[terminal as usize];
        &self.points[first as usize..last as usize]
    }

    /// The least cost of a link between two terminals, in fine units: that between their nearest points.
    pub(super) fn cheapest(&self, a: u32, b: u32) -> i64 {
        let (p, q) = self.nearest(a, b);
        self.price(p, q)
    }

    /// Cost of a link between two points, in fine units.
    pub(super) fn price(&self, p: u32, q: u32) -> i64 {
        let [a, b] = [p, q].map(|point| self.points[point as usize]);
        match self.cost {
            LinkCosts::Length => link(a, b),
            LinkCosts::Time(_) => {
                price(&self.cost, a, b, self.kind(self.item_of_point(p), self.item_of_point(q)))
            }
        }
    }

    /// The nearest points of two terminals.
    pub(super) fn nearest(&self, a: u32, b: u32) -> (u32, u32) {
        let [from, to] = [a, b].map(|t| self.terminals[t as usize]);
        let pairs = (from.first..from.last).flat_map(|p| (to.first..to.last).map(move |q| (p, q)));
        let distance = |&(p, q): &(u32, u32)| self.points[p as usize].distance2(self.points[q as usize]);
        pairs.min_by_key(distance).unwrap_or((from.first, to.first))
    }

    /// Whether a terminal is an end of an open path.
    pub(super) fn is_end(&self, terminal: u32) -> bool {
        !self.bodies[self.terminals[terminal as usize].item as usize].closed
    }

    /// Where the points of a path are in the list of all.
    pub(super) fn range_of_item(&self, item: u32) -> std::ops::Range<usize> {
        let Body { first, last, .. } = self.bodies[item as usize];
        let [first, last] = [first, last - 1].map(|t| self.terminals[t as usize]);
        first.first as usize..last.last as usize
    }

    pub(super) fn points_of_item(&self, item: u32) -> &[Point] {
        &self.points[self.range_of_item(item)]
    }

    pub(super) fn item_of_point(&self, point: u32) -> u32 {
        self.terminals[self.owner[point as usize] as usize].item
    }

    /// The run of each path, numbered from 0.
    pub(super) fn run_of(&self) -> Vec<u32> {
        let mut all: Vec<_> = self.bodies.iter().map(|body| body.groups).collect();
        all.sort_unstable();
        all.dedup();
        self.bodies.iter().map(|body| all.partition_point(|groups| *groups < body.groups) as u32).collect()
    }

    /// Pairs of runs, numbered as `run_of` says, of which the first directly precedes the second in an island that may be
    /// left between them. (Where it may not, links tell the direction already.)
    pub(super) fn successions(&self, run_of: &[u32]) -> Vec<(u32, u32)> {
        if self.scope != Scope::Feature {
            return Vec::new();
        }
        let key = |body: &Body| (body.groups[0], body.place.island, body.rank);
        let mut runs: Vec<_> = self.bodies.iter().map(key).zip(run_of).collect();
        runs.sort_unstable();
        runs.dedup();
        let mut pairs = Vec::new();
        for (k, &((stage, island, rank), &run)) in runs.iter().enumerate() {
            let next = (stage, island, rank + 1);
            let later =
                runs[k + 1..].iter().skip_while(|other| other.0 < next).take_while(|other| other.0 == next);
            pairs.extend(later.map(|&(_, &other)| (run, other)));
        }
        pairs
    }

    /// What a link between two paths leads over.
    pub(super) fn kind(&self, i: u32, j: u32) -> LinkKind {
        let [from, to] = [i, j].map(|item| self.bodies[item as usize].place);
        LinkKind::joining(from, to)
    }

    /// The depth at which two paths part.
    pub(super) fn depth(&self, i: u32, j: u32) -> usize {
        let (a, b) = (&self.bodies[i as usize].groups, &self.bodies[j as usize].groups);
        (0..3).find(|&k| a[k] != b[k]).unwrap_or(3)
    }

    /// Whether precedence lets one of two paths follow the other.
    pub(super) fn permits(&self, i: u32, j: u32) -> bool {
        let (a, b) = (&self.bodies[i as usize], &self.bodies[j as usize]);
        let in_turn = a.rank.abs_diff(b.rank) <= 1;
        match (self.depth(i, j), self.scope) {
            (3, _) => i != j,
            (2, _) => in_turn,
            (1, Scope::Island) => a.ends && b.begins || a.begins && b.ends,
            (1, _) => a.place.island != b.place.island || in_turn,
            _ => {
                let (low, high) = if a.groups[0] < b.groups[0] { (a, b) } else { (b, a) };
                low.groups[0] + 1 == high.groups[0] && low.ends && high.begins
            }
        }
    }

    /// Whether precedence lets one path come straight after another, of another run.
    pub(super) fn leads(&self, from: u32, to: u32) -> bool {
        let [a, b] = [from, to].map(|item| &self.bodies[item as usize]);
        let ascends = match a.groups[0].cmp(&b.groups[0]) {
            Ordering::Equal => a.place.island != b.place.island || a.rank <= b.rank,
            stages => stages == Ordering::Less,
        };
        ascends && self.permits(from, to)
    }

    /// Whether there are loops of which several pieces are distinguished.
    pub(super) fn has_pieces(&self) -> bool {
        self.bodies.iter().any(Body::is_split)
    }

    /// Number of stages.
    pub(super) fn stages(&self) -> usize {
        self.stages as usize
    }

    /// Whether a walk may begin its stage with this path.
    pub(super) fn may_begin_stage(&self, item: u32) -> bool {
        self.bodies[item as usize].begins
    }

    /// Whether a walk may begin with this path.
    pub(super) fn may_begin(&self, item: u32) -> bool {
        let body = &self.bodies[item as usize];
        body.groups[0] == 0 && body.begins
    }

    /// Every point at which a walk may begin (0) or end (1).
    pub(super) fn ends(&self, side: usize) -> impl Iterator<Item = Point> {
        let permits = move |item| if side == 0 { self.may_begin(item) } else { self.may_end(item) };
        self.points.iter().zip(0..).filter(move |&(_, k)| permits(self.item_of_point(k))).map(|(&p, _)| p)
    }

    /// Whether a walk may end with this path.
    pub(super) fn may_end(&self, item: u32) -> bool {
        let body = &self.bodies[item as usize];
        body.groups[0] + 1 == self.stages && body.ends
    }
}
