//! A uniform grid over the edges of a region, for "which edges are near this segment": the index for outlines that stay
//! as they are. Of points, `pathwright-ordering` has trees and a grid.

use std::ops::Range;
use std::sync::OnceLock;

use super::sort::sort;
use super::{Bounds, Point, Polygon, Region, UNITS_PER_MM, on_segment_mm, real};

/// How far beyond a segment its cells reach, in grid units: more than any rounding of its ends.
const SLACK: i64 = 2;

/// One edge of a region's boundary.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Start.
    pub a: Point,
    /// End.
    pub b: Point,
    /// Index of the ring in the order of [`Region::rings`].
    pub ring: u32,
    /// Index of the edge in its ring.
    pub index: u32,
}

impl Edge {
    fn bounds(&self) -> Bounds {
        Bounds::spanned(self.a, self.b)
    }
}

/// Boundary edges sorted into square cells. Building is O(edges) for edges of like length.
#[derive(Clone, Debug)]
pub struct EdgeGrid {
    edges: Vec<Edge>,
    bounds: Bounds,
    cell: i64,
    columns: i64,
    rows: i64,
    /// Where the items of each cell start.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Of every cell without edges whether it is inside, once a point was asked for.
    insides: OnceLock<Vec<bool>>,
}

impl EdgeGrid {
    /// Sorts the edges of a region into about as many cells as there are edges.
    pub fn new(region: &Region) -> Self {
        let mut edges = Vec::with_capacity(region.vertex_count());
        for (ring_index, ring) in region.rings().enumerate() {
            for (i, &a) in ring.iter().enumerate() {
                let b = ring[if i + 1 == ring.len() { 0 } else { i + 1 }];
                edges.push(Edge { a, b, ring: ring_index as u32, index: i as u32 });
            }
        }
        let bounds = region.bounds().unwrap_or_default();
        let [width, height] = bounds.size().map(|side| side + 1);
        let count = edges.len().max(1) as f64;
        // Neither more cells than edges in a compact region, nor in a long and thin one.
        let cell = ((width as f64 * height as f64 / count).sqrt() as i64)
            .max((width.max(height) as f64 / count) as i64)
            .max(1);
        let (columns, rows) = (width / cell + 1, height / cell + 1);
        let mut grid = Self {
            edges,
            bounds,
            cell,
            columns,
            rows,
            starts: vec![],
            items: vec![],
            insides: OnceLock::new(),
        };
        grid.fill();
        grid
    }

    /// The same of one polygon.
    pub fn of(polygon: &Polygon) -> Self {
        Self::new(&Region { polygons: vec![polygon.clone()] })
    }

    fn fill(&mut self) {
        // Cells side by side, and the edge in them.
        let mut spans: Vec<(Range<usize>, u32)> = Vec::with_capacity(2 * self.edges.len());
        for (edge, i) in self.edges.iter().zip(0..) {
            self.spans_along(edge.a, edge.b).for_each(|span| spans.push((span, i)));
        }
        let mut starts = vec![0_u32; (self.columns * self.rows) as usize + 1];
        for (span, _) in &spans {
            starts[span.start + 1..=span.end].iter_mut().for_each(|count| *count += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut items = vec![0; *starts.last().unwrap_or(&0) as usize];
        for (span, i) in spans {
            for next in &mut next[span] {
                items[*next as usize] = i;
                *next += 1;
            }
        }
        (self.starts, self.items) = (starts, items);
    }

    /// The edges.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The box around the region.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Indices, ascending and without repetition, of edges that share a cell with the segment: all that
    /// pass within one unit of it, and some more. They replace the contents of `found`.
    pub fn near_segment(&self, a: Point, b: Point, found: &mut Vec<u32>) {
        found.clear();
        self.spans_along(a, b).for_each(|span| found.extend_from_slice(self.items_in(span)));
        distinct(found);
    }

    /// Edges that share a cell with the segment, as [`Self::near_segment`] finds them, but in no order, and some several times.
    pub fn edges_along(&self, a: Point, b: Point) -> impl Iterator<Item = &Edge> {
        self.spans_along(a, b).flat_map(|span| self.items_in(span)).map(|&i| &self.edges[i as usize])
    }

    /// Indices, ascending and without repetition, of edges that share a cell with the box: all that come into it,
    /// and some more. They replace the contents of `found`.
    pub fn near_box(&self, bounds: Bounds, found: &mut Vec<u32>) {
        found.clear();
        self.rows_around(bounds).for_each(|items| found.extend_from_slice(items));
        distinct(found);
    }

    /// The edges whose boxes touch a box, in no order; an edge may come several times.
    pub fn edges_touching(&self, bounds: Bounds) -> impl Iterator<Item = &Edge> {
        let edges = self.rows_around(bounds).flatten().map(|&i| &self.edges[i as usize]);
        edges.filter(move |edge| edge.bounds().touches(&bounds))
    }

    /// The items of all cells that meet a box, row by row.
    fn rows_around(&self, bounds: Bounds) -> impl Iterator<Item = &[u32]> {
        let cell = |at: i32, origin: i32, cells: i64, slack: i64| {
            (i64::from(at) - i64::from(origin) + slack).div_euclid(self.cell).clamp(0, cells - 1)
        };
        let (min, origin) = (bounds.min, self.bounds.min);
        let left = cell(min.x, origin.x, self.columns, -SLACK);
        let right = cell(bounds.max.x, origin.x, self.columns, SLACK);
        let rows = cell(min.y, origin.y, self.rows, -SLACK)..=cell(bounds.max.y, origin.y, self.rows, SLACK);
        // The cells of a row lie side by side, and so do their items.
        rows.map(move |row| {
            let at = |column: i64| (row * self.columns + column) as usize;
            self.items_in(at(left)..at(right) + 1)
        })
    }

    /// The items of cells side by side.
    fn items_in(&self, cells: Range<usize>) -> &[u32] {
        &self.items[self.starts[cells.start] as usize..self.starts[cells.end] as usize]
    }

    /// Distance from a point to the nearest edge, in millimetres; more than `reach_mm` where that is more.
    pub fn distance_mm(&self, p: Point, reach_mm: f64) -> f64 {
        let area = Bounds::spanned(p, p).grown((reach_mm * UNITS_PER_MM).ceil() as i32);
        let p = p.mm();
        let mut least_mm2 = f64::INFINITY;
        for &i in self.rows_around(area).flatten() {
            let edge = &self.edges[i as usize];
            let [x, y] = on_segment_mm(p, edge.a.mm(), edge.b.mm());
            let (dx, dy) = (p[0] - x, p[1] - y);
            least_mm2 = real::lesser(dx * dx + dy * dy, least_mm2);
        }
        least_mm2.sqrt()
    }

    /// Whether the point is inside or on the boundary (even-odd over all rings). Looks at the cells between it and the nearest in
    /// its row that has no edges.
    pub fn contains(&self, p: Point) -> bool {
        if !self.bounds.holds(p) {
            return false;
        }
        let min = self.bounds.min;
        let cell_of = |at: i32, origin: i32| ((i64::from(at) - i64::from(origin)) / self.cell) as usize;
        let (column, columns) = (cell_of(p.x, min.x), self.columns as usize);
        let first = cell_of(p.y, min.y) * columns;
        let starts = &self.starts[first..=first + columns];
        let is_free = |column: usize| starts[column] == starts[column + 1];
        let is_inside = |column: usize| self.insides()[first + column];
        if is_free(column) {
            return is_inside(column);
        }
        // Beyond the first and the last cell of a row all is outside.
        let (mut left, mut right) = (column, column);
        let (to_left, inside) = loop {
            if left == 0 || is_free(left - 1) {
                break (true, left > 0 && is_inside(left - 1));
            }
            left -= 1;
            right += 1;
            if right == columns || is_free(right) {
                break (false, right < columns && is_inside(right));
            }
        };
        let between = if to_left { left..column + 1 } else { column..right };
        // Whether the number of edges that are passed on the way there is odd. One that is in the cell before, too, came already.
        let mut odd = false;
        let mut before: &[u32] = &[];
        for cell in between {
            let items = self.items_in(first + cell..first + cell + 1);
            for i in items {
                let Edge { a, b, .. } = self.edges[*i as usize];
                let up = a.y <= p.y;
                let crosses = up != (b.y <= p.y);
                if !crosses && a.y != p.y && b.y != p.y {
                    continue;
                }
                let side = (b - a).cross(p - a);
                if side == 0 && Bounds::spanned(a, b).holds(p) {
                    return true;
                }
                odd ^= crosses && (side < 0) == (up == to_left) && !before.contains(i);
            }
            before = items;
        }
        inside != odd
    }

    /// Of every cell without edges whether it is inside.
    fn insides(&self) -> &[bool] {
        self.insides.get_or_init(|| {
            let mut insides = vec![false; (self.columns * self.rows) as usize];
            // Where the boundary passes the middle of a row, from there on to the right the other holds.
            for &Edge { a, b, .. } in &self.edges {
                let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
                let [ax, ay] = [a.x, a.y].map(i64::from);
                let [x, y] = [i64::from(self.bounds.min.x), i64::from(self.bounds.min.y)];
                let slope = i64::from(b.x - a.x) as f64 / i64::from(b.y - a.y).max(1) as f64;
                let row_from =
                    |at: i32| (i64::from(at) - y + self.cell - self.cell / 2).div_euclid(self.cell);
                for row in row_from(a.y)..row_from(b.y) {
                    let middle = y + row * self.cell + self.cell / 2;
                    let column = (ax - x + (slope * (middle - ay) as f64) as i64) / self.cell;
                    insides[(row * self.columns + column.clamp(0, self.columns - 1)) as usize] ^= true;
                }
            }
            for row in insides.chunks_exact_mut(self.columns as usize) {
                let mut inside = false;
                for cell in row {
                    inside ^= *cell;
                    *cell = inside;
                }
            }
            insides
        })
    }

    /// All cells within [`SLACK`] of the segment: of every row those side by side.
    fn spans_along(&self, a: Point, b: Point) -> impl Iterator<Item = Range<usize>> + use<> {
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let (min_x, min_y) = (i64::from(self.bounds.min.x), i64::from(self.bounds.min.y));
        let (ax, ay) = (i64::from(a.x) - min_x, i64::from(a.y) - min_y);
        let (bx, by) = (i64::from(b.x) - min_x, i64::from(b.y) - min_y);
        let slope = if by > ay { (bx - ax) as f64 / (by - ay) as f64 } else { 0.0 };
        let at = move |y: i64| match y {
            y if y <= ay => ax,
            y if y >= by => bx,
            y => ax + (slope * (y - ay) as f64) as i64,
        };
        let (cell, columns) = (self.cell, self.columns);
        let first_row = (ay - SLACK).div_euclid(cell).max(0);
        let last_row = (by + SLACK).div_euclid(cell).min(self.rows - 1);
        (first_row..=last_row).filter_map(move |row| {
            let (low, high) = (row * cell - SLACK, (row + 1) * cell + SLACK);
            // A level segment is in one row at all its abscissae.
            let (enter, leave) = if low <= ay && by <= high { (ax, bx) } else { (at(low), at(high)) };
            let from = (enter.min(leave) - SLACK).div_euclid(cell).max(0);
            let to = (enter.max(leave) + SLACK).div_euclid(cell).min(columns - 1);
            let index = |column: i64| (row * columns + column) as usize;
            (from <= to).then(|| index(from)..index(to) + 1)
        })
    }
}

/// Sorts few numbers and leaves each once.
fn distinct(found: &mut Vec<u32>) {
    sort(found, |&number| number);
    found.dedup();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Polygon;

    #[test]
    fn every_edge_is_found_from_a_segment_through_its_middle() {
        let points = [(0, 0), (1_000_000, 3), (999_999, 70_000), (400_000, 50_000), (7, 90_000)];
        let outer = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let grid = EdgeGrid::new(&Region { polygons: vec![Polygon { outer, holes: vec![] }] });
        let mut found = Vec::new();
        for (i, edge) in grid.edges().iter().enumerate() {
            let middle = Point::new((edge.a.x + edge.b.x) / 2, (edge.a.y + edge.b.y) / 2);
            for by in [Point::new(0, 40), Point::new(40, 0), Point::new(-300_000, 200_000)] {
                grid.near_segment(middle - by, middle + by, &mut found);
                assert!(found.contains(&(i as u32)), "edge {i}");
            }
        }
    }
    #[test]
    fn points_are_inside_where_a_ray_from_them_meets_the_boundary_an_odd_number_of_times() {
        let mut random = crate::Random::new(3);
        for count in [3, 4, 7, 30, 200] {
            let mut number = |below: u32| random.below(below) as i32;
            let ring = |number: &mut dyn FnMut(u32) -> i32| -> Vec<Point> {
                // Few different ordinates, so that there are level edges and vertices at one height.
                (0..count).map(|_| Point::new(number(3000), 100 * number(20))).collect()
            };
            let rings = [ring(&mut number), ring(&mut number)];
            let polygons = rings.map(|outer| Polygon { outer, holes: vec![] });
            let region = Region { polygons: polygons.to_vec() };
            let grid = EdgeGrid::new(&region);
            let on =
                |p: Point, e: &Edge| (e.b - e.a).cross(p - e.a) == 0 && Bounds::spanned(e.a, e.b).holds(p);
            let passes = |p: Point, e: &Edge| {
                let up = e.a.y <= p.y;
                up != (e.b.y <= p.y) && ((e.b - e.a).cross(p - e.a) < 0) == up
            };
            for _ in 0..3000 {
                let y = if number(2) == 0 { 100 * number(20) } else { number(2000) };
                let p = Point::new(number(3000), y);
                let odd = grid.edges().iter().filter(|e| passes(p, e)).count() % 2 == 1;
                assert_eq!(grid.contains(p), odd || grid.edges().iter().any(|e| on(p, e)), "{p:?}");
            }
        }
    }
}
