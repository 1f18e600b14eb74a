//! Repair: what is broken is mended, what is meant is kept.

mod mesh_shapes;

use mesh_shapes::{Facets, ball, cuboid, damaged, inside_out, mesh, shared_models, torus};
use proptest::prelude::*;

fn close_to(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * b.abs()
}

#[test]
fn a_mesh_that_faces_inwards_is_turned_as_a_whole() {
    let hollow = [cuboid([0.0; 3], [10.0; 3]), inside_out(cuboid([2.0; 3], [4.0; 3]))].concat();
    for facets in [hollow.clone(), inside_out(hollow)] {
        let (_, report) = mesh(&facets);
        assert!(close_to(report.volume_mm3, 992.0), "{}", report.volume_mm3);
        assert_eq!(report.shells, 2);
    }
}

#[test]
fn a_shell_that_faces_inwards_is_a_cavity_only_inside_another() {
    let ball = ball([0.0; 3], 5.0, 3);
    let (_, alone) = mesh(&ball);
    let beside = [cuboid([10.0, 0.0, 0.0], [20.0, 10.0, 10.0]), inside_out(ball.clone())].concat();
    let (_, report) = mesh(&beside);
    assert!(close_to(report.volume_mm3, 1000.0 + alone.volume_mm3));
    assert_eq!(report.flipped, ball.len());
    let inside = [cuboid([-6.0; 3], [6.0; 3]), inside_out(ball)].concat();
    assert!(close_to(mesh(&inside).1.volume_mm3, 1728.0 - alone.volume_mm3));
}

#[test]
fn a_body_in_a_cavity_stays_solid() {
    let nested =
        [cuboid([0.0; 3], [10.0; 3]), inside_out(cuboid([1.0; 3], [9.0; 3])), cuboid([3.0; 3], [5.0; 3])];
    assert!(close_to(mesh(&nested.concat()).1.volume_mm3, 1000.0 - 512.0 + 8.0));
}

#[test]
fn an_inside_out_box_around_which_a_frame_stands_is_turned() {
    // A ring around it encloses its box, but not it.
    let facets = [torus(20.0, 4.0, 32), inside_out(cuboid([-2.0; 3], [2.0; 3]))].concat();
    let (_, report) = mesh(&facets);
    assert_eq!(report.flipped, 12);
}

#[test]
fn gaps_of_micrometres_are_welded() {
    let mut facets = ball([0.0; 3], 10.0, 3);
    for (i, facet) in facets.iter_mut().enumerate() {
        for p in facet {
            p[0] += (i % 3) as f32 * 0.002;
        }
    }
    let (_, report) = mesh(&facets);
    assert!(report.watertight && report.gaps_welded > 0, "{report}");
}

#[test]
fn a_hole_is_counted_and_not_welded_shut() {
    let mut facets = cuboid([0.0; 3], [10.0; 3]);
    facets.remove(0);
    let (_, report) = mesh(&facets);
    assert_eq!((report.open_edges, report.gaps_welded, report.watertight), (3, 0, false));
    assert!(report.to_string().contains("3 open edges"));
}

#[test]
fn bodies_that_touch_along_an_edge_or_face_stay_whole() {
    let edge = [cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0])].concat();
    let (_, report) = mesh(&edge);
    assert!(report.watertight && report.non_manifold_edges == 1 && close_to(report.volume_mm3, 2.0));
    let face = [cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])].concat();
    let (mesh, report) = mesh(&face);
    assert!(report.watertight && close_to(report.volume_mm3, 2.0) && report.flipped == 0);
    assert!(mesh.is_oriented());
}

#[test]
fn a_moebius_strip_is_told_to_be_inconsistent() {
    let count = 40;
    let point = |i: usize, side: f32| {
        let angle = i as f32 / count as f32 * std::f32::consts::TAU;
        let r = 20.0 + side * 5.0 * (angle / 2.0).cos();
        [r * angle.cos(), r * angle.sin(), side * 5.0 * (angle / 2.0).sin()]
    };
    let strip: Facets = (0..count)
        .flat_map(|i| {
            let (a, b) = (point(i, -1.0), point(i, 1.0));
            let (c, d) = match i + 1 == count {
                false => (point(i + 1, -1.0), point(i + 1, 1.0)),
                true => (point(0, 1.0), point(0, -1.0)),
            };
            [[a, c, d], [a, d, b]]
        })
        .collect();
    let with_body = [strip, cuboid([-5.0; 3], [5.0; 3])].concat();
    let (mesh, report) = mesh(&with_body);
    assert!(!mesh.is_oriented() && report.inconsistent_edges > 0);
}

#[test]
fn shared_models_have_the_volume_that_is_known_of_them() {
    // Volumes from the list of the collection, computed by another program.
    let known = [("3DBenchy.stl", 15550.7), ("3DHackerTest.stl", 13984.9), ("spikey_top.stl", 38399.7)];
    for path in shared_models() {
        for (_, volume_mm3) in known.iter().filter(|(name, _)| path.ends_with(name)) {
            let (_, report) = pathwright::mesh::load(&path).unwrap();
            assert!((report.volume_mm3 / volume_mm3 - 1.0).abs() < 1e-4, "{}", path.display());
            assert!(report.watertight);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn turned_repeated_and_collapsed_facets_are_mended(
        seed in prop::collection::vec(any::<u8>(), 300),
        ring in any::<bool>(),
    ) {
        let facets = if ring { torus(20.0, 6.0, 16) } else { ball([1.0, 2.0, 3.0], 12.0, 3) };
        let (_, whole) = mesh(&facets);
        let (_, report) = mesh(&damaged(&facets, &seed));
        prop_assert!(close_to(report.volume_mm3, whole.volume_mm3), "{} {}", report, whole);
        prop_assert!(report.watertight);
        prop_assert_eq!(report.triangles, facets.len());
    }
}
