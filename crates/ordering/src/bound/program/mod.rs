//! Multipliers from a linear program over links: the best there are for the known links, pieces and sets.
//!
//! The program has a share for each known link, and for each piece of a loop that with which the loop is entered there. Its
//! constraints are those of the relaxation, whose trees are sets of paths in which links close no circle. Sets that a solution
//! violates are found by least cuts, pieces that it crosses become smaller, links that are missing are those that cost less than they
//! are worth. The relaxation evaluates the multipliers over all links, in integers: an error of the solver makes a bound weaker, never
//! wrong. Without links, sets or pieces that are missing, the bound is the program's optimum.

mod aside;
mod certificate;
mod columns;
mod families;
mod precedence;
mod refinement;
mod separation;
mod simplex;

use super::model::{Model, PIECES, Pieces, pieces, to_mm};
use super::points::PricedPoints;
use super::relaxation::{Multipliers, Relaxation};
use super::solution::{outer, prices};
use super::walks::Settled;
use crate::{Cost, Effort, Optimized, Problem, Strategy, Visit};
use pathwright_geometry::Point;

pub use certificate::{Certificate, Cut, Tie};
use refinement::Carried;
use simplex::{Program, Rows, Solution};

/// Length of a loop's first pieces, as so many links of a solution, and how many there are at most.
const LONG: f64 = 4.0;
const MOST_PIECES: usize = 32;
/// How often pieces become smaller at most, and how often the program is solved in between.
const REFINEMENTS: usize = 16;
const ROUNDS: usize = 200;
/// Missing links are looked for when no set is, and every so many rounds.
const LOOK: usize = 3;
/// Pieces, where there are any, become smaller when in two rounds the program came nearer to the limit by less than this share of what was left,
const TAIL: f64 = 0.05;
/// and its multipliers are worth as much over all links, but for this share.
const MISSING: f64 = 0.01;
/// Links are known again with smaller pieces if they cost no more than they are worth and this share of what was left.
const WORTH: f64 = 0.1;
/// Work that a solution takes besides the solver's iterations, as so many of these.
const OTHER: i64 = 50;

/// What may be spent for each path: rows times iterations.
fn work(effort: Effort) -> i64 {
    match effort {
        Effort::Fast => 0,
        Effort::Normal => 100_000,
        Effort::High => 400_000,
    }
}

/// The best that was found: a bound, and the share of the layer.
pub(super) struct Best {
    pub(super) bound: i64,
    pub(super) settled: Settled,
    /// Whether more work would not have raised it.
    pub(super) is_final: bool,
    /// For others, if it was asked for.
    pub(super) certificate: Option<Certificate>,
}

/// A layer between what lies below and above, and a solution with its cost.
pub(super) struct Climb<'a> {
    problem: &'a Problem<'a>,
    cost: &'a Cost,
    ends: &'a [Option<PricedPoints>; 2],
    order: Vec<Visit>,
    limit: i64,
    /// What may still be spent.
    work: i64,
    /// Whether there will be a certificate, for these ends.
    certified: Option<[Option<Point>; 2]>,
}

impl<'a> Climb<'a> {
    pub(super) fn new(
        problem: &'a Problem,
        cost: &'a Cost,
        ends: &'a [Option<PricedPoints>; 2],
        effort: Effort,
    ) -> Self {
        let order = Optimized.solve(problem, cost, Effort::Normal);
        let beyond = |side: usize, p| ends[side].as_ref().map_or(0, |points| points.nearest(p));
        let limit = prices(problem, &order, cost).sum::<i64>() + outer(problem, &order, beyond);
        Self {
            problem,
            cost,
            ends,
            order,
            limit,
            work: work(effort) * problem.items.len() as i64,
            certified: None,
        }
    }

    /// Asks for a certificate, for these ends.
    pub(super) fn certified(self, ends: [Option<Point>; 2]) -> Self {
        Self { certified: Some(ends), ..self }
    }

    /// The best bound; `None` if nothing may be spent, or the solver fails.
    pub(super) fn best(mut self) -> Option<Best> {
        if self.work == 0 {
            return None;
        }
        let mut best = None;
        let links: i64 = prices(self.problem, &self.order, &Cost::Length).sum();
        let link_mm = to_mm(links.max(1)) / self.problem.items.len() as f64;
        let count = |loop_mm: f64| ((loop_mm / (LONG * link_mm)) as usize).clamp(PIECES, MOST_PIECES);
        let mut pieces = pieces(self.problem, count);
        let mut carried = None;
        for _ in 0..REFINEMENTS {
            let model = Model::of_pieces(self.problem, self.cost, &pieces);
            let (relaxation, rows) = self.begin(&model, carried.take());
            let Some(finer) = self.solve(relaxation, rows, &pieces, &mut best, &mut carried) else { break };
            pieces = finer;
        }
        best.map(|best| Best { is_final: self.work > 0, ..best })
    }

    /// The relaxation for these pieces, with what is known.
    fn begin<'m>(&self, model: &'m Model, carried: Option<Carried>) -> (Relaxation<'m>, Rows) {
        let mut relaxation = if carried.is_none() { Relaxation::new(model) } else { Relaxation::bare(model) };
        for (side, points) in (0..).zip(self.ends).filter_map(|(side, points)| Some((side, points.as_ref()?)))
        {
            relaxation.measure(side, |p| points.nearest(p));
        }
        relaxation.add_order(&self.order);
        let rows = carried.map_or_else(Rows::default, |carried| carried.restore(&mut relaxation));
        relaxation.share_cuts();
        (relaxation, rows)
    }

    /// Solves the program with these pieces until it gains little; finer ones, if these are too coarse.
    fn solve(
        &mut self,
        mut relaxation: Relaxation,
        mut rows: Rows,
        pieces: &Pieces,
        best: &mut Option<Best>,
        carried: &mut Option<Carried>,
    ) -> Option<Pieces> {
        let mut program = Program::new(&relaxation);
        let (mut values, mut proved) = (Vec::new(), i64::MIN);
        let mut last = None;
        for round in 0..ROUNDS {
            let Some(mut solution) = program.solve(&relaxation, &rows) else { break };
            self.work -= (solution.iterations + OTHER) * program.rows();
            let is_over = self.work <= 0 || round + 1 == ROUNDS;
            let added = if is_over { 0 } else { separation::separate(&mut relaxation, &mut rows, &solution) };
            values.push(solution.value);
            let looks = added == 0 || round % LOOK == LOOK - 1;
            let mut grown = false;
            if looks {
                solution.multipliers.cuts.resize(relaxation.cuts.members.len(), 0);
                solution.multipliers.passages.resize(relaxation.passages.len(), 0);
                let missing = columns::missing(&relaxation, &solution, &rows, &program.families);
                grown = self.evaluate(&mut relaxation, &solution.multipliers, &mut proved, best);
                grown |= !missing.is_empty();
                missing.into_iter().for_each(|(a, b)| relaxation.add_link(a, b));
            }
            relaxation.share_cuts();
            last = Some(solution);
            if is_over || proved >= self.limit || looks && !grown && added == 0 {
                break;
            }
            if looks && relaxation.model.has_pieces() && self.gains_little(&values, proved) {
                break;
            }
        }
        let solution: Solution = last?;
        if self.work <= 0 || proved >= self.limit {
            return None;
        }
        let finer = refinement::finer(&relaxation, &solution, pieces, self.ends)?;
        let worth = WORTH * self.limit.saturating_sub(proved) as f64;
        *carried = Some(Carried::new(&relaxation, &solution, rows, (pieces, &finer), worth));
        Some(finer)
    }

    /// Evaluates multipliers over all links and makes those of the cheapest tree known; whether any was new.
    fn evaluate(
        &self,
        relaxation: &mut Relaxation,
        multipliers: &Multipliers,
        proved: &mut i64,
        best: &mut Option<Best>,
    ) -> bool {
        let (bound, tree) = relaxation.exact(multipliers);
        *proved = bound.max(*proved);
        if best.as_ref().is_none_or(|best| bound > best.bound) {
            let settled = relaxation.settle(bound, multipliers);
            let certificate =
                self.certified.and_then(|ends| Certificate::new(relaxation, multipliers, bound, ends));
            *best = Some(Best { bound, settled, is_final: false, certificate });
        }
        relaxation.add_tree(&tree)
    }

    fn gains_little(&self, values: &[f64], proved: i64) -> bool {
        let [.., before, _, now] = values else { return false };
        let left = self.limit as f64 - now;
        now - before < TAIL * left && proved as f64 > now - MISSING * left
    }
}
