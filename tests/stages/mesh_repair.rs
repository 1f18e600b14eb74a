//! Repair: what is broken is mended, what is meant is kept.

use crate::support::mesh_shapes::broken::{BREAKAGES, DAMAGES, Inside};
use crate::support::mesh_shapes::{
    Facets, ball, cuboid, damaged, inside_out, load, mesh, own_models, stl, torus,
};
use pathwright::geometry::{Region, intersection};
use pathwright::mesh::Mesh;
use pathwright::plate::{Layout, Placement, place};
use pathwright::profile::Settings;
use pathwright::slice::{slice, volume_mm3};
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
fn a_level_hole_is_filled_and_not_welded_shut() {
    let mut facets = cuboid([0.0; 3], [10.0; 3]);
    facets.drain(..2);
    let (_, report) = mesh(&facets);
    assert_eq!((report.open_edges, report.gaps_welded, report.holes_filled), (0, 0, 1));
    assert!(close_to(report.volume_mm3, 1000.0) && report.uncertain.is_none());
    assert!(report.to_string().contains("1 hole filled"));
}

#[test]
fn a_hole_in_a_bulge_is_filled_and_said_to_be_uncertain_with_its_place_and_volume() {
    let whole = ball([0.0, 0.0, 30.0], 10.0, 4);
    let facets: Facets = whole.iter().filter(|f| f.iter().any(|p| p[2] < 38.0)).copied().collect();
    let off_mm3 = mesh(&whole).1.volume_mm3 - mesh(&facets).1.volume_mm3;
    let report = mesh(&facets).1;
    let doubt = report.uncertain.as_ref().expect("a doubt");
    assert!((0.5 * off_mm3..3.0 * off_mm3).contains(&doubt.volume_mm3), "{doubt} for {off_mm3} mm³");
    assert!(doubt.min_mm[2] > 36.0 && doubt.max_mm[2] < 40.1, "{doubt}");
    let told = report.warnings.iter().filter(|w| w.contains("the repair is uncertain: about 0."));
    assert_eq!(told.count(), 1, "{:?}", report.warnings);
}

#[test]
fn equal_facets_of_opposite_winding_cancel_where_they_part_bodies_that_touch() {
    let two = [cuboid([0.0; 3], [10.0; 3]), mirrored(cuboid([-10.0, 0.0, 0.0], [0.0, 10.0, 10.0]))].concat();
    let (_, report) = mesh(&two);
    assert_eq!((report.pairs_cancelled, report.non_manifold_edges, report.triangles), (2, 0, 20));
    assert!(close_to(report.volume_mm3, 2000.0) && report.uncertain.is_none());
}

/// The facets mirrored and turned, so that cubes side by side have equal facets where they touch.
fn mirrored(facets: Facets) -> Facets {
    let mirror = |p: [f32; 3]| [-10.0 - p[0], p[1], p[2]];
    inside_out(facets.into_iter().map(|f| f.map(mirror)).collect())
}

#[test]
fn equal_facets_of_opposite_winding_stay_once_where_the_surface_needs_them() {
    let whole = ball([0.0; 3], 10.0, 3);
    for share in [10, 3, 1] {
        let reversed = inside_out(whole[..whole.len() / share].to_vec());
        let (_, report) = mesh(&[whole.clone(), reversed].concat());
        assert_eq!((report.triangles, report.duplicates_dropped), (whole.len(), whole.len() / share));
        assert!(report.watertight && report.pairs_cancelled == 0 && report.uncertain.is_none());
        assert!(close_to(report.volume_mm3, mesh(&whole).1.volume_mm3), "{}", report.volume_mm3);
    }
}

#[test]
fn fins_without_thickness_are_dropped_single_or_double() {
    let cube = cuboid([0.0; 3], [10.0; 3]);
    let fin = [cube[0][0], cube[0][1], [5.0, 5.0, -8.0]];
    for fins in [vec![fin], vec![fin, [fin[1], fin[0], fin[2]]], vec![fin, fin]] {
        let (_, report) = mesh(&[cube.clone(), fins].concat());
        assert_eq!((report.triangles, report.watertight, report.uncertain), (12, true, None));
        assert!(report.sheets_dropped + report.pairs_cancelled > 0 && close_to(report.volume_mm3, 1000.0));
    }
}

#[test]
fn a_body_full_of_holes_is_no_sheet_though_a_fin_hangs_on_it() {
    let whole = ball([0.0; 3], 10.0, 4);
    let holed: Facets = whole.iter().enumerate().filter(|(i, _)| i % 9 > 1).map(|(_, f)| *f).collect();
    let fin = [holed[0][0], holed[0][1], [14.0, 14.0, 14.0]];
    let (_, report) = mesh(&[holed, vec![fin]].concat());
    let whole_mm3 = mesh(&whole).1.volume_mm3;
    assert!((report.volume_mm3 / whole_mm3 - 1.0).abs() < 0.02, "{report}");
}

#[test]
fn bodies_that_cross_are_united_also_where_one_of_them_faces_in() {
    let (a, b) = (cuboid([0.0; 3], [10.0; 3]), cuboid([5.0, 5.0, 2.0], [15.0, 15.0, 8.0]));
    for facets in [[a.clone(), b.clone()].concat(), [a, inside_out(b)].concat()] {
        let (mesh, report) = mesh(&facets);
        assert!((volume_mm3(&mesh) - 1450.0).abs() < 0.1 && report.uncertain.is_none(), "{report}");
    }
}

#[test]
fn every_kind_of_repair_is_listed_once_in_words() {
    let mut facets = damaged(&ball([0.0; 3], 10.0, 3), &[3, 1, 21, 22, 4]);
    facets.remove(0);
    let (_, report) = mesh(&facets);
    let lines: Vec<String> = report.repairs().iter().map(ToString::to_string).collect();
    let has = |words: &str| lines.iter().filter(|line| line.contains(words)).count() == 1;
    assert!(has("facets without area dropped") && has("duplicate facets dropped"), "{lines:?}");
    assert!(has("facets turned to face outwards"), "{lines:?}");
    assert!(lines.iter().all(|line| report.to_string().contains(line.as_str())));
    assert!(mesh(&cuboid([0.0; 3], [1.0; 3])).1.repairs().is_empty());
}

#[test]
fn a_hole_of_one_facet_is_filled_with_it() {
    let mut facets = cuboid([0.0; 3], [10.0; 3]);
    facets.remove(3);
    let (_, report) = mesh(&facets);
    assert_eq!((report.open_edges, report.holes_filled, report.watertight), (0, 1, true));
    assert!(close_to(report.volume_mm3, 1000.0));
}

#[test]
fn where_half_of_the_facets_face_in_only_a_shell_inside_another_is_uncertain() {
    let half_turned = |mut facets: Facets| {
        facets[..6].iter_mut().for_each(|f| f.swap(1, 2));
        facets
    };
    let (_, alone) = mesh(&half_turned(cuboid([0.0; 3], [10.0; 3])));
    assert!(close_to(alone.volume_mm3, 1000.0) && alone.uncertain.is_none());
    let inner = half_turned(cuboid([2.0; 3], [6.0; 3]));
    let (_, nested) = mesh(&[cuboid([0.0; 3], [10.0; 3]), inner].concat());
    assert!(nested.uncertain.is_some_and(|doubt| close_to(doubt.volume_mm3, 64.0)));
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
fn a_moebius_strip_is_told_to_be_inconsistent_and_uncertain() {
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
    assert!(report.inconsistent_edges > 0 && report.uncertain.is_some(), "{report}");
    assert!(mesh.is_oriented(), "the body beside it has an outside");
}

/// The sections of a mesh, layer by layer.
fn sections(mesh: Mesh) -> Vec<Region> {
    let settings = Settings::default();
    let item = Layout::single("part", mesh, 1);
    let plate = place(vec![item], &settings.bed, &Placement::default()).expect("room");
    let layers = slice(&plate, &settings.layer);
    layers
        .into_iter()
        .map(|layer| layer.sections.into_iter().next().map(|s| s.region).unwrap_or_default())
        .collect()
}

/// Volume that only one of two prints has, as a share of the first.
fn difference(good: &[Region], broken: &[Region]) -> f64 {
    let nothing = Region::default();
    let at = |regions: &[Region], i: usize| regions.get(i).unwrap_or(&nothing).clone();
    let layers = 0..good.len().max(broken.len());
    let only_one: f64 = layers
        .map(|i| {
            let (a, b) = (at(good, i), at(broken, i));
            a.area_mm2() + b.area_mm2() - 2.0 * intersection(&a, &b).area_mm2()
        })
        .sum();
    only_one / good.iter().map(Region::area_mm2).sum::<f64>()
}

/// `cargo test --test stages judged -- --nocapture` prints the table of `docs/trust.md`.
#[test]
fn broken_meshes_print_like_the_good_ones_they_are_made_from_judged_by_volume() {
    let facets = |path: &str| -> Facets {
        let path = own_models().into_iter().find(|p| p.ends_with(path)).expect("a bundled model");
        let (mesh, _) = pathwright::mesh::load(&path).expect("sound");
        let corner = |v: &u32| mesh.vertices()[*v as usize].map(|mm| mm as f32);
        mesh.triangles().iter().map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]).collect()
    };
    let cavity = [cuboid([0.0; 3], [20.0; 3]), inside_out(cuboid([12.0; 3], [18.0; 3]))].concat();
    let shapes: [(&str, Facets, Inside); 5] = [
        ("ball", ball([0.0; 3], 10.0, 4), ([0.0; 3], 10.0)),
        ("ring", torus(20.0, 6.0, 48), ([20.0, 0.0, 0.0], 6.0)),
        ("box with cavity", cavity, ([6.0; 3], 5.0)),
        ("helical_gear", facets("helical_gear.stl"), ([0.0; 3], 0.0)),
        ("tilted_bracket", facets("tilted_bracket.stl"), ([0.0; 3], 0.0)),
    ];
    let mut wrong = Vec::new();
    for (shape, good, inside) in &shapes {
        let (sound, _) = mesh(good);
        let whole_mm3 = volume_mm3(&sound);
        let whole = sections(sound);
        for (breakage, spoil) in BREAKAGES {
            if breakage == "self-union" && inside.1 == 0.0 {
                continue;
            }
            let (mesh, report) = mesh(&spoil(good, *inside));
            let told = report.uncertain.is_some();
            let volume_off = volume_mm3(&mesh) / whole_mm3 - 1.0;
            let off = difference(&whole, &sections(mesh));
            println!(
                "| {shape} | {breakage} | {:.4} % | {:.4} % | {} |",
                100.0 * off,
                100.0 * volume_off,
                if told { "told" } else { "mended" }
            );
            let most = if told { 0.5 } else { 0.001 };
            if off > most || (!told && volume_off.abs() > 0.005) {
                wrong.push(format!("{shape}, {breakage}: {:.3} %", 100.0 * off));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
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

    #[test]
    fn whatever_the_damage_the_volume_is_right_or_said_to_be_uncertain(
        first in 0..DAMAGES.len(),
        second in 0..DAMAGES.len(),
        share in 0.01f32..0.5,
        seed in 0usize..1000,
        shape in 0usize..4,
    ) {
        let good = match shape {
            0 => ball([1.0, 2.0, 3.0], 12.0, 3),
            1 => torus(20.0, 6.0, 16),
            2 => cuboid([0.0; 3], [20.0, 15.0, 10.0]),
            _ => [ball([0.0; 3], 12.0, 3), cuboid([5.0, -5.0, -5.0], [25.0, 5.0, 5.0])].concat(),
        };
        let whole_mm3 = volume_mm3(&mesh(&good).0);
        let once = DAMAGES[first].1(&good, share, seed);
        let facets = DAMAGES[second].1(&once, share, seed + 1);
        let Ok((mesh, report)) = load(stl(&facets)) else { return Ok(()) };
        let off = volume_mm3(&mesh) / whole_mm3 - 1.0;
        prop_assert!(
            off.abs() <= 0.005 || report.uncertain.is_some(),
            "{} and {}: {:.2} % off\n{}", DAMAGES[first].0, DAMAGES[second].0, 100.0 * off, report
        );
    }
}
