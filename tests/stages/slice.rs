//! Cross-sections against an independent program and against what is known of the shapes.

use crate::support::mesh_shapes::{
    Facets, ball, cuboid, damaged, inside_out, load, mesh, own_models, stl, torus,
};
use crate::support::oracle::{assert_agrees, assert_sections_agree, section, span};
use pathwright::mesh::{Mesh, Transform};
use pathwright::plate::{Layout, Placement, Plate, place};
use pathwright::profile::{BedSettings, LayerSettings};
use pathwright::slice::{Cutter, Gaps, Slicer, slice};
use pathwright::units::Mm;
use proptest::prelude::*;

fn plate(mesh: Mesh, copies: usize) -> Plate {
    let bed = BedSettings { size: [Mm(1000.0); 2], height: Mm(1000.0), ..BedSettings::default() };
    place(vec![Layout::single("part", mesh, copies)], &bed, &Placement::default()).unwrap()
}

#[test]
fn sections_agree_with_an_independent_cut() {
    own_models().iter().for_each(|path| assert_sections_agree(path));
}

#[test]
fn layers_add_up_to_the_volume() {
    for path in own_models() {
        let (mesh, report) = pathwright::mesh::load(&path).unwrap();
        let settings = LayerSettings { height: Mm(0.1), first_height: Mm(0.1), ..LayerSettings::default() };
        let layers = slice(&plate(mesh, 1), &settings);
        let area = |l: &pathwright::slice::Layer| l.sections.iter().map(|s| s.region.area_mm2()).sum::<f64>();
        let volume: f64 = layers.iter().map(|l| l.span.height_mm * area(l)).sum();
        assert!((volume / report.volume_mm3 - 1.0).abs() < 5e-3, "{}: {volume}", path.display());
    }
}

#[test]
fn a_cut_through_vertices_is_the_section_just_below_them() {
    let (mesh, _) = mesh(&ball([0.0; 3], 10.0, 3));
    for level in mesh.vertices().iter().map(|v| v[2]).filter(|z| z.abs() < 9.5) {
        let (on, gaps) = section(&mesh, level);
        let (below, _) = section(&mesh, level - 1e-9);
        assert!((on.area_mm2() - below.area_mm2()).abs() < 1e-3 && gaps == Gaps::default());
    }
}

#[test]
fn a_box_is_cut_at_its_bottom_and_not_at_its_top() {
    let (mesh, _) = mesh(&cuboid([0.0; 3], [10.0, 10.0, 5.0]));
    assert_eq!(section(&mesh, 5.0).0.area_mm2(), 100.0);
    assert_eq!(section(&mesh, 1e-9).0.area_mm2(), 100.0);
    assert!(section(&mesh, 0.0).0.is_empty() && section(&mesh, 5.1).0.is_empty());
}

#[test]
fn overlapping_bodies_are_one_and_cavities_are_holes() {
    let overlap = [cuboid([0.0; 3], [10.0; 3]), cuboid([5.0, 5.0, 0.0], [15.0, 15.0, 10.0])].concat();
    assert_eq!(section(&mesh(&overlap).0, 5.0).0.area_mm2(), 175.0);
    let nested = [cuboid([0.0; 3], [10.0; 3]), inside_out(cuboid([2.0; 3], [4.0; 3]))].concat();
    let (region, _) = section(&mesh(&nested).0, 3.0);
    assert_eq!((region.area_mm2(), region.polygons().len(), region.polygons()[0].holes.len()), (96.0, 1, 1));
}

#[test]
fn bodies_with_hardly_a_gap_between_them_are_one() {
    // The second body stands beside the first as near as `gaps_mm[0]`, the third, which touches the second, as `gaps_mm[1]`.
    let outlines = |gaps_mm: [f32; 2], closing_mm: f64| {
        let settings = LayerSettings { closing_radius: Mm(closing_mm), ..LayerSettings::default() };
        let bodies = [
            cuboid([0.0; 3], [10.0; 3]),
            cuboid([10.0 + gaps_mm[0], 0.0, 0.0], [20.0, 6.0, 10.0]),
            cuboid([10.0 + gaps_mm[1], 6.0, 0.0], [20.0, 10.0, 10.0]),
        ];
        let region = Cutter::new(&mesh(&bodies.concat()).0, &[span(5.0)], &settings).section(0).0;
        (region.rings().count(), region.area_mm2())
    };
    for gap_mm in [0.002, 0.01, 0.04, 0.09] {
        // With a gap all along, and with a slit in one outline.
        for gaps_mm in [[gap_mm; 2], [0.0, gap_mm]] {
            let (rings, area_mm2) = outlines(gaps_mm, 0.049);
            assert!(rings == 1 && (area_mm2 - 200.0).abs() < 0.02, "{gaps_mm:?}: {rings}, {area_mm2}");
        }
        assert_eq!(outlines([gap_mm; 2], 0.0).0, 2);
    }
    assert_eq!(outlines([0.11; 2], 0.049).0, 2);
}

#[test]
fn copies_are_cut_once_and_stand_apart() {
    let (cube, _) = mesh(&cuboid([0.0; 3], [10.0; 3]));
    let plate = plate(cube, 3);
    let slicer = Slicer::new(&plate, &LayerSettings::default());
    let layer = slicer.layer(7);
    assert_eq!(layer.sections.iter().map(|s| s.object).collect::<Vec<_>>(), [0, 1, 2]);
    let bounds: Vec<_> = layer.sections.iter().map(|s| s.region.bounds().unwrap()).collect();
    assert!(
        !bounds[0].touches(&bounds[1]) && !bounds[1].touches(&bounds[2]) && !bounds[0].touches(&bounds[2])
    );
}

#[test]
fn compensation_moves_every_side() {
    let (cube, _) = mesh(&cuboid([0.0; 3], [10.0; 3]));
    let settings =
        LayerSettings { xy_compensation: Mm(0.1), elephant_foot: Mm(0.3), ..LayerSettings::default() };
    let plate = plate(cube, 1);
    let side = |layer| Slicer::new(&plate, &settings).layer(layer).sections[0].region.area_mm2().sqrt();
    assert!((side(0) - 9.6).abs() < 1e-3 && (side(1) - 10.2).abs() < 1e-3);
}

#[test]
fn a_sunk_model_loses_its_bottom() {
    let (cube, _) = mesh(&cuboid([0.0; 3], [10.0; 3]));
    let options = Placement { shift_mm: [0.0, 0.0, -4.0], ..Placement::default() };
    let items = vec![Layout::single("cube", cube, 1)];
    let plate = place(items, &BedSettings::default(), &options).unwrap();
    assert_eq!(slice(&plate, &LayerSettings::default()).len(), 30);
}

#[test]
fn t_junctions_leave_no_trace() {
    // The side of one box is split where that of its neighbour is not.
    let mut facets = cuboid([0.0; 3], [10.0; 3]);
    let [a, b, c] = facets.remove(4);
    let middle = [0, 1, 2].map(|i| (a[i] + c[i]) / 2.0);
    facets.extend([[a, b, middle], [middle, b, c]]);
    let (mesh, _) = mesh(&facets);
    for z in [0.5, 2.5, 5.0, 7.7] {
        let (region, gaps) = section(&mesh, z);
        assert!((region.area_mm2() - 100.0).abs() < 1e-3 && gaps == Gaps::default(), "{z}: {gaps:?}");
    }
}

#[test]
fn a_missing_side_is_bridged_and_told() {
    let (whole, _) = mesh(&cuboid([0.0; 3], [10.0; 3]));
    let mut triangles = whole.triangles().to_vec();
    triangles.drain(4..6);
    // Taken as it is: repair would fill the hole.
    let (region, gaps) = section(&Mesh::new(whole.vertices().to_vec(), triangles), 5.0);
    assert!((region.area_mm2() - 100.0).abs() < 13.0 && region.area_mm2() > 80.0, "{}", region.area_mm2());
    assert_eq!(gaps.joined + gaps.forced, 1);
}

#[test]
fn a_wall_through_a_body_leaves_no_trace() {
    // A box with a wall through its middle: three facets meet at its edges.
    let wall = |z: f32| {
        [
            [[5.0, 0.0, 0.0], [5.0, 10.0, 0.0], [5.0, 10.0, z]],
            [[5.0, 0.0, 0.0], [5.0, 10.0, z], [5.0, 0.0, z]],
        ]
    };
    let facets: Facets = [cuboid([0.0; 3], [10.0; 3]), wall(10.0).to_vec()].concat();
    let (region, _) = section(&mesh(&facets).0, 4.0);
    assert!((region.area_mm2() - 100.0).abs() < 0.1, "{}", region.area_mm2());
}

fn solid() -> impl Strategy<Value = Facets> {
    prop_oneof![
        (5.0f32..20.0, 1u32..4).prop_map(|(r, n)| ball([0.0; 3], r, n)),
        (5.0f32..20.0, 5.0f32..20.0, 5.0f32..20.0).prop_map(|(x, y, z)| cuboid([-x, -y, -z], [x, y, z])),
        (10.0f32..20.0, 1.0f32..8.0, 5usize..24).prop_map(|(r, s, n)| torus(r, s, n)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn turned_bodies_agree_with_an_independent_cut(
        facets in solid(),
        rotate_deg in [0.0f64..360.0, 0.0..360.0, 0.0..360.0],
        scale in [0.3f64..2.0, 0.3..2.0, -2.0..-0.3],
    ) {
        let turned = Transform { scale, rotate_deg }.apply(mesh(&facets).0).unwrap();
        assert_agrees(&turned, 3, "a turned body");
    }

    #[test]
    fn broken_copies_have_the_sections_of_the_whole(
        facets in solid(),
        rotate_deg in [0.0f64..360.0, 0.0..360.0, 0.0..360.0],
        seed in prop::collection::vec(any::<u8>(), 100),
        share in 0.1f64..0.9,
    ) {
        let turn = Transform { rotate_deg, ..Transform::default() };
        let whole = turn.apply(mesh(&facets).0).unwrap();
        let broken = turn.apply(mesh(&damaged(&facets, &seed)).0).unwrap();
        let [min, max] = whole.bounds();
        let z = min[2] + share * (max[2] - min[2]);
        let (a, b) = (section(&whole, z).0.area_mm2(), section(&broken, z).0.area_mm2());
        prop_assert!((a - b).abs() < 0.01 + 1e-4 * a, "{} instead of {}", b, a);
    }

    #[test]
    fn any_facets_are_cut_without_panic(
        corners in prop::collection::vec([-20.0f32..20.0, -20.0..20.0, 0.0..20.0], 12..90),
    ) {
        let facets: Facets = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        if let Ok((mesh, _)) = load(stl(&facets)) {
            let layers = slice(&plate(mesh, 1), &LayerSettings { height: Mm(1.0), ..LayerSettings::default() });
            let rings = layers.iter().flat_map(|l| &l.sections).flat_map(|s| s.region.rings());
            prop_assert!(rings.into_iter().all(|r| r.len() >= 3));
        }
    }
}
