//! Transforms and placement.

use crate::support::mesh_shapes::{ball, cuboid, mesh, own_models};
use pathwright::mesh::{Mesh, Transform};
use pathwright::plate::{Arrange, Item, Layout, Line, Placement, PlacementError, Plate, orient, place};
use pathwright::profile::{BedOrigin, BedSettings, BedShape};
use pathwright::units::Mm;
use proptest::prelude::*;

fn bed(shape: BedShape, side: f64, origin: BedOrigin) -> BedSettings {
    BedSettings {
        shape,
        size: [Mm(side), Mm(side)],
        height: Mm(200.0),
        origin,
        offset: [Mm(0.0); 2],
        ..BedSettings::default()
    }
}

fn block(x: f32, y: f32, z: f32) -> Mesh {
    mesh(&cuboid([3.0, -7.0, 5.0], [3.0 + x, y - 7.0, 5.0 + z])).0
}

fn item(name: &str, mesh: Mesh, copies: usize) -> Layout {
    Layout::single(name, mesh, copies)
}

/// Boxes of the objects on the bed: low x, low y, high x, high y.
fn boxes(plate: &Plate) -> Vec<[f64; 4]> {
    let corner = |object: &pathwright::plate::Object| {
        let ([x, y], [min, max]) = (object.offset.mm(), plate.meshes[object.mesh].bounds());
        [x + min[0], y + min[1], x + max[0], y + max[1]]
    };
    plate.objects.iter().map(corner).collect()
}

#[test]
fn a_model_stands_in_the_middle_of_the_bed() {
    for (origin, middle) in [(BedOrigin::Corner, 100.0), (BedOrigin::Center, 0.0)] {
        for shape in [BedShape::Rectangular, BedShape::Round] {
            let items = vec![item("a", block(30.0, 20.0, 10.0), 1)];
            let plate = place(items, &bed(shape, 200.0, origin), &Placement::default()).unwrap();
            assert_eq!(boxes(&plate), [[middle - 15.0, middle - 10.0, middle + 15.0, middle + 10.0]]);
            assert_eq!(plate.meshes[0].bounds()[0][2], 0.0);
        }
    }
}

#[test]
fn a_bed_may_lie_anywhere() {
    for (origin, middle) in [(BedOrigin::Corner, [105.0, 92.0]), (BedOrigin::Center, [5.0, -8.0])] {
        let bed = BedSettings { offset: [Mm(5.0), Mm(-8.0)], ..bed(BedShape::Rectangular, 200.0, origin) };
        let (low, high) = (bed.low_mm(), bed.high_mm());
        assert_eq!([0, 1].map(|i| (low[i] + high[i]) / 2.0), middle);
        let plate = place(vec![item("a", block(30.0, 20.0, 10.0), 1)], &bed, &Placement::default()).unwrap();
        let [x, y] = middle;
        assert_eq!(boxes(&plate), [[x - 15.0, y - 10.0, x + 15.0, y + 10.0]]);
    }
}

#[test]
fn a_model_larger_than_the_bed_is_refused_with_the_factor_that_fits() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let long = block(250.0, 20.0, 10.0);
    let error = place(vec![item("long.stl", long.clone(), 1)], &bed, &Placement::default()).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("long.stl: 250.00 × 20.00 × 10.00 mm") && message.contains("50.00 mm too long in X")
    );
    assert!(message.ends_with("--scale-to-fit would scale it by 0.8"), "{message}");
    assert!(message.contains("turned by 45° about Z (--rotate) it fits"), "{message}");
    let turned =
        Transform { rotate_deg: [0.0, 0.0, 45.0], ..Transform::default() }.apply(long.clone()).unwrap();
    assert!(place(vec![item("long.stl", turned, 1)], &bed, &Placement::default()).is_ok());
    let longer = place(vec![item("longer", block(270.0, 20.0, 10.0), 1)], &bed, &Placement::default());
    assert!(!longer.unwrap_err().to_string().contains("turned"));
    let factor = item("long", long.clone(), 1).fit_factor(&bed, 0.0);
    let smaller = Transform { scale: [factor; 3], ..Transform::default() }.apply(long).unwrap();
    assert!(place(vec![item("long.stl", smaller, 1)], &bed, &Placement::default()).is_ok());
    let high = place(vec![item("high", block(1.0, 1.0, 250.0), 1)], &bed, &Placement::default());
    assert!(high.unwrap_err().to_string().contains("50.00 mm too high"));
}

#[test]
fn exact_fits_fit() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let items = || vec![item("a", block(190.0, 190.0, 200.0), 1)];
    assert!(place(items(), &bed, &Placement { margin_mm: 5.0, ..Placement::default() }).is_ok());
    assert!(place(items(), &bed, &Placement { margin_mm: 5.1, ..Placement::default() }).is_err());
    assert_eq!(items()[0].fit_factor(&bed, 5.0), 1.0);
}

#[test]
fn a_round_bed_measures_the_outline_and_not_its_box() {
    let bed = bed(BedShape::Round, 100.0, BedOrigin::Center);
    let round = mesh(&ball([0.0; 3], 49.0, 4)).0;
    assert!(place(vec![item("ball", round, 1)], &bed, &Placement::default()).is_ok());
    let square = place(vec![item("square", block(80.0, 80.0, 5.0), 1)], &bed, &Placement::default());
    assert!(square.unwrap_err().to_string().contains("6.57 mm beyond the edge"));
}

#[test]
fn copies_share_a_mesh_and_fill_the_bed() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let items = |copies| vec![item("part", block(45.0, 45.0, 5.0), copies)];
    let plate = place(items(16), &bed, &Placement::default()).unwrap();
    assert_eq!((plate.meshes.len(), plate.objects.len()), (1, 16));
    assert_eq!(plate.objects[1].name, "part (2)");
    let error = place(items(17), &bed, &Placement::default()).unwrap_err();
    assert!(matches!(error, PlacementError::TooMany { total: 17, fitting: 16, .. }), "{error}");
}

/// An L of two boxes that share no corner: a foot of `long` × `wide`, and a leg of `wide` × `long`.
fn ell(long: f32, wide: f32) -> Mesh {
    let (foot, leg) = (cuboid([0.0; 3], [long, wide, 5.0]), cuboid([0.0, 0.5, 0.0], [wide, long, 4.0]));
    mesh(&[foot, leg].concat()).0
}

/// The two boxes of every L on the bed.
fn ells(plate: &Plate) -> Vec<[[f64; 4]; 2]> {
    let boxes = |object: &pathwright::plate::Object| {
        let ([x, y], vertices) = (object.offset.mm(), plate.meshes[object.mesh].vertices());
        let bounds = |part: &[[f64; 3]]| {
            part.iter().fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |[x0, y0, x1, y1], v| {
                [x0.min(x + v[0]), y0.min(y + v[1]), x1.max(x + v[0]), y1.max(y + v[1])]
            })
        };
        [bounds(&vertices[..8]), bounds(&vertices[8..])]
    };
    plate.objects.iter().map(boxes).collect()
}

fn gap_mm(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let along = |i: usize| (a[i] - b[i + 2]).max(b[i] - a[i + 2]).max(0.0);
    along(0).hypot(along(1))
}

#[test]
fn outlines_nest_where_boxes_would_not_fit() {
    let bed = bed(BedShape::Rectangular, 104.0, BedOrigin::Corner);
    let options = Placement { spacing_mm: 3.0, ..Placement::default() };
    let plate = place(vec![item("ell", ell(60.0, 15.0), 3)], &bed, &options).unwrap();
    assert_eq!(plate.objects.len(), 3);
    let error = place(vec![item("ell", ell(60.0, 15.0), 9)], &bed, &options).unwrap_err().to_string();
    assert!(error.contains("9 models do not fit") && error.contains("no room for ell ("), "{error}");
}

#[test]
fn quarter_turns_are_made_where_they_are_needed() {
    let bed = bed(BedShape::Rectangular, 100.0, BedOrigin::Corner);
    let items = || vec![item("upright", block(20.0, 98.0, 5.0), 3), item("flat", block(98.0, 20.0, 5.0), 1)];
    assert!(place(items(), &bed, &Placement::default()).is_err());
    let plate = place(items(), &bed, &Placement { turn: true, ..Placement::default() }).unwrap();
    assert_eq!(plate.objects.len(), 4);
}

#[test]
fn models_stay_where_their_files_put_them() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let kept = |x: f64, convex: bool| {
        let positions = |positions: &[[f64; 3]]| positions.to_vec();
        let items = vec![
            Item::new("a", block(20.0, 20.0, 5.0), positions(&[[50.0, 60.0, 0.0]])),
            Item::new("b", block(20.0, 20.0, 5.0), positions(&[[x, 60.0, 0.0], [150.0, 100.0, 0.0]])),
        ];
        let options = Placement { arrange: Arrange::Off, convex, ..Placement::default() };
        place(vec![Layout::new("file", items, 1)], &bed, &options)
    };
    let plate = kept(75.0, false).unwrap();
    assert_eq!(boxes(&plate)[..2], [[53.0, 53.0, 73.0, 73.0], [78.0, 53.0, 98.0, 73.0]]);
    assert_eq!((plate.meshes.len(), plate.objects[2].name.as_str()), (2, "b (2)"));
    assert_eq!(boxes(&kept(70.2, false).unwrap())[1][0], 73.2, "near as they are");
    assert!(matches!(kept(74.0, true), Err(PlacementError::TooNear { .. })), "one after the other");
    assert!(matches!(kept(190.0, false), Err(PlacementError::Outside { name, .. }) if name == "b"));
}

/// A ring of four bars, a block within it that touches nothing and begins 1 mm higher, and a block beside both.
fn assembly() -> Layout {
    let bar = |low: [f32; 2], high: [f32; 2]| cuboid([low[0], low[1], 0.0], [high[0], high[1], 6.0]);
    let ring = [
        bar([0.0, 0.0], [30.0, 5.0]),
        bar([0.0, 25.0], [30.0, 30.0]),
        bar([0.0, 0.0], [5.0, 30.0]),
        bar([25.0, 0.0], [30.0, 30.0]),
    ];
    let inner = mesh(&cuboid([12.0, 12.0, 1.0], [18.0, 18.0, 5.0])).0;
    let items = vec![
        Item::new("ring", mesh(&ring.concat()).0, vec![[0.0; 3]]),
        Item::new("inner", inner, vec![[0.0; 3]]),
        Item::new("beside", block(10.0, 10.0, 3.0), vec![[40.0, 0.0, 0.0]]),
    ];
    Layout::new("assembly", items, 1)
}

fn low_mm(plate: &Plate, object: usize) -> f64 {
    plate.meshes[plate.objects[object].mesh].bounds()[0][2]
}

#[test]
fn a_layout_is_moved_as_a_whole_and_each_body_let_down() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let plate = place(vec![assembly()], &bed, &Placement::default()).unwrap();
    let [ring, inner, beside] = boxes(&plate).try_into().unwrap();
    assert_eq!([inner[0] - ring[0], inner[1] - ring[1]], [12.0; 2]);
    assert_eq!([beside[0] - ring[0], beside[1] - ring[1]], [43.0, -7.0]);
    assert_eq!([ring[0] + beside[2], beside[1] + ring[3]], [200.0; 2], "in the middle of the bed");
    assert_eq!([0, 1, 2].map(|object| low_mm(&plate, object)), [0.0, 1.0, 0.0]);
    assert_eq!(plate.objects.iter().map(|object| object.body).collect::<Vec<_>>(), [0, 0, 1]);
    assert!(plate.notes.is_empty());
}

#[test]
fn what_interlocks_is_moved_together_when_all_is_arranged_anew() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let options = Placement { arrange: Arrange::Bodies, turn: true, ..Placement::default() };
    let plate = place(vec![assembly()], &bed, &options).unwrap();
    let [ring, inner, beside] = boxes(&plate).try_into().unwrap();
    assert_eq!([inner[0] - ring[0], inner[1] - ring[1]], [12.0; 2]);
    assert_ne!([beside[0] - ring[0], beside[1] - ring[1]], [43.0, -7.0]);
    assert!(gap_mm(&ring, &beside) >= 5.0);
    assert_eq!(low_mm(&plate, 1), 1.0);
}

#[test]
fn a_layout_too_large_for_the_bed_is_arranged_anew_and_told() {
    let cube = || block(40.0, 40.0, 10.0);
    let layout = |places: &[f64]| {
        let positions = places.iter().map(|x| [*x, 60.0, 0.0]).collect();
        Layout::new("plates", vec![Item::new("cube", cube(), positions)], 1)
    };
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    // Two on the bed, one beyond it: the two keep their distance.
    let plate = place(vec![layout(&[30.0, 100.0, 300.0])], &bed, &Placement::default()).unwrap();
    let boxes = boxes(&plate);
    assert_eq!(boxes[1][0] - boxes[0][0], 70.0);
    assert!(boxes.iter().flatten().all(|c| (0.0..=200.0).contains(c)));
    let note = &plate.notes[0];
    assert!(
        note.contains("does not fit the printer's") && note.contains("arranged anew: cube (3)"),
        "{note}"
    );
    // Copies that fit only when the layouts are taken apart.
    let copies = Layout::new("pair", vec![Item::new("cube", cube(), vec![[0.0; 3], [130.0, 0.0, 0.0]])], 5);
    let plate = place(vec![copies], &bed, &Placement::default()).unwrap();
    assert_eq!((plate.objects.len(), plate.notes.len()), (10, 1));
    assert!(plate.notes[0].contains("not all models have room"), "{:?}", plate.notes);
    // Apart enough for a plate, too near to be printed one after the other.
    let convex = Placement { convex: true, spacing_mm: 50.0, ..Placement::default() };
    let plate = place(vec![layout(&[30.0, 100.0])], &bed, &convex).unwrap();
    assert!(plate.notes[0].contains("too near to be printed one after the other"), "{:?}", plate.notes);
}

#[test]
fn a_shell_without_a_printable_line_does_not_count() {
    let sliver = cuboid([0.0, 0.0, -3.0], [0.02, 5.0, 0.0]);
    let facets = [cuboid([0.0; 3], [20.0, 20.0, 10.0]), cuboid([30.0, 0.0, 2.0], [40.0, 10.0, 5.0]), sliver];
    let item = Item::new("part", mesh(&facets.concat()).0, vec![[0.0; 3]])
        .without_slivers(Line { width_mm: 0.16, height_mm: 0.2 });
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let plate = place(vec![Layout::new("part", vec![item], 1)], &bed, &Placement::default()).unwrap();
    assert_eq!(plate.meshes[0].bounds()[0][2], -3.0);
    assert_eq!(boxes(&plate), [[80.0, 90.0, 120.0, 110.0]]);
}

#[test]
fn twenty_models_share_a_bed_without_touching() {
    let bed = bed(BedShape::Rectangular, 250.0, BedOrigin::Corner);
    let mixed = |i: usize| match i % 3 {
        0 => item("ell", ell(20.0 + 2.0 * i as f32, 6.0), 1),
        _ => item(
            "block",
            mesh(
                &[cuboid([0.0; 3], [15.0 + i as f32, 40.0 - i as f32, 5.0]), cuboid([1.0; 3], [2.0; 3])]
                    .concat(),
            )
            .0,
            1,
        ),
    };
    let plate = place((0..20).map(mixed).collect(), &bed, &Placement::default()).unwrap();
    let boxes = ells(&plate);
    for (i, a) in boxes.iter().enumerate() {
        assert!(a.iter().flatten().all(|c| (-1e-3..=250.001).contains(c)), "{a:?}");
        let others = boxes[..i].iter().flatten();
        assert!(others.flat_map(|b| a.iter().map(|a| gap_mm(a, b))).all(|gap_mm| gap_mm >= 5.0), "{a:?}");
    }
}

#[test]
fn a_part_is_turned_onto_the_side_that_needs_no_support() {
    let pocketed = pathwright::mesh::load(&own_models()[2]).unwrap().0;
    let on_bed = |mesh: &Mesh| {
        let low = mesh.bounds()[0][2];
        let at = |v: u32| mesh.vertices()[v as usize];
        let flat = mesh.triangles().iter().map(|t| t.map(at)).filter(|t| t.iter().all(|v| v[2] < low + 0.01));
        flat.map(|[a, b, c]| ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0)
            .sum::<f64>()
    };
    let upright = on_bed(&pocketed);
    assert!(upright > 300.0);
    assert_eq!(orient(pocketed.clone()), pocketed, "nothing is better than as it is");
    for rotate_deg in [[180.0, 0.0, 0.0], [0.0, 90.0, 0.0], [33.0, 20.0, 5.0]] {
        let turned = Transform { rotate_deg, ..Transform::default() }.apply(pocketed.clone()).unwrap();
        assert!((on_bed(&orient(turned)) - upright).abs() < 0.1, "{rotate_deg:?}");
    }
}

#[test]
fn a_shift_moves_and_sinks_but_not_off_the_bed() {
    let bed = bed(BedShape::Rectangular, 200.0, BedOrigin::Corner);
    let shifted = |shift_mm| {
        let options = Placement { shift_mm, ..Placement::default() };
        place(vec![item("a", block(20.0, 20.0, 10.0), 1)], &bed, &options)
    };
    let plate = shifted([30.0, -10.0, -2.0]).unwrap();
    assert_eq!(boxes(&plate), [[120.0, 80.0, 140.0, 100.0]]);
    assert_eq!(plate.meshes[0].bounds()[0][2], -2.0);
    assert!(shifted([95.0, 0.0, 0.0]).unwrap_err().to_string().contains("5.00 mm beyond"));
    assert!(matches!(shifted([0.0, 0.0, 1.0]), Err(PlacementError::InTheAir(_))));
}

#[test]
fn mirroring_keeps_the_outside_out() {
    let ball = mesh(&ball([0.0; 3], 5.0, 2)).0;
    let mirror = Transform { scale: [-1.0, 2.0, 1.0], ..Transform::default() };
    let mirrored = mirror.apply(ball.clone()).unwrap();
    assert!((mirrored.volume_and_area().0 / ball.volume_and_area().0 - 2.0).abs() < 1e-9);
    let rebuilt = Mesh::new(mirrored.vertices().to_vec(), mirrored.triangles().to_vec());
    assert_eq!(mirrored.twins(), rebuilt.twins());
}

#[test]
fn quarter_turns_are_exact() {
    let turn = Transform { rotate_deg: [90.0, 0.0, 90.0], ..Transform::default() };
    let turned = turn.apply(block(1.0, 2.0, 3.0)).unwrap();
    assert_eq!(turned.size(), [3.0, 1.0, 2.0]);
}

#[test]
fn scales_that_leave_nothing_are_refused() {
    for bad in [0.0, f64::NAN, f64::INFINITY, 1e6] {
        assert!(
            Transform { scale: [1.0, bad, 1.0], ..Transform::default() }.apply(block(1.0, 2.0, 3.0)).is_err()
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn turned_and_nested_outlines_never_come_closer_than_the_spacing(
        sizes in prop::collection::vec((25.0f32..80.0, 4.0f32..20.0, 1usize..4), 1..6),
        spacing_mm in 0.0f64..10.0,
        turn in any::<bool>(),
    ) {
        let items = sizes.iter().map(|&(long, wide, n)| item("ell", ell(long, wide), n)).collect();
        let options = Placement { spacing_mm, turn, ..Placement::default() };
        if let Ok(plate) = place(items, &bed(BedShape::Rectangular, 200.0, BedOrigin::Center), &options) {
            let ells = ells(&plate);
            for (i, a) in ells.iter().enumerate() {
                prop_assert!(a.iter().flatten().all(|c| c.abs() <= 100.0 + 1e-3));
                for b in &ells[..i] {
                    let nearest = a.iter().flat_map(|a| b.iter().map(move |b| gap_mm(a, b))).fold(f64::MAX, f64::min);
                    prop_assert!(nearest >= spacing_mm - 1e-4, "{nearest} mm for {spacing_mm}");
                }
            }
        }
    }

    #[test]
    fn models_never_come_closer_than_the_spacing(
        sizes in prop::collection::vec((1.0f32..60.0, 1.0f32..60.0, 1usize..4), 1..6),
        spacing_mm in 0.5f64..10.0,
        round in any::<bool>(),
    ) {
        let shape = if round { BedShape::Round } else { BedShape::Rectangular };
        let items = sizes.iter().map(|&(x, y, n)| item("a", block(x, y, 5.0), n)).collect();
        let options = Placement { spacing_mm, ..Placement::default() };
        if let Ok(plate) = place(items, &bed(shape, 250.0, BedOrigin::Center), &options) {
            let boxes = boxes(&plate);
            for (i, a) in boxes.iter().enumerate() {
                prop_assert!(a.iter().all(|c| c.abs() <= 125.0 + 1e-3));
                for b in &boxes[..i] {
                    prop_assert!(gap_mm(a, b) >= spacing_mm - 1e-4);
                }
            }
        } else {
            let area: f32 = sizes.iter().map(|s| (s.0 + 10.0) * (s.1 + 10.0) * s.2 as f32).sum();
            prop_assert!(area > 0.3 * 250.0 * 250.0, "a plate that is less than a third full must fit");
        }
    }
}
