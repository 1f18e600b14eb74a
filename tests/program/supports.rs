//! Supports, raft and draft shield, from model to G-code and back.

use std::path::PathBuf;

use crate::support::mesh_shapes::{cuboid, stl};
use crate::support::print::{Bead, Print, Solid, model, print, run, solid, standard};
use pathwright::geometry::{Join, Point, Region, difference, offset, offset_with, opening};
use pathwright::job::Job;
use pathwright::profile::Settings;

const HEIGHT_MM: f64 = 0.2;

/// Support of a style that holds bridges as well.
fn held(style: &str) -> Settings {
    standard(&["support.enabled=true", "support.max_bridge=0", &format!("support.style={style}")])
}

fn is_support(bead: &Bead) -> bool {
    bead.kind.starts_with("Support material")
}

fn layer_of(bead: &Bead) -> usize {
    (bead.z_mm / HEIGHT_MM).round() as usize - 1
}

/// The beads of each layer.
fn by_layer(beads: Vec<Bead>) -> Vec<Vec<Bead>> {
    let mut layers: Vec<Vec<Bead>> = Vec::new();
    for bead in beads.into_iter().filter(|bead| bead.kind != "Skirt/Brim") {
        let layer = layer_of(&bead);
        layers.resize_with(layers.len().max(layer + 1), Vec::new);
        layers[layer].push(bead);
    }
    layers
}

/// Distance from a place to the nearest centre line.
fn distance_mm<'a>(at: [f64; 2], beads: impl IntoIterator<Item = &'a Bead>) -> f64 {
    let to_segment = |w: &[[f64; 2]]| {
        let (d, p) = ([w[1][0] - w[0][0], w[1][1] - w[0][1]], [at[0] - w[0][0], at[1] - w[0][1]]);
        let length2 = d[0] * d[0] + d[1] * d[1];
        let t = if length2 > 0.0 { ((p[0] * d[0] + p[1] * d[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
        (p[0] - t * d[0]).hypot(p[1] - t * d[1])
    };
    beads.into_iter().flat_map(|bead| bead.points.windows(2).map(to_segment)).fold(f64::MAX, f64::min)
}

/// Places 0.7 mm apart inside a region.
fn samples(region: &Region) -> Vec<[f64; 2]> {
    let Some(bounds) = region.bounds() else { return Vec::new() };
    let ([x0, y0], [x1, y1]) = (bounds.min.mm(), bounds.max.mm());
    let steps = |from: f64, to: f64| (0..=((to - from) / 0.7) as usize).map(move |k| from + 0.7 * k as f64);
    let all = steps(y0, y1).flat_map(|y| steps(x0, x1).map(move |x| [x, y]));
    all.filter(|p| region.contains(Point::from_mm(p[0], p[1]))).collect()
}

/// What of a layer hangs further out than by 50° from the vertical, rims narrower than a millimetre left out.
fn overhang(part: &Solid, layer: usize) -> Region {
    let lean_mm = HEIGHT_MM * 50_f64.to_radians().tan();
    let carried = offset(&part.section(layer.checked_sub(1)), lean_mm);
    opening(&difference(&part.section(Some(layer)), &carried), 0.5)
}

fn parts(name: &str, settings: &Settings) -> (Vec<Vec<Bead>>, Solid) {
    (by_layer(print(name, settings).beads()), solid(&model(name), settings))
}

#[test]
fn every_overhang_is_held_from_close_below() {
    for style in ["grid", "tree"] {
        let (layers, part) = parts("overhang_and_bridge", &held(style));
        let mut seen = 0;
        for layer in 3..layers.len() {
            for at in samples(&overhang(&part, layer)) {
                let below = layers[layer - 3..layer - 1].iter().flatten().filter(|bead| is_support(bead));
                let far_mm = distance_mm(at, below);
                assert!(far_mm < 1.2, "{style}: {at:?} on layer {layer} is {far_mm} mm from support");
                seen += 1;
            }
        }
        assert!(seen > 500, "{seen}");
    }
}

#[test]
fn no_support_touches_the_part() {
    for style in ["grid", "tree"] {
        let settings = held(style);
        let (layers, part) = parts("overhang_and_bridge", &settings);
        let keep_mm = settings.support.xy_gap.0 + settings.support.width.0 / 2.0 - 0.02;
        for (layer, beads) in layers.iter().enumerate() {
            let near = offset_with(&part.section(Some(layer)), keep_mm, Join::Round { tolerance_mm: 0.01 });
            for bead in beads.iter().filter(|bead| is_support(bead)) {
                let hit = bead.points.iter().find(|p| near.contains(Point::from_mm(p[0], p[1])));
                assert!(hit.is_none(), "{style}: layer {layer} at {hit:?}");
            }
        }
    }
}

#[test]
fn no_bead_of_support_begins_in_mid_air() {
    for (style, name) in
        [("grid", "overhang_and_bridge"), ("tree", "overhang_and_bridge"), ("tree", "pin_forest")]
    {
        let mut settings = held(style);
        settings.support.min_reach.0 = 0.2;
        let (layers, part) = parts(name, &settings);
        let (mut begun, mut hanging) = (0, Vec::new());
        for layer in 1..layers.len() {
            // Support rests on the part a layer apart.
            let rest: Vec<Region> = (1..=2).map(|k| part.section(layer.checked_sub(k))).collect();
            for bead in layers[layer].iter().filter(|bead| is_support(bead)) {
                let at = bead.points[0];
                let on_part = rest.iter().any(|r| offset(r, 0.6).contains(Point::from_mm(at[0], at[1])));
                let far_mm = distance_mm(at, layers[layer - 1].iter().filter(|bead| is_support(bead)));
                begun += 1;
                if !on_part && far_mm > 0.5 {
                    hanging.push((layer, at, far_mm));
                }
            }
        }
        assert!(hanging.is_empty(), "{style}, {name}: {} of {begun}: {hanging:?}", hanging.len());
    }
}

#[test]
fn what_prints_by_itself_gets_no_support() {
    let none = |name: &str, sets: &[&str]| {
        let settings = standard(&[&["support.enabled=true"], sets].concat());
        let volume_mm3 = print(name, &settings).volume_of("Support material", &settings);
        assert_eq!(volume_mm3, 0.0, "{name}");
    };
    none("calibration_cube", &[]);
    none("tilted_bracket", &[]);
    none("overhang_and_bridge", &["support.max_bridge=21", "support.angle=80"]);
}

#[test]
fn support_from_the_bed_only_stands_on_no_part() {
    let settings = standard(&["support.enabled=true", "support.from_bed_only=true", "support.max_bridge=0"]);
    let (layers, part) = parts("overhang_and_bridge", &settings);
    let mut below = Region::default();
    let mut beads = 0;
    for (layer, drawn) in layers.iter().enumerate() {
        below = pathwright::geometry::union(&below, &part.section(Some(layer)));
        for bead in drawn.iter().filter(|bead| is_support(bead)) {
            assert!(bead.points.iter().all(|p| !below.contains(Point::from_mm(p[0], p[1]))), "layer {layer}");
            beads += 1;
        }
    }
    assert!(beads > 100);
}

#[test]
fn trees_take_less_than_columns() {
    let volume_mm3 = |style: &str| {
        let settings = standard(&["support.enabled=true", &format!("support.style={style}")]);
        print("overhang_and_bridge", &settings).volume_of("Support material", &settings)
    };
    let (grid_mm3, tree_mm3) = (volume_mm3("grid"), volume_mm3("tree"));
    assert!(tree_mm3 < grid_mm3, "{tree_mm3} against {grid_mm3}");
}

/// A box around everything, as a file.
fn everything(folder: &tempfile::TempDir) -> PathBuf {
    let path = folder.path().join("everything.stl");
    std::fs::write(&path, stl(&cuboid([-500.0; 3], [500.0; 3]))).expect("written");
    path
}

#[test]
fn bodies_enforce_and_block_support() {
    let folder = tempfile::tempdir().expect("a folder");
    let volume_mm3 = |enforcers: bool, blockers: bool, enabled: bool| {
        let body = |wanted: bool| if wanted { vec![everything(&folder).into()] } else { Vec::new() };
        let job = Job {
            models: vec![model("overhang_and_bridge").into()],
            support_enforcers: body(enforcers),
            support_blockers: body(blockers),
            ..Job::default()
        };
        let settings = standard(&[&format!("support.enabled={enabled}")]);
        let print: Print = run(&job, &settings).expect("a print");
        print.volume_of("Support material", &settings)
    };
    let usual_mm3 = volume_mm3(false, false, true);
    assert!(usual_mm3 > 0.0);
    assert!(volume_mm3(true, false, true) > 1.2 * usual_mm3, "short bridges are held as well");
    assert!(volume_mm3(true, false, false) > 0.0, "an enforcer needs no support elsewhere");
    assert_eq!(volume_mm3(false, true, true), 0.0);
}

#[test]
fn a_raft_has_its_layers_and_its_gap() {
    let settings = standard(&["raft.layers=3", "raft.gap=0.15"]);
    let print = print("calibration_cube", &settings);
    let raft: Vec<f64> = print.beads().iter().filter(|bead| is_support(bead)).map(|bead| bead.z_mm).collect();
    let mut heights: Vec<i64> = raft.iter().map(|z| (z * 1000.0).round() as i64).collect();
    heights.sort_unstable();
    heights.dedup();
    assert_eq!(heights, [200, 400, 600]);
    let part = print.beads().into_iter().filter(|bead| bead.kind.contains("perimeter"));
    let lowest_mm = part.map(|bead| bead.z_mm).fold(f64::MAX, f64::min);
    assert!((lowest_mm - (0.6 + 0.15 + 0.2)).abs() < 1e-6, "{lowest_mm}");
    assert_eq!(print.summary.layer_count, 103);
}

#[test]
fn a_draft_shield_surrounds_every_layer() {
    let settings = standard(&["skirt.draft_shield=true", "skirt.loops=2"]);
    let layers = print("tilted_bracket", &settings);
    let mut loops = std::collections::BTreeMap::new();
    for bead in layers.beads().iter().filter(|bead| bead.kind == "Skirt/Brim") {
        *loops.entry(layer_of(bead)).or_insert(0) += 1;
    }
    assert_eq!(loops.len(), layers.summary.layer_count);
    assert!(loops.iter().all(|(&layer, &count)| count == if layer == 0 { 2 } else { 1 }));
}

#[test]
fn threads_change_no_byte_of_support() {
    let settings = standard(&["support.enabled=true", "support.style=tree"]);
    let text = |threads| {
        let job = Job { models: vec![model("pin_forest").into()], threads: Some(threads), ..Job::default() };
        run(&job, &settings).expect("a print").text
    };
    assert!(text(1) == text(3));
}
