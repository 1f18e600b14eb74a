//! A G-code file in another order: read, ordered, written and compared in batches of blocks.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::ops::Range;
use std::path::Path;

use crate::job::{JobError, Progress, ReorderJob};
use crate::order::{Chain, Pins, SeamRule, chunk_len};
use crate::output::Output;
use crate::profile::{SeamPosition, Settings};
use crate::reorder::{self, Block, Blocks, Habit, Learner, Options, Ordering, Pick, Toll, Walls, Written};
use crate::report::{Reordered, Way};
use crate::toolpath::LayerPaths;

use super::{ordering, parallel};

/// A batch holds at least so many bytes of the file: enough to keep all threads busy, whatever the file's size.
const BATCH_BYTES: usize = 8 << 20;
/// Size of the buffer in front of the file.
const BUFFER_BYTES: usize = 1 << 18;
/// An improvement below this share of the travel is none.
const WORTHWHILE: f64 = 1e-4;

/// Puts a file into another order.
pub(super) fn reorder(
    job: &ReorderJob,
    settings: &Settings,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<Reordered, JobError> {
    let mut run = Run::new(settings, job.keep_direction, true);
    run.rewrite(&job.file, open(&job.file)?, output, progress)?;
    let mut report = Reordered { file: job.file.display().to_string(), ..Reordered::default() };
    if run.improved() {
        let proof = reorder::verify(open(&job.file)?, output.reread()?, parallel::both)
            .map_err(|error| input_error(&job.file, &error))?
            .map_err(|difference| {
                JobError::Check(format!("{}: {difference}; nothing was written", job.file.display()))
            })?;
        (report.before, report.after) = (Way::from(&proof.before), Way::from(&proof.after));
        (report.layers, report.changed) = (proof.layers, true);
    }
    Ok(report)
}

/// The layers of a file as they are ordered, and the links within each that are not open to ordering, mm.
pub(super) fn layers(path: &Path, settings: &Settings) -> Result<(Vec<LayerPaths>, Vec<f64>), JobError> {
    let mut blocks = Blocks::new(open(path)?);
    let (mut layers, mut fixed_mm) = (Vec::new(), Vec::new());
    let (seam, scope) = (settings.seam.position, settings.order.scope);
    while let Some(block) = blocks.read().map_err(|error| input_error(path, &error))? {
        if block.paths() > 0 {
            let ordering = Ordering::new(&block, layers.len(), seam, scope);
            layers.push(ordering.layer);
            fixed_mm.push(ordering.fixed_mm);
        }
    }
    if layers.is_empty() {
        return Err(JobError::Input(format!("{}: nothing is printed in it", path.display())));
    }
    Ok((layers, fixed_mm))
}

/// A seam rule for the paths of finished files: there, walls that keep their seams are known by their roles.
pub(super) fn seam_rule(position: SeamPosition) -> SeamRule {
    SeamRule::new(if position == SeamPosition::Pinned { SeamPosition::Free } else { position })
}

/// Writes a file in the order that the settings ask for, whether or not that is any better.
pub(super) fn rewritten(
    path: &Path,
    input: impl BufRead + Send,
    settings: &Settings,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<(), JobError> {
    Run::new(settings, false, false).rewrite(path, input, output, progress)
}

pub(super) fn open(path: &Path) -> Result<BufReader<File>, JobError> {
    let file = File::open(path).map_err(|error| input_error(path, &error))?;
    Ok(BufReader::with_capacity(BUFFER_BYTES, file))
}

pub(super) fn input_error(path: &Path, error: &io::Error) -> JobError {
    JobError::Input(format!("{}: {error}", path.display()))
}

/// Batches of blocks of a file.
struct Batches<R> {
    blocks: Blocks<R>,
    carry: Option<Block>,
}

impl<R: BufRead> Batches<R> {
    /// The next batch; an empty one at the end. The blocks of one layer stay together.
    fn read(&mut self) -> io::Result<Vec<Block>> {
        let mut batch: Vec<Block> = self.carry.take().into_iter().collect();
        let mut bytes = batch.iter().map(Block::bytes).sum::<usize>();
        while let Some(block) = self.blocks.read()? {
            if bytes >= BATCH_BYTES && batch.last().is_some_and(|last| last.layer() != block.layer()) {
                self.carry = Some(block);
                break;
            }
            bytes += block.bytes();
            batch.push(block);
        }
        Ok(batch)
    }
}

/// What goes on from batch to batch.
struct Run {
    chain: Chain,
    seam: SeamRule,
    position: SeamPosition,
    keep_direction: bool,
    /// Whether blocks keep their old order where the new one is not worth it.
    choosy: bool,
    learner: Learner,
    /// What a retraction is worth, mm of travel.
    retraction_mm: f64,
    /// Where the nozzle is, if not where the file has it.
    at: Option<[i64; 2]>,
    /// Whether the file marks its layers.
    marked: bool,
    blocks: usize,
    before: Toll,
    after: Toll,
}

impl Run {
    fn new(settings: &Settings, keep_direction: bool, choosy: bool) -> Self {
        Self {
            chain: ordering::chain(settings),
            seam: seam_rule(settings.seam.position),
            position: settings.seam.position,
            keep_direction,
            choosy,
            learner: Learner::default(),
            retraction_mm: 0.0,
            at: None,
            marked: false,
            blocks: 0,
            before: Toll::default(),
            after: Toll::default(),
        }
    }

    /// Whether what was written is worth anything: less travel or fewer retractions, and neither more than before.
    fn improved(&self) -> bool {
        let score = |toll: Toll| toll.score(self.retraction_mm);
        self.after.within(self.before) && score(self.after) < score(self.before) * (1.0 - WORTHWHILE)
    }

    /// Batch by batch; while one is ordered and written, the next is read.
    fn rewrite(
        &mut self,
        path: &Path,
        input: impl BufRead + Send,
        output: &mut Output,
        progress: &dyn Progress,
    ) -> Result<(), JobError> {
        let failed = |error: io::Error| input_error(path, &error);
        let mut batches = Batches { blocks: Blocks::new(input), carry: None };
        let mut batch = batches.read().map_err(failed)?;
        while !batch.is_empty() {
            let (written, next) = parallel::join(|| self.batch(&batch), || batches.read());
            for written in written {
                output.write(&written.bytes)?;
                progress.layer_done();
            }
            batch = next.map_err(failed)?;
        }
        Ok(())
    }

    /// Orders and writes some blocks.
    fn batch(&mut self, blocks: &[Block]) -> Vec<Written> {
        blocks.iter().for_each(|block| self.learner.learn(block));
        let habit = self.learner.habit();
        let old: Vec<Vec<Pick>> =
            blocks.iter().map(|block| (0..block.paths()).map(Pick::as_is).collect()).collect();
        let mut new = if habit.is_some() { self.order(blocks) } else { old.clone() };
        // What comes before the first mark is no layer of the print.
        self.marked |= blocks.iter().any(Block::marked);
        for ((block, new), old) in blocks.iter().zip(&mut new).zip(&old) {
            if self.marked && !block.marked() {
                new.clone_from(old);
            }
        }
        let habit = habit.unwrap_or_default();
        self.retraction_mm = habit.retraction_mm();
        let start = self.at.unwrap_or(blocks[0].start());
        let batch = Batch { blocks, habit, walls: walls(blocks), start };
        let mut written = parallel::map(blocks.len(), |i| batch.write(&new, i));
        for block in blocks {
            let [junction, inside] = block.tolls();
            self.before += junction + inside;
        }
        if self.choosy {
            let options = parallel::map(blocks.len(), |i| batch.options(&old, &new, &written, i));
            let limit = Toll {
                travel_mm: self.before.travel_mm - self.after.travel_mm,
                pulls: self.before.pulls.saturating_sub(self.after.pulls),
            };
            let chosen = reorder::choose(&options, limit, self.retraction_mm);
            let chosen = chosen.unwrap_or_else(|| vec![false; blocks.len()]);
            let stays: Vec<bool> = (0..blocks.len()).map(|i| options[i].changed && !chosen[i]).collect();
            (0..blocks.len()).filter(|&i| stays[i]).for_each(|i| new[i].clone_from(&old[i]));
            // A block's text depends on where the one before ends.
            let again: Vec<usize> =
                (0..blocks.len()).filter(|&i| stays[i] || i > 0 && stays[i - 1]).collect();
            let texts = parallel::map(again.len(), |k| batch.write(&new, again[k]));
            again.into_iter().zip(texts).for_each(|(i, text)| written[i] = text);
        }
        written.iter().for_each(|written| self.after += written.junction + written.inside);
        self.at = blocks.last().zip(new.last()).map(|(block, picks)| reorder::end(block, picks));
        self.blocks += blocks.len();
        written
    }

    /// The order of the paths of every block.
    fn order(&mut self, blocks: &[Block]) -> Vec<Vec<Pick>> {
        let scope = self.chain.settings.scope;
        let orderings: Vec<Ordering> =
            parallel::map(blocks.len(), |i| Ordering::new(&blocks[i], self.blocks + i, self.position, scope));
        // Blocks without paths are passed over.
        let with_paths: Vec<usize> = (0..blocks.len()).filter(|&i| blocks[i].paths() > 0).collect();
        let layers: Vec<LayerPaths> = with_paths.iter().map(|&i| orderings[i].layer.clone()).collect();
        let pins: Vec<Pins> = layers.iter().map(|layer| self.seam.pins(layer)).collect();
        let start = self.at.zip(blocks.first()).map(|(at, block)| block.point(at));
        let sequences = match layers.is_empty() {
            true => Vec::new(),
            false => ordering::solve(&self.chain, &layers, &pins, chunk_len(layers.len()), start).sequences,
        };
        let mut picks = vec![Vec::new(); blocks.len()];
        for (&i, sequence) in with_paths.iter().zip(&sequences) {
            picks[i] = orderings[i].picks(&blocks[i], sequence);
        }
        if self.keep_direction {
            let forwards = |i: usize| reorder::forwards(&blocks[i], &orderings[i], scope, &picks[i]);
            picks = parallel::map(blocks.len(), forwards);
        }
        picks
    }
}

/// Some blocks, and what it takes to write them.
struct Batch<'a> {
    blocks: &'a [Block],
    habit: Habit,
    /// The walls of each layer, with the blocks that make it up.
    walls: Vec<(Range<usize>, Walls)>,
    /// Where the nozzle is before the first block.
    start: [i64; 2],
}

impl Batch<'_> {
    /// A block's text, all blocks being drawn as `picks` say.
    fn write(&self, picks: &[Vec<Pick>], i: usize) -> Written {
        reorder::write(&self.blocks[i], &picks[i], self.from(picks, i), &self.habit, self.walls(i))
    }

    /// What a block comes to in its old and in its new order; `written`: all blocks in their new order.
    fn options(&self, old: &[Vec<Pick>], new: &[Vec<Pick>], written: &[Written], i: usize) -> Options {
        let junction = |before: &[Vec<Pick>], picks: &[Vec<Pick>]| {
            let from = self.from(before, i);
            reorder::junction(&self.blocks[i], &picks[i], from, &self.habit, self.walls(i))
        };
        let changed = |i: usize| old[i] != new[i];
        let after_new = [junction(new, old), written[i].junction];
        let after_old = match i > 0 && changed(i - 1) {
            true => [junction(old, old), junction(old, new)],
            false => after_new,
        };
        Options {
            inside: [self.blocks[i].tolls()[1], written[i].inside],
            junction: [after_old, after_new],
            changed: changed(i),
        }
    }

    /// Where the nozzle is before a block.
    fn from(&self, picks: &[Vec<Pick>], i: usize) -> [i64; 2] {
        i.checked_sub(1).map_or(self.start, |last| reorder::end(&self.blocks[last], &picks[last]))
    }

    fn walls(&self, i: usize) -> &Walls {
        let layer = self.walls.partition_point(|(range, _)| range.end <= i);
        &self.walls[layer].1
    }
}

/// The walls of every layer, with the blocks that make it up.
fn walls(blocks: &[Block]) -> Vec<(Range<usize>, Walls)> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        match ranges.last_mut() {
            Some(range) if blocks[range.start].layer() == block.layer() => range.end = index + 1,
            _ => ranges.push(index..index + 1),
        }
    }
    let walls = parallel::map(ranges.len(), |i| Walls::new(blocks[ranges[i].clone()].iter()));
    ranges.into_iter().zip(walls).collect()
}
