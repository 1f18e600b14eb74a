//! What is printed where: copies, plates, beds, transforms, pauses; and the same bytes every time.

use crate::support::print::{Bead, Print, model, run, settings, standard};
use pathwright::gcode::{Action, replay};
use pathwright::job::{FitError, Job, JobError, ObjectSettings};
use pathwright::mesh::Transform;
use pathwright::motion::PauseAt;
use pathwright::profile::Settings;

fn job(names: &[&str]) -> Job {
    Job::of(names.iter().map(|name| model(name)))
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
        ("klipper", "EXCLUDE_OBJECT_START NAME=calibration_cube", "EXCLUDE_OBJECT_END NAME=calibration_cube"),
        ("marlin", "M486 S", "M486 S-1"),
    ] {
        let settings = standard(&["gcode.labels=true", &format!("printer.flavor={flavor}")]);
        let print = run(&job(&["calibration_cube"]).with_copies(2), &settings).expect("a print");
        let text = String::from_utf8(print.text).expect("text");
        let defined =
            text.lines().filter(|l| l.starts_with("EXCLUDE_OBJECT_DEFINE") || *l == "M486 T2").count();
        assert_eq!(defined, if flavor == "klipper" { 2 } else { 1 });
        let (mut inside, mut kind, mut seen) = (false, "", std::collections::BTreeSet::new());
        for line in text.lines() {
            kind = line.strip_prefix(";TYPE:").unwrap_or(kind);
            if line.starts_with("M486 A") {
                assert!(kind == "Custom" && line.contains("Acalibration_cube"), "the head names it: {line}");
            } else if line.starts_with(end) {
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

/// A bead as a printer draws it: where, how fast, how far the filament is drawn back before, and by which acceleration.
#[derive(Debug, PartialEq)]
struct Drawn {
    from: [String; 3],
    to: [String; 3],
    speed: String,
    acceleration: String,
    is_primed: bool,
}

/// The beads of an object where another one was cancelled from a line on: firmware leaves out its moves, a host all that
/// belongs to it.
fn drawn(
    text: &str,
    object: &str,
    cancelled: Option<&str>,
    from_line: usize,
    leaves_all: bool,
) -> Vec<Drawn> {
    let (mut now, mut at, mut speed, mut acceleration) =
        (String::new(), <[String; 3]>::default(), String::new(), String::new());
    let (mut fed, mut most, mut out) = (0.0_f64, 0.0_f64, Vec::new());
    for (number, line) in text.lines().enumerate() {
        let line = line.split(';').next().unwrap_or_default();
        if let Some(label) = line.strip_prefix("M486 S") {
            now = label.to_owned();
            continue;
        }
        let is_move = line.starts_with("G1 ");
        if Some(now.as_str()) == cancelled && number >= from_line && (is_move || leaves_all) {
            continue;
        }
        if let Some(value) = line.strip_prefix("M204 P") {
            acceleration = value.to_owned();
        }
        if !is_move {
            continue;
        }
        let (before, primed) = (at.clone(), most - fed < 1e-6);
        let mut feeds = 0.0;
        for word in line.split_whitespace().skip(1) {
            let value = word[1..].to_owned();
            match &word[..1] {
                "X" => at[0] = value,
                "Y" => at[1] = value,
                "Z" => at[2] = value,
                "F" => speed = value,
                _ => feeds = value.parse().expect("a number"),
            }
        }
        fed += feeds;
        most = most.max(fed);
        if feeds > 0.0 && at != before && now == object {
            let (speed, acceleration) = (speed.clone(), acceleration.clone());
            out.push(Drawn { from: before, to: at.clone(), speed, acceleration, is_primed: primed });
        }
    }
    out
}

#[test]
fn an_object_is_printed_alike_where_another_is_cancelled() {
    for more in [&[][..], &["retract.z_hop=0.2", "retract.wipe=2"], &["gcode.label_comments=true"]] {
        let settings = standard(&[&["gcode.labels=true", "gcode.relative_e=true"], more].concat());
        let print = run(&job(&["calibration_cube"]).with_copies(2), &settings).expect("a print");
        let text = String::from_utf8(print.text).expect("text");
        let third = text.lines().position(|line| line == ";LAYER:2").expect("a third layer");
        for (object, other) in [("0", "1"), ("1", "0")] {
            let whole = drawn(&text, object, None, 0, false);
            assert!(whole.len() > 1000 && whole.iter().all(|bead| bead.is_primed));
            for leaves_all in [false, true] {
                let alone = drawn(&text, object, Some(other), third, leaves_all);
                let differs = whole.iter().zip(&alone).find(|(a, b)| a != b);
                assert!(
                    differs.is_none() && whole.len() == alone.len(),
                    "{more:?}, {leaves_all}: {differs:#?}"
                );
            }
        }
    }
}

/// Two objects of different height, one after the other.
fn one_by_one() -> Job {
    job(&["calibration_cube", "plate_with_holes"])
}

#[test]
fn one_after_the_other_the_lowest_is_finished_first_and_nothing_comes_near_it() {
    let radius_mm = 30.0;
    let settings = standard(&["print.sequence=object", "print.clearance_radius=30", "gcode.labels=true"]);
    let print = run(&one_by_one(), &settings).expect("a print");
    let text: Vec<&str> = print.lines().filter(|l| l.starts_with("; printing object ")).collect();
    assert_eq!(text, ["; printing object plate_with_holes", "; printing object calibration_cube"]);
    // Objects by the label that is in force; the skirt has none.
    let mut beads: [Vec<[f64; 3]>; 2] = Default::default();
    let (mut object, mut done): (Option<usize>, _) = (None, [false; 2]);
    for step in replay(&print.text) {
        let line = String::from_utf8_lossy(step.line.text).into_owned();
        if line.starts_with("M486 A") {
            // The head says which there are.
            (object, done) = (None, [false; 2]);
        }
        if let Some(now) = line.strip_prefix("M486 S").and_then(|number| number.parse::<usize>().ok()) {
            assert!(!done[now], "no object is taken up again");
            if let Some(before) = object.replace(now).filter(|before| *before != now) {
                done[before] = true;
            }
        }
        let Action::Stroke(s) = step.action else { continue };
        let Some(here) = object else { continue };
        if s.extrudes() {
            beads[here].push(s.to);
        } else if s.xy_mm > 0.0 && !beads[1 - here].is_empty() {
            // What is finished is passed over.
            let box_mm = beads[1 - here].iter().fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |b, p| {
                [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])]
            });
            let top_mm = beads[1 - here].iter().map(|p| p[2]).fold(0.0, f64::max);
            for k in 0..=50 {
                let at = [0, 1].map(|i| s.from[i] + f64::from(k) / 50.0 * (s.to[i] - s.from[i]));
                let gap = [0, 1].map(|i| (box_mm[i] - at[i]).max(at[i] - box_mm[i + 2]).max(0.0));
                let clear = s.from[2].min(s.to[2]) > top_mm + 1.0 || gap[0].hypot(gap[1]) >= radius_mm;
                assert!(clear, "{at:?} at {} mm, beside {box_mm:?} of {top_mm} mm", s.to[2]);
            }
        }
    }
    for own in &beads {
        assert_eq!(own.first().map(|p| p[2]), Some(0.2), "each begins on the bed");
        assert!(own.windows(2).all(|w| w[1][2] >= w[0][2]), "and rises");
    }
    let alone = |name: &str| {
        run(&job(&[name]), &standard(&["skirt.loops=0"])).expect("a print").summary.total.volume_mm3
    };
    let whole = print.summary.total.volume_mm3 - print.volume_of("Skirt/Brim", &settings);
    assert!((whole / (alone("calibration_cube") + alone("plate_with_holes")) - 1.0).abs() < 0.01);
    assert_eq!(print.summary.layer_count, 100 + 15);
}

#[test]
fn what_the_gantry_would_strike_is_not_printed_before_another() {
    let settings = standard(&["print.sequence=object", "print.clearance_height=2"]);
    match run(&one_by_one(), &settings) {
        Err(JobError::DoesNotFit(error @ FitError::Gantry { .. })) => assert!(
            error.to_string().starts_with(
                "plate_with_holes is 3.00 mm high, and calibration_cube is to be printed after it"
            ),
            "{error}"
        ),
        other => panic!("{:?}", other.map(|p| p.summary)),
    }
}

#[test]
fn an_object_can_have_settings_of_its_own() {
    let plate = standard(&["gcode.labels=true", "skirt.loops=0"]);
    let own = standard(&["infill.density=0", "walls.count=4"]);
    let named = |object: &str| Job {
        objects: vec![ObjectSettings { object: object.into(), settings: own.clone() }],
        ..job(&["calibration_cube"]).with_copies(2)
    };
    let print = run(&named("calibration_cube (2)"), &plate).expect("a print");
    let (mut object, mut kind, mut beads) = (String::new(), String::new(), std::collections::BTreeMap::new());
    for line in print.lines() {
        if let Some(number) = line.strip_prefix("M486 S") {
            object = number.to_owned();
        }
        kind = line.strip_prefix(";TYPE:").map_or(kind, str::to_owned);
        if line.starts_with("G1 X") && line.contains(" E") {
            *beads.entry((object.clone(), kind.clone())).or_insert(0) += 1;
        }
    }
    let count =
        |object: &str, kind: &str| beads.get(&(object.to_owned(), kind.to_owned())).copied().unwrap_or(0);
    assert!(count("0", "Internal infill") > 0 && count("1", "Internal infill") == 0, "{beads:?}");
    assert!(count("1", "Perimeter") > 2 * count("0", "Perimeter"), "{beads:?}");
    let error = run(&named("cube"), &plate).map(|p| p.summary).expect_err("there is none").to_string();
    assert!(error.contains("no object `cube`; there are: calibration_cube"), "{error}");
}

#[test]
fn the_same_mesh_gives_the_same_bytes_from_every_format() {
    let settings = standard(&["gcode.labels=true"]);
    let file = |extension| model("tilted_bracket").with_extension(extension);
    let text = |extension| {
        run(&Job { models: vec![file(extension).into()], ..Job::default() }, &settings).expect("a print").text
    };
    let stl = text("stl");
    assert!(text("3mf") == stl && text("obj") == stl);
}

#[test]
fn four_copies_are_four_islands_of_four_times_the_volume() {
    let settings = standard(&["skirt.loops=0"]);
    let single = run(&job(&["calibration_cube"]), &settings).expect("a print").measure(&settings).volume_mm3;
    let print = run(&job(&["calibration_cube"]).with_copies(4), &settings).expect("a print");
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
    let turned = Transform { rotate_deg: [90.0, 0.0, 90.0], ..Transform::default() };
    let job = job(&["plate_with_holes"]).transformed(turned);
    let size = run(&job, &settings).expect("a print").summary.size_mm;
    for (size, wanted) in size.iter().zip([3.0, 60.0, 40.0]) {
        assert!((size - wanted).abs() < 0.03, "{size} for {wanted}");
    }
}

#[test]
fn a_moved_model_is_printed_where_it_was_moved_to() {
    let settings = standard(&[]);
    let still = run(&job(&["helical_gear"]), &settings).expect("a print");
    let moved = Job { translate_mm: [40.0, -30.0, 0.0], ..job(&["helical_gear"]) };
    let moved = run(&moved, &settings).expect("a print");
    let (from, to) = (bounds(&outlines(&still)), bounds(&outlines(&moved)));
    for (i, by_mm) in [40.0, -30.0, 40.0, -30.0].into_iter().enumerate() {
        assert!((to[i] - from[i] - by_mm).abs() < 1e-3, "{from:?} to {to:?}");
    }
}

#[test]
fn a_sunk_model_loses_its_lowest_layers() {
    let settings = standard(&[]);
    let sunk = Job { translate_mm: [0.0, 0.0, -5.0], ..job(&["calibration_cube"]) };
    let print = run(&sunk, &settings).expect("a print");
    assert_eq!(print.summary.layer_count, 75);
}

#[test]
fn what_is_too_large_is_refused_or_made_to_fit() {
    let settings = standard(&["bed.size=[30, 60]"]);
    match run(&job(&["plate_with_holes"]), &settings) {
        Err(JobError::DoesNotFit(error)) => {
            let message = error.to_string();
            assert!(
                message.starts_with("plate_with_holes: ") && message.contains("--scale-to-fit"),
                "{message}"
            );
        }
        other => panic!("{:?}", other.map(|p| p.summary)),
    }
    let fitted = Job { scale_to_fit: true, ..job(&["plate_with_holes"]) };
    let print = run(&fitted, &settings).expect("it fits");
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
