//! Each kind of fault, planted into a clean file, is found, and no other; other slicers' files and our own have none.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::support::found::{self, kinds, report};
use crate::support::mesh_shapes::{Facets, ball, cuboid, mesh, stl};
use crate::support::print::{model, settings, standard};
use pathwright::Observer;
use pathwright::check::{CheckReport, Checker, Kind, Severity};
use pathwright::job::{Engine, Job};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::plate::Layout;
use pathwright::profile::Settings;
use pathwright::units::Mm3PerS;

const LAYERS: usize = 6;

/// A small print of two square loops a layer, written by nobody's slicer. `decimals`: of all numbers.
fn clean(decimals: [usize; 2]) -> Vec<String> {
    let mut lines: Vec<String> =
        ["M140 S60", "M190 S60", "M104 S210", "G28", "M109 S210", "G21", "G90", "M83", "G92 E0"]
            .map(String::from)
            .to_vec();
    let [xy, e] = decimals;
    for layer in 1..=LAYERS {
        lines.push(format!(";LAYER:{}", layer - 1));
        lines.push(format!("G1 Z{:.1} F600", 0.2 * layer as f64));
        for x0 in [100.123, 130.321] {
            lines.push(format!("G0 X{x0:.xy$} Y100.{} F9000", "0".repeat(xy)));
            lines.push("G1 E1 F2400".into());
            lines.push(";TYPE:Perimeter".into());
            lines.push("G1 F1800".into());
            for step in 1..=12 {
                let along = f64::from(step % 3) * 5.0 + if step % 3 == 0 { 15.0 } else { 0.0 };
                let (dx, dy) = match (step - 1) / 3 {
                    0 => (along, 0.0),
                    1 => (15.0, along),
                    2 => (15.0 - along, 15.0),
                    _ => (0.0, 15.0 - along),
                };
                let amount = 5.0 * 0.0334;
                lines.push(format!("G1 X{:.xy$} Y{:.xy$} E{amount:.e$}", x0 + dx, 100.0 + dy));
            }
            lines.push("G1 E-1 F2400".into());
        }
    }
    lines.extend([";TYPE:Custom", "G0 Z20 F600", "M104 S0", "M140 S0", "M84"].map(String::from));
    // The first loop begins with nothing pulled back.
    let first = lines.iter().position(|line| line == "G1 E1 F2400").expect("there is one");
    lines.remove(first);
    lines
}

/// The clean file with lines before the loops of a layer.
fn before_layer(layer: usize, planted: &[&str]) -> String {
    let mut lines = clean([3, 5]);
    let at = lines.iter().position(|line| *line == format!(";LAYER:{}", layer - 1)).expect("a layer") + 2;
    lines.splice(at..at, planted.iter().map(|line| (*line).to_string()));
    lines.join("\n")
}

fn replaced(from: &str, to: &str) -> String {
    clean([3, 5]).iter().map(|line| if line == from { to } else { line }).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_clean_file_has_no_fault() {
    let report = report(clean([3, 5]).join("\n"), &Settings::default());
    assert_eq!(report.faults, []);
    assert_eq!(report.layer_count, LAYERS);
    assert!((report.total.print_mm - 60.0 * 2.0 * LAYERS as f64).abs() < 0.1, "{}", report.total.print_mm);
}

#[test]
fn each_planted_fault_is_found_and_no_other() {
    let planted = [
        (Kind::NotANumber, before_layer(3, &["G1 Xnan"])),
        (Kind::Malformed, before_layer(3, &["G1 X"])),
        (Kind::Malformed, before_layer(3, &["X10 Y20"])),
        (Kind::Malformed, before_layer(3, &["G1 E1", "G2 X110 Y110 I40 E.01", "G1 E-1"])),
        (Kind::Exponent, before_layer(3, &["G1 E1", "G1 X100 Y1.2e2", "G1 E-1"])),
        (Kind::BadFeedRate, before_layer(3, &["G1 F0"])),
        (Kind::OutsideBed, before_layer(3, &["G0 X251 Y50"])),
        (Kind::OutsideBed, before_layer(3, &["G92 X0", "G0 X-140", "G92 X0"])),
        (Kind::BelowBed, before_layer(3, &["G0 Z-0.5", "G0 Z0.6"])),
        (Kind::ThroughPrint, before_layer(5, &["G0 X90 Y107", "G0 Z0.4", "G0 X125", "G0 Z1"])),
        (
            Kind::HeightOrder,
            before_layer(6, &["G0 X50 Y50", "G1 Z.2", "G1 E1", "G1 X60 E.3", "G1 E-1", "G1 Z1.2"]),
        ),
        (Kind::ColdExtrusion, before_layer(3, &["M104 S0"])),
        (
            Kind::ColdExtrusion,
            clean([3, 5]).into_iter().filter(|l| !l.starts_with("M10")).collect::<Vec<_>>().join("\n"),
        ),
        (Kind::RetractedExtrusion, before_layer(3, &["G1 E-1"])),
        (Kind::RetractedExtrusion, before_layer(3, &["G10", "G1 E1", "G1 X101 E.03", "G11", "G1 E-1"])),
        (Kind::ExtrusionInPlace, before_layer(3, &["G1 E1", "G1 E.5", "G1 E-1"])),
        (Kind::UnbalancedRetraction, before_layer(3, &["G1 E1.5", "G1 E-1"])),
        (Kind::UnbalancedRetraction, before_layer(3, &["G1 E-.2"])),
        (Kind::UnbalancedRetraction, before_layer(3, &["G10", "G10", "G11"])),
        (Kind::OutsideAtStart, replaced("M109 S210", "M109 S210\nG0 X-20 Y10")),
        (Kind::HeaterLeftOn, replaced("M140 S0", "")),
        (Kind::NotAwaited, replaced("M109 S210", "")),
        (Kind::UnknownCommand, before_layer(3, &["G777"])),
        (Kind::Speed, before_layer(3, &["G0 X90 Y90 F60000"])),
        (Kind::Acceleration, before_layer(3, &["M204 S50000"])),
        (Kind::FewDecimals, clean([1, 5]).join("\n")),
        (Kind::FewDecimals, clean([3, 2]).join("\n")),
        (
            Kind::CoarseAmounts,
            before_layer(3, &["M82", "G92 E70000", "G1 E70001", "G1 X101 E70001.03", "M83", "G1 E-1"]),
        ),
        (Kind::NoTemperature, replaced("M104 S210", "START_PRINT").replace("M109 S210\n", "")),
    ];
    for (kind, text) in &planted {
        let report = report(text, &Settings::default());
        assert_eq!(kinds(&report), [*kind], "{report}");
        assert_eq!(report.errors > 0, kind.severity() == Severity::Error);
    }
    let mut limited = Settings::default();
    limited.filament.max_flow = Mm3PerS(6.0);
    assert_eq!(kinds(&report(clean([3, 5]).join("\n"), &limited)), []);
    let fast = before_layer(3, &["G1 E1", "G1 X125 E.9 F1800", "G1 E-1"]);
    assert_eq!(kinds(&report(&fast, &limited)), [Kind::Flow]);
}

#[test]
fn after_makerbots_homing_the_nozzle_is_where_g92_says() {
    let homed = replaced("G28", "G28\nG0 X20 Y20 Z10 F3000\nG162 X Y F3000\nG161 Z F450\nG92 X240 Y240 Z0");
    let report = report(homed, &Settings::default());
    assert!(!kinds(&report).contains(&Kind::OutsideBed), "{report}");
}

#[test]
fn a_fault_is_told_with_its_line_and_layer_and_many_of_a_kind_are_one() {
    let text = before_layer(4, &["G0 X251", "G0 X252", "G0 X253", "G0 X254", "G0 X255", "G0 X256", "G0 X10"]);
    let report = report(&text, &Settings::default());
    let line = text.lines().position(|line| line == "G0 X251").expect("planted") + 1;
    let fault = &report.faults[0];
    assert_eq!((fault.count, fault.first.len()), (6, 5));
    // The layer begins with its first bead.
    assert_eq!((fault.first[0].line, fault.first[0].layer), (line, Some(4)));
    let json = serde_json::to_value(&report).expect("JSON");
    assert_eq!(json["faults"][0]["kind"], "outside-bed");
    assert_eq!((&json["errors"], &json["faults"][0]["severity"]), (&1.into(), &"error".into()));
}

#[test]
fn objects_printed_one_after_the_other_begin_at_the_bed_again() {
    let print = clean([3, 5]);
    let end = print.iter().position(|line| line == ";TYPE:Custom").expect("an end");
    let second: Vec<String> = print[9..end].iter().map(|l| l.replace("Y1", "Y2")).collect();
    let lift = ["G0 Z20 F600", "G0 X100 Y200 F9000"].map(String::from);
    let join = |label: &str| {
        [&print[..end], &lift, &[label.to_string()], &second, &print[end..]].concat().join("\n")
    };
    let settings = Settings::default();
    // The second print's first loop begins with the filament pulled back by the first.
    let of_order = |text: &str| kinds(&report(text, &settings)).contains(&Kind::HeightOrder);
    assert!(of_order(&join("")));
    assert!(!of_order(&join("; printing object b")) && !of_order(&join("M486 S1")));
}

#[test]
fn expressions_of_reprapfirmware_stand_for_numbers() {
    let text =
        |x: &str| format!("M109 S210\nG28\nG90\nM83\nG1 X9 Y9 Z.2 F600\nG1 Y9 F{{var.f}} X{x}\nM104 S0");
    let settings = Settings::default();
    assert_eq!(kinds(&report(text("{move.axes[0].min + 9}"), &settings)), []);
    assert_eq!(kinds(&report(text("{move.axes[0].min"), &settings)), [Kind::Malformed]);
}

#[test]
fn round_beds_end_where_they_are_round() {
    let delta = settings(&["delta-round"], &[]);
    let text =
        |place: &str| format!("M109 S210\nG28\nG90\nM83\nG1 X0 Y0 Z.2 F600\nG1 X10 E.3\nG0 {place}\nM104 S0");
    assert_eq!(kinds(&report(text("X80 Y80"), &delta)), []);
    assert_eq!(kinds(&report(text("X100 Y100"), &delta)), [Kind::OutsideBed]);
}

fn sliced(facets: &Facets, settings: &Settings) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("part.stl");
    std::fs::write(&model, stl(facets)).expect("written");
    of_models(vec![model], settings)
}

fn of_models(models: Vec<PathBuf>, settings: &Settings) -> Vec<u8> {
    let job = Job::of(models);
    let mut output = Output::memory();
    Pipeline.slice(&job, settings, &mut output, &Observer::none()).expect("a print");
    output.into_bytes()
}

fn beside(text: &[u8], facets: &Facets, settings: &Settings) -> CheckReport {
    let bodies = Layout::single("part", mesh(facets).0, 1).standing_bodies();
    found::beside(text, &bodies, settings)
}

/// The print, its E relative, without the filament of beads that end at an X beyond some place, on some layers.
fn without(text: &[u8], layers: std::ops::Range<usize>, beyond_mm: f64) -> Vec<u8> {
    let (mut layer, mut x) = (0, 0.0);
    let text = String::from_utf8_lossy(text);
    let lines = text.lines().map(|line| {
        layer += usize::from(line == ";LAYER_CHANGE");
        let words = || line.split(' ').skip(1);
        x = words().find_map(|word| word.strip_prefix('X')?.parse().ok()).unwrap_or(x);
        let bead = line.starts_with("G1 ") && words().any(|word| word.starts_with(['X', 'Y']));
        match bead && layers.contains(&layer) && x > beyond_mm {
            true => line.split(' ').filter(|word| !word.starts_with('E')).collect::<Vec<_>>().join(" "),
            false => line.to_string(),
        }
    });
    lines.collect::<Vec<_>>().join("\n").into_bytes()
}

#[test]
fn a_print_is_compared_with_its_model() {
    let settings = standard(&["gcode.relative_e=true"]);
    let towers = [cuboid([0.0; 3], [10.0, 10.0, 4.0]), cuboid([20.0, 0.0, 0.0], [30.0, 10.0, 4.0])].concat();
    let print = sliced(&towers, &settings);
    let whole = beside(&print, &towers, &settings);
    assert_eq!(kinds(&whole), [], "{whole}");
    let model = whole.model.expect("compared");
    assert_eq!((model.islands, model.missing_islands), (40, 0));
    assert!((model.mesh_volume_mm3 - 800.0).abs() < 1e-3);

    // The last layer of the second tower is left out.
    let part = beside(&without(&print, 20..21, 125.0), &towers, &settings);
    assert_eq!(kinds(&part), [Kind::MissingIsland], "{part}");
    assert_eq!(part.model.expect("compared").missing_islands, 1);

    let text = String::from_utf8_lossy(&print);
    let planted = text.replacen(
        ";LAYER_CHANGE\n;Z:2\n",
        ";LAYER_CHANGE\n;Z:2\n;TYPE:Perimeter\nG0 X120 Y115\nG1 Z2\nG1 Y120 E.16\n",
        1,
    );
    assert_ne!(planted, text);
    let extra = beside(planted.as_bytes(), &towers, &settings);
    assert!(kinds(&extra).contains(&Kind::ExtraMaterial), "{extra}");

    let thick = standard(&["filament.flow=2.5"]);
    assert_eq!(kinds(&beside(&sliced(&towers, &thick), &towers, &settings)), [Kind::OverVolume]);
    let other = ball([60.0, 0.0, 10.0], 10.0, 3);
    assert_eq!(kinds(&beside(&print, &other, &settings)), [Kind::NotPlaced]);
}

#[test]
fn a_print_may_end_below_a_needles_tip_but_not_below_more() {
    let settings = settings(&["default"], &[]);
    let needle = needle(2.0, 20.0);
    let report = beside(&sliced(&needle, &settings), &needle, &settings);
    assert!(!kinds(&report).contains(&Kind::MissingIsland), "{report}");
    let tower = |high_mm: f32| cuboid([0.0; 3], [10.0, 10.0, high_mm]);
    let report = beside(&sliced(&tower(4.0), &settings), &tower(6.0), &settings);
    assert_eq!(kinds(&report), [Kind::MissingIsland], "{report}");
}

#[test]
fn beads_that_rise_belong_to_the_layer_that_they_rise_to() {
    let cube = cuboid([0.0; 3], [10.0, 10.0, 4.0]);
    // Many short pieces, of which some do not rise by a micrometre.
    let round = ball([10.0, 10.0, 8.0], 10.0, 4);
    for (facets, sets) in [
        (&cube, ["seam.scarf=5", "seam.position=aligned"]),
        (&round, ["seam.scarf=8", "seam.position=rear"]),
        (&cube, ["spiral.enabled=true", "skirt.loops=0"]),
        (&round, ["spiral.enabled=true", "spiral.smooth=false"]),
    ] {
        let settings = settings(&["default"], &[&["order.strategy=nearest"], &sets[..]].concat());
        let print = sliced(facets, &settings);
        let report = beside(&print, facets, &settings);
        assert!(kinds(&report).iter().all(|kind| *kind == Kind::OverAir), "{sets:?} {report}");
        let model = report.model.expect("compared");
        let layers = String::from_utf8_lossy(&print).matches(";LAYER_CHANGE").count();
        assert!((layers - 3..=layers + 1).contains(&model.islands), "{sets:?} {model} {layers}");
        assert_eq!(model.missing_islands, 0, "{sets:?} {model}");
    }
}

#[test]
fn a_print_without_walls_is_found_and_no_edges_are_asked_for() {
    let cube = cuboid([0.0; 3], [10.0, 10.0, 4.0]);
    for pattern in ["rectilinear", "concentric"] {
        let pattern = format!("infill.pattern={pattern}");
        let settings = standard(&["walls.count=0", "skirt.loops=2", &pattern]);
        let report = beside(&sliced(&cube, &settings), &cube, &settings);
        assert!(kinds(&report).iter().all(|kind| *kind == Kind::OverAir), "{report}");
    }
}

#[test]
fn a_turn_of_a_spiral_that_is_mostly_left_out_is_missed() {
    let cube = cuboid([0.0; 3], [10.0, 10.0, 4.0]);
    let settings = standard(&["spiral.enabled=true", "gcode.relative_e=true"]);
    let whole = sliced(&cube, &settings);
    let report = beside(&without(&whole, 12..14, 121.0), &cube, &settings);
    assert!(kinds(&report).contains(&Kind::MissingIsland), "{report}");
}

/// A pyramid on a square.
fn needle(wide_mm: f64, high_mm: f64) -> Facets {
    let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|[x, y]| [(x * wide_mm) as f32, (y * wide_mm) as f32, 0.0]);
    let tip = [(wide_mm / 2.0) as f32, (wide_mm / 2.0) as f32, high_mm as f32];
    vec![[a, c, b], [a, d, c], [a, b, tip], [b, c, tip], [c, d, tip], [d, a, tip]]
}

#[test]
fn beads_over_air_are_found_and_bridges_are_none() {
    let settings = standard(&[]);
    let table =
        [cuboid([10.0, 10.0, 0.0], [14.0, 14.0, 3.0]), cuboid([0.0, 0.0, 3.0], [24.0, 24.0, 4.0])].concat();
    let report = beside(&sliced(&table, &settings), &table, &settings);
    assert_eq!(kinds(&report), [Kind::OverAir], "{report}");
    assert!(report.to_string().contains(" mm of "), "what they are part of: {report}");
    assert!(report.model.expect("compared").over_air_mm > 100.0);
    let feet = [cuboid([0.0; 3], [4.0, 10.0, 3.0]), cuboid([20.0, 0.0, 0.0], [24.0, 10.0, 3.0])].concat();
    let gate = [feet, cuboid([0.0, 0.0, 3.0], [24.0, 10.0, 4.0])].concat();
    let report = beside(&sliced(&gate, &settings), &gate, &settings);
    assert_eq!(kinds(&report), [], "{report}");
}

#[test]
fn our_own_files_are_clean_scripts_and_all() {
    let cube = model("calibration_cube");
    let bridge = model("overhang_and_bridge");
    let quick = "order.strategy=nearest";
    let jobs: &[(&Path, &[&str], &[&str])] = &[
        (&cube, &["default"], &[quick]),
        (&cube, &["standard-job"], &[quick, "gcode.relative_e=false", "gcode.arcs=true"]),
        (&cube, &["ender-3", "petg"], &[quick, "gcode.labels=true", "retract.wipe=1", "retract.z_hop=0.3"]),
        (&cube, &["prusa-i3", "abs"], &[quick, "retract.firmware=true", "gcode.limits=true"]),
        (&cube, &["corexy-klipper", "tpu"], &[quick, "gcode.labels=true", "gcode.limits=true"]),
        (&cube, &["delta-round"], &[quick, "raft.layers=3"]),
        (&bridge, &["speed"], &["support.enabled=true", "brim.width=3", "order.effort=fast"]),
    ];
    for (model, profiles, sets) in jobs {
        let settings = settings(profiles, sets);
        let text = of_models(vec![model.to_path_buf()], &settings);
        let report = report(&text, &settings);
        let worst: Vec<Kind> =
            report.faults.iter().filter(|f| f.severity > Severity::Note).map(|f| f.kind).collect();
        assert_eq!(worst, [], "{profiles:?} {sets:?}\n{report}");
    }
}

#[test]
fn what_scripts_leave_behind_stops_no_run() {
    let cube = model("calibration_cube");
    let mut settings = standard(&[]);
    let primed = "G28\nG1 Z1.2 F600\nG1 X9 Y9 F6000\nG1 X60 E9";
    for start in ["G28\nG1 E-3 F2400", "G28\nG10", "G28\nG0 X-30 Y400 F9000\nG1 E5", "START_PRINT", primed] {
        settings.gcode.start = start.into();
        settings.gcode.end = "G1 E9\nG0 X999 Z-1".into();
        assert!(!of_models(vec![cube.clone()], &settings).is_empty());
    }
}

#[test]
fn memory_does_not_grow_with_the_faults() {
    let mut checker = Checker::new(&Settings::default());
    for _ in 0..100_000 {
        checker.text(b"G1 X999 Y1 F6000\n");
    }
    let faults = checker.finish().into_faults();
    assert_eq!((faults.len(), faults[0].count, faults[0].first.len()), (1, 100_000, 5));
}

#[test]
fn every_kind_has_a_name_of_its_own() {
    let names: BTreeSet<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    assert_eq!(names.len(), Kind::ALL.len());
}
