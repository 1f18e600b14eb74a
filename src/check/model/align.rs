//! Where on the bed bodies were printed.
//!
//! First all of them together, as their files place them; then each by itself, as often as it is there: loops of the print
//! are set beside those of its sections, and where many of equal size agree on a shift, the walls have to lie there.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::evidence::PrintedLayer;
use super::levels::Levels;
use super::sections::{Sections, along};
use super::survey::{Extent, Survey};
use crate::mesh::{Mesh, quarter_turned};
use crate::profile::Settings;
use geometry::{EdgeGrid, Point, Region};

/// At a position at least this share of the beads lies in the sections.
const FOUND: f64 = 0.6;
/// Or this share, where all outlines are there.
const PART: f64 = 0.05;
/// This many do where nothing else needs to be looked for.
const SURE: f64 = 0.95;
/// At least this share of a body's outline has walls where it is.
const OUTLINED: f64 = 0.7;
/// And at least this share of all outlines together, of which some may be missing.
const SEEN: f64 = 0.3;
/// Loops differ in size by at most this.
const ALIKE_MM: f64 = 0.4;
/// Shifts that differ by less are one.
const SAME_MM: f64 = 0.25;
/// This many shifts are tried for a body.
const TRIED: usize = 100;
/// Islands smaller than this say little.
const SPECK_MM2: f64 = 0.5;

/// A body at its position.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub body: usize,
    /// Turned counter-clockwise by quarters about its own zero.
    pub quarters: u32,
    /// Where its own zero is.
    pub at_mm: [f64; 2],
}

/// The positions of all bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    pub placed: Vec<Placed>,
    /// Height at which they begin.
    pub bottom_mm: f64,
    /// Bodies that are nowhere, or fewer times than they are given.
    pub lost: Vec<usize>,
}

/// A body's sections in the layers that are looked at.
struct Shape {
    must: Vec<Region>,
    may: Vec<Region>,
}

/// A position where bodies of a kind may be.
struct Candidate {
    kind: usize,
    quarters: u32,
    at_mm: [f64; 2],
    /// Of its outline on which walls lie.
    share: f64,
    shape: Rc<Shape>,
}

/// How well bodies at their positions and a print fit.
struct Fit {
    /// The share of beads that lie in the bodies.
    inside: f64,
    /// The share of the bodies' outlines on which walls lie.
    outlined: f64,
}

impl Fit {
    fn worst(&self) -> f64 {
        self.inside.min(self.outlined)
    }

    /// Most of the print is explained, or a part of it without a doubt: there may be other models in it.
    fn is_enough(&self) -> bool {
        self.inside >= FOUND && self.outlined >= SEEN || self.inside >= PART && self.outlined >= SURE
    }
}

/// What is searched in.
pub(super) struct Search<'a> {
    pub bodies: &'a [(String, Mesh)],
    pub survey: &'a Survey,
    pub levels: &'a Levels,
    pub shown: &'a [PrintedLayer],
    pub settings: &'a Settings,
}

impl Search<'_> {
    /// Looks for the bodies; what explains most of the beads is taken. `None`: nothing explains them.
    pub fn run(&self) -> Option<Found> {
        let mut best: Option<(Fit, Found)> = None;
        let mut offer = |(fit, found): (Fit, Found)| {
            let sure = fit.worst() >= SURE && found.lost.is_empty();
            if best.as_ref().is_none_or(|(most, _)| fit.worst() > most.worst()) {
                best = Some((fit, found));
            }
            sure
        };
        for &bottom_mm in self.levels.bottoms_mm() {
            if offer(self.together(bottom_mm)) || [1, 4].iter().any(|&q| offer(self.one_by_one(bottom_mm, q)))
            {
                break;
            }
        }
        best.filter(|(fit, _)| fit.is_enough()).map(|(_, found)| found)
    }

    /// All bodies as their files place them.
    fn together(&self, bottom_mm: f64) -> (Fit, Found) {
        let sections = Sections::new(
            self.bodies.iter().map(|(_, mesh)| (mesh, vec![Point::default()])),
            self.levels,
            bottom_mm,
            self.settings,
        );
        let layers: Vec<(Region, Region)> =
            self.shown.iter().map(|layer| sections.layer(layer.level)).collect();
        let boxes = self.bodies.iter().map(|(_, mesh)| mesh.bounds());
        let joined = boxes.reduce(|[low, high], [min, max]| {
            [[0, 1, 2].map(|i| low[i].min(min[i])), [0, 1, 2].map(|i| high[i].max(max[i]))]
        });
        let [low, high] = joined.unwrap_or_default();
        let middle = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
        let to = |point: [f64; 2]| [point[0] - middle[0], point[1] - middle[1]];
        let extents = self.survey.extents().into_iter().flatten().map(|extent| to(extent.middle()));
        let mut candidates: Vec<[f64; 2]> =
            extents.chain([to(self.settings.bed.middle_mm()), [0.0; 2]]).collect();
        let outlines: Vec<&Region> = layers.iter().map(|(must, _)| must).collect();
        candidates.extend(self.shifts(&outlines).into_iter().take(8));
        let grids: Vec<EdgeGrid> = layers.iter().map(|(_, may)| EdgeGrid::new(may)).collect();
        let share = |shift: [f64; 2]| {
            self.share(|layer, p| grids[layer].contains(p - Point::from_mm(shift[0], shift[1])))
        };
        let shares: Vec<f64> = candidates.iter().map(|&shift| share(shift)).collect();
        let best = (0..candidates.len()).rev().max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0);
        let at_mm = candidates[best];
        let placed = |body| Placed { body, quarters: 0, at_mm };
        let placed = (0..self.bodies.len()).map(placed).collect();
        let must: Vec<Region> = layers.into_iter().map(|(must, _)| must).collect();
        let nothing: Vec<Vec<Region>> = self.shown.iter().map(|_| Vec::new()).collect();
        // Where no walls are printed, nothing shows outlines.
        let outlined = match self.survey.has_edges() {
            true => self.outlined(&must, Point::from_mm(at_mm[0], at_mm[1]), &nothing),
            false => Some(1.0),
        };
        // Nor where all is thinner than two beads: what the beads say has to do.
        (
            Fit { inside: shares[best], outlined: outlined.unwrap_or(shares[best]) },
            Found { placed, bottom_mm, lost: Vec::new() },
        )
    }

    /// The share of the print's beads for which this holds.
    fn share(&self, holds: impl Fn(usize, Point) -> bool) -> f64 {
        let points = self.shown.iter().enumerate();
        let points = points.flat_map(|(layer, shown)| shown.points.iter().map(move |&p| (layer, p)));
        let (mut all, mut held) = (0_usize, 0_usize);
        for (layer, p) in points {
            all += 1;
            held += usize::from(holds(layer, p));
        }
        held as f64 / all.max(1) as f64
    }

    /// Shifts on which loops of the print and of sections agree, those with most votes first.
    fn shifts(&self, outlines: &[&Region]) -> Vec<[f64; 2]> {
        let mut votes: BTreeMap<[i64; 2], (usize, [f64; 2])> = BTreeMap::new();
        for (shown, outline) in self.shown.iter().zip(outlines) {
            for island in outline.polygons().iter().filter(|island| island.area_mm2() > SPECK_MM2) {
                let mut extent = None;
                island.outer.iter().for_each(|p| Extent::add(&mut extent, [p.mm()[0], p.mm()[1], 0.0]));
                let Some(own) = extent else { continue };
                let size = |e: &Extent| [0, 1].map(|i| e.high[i] - e.low[i]);
                let alike =
                    |other: &&Extent| (0..2).all(|i| (size(other)[i] - size(&own)[i]).abs() < ALIKE_MM);
                for other in shown.loops.iter().filter(alike) {
                    let shift = [0, 1].map(|i| other.middle()[i] - own.middle()[i]);
                    let bucket = shift.map(|mm| (mm / SAME_MM).round() as i64);
                    let (count, sum) = votes.entry(bucket).or_default();
                    *count += 1;
                    *sum = [sum[0] + shift[0], sum[1] + shift[1]];
                }
            }
        }
        let mut votes: Vec<(usize, [f64; 2])> = votes.into_values().collect();
        votes.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
        votes.into_iter().take(TRIED).map(|(count, sum)| sum.map(|mm| mm / count as f64)).collect()
    }

    /// Each body by itself, as often as it is there, turned by less than this many quarters: where its walls fit best comes
    /// first.
    fn one_by_one(&self, bottom_mm: f64, quarters: u32) -> (Fit, Found) {
        let kinds = self.kinds();
        let nothing: Vec<Vec<Region>> = self.shown.iter().map(|_| Vec::new()).collect();
        let mut candidates: Vec<Candidate> = Vec::new();
        for (kind, bodies) in kinds.iter().enumerate() {
            for quarters in 0..quarters {
                let mesh = self.bodies[bodies[0]].1.clone().quarter_turned(quarters);
                let one = [(&mesh, vec![Point::default()])];
                let sections = Sections::new(one, self.levels, bottom_mm, self.settings);
                let layers = self.shown.iter().map(|layer| sections.layer(layer.level));
                let (must, may): (Vec<Region>, Vec<Region>) = layers.unzip();
                let outlines: Vec<&Region> = must.iter().collect();
                let shape = Rc::new(Shape { must: must.clone(), may });
                for at_mm in self.shifts(&outlines) {
                    let share = self.outlined(&must, Point::from_mm(at_mm[0], at_mm[1]), &nothing);
                    if let Some(share) = share.filter(|share| *share >= OUTLINED) {
                        candidates.push(Candidate { kind, quarters, at_mm, share, shape: shape.clone() });
                    }
                }
            }
        }
        let area = |kind: usize| {
            let [x, y, _] = self.bodies[kinds[kind][0]].1.size();
            x * y
        };
        candidates.sort_by(|a, b| {
            let of_size = || area(b.kind).total_cmp(&area(a.kind));
            b.share.total_cmp(&a.share).then_with(of_size).then(a.quarters.cmp(&b.quarters))
        });
        let mut found = Found { bottom_mm, ..Found::default() };
        let mut explained: Vec<Vec<bool>> =
            self.shown.iter().map(|layer| vec![false; layer.points.len()]).collect();
        let mut taken = nothing;
        let mut counts = vec![0_usize; kinds.len()];
        for Candidate { kind, quarters, at_mm, shape, .. } in candidates {
            let by = Point::from_mm(at_mm[0], at_mm[1]);
            if self.outlined(&shape.must, by, &taken).is_none_or(|share| share < OUTLINED) {
                continue;
            }
            // Bodies of one kind are distinguished by their order alone.
            let body = kinds[kind].get(counts[kind]).copied().unwrap_or(kinds[kind][0]);
            counts[kind] += 1;
            let [own, other] = [kinds[kind][0], body].map(|body| self.middle(body, quarters));
            let at_mm = [0, 1].map(|i| at_mm[i] + own[i] - other[i]);
            found.placed.push(Placed { body, quarters, at_mm });
            for (layer, may) in shape.may.iter().enumerate() {
                let moved = may.translated(by);
                let grid = EdgeGrid::new(&moved);
                for (p, done) in self.shown[layer].points.iter().zip(&mut explained[layer]) {
                    *done |= grid.contains(*p);
                }
                taken[layer].push(moved);
            }
        }
        for (kind, bodies) in kinds.iter().enumerate() {
            for &body in bodies.iter().skip(counts[kind]) {
                // Of nearly equal kinds one may have been taken for the other.
                let spare = |placed: &Placed| {
                    let other = kinds.iter().position(|bodies| bodies.contains(&placed.body));
                    other.is_some_and(|other| counts[other] > kinds[other].len())
                        && near_alike(&self.bodies[placed.body].1, &self.bodies[body].1)
                };
                let Some(index) = found.placed.iter().position(spare) else {
                    found.lost.push(body);
                    continue;
                };
                let placed = &mut found.placed[index];
                if let Some(other) = kinds.iter().position(|bodies| bodies.contains(&placed.body)) {
                    counts[other] -= 1;
                }
                let [from, to] = [placed.body, body].map(|body| self.middle(body, placed.quarters));
                placed.at_mm = [0, 1].map(|i| placed.at_mm[i] + from[i] - to[i]);
                placed.body = body;
            }
        }
        found.placed.sort_by_key(|placed| placed.body);
        found.lost.sort_unstable();
        let all: usize = explained.iter().map(Vec::len).sum();
        let done = explained.iter().flatten().filter(|done| **done).count();
        let inside = done as f64 / all.max(1) as f64;
        (Fit { inside, outlined: if found.placed.is_empty() { 0.0 } else { 1.0 } }, found)
    }

    /// The middle of a body's box, turned by quarters.
    fn middle(&self, body: usize, quarters: u32) -> [f64; 2] {
        let [low, high] = self.bodies[body].1.bounds();
        let [x, y] = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
        quarter_turned([x, y], quarters)
    }

    /// Bodies that are the same but for their positions.
    fn kinds(&self) -> Vec<Vec<usize>> {
        let mut kinds: Vec<Vec<usize>> = Vec::new();
        for body in 0..self.bodies.len() {
            let same = |kind: &&mut Vec<usize>| alike(&self.bodies[kind[0]].1, &self.bodies[body].1);
            match kinds.iter_mut().find(same) {
                Some(kind) => kind.push(body),
                None => kinds.push(vec![body]),
            }
        }
        kinds
    }

    /// The share of a body's outline, moved, on which walls lie that belong to no other body. `None`: it has none.
    fn outlined(&self, outlines: &[Region], by: Point, taken: &[Vec<Region>]) -> Option<f64> {
        let (mut seen, mut on_walls) = (0_usize, 0_usize);
        for (layer, (shown, outline)) in self.shown.iter().zip(outlines).enumerate() {
            for p in outline.rings().flat_map(along) {
                let p = p + by;
                seen += 1;
                let free = !taken[layer].iter().any(|region| region.contains(p));
                on_walls += usize::from(free && shown.has_wall(p));
            }
        }
        (seen > 0).then(|| on_walls as f64 / seen as f64)
    }
}

/// Whether two bodies are the same but for their positions.
fn alike(a: &Mesh, b: &Mesh) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() < 1e-3 + 1e-4 * a.abs();
    a.triangles().len() == b.triangles().len()
        && (0..3).all(|i| close(a.size()[i], b.size()[i]))
        && close(a.volume_and_area().0, b.volume_and_area().0)
}

/// Whether two bodies differ by less than can be measured in a print.
fn near_alike(a: &Mesh, b: &Mesh) -> bool {
    (0..3).all(|i| (a.size()[i] - b.size()[i]).abs() < ALIKE_MM)
}
