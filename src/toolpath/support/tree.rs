//! Branches that grow down from the overhangs, lean towards each other, merge, and keep clear of the part.
//!
//! For every layer the positions are known from which a branch, leaning no more than it may, still finds a route down to
//! the bed ([`avoidance`]); a branch stays there if it can, and otherwise ends on the part. The idea of such
//! avoidance areas is that of J. Vanek, J. A. G. Galicia and B. Benes, Clever Support, Computer Graphics Forum 33 (2014),
//! doi:10.1111/cgf.12437, as slicers have made it layer by layer.

use super::bitmap::Bitmap;
use super::columns::{ColumnSpec, kept_free, pads};
use crate::toolpath::options::SupportSettings;
use geometry::real;
use geometry::{Point, Polygon, Region, distance_mm};

/// Distance between the tips under a wide overhang. Their heads overlap.
const TIPS_MM: f64 = 3.0;

/// Radius of a tip's head: it covers its share of the overhang.
const HEAD_MM: f64 = 2.0;

/// Heads taper at this slope to the branch under them.
const HEAD_SLOPE: f64 = 0.6;

/// Branches grow no thicker than this in radius.
const THICKEST_MM: f64 = 6.0;

/// On the bed branches spread by this, at a slope that each loop still rests on the one below.
const FOOT_MM: f64 = 1.5;

/// See [`FOOT_MM`].
const FOOT_SLOPE: f64 = 0.5;

/// Radius of a branch where it lands on the part.
const POINT_MM: f64 = 0.6;

/// Branches this far apart lean towards each other.
const REACH_MM: f64 = 15.0;

/// Height after which branches look for their neighbours anew.
const LOOK_EVERY_MM: f64 = 1.0;

/// How far, in cells, a branch looks for a route round the part.
const DETOUR: i64 = 10;

/// Smaller holes between discs are filled: a loop around one would begin in mid-air.
const LEAST_HOLE_MM2: f64 = 10.0;

/// Corners of a circle.
const CORNERS: usize = 12;

/// A branch where it passes a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its middle in millimetres.
    pub at: [f64; 2],
    /// Its radius.
    pub radius_mm: f64,
    /// Whether it lies close under the part.
    pub is_head: bool,
}

#[derive(Clone, Copy, Debug)]
struct Branch {
    /// Number, in the order in which branches begin.
    id: usize,
    at: [f64; 2],
    goal: Option<[f64; 2]>,
    /// Layers from its highest tip down to here, and from its lowest.
    depth: usize,
    head: usize,
}

/// Grows branches under `held`, top down. `solid` are the part's cells. Returns the discs of each layer.
pub fn grow(
    held: &[Bitmap],
    solid: &[&Bitmap],
    spec: &ColumnSpec,
    settings: &SupportSettings,
) -> Vec<Vec<Disc>> {
    let pads = pads(held, solid, spec);
    let Some(top) = (0..pads.len()).rev().find(|&layer| !pads[layer].is_empty()) else {
        return vec![Vec::new(); solid.len()];
    };
    let mut discs: Vec<Vec<(usize, Disc)>> = vec![Vec::new(); solid.len()];
    // For each branch the one that it has become part of.
    let mut trunks: Vec<usize> = Vec::new();
    // For each branch its lowest layer, if it ends on the part.
    let mut landings: Vec<Option<usize>> = Vec::new();
    let lean_mm = spec.height_mm * real::tan(settings.branch_angle.to_radians());
    let avoided = avoidance(&solid[..=top], spec, settings, lean_mm);
    let look_every = ((LOOK_EVERY_MM / spec.height_mm) as usize).max(1);
    let radius = |depth: usize| {
        let widened_mm = depth as f64 * spec.height_mm * real::tan(settings.branch_taper.to_radians());
        (settings.branch_diameter.0 / 2.0 + widened_mm).min(THICKEST_MM)
    };
    let mut branches: Vec<Branch> = Vec::new();
    for layer in (0..=top).rev() {
        let free = kept_free(solid, layer, spec);
        branches.retain_mut(|branch| {
            branch.depth += 1;
            branch.head += 1;
            branch.at = step(branch, &avoided[layer], lean_mm);
            let lands = free.has_at(Point::from_mm(branch.at[0], branch.at[1]));
            landings[branch.id] = lands.then_some(layer + 1);
            !lands
        });
        merge(&mut branches, &mut trunks, &radius, lean_mm);
        let mut pad = pads[layer].clone();
        pad.remove(&free);
        begin(&mut branches, &mut trunks, &pad);
        landings.resize(trunks.len(), None);
        if layer % look_every == 0 {
            let height_mm = layer as f64 * spec.height_mm;
            look_around(&mut branches, 2.0 * height_mm * lean_mm / spec.height_mm);
        }
        let foot_mm = (FOOT_MM - FOOT_SLOPE * layer as f64 * spec.height_mm).max(0.0);
        discs[layer] = branches
            .iter()
            .map(|b| {
                let head_mm = HEAD_MM - HEAD_SLOPE * spec.height_mm * b.head as f64;
                let radius_mm = (radius(b.depth).max(head_mm) + foot_mm).min(free.grid().inside_mm(b.at));
                (b.id, Disc { at: b.at, radius_mm, is_head: b.head < spec.interface_layers })
            })
            .collect();
    }
    let trunk = |mut id: usize| {
        while trunks[id] != id {
            id = trunks[id];
        }
        id
    };
    let mut stands = vec![!spec.from_bed_only; trunks.len()];
    branches.iter().for_each(|branch| stands[branch.id] = true);
    // Where a branch lands on the part it may be on an edge: it stands on its middle.
    let pointed = |layer: usize, (id, disc): (usize, Disc)| {
        let up_mm = landings[id].map(|landing| layer.saturating_sub(landing) as f64 * spec.height_mm);
        let most_mm = up_mm.map_or(f64::MAX, |up_mm| POINT_MM + HEAD_SLOPE * up_mm);
        Disc { radius_mm: disc.radius_mm.min(most_mm), ..disc }
    };
    let standing = |(layer, discs): (usize, Vec<(usize, Disc)>)| {
        discs.into_iter().filter(|(id, _)| stands[trunk(*id)]).map(|disc| pointed(layer, disc)).collect()
    };
    discs.into_iter().enumerate().map(standing).collect()
}

/// For each layer, where a branch would touch the part, or could not but do so further down.
fn avoidance(solid: &[&Bitmap], spec: &ColumnSpec, settings: &SupportSettings, lean_mm: f64) -> Vec<Bitmap> {
    let Some(first) = solid.first() else { return Vec::new() };
    let grid = first.grid();
    let clear = grid.cells(settings.branch_diameter.0 / 2.0) + spec.gap_cells;
    let every = (grid.cell_mm() / lean_mm.max(1e-3)).ceil().min(1e6) as usize;
    let mut shadow = Bitmap::empty(grid);
    solid
        .iter()
        .enumerate()
        .map(|(layer, solid)| {
            if layer % every == 0 {
                shadow = shadow.shrunk(1);
            }
            shadow.add(&solid.grown(clear));
            shadow.clone()
        })
        .collect()
}

/// Position of a branch on the next layer down: towards its goal, or out of the part; straight down where neither is
/// possible.
fn step(branch: &Branch, avoided: &Bitmap, lean_mm: f64) -> [f64; 2] {
    let is_free = |at: [f64; 2]| !avoided.has_at(Point::from_mm(at[0], at[1]));
    if let Some(next) = branch.goal.map(|goal| toward(branch.at, goal, lean_mm))
        && is_free(next)
    {
        return next;
    }
    if is_free(branch.at) {
        return branch.at;
    }
    let grid = avoided.grid();
    let Some([x, y]) = grid.cell_at(Point::from_mm(branch.at[0], branch.at[1])) else { return branch.at };
    let around =
        (-DETOUR..=DETOUR).flat_map(|dy| (-DETOUR..=DETOUR).map(move |dx| (dx * dx + dy * dy, dx, dy)));
    let nearest = around
        .filter_map(|(far, dx, dy)| {
            let cell = [usize::try_from(x as i64 + dx).ok()?, usize::try_from(y as i64 + dy).ok()?];
            let [columns, rows] = grid.size();
            (cell[0] < columns && cell[1] < rows && !avoided.has(cell)).then_some((far, cell))
        })
        .min();
    nearest.map_or(branch.at, |(_, cell)| toward(branch.at, grid.middle_mm(cell), lean_mm))
}

/// From one position to another, but no further than so much.
fn toward(from: [f64; 2], to: [f64; 2], most_mm: f64) -> [f64; 2] {
    let away_mm = distance_mm(from, to);
    let share = if away_mm > most_mm { most_mm / away_mm } else { 1.0 };
    [0, 1].map(|i| from[i] + share * (to[i] - from[i]))
}

/// Makes one of branches that have met: the thicker one continues.
fn merge(branches: &mut Vec<Branch>, trunks: &mut [usize], radius: &impl Fn(usize) -> f64, near_mm: f64) {
    let buckets = Buckets::new(branches, THICKEST_MM.max(near_mm));
    let mut gone = vec![false; branches.len()];
    for i in 0..branches.len() {
        for j in buckets.near(branches[i].at) {
            if j <= i || gone[i] || gone[j] {
                continue;
            }
            let (thick, thin) = if branches[j].depth > branches[i].depth { (j, i) } else { (i, j) };
            let inside_mm = radius(branches[thick].depth) - radius(branches[thin].depth);
            if distance_mm(branches[i].at, branches[j].at) <= near_mm.max(inside_mm) {
                gone[thin] = true;
                trunks[branches[thin].id] = branches[thick].id;
                let head = branches[thin].head;
                branches[thick].head = branches[thick].head.min(head);
            }
        }
    }
    let mut index = 0;
    branches.retain(|_| {
        index += 1;
        !gone[index - 1]
    });
}

/// Begins branches under pads: one for each square of a lattice, unless a branch that passes there can hold it with a
/// head of its own.
fn begin(branches: &mut Vec<Branch>, trunks: &mut Vec<usize>, pad: &Bitmap) {
    if pad.is_empty() {
        return;
    }
    let grid = pad.grid();
    let buckets = Buckets::new(branches, HEAD_MM);
    let mut tips: Vec<([i64; 2], [f64; 2], f64)> = Vec::new();
    for cell in pad.cells() {
        let at = grid.middle_mm(cell);
        let holder = buckets.near(at).find(|&i| distance_mm(branches[i].at, at) <= HEAD_MM - grid.cell_mm());
        if let Some(holder) = holder {
            branches[holder].head = 0;
            continue;
        }
        let square = at.map(|mm| (mm / TIPS_MM).floor() as i64);
        // Cells come row by row: the squares of the last rows are at the end.
        match tips.iter_mut().rev().find(|tip| tip.0 == square) {
            Some((_, sum, count)) => {
                *sum = [sum[0] + at[0], sum[1] + at[1]];
                *count += 1.0;
            }
            None => tips.push((square, at, 1.0)),
        }
    }
    for (_, sum, count) in tips {
        let id = trunks.len();
        trunks.push(id);
        branches.push(Branch { id, at: sum.map(|mm| mm / count), goal: None, depth: 0, head: 0 });
    }
}

/// Sets the goal of each branch: its nearest neighbour, if the two can meet above the bed.
fn look_around(branches: &mut [Branch], meet_mm: f64) {
    let reach_mm = REACH_MM.min(meet_mm);
    let buckets = Buckets::new(branches, reach_mm);
    let goals: Vec<Option<[f64; 2]>> = (0..branches.len())
        .map(|i| {
            let at = branches[i].at;
            let others = buckets.near(at).filter(|&j| j != i).map(|j| (distance_mm(at, branches[j].at), j));
            let (far_mm, nearest) = others.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
            (far_mm <= reach_mm).then_some(branches[nearest].at)
        })
        .collect();
    branches.iter_mut().zip(goals).for_each(|(branch, goal)| branch.goal = goal);
}

/// Branches by squares of the plane, to find those near a position: made anew for every layer, so only sorted.
struct Buckets {
    side_mm: f64,
    /// Square and branch, sorted.
    entries: Vec<([i64; 2], usize)>,
}

impl Buckets {
    /// Finds everything within `side_mm`.
    fn new(branches: &[Branch], side_mm: f64) -> Self {
        let side_mm = side_mm.max(0.1);
        let square = |at: [f64; 2]| at.map(|mm| (mm / side_mm).floor() as i64);
        let mut entries: Vec<_> = branches.iter().enumerate().map(|(i, b)| (square(b.at), i)).collect();
        entries.sort_unstable();
        Self { side_mm, entries }
    }

    fn near(&self, at: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let [x, y] = at.map(|mm| (mm / self.side_mm).floor() as i64);
        (x - 1..=x + 1).flat_map(move |x| {
            let from = self.entries.partition_point(|e| e.0 < [x, y - 1]);
            let to = self.entries.partition_point(|e| e.0 <= [x, y + 1]);
            self.entries[from..to].iter().map(|e| e.1)
        })
    }
}

/// The outline of discs, and of the heads among them, less `kept_free`; parts that hold no disc's middle are cut off
/// from their branch and left out.
pub fn outline(discs: &[Disc], kept_free: &Region) -> (Region, Region) {
    let circle = |disc: &Disc| {
        let corner = |k: usize| {
            let (sin, cos) = real::sin_cos(k as f64 / CORNERS as f64 * std::f64::consts::TAU);
            Point::from_mm(disc.at[0] + disc.radius_mm * cos, disc.at[1] + disc.radius_mm * sin)
        };
        Region::from(Polygon { outer: (0..CORNERS).map(corner).collect(), holes: Vec::new() })
    };
    let circles: Vec<Region> = discs.iter().map(circle).collect();
    let mut united = geometry::union_all(&circles).into_polygons();
    for polygon in &mut united {
        polygon.holes.retain(|hole| geometry::ring_area(hole).abs() > LEAST_HOLE_MM2);
    }
    let united = Region::disjoint(united);
    let mut all = geometry::difference(&united, kept_free);
    let middles: Vec<Point> = discs.iter().map(|disc| Point::from_mm(disc.at[0], disc.at[1])).collect();
    all.retain(|polygon| {
        let alone = Region::from(polygon.clone());
        let bounds = alone.bounds();
        middles.iter().any(|&p| bounds.is_some_and(|b| b.holds(p)) && alone.contains(p))
    });
    let heads = circles.iter().zip(discs).filter(|(_, disc)| disc.is_head).map(|(circle, _)| circle);
    let heads = if discs.iter().all(|disc| disc.is_head) { united } else { geometry::union_all(heads) };
    (all, heads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::support::bitmap::Grid;
    use geometry::Bounds;

    const HEIGHT_MM: f64 = 0.2;

    fn grid() -> Grid {
        Grid::new(Bounds { min: Point::from_mm(0.0, 0.0), max: Point::from_mm(40.0, 20.0) }, 0.0, 0.4)
    }

    fn cells(x0: f64, y0: f64, x1: f64, y1: f64) -> Bitmap {
        let outer = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point::from_mm(x, y)).to_vec();
        Bitmap::of(grid(), &Region::from(Polygon { outer, holes: Vec::new() }))
    }

    fn discs(solid: &[Bitmap], ceiling: Bitmap, from_bed_only: bool) -> Vec<Vec<Disc>> {
        let mut held = vec![Bitmap::empty(grid()); solid.len()];
        *held.last_mut().unwrap() = ceiling;
        let spec = ColumnSpec {
            gap_layers: vec![1; solid.len()],
            interface_layers: 2,
            gap_cells: 1,
            from_bed_only,
            height_mm: HEIGHT_MM,
        };
        grow(&held, &solid.iter().collect::<Vec<_>>(), &spec, &SupportSettings::default())
    }

    #[test]
    fn branches_merge_downwards() {
        let layers = discs(&vec![Bitmap::empty(grid()); 100], cells(10.0, 8.0, 24.0, 12.0), true);
        let (top, bottom) = (layers.iter().rev().find(|l| !l.is_empty()).unwrap(), &layers[0]);
        assert!(top.len() >= 8 && bottom.len() <= 2, "{} → {}", top.len(), bottom.len());
        assert!(bottom.iter().all(|disc| disc.radius_mm > 2.0));
    }

    #[test]
    fn no_branch_leans_more_than_it_may() {
        let layers = discs(&vec![Bitmap::empty(grid()); 60], cells(10.0, 8.0, 24.0, 12.0), false);
        let most_mm = HEIGHT_MM * SupportSettings::default().branch_angle.to_radians().tan() + 1e-9;
        for pair in layers[..58].windows(2) {
            for above in &pair[1] {
                let nearest = pair[0].iter().map(|b| distance_mm(b.at, above.at)).fold(f64::MAX, f64::min);
                assert!(nearest <= 2.0 * most_mm, "{nearest}");
            }
        }
    }

    #[test]
    fn branches_go_round_the_part_where_they_can() {
        let shelf = cells(8.0, 4.0, 20.0, 16.0);
        let solid: Vec<Bitmap> = (0..120)
            .map(|i| if (30..35).contains(&i) { shelf.clone() } else { Bitmap::empty(grid()) })
            .collect();
        let layers = discs(&solid, cells(17.0, 9.0, 19.0, 11.0), true);
        assert!(!layers[0].is_empty(), "it reaches the bed");
        for disc in &layers[32] {
            assert!(disc.at[0] - 20.0 >= 1.0, "{disc:?}");
        }
    }

    #[test]
    fn over_a_wide_floor_branches_stand_on_it_or_not_at_all() {
        let floor = cells(0.0, 0.0, 40.0, 20.0);
        let solid: Vec<Bitmap> =
            (0..60).map(|i| if i < 10 { floor.clone() } else { Bitmap::empty(grid()) }).collect();
        let ceiling = || cells(17.0, 9.0, 19.0, 11.0);
        let layers = discs(&solid, ceiling(), false);
        assert!(layers[..11].iter().all(Vec::is_empty) && !layers[11].is_empty(), "a layer apart");
        assert!(discs(&solid, ceiling(), true).iter().all(Vec::is_empty));
    }
}
