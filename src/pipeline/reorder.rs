//! A G-code file in another order: read, ordered, written and compared in batches of blocks.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::ops::Range;
use std::path::Path;

use crate::job::{JobError, Progress, ReorderJob};
use crate::order::{Chain, Pins, SeamRule, chunk_len};
use crate::output::Output;
use crate::profile::{SeamPosition, Settings};
use crate::reorder::{self, Block, Blocks, Habit, Learner, Ordering, Pick, Walls, Written};
use crate::report::{Reordered, Way};
use crate::toolpath::LayerPaths;

use super::{ordering, parallel};

/// A batch holds at least so many bytes of the file: enough to keep all threads busy, whatever the file's size.
const BATCH_BYTES: usize = 8 << 20;
/// Size of the buffer in front of the file.
const BUFFER_BYTES: usize = 1 << 18;
/// An improvement below this share of the travel is none.
const WORTHWHILE: f64 = 1e-4;
/// How often blocks whose new order turns out no better are taken back.
const ROUNDS: usize = 3;

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
        let proof = reorder::verify(open(&job.file)?, output.reread()?)
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
    input: impl BufRead,
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

/// Way without extrusion, mm, and how often filament is pulled back.
type Toll = (f64, usize);

/// What goes on from batch to batch.
struct Run {
    chain: Chain,
    seam: SeamRule,
    position: SeamPosition,
    keep_direction: bool,
    /// Whether blocks whose new order is no better keep the old one.
    take_back: bool,
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
    fn new(settings: &Settings, keep_direction: bool, take_back: bool) -> Self {
        Self {
            chain: ordering::chain(settings),
            seam: seam_rule(settings.seam.position),
            position: settings.seam.position,
            keep_direction,
            take_back,
            learner: Learner::default(),
            retraction_mm: 0.0,
            at: None,
            marked: false,
            blocks: 0,
            before: (0.0, 0),
            after: (0.0, 0),
        }
    }

    /// Whether what was written is worth anything.
    fn improved(&self) -> bool {
        self.score(self.after) < self.score(self.before) * (1.0 - WORTHWHILE)
    }

    /// The lower, the better.
    fn score(&self, (travel_mm, pulls): Toll) -> f64 {
        travel_mm + self.retraction_mm * pulls as f64
    }

    fn rewrite(
        &mut self,
        path: &Path,
        input: impl BufRead,
        output: &mut Output,
        progress: &dyn Progress,
    ) -> Result<(), JobError> {
        let mut blocks = Blocks::new(input);
        let mut carry: Option<Block> = None;
        loop {
            let mut batch: Vec<Block> = carry.take().into_iter().collect();
            let mut bytes = 0;
            while let Some(block) = blocks.read().map_err(|error| input_error(path, &error))? {
                // The blocks of one layer stay together.
                if bytes >= BATCH_BYTES && batch.last().is_some_and(|last| last.layer() != block.layer()) {
                    carry = Some(block);
                    break;
                }
                bytes += block.bytes();
                batch.push(block);
            }
            if batch.is_empty() {
                return Ok(());
            }
            for written in self.batch(&batch) {
                output.write(&written.bytes)?;
                progress.layer_done();
            }
        }
    }

    /// Orders and writes some blocks.
    fn batch(&mut self, blocks: &[Block]) -> Vec<Written> {
        blocks.iter().for_each(|block| self.learner.learn(block));
        let habit = self.learner.habit();
        let walls = walls(blocks);
        let as_is = |block: &Block| (0..block.paths()).map(Pick::as_is).collect::<Vec<_>>();
        let mut picks: Vec<Vec<Pick>> = match &habit {
            None => blocks.iter().map(as_is).collect(),
            Some(_) => self.order(blocks),
        };
        // What comes before the first mark is no layer of the print.
        self.marked |= blocks.iter().any(Block::marked);
        for (block, picks) in blocks.iter().zip(&mut picks) {
            if self.marked && !block.marked() {
                *picks = as_is(block);
            }
        }
        let habit = habit.unwrap_or_default();
        self.retraction_mm = habit.retraction_mm();
        let mut written = self.write(blocks, &picks, &habit, &walls);
        for _ in 0..if self.take_back { ROUNDS } else { 0 } {
            let mut worse = false;
            for (index, block) in blocks.iter().enumerate() {
                let was = block.travel();
                let now = (written[index].travel_mm, written[index].pulls);
                let changed = picks[index].iter().enumerate().any(|(i, pick)| *pick != Pick::as_is(i));
                // Nowhere is less travel paid for with more retractions, or the other way round.
                let dearer = now.0 > was.0 || now.1 > was.1;
                if changed && (dearer || self.score(now) >= self.score(was)) {
                    picks[index] = as_is(block);
                    worse = true;
                }
            }
            if !worse {
                break;
            }
            written = self.write(blocks, &picks, &habit, &walls);
        }
        for (block, written) in blocks.iter().zip(&written) {
            let (travel_mm, pulls) = block.travel();
            self.before = (self.before.0 + travel_mm, self.before.1 + pulls);
            self.after = (self.after.0 + written.travel_mm, self.after.1 + written.pulls);
        }
        self.at = blocks.last().zip(picks.last()).map(|(block, picks)| reorder::end(block, picks));
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

    fn write(
        &self,
        blocks: &[Block],
        picks: &[Vec<Pick>],
        habit: &Habit,
        walls: &[(Range<usize>, Walls)],
    ) -> Vec<Written> {
        parallel::map(blocks.len(), |i| {
            let from = match i.checked_sub(1) {
                Some(last) => reorder::end(&blocks[last], &picks[last]),
                None => self.at.unwrap_or(blocks[i].start()),
            };
            let layer = walls.partition_point(|(range, _)| range.end <= i);
            reorder::write(&blocks[i], &picks[i], from, habit, &walls[layer].1)
        })
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
