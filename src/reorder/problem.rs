//! A block as a layer to be ordered, and the answer in terms of its paths.

use std::hash::Hash;
use std::ops::Range;

use rustc_hash::FxHashMap;

use super::block::{Block, Path};
use super::islands::{Islands, is_wall, islands};
use super::monotonic;
use super::state::Key;
use crate::order::PathVisit;
use crate::order::{Scope, SeamPosition};
use crate::toolpath::{IslandId, LayerKind, LayerPaths, Path as Toolpath, Phase, Role, Width};
use geometry::{Point, Region};

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

/// A block as the ordering knows it.
#[derive(Clone, Debug)]
pub struct Ordering {
    /// Its paths: open ones by their ends, loops that must keep their seam as open ones with equal ends, and walls
    /// that stay together as one path.
    pub layer: LayerPaths,
    /// The paths of the block that each of them stands for.
    members: Vec<Range<usize>>,
    /// Links within walls that stay together, mm.
    pub fixed_mm: f64,
}

impl Ordering {
    /// The problem of a block; `index` is that of the layer among all that are ordered together.
    ///
    /// Islands are connected sets of beads. Within an island the types keep the file's order, by their first
    /// appearance, and so do walls of one type that the file draws depth by depth. Where a file goes to and fro between
    /// inner and outer walls, it does so contour by contour: the walls of a contour then stay together, in their order,
    /// and are one path (not under `layer` scope), and so are the lines of [monotonic](monotonic::kept) surfaces. A
    /// skirt or brim with which a layer begins stays first.
    pub fn new(block: &Block, index: usize, seam: SeamPosition, scope: Scope) -> Self {
        let Islands { of: island, beside } = islands(block);
        let classes = Classes::new(block, &island, &beside);
        let monotonic = monotonic::kept(block, &island);
        let together = |i: usize| {
            scope != Scope::Layer && i > 0 && (monotonic[i] || classes.stay_together(i - 1, i, &island))
        };
        let (mut paths, mut members, mut fixed_mm) = (Vec::new(), Vec::new(), 0.0);
        let mut leading = true;
        let mut first = 0;
        while first < block.paths.len() {
            let end = (first + 1..block.paths.len()).find(|&i| !together(i)).unwrap_or(block.paths.len());
            let walls = &block.paths[first..end];
            leading &= matches!(walls[0].role, Some(Role::Skirt | Role::Brim));
            let (closed, points) = match walls {
                [path] => shape(block, path, seam),
                // Drawn in their own order from whichever side they are reached: a position between start and end.
                _ => (false, vec![middle(block, &walls[0], &walls[walls.len() - 1]); 2]),
            };
            let link = |w: &[Path]| block.point(block.end(&w[0])).distance_mm(block.point(w[1].from));
            fixed_mm += walls.windows(2).map(link).sum::<f64>();
            paths.push(Toolpath {
                // What is printed is of no concern any more, only whether it comes before everything else.
                role: if leading { Role::Skirt } else { Role::Perimeter },
                closed,
                points,
                width: Width::Constant(0.4),
                height_mm: 0.2,
                island: Some(IslandId(island[first])),
                phase: Phase::Found(classes.rank[first]),
                tool: None,
            });
            members.push(first..end);
            first = end;
        }
        let layer = LayerPaths {
            index,
            top_mm: super::ticks::units(block.after.at[2]) * block.frame.scale,
            height_mm: 0.2,
            islands: Vec::new(),
            paths,
            outline: Region::default(),
            beneath: None,
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        };
        Self { layer, members, fixed_mm }
    }

    /// The picks that a solution means.
    pub fn picks(&self, block: &Block, sequence: &[PathVisit]) -> Vec<Pick> {
        let mut picks = Vec::with_capacity(block.paths.len());
        for visit in sequence {
            let item = visit.path as usize;
            let members = self.members[item].clone();
            picks.extend(members.clone().map(Pick::as_is));
            let Some(pick) = picks.last_mut().filter(|_| members.len() == 1) else { continue };
            if self.layer.paths[item].closed {
                // Point k of a loop is where its stroke k begins.
                pick.first = visit.entry as usize;
            } else {
                // A loop that keeps its seam is never turned around.
                pick.reversed = visit.entry == 1 && !block.closed(&block.paths[pick.path]);
            }
        }
        picks
    }

    /// Which paths may be mixed: equal numbers follow each other in a solution and may change places.
    pub(super) fn runs(&self, scope: Scope) -> Vec<(usize, bool, Option<IslandId>, Phase)> {
        let of = |item: usize| {
            let path = &self.layer.paths[item];
            let leading = path.role == Role::Skirt;
            let (island, phase) =
                if scope == Scope::Layer { (None, Phase::Found(0)) } else { (path.island, path.phase) };
            // Walls that stay together are a run of their own.
            let whole = if self.members[item].len() > 1 { item + 1 } else { 0 };
            self.members[item].clone().map(move |_| (whole, leading, island, phase))
        };
        (0..self.members.len()).flat_map(of).collect()
    }
}

fn shape(block: &Block, path: &Path, seam: SeamPosition) -> (bool, Vec<Point>) {
    if block.closed(path) && may_rotate(path, seam) {
        let points = block.points(path).take(path.segs.len());
        return (true, points.map(|[x, y]| Point::from_mm(x, y)).collect());
    }
    (false, [path.from, block.end(path)].map(|p| block.point(p)).to_vec())
}

fn middle(block: &Block, first: &Path, last: &Path) -> Point {
    let [a, b] = [first.from, block.end(last)].map(|p| block.mm(p));
    Point::from_mm((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0)
}

/// Whether a loop may begin elsewhere.
fn may_rotate(path: &Path, seam: SeamPosition) -> bool {
    let outer = path.role.is_none_or(Role::is_outer_wall);
    seam != SeamPosition::Pinned || !outer
}

/// Types of paths within their islands.
struct Classes {
    /// Rank of each path among the runs of its island.
    rank: Vec<u32>,
    /// Position of its type among those of its island.
    kind: Vec<u32>,
    /// Whether it is a wall, and the file goes to and fro between its island's types of walls.
    alternating: Vec<bool>,
}

impl Classes {
    fn new(block: &Block, island: &[u32], beside: &[Option<u32>]) -> Self {
        let name = names(block);
        let depth = depths(&block.paths, |i| (island[i], name[i]), beside);
        // (island, type, depth) in the order of their first paths.
        let mut known = FxHashMap::default();
        let mut runs: Vec<Run> = Vec::new();
        let of: Vec<usize> = block
            .paths
            .iter()
            .enumerate()
            .map(|(i, path)| {
                let run = *known.entry((island[i], name[i], depth[i])).or_insert_with(|| {
                    runs.push(Run {
                        island: island[i],
                        wall: is_wall(path),
                        first: i,
                        last: i,
                        kind: 0,
                        rank: 0,
                    });
                    runs.len() - 1
                });
                runs[run].last = i;
                run
            })
            .collect();
        let mut islands: FxHashMap<u32, IslandRuns> = FxHashMap::default();
        for run in &mut runs {
            let seen = islands.entry(run.island).or_default();
            run.kind = seen.kinds;
            seen.kinds += 1;
            if run.wall {
                seen.alternating |= seen.last_wall.is_some_and(|last| last > run.first);
                seen.last_wall = seen.last_wall.max(Some(run.last));
            }
        }
        for run in &mut runs {
            let seen = islands.entry(run.island).or_default();
            let one = run.wall && seen.alternating;
            run.rank = match seen.walls.filter(|_| one) {
                Some(rank) => rank,
                None => {
                    seen.ranks += 1;
                    seen.ranks - 1
                }
            };
            if one {
                seen.walls = Some(run.rank);
            }
        }
        Self {
            rank: of.iter().map(|&run| runs[run].rank).collect(),
            kind: of.iter().map(|&run| runs[run].kind).collect(),
            alternating: of
                .iter()
                .map(|&run| runs[run].wall && islands[&runs[run].island].alternating)
                .collect(),
        }
    }

    /// Whether two paths, one after the other in the file, are walls of one contour.
    fn stay_together(&self, a: usize, b: usize, island: &[u32]) -> bool {
        island[a] == island[b] && self.alternating[a] && self.alternating[b] && self.kind[a] <= self.kind[b]
    }
}

/// A number for the role and type of each path, the same for the same.
fn names(block: &Block) -> Vec<u32> {
    let mut known = FxHashMap::default();
    let name = |path: &Path| {
        let state = block.segs[path.segs.start].state as usize;
        let next = known.len() as u32;
        *known.entry((path.role, block.states[state].get(Key::Type).of(&block.text))).or_insert(next)
    };
    block.paths.iter().map(name).collect()
}

/// For each wall, the number of walls of its type and island outside of it, where the file draws them depth by depth;
/// otherwise 0. A wall that runs along none, before it or after, may be of any depth: it is taken to be of the one
/// that is being drawn.
fn depths<K: Eq + Hash>(paths: &[Path], kind: impl Fn(usize) -> K, beside: &[Option<u32>]) -> Vec<u32> {
    let (mut depth, mut drawn) = (vec![0; paths.len()], vec![0; paths.len()]);
    let inner = |i: usize| beside[i].map(|other| other as usize).filter(|&other| kind(other) == kind(i));
    let mut has_outer = vec![false; paths.len()];
    (0..paths.len()).filter_map(inner).for_each(|inner| has_outer[inner] = true);
    // The depth drawn last of each kind; `None`: they are drawn to and fro.
    let mut last: FxHashMap<K, Option<u32>> = FxHashMap::default();
    for i in (0..paths.len()).filter(|&i| is_wall(&paths[i])) {
        let inner = inner(i);
        depth[i] = inner.map_or(0, |inner| depth[inner] + 1);
        let known = last.entry(kind(i)).or_insert(Some(depth[i]));
        if inner.is_some() || has_outer[i] {
            *known = known.filter(|&known| known <= depth[i]).map(|_| depth[i]);
        }
        drawn[i] = known.unwrap_or(depth[i]);
    }
    for i in (0..paths.len()).filter(|&i| is_wall(&paths[i])) {
        if last.get(&kind(i)).is_none_or(Option::is_none) {
            drawn[i] = 0;
        }
    }
    drawn
}

/// All paths of one type and depth in one island.
struct Run {
    island: u32,
    wall: bool,
    first: usize,
    last: usize,
    /// Position among the types of its island, and among its runs.
    kind: u32,
    rank: u32,
}

/// What is known of an island's runs so far.
#[derive(Default)]
struct IslandRuns {
    kinds: u32,
    ranks: u32,
    last_wall: Option<usize>,
    alternating: bool,
    /// The rank of its walls, where these are one run.
    walls: Option<u32>,
}
