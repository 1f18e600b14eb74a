//! What must hold of any print, asserted on the G-code of bundled models.

use crate::support::print::{Bead, Print, model, print, settings, solid, standard};
use pathwright::estimate::Machine;
use pathwright::gcode::file_time;
use pathwright::geometry::{Point, offset};
use pathwright::profile::{EMBEDDED, OrderStrategy, Settings};

/// Small models with holes, islands, slopes, thin walls.
const MODELS: [&str; 4] = ["calibration_cube", "pin_forest", "overhang_and_bridge", "thin_wall_comb"];

/// Points along a bead, vertices and middles.
fn samples(bead: &Bead) -> impl Iterator<Item = Point> + '_ {
    let middles = bead.points.windows(2).map(|w| [(w[0][0] + w[1][0]) / 2.0, (w[0][1] + w[1][1]) / 2.0]);
    bead.points.iter().copied().chain(middles).map(|[x, y]| Point::from_mm(x, y))
}

/// Beads of the part, by layer.
fn beads_by_layer(print: &Print, settings: &Settings) -> Vec<Vec<Bead>> {
    let mut layers = vec![Vec::new(); print.summary.layer_count];
    for bead in print.beads().into_iter().filter(|b| b.kind != "Skirt/Brim") {
        let layer = ((bead.z_mm - settings.layer.first_height.0) / settings.layer.height.0).round();
        layers[layer as usize].push(bead);
    }
    layers
}

#[test]
fn beads_stay_inside_the_section() {
    let settings = standard(&[]);
    for name in MODELS {
        let (print, solid) = (print(name, &settings), solid(&model(name), &settings));
        for (i, beads) in beads_by_layer(&print, &settings).iter().enumerate().step_by(4) {
            let section = solid.section(Some(i));
            // Beads of fitting width change theirs along the path; their centres have to be inside.
            let (inner, outer) = (offset(&section, 0.05 - 0.45 / 2.0), offset(&section, 0.02));
            for bead in beads {
                let room = if bead.width_mm == 0.45 && bead.kind != "Gap fill" { &inner } else { &outer };
                for p in samples(bead) {
                    assert!(room.contains(p), "{name} layer {i}: {} at {:?}", bead.kind, p.mm());
                }
            }
        }
    }
}

#[test]
fn every_island_has_an_external_perimeter() {
    let settings = standard(&[]);
    for name in MODELS {
        let (print, solid) = (print(name, &settings), solid(&model(name), &settings));
        for (i, beads) in beads_by_layer(&print, &settings).iter().enumerate() {
            for island in solid.section(Some(i)).into_polygons() {
                let island = pathwright::geometry::Region::from(island);
                if offset(&island, -0.25).is_empty() {
                    continue;
                }
                let outer = beads.iter().filter(|b| b.kind == "External perimeter");
                let found =
                    outer.flat_map(|b| b.points.first()).any(|p| island.contains(Point::from_mm(p[0], p[1])));
                assert!(found, "{name} layer {i}: an island at {:?}", island.bounds());
            }
        }
    }
}

#[test]
fn walls_are_closed_loops() {
    let settings = standard(&["walls.gap_fill=false"]);
    for name in ["calibration_cube", "pin_forest"] {
        for bead in print(name, &settings).beads() {
            assert!(!bead.kind.ends_with("erimeter") || bead.closed(), "{name}: {bead:?}");
        }
    }
}

#[test]
fn nothing_is_extruded_outside_the_bed_or_below_what_is_there() {
    for printer in ["reprap-250", "ender-3", "prusa-i3", "corexy-klipper", "delta-round"] {
        let settings = settings(&[printer], &["order.strategy=nearest"]);
        let print = print("calibration_cube", &settings);
        let mut z_mm = 0.0;
        for stroke in print.strokes().into_iter().filter(pathwright::gcode::Stroke::extrudes) {
            assert!(stroke.to[2] >= z_mm, "{printer}: down to {} from {z_mm}", stroke.to[2]);
            z_mm = stroke.to[2];
            let (width_mm, depth_mm) = (settings.bed.size[0].0, settings.bed.size[1].0);
            let [x, y] = [stroke.to[0], stroke.to[1]];
            let on_bed = match printer {
                "delta-round" => x.hypot(y) <= width_mm / 2.0,
                _ => (0.0..=width_mm).contains(&x) && (0.0..=depth_mm).contains(&y),
            };
            assert!(on_bed, "{printer}: {x}, {y}");
        }
        assert!((z_mm - 20.0).abs() < 1e-6, "{printer}: up to {z_mm}");
    }
}

#[test]
fn the_first_layer_has_its_own_speed_width_and_temperature() {
    let settings = settings(&["prusa-i3", "petg"], &["order.strategy=nearest", "first_layer.width=0.6"]);
    let print = print("pin_forest", &settings);
    let beads = print.beads();
    let (first, others): (Vec<&Bead>, Vec<&Bead>) =
        beads.iter().partition(|b| b.z_mm < settings.layer.first_height.0 + 1e-6);
    let cap = settings.first_layer.speed.0 + 0.01;
    assert!(first.iter().all(|b| b.feed_mm_s <= cap), "slow");
    assert!(others.iter().any(|b| b.feed_mm_s > cap), "the others are not");
    assert!(first.iter().any(|b| b.width_mm == 0.6) && others.iter().all(|b| b.width_mm != 0.6));

    let text = String::from_utf8(print.text.clone()).expect("UTF-8");
    let temperature = &settings.temperature;
    let (heated, then) = (temperature.nozzle_first_layer.0, temperature.nozzle.0);
    let [waits, second] = [format!("M109 S{heated}"), format!("M104 S{then}\n")];
    let layer = |i: usize| text.find(&format!(";LAYER:{i}\n")).expect("a layer");
    assert!(text.find(&waits).expect("waits") < layer(0));
    if heated != then {
        let at = layer(1) + text[layer(1)..].find(&second).expect("another temperature");
        assert!(at < layer(2), "set on the second layer");
    }
}

#[test]
fn layers_last_as_long_as_they_should_or_are_as_slow_as_they_may() {
    let settings = settings(&[], &["order.strategy=nearest"]);
    let print = print("pin_forest", &settings);
    let layers = beads_by_layer(&print, &settings);
    let least_s = settings.cooling.min_layer_time.0;
    for (layer, beads) in print.summary.layers.iter().zip(layers) {
        let slow = beads.iter().all(|b| b.feed_mm_s <= settings.cooling.min_speed.0 + 0.02);
        assert!(
            layer.measures.total_s > 0.97 * least_s || slow,
            "{} mm: {}",
            layer.z_mm,
            layer.measures.total_s
        );
    }
    assert!(
        print.summary.layers.iter().any(|l| l.measures.total_s < 1.2 * least_s),
        "the test has a short layer"
    );
}

#[test]
fn relative_and_absolute_extrusion_deposit_the_same() {
    let [relative, absolute] = [true, false].map(|relative| {
        let settings = standard(&[&format!("gcode.relative_e={relative}")]);
        print("tilted_bracket", &settings).measure(&settings).volume_mm3
    });
    assert!((relative / absolute - 1.0).abs() < 1e-5, "{relative} and {absolute} mm³");
}

#[test]
fn arcs_print_the_same_in_fewer_lines() {
    let [straight, arcs] = [false, true].map(|arcs| {
        let settings = standard(&[&format!("gcode.arcs={arcs}")]);
        let print = print("plate_with_holes", &settings);
        (print.lines().count(), print.measure(&settings).volume_mm3)
    });
    assert!(arcs.0 < straight.0, "{} lines with arcs, {} without", arcs.0, straight.0);
    assert!((arcs.1 / straight.1 - 1.0).abs() < 1e-3, "{} and {} mm³", arcs.1, straight.1);
}

#[test]
fn every_order_prints_the_same_paths() {
    let prints = OrderStrategy::NAMES.iter().map(|order| {
        let settings =
            settings(&["standard-job"], &[&format!("order.strategy={order}"), "seam.position=pinned"]);
        (*order, print("plate_with_holes", &settings).measure(&settings))
    });
    let prints: Vec<_> = prints.collect();
    let [(_, as_sliced), rest @ .., (_, optimized)] = prints.as_slice() else { unreachable!("six orders") };
    for (order, measure) in rest.iter().chain([&("optimized", optimized.clone())]) {
        assert!((measure.print_mm / as_sliced.print_mm - 1.0).abs() < 1e-6, "{order}: {}", measure.print_mm);
        assert!(
            (measure.volume_mm3 / as_sliced.volume_mm3 - 1.0).abs() < 1e-5,
            "{order}: {}",
            measure.volume_mm3
        );
        assert!(optimized.link_mm <= measure.link_mm + 1e-6, "{order} beats optimized: {}", measure.link_mm);
    }
}

#[test]
fn what_any_profile_makes_passes_the_check() {
    // Slicing ends in an error where it does not.
    for profile in EMBEDDED {
        let settings = settings(&[profile.name], &[]);
        for name in ["thin_wall_comb", "tilted_bracket"] {
            print(name, &settings);
        }
    }
    // Walls that widen beside holes, by a filament that melts slowly.
    print("plate_with_holes", &settings(&["tpu"], &["order.strategy=nearest"]));
}

#[test]
fn rear_seams_are_at_the_rear() {
    let settings = standard(&["seam.position=rear"]);
    for bead in print("helical_gear", &settings).beads().iter().filter(|b| b.kind == "External perimeter") {
        let rearmost = bead.points.iter().map(|p| p[1]).fold(f64::MIN, f64::max);
        assert!(rearmost - bead.points[0][1] < 0.02, "a seam at {:?}", bead.points[0]);
    }
}

#[test]
fn the_summary_says_what_the_file_measures() {
    for profile in ["default", "standard-job", "prusa-i3", "corexy-klipper"] {
        let settings = settings(&[profile], &["order.strategy=nearest"]);
        let print = print("overhang_and_bridge", &settings);
        let (said, file) = (&print.summary.total, print.measure(&settings));
        let lengths = [
            ("print", said.print_mm, file.print_mm),
            ("travel", said.travel_mm, file.travel_mm),
            ("total", said.total_mm, file.total_mm()),
            ("link", said.link_mm, file.link_mm),
            ("volume", said.volume_mm3, file.volume_mm3),
            ("time", said.total_s, file_time(&print.text, &Machine::new(&settings)).0),
        ];
        for (what, said, measured) in lengths {
            // Coordinates are rounded to a micrometre; layers are timed one by one, each from rest.
            let tolerance = if what == "time" { 0.01 } else { 2e-4 };
            assert!(
                (said / measured - 1.0).abs() < tolerance,
                "{profile}, {what}: {said}, measured {measured}"
            );
        }
        assert_eq!((said.travels, said.retractions), (file.travels, file.retractions), "{profile}");
        assert_eq!(print.summary.layer_count, print.summary.layers.len());
    }
}
