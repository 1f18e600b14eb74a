//! Offsets and booleans against an independent implementation (Clipper 2), on random regions.

use std::collections::BTreeSet;

use clipper2_rust::{
    EndType, FillRule, JoinType, Path64, Paths64, Point64, area_paths, difference_64, inflate_paths_64,
    intersect_64, union_subjects_64, xor_64,
};
use pathwright::geometry::{
    Join, Point, Polygon, Region, Ring, UNITS_PER_MM, close_between, closing, difference, intersection,
    offset, offset_with, opening, remainder, ring_area, ring_length_mm, simplify, split, union, union_all,
    unite_rings,
};
use proptest::prelude::*;

const UNITS2: f64 = UNITS_PER_MM * UNITS_PER_MM;

fn paths(region: &Region) -> Paths64 {
    region.rings().map(|ring| path(ring)).collect()
}

fn path(ring: &[Point]) -> Path64 {
    ring.iter().map(|p| Point64::new(i64::from(p.x), i64::from(p.y))).collect()
}

fn area_mm2(paths: &Paths64) -> f64 {
    area_paths(paths) / UNITS2
}

fn xor_mm2(a: &Paths64, b: &Paths64) -> f64 {
    area_mm2(&xor_64(a, b, FillRule::NonZero))
}

fn outside_mm2(a: &Region, b: &Region) -> f64 {
    area_mm2(&difference_64(&paths(a), &paths(b), FillRule::NonZero))
}

/// Sampled area where a round offset is wrong, by the distance from the boundary: the referee where two
/// implementations disagree.
fn wrong_mm2(region: &Region, by_mm: f64, moved: &Region) -> f64 {
    let edges: Vec<[Point; 2]> =
        region.rings().flat_map(|r| (0..r.len()).map(move |i| [r[i], r[(i + 1) % r.len()]])).collect();
    let distance_mm = |p: Point| {
        let to_edge = |[a, b]: &[Point; 2]| {
            let (d, e) = (*b - *a, p - *a);
            let t = (e.dot(d) as f64 / d.dot(d).max(1) as f64).clamp(0.0, 1.0);
            let (x, y) = (f64::from(e.x) - t * f64::from(d.x), f64::from(e.y) - t * f64::from(d.y));
            x.hypot(y) / UNITS_PER_MM
        };
        edges.iter().map(to_edge).fold(f64::INFINITY, f64::min)
    };
    let step_mm = 0.1;
    let Some(bounds) = region.bounds() else { return 0.0 };
    let steps =
        |low: i32, high: i32| ((f64::from(high - low) / UNITS_PER_MM + 2.0 * by_mm.abs()) / step_mm) as i32;
    let mut wrong = 0;
    for i in 0..steps(bounds.min.x, bounds.max.x) {
        for j in 0..steps(bounds.min.y, bounds.max.y) {
            let shift = |k: i32| f64::from(k) * step_mm - by_mm.abs();
            let p = bounds.min + Point::from_mm(shift(i), shift(j));
            let signed = if region.contains(p) { -distance_mm(p) } else { distance_mm(p) };
            let clear = (signed - by_mm).abs() > 0.01;
            wrong += i32::from(clear && moved.contains(p) != (signed < by_mm));
        }
    }
    f64::from(wrong) * step_mm * step_mm
}

/// Sampled points that one of the two holds and the other does not: the referee where the oracle, which errs
/// once in some thousand cases with many edges through one point, disagrees. Points within two units of the grid of
/// an edge may fall to either side and do not count.
fn disputed_points(ours: &Region, holds: impl Fn(Point) -> bool) -> usize {
    let differs = |p: Point| ours.contains(p) != holds(p);
    let around = [(0, 0), (2, 0), (-2, 0), (0, 2), (0, -2)].map(|(x, y)| Point::new(x, y));
    let lattice =
        |i: i32| Point::from_mm(f64::from(i % 700) * 0.1011 - 20.0, f64::from(i / 700) * 0.1013 - 20.0);
    (0..490_000).map(lattice).filter(|&p| around.iter().all(|&step| differs(p + step))).count()
}

fn perimeter_mm(region: &Region) -> f64 {
    region.rings().map(|ring| ring_length_mm(ring)).sum()
}

/// Outer rings are positive, holes negative, nothing degenerate.
fn is_clean(region: &Region) -> bool {
    region.polygons().iter().all(|p| {
        ring_area(&p.outer) > 0.0
            && p.holes.iter().all(|h| ring_area(h) < 0.0)
            && p.rings()
                .all(|ring| ring.len() > 2 && (0..ring.len()).all(|i| ring[i] != ring[(i + 1) % ring.len()]))
    })
}

/// What a hole takes out.
fn turned(hole: &Ring) -> Region {
    polygon(hole.iter().rev().copied().collect(), vec![])
}

fn polar(center: (f64, f64), radii: &[f64]) -> Ring {
    let n = radii.len() as f64;
    let at = |(i, r): (usize, &f64)| {
        let angle = i as f64 / n * std::f64::consts::TAU;
        Point::from_mm(center.0 + r * angle.cos(), center.1 + r * angle.sin())
    };
    radii.iter().enumerate().map(at).collect()
}

fn star() -> impl Strategy<Value = Region> {
    prop::collection::vec(0.5..12.0_f64, 3..60).prop_map(|radii| unite_rings(&[polar((0.0, 0.0), &radii)]))
}

/// A smooth blob with many vertices, as curved walls give.
fn blob() -> impl Strategy<Value = Region> {
    (100_usize..600, prop::collection::vec((-1.0..1.0_f64, 0.0..6.0_f64), 2..8)).prop_map(|(n, waves)| {
        let radius = |i: usize| {
            let angle = i as f64 / n as f64 * std::f64::consts::TAU;
            let waves = waves.iter().enumerate();
            (8.0 + waves.map(|(k, (a, phase))| a * ((k + 1) as f64 * angle + phase).sin()).sum::<f64>())
                .max(0.3)
        };
        unite_rings(&[polar((3.0, -7.0), &(0..n).map(radius).collect::<Vec<_>>())])
    })
}

fn comb() -> impl Strategy<Value = Region> {
    prop::collection::vec((0.01..6.0_f64, 0.005..1.5_f64, 0.005..1.5_f64), 2..20).prop_map(|teeth| {
        let mut ring = vec![(0.0, -1.0), (0.0, 0.0)];
        let mut x = 0.0;
        for (height, tooth, gap) in teeth {
            ring.extend([(x, height), (x + tooth, height), (x + tooth, 0.0), (x + tooth + gap, 0.0)]);
            x += tooth + gap;
        }
        ring.push((x, -1.0));
        let ring: Ring = ring.into_iter().map(|(x, y)| Point::from_mm(x, y)).collect();
        unite_rings(&[ring])
    })
}

/// Shells in shells, not all of them apart.
fn nested() -> impl Strategy<Value = Region> {
    let ring = |low: f64, high: f64| prop::collection::vec(low..high, 3..30);
    (ring(8.0, 12.0), ring(5.0, 7.0), ring(0.5, 4.0), ring(0.1, 1.0), 0.0..9.0_f64).prop_map(
        |(a, b, c, d, x)| {
            let solid = |radii: &[f64], x: f64| unite_rings(&[polar((x, 0.5), radii)]);
            let frame = difference(&solid(&a, 0.0), &solid(&b, 0.0));
            difference(&union(&frame, &solid(&c, 0.3)), &solid(&d, x))
        },
    )
}

/// Arbitrary overlapping triangles on a coarse lattice: touching vertices, slivers, collinear edges.
fn lattice() -> impl Strategy<Value = Region> {
    prop::collection::vec((0..12_i32, 0..12_i32), 3..40).prop_map(|points| {
        let rings: Vec<Ring> = points
            .chunks_exact(3)
            .map(|t| t.iter().map(|&(x, y)| Point::from_mm(f64::from(x), f64::from(y))).collect())
            .collect();
        unite_rings(&rings)
    })
}

fn any_region() -> impl Strategy<Value = Region> {
    prop_oneof![star(), blob(), comb(), nested(), lattice()].prop_filter("empty", |r| !r.is_empty())
}

/// Without the parts narrower than 2.5 µm, which an offset may take for nothing.
fn solid_region() -> impl Strategy<Value = Region> {
    any_region().prop_map(|region| simplify(&region, 0.0025)).prop_filter("empty", |r| !r.is_empty())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn an_inset_lies_inside_and_is_smaller(region in any_region(), by_mm in 0.001..2.0_f64) {
        let inset = offset(&region, -by_mm);
        prop_assert!(is_clean(&inset));
        prop_assert!(outside_mm2(&inset, &region) <= 1e-6);
        prop_assert!(inset.area_mm2() < region.area_mm2());
    }

    #[test]
    fn a_grown_region_covers_its_input(region in any_region(), by_mm in 0.001..2.0_f64) {
        let grown = offset(&region, by_mm);
        prop_assert!(is_clean(&grown));
        prop_assert!(outside_mm2(&region, &grown) <= 1e-6);
        prop_assert!(grown.area_mm2() > region.area_mm2());
    }

    #[test]
    fn round_offsets_agree_with_the_oracle(region in solid_region(), by_mm in -2.0..2.0_f64) {
        let ours = offset_with(&region, by_mm, Join::Round { tolerance_mm: 0.002 });
        let theirs = inflate_paths_64(
            &paths(&region), (by_mm * UNITS_PER_MM).round(), JoinType::Round, EndType::Polygon, 2.0, 200.0,
        );
        let slack = 0.008 * (perimeter_mm(&region) + perimeter_mm(&ours)) + 0.01;
        let xor = xor_mm2(&paths(&ours), &theirs);
        if xor >= slack {
            let wrong = wrong_mm2(&region, by_mm, &ours);
            prop_assert!(wrong < slack, "differ by {xor} mm², wrong {wrong}, allowed {slack}");
        }
    }

    #[test]
    fn mitred_offsets_agree_with_the_oracle(region in solid_region(), by_mm in -2.0..2.0_f64) {
        let ours = offset(&region, by_mm);
        let theirs = inflate_paths_64(
            &paths(&region), (by_mm * UNITS_PER_MM).round(), JoinType::Miter, EndType::Polygon, 2.0, 200.0,
        );
        // A corner of just 60° may be mitred by one and cut by the other.
        let slack = 0.008 * (perimeter_mm(&region) + perimeter_mm(&ours)) + 0.01 + 0.6 * by_mm * by_mm;
        let xor = xor_mm2(&paths(&ours), &theirs);
        prop_assert!(xor < slack, "differ by {xor} mm², allowed {slack}");
    }

    #[test]
    fn booleans_agree_with_the_oracle(a in any_region(), b in any_region()) {
        let (pa, pb) = (paths(&a), paths(&b));
        let both = intersect_64(&pa, &pb, FillRule::NonZero);
        let slack = 1e-5 * (perimeter_mm(&a) + perimeter_mm(&b)) + 1e-6;
        let ours = intersection(&a, &b);
        if xor_mm2(&paths(&ours), &both) >= slack {
            prop_assert_eq!(disputed_points(&ours, |p| a.contains(p) && b.contains(p)), 0);
            return Ok(());
        }
        prop_assert!((union(&a, &b).area_mm2() - (a.area_mm2() + b.area_mm2() - area_mm2(&both))).abs() < slack);
        prop_assert!((difference(&a, &b).area_mm2() - (a.area_mm2() - area_mm2(&both))).abs() < slack);
        prop_assert!((union_all([&a, &b, &a]).area_mm2() - union(&a, &b).area_mm2()).abs() < slack);
        prop_assert_eq!(split(&a, &b), (ours, difference(&a, &b)));
    }

    /// Zones of a layer: what an opening leaves is taken out, and the thin rest is what is searched for.
    #[test]
    fn a_part_that_shares_its_boundary_with_the_region_leaves_only_the_rest(
        region in any_region(),
        radius_mm in 0.1..0.8_f64,
    ) {
        let part = opening(&region, radius_mm);
        let rest = remainder(&region, &part);
        prop_assert!(is_clean(&rest));
        let slack = 1e-5 * perimeter_mm(&region) + 1e-6;
        prop_assert!(intersection(&rest, &part).area_mm2() < slack);
        // 5 µm along the part's boundary may be missing, corners included.
        let missing = region.area_mm2() - union(&part, &rest).area_mm2();
        prop_assert!(missing < 0.008 * (perimeter_mm(&part) + 1.0), "{missing} mm²");
        prop_assert!(outside_mm2(&rest, &region) < slack);
    }

    /// Wherever outlines cross, each hole that arises belongs to the polygon around it.
    #[test]
    fn holes_lie_in_their_polygons(a in any_region(), b in any_region()) {
        let held = |p: &Polygon| {
            let outer = polygon(p.outer.clone(), vec![]);
            p.holes.iter().all(|hole| outside_mm2(&turned(hole), &outer) < 1e-5)
        };
        for ours in [intersection(&a, &b), difference(&a, &b), union(&a, &b)] {
            prop_assert!(is_clean(&ours) && ours.polygons().iter().all(held));
        }
    }

    /// Neighbouring layers on a slope: outlines inside each other, that touch nowhere.
    #[test]
    fn booleans_of_nested_regions_agree_with_areas(a in any_region(), by_mm in 0.01..0.5_f64) {
        let b = offset(&a, -by_mm);
        let rim = a.area_mm2() - b.area_mm2();
        let slack = 1e-5 * perimeter_mm(&a) + 1e-6;
        prop_assert!((intersection(&a, &b).area_mm2() - b.area_mm2()).abs() < slack);
        prop_assert!((union(&b, &a).area_mm2() - a.area_mm2()).abs() < slack);
        prop_assert!((difference(&a, &b).area_mm2() - rim).abs() < slack);
        prop_assert!(difference(&b, &a).area_mm2() < slack);
        prop_assert!(is_clean(&difference(&a, &b)));
    }

    #[test]
    fn united_rings_agree_with_the_oracle(seeds in prop::collection::vec((0..40_i32, 0..40_i32, 3..9_usize, 1..12_i32, any::<bool>()), 1..12)) {
        let rings: Vec<Ring> = seeds.iter().map(|&(x, y, n, r, turn)| {
            let mut ring = polar((f64::from(x), f64::from(y)), &vec![f64::from(r); n]);
            if turn {
                ring.reverse();
            }
            ring
        }).collect();
        let ours = unite_rings(&rings);
        let theirs = union_subjects_64(&rings.iter().map(|ring| path(ring)).collect(), FillRule::NonZero);
        prop_assert!(is_clean(&ours));
        // Either may round a corner by a unit of the grid.
        if xor_mm2(&paths(&ours), &theirs) >= 2e-5 * perimeter_mm(&ours) + 1e-6 {
            prop_assert_eq!(disputed_points(&ours, |p| in_any(&rings, p)), 0);
        }
    }

    #[test]
    fn simplifying_moves_the_boundary_by_the_tolerance_at_most(region in any_region(), tol_mm in 0.001..0.1_f64) {
        let slim = simplify(&region, tol_mm);
        prop_assert!(is_clean(&slim));
        // Where polygons touch, they are cut anew.
        let places: BTreeSet<&Point> = region.rings().flat_map(|ring| ring.iter()).collect();
        let touching = region.vertex_count() - places.len();
        prop_assert!(
            slim.vertex_count() <= region.vertex_count() + touching
                || slim.polygons().len() != region.polygons().len()
        );
        let grown = offset_with(&region, 1.1 * tol_mm + 0.001, Join::Round { tolerance_mm: 0.0005 });
        prop_assert!(outside_mm2(&slim, &grown) < 1e-4);
    }

    #[test]
    fn opening_and_closing_bracket_the_region(region in any_region(), radius_mm in 0.05..0.5_f64) {
        let slack = 0.006 * perimeter_mm(&region) + 0.5 * radius_mm * radius_mm * region.vertex_count() as f64;
        prop_assert!(opening(&region, radius_mm).area_mm2() <= region.area_mm2() + slack);
        prop_assert!(closing(&region, radius_mm).area_mm2() >= region.area_mm2() - slack);
    }

    #[test]
    fn closing_between_fills_what_closing_fills_and_leaves_lonely_polygons_as_they_are(
        region in any_region(),
        radius_mm in 0.02..0.5_f64,
    ) {
        let closed = close_between(&region, radius_mm);
        let slack_mm2 = 0.006 * perimeter_mm(&region);
        prop_assert!(difference(&region, &closed).area_mm2() <= slack_mm2);
        prop_assert!(difference(&closed, &closing(&region, radius_mm)).area_mm2() <= slack_mm2);
        if let [polygon] = region.polygons() {
            prop_assert_eq!(closed.polygons(), std::slice::from_ref(polygon));
        }
    }

    #[test]
    fn three_insets_add_no_vertices(region in blob()) {
        let mut inset = region.clone();
        for _ in 0..3 {
            inset = offset(&inset, -0.45);
        }
        prop_assert!(inset.vertex_count() <= region.vertex_count() + 8);
    }
}

/// By nonzero winding, for rings that each go round once.
fn in_any(rings: &[Ring], p: Point) -> bool {
    let solid =
        |ring: &Ring| Region::from(pathwright::geometry::Polygon { outer: ring.clone(), holes: vec![] });
    let winding =
        |ring: &Ring| i32::from(solid(ring).contains(p)) * if ring_area(ring) < 0.0 { -1 } else { 1 };
    rings.iter().map(winding).sum::<i32>() != 0
}

/// The tip of the triangle lies on an edge of the square: what the three enclose stays empty. The oracle
/// fills it.
#[test]
fn a_void_that_closes_in_one_point_stays() {
    let rings: Vec<Ring> = [(26, 38, 4, 5), (14, 34, 7, 9), (15, 35, 3, 9)]
        .map(|(x, y, n, r)| polar((f64::from(x), f64::from(y)), &vec![f64::from(r); n]))
        .to_vec();
    let united = unite_rings(&rings);
    assert!(!united.contains(Point::from_mm(22.3, 36.5)));
    assert_eq!(disputed_points(&united, |p| in_any(&rings, p)), 0);
}

fn ring(points: &[(i32, i32)]) -> Ring {
    points.iter().map(|&(x, y)| Point::new(x, y)).collect()
}

fn polygon(outer: Ring, holes: Vec<Ring>) -> Region {
    Region::from(pathwright::geometry::Polygon { outer, holes })
}

#[test]
fn clockwise_outers_are_taken_as_outers() {
    let square = polygon(ring(&[(0, 0), (0, 1_000_000), (1_000_000, 1_000_000), (1_000_000, 0)]), vec![]);
    assert!((offset(&square, -1.0).area_mm2() - 64.0).abs() < 1e-9);
    assert!((offset(&square, 1.0).area_mm2() - 144.0).abs() < 1e-9);
}

#[test]
fn a_wall_thinner_than_the_distance_vanishes_with_its_hole() {
    let outer = ring(&[(0, 0), (1_000_000, 0), (1_000_000, 1_000_000), (0, 1_000_000)]);
    let hole = ring(&[(100_000, 100_000), (100_000, 900_000), (900_000, 900_000), (900_000, 100_000)]);
    let frame = polygon(outer, vec![hole]);
    assert!((offset(&frame, -0.49).area_mm2() - (9.02_f64.powi(2) - 8.98_f64.powi(2))).abs() < 1e-9);
    assert!(offset(&frame, -0.5).is_empty());
    assert!(offset(&frame, -0.7).is_empty());
    assert_eq!(offset(&frame, 5.0).polygons()[0].holes.len(), 0);
}

#[test]
fn an_island_swallowed_by_its_frame_is_one_area() {
    let square = |low: i32, high: i32| ring(&[(low, low), (high, low), (high, high), (low, high)]);
    let mut hole = square(100_000, 900_000);
    hole.reverse();
    let mut region = polygon(square(0, 1_000_000), vec![hole]);
    region.add_disjoint(polygon(square(300_000, 700_000), vec![]).into_polygons());
    assert_eq!(offset(&region, 0.5).polygons().len(), 2);
    let solid = offset(&region, 3.0);
    assert_eq!(solid.polygons().len(), 1);
    assert!((solid.area_mm2() - 256.0).abs() < 1e-6);
}

#[test]
fn points_one_unit_apart_and_collinear_ones_do_no_harm() {
    let outer = [
        (0, 0),
        (1, 0),
        (2, 0),
        (500_000, 0),
        (500_000, 1),
        (500_000, 500_000),
        (499_999, 500_000),
        (0, 500_000),
        (0, 499_999),
    ];
    let inset = offset(&polygon(ring(&outer), vec![]), -1.0);
    assert_eq!(inset.vertex_count(), 4);
    assert!((inset.area_mm2() - 9.0).abs() < 1e-4);
}

#[test]
fn ten_metres_do_not_overflow() {
    let far = 1_000_000_000;
    let region = polygon(ring(&[(-far, -far), (far, -far), (far, far), (-far, far)]), vec![]);
    for by_mm in [-1.0, 1.0, 600.0, -5_000.0, 5_000.0, f64::NAN, f64::INFINITY] {
        let moved = offset(&region, by_mm);
        if by_mm.is_finite() {
            assert_eq!(moved.area_mm2() > region.area_mm2(), by_mm > 0.0);
        }
    }
    let inset = offset(&region, -1.0);
    assert_eq!(intersection(&region, &inset).area_mm2(), inset.area_mm2());
}

#[test]
fn tiny_regions_vanish_or_grow() {
    let speck = polygon(ring(&[(0, 0), (2000, 0), (2000, 2000), (0, 2000)]), vec![]);
    assert!(offset(&speck, -0.0101).is_empty());
    assert!((offset(&speck, 0.5).area_mm2() - 1.02_f64.powi(2)).abs() < 1e-6);
}

#[test]
fn degenerate_rings_are_dropped() {
    for outer in
        [vec![], ring(&[(5, 5)]), ring(&[(0, 0), (100_000, 0)]), ring(&[(0, 0), (9, 9), (0, 0), (9, 9)])]
    {
        let region = polygon(outer, vec![ring(&[])]);
        assert!(offset(&region, -0.1).is_empty());
        let _ = (offset(&region, 0.1), simplify(&region, 0.01), union_all([&region, &region]));
        let _ =
            (intersection(&region, &region), difference(&region, &region), region.contains(Point::new(1, 1)));
    }
}
