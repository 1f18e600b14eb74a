//! Soup → mesh: repeated facets and sheets dropped, small gaps welded, facets turned to face outwards, holes filled.
//!
//! Each step runs only where edge matching shows that it is needed; overlaps and self-intersections stay, slicing copes
//! with them.

mod agree;
mod doubts;
mod gaps;
mod holes;
mod outside;
mod pairs;
mod rays;
mod sheets;
mod walls;

use crate::mesh::edges::{Edges, NO_TWIN, Side, for_each_edge};
use crate::mesh::measure::{area_mm2, keep};
use crate::mesh::weld::Soup;
use crate::parallel::Workers;
use doubts::Doubtful;
use geometry::DisjointSets;

pub use doubts::Doubt;
pub(super) use outside::turn_facets;

/// Repairs and findings; the volume of an open shell is that of the cone from the middle of its box.
#[derive(Clone, Debug, Default)]
pub(super) struct Repairs {
    pub degenerate: usize,
    pub duplicates: usize,
    /// Pairs of equal facets of opposite winding of which neither stays.
    pub cancelled: usize,
    /// Facets of fins, and of walls between bodies.
    pub sheets: usize,
    pub welded: usize,
    pub flipped: usize,
    /// Holes that were filled.
    pub filled: usize,
    pub open: usize,
    pub non_manifold: usize,
    /// Edges whose two facets could not be made to agree.
    pub clashing: usize,
    pub shells: usize,
    pub volume_mm3: f64,
    pub area_mm2: f64,
    pub doubt: Option<Doubt>,
}

/// A mesh with its neighbourhood, coordinates as read.
pub(super) struct Repaired {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub twins: Vec<u32>,
    pub repairs: Repairs,
}

/// The share of the surface that is taken to have moved where wide gaps were welded: moves average out.
const WELDED_SHARE: f64 = 0.1;

/// Repairs a mesh as far as possible, unless the run is cancelled before one of the steps; guesses are reported as doubts.
pub(super) fn repair(soup: Soup, workers: Workers<'_>) -> Repaired {
    let Soup { mut vertices, mut triangles, mut degenerate } = soup;
    let mut repairs = Repairs::default();
    let mut doubts = Vec::new();
    // Facets whose winding says nothing.
    let mut free = vec![false; triangles.len()];
    workers.go_on();
    let mut edges = Edges::new(&triangles, vertices.len());
    settle(&vertices, &mut triangles, &mut free, &mut edges, &mut repairs);
    workers.go_on();
    if edges.matches.open > 0
        && let Some(closed) = gaps::close(&vertices, &triangles, &edges)
    {
        repairs.welded = closed.welded;
        if closed.moved_mm > 0.0 {
            let area_mm2: f64 = triangles.iter().map(|t| area_mm2(&vertices, *t)).sum();
            let cause = "wide gaps were welded";
            let volume_mm3 = WELDED_SHARE * area_mm2 * closed.moved_mm;
            doubts.push(Doubtful::around(cause, volume_mm3, vertices.iter().copied()));
        }
        degenerate += closed.stays.iter().filter(|stays| !**stays).count();
        keep(&mut free, &closed.stays);
        (triangles, edges) = (closed.triangles, closed.edges);
        settle(&vertices, &mut triangles, &mut free, &mut edges, &mut repairs);
    }
    workers.go_on();
    if edges.matches.non_manifold > 0 {
        repairs.sheets = sheets::drop_sheets(&vertices, &mut triangles, &mut free);
        if repairs.sheets > 0 {
            edges = Edges::new(&triangles, vertices.len());
        }
    }
    workers.go_on();
    let mut doubtful = Vec::new();
    if edges.matches.clashing > 0 {
        let agreed = agree::agree(&vertices, &mut triangles, &edges.twins, &free);
        repairs.flipped = agreed.turned;
        doubtful = agreed.doubtful;
        edges = Edges::new(&triangles, vertices.len());
    }
    workers.go_on();
    if edges.matches.non_manifold > 0 {
        let turned = walls::turn_patches(&vertices, &mut triangles);
        repairs.flipped += turned;
        if turned > 0 {
            edges = Edges::new(&triangles, vertices.len());
        }
    }
    workers.go_on();
    if !edges.matches.are_perfect() {
        let filled = holes::fill(&vertices, &triangles, &edges);
        if filled.holes > 0 {
            repairs.filled = filled.holes;
            triangles.extend(filled.facets);
            doubts.extend(filled.doubts);
            edges = Edges::new(&triangles, vertices.len());
        }
    }
    if degenerate + repairs.duplicates + repairs.cancelled + repairs.sheets > 0 {
        drop_unused(&mut vertices, &mut triangles);
    }
    workers.go_on();
    let (shell_of, shells) = shells(&triangles, vertices.len(), &edges);
    let (body_of, bodies) = match edges.matches.non_manifold {
        0 => (shell_of, shells),
        _ => bodies(&triangles, vertices.len()),
    };
    doubtful.resize(triangles.len(), false);
    workers.go_on();
    let outcome =
        outside::turn_outwards(&vertices, &mut triangles, &mut edges.twins, &body_of, bodies, &doubtful);
    repairs.flipped += outcome.turned;
    doubts.extend(outcome.doubts);
    if outcome.turned > 0 && edges.matches.non_manifold > 0 {
        // Bodies that meet at an edge may have turned apart.
        edges = Edges::new(&triangles, vertices.len());
    }
    if doubts::is_broken(&edges.twins, edges.matches.clashing) {
        let cause = "edges stay open, or their facets disagree on the outside";
        let along_lines = doubts::along_lines(&vertices, &triangles, cause);
        doubts.extend(along_lines.or_else(|| doubts::between_axes(&vertices, &triangles, cause)));
    }
    Repaired {
        repairs: Repairs {
            degenerate,
            open: edges.matches.open,
            non_manifold: edges.matches.non_manifold,
            clashing: edges.matches.clashing,
            shells,
            volume_mm3: outcome.volume_mm3,
            area_mm2: outcome.area_mm2,
            doubt: doubts::sum(&doubts, outcome.volume_mm3, &vertices),
            ..repairs
        },
        vertices,
        triangles,
        twins: edges.twins,
    }
}

/// Drops facets that stand at one position with others, where edges show that there are any: two equal facets make edges
/// with two facets in the same direction, or with more than two.
fn settle(
    vertices: &[[f32; 3]],
    triangles: &mut Vec<[u32; 3]>,
    free: &mut Vec<bool>,
    edges: &mut Edges,
    repairs: &mut Repairs,
) {
    // Two facets back to back that nothing else touches match each other.
    if edges.matches.clashing + edges.matches.non_manifold > 0 {
        let Some(settled) = pairs::settle(vertices, triangles, edges) else { return };
        repairs.duplicates += settled.duplicates;
        repairs.cancelled += settled.cancelled;
        keep(free, &settled.alone);
        free.extend(settled.added_free);
        *edges = edges.after(triangles, &settled.alone, &settled.triangles, vertices.len());
        *triangles = settled.triangles;
    }
}

/// Drops vertices that no facet names, which dropped facets leave behind.
fn drop_unused(vertices: &mut Vec<[f32; 3]>, triangles: &mut [[u32; 3]]) {
    let mut used = vec![false; vertices.len()];
    for &v in triangles.iter().flatten() {
        used[v as usize] = true;
    }
    let index: Vec<u32> = used
        .iter()
        .scan(0, |next, &used| {
            let index = *next;
            *next += u32::from(used);
            Some(index)
        })
        .collect();
    let mut used = used.into_iter();
    vertices.retain(|_| used.next().unwrap_or(false));
    for v in triangles.iter_mut().flatten() {
        *v = index[*v as usize];
    }
}

/// Numbers the parts connected by edges, in the order of their first facets.
fn shells(triangles: &[[u32; 3]], vertex_count: usize, edges: &Edges) -> (Vec<u32>, usize) {
    let mut parts = DisjointSets::new(triangles.len());
    for (half, &twin) in edges.twins.iter().enumerate() {
        if twin != NO_TWIN && (half as u32) < twin {
            parts.join(half as u32 / 3, twin / 3);
        }
    }
    if edges.matches.non_manifold + edges.matches.clashing > 0 {
        for_each_edge(triangles, vertex_count, |sides| {
            for pair in sides.windows(2) {
                parts.join(pair[0].triangle(), pair[1].triangle());
            }
        });
    }
    parts.number()
}

/// Numbers the parts that are closed by themselves: where more than two facets meet at an edge, those parts are joined
/// that have more facets there of one direction than of the other.
fn bodies(triangles: &[[u32; 3]], vertex_count: usize) -> (Vec<u32>, usize) {
    let mut parts = DisjointSets::new(triangles.len());
    for_each_edge(triangles, vertex_count, |sides| {
        if let [a, b] = *sides {
            parts.join(a.triangle(), b.triangle());
        }
    });
    let (patch_of, _) = parts.number();
    let patch = |side: &Side| patch_of[side.triangle() as usize];
    for_each_edge(triangles, vertex_count, |sides| {
        if sides.len() < 3 {
            return;
        }
        let net = |of: u32| -> i32 {
            let own = sides.iter().filter(|side| patch(side) == of);
            own.map(|side| if side.is_backward() { -1 } else { 1 }).sum()
        };
        let unbalanced: Vec<u32> =
            sides.iter().filter(|side| net(patch(side)) != 0).map(|side| side.triangle()).collect();
        unbalanced.windows(2).for_each(|pair| {
            parts.join(pair[0], pair[1]);
        });
    });
    parts.number()
}
