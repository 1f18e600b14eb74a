//! No piece of a section is narrower than a line, unless the section is.

use geometry::{Polygon, Region, difference, intersection, offset, opening, union, union_all};

use super::piece::Piece;

/// Pieces touch where they come so near, mm.
const TOUCH_MM: f64 = 0.02;

/// What is within this share of a line of where a line has room belongs to it: corners.
const CORNERS: f64 = 0.75;

/// What is smaller is a dot and no bead, in line widths squared.
const DOT: f64 = 2.0;

/// What is narrower comes of rounding where edges do not meet exactly, mm.
const CRACK_MM: f64 = 1e-4;

/// Pieces that are to meet are no further apart, mm.
const APART_MM: f64 = 0.003;

/// So little may be between them, mm².
const LEFT_MM2: f64 = 1e-5;

/// Nothing that is larger is a crack, mm².
const CRACK_MM2: f64 = 0.05;

/// What is given away may cut off something else; so often it is looked at again.
const ROUNDS: usize = 4;

/// Gives what is narrower than a line to the piece that it touches most. Afterwards the pieces make up the section, and do not
/// overlap.
pub(super) fn give_away(section: &Region, pieces: &mut Vec<Piece>, line_mm: f64) {
    // Where the section is as narrow, a piece may be, too.
    let narrow = difference(section, &opening(section, line_mm / 2.0));
    let is_sound = |piece: &Piece| {
        let mut polygons = piece.region.polygons().iter();
        polygons.all(|polygon| has_room(&Region::from(polygon.clone()), &narrow, line_mm))
    };
    for _ in 0..ROUNDS {
        give_away_once(section, &narrow, pieces, line_mm);
        if pieces.iter().all(is_sound) {
            break;
        }
    }
    close(section, pieces);
    meet(section, pieces);
    drop_cracks(pieces);
}

/// Gives what is between pieces where their edges do not meet exactly to the first of those that it touches.
fn close(section: &Region, pieces: &mut [Piece]) {
    let all = union_all(pieces.iter().map(|piece| &piece.region));
    let mut left = intersection(&offset(&difference(section, &all), CRACK_MM), section);
    for number in 0..pieces.len() {
        if left.is_empty() {
            break;
        }
        // No more than that: what is taken from the others may cut them in two.
        let others = union_all(
            pieces.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, p)| &p.region),
        );
        let near = intersection(&left, &offset(&pieces[number].region, CRACK_MM));
        let own = difference(&near, &others);
        if !own.is_empty() {
            left = difference(&left, &own);
            pieces[number].region = union(&pieces[number].region, &own);
        }
    }
}

/// The same for what is narrower than offsets are exact, which [`close`] does not see.
fn meet(section: &Region, pieces: &mut [Piece]) {
    for number in 0..pieces.len() {
        let all = union_all(pieces.iter().map(|piece| &piece.region));
        if difference(section, &all).area_mm2() < LEFT_MM2 {
            break;
        }
        let others = union_all(
            pieces.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, p)| &p.region),
        );
        let grown = intersection(&offset(&pieces[number].region, APART_MM), section);
        pieces[number].region = union(&pieces[number].region, &difference(&grown, &others));
    }
}

fn give_away_once(section: &Region, narrow: &Region, pieces: &mut Vec<Piece>, line_mm: f64) {
    let wide = |region: &Region| {
        let roomy = offset(region, -line_mm / 2.0);
        if roomy.is_empty() { roomy } else { intersection(&offset(&roomy, line_mm * CORNERS), region) }
    };
    let kept = |piece: &Piece| match intersection(narrow, &piece.region) {
        thin if thin.is_empty() => wide(&piece.region),
        thin => union(&wide(&piece.region), &thin),
    };
    let before: Vec<Region> = pieces.iter().map(|piece| piece.region.clone()).collect();
    for piece in pieces.iter_mut() {
        let mut region = kept(piece);
        region.retain(|polygon| has_room(&Region::from(polygon.clone()), narrow, line_mm));
        piece.region = without_hanging(&region, narrow, line_mm);
    }
    share_out(section, &before, pieces);
}

/// A region without what hangs on the rest by a point only, and is too small by itself.
fn without_hanging(region: &Region, narrow: &Region, line_mm: f64) -> Region {
    let parts = offset(region, -CRACK_MM / 2.0);
    let parts = parts.polygons().iter().map(|part| Region::from(part.clone()));
    let small: Vec<Region> = parts.filter(|part| !has_room(part, narrow, line_mm)).collect();
    match small.is_empty() {
        true => region.clone(),
        false => difference(region, &across_cracks(&union_all(&small))),
    }
}

/// Gives what of a section no piece has to the piece that it touches most, or touched most `before`.
pub(super) fn share_out(section: &Region, before: &[Region], pieces: &mut Vec<Piece>) {
    let left = pieces.iter().fold(section.clone(), |left, piece| difference(&left, &piece.region));
    for sliver in left.polygons().iter().filter(|polygon| !is_crack(polygon)) {
        let sliver = Region::from(sliver.clone());
        let most = |within_mm: f64, of: &mut dyn Iterator<Item = &Region>| {
            let near = offset(&sliver, within_mm);
            let areas = of.map(|region| intersection(&near, region).area_mm2()).enumerate();
            areas.filter(|(_, area)| *area > 0.0).max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
        };
        // Those that it meets come first: beside another it would be a piece of its own.
        let touched = [CRACK_MM, TOUCH_MM]
            .into_iter()
            .find_map(|within_mm| most(within_mm, &mut pieces.iter().map(|piece| &piece.region)));
        let Some((number, _)) = touched.or_else(|| most(TOUCH_MM, &mut before.iter())) else { continue };
        // Across cracks, so that it is one with its piece.
        let grown = intersection(&across_cracks(&sliver), section);
        for (other, piece) in pieces.iter_mut().enumerate() {
            piece.region = match other == number {
                true => union(&piece.region, &grown),
                false => difference(&piece.region, &grown),
            };
        }
    }
    drop_cracks(pieces);
}

/// A region grown over cracks beside it.
pub(super) fn across_cracks(region: &Region) -> Region {
    offset(region, CRACK_MM)
}

fn drop_cracks(pieces: &mut Vec<Piece>) {
    for piece in pieces.iter_mut() {
        piece.region.retain(|polygon| !is_crack(polygon));
    }
    pieces.retain(|piece| !piece.region.is_empty());
}

fn is_crack(polygon: &Polygon) -> bool {
    polygon.area_mm2() < CRACK_MM2 && offset(&Region::from(polygon.clone()), -CRACK_MM / 2.0).is_empty()
}

/// Whether a line that is no dot has room in a region, or the section is narrow there.
fn has_room(region: &Region, narrow: &Region, line_mm: f64) -> bool {
    let is_dot = region.area_mm2() < DOT * line_mm * line_mm;
    !is_dot && !offset(region, -line_mm / 2.0).is_empty()
        || intersection(region, narrow).area_mm2() > line_mm * line_mm
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::toolpath::ToolId;
    use geometry::Point;
    use proptest::prelude::*;
    use proptest::test_runner::TestCaseError;

    /// What rounding may lose, or have twice, mm².
    const LOST_MM2: f64 = 1e-3;

    /// Pieces make up the section, do not overlap, and a line has room in each, unless the section is as narrow there.
    pub(in super::super) fn is_sound(
        section: &Region,
        pieces: &[Piece],
        line_mm: f64,
    ) -> Result<(), TestCaseError> {
        let all = union_all(pieces.iter().map(|piece| &piece.region));
        let lost = difference(section, &all).area_mm2() + difference(&all, section).area_mm2();
        prop_assert!(lost < LOST_MM2, "{lost} mm² lost or too much");
        let sum: f64 = pieces.iter().map(|piece| piece.region.area_mm2()).sum();
        prop_assert!((sum - all.area_mm2()).abs() < LOST_MM2, "{} mm² twice", sum - all.area_mm2());
        let narrow = difference(section, &opening(section, line_mm / 2.0));
        for piece in pieces {
            for polygon in piece.region.polygons() {
                let polygon = Region::from(polygon.clone());
                let room = !offset(&polygon, -0.45 * line_mm).is_empty();
                prop_assert!(
                    room || !intersection(&polygon, &narrow).is_empty(),
                    "tool {}: a sliver of {} mm²: {polygon:?}",
                    piece.tool,
                    polygon.area_mm2()
                );
            }
        }
        Ok(())
    }

    fn ring(corners: &[(f64, f64)]) -> Region {
        let outer = corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect();
        Region::from(Polygon { outer, holes: Vec::new() })
    }

    fn rectangle(low: (f64, f64), high: (f64, f64)) -> Region {
        ring(&[low, (high.0, low.1), high, (low.0, high.1)])
    }

    /// The section in pieces, each taking what it covers from those before.
    fn pieces(section: &Region, covers: &[Region]) -> Vec<Piece> {
        let mut left = section.clone();
        let mut pieces = Vec::new();
        for (tool, cover) in
            covers.iter().enumerate().rev().map(|(number, cover)| (number as ToolId + 1, cover))
        {
            pieces.push(Piece { tool, style: None, region: intersection(&left, cover) });
            left = difference(&left, cover);
        }
        pieces.push(Piece { tool: 0, style: None, region: left });
        pieces
    }

    #[test]
    fn a_strip_goes_to_the_piece_beside_it_and_a_rib_keeps_its_own() {
        let section = union(&rectangle((0.0, 0.0), (10.0, 10.0)), &rectangle((10.0, 5.0), (20.0, 5.4)));
        let covers = [rectangle((0.0, 0.0), (5.0, 10.0)), rectangle((9.8, 0.0), (30.0, 10.0))];
        let mut all = pieces(&section, &covers);
        give_away(&section, &mut all, 0.45);
        let area_mm2 = |tool| all.iter().filter(|p| p.tool == tool).map(|p| p.region.area_mm2()).sum::<f64>();
        assert!((area_mm2(1) - 50.0).abs() < 1e-6, "{}", area_mm2(1));
        assert!((area_mm2(2) - 4.0).abs() < 0.2, "the rib, and not the strip: {}", area_mm2(2));
        assert!((area_mm2(0) - 50.0).abs() < 0.2, "{}", area_mm2(0));
    }

    #[test]
    fn a_speck_where_a_section_crosses_itself_is_no_piece() {
        let corners = [
            (3.1551395720648068, 5.891476653332324),
            (-7.5567807487363945, 1.177055890934446),
            (3.3726504384997367, 5.086910731474174),
            (-5.9398957992515165, -8.417796001512473),
            (-8.590080384387335, 9.013767658893142),
        ];
        let section = geometry::unite_rings(&[corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()]);
        let (low, high) = ((-9.51933682873797, 1.2662254609027863), (-5.358345437, 11.167546781));
        let mut all = pieces(&section, &[rectangle(low, high)]);
        give_away(&section, &mut all, 0.45);
        is_sound(&section, &all, 0.45).unwrap();
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn pieces_of_bodies_that_overlap_make_up_the_section(
            boxes in proptest::collection::vec(
                ((-12.0..12.0f64, -12.0..12.0f64), (0.05..12.0f64, 0.05..12.0f64)),
                1..7,
            ),
            corners in proptest::collection::vec((-10.0..10.0f64, -10.0..10.0f64), 3..9),
        ) {
            let section = geometry::unite_rings(&[corners.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()]);
            let covers: Vec<Region> =
                boxes.iter().map(|&((x, y), (w, d))| rectangle((x, y), (x + w, y + d))).collect();
            let mut all = pieces(&section, &covers);
            give_away(&section, &mut all, 0.45);
            is_sound(&section, &all, 0.45)?;
        }
    }
}
