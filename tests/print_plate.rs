//! What is printed where: copies, plates, beds, transforms, pauses; and the same bytes every time.

mod print_support;

use pathwright::job::{Job, JobError, TransformOptions};
use pathwright::motion::PauseAt;
use pathwright::profile::Settings;
use print_support::{Bead, Print, model, run, settings, standard};

fn job(names: &[&str]) -> Job {
    Job { models: names.iter().map(|name| model(name)).collect(), ..Job::default() }
}

fn turned(names: &[&str], transform: TransformOptions) -> Job {
    Job { transform, ..job(names) }
}

/// Box around some beads' centre lines: smallest X and Y, largest X and Y.
fn bounds<'a>(beads: impl IntoIterator<Item = &'a Bead>) -> [f64; 4] {
    let points = beads.into_iter().flat_map(|b| b.points.iter());
    points.fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |[x0, y0, x1, y1], &[x, y]| {
        [x0.min(x), y0.min(y), x1.max(x), y1.max(y)]
    })
}

/// Outlines of the first layer.
fn outlines(print: &Print) -> Vec<Bead> {
    let beads = print.beads();
    let first_mm = beads.iter().map(|b| b.z_mm).fold(f64::MAX, f64::min);
    beads.into_iter().filter(|b| b.kind == "External perimeter" && b.z_mm == first_mm).collect()
}

#[test]
fn the_bytes_do_not_depend_on_threads_or_on_the_run() {
    for profile in ["default", "standard-job"] {
        for name in ["pin_forest", "plate_with_holes"] {
            let settings = settings(&[profile], &[]);
            let prints = [1, 2, 8, 8].map(|threads| {
                run(&Job { threads: Some(threads), ..job(&[name]) }, &settings).expect("a print")
            });
            for other in &prints[1..] {
                assert!(other.text == prints[0].text, "{profile}, {name}");
                assert_eq!(other.summary, prints[0].summary);
            }
        }
    }
}

#[test]
fn labels_say_which_object_every_bead_belongs_to() {
    for (flavor, begin, end) in [
        ("klipper", "EXCLUDE_OBJECT_START NAME=object_", "EXCLUDE_OBJECT_END NAME=object_"),
        ("marlin", "M486 S", "M486 S-1"),
    ] {
        let settings = standard(&["gcode.labels=true", &format!("printer.flavor={flavor}")]);
        let print = run(&Job { copies: 2, ..job(&["calibration_cube"]) }, &settings).expect("a print");
        let text = String::from_utf8(print.text).expect("text");
        let defined =
            text.lines().filter(|l| l.starts_with("EXCLUDE_OBJECT_DEFINE") || *l == "M486 T2").count();
        assert_eq!(defined, if flavor == "klipper" { 2 } else { 1 });
        let (mut inside, mut kind, mut seen) = (false, "", std::collections::BTreeSet::new());
        for line in text.lines() {
            kind = line.strip_prefix(";TYPE:").unwrap_or(kind);
            if line.starts_with(end) {
                inside = false;
            } else if line.starts_with(begin) {
                inside = true;
                seen.insert(line);
            } else if line.starts_with("G1 X") && line.contains(" E") {
                assert_eq!(inside, kind != "Skirt/Brim", "{flavor}, {kind}: {line}");
            }
        }
        assert_eq!(seen.len(), 2);
    }
}

#[test]
fn four_copies_are_four_islands_of_four_times_the_volume() {
    let settings = standard(&["skirt.loops=0"]);
    let single = run(&job(&["calibration_cube"]), &settings).expect("a print").measure(&settings).volume_mm3;
    let print = run(&Job { copies: 4, ..job(&["calibration_cube"]) }, &settings).expect("a print");
    assert!((print.measure(&settings).volume_mm3 / (4.0 * single) - 1.0).abs() < 1e-3);
    let boxes: Vec<[f64; 4]> = outlines(&print).iter().map(|b| bounds([b])).collect();
    assert_eq!(boxes.len(), 4);
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[..i] {
            let gap_mm = (a[0] - b[2]).max(b[0] - a[2]).max(a[1] - b[3]).max(b[1] - a[3]);
            assert!(gap_mm > 5.0, "{a:?} and {b:?} are {gap_mm} mm apart");
        }
    }
}

#[test]
fn models_share_a_plate_in_its_middle() {
    let settings = standard(&[]);
    let names = ["calibration_cube", "tilted_bracket"];
    let together = run(&job(&names), &settings).expect("a print");
    assert!(outlines(&together).len() >= 2);
    let [x0, y0, x1, y1] = bounds(&together.beads());
    assert!(x0 > 0.0 && y0 > 0.0 && x1 < 250.0 && y1 < 250.0);
    let alone: f64 = names
        .iter()
        .map(|name| {
            run(&job(&[name]), &standard(&["skirt.loops=0"])).expect("a print").summary.total.volume_mm3
        })
        .sum();
    let skirt = together.volume_of("Skirt/Brim", &settings);
    assert!(((together.summary.total.volume_mm3 - skirt) / alone - 1.0).abs() < 0.01);
}

#[test]
fn a_model_stands_in_the_middle_of_any_bed() {
    for (printer, middle) in [("reprap-250", [125.0, 125.0]), ("delta-round", [0.0, 0.0])] {
        let settings = settings(&[printer], &["order.strategy=nearest"]);
        let print = run(&job(&["calibration_cube"]), &settings).expect("a print");
        let [x0, y0, x1, y1] = bounds(&outlines(&print));
        assert!(
            ((x0 + x1) / 2.0 - middle[0]).abs() < 0.01 && ((y0 + y1) / 2.0 - middle[1]).abs() < 0.01,
            "{printer}"
        );
    }
}

#[test]
fn a_turned_model_has_its_sides_exchanged() {
    let settings = standard(&[]);
    let transform = TransformOptions { rotate_deg: [90.0, 0.0, 90.0], ..TransformOptions::default() };
    let size = run(&turned(&["plate_with_holes"], transform), &settings).expect("a print").summary.size_mm;
    for (size, wanted) in size.iter().zip([3.0, 60.0, 40.0]) {
        assert!((size - wanted).abs() < 0.03, "{size} for {wanted}");
    }
}

#[test]
fn a_moved_model_is_printed_where_it_was_moved_to() {
    let settings = standard(&[]);
    let still = run(&job(&["helical_gear"]), &settings).expect("a print");
    let transform = TransformOptions { translate_mm: [40.0, -30.0, 0.0], ..TransformOptions::default() };
    let moved = run(&turned(&["helical_gear"], transform), &settings).expect("a print");
    let (from, to) = (bounds(&outlines(&still)), bounds(&outlines(&moved)));
    for (i, by_mm) in [40.0, -30.0, 40.0, -30.0].into_iter().enumerate() {
        assert!((to[i] - from[i] - by_mm).abs() < 1e-3, "{from:?} to {to:?}");
    }
}

#[test]
fn a_sunk_model_loses_its_lowest_layers() {
    let settings = standard(&[]);
    let transform = TransformOptions { translate_mm: [0.0, 0.0, -5.0], ..TransformOptions::default() };
    let print = run(&turned(&["calibration_cube"], transform), &settings).expect("a print");
    assert_eq!(print.summary.layer_count, 75);
}

#[test]
fn what_is_too_large_is_refused_or_made_to_fit() {
    let settings = standard(&["bed.size=[30, 60]"]);
    match run(&job(&["plate_with_holes"]), &settings) {
        Err(JobError::DoesNotFit(message)) => {
            assert!(
                message.starts_with("plate_with_holes: ") && message.contains("--scale-to-fit"),
                "{message}"
            );
        }
        other => panic!("{:?}", other.map(|p| p.summary)),
    }
    let transform = TransformOptions { scale_to_fit: true, ..TransformOptions::default() };
    let print = run(&turned(&["plate_with_holes"], transform), &settings).expect("it fits");
    let [x0, y0, x1, y1] = bounds(&print.beads());
    assert!(x0 > 0.0 && y0 > 0.0 && x1 < 30.0 && y1 < 60.0, "{x0} {y0} {x1} {y1}");
    assert!(x1 - x0 > 0.97 * 29.55, "no smaller than needed: {}", x1 - x0);
}

#[test]
fn a_pause_comes_once_before_the_layer_that_reaches_its_height() {
    let settings: Settings = standard(&[]);
    let pauses = vec![PauseAt::Height(7.3)];
    let print = run(&Job { pauses, ..job(&["calibration_cube"]) }, &settings).expect("a print");
    let mut layer = "";
    let mut found = Vec::new();
    for line in print.lines() {
        layer = line.strip_prefix(";LAYER:").unwrap_or(layer);
        if line.starts_with("M600") {
            found.push(layer);
        }
    }
    assert_eq!(found, ["36"], "the layer from 7.2 to 7.4 mm");
}
