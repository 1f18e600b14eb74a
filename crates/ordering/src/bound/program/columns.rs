//! Links that are missing in the program.

use super::super::cuts::common;
use super::super::directions::RUNS;
use super::super::relaxation::Relaxation;
use super::families::Families;
use super::simplex::{Rows, Solution};

/// Links that are added at once, at most, for each terminal.
const MOST: usize = 3;

/// Links that cost less than they are worth, the cheapest first, but not too many.
pub(super) fn missing(
    relaxation: &Relaxation,
    solution: &Solution,
    rows: &Rows,
    families: &Families,
) -> Vec<(u32, u32)> {
    let model = relaxation.model;
    let prices = &solution.multipliers;
    let weights = relaxation.weights(prices);
    let active = relaxation.cuts.active(&prices.cuts);
    let mut found = Vec::new();
    for (i, one) in (0u32..).zip(&model.bodies) {
        for (j, other) in (0u32..).zip(&model.bodies).skip(i as usize + 1) {
            if !model.permits(i, j) {
                continue;
            }
            let depth = model.depth(i, j);
            let run = |from: u32, to: u32| match relaxation.directions.as_ref().zip(weights.fares()) {
                Some((directions, fares)) if depth <= RUNS && model.leads(from, to) => {
                    let [tail, head] = [from, to].map(|item| directions.run_of[item as usize]);
                    fares.of(tail, head)
                }
                Some(_) if depth <= RUNS => i64::MAX / 4,
                _ => 0,
            };
            let sets = rows.trees.iter().zip(&solution.trees);
            let sets = sets.filter(|(set, _)| set[i as usize] && set[j as usize]).map(|(_, price)| price);
            let pair = sets.sum::<i64>()
                + solution.families[families.of[depth][i as usize] as usize]
                + run(i, j).min(run(j, i));
            for a in one.first..one.last {
                for b in other.first..other.last {
                    let least = pair + weights.at(a) + weights.at(b);
                    if least >= 0 || relaxation.is_known(a, b) {
                        continue;
                    }
                    let least = least + model.cheapest(a, b);
                    if least >= 0 {
                        continue;
                    }
                    let both = common(&active[a as usize], &active[b as usize]);
                    let both: i64 = both.map(|cut| prices.cuts[cut as usize]).sum();
                    let ties = relaxation.tied(a, b, prices) + relaxation.tied(b, a, prices);
                    let excess = least + 2 * both + ties;
                    if excess < -ROUNDING {
                        found.push((excess, (a, b)));
                    }
                }
            }
        }
    }
    found.sort_unstable();
    found.truncate(MOST * model.terminals.len());
    found.into_iter().map(|(_, link)| link).collect()
}

/// What multipliers may be off by, fine units.
const ROUNDING: i64 = 16;
