//! Painted pieces of a section with round corners.

use geometry::{Join, Region, difference, intersection, offset, offset_with, union};

use super::piece::Piece;
use super::slivers;

const ROUND: Join = Join::Round { tolerance_mm: 0.01 };

/// What a corner gives away may have a corner in its new piece; so often all are rounded.
const ROUNDS: usize = 2;

/// Pieces reach so far beyond the section, in radii, that the outline is no corner of theirs.
const BEYOND: f64 = 2.5;

/// Rounds the corners that pieces have between each other: facets are painted, so that their borders go to and fro by less than
/// a bead can follow, and each corner leaves a void in every wall along it. Where a border meets the outline, it stays. What is
/// narrower than twice the radius goes to the pieces beside it.
pub(super) fn round(section: &Region, pieces: &mut Vec<Piece>, radius_mm: f64) {
    if pieces.len() < 2 {
        return;
    }
    for _ in 0..ROUNDS {
        let before: Vec<Region> = pieces.iter().map(|piece| piece.region.clone()).collect();
        for piece in pieces.iter_mut() {
            let outside = difference(&offset(&piece.region, BEYOND * radius_mm), section);
            let beyond = union(&piece.region, &slivers::across_cracks(&outside));
            let round = offset_with(&offset(&beyond, -radius_mm), radius_mm, ROUND);
            piece.region = intersection(&round, &piece.region);
        }
        slivers::share_out(section, &before, pieces);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{Point, Polygon};

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
        round(&section, &mut pieces, 0.225);
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
    fn a_stroke_as_wide_as_a_line_stays_and_a_narrower_one_goes() {
        let section = region(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]);
        for (width_mm, stays) in [(0.5, true), (0.4, false)] {
            let mut pieces = split(
                &section,
                &region(&[(5.0, -1.0), (5.0 + width_mm, -1.0), (5.0 + width_mm, 8.0), (5.0, 8.0)]),
            );
            round(&section, &mut pieces, 0.225);
            let stroke = pieces.iter().find(|piece| piece.tool == 1);
            let area_mm2 = stroke.map_or(0.0, |piece| piece.region.area_mm2());
            let expected_mm2 = if stays { 8.0 * width_mm } else { 0.0 };
            assert!((area_mm2 - expected_mm2).abs() < 0.1, "{width_mm} mm: {area_mm2} mm²");
        }
    }
}
