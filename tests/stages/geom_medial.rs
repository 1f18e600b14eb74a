//! Medial axes of shapes whose axes are known.

use std::f64::consts::TAU;

use pathwright::geometry::{
    EdgeGrid, KnownAxes, MedialPath, Point, Region, Ring, UNITS_PER_MM, difference, medial_axis,
    medial_axis_in, offset, opening, unite_rings,
};
use proptest::prelude::*;

fn ring(points: &[(f64, f64)]) -> Ring {
    points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
}

fn turned(points: &[(f64, f64)], angle: f64) -> Region {
    let (sin, cos) = angle.sin_cos();
    unite_rings(&[points
        .iter()
        .map(|&(x, y)| Point::from_mm(x * cos - y * sin, x * sin + y * cos))
        .collect()])
}

fn circle(radius: f64, n: usize) -> Ring {
    let at = |i: usize| i as f64 / n as f64 * TAU;
    (0..n).map(|i| Point::from_mm(radius * at(i).cos(), radius * at(i).sin())).collect()
}

fn covered_mm2(paths: &[MedialPath]) -> f64 {
    paths.iter().map(MedialPath::area_mm2).sum()
}

fn assert_inside(region: &Region, paths: &[MedialPath]) {
    for p in paths.iter().flat_map(|path| &path.points) {
        assert!(region.contains(*p), "{p:?} is outside");
    }
}

fn assert_covers(region: &Region, paths: &[MedialPath], share: f64) {
    assert_inside(region, paths);
    let (covered, area) = (covered_mm2(paths), region.area_mm2());
    assert!((covered / area - 1.0).abs() <= share, "{covered} of {area} mm²: {paths:?}");
}

#[test]
fn a_strip_has_one_centred_line() {
    for width in [0.1, 0.3, 0.6, 0.9] {
        for angle in [0.0, 0.3, 0.785, 1.5] {
            let h = width / 2.0;
            let strip = turned(&[(0.0, -h), (20.0, -h), (20.0, h), (0.0, h)], angle);
            let paths = medial_axis(&strip, 0.05, 1.0, 0.5);
            assert_eq!(paths.len(), 1, "{width} {angle}: {paths:?}");
            let length = paths[0].length_mm();
            assert!((19.9 - width..=20.0 - 0.5 * width).contains(&length), "{width} {angle}: {length}");
            assert!(
                paths[0].width_mm.iter().all(|w| (f64::from(*w) - width).abs() < 0.1 * width),
                "{paths:?}"
            );
            let off_axis = |p: &Point| (p.mm()[1] * angle.cos() - p.mm()[0] * angle.sin()).abs();
            let worst = paths[0].points.iter().map(off_axis).fold(0.0, f64::max);
            assert!(worst < 0.05 * width, "{width} {angle}: {worst}");
            assert_covers(&strip, &paths, 0.05);
        }
    }
}

#[test]
fn a_narrow_annulus_is_one_loop() {
    let annulus = difference(&unite_rings(&[circle(5.25, 120)]), &unite_rings(&[circle(4.75, 90)]));
    let paths = medial_axis(&annulus, 0.1, 1.0, 0.5);
    assert_eq!(paths.len(), 1);
    assert!(paths[0].closed);
    assert!((paths[0].length_mm() - 5.0 * TAU).abs() < 0.1, "{}", paths[0].length_mm());
    assert_covers(&annulus, &paths, 0.02);
}

#[test]
fn a_tee_is_a_bar_and_a_stem() {
    let tee = [
        (-5.0, 0.0),
        (-0.25, 0.0),
        (-0.25, -6.0),
        (0.25, -6.0),
        (0.25, 0.0),
        (5.0, 0.0),
        (5.0, 0.5),
        (-5.0, 0.5),
    ];
    for angle in [0.0, 0.5] {
        let tee = turned(&tee, angle);
        let paths = medial_axis(&tee, 0.1, 1.0, 0.5);
        let mut lengths: Vec<f64> = paths.iter().map(MedialPath::length_mm).collect();
        lengths.sort_by(f64::total_cmp);
        assert_eq!(lengths.len(), 2, "{paths:?}");
        assert!((lengths[1] - 9.5).abs() < 0.3 && (5.5..6.3).contains(&lengths[0]), "{lengths:?}");
        assert_covers(&tee, &paths, 0.05);
    }
}

#[test]
fn a_stem_ends_at_the_side_of_the_bar_and_does_not_turn_before() {
    // Beside the middle of the bar, so that nothing is symmetric.
    let bar = ring(&[(-7.0, 0.0), (4.0, 0.0), (4.0, 0.6), (-7.0, 0.6)]);
    let stem = ring(&[(-0.3, -5.0), (0.3, -5.0), (0.3, 0.1), (-0.3, 0.1)]);
    let paths = medial_axis(&unite_rings(&[bar, stem]), 0.1, 1.0, 0.5);
    let stems = paths.iter().filter(|path| path.points.iter().any(|p| p.mm()[1] < -1.0));
    let [stem] = stems.collect::<Vec<_>>()[..] else { panic!("{paths:?}") };
    let top = stem.points.iter().map(|p| p.mm()[1]).fold(f64::MIN, f64::max);
    assert!((-0.1..0.05).contains(&top), "it ends at {top} mm: {stem:?}");
    assert!(stem.points.iter().all(|p| p.mm()[0].abs() < 0.05), "{stem:?}");
}

#[test]
fn an_ell_is_one_line() {
    let ell = turned(&[(0.0, 0.0), (8.0, 0.0), (8.0, 0.6), (0.6, 0.6), (0.6, 8.0), (0.0, 8.0)], 0.2);
    let paths = medial_axis(&ell, 0.1, 1.0, 0.5);
    assert_eq!(paths.len(), 1, "{paths:?}");
    assert_covers(&ell, &paths, 0.07);
}

#[test]
fn a_plus_is_one_line_and_two_that_end_beside_it() {
    let arms = |x0: f64, y0: f64| ring(&[(-x0, -y0), (x0, -y0), (x0, y0), (-x0, y0)]);
    let plus = unite_rings(&[arms(5.0, 0.3), arms(0.3, 5.0)]);
    let paths = medial_axis(&plus, 0.1, 1.0, 0.5);
    let mut lengths: Vec<f64> = paths.iter().map(MedialPath::length_mm).collect();
    lengths.sort_by(f64::total_cmp);
    let [a, b, whole] = lengths[..] else { panic!("{paths:?}") };
    assert!((whole - 9.4).abs() < 0.4 && [a, b].iter().all(|arm| (arm - 4.4).abs() < 0.2), "{lengths:?}");
    // All of it, once, but for half a width at each of four free ends, which the round ends hold.
    assert_inside(&plus, &paths);
    let (covered, area) = (covered_mm2(&paths), plus.area_mm2() - 4.0 * 0.3 * 0.6);
    assert!((covered / area - 1.0).abs() < 0.01, "{covered} of {area} mm²: {paths:?}");
}

#[test]
fn width_follows_a_taper() {
    let taper = turned(&[(0.0, 0.0), (20.0, -0.1), (20.0, 1.0), (0.0, 0.2)], 0.0);
    let paths = medial_axis(&taper, 0.1, 2.0, 0.5);
    assert_eq!(paths.len(), 1);
    for (p, w) in paths[0].points.iter().zip(&paths[0].width_mm) {
        let x = p.mm()[0];
        let expected = 0.2 + x / 20.0 * 0.9;
        assert!((f64::from(*w) - expected).abs() < 0.04, "{w} at {x}, not {expected}");
    }
    assert_covers(&taper, &paths, 0.05);
}

#[test]
fn parts_narrower_than_the_minimum_are_left_out() {
    let needle = turned(&[(0.0, 0.0), (20.0, -0.5), (20.0, 0.5)], 0.0);
    let paths = medial_axis(&needle, 0.2, 2.0, 0.5);
    assert_eq!(paths.len(), 1);
    assert!(paths[0].points.iter().all(|p| p.mm()[0] > 3.8));
    assert!(medial_axis(&needle, 1.5, 2.0, 0.5).is_empty());
}

#[test]
fn bad_widths_give_nothing() {
    let strip = turned(&[(0.0, 0.0), (9.0, 0.0), (9.0, 0.5), (0.0, 0.5)], 0.0);
    for (min, max) in [(f64::NAN, 1.0), (0.5, 0.1), (0.0, f64::INFINITY), (-1.0, 1.0), (0.0, 0.0)] {
        assert!(medial_axis(&strip, min, max, 0.5).is_empty());
    }
    assert!(medial_axis(&Region::default(), 0.1, 1.0, 0.5).is_empty());
}

#[test]
fn a_neck_has_its_line_along_it_even_where_it_is_wider_than_long() {
    for length in [0.25, 0.4, 1.0] {
        for angle in [0.0, 0.3, 0.785, 1.5] {
            let h = length / 2.0;
            let below = [(-2.0, -2.0), (-h, -2.0), (-h, -0.25), (h, -0.25), (h, -2.0), (2.0, -2.0)];
            let above = [(2.0, 2.0), (h, 2.0), (h, 0.25), (-h, 0.25), (-h, 2.0), (-2.0, 2.0)];
            let dumbbell = turned(&[below, above].concat(), angle);
            let neck = turned(&[(-h, -0.25), (h, -0.25), (h, 0.25), (-h, 0.25)], angle);
            let paths = medial_axis_in(&neck, &dumbbell, 0.1, 0.6, 0.5, &KnownAxes::default());
            assert_eq!(paths.len(), 1, "{length} {angle}: {paths:?}");
            let across = |p: &Point| (p.mm()[1] * angle.cos() - p.mm()[0] * angle.sin()).abs();
            assert!(paths[0].points.iter().all(|p| across(p) < 0.03), "{length} {angle}: {paths:?}");
            assert!((paths[0].length_mm() - length).abs() < 0.05, "{length} {angle}: {paths:?}");
        }
    }
}

#[test]
fn a_line_ends_where_the_area_does() {
    let strip = turned(&[(-2.0, -0.2), (2.0, -0.2), (2.0, 0.2), (-2.0, 0.2)], 0.0);
    let area = turned(&[(-1.0, -0.2), (1.0, -0.2), (1.0, 0.2), (-1.0, 0.2)], 0.0);
    let paths = medial_axis_in(&area, &strip, 0.1, 0.6, 0.5, &KnownAxes::default());
    assert_eq!(paths.len(), 1, "{paths:?}");
    assert!((paths[0].length_mm() - 2.0).abs() < 0.01, "{paths:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(150) })]

    /// The band between a blob and its inset: what walls leave behind.
    #[test]
    fn bands_are_covered(waves in prop::collection::vec((-0.8..0.8_f64, 0.0..6.0_f64), 2..5), width in 0.15..0.9_f64, n in 40_usize..400) {
        let radius = |angle: f64| {
            let waves = waves.iter().enumerate();
            8.0 + waves.map(|(k, (a, phase))| a * ((k + 1) as f64 * angle + phase).sin()).sum::<f64>()
        };
        let at = |i: usize| i as f64 / n as f64 * TAU;
        let outline = (0..n).map(|i| Point::from_mm(radius(at(i)) * at(i).cos(), radius(at(i)) * at(i).sin()));
        let solid = unite_rings(&[outline.collect()]);
        let band = difference(&solid, &offset(&solid, -width));
        let paths = medial_axis(&band, 0.05, 1.2, 0.5);
        let (covered, area) = (covered_mm2(&paths), band.area_mm2());
        prop_assert!((covered / area - 1.0).abs() < 0.05, "{covered} of {area}");
        prop_assert!(paths.iter().flat_map(|path| &path.points).all(|p| band.contains(*p)));
    }

    /// Overlapping triangles on a lattice: wide, narrow, touching, anything.
    #[test]
    fn any_region_gives_points_inside_it(points in prop::collection::vec((0..30_i32, 0..30_i32), 3..60), min in 0.0..0.3_f64, max in 0.3..3.0_f64) {
        let rings: Vec<Ring> = points
            .chunks_exact(3)
            .map(|t| t.iter().map(|&(x, y)| Point::from_mm(f64::from(x) * 0.3, f64::from(y) * 0.3)).collect())
            .collect();
        let region = unite_rings(&rings);
        let paths = medial_axis(&region, min, max, 0.5);
        for path in &paths {
            prop_assert_eq!(path.points.len(), path.width_mm.len());
            prop_assert!(path.points.len() >= 2 + usize::from(path.closed));
            for (p, w) in path.points.iter().zip(&path.width_mm) {
                prop_assert!(region.contains(*p), "{:?} is outside", p);
                prop_assert!((min as f32 - 1e-6..=max as f32).contains(w));
            }
        }
        prop_assert_eq!(&paths, &medial_axis(&region, min, max, 0.5));
        let narrow = difference(&region, &opening(&region, max / 2.0));
        let grid = EdgeGrid::new(&region);
        for path in medial_axis_in(&narrow, &region, min, max, 0.5, &KnownAxes::default()) {
            prop_assert_eq!(path.points.len(), path.width_mm.len());
            prop_assert!(path.points.iter().all(|p| grid.contains(*p) || grid.distance_mm(*p, 1.0) <= 1.0 / UNITS_PER_MM), "{:?}", path);
            prop_assert!(path.width_mm.iter().all(|w| (min as f32 - 1e-6..=max as f32).contains(w)));
        }
    }
}
