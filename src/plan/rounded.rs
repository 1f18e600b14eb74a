//! Painted pieces of a section with round corners.

use geometry::{Join, Region, difference, intersection, offset, offset_with, union};

use super::piece::Piece;
use super::slivers;

const ROUND: Join = Join::Round { tolerance_mm: 0.01 };

/// What a corner gives away may have a corner in its new piece; so often all are rounded.
const ROUNDS: usize = 2;

/// Pieces reach so far beyond the section, in radii, that the outline is no corner of theirs.
const BEYOND: f64 = 2.5;

/// How round corners are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Radii {
    /// What is narrower than twice this goes to the pieces beside it, mm.
    pub narrow_mm: f64,
    /// The radius of corners, mm.
    pub corner_mm: f64,
    /// What corners of that radius would take away stays if it is larger, mm²: it is a stroke …
    pub stroke_mm2: f64,
    /// … or, where nothing is left beside it, a dot.
    pub dot_mm2: f64,
}

/// Rounds the corners that pieces have between each other: facets are painted, so that their borders go to and fro by less than
/// a bead can follow, and each corner leaves a void in every wall along it. Where a border meets the outline, it stays.
pub(super) fn round(section: &Region, pieces: &mut Vec<Piece>, radii: Radii) {
    if pieces.len() < 2 {
        return;
    }
    for _ in 0..ROUNDS {
        let before: Vec<Region> = pieces.iter().map(|piece| piece.region.clone()).collect();
        for piece in pieces.iter_mut() {
            let outside = difference(&offset(&piece.region, BEYOND * radii.corner_mm), section);
            let beyond = union(&piece.region, &slivers::across_cracks(&outside));
            piece.region = intersection(&rounded(&beyond, radii), &piece.region);
        }
        slivers::share_out(section, &before, pieces);
    }
}

fn rounded(region: &Region, radii: Radii) -> Region {
    let Radii { narrow_mm, corner_mm, stroke_mm2, dot_mm2 } = radii;
    let opened = |radius_mm: f64| offset_with(&offset(region, -radius_mm), radius_mm, ROUND);
    let round = opened(corner_mm);
    let mut strokes = difference(&opened(narrow_mm), &round);
    strokes.retain(|polygon| {
        let area_mm2 = polygon.area_mm2();
        let is_apart =
            || intersection(&slivers::across_cracks(&Region::from(polygon.clone())), &round).is_empty();
        area_mm2 > stroke_mm2 || area_mm2 > dot_mm2 && is_apart()
    });
    if strokes.is_empty() { round } else { union(&round, &slivers::across_cracks(&strokes)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Point, Polygon};

    const RADII: Radii = Radii { narrow_mm: 0.225, corner_mm: 0.45, stroke_mm2: 0.8, dot_mm2: 0.4 };

    fn region(corners: &[(f64, f64)]) -> Region {
        let outer = corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    fn split(section: &Region, cover: &Region) -> Vec<Piece> {
        let of = |tool, region| Piece { tool, style: None, region };
        vec![of(0, difference(section, cover)), of(1, intersection(section, cover))]
    }

    #[test]
    fn a_border_that_goes_to_and_fro_runs_straight_and_ends_where_it_did() {
        let section = region(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        // Teeth of 0.4 mm, 0.5 mm apart.
        let teeth = (0..=80).map(|k| (10.0 + 0.4 * f64::from(k % 2), 0.25 * f64::from(k)));
        let corners: Vec<(f64, f64)> = [(0.0, 20.0), (0.0, 0.0)].into_iter().chain(teeth).collect();
        let mut pieces = split(&section, &region(&corners));
        let length_mm =
            |piece: &Piece| piece.region.rings().map(|ring| geometry::ring_length_mm(ring)).sum::<f64>();
        let area_mm2 = pieces[1].region.area_mm2();
        assert!(length_mm(&pieces[1]) > 77.0, "{}", length_mm(&pieces[1]));
        round(&section, &mut pieces, RADII);
        assert!(length_mm(&pieces[1]) < 62.0, "{}", length_mm(&pieces[1]));
        assert!(
            (pieces[1].region.area_mm2() - area_mm2).abs() < 20.0 * 0.2,
            "the border moves by half a tooth at most"
        );
        for (tool, x_mm) in [(1, 9.9), (0, 10.5)] {
            for y_mm in [0.02, 19.98] {
                assert!(
                    pieces[tool].region.contains(Point::from_mm(x_mm, y_mm)),
                    "tool {tool} at {x_mm}, {y_mm}"
                );
            }
        }
    }

    #[test]
    fn a_corner_between_pieces_is_as_round_as_asked_and_one_at_the_outline_stays() {
        let section = region(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        let mut pieces = split(&section, &region(&[(-1.0, -1.0), (8.0, -1.0), (8.0, 8.0), (-1.0, 8.0)]));
        round(&section, &mut pieces, RADII);
        let corner_mm2 = 0.45 * 0.45 * (1.0 - std::f64::consts::FRAC_PI_4);
        let area_mm2 = pieces[1].region.area_mm2();
        assert!((area_mm2 - (64.0 - corner_mm2)).abs() < 0.02, "{area_mm2}");
        assert!(pieces[1].region.contains(Point::from_mm(7.99, 0.01)));
    }

    #[test]
    fn a_stroke_as_wide_as_a_line_stays_and_a_narrower_one_goes() {
        let section = region(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        for (width_mm, stays) in [(0.5, true), (0.4, false)] {
            let mut pieces = split(
                &section,
                &region(&[(5.0, -1.0), (5.0 + width_mm, -1.0), (5.0 + width_mm, 8.0), (5.0, 8.0)]),
            );
            round(&section, &mut pieces, RADII);
            let stroke = pieces.iter().find(|piece| piece.tool == 1);
            let area_mm2 = stroke.map_or(0.0, |piece| piece.region.area_mm2());
            let expected_mm2 = if stays { 8.0 * width_mm } else { 0.0 };
            assert!((area_mm2 - expected_mm2).abs() < 0.1, "{width_mm} mm: {area_mm2} mm²");
        }
    }
}
