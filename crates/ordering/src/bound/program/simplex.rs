//! The linear program over the known links, solved by HiGHS, whose simplex method goes on from the last solution when it has grown.

use highs::{Col, HighsModelStatus, Model as Simplex, Row, RowProblem, Sense};
use rustc_hash::FxHashMap;
use std::ops::RangeBounds;

use super::super::directions::RUNS;
use super::super::link::Link;
use super::super::model::{Body, DEPTHS, to_mm};
use super::super::relaxation::{Multipliers, Relaxation, WalkEnd};
use super::families::Families;

/// Constraints that are added where a solution violates them, besides cuts.
#[derive(Default)]
pub(super) struct Rows {
    /// Ties that count, with their terminals.
    pub(super) ties: Vec<(u32, u32)>,
    /// Sets of paths, by path, in which links close no circle.
    pub(super) trees: Vec<Vec<bool>>,
}

/// What solves the program; costs in fine units.
pub(super) struct Solution {
    pub(super) value: f64,
    /// Shares of links, and what they cost more than they are worth.
    pub(super) links: [Vec<f64>; DEPTHS],
    pub(super) excess: [Vec<f64>; DEPTHS],
    pub(super) ends: [Vec<f64>; 2],
    /// Shares of links between runs, from one to the other, where they have directions.
    pub(super) arcs: Vec<(u32, u32, f64)>,
    /// Share with which a path is entered at each terminal; 1 for ends and for loops in one piece.
    pub(super) entered: Vec<f64>,
    pub(super) multipliers: Multipliers,
    /// Prices of links within each tree, and of each family, of either sign.
    pub(super) trees: Vec<i64>,
    pub(super) families: Vec<i64>,
    pub(super) iterations: i64,
}

impl Solution {
    /// The links with a share above this, and the share.
    pub(super) fn used_links<'a>(
        &'a self,
        relaxation: &'a Relaxation,
        above: f64,
    ) -> impl Iterator<Item = (&'a Link, f64)> {
        let links =
            relaxation.links.iter().zip(&self.links).flat_map(|(links, shares)| links.iter().zip(shares));
        links.map(|(link, &share)| (link, share)).filter(move |&(_, share)| share > above)
    }

    /// The same of links into the layer (0) and out of it (1), with their side.
    pub(super) fn used_ends<'a>(
        &'a self,
        relaxation: &'a Relaxation,
        above: f64,
    ) -> impl Iterator<Item = (usize, &'a WalkEnd, f64)> {
        let ends = relaxation.walk_ends.iter().zip(&self.ends).enumerate();
        let ends = ends.flat_map(|(side, (ends, shares))| {
            ends.iter().zip(shares).map(move |(end, &share)| (side, end, share))
        });
        ends.filter(move |&(_, _, share)| share > above)
    }
}

/// A row and its number.
#[derive(Clone, Copy)]
struct Line {
    row: Row,
    number: usize,
}

impl Line {
    fn times(self, factor: f64) -> (Row, f64) {
        (self.row, factor)
    }
}

fn add_row(simplex: &mut Simplex, bounds: impl RangeBounds<f64>, factors: Vec<(Col, f64)>) -> Line {
    let number = simplex.num_rows();
    Line { row: simplex.add_row(bounds, factors), number }
}

/// The program.
pub(super) struct Program {
    /// Nothing after a failure.
    simplex: Option<Simplex>,
    /// Columns of links, two where they have two directions; of ends; of entries into loops of several pieces.
    links: [Vec<Vec<Col>>; DEPTHS],
    ends: [Vec<Col>; 2],
    entries: Vec<Option<Col>>,
    /// Rows of terminals, of families by their number, of links into and out of runs, and of what was added.
    nodes: Vec<Line>,
    pub(super) families: Families,
    family_lines: Vec<Option<Line>>,
    runs: Vec<[Line; 2]>,
    ties: Vec<Line>,
    line_of_tie: FxHashMap<u32, Line>,
    cuts: Vec<Line>,
    trees: Vec<Line>,
    passages: Vec<Line>,
    /// Whether a cut's row counts links within, not those that leave: whichever are fewer. The degrees make up the difference.
    counts_within: Vec<bool>,
}

impl Program {
    /// The program without links, ties, cuts or trees.
    pub(super) fn new(relaxation: &Relaxation) -> Self {
        let model = relaxation.model;
        let mut simplex = RowProblem::default().optimise(Sense::Minimise);
        simplex.make_quiet();
        simplex.set_option("threads", 1);
        simplex.set_option("parallel", "off");
        simplex.set_option("presolve", "off");
        simplex.set_option("solver", "simplex");
        let mut equal = |right: f64| add_row(&mut simplex, right..=right, Vec::new());
        let nodes: Vec<Line> = model
            .bodies
            .iter()
            .flat_map(|body| (body.first..body.last).map(|_| degree(body)))
            .map(&mut equal)
            .collect();
        let loops: Vec<Option<Line>> =
            model.bodies.iter().map(|body| body.is_split().then(|| equal(1.0))).collect();
        let sides = [equal(1.0), equal(1.0)];
        let families = Families::new(relaxation);
        let family_lines = families.links.iter().map(|links| Some(equal(f64::from((*links)?)))).collect();
        let count = relaxation.directions.as_ref().map_or(0, |directions| directions.count());
        let runs: Vec<[Line; 2]> = (0..count).map(|_| [equal(1.0), equal(1.0)]).collect();
        let mut entries = vec![None; model.terminals.len()];
        for (body, line) in model.bodies.iter().zip(loops).filter_map(|(body, line)| Some((body, line?))) {
            for t in body.first as usize..body.last as usize {
                entries[t] = Some(simplex.add_col(0.0, 0.0.., [nodes[t].times(-2.0), line.times(1.0)]));
            }
        }
        let mut ends = [Vec::new(), Vec::new()];
        for (side, walk_ends) in relaxation.walk_ends.iter().enumerate() {
            for end in walk_ends {
                let run = relaxation.run_of(end).map(|run| runs[run][side]);
                let lines = [nodes[end.terminal as usize], sides[side]].into_iter().chain(run);
                ends[side].push(simplex.add_col(to_mm(end.cost), 0.0.., lines.map(|line| line.times(1.0))));
            }
        }
        Self {
            simplex: Some(simplex),
            links: Default::default(),
            ends,
            entries,
            nodes,
            families,
            family_lines,
            runs,
            ties: Vec::new(),
            line_of_tie: FxHashMap::default(),
            cuts: Vec::new(),
            trees: Vec::new(),
            passages: Vec::new(),
            counts_within: Vec::new(),
        }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> i64 {
        self.simplex.as_ref().map_or(0, |simplex| simplex.num_rows() as i64)
    }

    /// Solves the program with what is known by now; `None` if the solver fails.
    pub(super) fn solve(&mut self, relaxation: &Relaxation, rows: &Rows) -> Option<Solution> {
        let mut simplex = self.simplex.take()?;
        self.add_links(&mut simplex, relaxation, rows);
        self.add_ties(&mut simplex, relaxation, rows);
        for cut in self.cuts.len()..relaxation.cuts.members.len() {
            self.add_cut(&mut simplex, relaxation, cut);
        }
        self.add_trees(&mut simplex, relaxation, rows);
        self.add_passages(&mut simplex, relaxation);
        let solved =
            simplex.try_solve().ok().filter(|solved| solved.status() == HighsModelStatus::Optimal)?;
        let (value, iterations) = (solved.objective_value(), solved.simplex_iteration_count());
        let found = solved.get_solution();
        self.simplex = Some(solved.into());
        let share = |col: Col| found[col].max(0.0);
        let [costs, prices] = [found.dual_columns(), found.dual_rows()];
        let price = |line: Line| -to_fine(prices[line.number]).round() as i64;
        let links = self.links.each_ref();
        Some(Solution {
            value: to_fine(value),
            links: links
                .map(|links| links.iter().map(|cols| cols.iter().map(|&col| share(col)).sum()).collect()),
            excess: links.map(|links| {
                let excess =
                    |cols: &Vec<Col>| cols.iter().map(|col| costs[col.index()]).fold(f64::MAX, f64::min);
                links.iter().map(|cols| to_fine(excess(cols))).collect()
            }),
            ends: self.ends.each_ref().map(|cols| cols.iter().map(|&col| share(col)).collect()),
            arcs: self.arcs(relaxation).map(|(tail, head, col)| (tail, head, share(col))).collect(),
            entered: self.entries.iter().map(|col| col.map_or(1.0, share)).collect(),
            multipliers: self.multipliers(relaxation, rows, price),
            trees: self.trees.iter().map(|&line| price(line).max(0)).collect(),
            families: self.family_lines.iter().map(|line| line.map_or(0, price)).collect(),
            iterations,
        })
    }

    fn multipliers(&self, relaxation: &Relaxation, rows: &Rows, price: impl Fn(Line) -> i64) -> Multipliers {
        let mut multipliers = relaxation.zero();
        multipliers.nodes.iter_mut().zip(&self.nodes).for_each(|(node, &line)| *node = price(line));
        for (cut, &line) in self.cuts.iter().enumerate() {
            multipliers.cuts[cut] = price(line).max(0);
            if self.counts_within[cut] {
                let members = &relaxation.cuts.members[cut];
                members.iter().for_each(|&t| multipliers.nodes[t as usize] += multipliers.cuts[cut]);
            }
        }
        let ties = rows.ties.iter().zip(&self.ties);
        ties.for_each(|(&(tie, _), &line)| multipliers.ties[tie as usize] = price(line).max(0));
        let passages = multipliers.passages.iter_mut().zip(&self.passages);
        passages.for_each(|(passage, &line)| *passage = price(line).max(0));
        multipliers.runs.iter_mut().zip(&self.runs).for_each(|(run, lines)| *run = lines.map(&price));
        multipliers
    }

    fn add_links(&mut self, simplex: &mut Simplex, relaxation: &Relaxation, rows: &Rows) {
        for (depth, links) in relaxation.links.iter().enumerate() {
            for link in &links[self.links[depth].len()..] {
                let factors = self.factors(relaxation, rows, depth, link);
                let mut add = |more: &[(Row, f64)]| {
                    simplex.add_col(to_mm(link.cost), 0.0.., factors.iter().chain(more).copied())
                };
                let cols = match relaxation.directions.as_ref().filter(|_| depth <= RUNS) {
                    None => vec![add(&[])],
                    Some(_) => ways(relaxation, link)
                        .map(|(tail, head)| {
                            let [leaves, enters] = [self.runs[tail as usize][1], self.runs[head as usize][0]];
                            let passages = relaxation.passages.iter().zip(&self.passages);
                            let passages = passages.filter(|(passage, _)| passage.holds(tail, head));
                            let passages = passages.map(|(_, line)| line.times(-1.0));
                            let lines = [leaves.times(1.0), enters.times(1.0)].into_iter().chain(passages);
                            add(&lines.collect::<Vec<_>>())
                        })
                        .collect(),
                };
                self.links[depth].push(cols);
            }
        }
    }

    /// What a link counts in the rows that there are, but for directions.
    fn factors(&self, relaxation: &Relaxation, rows: &Rows, depth: usize, link: &Link) -> Vec<(Row, f64)> {
        let [i, j] = link.items(relaxation.model);
        let family = self.family_lines[self.families.of[depth][i as usize] as usize];
        let ties = link.ties.iter().filter_map(|tie| self.line_of_tie.get(tie)).copied();
        let trees = rows.trees.iter().zip(&self.trees).filter(|(set, _)| set[i as usize] && set[j as usize]);
        let once = [link.a, link.b].map(|t| self.nodes[t as usize]).into_iter().chain(family).chain(ties);
        let once = once.chain(trees.map(|(_, &line)| line)).map(|line| line.times(1.0));
        let of = |t: u32| {
            let cuts = &relaxation.cuts.of[t as usize];
            &cuts[..cuts.partition_point(|&cut| (cut as usize) < self.cuts.len())]
        };
        let [one, other] = [of(link.a), of(link.b)];
        let within =
            one.iter().filter(|cut| self.counts_within[**cut as usize] && other.binary_search(cut).is_ok());
        let leaves = |own: &[u32], others: &[u32]| -> Vec<u32> {
            let leaves = |cut: &u32| !self.counts_within[*cut as usize] && others.binary_search(cut).is_err();
            own.iter().copied().filter(leaves).collect()
        };
        let leaving = [leaves(one, other), leaves(other, one)].concat();
        let line = |cut: u32, factor: f64| self.cuts[cut as usize].times(factor);
        let cuts = within.map(|&cut| line(cut, 2.0)).chain(leaving.into_iter().map(|cut| line(cut, -1.0)));
        once.chain(cuts).collect()
    }

    fn add_ties(&mut self, simplex: &mut Simplex, relaxation: &Relaxation, rows: &Rows) {
        let fresh = &rows.ties[self.ties.len()..];
        if fresh.is_empty() {
            return;
        }
        let entry = |terminal: u32| self.entries[terminal as usize].map(|col| (col, -1.0));
        let entries = fresh.iter().map(|&(tie, terminal)| (tie, entry(terminal).into_iter().collect()));
        let mut factors: FxHashMap<u32, Vec<(Col, f64)>> = entries.collect();
        for (link, cols) in self.all_links(relaxation) {
            for tie in link.ties {
                if let Some(factors) = factors.get_mut(&tie) {
                    factors.extend(cols.iter().map(|&col| (col, 1.0)));
                }
            }
        }
        for (end, &col) in relaxation.walk_ends.iter().flatten().zip(self.ends.iter().flatten()) {
            if let Some(factors) = factors.get_mut(&end.tie) {
                factors.push((col, 1.0));
            }
        }
        for &(tie, _) in fresh {
            let line = add_row(simplex, ..=0.0, factors.remove(&tie).unwrap_or_default());
            self.ties.push(line);
            self.line_of_tie.insert(tie, line);
        }
    }

    fn add_trees(&mut self, simplex: &mut Simplex, relaxation: &Relaxation, rows: &Rows) {
        for set in &rows.trees[self.trees.len()..] {
            let within = self
                .all_links(relaxation)
                .filter(|(link, _)| link.items(relaxation.model).iter().all(|&item| set[item as usize]));
            let factors = within.flat_map(|(_, cols)| cols.iter().map(|&col| (col, 1.0))).collect();
            let paths = set.iter().filter(|&&is_in| is_in).count();
            let line = add_row(simplex, ..=paths as f64 - 1.0, factors);
            self.trees.push(line);
        }
    }

    /// Columns of links between runs, with the runs that they lead from and to.
    fn arcs<'a>(&'a self, relaxation: &'a Relaxation) -> impl Iterator<Item = (u32, u32, Col)> {
        let depths = if relaxation.directions.is_some() { RUNS + 1 } else { 0 };
        let links = relaxation.links[..depths].iter().zip(&self.links);
        let links = links.flat_map(|(links, cols)| links.iter().zip(cols));
        links
            .flat_map(|(link, cols)| ways(relaxation, link).zip(cols))
            .map(|((tail, head), &col)| (tail, head, col))
    }

    fn add_passages(&mut self, simplex: &mut Simplex, relaxation: &Relaxation) {
        for passage in &relaxation.passages[self.passages.len()..] {
            let links = self.arcs(relaxation).filter(|&(tail, head, _)| passage.holds(tail, head));
            let runs = self.runs.len();
            let ends = relaxation.walk_ends.iter().zip(&self.ends).enumerate();
            let ends = ends.flat_map(|(side, (ends, cols))| {
                let holds = move |run: usize| match side {
                    0 => passage.holds(runs as u32, run as u32),
                    _ => passage.holds(run as u32, runs as u32 + 1),
                };
                let ends = ends.iter().zip(cols);
                ends.filter(move |(end, _)| relaxation.run_of(end).is_some_and(holds)).map(|(_, &col)| col)
            });
            let cols = links.map(|(.., col)| col).chain(ends);
            let line = add_row(simplex, ..=-1.0, cols.map(|col| (col, -1.0)).collect());
            self.passages.push(line);
        }
    }

    fn add_cut(&mut self, simplex: &mut Simplex, relaxation: &Relaxation, cut: usize) {
        let (model, cuts) = (relaxation.model, &relaxation.cuts);
        let start = model.terminals.len();
        let members = &cuts.members[cut];
        let mut is_in = vec![false; start + 1];
        members.iter().for_each(|&t| is_in[t as usize] = true);
        let within = !is_in[start] && 2 * members.len() <= start;
        let body = |t: u32| &model.bodies[model.terminals[t as usize].item as usize];
        let least = f64::from(cuts.least[cut]);
        let guard = cuts.guard[cut].filter(|&item| model.bodies[item as usize].is_split());
        let mut right = if guard.is_some() { 0.0 } else { -least };
        let mut factors = Vec::new();
        for &t in members.iter().filter(|&&t| (t as usize) < start) {
            let guards = guard.is_some_and(|item| model.terminals[t as usize].item == item);
            let own = if guards { least } else { 0.0 } - if within { 2.0 } else { 0.0 };
            factors.extend(self.entries[t as usize].filter(|_| own != 0.0).map(|col| (col, own)));
            right += if within { degree(body(t)) } else { 0.0 };
        }
        for (link, cols) in self.all_links(relaxation) {
            let factor = match (within, [link.a, link.b].map(|t| is_in[t as usize])) {
                (true, [true, true]) => 2.0,
                (false, [one, other]) if one != other => -1.0,
                _ => continue,
            };
            factors.extend(cols.iter().map(|&col| (col, factor)));
        }
        if !within {
            for (side, walk_ends) in relaxation.walk_ends.iter().enumerate() {
                let beyond = side == 0 && is_in[start];
                let leaving = walk_ends
                    .iter()
                    .zip(&self.ends[side])
                    .filter(|(end, _)| is_in[end.terminal as usize] != beyond);
                factors.extend(leaving.map(|(_, &col)| (col, -1.0)));
            }
        }
        let line = add_row(simplex, ..=right, factors);
        self.cuts.push(line);
        self.counts_within.push(within);
    }

    /// The links that have columns.
    fn all_links<'a>(&'a self, relaxation: &'a Relaxation) -> impl Iterator<Item = (&'a Link, &'a Vec<Col>)> {
        relaxation.links.iter().zip(&self.links).flat_map(|(links, cols)| links.iter().zip(cols))
    }
}

/// The runs that a link between two may lead from and to.
fn ways<'a>(relaxation: &'a Relaxation, link: &Link) -> impl Iterator<Item = (u32, u32)> + use<'a> {
    let [i, j] = link.items(relaxation.model);
    let ways = [(i, j), (j, i)].into_iter().filter(|&(from, to)| relaxation.model.leads(from, to));
    let run = |item: u32| relaxation.directions.as_ref().map_or(0, |runs| runs.run_of[item as usize]);
    ways.map(move |(from, to)| (run(from), run(to)))
}

/// Links at each terminal of a path, if that does not depend on where it is entered.
fn degree(body: &Body) -> f64 {
    match (body.closed, body.is_split()) {
        (false, _) => 1.0,
        (true, false) => 2.0,
        (true, true) => 0.0,
    }
}

/// Millimetres to fine units.
fn to_fine(mm: f64) -> f64 {
    mm / to_mm(1)
}
