//! Extra perimeters on overhangs: what hangs over air without anchors at both of its sides is filled with beads along its
//! walls, which begin and end where the part is held.

use geometry::{Clipper, Join, KnownAxes, Point, Region};

use super::bead::Line;
use super::beading;
use super::beneath::Beneath;

/// Ends this near to a loop's first vertex are there: square of the distance in grid units.
const SAME: i64 = 4;

/// Beads along the walls around `inside`, as far as they are in `area`.
pub(super) fn fill(inside: &Region, area: &Region, spacing_mm: f64, axes: &KnownAxes) -> Vec<Line> {
    let clipper = Clipper::new(area);
    let mut rest = inside.clone();
    rest.retain(|polygon| {
        let island = Region::from(polygon.clone());
        !geometry::intersection(&island, area).is_empty()
    });
    let mut lines = Vec::new();
    while !geometry::intersection(&rest, area).is_empty() {
        let pair = beading::pair(&rest, spacing_mm, beading::FULL, beading::MIN_GAP_MM, Join::DEFAULT);
        lines.extend(pair.loops.iter().flat_map(|line| cut(line, &clipper)));
        if let Some(gap) = pair.gap {
            let (least_mm, most_mm) = (beading::MIN_GAP_MM, beading::WIDEST * spacing_mm);
            let tip = beading::GAP_TIP;
            let middles = geometry::medial_axis_in(&gap.area, &gap.region, least_mm, most_mm, tip, axes);
            for path in middles {
                let line = Line { points: path.points, spacing_mm: path.width_mm, closed: path.closed };
                lines.extend(cut(&line, &clipper));
            }
        }
        rest = pair.rest;
    }
    lines
}

/// Share of the lines' length that is not held: all of a line that neither begins nor ends over the layer beneath, half of
/// one of whose ends only one is held.
pub(super) fn loose(lines: &[Line], beneath: &Beneath<'_>) -> f64 {
    let (mut length_mm, mut loose_mm) = (0.0, 0.0);
    for line in lines {
        let own_mm = geometry::polyline_length_mm(&line.points);
        let held = match line.closed {
            true => 2 * usize::from(line.points.iter().any(|&p| beneath.holds(p))),
            false => [line.points.first(), line.points.last()]
                .into_iter()
                .flatten()
                .filter(|p| beneath.holds(**p))
                .count(),
        };
        length_mm += own_mm;
        loose_mm += own_mm * (2 - held) as f64 / 2.0;
    }
    if length_mm > 0.0 { loose_mm / length_mm } else { 1.0 }
}

/// The parts of a line in a region, with its spacings.
fn cut(line: &Line, clipper: &Clipper) -> Vec<Line> {
    let mut points = line.points.clone();
    if line.closed {
        points.extend(line.points.first());
    }
    let mut pieces: Vec<Vec<Point>> = clipper.clip(&points).into_iter().map(|piece| piece.points).collect();
    let near = |a: Option<&Point>, b: Option<&Point>| a.zip(b).is_some_and(|(a, b)| a.distance2(*b) <= SAME);
    let goes_on =
        line.closed && near(pieces.first().and_then(|p| p.first()), pieces.last().and_then(|p| p.last()));
    let is_whole = goes_on && pieces.len() == 1;
    if is_whole {
        pieces[0].pop();
    } else if goes_on && let (Some(mut last), Some(first)) = (pieces.pop(), pieces.first_mut()) {
        last.pop();
        last.append(first);
        *first = last;
    }
    let spaced = |points: Vec<Point>| {
        let spacing_mm = points.iter().filter_map(|&p| spacing_at(line, p)).collect();
        Line { points, spacing_mm, closed: is_whole }
    };
    pieces.into_iter().map(spaced).filter_map(Line::sound).collect()
}

/// Spacing of a line at a point of it; `None` where it is the nominal one throughout.
fn spacing_at(line: &Line, p: Point) -> Option<f32> {
    if line.spacing_mm.is_empty() {
        return None;
    }
    let count = line.points.len();
    let edges = if line.closed { count } else { count - 1 };
    let off_mm =
        |i: usize| geometry::to_segment_mm(p.mm(), line.points[i].mm(), line.points[(i + 1) % count].mm());
    let nearest = (0..edges).min_by(|&a, &b| off_mm(a).total_cmp(&off_mm(b)))?;
    let [a, b] = [nearest, (nearest + 1) % count];
    let length_mm = line.points[a].distance_mm(line.points[b]).max(f64::MIN_POSITIVE);
    let share = (line.points[a].distance_mm(p) / length_mm).clamp(0.0, 1.0) as f32;
    Some(line.spacing_mm[a] + (line.spacing_mm[b] - line.spacing_mm[a]) * share)
}
