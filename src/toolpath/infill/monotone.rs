//! The order of the lines of monotonic surfaces: each comes after those before it that it lies against, and on both sides of a hole
//! the lines of one side come after those of the other, not by turns.

use geometry::{Direction, Point};

use super::super::bead::Line;
use super::solid::SolidPatch;

/// Lines one beside the other, of which each but the first lies against the one before alone, and is alone against it.
struct Stretch {
    patch: SolidPatch,
    /// So many others that its first line lies against are still to come.
    waits_for: usize,
    /// Those whose first line lies against its last.
    followers: Vec<usize>,
}

impl Stretch {
    /// The ends of its first line, and of its last.
    fn ends(&self) -> [[Point; 2]; 2] {
        let lines = &self.patch.lines;
        [&lines[0], &lines[lines.len() - 1]]
            .map(|(_, Line { points, .. })| [points[0], points[points.len() - 1]])
    }
}

/// From where to where a line lies along and across a direction, millimetres.
struct Span {
    along_mm: (f64, f64),
    across_mm: (f64, f64),
}

impl Span {
    fn of(points: &[Point], direction: Direction) -> Self {
        let along_mm = points.iter().map(|point| direction.along_mm(*point));
        let along_mm = along_mm.fold((f64::MAX, f64::MIN), |(low, high), mm| (low.min(mm), high.max(mm)));
        Self { along_mm, across_mm: direction.extent_mm(points) }
    }

    /// Whether it lies beside another with no room for a line between them, or reaches as far as that.
    fn is_against(&self, other: &Self, spacing_mm: f64) -> bool {
        let beside_mm = self.along_mm.0.max(other.along_mm.0) - self.along_mm.1.min(other.along_mm.1);
        beside_mm < spacing_mm && self.across_mm.0 - other.across_mm.1 < 1.5 * spacing_mm
    }
}

/// Orders the lines of patches, whose ends are not joined, in stretches: of those that wait for no other always the one is next that begins
/// nearest to where the last has ended. O(n²) of their number.
pub fn monotone(patches: Vec<SolidPatch>) -> Vec<SolidPatch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    for patch in patches {
        add_stretches(patch, &mut stretches);
    }
    let mut open: Vec<usize> = (0..stretches.len()).filter(|k| stretches[*k].waits_for == 0).collect();
    let mut order = Vec::with_capacity(stretches.len());
    let mut from: Option<[Point; 2]> = None;
    while !open.is_empty() {
        let distance_mm = |number: usize| {
            let [to, _] = stretches[number].ends();
            let pairs = from.into_iter().flatten().flat_map(|a| to.map(|b| (a, b)));
            pairs.map(|(a, b)| a.distance_mm(b)).fold(f64::INFINITY, f64::min)
        };
        let distances_mm = open.iter().map(|number| distance_mm(*number)).enumerate();
        let nearest = distances_mm.min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(place, _)| place);
        let number = open.remove(nearest);
        from = Some(stretches[number].ends()[1]);
        for next in std::mem::take(&mut stretches[number].followers) {
            stretches[next].waits_for -= 1;
            if stretches[next].waits_for == 0 {
                open.push(next);
            }
        }
        order.push(number);
    }
    let mut patches: Vec<Option<SolidPatch>> = stretches.into_iter().map(|own| Some(own.patch)).collect();
    order.into_iter().filter_map(|number| patches[number].take()).collect()
}

/// Takes a patch apart.
fn add_stretches(patch: SolidPatch, stretches: &mut Vec<Stretch>) {
    let SolidPatch { spacing_mm, direction, mut lines } = patch;
    let across_mm = |line: &Line| direction.extent_mm(&line.points).1;
    lines.sort_by(|(a, one), (b, other)| a.cmp(b).then(across_mm(one).total_cmp(&across_mm(other))));
    let spans: Vec<Span> = lines.iter().map(|(_, line)| Span::of(&line.points, direction)).collect();
    // A bead of fitting width that is part of a line reaches past others.
    let deepest_mm = spans.iter().map(|span| span.across_mm.1 - span.across_mm.0).fold(0.0, f64::max);
    let reach = (deepest_mm / spacing_mm).ceil() as u32 + 1;
    let (mut before, mut after) = (vec![Vec::new(); lines.len()], vec![0; lines.len()]);
    for number in 0..lines.len() {
        let own = lines[number].0;
        let near = (0..number).rev().take_while(|other| lines[*other].0 + reach >= own);
        before[number] = near.filter(|other| spans[number].is_against(&spans[*other], spacing_mm)).collect();
        before[number].iter().for_each(|other: &usize| after[*other] += 1);
    }
    let mut stretch_of = Vec::with_capacity(lines.len());
    for (number, (_, line)) in lines.into_iter().enumerate() {
        if let [one] = before[number][..]
            && after[one] == 1
        {
            let own: usize = stretch_of[one];
            let lines = &mut stretches[own].patch.lines;
            lines.push((lines.len() as u32, line));
            stretch_of.push(own);
            continue;
        }
        let own = stretches.len();
        before[number].iter().for_each(|other| stretches[stretch_of[*other]].followers.push(own));
        let patch = SolidPatch { spacing_mm, direction, lines: vec![(0, line)] };
        stretches.push(Stretch { patch, waits_for: before[number].len(), followers: Vec::new() });
        stretch_of.push(own);
    }
}
