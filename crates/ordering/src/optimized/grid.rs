//! A grid over the entries of one group, for many small searches: no entry ever goes, and few are near.

use super::super::entries::samples;
use super::super::{Problem, Shape};
use pathwright_geometry::{Bounds, Point};

/// Points per cell.
const PER_CELL: usize = 2;

/// A point in the grid.
#[derive(Clone, Copy, Debug)]
struct Site {
    point: Point,
    node: u32,
    /// Of a loop, the vertex; of an open path, the end.
    entry: u32,
    is_loop: bool,
}

/// Entries in square cells.
#[derive(Debug)]
pub struct Grid {
    origin: Point,
    cell: i64,
    columns: i64,
    rows: i64,
    /// The sites of cell c: `sites[first[c]..first[c + 1]]`.
    first: Vec<u32>,
    sites: Vec<Site>,
}

/// A node found by a search: its squared distance in square units, the node (of a loop, its even node), and its entry.
pub type Found = (i64, u32, u32);

impl Grid {
    /// Puts both ends of open paths and samples of loops into a grid. O(n).
    pub fn new(problem: &Problem, items: &[u32]) -> Self {
        let mut sites = Vec::with_capacity(2 * items.len());
        for &item in items {
            match problem.items[item as usize].shape {
                Shape::Open(ends) => {
                    let site = |(entry, point)| Site { point, node: 2 * item + entry, entry, is_loop: false };
                    sites.extend((0..).zip(ends).map(site));
                }
                Shape::Loop(vertices) => {
                    // Which loops are near is all that a search must tell; their vertices are chosen exactly elsewhere.
                    let site = |entry: u32| Site {
                        point: vertices[entry as usize],
                        node: 2 * item,
                        entry,
                        is_loop: true,
                    };
                    sites.extend(samples(vertices.len(), false).map(site));
                }
            }
        }
        let bounds = Bounds::of(sites.iter().map(|site| site.point)).unwrap_or_default();
        let [width, height] = bounds.size().map(|side| side + 1);
        let cells = (sites.len() / PER_CELL).max(1) as f64;
        // At most about twice as many cells as requested, however long and narrow the box is.
        let cell =
            (width as f64 * height as f64 / cells).sqrt().max(width.max(height) as f64 / cells).ceil() as i64;
        let (columns, rows) = (width / cell + 1, height / cell + 1);
        let mut grid = Self { origin: bounds.min, cell, columns, rows, first: Vec::new(), sites: Vec::new() };
        grid.fill(&sites);
        grid
    }

    /// Sorts sites by cell (counting sort).
    fn fill(&mut self, sites: &[Site]) {
        self.first = vec![0; (self.columns * self.rows) as usize + 1];
        let cells: Vec<u32> = sites
            .iter()
            .map(|site| {
                let (column, row) = self.cell_of(site.point);
                (row * self.columns + column) as u32
            })
            .collect();
        for &cell in &cells {
            self.first[cell as usize + 1] += 1;
        }
        for cell in 1..self.first.len() {
            self.first[cell] += self.first[cell - 1];
        }
        let mut next = self.first.clone();
        self.sites = sites.to_vec();
        for (site, &cell) in sites.iter().zip(&cells) {
            self.sites[next[cell as usize] as usize] = *site;
            next[cell as usize] += 1;
        }
    }

    /// Column and row of a point; outside the grid, too.
    fn cell_of(&self, p: Point) -> (i64, i64) {
        let (x, y) = (i64::from(p.x) - i64::from(self.origin.x), i64::from(p.y) - i64::from(self.origin.y));
        (x.div_euclid(self.cell), y.div_euclid(self.cell))
    }

    /// The nodes nearest to a point, nearest first; each loop once, `except` (an item) not at all. Squared distances compare in
    /// single precision.
    pub fn nearest<const K: usize>(&self, p: Point, except: u32) -> impl Iterator<Item = Found> {
        // Squared distance and site in one number, in the order of the distances: those of positive floats are those of their
        // bits. A new one goes in by exchanges without a jump: which of two is less is as good as random.
        let mut found = [u64::MAX; K];
        let site = |key: u64| self.sites.get(key as u32 as usize);
        self.search(p, &mut |index, new_site, distance2, worst| {
            if new_site.node / 2 == except {
                return worst;
            }
            let mut new = u64::from(distance2.to_bits()) << 32 | index as u64;
            // A loop has several sites of one node.
            let is_same = |&key: &u64| site(key).is_some_and(|site| site.node == new_site.node);
            if new_site.is_loop
                && let Some(at) = found.iter().position(is_same)
            {
                if found[at] <= new {
                    return worst;
                }
                found.copy_within(at + 1.., at);
                found[K - 1] = u64::MAX;
            }
            for other in &mut found {
                (*other, new) = ((*other).min(new), (*other).max(new));
            }
            if found[K - 1] == u64::MAX { worst } else { f32::from_bits((found[K - 1] >> 32) as u32) }
        });
        found.into_iter().map_while(site).map(move |site| (site.point.distance2(p), site.node, site.entry))
    }

    /// The nearest site whose node and entry are wanted. Ties go to the lowest node.
    pub fn nearest_wanted(&self, p: Point, wanted: impl Fn(u32, u32) -> bool) -> Option<Found> {
        let mut best: Option<Found> = None;
        self.search(p, &mut |_, site, distance2, worst| {
            let entry = (site.point.distance2(p), site.node, site.entry);
            if best.is_some_and(|best| best <= entry) || !wanted(site.node, site.entry) {
                return worst;
            }
            best = Some(entry);
            distance2
        });
        best
    }

    /// Shows sites to `visit`, cells in growing rings around a point: those not farther than the worst that is still of interest,
    /// which `visit` gets and returns as it is from then on.
    fn search(&self, p: Point, visit: &mut impl FnMut(usize, &Site, f32, f32) -> f32) {
        let (column, row) = self.cell_of(p);
        // Rings of cells from where they first meet the grid to where they have left it on all sides.
        let outside = |at: i64, cells: i64| (-at).max(at - (cells - 1)).max(0);
        let nearest = outside(column, self.columns).max(outside(row, self.rows));
        let farthest = column.max(self.columns - 1 - column).max(row).max(self.rows - 1 - row);
        let columns = |ring: i64| ((column - ring).max(0), (column + ring).min(self.columns - 1));
        let rows = |ring: i64| (row - ring).max(0)..=(row + ring).min(self.rows - 1);
        // Nearly always more than the point's own cell is of interest: the cells around it are looked at with it.
        let first = nearest.max(1);
        let (from, to) = columns(first);
        let mut worst = f32::INFINITY;
        for at in rows(first) {
            worst = self.scan(at, from, to, p, worst, visit);
        }
        // How far the sides of the point's own cell are.
        let west = i64::from(p.x) - i64::from(self.origin.x) - column * self.cell;
        let south = i64::from(p.y) - i64::from(self.origin.y) - row * self.cell;
        let [east, north] = [west, south].map(|side| self.cell - side);
        let closest = west.min(east).min(south).min(north);
        for ring in first + 1..=farthest {
            let inside = (ring - 1) * self.cell;
            let is_near = |side: i64, worst: f32| ((inside + side) as f32).powi(2) <= worst;
            if !is_near(closest, worst) {
                return;
            }
            let (from, to) = columns(ring);
            for (at, side) in [(row - ring, south), (row + ring, north)] {
                if is_near(side, worst) && (0..self.rows).contains(&at) {
                    worst = self.scan(at, from, to, p, worst, visit);
                }
            }
            for (at, side) in [(column - ring, west), (column + ring, east)] {
                if is_near(side, worst) && (0..self.columns).contains(&at) {
                    for row in rows(ring - 1) {
                        worst = self.scan(row, at, at, p, worst, visit);
                    }
                }
            }
        }
    }

    /// Looks at the cells of a row from one column to another.
    #[inline]
    fn scan(
        &self,
        row: i64,
        from: i64,
        to: i64,
        p: Point,
        mut worst: f32,
        visit: &mut impl FnMut(usize, &Site, f32, f32) -> f32,
    ) -> f32 {
        let base = row * self.columns;
        let sites =
            self.first[(base + from) as usize] as usize..self.first[(base + to) as usize + 1] as usize;
        for (index, site) in (sites.start..).zip(&self.sites[sites]) {
            let distance2 = site.point.distance2(p) as f32;
            if distance2 <= worst {
                worst = visit(index, site, distance2, worst);
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::super::{Item, Problem};
    use super::*;
    use crate::Scope;

    proptest! {
        #[test]
        fn the_grid_finds_what_looking_at_all_finds(
            ends in prop::collection::vec((-50..50i32, -9..9i32, -50..50i32, -9..9i32), 1..60),
            (x, y) in (-99..99i32, -99..99i32),
        ) {
            let shape = |&(a, b, c, d): &_| Shape::Open([Point::new(a, b), Point::new(c, d)]);
            let items: Vec<_> = ends.iter().map(|ends| Item { run: 0, shape: shape(ends) }).collect();
            let all: Vec<u32> = (0..items.len() as u32).collect();
            let problem = Problem { items, runs: Vec::new(), scope: Scope::Layer, start: None, end: None };
            let p = Point::new(x, y);
            let grid = Grid::new(&problem, &all);
            let found: Vec<i64> = grid.nearest::<5>(p, 3).map(|(distance2, ..)| distance2).collect();
            let nodes = (0..2 * all.len() as u32).filter(|node| node / 2 != 3);
            let mut expected: Vec<i64> = nodes
                .map(|node| problem.items[node as usize / 2].ends(node % 2).0.distance2(p))
                .collect();
            expected.sort_unstable();
            expected.truncate(5);
            prop_assert_eq!(found, expected);
        }
    }
}
