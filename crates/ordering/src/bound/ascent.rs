//! Held and Karp's ascent: multipliers follow what the tree does too often or too seldom.

use pathwright_geometry::real;

use super::relaxation::{Multipliers, Relaxation};
use super::tree::Usage;

/// Steps. Four times as many raise bounds by 0.5 % with pinned seams and 4 % with free ones.
const STEPS: usize = 150;
/// The first step, as a share of the first bound per terminal, and the last as a share of the first; in between they shrink
/// geometrically. Firsts from 1 to 3 and lasts from 0.003 to 0.03 end within 0.5 % of each other.
const FIRST: f64 = 2.0;
const LAST: f64 = 0.01;
/// Steps when multipliers were found before, and the first of them.
const AGAIN: usize = 50;
const FIRST_AGAIN: f64 = 0.5;
/// How far a step follows its own direction; the rest follows the one before it (Volgenant & Jonker 1982,
/// <https://doi.org/10.1016/0377-2217(82)90015-7>).
const FRESH: f64 = 0.7;
/// Multipliers of a run's terminals also move together, by this share of the sum of their directions: so the links into
/// and out of a run are balanced in a few steps, not one terminal at a time.
const TOGETHER: f64 = 0.5;
/// Steps before all links are looked at for the first time; after that, when a quarter more have been made.
const FIRST_LOOK: usize = 8;
/// Steps before cuts are looked for: earlier trees tell little.
const FIRST_CUTS: usize = 20;

/// Multipliers of one kind during the ascent.
struct Climb {
    at: Vec<f64>,
    last: Vec<f64>,
}

impl Climb {
    fn from(multipliers: &[i64]) -> Self {
        Self { at: multipliers.iter().map(|&at| at as f64).collect(), last: vec![0.0; multipliers.len()] }
    }

    /// Moves one multiplier and returns it, rounded to an integer.
    fn go(&mut self, k: usize, direction: f64, step: f64) -> i64 {
        self.at[k] += step * (FRESH * direction + (1.0 - FRESH) * self.last[k]);
        self.last[k] = direction;
        self.at[k] as i64
    }

    /// As [`Self::go`], not below zero.
    fn go_positive(&mut self, k: usize, direction: f64, step: f64) -> i64 {
        let to = self.go(k, direction, step);
        self.at[k] = self.at[k].max(0.0);
        to.max(0)
    }

    fn grow(&mut self, len: usize) {
        self.at.resize(len, 0.0);
        self.last.resize(len, 0.0);
    }
}

/// The best bound over all links that was found, and its multipliers (Held & Karp 1970 and 1971,
/// <https://doi.org/10.1287/opre.18.6.1138>, <https://doi.org/10.1007/BF01584070>).
///
/// `from` are those found before, for other points to come from and to continue to.
pub(super) fn ascend(relaxation: &mut Relaxation, from: Option<Multipliers>) -> (i64, Multipliers) {
    let (steps, first) = if from.is_some() { (AGAIN, FIRST_AGAIN) } else { (STEPS, FIRST) };
    let mut now = from.unwrap_or_else(|| relaxation.zero());
    relaxation.forget_trees();
    let mut usage = Usage::default();
    let mut ascent = Ascent::new(relaxation, &now);
    // Over all links, and over the known links.
    let mut proved = (relaxation.exact(&now).0, now.clone());
    let mut hoped = (relaxation.relax(&now, &mut usage), now.clone());
    let mut step = first * proved.0.max(now.nodes.len() as i64) as f64 / now.nodes.len().max(1) as f64;
    let (mut look, mut cut) = (FIRST_LOOK, 0);
    for k in 1..=steps {
        ascent.step(relaxation, &usage, &mut now, step);
        step *= real::pow(LAST * FIRST / first, 1.0 / steps as f64);
        let mut value = relaxation.relax(&now, &mut usage);
        if k == look {
            let (bound, tree) = relaxation.exact(&now);
            if bound > proved.0 {
                proved = (bound, now.clone());
            }
            let mut grown = relaxation.add_tree(&tree);
            if k >= FIRST_CUTS {
                grown |= relaxation.look_for_cuts((k - cut) as u32);
                cut = k;
            }
            if grown {
                ascent.grow(relaxation);
                for multipliers in [&mut now, &mut proved.1] {
                    multipliers.cuts.resize(relaxation.cuts.members.len(), 0);
                    multipliers.ties.resize(relaxation.ties, 0);
                }
                hoped = proved.clone();
                value = relaxation.relax(&now, &mut usage);
            }
            look += look / 4;
        }
        if value > hoped.0 {
            hoped = (value, now.clone());
        }
    }
    let (bound, _) = relaxation.exact(&hoped.1);
    if bound > proved.0 { (bound, hoped.1) } else { proved }
}

struct Ascent {
    nodes: Climb,
    cuts: Climb,
    ties: Climb,
    passages: Climb,
    directions: Vec<f64>,
    /// The terminal at which each loop is entered where that gives back most.
    entered: Vec<u32>,
    /// Run of each path, and the sum of its terminals' directions.
    run_of: Vec<u32>,
    runs: Vec<f64>,
}

impl Ascent {
    fn new(relaxation: &Relaxation, from: &Multipliers) -> Self {
        let model = relaxation.model;
        let mut ascent = Self {
            nodes: Climb::from(&from.nodes),
            cuts: Climb::from(&from.cuts),
            ties: Climb::from(&from.ties),
            passages: Climb::from(from.runs.as_flattened()),
            directions: vec![0.0; model.terminals.len()],
            entered: vec![0; model.bodies.len()],
            run_of: model.run_of(),
            runs: vec![0.0; model.bodies.len()],
        };
        ascent.grow(relaxation);
        ascent
    }

    fn grow(&mut self, relaxation: &Relaxation) {
        self.nodes.grow(relaxation.model.terminals.len());
        self.cuts.grow(relaxation.cuts.members.len());
        self.ties.grow(relaxation.ties);
    }

    fn step(&mut self, relaxation: &Relaxation, usage: &Usage, now: &mut Multipliers, step: f64) {
        let model = relaxation.model;
        self.runs.fill(0.0);
        for (item, body) in model.bodies.iter().enumerate() {
            let entered = if body.closed { relaxation.dearest(item, now).1 } else { 0 };
            self.entered[item] = body.first + entered as u32;
            for (piece, t) in (body.first as usize..body.last as usize).enumerate() {
                let here = i32::from(piece == entered);
                self.directions[t] = f64::from(usage.degrees[t] - if body.closed { 2 * here } else { 1 });
                self.runs[self.run_of[item] as usize] += self.directions[t];
                for &block in &relaxation.blocks[item] {
                    let tie = block as usize + piece;
                    now.ties[tie] = self.ties.go_positive(tie, f64::from(usage.tied[tie] - here), step);
                }
            }
        }
        for (t, terminal) in model.terminals.iter().enumerate() {
            let together = self.runs[self.run_of[terminal.item as usize] as usize];
            now.nodes[t] = self.nodes.go(t, self.directions[t] + TOGETHER * together, step);
        }
        let passed = usage.runs.as_flattened().iter().zip(now.runs.as_flattened_mut());
        for (k, (&times, multiplier)) in passed.enumerate() {
            *multiplier = self.passages.go(k, f64::from(times - 1), step);
        }
        for (cut, members) in relaxation.cuts.members.iter().enumerate() {
            let ends: i32 = members.iter().map(|&t| usage.degrees[t as usize]).sum();
            let leaving = ends - 2 * usage.inside[cut];
            let guard = relaxation.cuts.guard[cut];
            let bound = guard.is_none_or(|item| members.binary_search(&self.entered[item as usize]).is_ok());
            let least = if bound { relaxation.cuts.least[cut] } else { 0 };
            now.cuts[cut] = self.cuts.go_positive(cut, f64::from(least - leaving), step);
        }
    }
}
