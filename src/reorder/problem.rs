//! A block as a layer to be ordered, and the answer in terms of its paths.

use super::block::{Block, Path};
use super::islands::islands;
use super::state::Key;
use crate::geom::{Point, Region};
use crate::order::Visit;
use crate::profile::SeamPosition;
use crate::toolpath::{LayerPaths, Path as Toolpath, Role, Width};

/// One step of an order: a path, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pick {
    pub(super) path: usize,
    pub(super) reversed: bool,
    /// Of a loop, the stroke it begins with.
    pub(super) first: usize,
}

impl Pick {
    /// A path as the file has it.
    pub fn as_is(path: usize) -> Self {
        Self { path, reversed: false, first: 0 }
    }
}

/// The block's paths as the ordering knows them: open ones by their ends, loops that must keep their seam as open ones
/// whose ends are the same.
///
/// Islands are connected sets of beads. Within an island the types keep the file's order, by their first appearance;
/// types between which the file goes to and fro form one run. A skirt or brim with which a layer begins stays first.
pub fn layer(block: &Block, index: usize, seam: SeamPosition) -> LayerPaths {
    let island = islands(block);
    let ranks = ranks(block, &island);
    let mut leading = true;
    let paths = block.paths.iter().enumerate().map(|(i, path)| {
        leading &= matches!(path.role, Some(Role::Skirt | Role::Brim));
        let rotates = block.closed(path) && may_rotate(path, seam);
        let ends = [path.from, block.end(path)];
        let points = match rotates {
            true => block.points(path).skip(1).map(|[x, y]| Point::from_mm(x, y)).collect(),
            false => ends.iter().map(|p| block.mm(*p)).map(|[x, y]| Point::from_mm(x, y)).collect(),
        };
        Toolpath {
            // What is printed is of no concern any more, only whether it comes before everything else.
            role: if leading { Role::Skirt } else { Role::Perimeter },
            closed: rotates,
            points,
            width: Width::Constant(0.4),
            height_mm: 0.2,
            island: island[i],
            rank: ranks[i],
        }
    });
    LayerPaths {
        index,
        top_mm: super::ticks::units(block.after.at[2]) * block.frame.scale,
        height_mm: 0.2,
        islands: Vec::new(),
        paths: paths.collect(),
        outline: Region::default(),
        beneath: None,
    }
}

/// Whether a loop may begin elsewhere.
fn may_rotate(path: &Path, seam: SeamPosition) -> bool {
    let outer = matches!(path.role, None | Some(Role::ExternalPerimeter | Role::OverhangPerimeter));
    seam != SeamPosition::Pinned || !outer
}

/// The picks that a solution means.
pub fn picks(block: &Block, layer: &LayerPaths, sequence: &[Visit]) -> Vec<Pick> {
    let pick = |visit: &Visit| {
        let path = visit.item as usize;
        if !layer.paths[path].closed {
            // A loop that keeps its seam is never turned around.
            let reversed = visit.entry == 1 && !block.closed(&block.paths[path]);
            return Pick { path, reversed, first: 0 };
        }
        // Point k of a loop is where its stroke k + 1 begins.
        Pick { path, reversed: false, first: (visit.entry as usize + 1) % block.paths[path].segs.len() }
    };
    sequence.iter().map(pick).collect()
}

/// The rank of every path among the runs of its island.
fn ranks(block: &Block, island: &[u32]) -> Vec<u32> {
    // (island, type) → first and last path of it.
    let kind = |path: &Path| {
        let state = block.segs[path.segs.start].state as usize;
        (path.role, block.states[state].get(Key::Type).of(&block.text))
    };
    let mut runs: Vec<Run> = Vec::new();
    let mut known = rustc_hash::FxHashMap::default();
    let of: Vec<usize> = block
        .paths
        .iter()
        .enumerate()
        .map(|(i, path)| {
            let run = *known.entry((island[i], kind(path))).or_insert_with(|| {
                runs.push(Run { island: island[i], first: i, last: i, rank: 0 });
                runs.len() - 1
            });
            runs[run].last = i;
            run
        })
        .collect();
    // Runs are listed by their first path: those that overlap form one.
    let mut reach = rustc_hash::FxHashMap::default();
    for run in &mut runs {
        let (last, rank) = reach.entry(run.island).or_insert((run.last, 0_u32));
        if run.first > *last {
            *rank += 1;
        }
        *last = run.last.max(*last);
        run.rank = *rank;
    }
    of.into_iter().map(|run| runs[run].rank).collect()
}

/// All paths of one type in one island.
struct Run {
    island: u32,
    first: usize,
    last: usize,
    rank: u32,
}
