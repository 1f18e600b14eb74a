//! A G-code file in another order: read, ordered, written and compared in batches of blocks.

use std::io::{self, BufRead, Read, Seek, SeekFrom};
use std::ops::Range;

use crate::check::FaultFinder;
use crate::estimate::Machine;
use crate::gcode::{Annotated, Input, State};
use crate::job::{CheckError, InputError, JobError, ReorderJob};
use crate::order::{Chain, Pins, SeamRule, chunk_len};
use crate::order::{OrderStrategy, Scope, SeamPosition};
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::profile::Settings;
use crate::reorder::{
    self, Block, Blocks, Inventory, Learner, LinkCost, Options, Ordering, Pick, Readback, RetractionStyle,
    Times, Walls, Written,
};
use crate::report::{PathMeasures, Reordered};
use crate::source::Source;
use crate::toolpath::LayerPaths;

use super::ordering::Sequencer;
use super::{inspect, ordering};

/// A batch holds at least this many bytes of the file: enough to keep all threads busy, whatever the file's size, and
/// blocks enough to be weighed against each other.
const BATCH_BYTES: usize = 8 << 20;
/// As many for the order that is found fastest, where reading and checking would wait for each other.
const NEAREST_BYTES: usize = 1 << 20;
/// Lines about time are looked for in this many bytes at either end of a file.
const TIME_BYTES: u64 = 1 << 16;
/// An improvement below this share of the travel is none.
const WORTHWHILE: f64 = 1e-4;

/// Puts a file into another order.
pub(super) fn reorder(
    source: Source<'_>,
    job: &ReorderJob,
    settings: &Settings,
    output: &mut Output,
    workers: Workers<'_>,
) -> Result<Reordered, JobError> {
    let mut rewriter = Rewriter {
        more_retractions: job.more_retractions,
        ..Rewriter::new(settings, job.keep_direction, true, workers)
    };
    let begun = source.stamp().map_err(|error| source.error(error))?;
    let machine = has_times(source)?.then(|| Machine::new(settings));
    let input = Blocks::new(open(source)?).proven(machine.as_ref());
    let mut finder = FaultFinder::of_paths(settings, true);
    let mut readback = Readback::timed(machine.as_ref());
    let mut check = |read: &mut Annotated<'_>, state: &State| finder.check_line(read, state);
    let back = |text: Box<dyn BufRead + Send + '_>| readback.read(text, &mut check);
    let mut before = rewriter.rewrite(source, input, back, output)?.unwrap_or_default();
    let mut after = readback.finish();
    let times = before.take_times().zip(after.take_times());
    let mut report = Reordered { file: source.to_string(), ..Reordered::default() };
    if rewriter.improved() {
        let proof = before
            .compare(after)
            .map_err(|difference| CheckError::Differs { file: source.to_string(), difference })?;
        let fewer = job.more_retractions || proof.after.retractions <= proof.before.retractions;
        if fewer && proof.after.travel_mm <= proof.before.travel_mm {
            (report.before, report.after) =
                (PathMeasures::from(&proof.before), PathMeasures::from(&proof.after));
            (report.layers, report.changed) = (proof.layers, true);
            update_times(&rewriter.times, times, output)?;
            inspect::remade(source, &finder.finish(), settings)?;
        }
    }
    if source.stamp().map_err(|error| source.error(error))? != begun {
        let error = io::Error::other("it was changed while it was read; nothing was written");
        return Err(source.error(error));
    }
    Ok(report)
}

/// Whether a file has lines about time near its beginning or its end, as all slicers write them that write any.
fn has_times(source: Source<'_>) -> Result<bool, JobError> {
    let mut input = open(source)?;
    let failed = |error: io::Error| source.error(error);
    let length = input.seek(SeekFrom::End(0)).map_err(failed)?;
    let mut tells = false;
    for offset in [0, length.saturating_sub(TIME_BYTES)] {
        let mut text = Vec::new();
        input.seek(SeekFrom::Start(offset)).map_err(failed)?;
        input.by_ref().take(TIME_BYTES).read_to_end(&mut text).map_err(failed)?;
        tells |= reorder::has_times(&text);
    }
    Ok(tells)
}

/// A line about time in the output.
struct TimeLine {
    /// Where it begins.
    offset: u64,
    /// Its number in the file, among its kind.
    number: usize,
    text: Vec<u8>,
}

/// Brings lines about time up to date. Without `times`, of the file and of the output, nothing is said.
fn update_times(
    lines: &[TimeLine],
    times: Option<(Times, Times)>,
    output: &mut Output,
) -> Result<(), JobError> {
    for (index, TimeLine { offset, number, text }) in lines.iter().enumerate() {
        let length = text.trim_ascii_end().len() + reorder::TIME_PADDING.len();
        let updated = times.as_ref().and_then(|(old, new)| old.updated(text, *number, new, index));
        let mut updated = updated.filter(|updated| updated.len() <= length).unwrap_or_else(|| b";".to_vec());
        updated.resize(length, b' ');
        output.patch(*offset, &updated)?;
    }
    Ok(())
}

/// The layers of a file as they are ordered, and the links within each that are not open to ordering, mm.
pub(super) fn layers(
    source: Source<'_>,
    settings: &Settings,
) -> Result<(Vec<LayerPaths>, Vec<f64>), JobError> {
    let mut blocks = Blocks::new(open(source)?);
    let (mut layers, mut fixed_mm) = (Vec::new(), Vec::new());
    let (seam, scope) = (settings.seam.position, settings.order.scope);
    while let Some(block) = blocks.read().map_err(|error| source.error(error))? {
        if block.paths() > 0 {
            let ordering = Ordering::new(&block, layers.len(), seam, scope);
            layers.push(ordering.layer);
            fixed_mm.push(ordering.fixed_mm);
        }
    }
    if layers.is_empty() {
        return Err(InputError::NoPaths { file: source.to_string() }.into());
    }
    Ok((layers, fixed_mm))
}

/// A seam rule for the paths of finished files: there, walls that keep their seams are known by their roles.
pub(super) fn seam_rule(position: SeamPosition) -> SeamRule {
    SeamRule::new(if position == SeamPosition::Pinned { SeamPosition::Free } else { position })
}

/// Writes a file in the order of the settings, without the proof, even if it is no improvement.
pub(super) fn rewritten(
    source: Source<'_>,
    settings: &Settings,
    output: &mut Output,
    workers: Workers<'_>,
) -> Result<(), JobError> {
    let blocks = Blocks::new(open(source)?);
    Rewriter::new(settings, false, false, workers).rewrite(source, blocks, |_| Ok(()), output).map(drop)
}

fn open(source: Source<'_>) -> Result<Box<dyn Input + '_>, JobError> {
    source.open().map_err(|error| source.error(error))
}

/// Batches of blocks of a file.
struct Batches<R> {
    blocks: Blocks<R>,
    carry: Option<Block>,
    /// A batch holds at least this many bytes.
    least: usize,
}

impl<R: BufRead> Batches<R> {
    /// The next batch; an empty one at the end. The blocks of one layer stay together.
    fn read(&mut self) -> io::Result<Vec<Block>> {
        let mut batch: Vec<Block> = self.carry.take().into_iter().collect();
        let mut bytes = batch.iter().map(Block::bytes).sum::<usize>();
        while let Some(block) = self.blocks.read()? {
            if bytes >= self.least && batch.last().is_some_and(|last| last.layer() != block.layer()) {
                self.carry = Some(block);
                break;
            }
            bytes += block.bytes();
            batch.push(block);
        }
        Ok(batch)
    }
}

/// The state of rewriting a file that passes from batch to batch.
struct Rewriter<'a> {
    workers: Workers<'a>,
    chain: Chain,
    seam: SeamRule,
    position: SeamPosition,
    keep_direction: bool,
    /// Whether blocks keep their old order where the new one is not worth it.
    choosy: bool,
    /// Whether retractions may grow in number where that saves more than they cost.
    more_retractions: bool,
    learner: Learner,
    /// What it has learned.
    style: Option<RetractionStyle>,
    /// What a retraction is worth, mm of travel.
    retraction_mm: f64,
    /// Where the nozzle is, if not where the file has it.
    at: Option<[i64; 2]>,
    /// Whether the file marks its layers.
    marked: bool,
    /// Whether there was a path.
    begun: bool,
    blocks: usize,
    /// Lines about time in the output.
    times: Vec<TimeLine>,
    before: LinkCost,
    after: LinkCost,
}

impl<'a> Rewriter<'a> {
    fn new(settings: &Settings, keep_direction: bool, choosy: bool, workers: Workers<'a>) -> Self {
        Self {
            workers,
            chain: ordering::chain(settings),
            seam: seam_rule(settings.seam.position),
            position: settings.seam.position,
            keep_direction,
            choosy,
            more_retractions: false,
            learner: Learner::default(),
            style: None,
            retraction_mm: 0.0,
            at: None,
            marked: false,
            begun: false,
            blocks: 0,
            times: Vec::new(),
            before: LinkCost::default(),
            after: LinkCost::default(),
        }
    }

    /// Retractions that the file may have.
    fn max_retractions(&self) -> usize {
        if self.more_retractions { usize::MAX } else { self.before.retractions }
    }

    /// Whether what was written is worth anything.
    fn improved(&self) -> bool {
        let score = |cost: LinkCost| cost.score(self.retraction_mm);
        let limit = LinkCost { retractions: self.max_retractions(), ..self.before };
        self.after.within(limit) && score(self.after) < score(self.before) * (1.0 - WORTHWHILE)
    }

    /// Batch by batch: while one is ordered and written, the next is read, and the one before is given `back` to be
    /// compared and checked. What the file prints, where that is to be proven.
    fn rewrite(
        &mut self,
        source: Source<'_>,
        blocks: Blocks<impl BufRead + Send>,
        mut back: impl FnMut(Box<dyn BufRead + Send + '_>) -> io::Result<()> + Send,
        output: &mut Output,
    ) -> Result<Option<Inventory>, JobError> {
        let failed = |error: io::Error| source.error(error);
        let mut batches = Batches { blocks, carry: None, least: self.batch_bytes() };
        let mut batch = batches.read().map_err(failed)?;
        let mut checked = output.written();
        while !batch.is_empty() {
            let end = output.written();
            let text = output.reread(checked)?;
            let read_back = || back(text);
            // What cannot be divided begins first; ordering takes whatever thread is free.
            let ((read_back, written), next) =
                parallel::join(|| parallel::join(read_back, || self.batch(&batch)), || batches.read());
            read_back.map_err(failed)?;
            checked = end;
            for written in written {
                let begin = output.written();
                self.times.extend(written.times.iter().map(|&(at, number)| {
                    let text = written.bytes[at..].split_inclusive(|&byte| byte == b'\n').next();
                    TimeLine { offset: begin + at as u64, number, text: text.unwrap_or_default().to_vec() }
                }));
                output.write(&written.bytes)?;
                self.workers.observer.layer_done();
            }
            batch = next.map_err(failed)?;
        }
        back(output.reread(checked)?).map_err(failed)?;
        Ok(batches.blocks.finish())
    }

    /// Orders and writes some blocks.
    fn batch(&mut self, blocks: &[Block]) -> Vec<Written> {
        if blocks.iter().filter(|block| self.learner.learn(block)).count() > 0 {
            self.style = self.learner.style();
        }
        let style = self.style.clone();
        // What comes before the first mark is no layer of the print.
        self.marked |= blocks.iter().any(Block::marked);
        let (marked, seam) = (self.marked, self.seam.clone());
        let stays = |block: &Block| style.is_none() || marked && !block.marked();
        let old = |block: &Block| (0..block.paths()).map(Pick::as_is).collect::<Vec<_>>();
        let mut orders: Vec<Vec<Vec<Pick>>> = vec![blocks.iter().map(old).collect()];
        for &scope in self.scopes() {
            self.seam = seam.clone();
            let mut picks = self.order(blocks, scope);
            for (i, block) in blocks.iter().enumerate().filter(|(_, block)| stays(block)) {
                picks[i] = old(block);
            }
            orders.push(picks);
        }
        let style = style.unwrap_or_default();
        self.retraction_mm = style.retraction_mm();
        let start = self.at.unwrap_or(blocks[0].start());
        let workers = self.workers;
        let walls = walls(blocks, workers);
        let silent = match self.begun {
            true => 0,
            false => blocks.iter().position(|block| block.paths() > 0).map_or(blocks.len(), |i| i + 1),
        };
        self.begun |= silent < blocks.len();
        let batch = Batch { workers, blocks, orders, style, walls, start, silent };
        for (i, block) in blocks.iter().enumerate() {
            let [junction, inside] = block.costs();
            self.before += batch.counted(i, junction) + inside;
        }
        let (chosen, written) = if self.choosy {
            let limit = LinkCost {
                travel_mm: self.before.travel_mm - self.after.travel_mm,
                retractions: self.max_retractions().saturating_sub(self.after.retractions),
            };
            batch.best(limit, self.retraction_mm)
        } else {
            (vec![1; blocks.len()], workers.map(blocks.len(), |i| batch.write(1, 1, i)))
        };
        for (i, written) in written.iter().enumerate() {
            self.after += batch.counted(i, written.junction) + written.inside;
        }
        self.at = Some(batch.end(chosen[blocks.len() - 1], blocks.len()));
        self.blocks += blocks.len();
        written
    }

    /// The scopes in which orders are looked for, first the one that is requested. What finishes one island before the
    /// next is begun is allowed in every scope, and retracts less often.
    fn scopes(&self) -> &'static [Scope] {
        let settings = &self.chain.settings;
        match settings.scope {
            Scope::Layer if self.searches() => &[Scope::Layer, Scope::Island],
            Scope::Feature if self.searches() => &[Scope::Feature, Scope::Island],
            Scope::Layer => &[Scope::Layer],
            Scope::Feature => &[Scope::Feature],
            Scope::Island => &[Scope::Island],
        }
    }

    /// Whether time is spent on the best among several orders.
    fn searches(&self) -> bool {
        self.choosy && self.chain.settings.strategy == OrderStrategy::Optimized
    }

    fn batch_bytes(&self) -> usize {
        let near = self.choosy && self.chain.settings.strategy == OrderStrategy::Nearest;
        if near { NEAREST_BYTES } else { BATCH_BYTES }
    }

    /// The order of the paths of every block.
    fn order(&mut self, blocks: &[Block], scope: Scope) -> Vec<Vec<Pick>> {
        let workers = self.workers;
        let orderings: Vec<Ordering> =
            workers.map(blocks.len(), |i| Ordering::new(&blocks[i], self.blocks + i, self.position, scope));
        // Blocks without paths are passed over.
        let with_paths: Vec<usize> = (0..blocks.len()).filter(|&i| blocks[i].paths() > 0).collect();
        let layers: Vec<LayerPaths> = with_paths.iter().map(|&i| orderings[i].layer.clone()).collect();
        let pins: Vec<Pins> = layers.iter().map(|layer| self.seam.pins(layer)).collect();
        let start = self.at.zip(blocks.first()).map(|(at, block)| block.point(at));
        let mut chain = self.chain.clone();
        chain.settings.scope = scope;
        let sequences = Sequencer::new(&chain, workers, chunk_len(layers.len()), start)
            .take(layers, pins, true)
            .sequences;
        let mut picks = vec![Vec::new(); blocks.len()];
        for (&i, sequence) in with_paths.iter().zip(&sequences) {
            picks[i] = orderings[i].picks(&blocks[i], sequence);
        }
        if self.keep_direction {
            let forwards = |i: usize| reorder::forwards(&blocks[i], &orderings[i], scope, &picks[i]);
            picks = workers.map(blocks.len(), forwards);
        }
        picks
    }
}

/// Some blocks, and what it takes to write them.
struct Batch<'a> {
    workers: Workers<'a>,
    blocks: &'a [Block],
    /// The paths of every block in several orders, the first being that of the file.
    orders: Vec<Vec<Vec<Pick>>>,
    style: RetractionStyle,
    /// The walls of each layer, with the blocks that make it up.
    walls: Vec<(Range<usize>, Walls)>,
    /// Where the nozzle is before the first block.
    start: [i64; 2],
    /// This many blocks at the beginning come before the first bead: the move to them is no travel.
    silent: usize,
}

impl Batch<'_> {
    /// The best choice of orders within a limit, and the text of every block.
    fn best(&self, limit: LinkCost, retraction_mm: f64) -> (Vec<usize>, Vec<Written>) {
        let (workers, count, orders) = (self.workers, self.blocks.len(), self.orders.len());
        let mut written: Vec<Vec<Written>> =
            (1..orders).map(|order| workers.map(count, |i| self.write(order, order, i))).collect();
        let options = workers.map(count, |i| self.options(&written, i));
        let chosen = reorder::choose(&options, limit, retraction_mm).unwrap_or_else(|| vec![0; count]);
        // A block's text depends on where the one before ends.
        let before = |i: usize| i.checked_sub(1).map_or(0, |before| chosen[before]);
        let again = |i: &usize| chosen[*i] == 0 || *i > 0 && before(*i) != chosen[*i];
        let again: Vec<usize> = (0..count).filter(again).collect();
        let texts = workers.map(again.len(), |k| self.write(before(again[k]), chosen[again[k]], again[k]));
        let mut texts = texts.into_iter();
        let mut again = again.into_iter().peekable();
        let best = |i: usize| match again.next_if_eq(&i) {
            Some(_) => texts.next().unwrap_or_default(),
            None => std::mem::take(&mut written[chosen[i] - 1][i]),
        };
        let best = (0..count).map(best).collect();
        (chosen, best)
    }

    /// A block's text in an order, the block before being drawn in the order `before`.
    fn write(&self, before: usize, order: usize, i: usize) -> Written {
        let from = self.end(before, i);
        reorder::write(&self.blocks[i], &self.orders[order][i], from, &self.style, self.walls(i))
    }

    /// The costs of a block in each order; `written`: all blocks in each of the new orders.
    fn options(&self, written: &[Vec<Written>], i: usize) -> Options {
        let junction = |before: usize, order: usize| {
            let (from, picks) = (self.end(before, i), &self.orders[order][i]);
            reorder::junction(&self.blocks[i], picks, from, &self.style, self.walls(i))
        };
        let row = |before: usize| {
            let to = |order: usize| match order == before && order > 0 {
                true => self.counted(i, written[order - 1][i].junction),
                false => self.counted(i, junction(before, order)),
            };
            (0..self.orders.len()).map(to).collect()
        };
        let befores = if i == 0 { 1 } else { self.orders.len() };
        let new = written.iter().map(|written| written[i].inside);
        Options {
            inside: std::iter::once(self.blocks[i].costs()[1]).chain(new).collect(),
            junction: (0..befores).map(row).collect(),
        }
    }

    /// What the travel to a block counts.
    fn counted(&self, i: usize, junction: LinkCost) -> LinkCost {
        if i < self.silent { LinkCost::default() } else { junction }
    }

    /// Where the nozzle is before a block, if the one before is drawn in this order.
    fn end(&self, order: usize, i: usize) -> [i64; 2] {
        let before = i.checked_sub(1);
        before.map_or(self.start, |i| reorder::end(&self.blocks[i], &self.orders[order][i]))
    }

    fn walls(&self, i: usize) -> &Walls {
        let layer = self.walls.partition_point(|(range, _)| range.end <= i);
        &self.walls[layer].1
    }
}

/// The walls of every layer, with the blocks that make it up.
fn walls(blocks: &[Block], workers: Workers<'_>) -> Vec<(Range<usize>, Walls)> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        match ranges.last_mut() {
            Some(range) if blocks[range.start].layer() == block.layer() => range.end = index + 1,
            _ => ranges.push(index..index + 1),
        }
    }
    let walls = workers.map(ranges.len(), |i| Walls::new(blocks[ranges[i].clone()].iter()));
    ranges.into_iter().zip(walls).collect()
}
