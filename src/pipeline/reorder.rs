//! A G-code file in another order: read, ordered, written and compared in batches of blocks.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::ops::Range;
use std::path::Path;

use crate::job::{JobError, Progress, ReorderJob};
use crate::order::{Chain, Pins, SeamRule, chunk_len};
use crate::output::Output;
use crate::profile::{SeamPosition, Settings};
use crate::reorder::{self, Block, Blocks, Habit, Learner, Pick, Proof, Walls, Written};
use crate::report::{Reordered, Way};
use crate::toolpath::LayerPaths;

use super::{ordering, parallel};

/// A batch holds at least so many bytes of the file: enough to keep all threads busy, whatever the file's size.
const BATCH_BYTES: usize = 8 << 20;
/// Size of the buffer in front of the file.
const BUFFER_BYTES: usize = 1 << 18;
/// A retraction is worth so much travel, mm: about what it takes in time.
const RETRACTION_MM: f64 = 5.0;
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
    let open = || open(&job.file);
    let improved = rewrite(open()?, job, settings, output, progress)?;
    let read = |error: io::Error| input_error(&job.file, &error);
    let mut report = Reordered { file: job.file.display().to_string(), ..Reordered::default() };
    let proof: Option<Proof> = match improved {
        false => None,
        true => {
            let proof = reorder::verify(open()?, output.reread()?).map_err(read)?;
            Some(proof.map_err(|difference| {
                JobError::Check(format!("{}: {difference}; nothing was written", job.file.display()))
            })?)
        }
    };
    if let Some(proof) = proof {
        (report.before, report.after) = (Way::from(&proof.before), Way::from(&proof.after));
        report.layers = proof.layers;
        report.changed = true;
    }
    Ok(report)
}

fn open(path: &Path) -> Result<BufReader<File>, JobError> {
    let file = File::open(path).map_err(|error| input_error(path, &error))?;
    Ok(BufReader::with_capacity(BUFFER_BYTES, file))
}

fn input_error(path: &Path, error: &io::Error) -> JobError {
    JobError::Input(format!("{}: {error}", path.display()))
}

/// Writes the file in its new order. Whether that is worth anything.
fn rewrite(
    input: impl BufRead,
    job: &ReorderJob,
    settings: &Settings,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<bool, JobError> {
    let mut run = Run {
        chain: ordering::chain(settings),
        seam: SeamRule::new(match settings.seam.position {
            // Walls that keep their seams are known by their roles.
            SeamPosition::Pinned => SeamPosition::Free,
            other => other,
        }),
        position: settings.seam.position,
        learner: Learner::default(),
        at: None,
        marked: false,
        layers: 0,
        before: (0.0, 0),
        after: (0.0, 0),
    };
    let mut blocks = Blocks::new(input);
    let mut carry: Option<Block> = None;
    loop {
        let mut batch: Vec<Block> = carry.take().into_iter().collect();
        let mut bytes = 0;
        while let Some(block) = blocks.next().map_err(|error| input_error(&job.file, &error))? {
            // The blocks of one layer stay together.
            if bytes >= BATCH_BYTES && batch.last().is_some_and(|last| last.layer() != block.layer()) {
                carry = Some(block);
                break;
            }
            bytes += block.bytes();
            batch.push(block);
        }
        if batch.is_empty() {
            break;
        }
        for written in run.batch(&batch) {
            output.write(&written.bytes)?;
            progress.layer_done();
        }
    }
    let score = |(travel_mm, pulls): (f64, usize)| travel_mm + RETRACTION_MM * pulls as f64;
    Ok(score(run.after) < score(run.before) * (1.0 - WORTHWHILE))
}

/// What goes on from batch to batch.
struct Run {
    chain: Chain,
    seam: SeamRule,
    position: SeamPosition,
    learner: Learner,
    /// Where the nozzle is, if not where the file has it.
    at: Option<[i64; 2]>,
    /// Whether the file marks its layers.
    marked: bool,
    layers: usize,
    before: (f64, usize),
    after: (f64, usize),
}

impl Run {
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
        let mut written = self.write(blocks, &picks, &habit, &walls);
        for _ in 0..ROUNDS {
            let mut worse = false;
            for (index, block) in blocks.iter().enumerate() {
                let was = block.travel();
                let now = (written[index].travel_mm, written[index].pulls);
                let score = |(travel_mm, pulls): (f64, usize)| travel_mm + RETRACTION_MM * pulls as f64;
                if score(now) >= score(was)
                    && picks[index].iter().enumerate().any(|(i, p)| *p != Pick::as_is(i))
                {
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
            self.before.0 += travel_mm;
            self.before.1 += pulls;
            self.after.0 += written.travel_mm;
            self.after.1 += written.pulls;
        }
        for (block, picks) in blocks.iter().zip(&picks) {
            self.at = Some(reorder::end(block, picks));
        }
        self.layers += blocks.len();
        written
    }

    /// The order of the paths of every block.
    fn order(&mut self, blocks: &[Block]) -> Vec<Vec<Pick>> {
        let layers: Vec<LayerPaths> =
            parallel::map(blocks.len(), |i| reorder::layer(&blocks[i], self.layers + i, self.position));
        let pins: Vec<Pins> = layers.iter().map(|layer| self.seam.pins(layer)).collect();
        // Blocks without paths are passed over.
        let with_paths: Vec<usize> = (0..blocks.len()).filter(|&i| blocks[i].paths() > 0).collect();
        let paths: Vec<LayerPaths> = with_paths.iter().map(|&i| layers[i].clone()).collect();
        let chosen: Vec<Pins> = with_paths.iter().map(|&i| pins[i].clone()).collect();
        let start = self.at.zip(blocks.first()).map(|(at, block)| block.point(at));
        let sequences = match paths.is_empty() {
            true => Vec::new(),
            false => ordering::solve(&self.chain, &paths, &chosen, chunk_len(paths.len()), start).sequences,
        };
        let mut picks = vec![Vec::new(); blocks.len()];
        for (&i, sequence) in with_paths.iter().zip(&sequences) {
            picks[i] = reorder::picks(&blocks[i], &layers[i], sequence);
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
