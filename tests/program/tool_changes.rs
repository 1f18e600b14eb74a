//! What changes of tool take, and where flushes go: times, towers, shields, widths.

use std::collections::{BTreeMap, BTreeSet};

use crate::support::found::{kinds, report};
use crate::support::print::{Print, run};
use crate::tools::{LEFT, RIGHT, boxes, near, pair, several, text, timed_as_said, volumes, with_tools};
use pathwright::check::Kind;
use pathwright::estimate::Machine;
use pathwright::gcode::{Action, file_time, replay};
use pathwright::job::{Job, ObjectSettings};
use pathwright::profile::{self, Settings};
use pathwright::toolpath::bead;
use pathwright::units::Mm;

#[test]
fn the_summary_counts_changes_waits_and_scripts_as_the_file_is_timed() {
    let heated = ["tools.1.idle_temperature=150", "tools.2.idle_temperature=150"];
    let moved = "tool_change.script=G4 P1500";
    for sets in [
        &["tool_change.kind=single-nozzle", "tools.2.temperature.nozzle=240", moved][..],
        &["tool_change.kind=tool-changer", heated[0], heated[1], "tools.2.tool_change.time=4"],
    ] {
        let (print, settings) = pair(&[sets, &["tool_change.flush_volume=20"]].concat());
        let machine = Machine::new(&settings);
        let timed = timed_as_said(&print, &machine, 0.004);
        let changes = print.summary.tool_changes as f64;
        // Neither changes nor what is waited for after them.
        let unheated = text(&print).replace("; tool_heating_rate", ";");
        let moves = Machine { change_is_fixed: true, change_s: 0.0, heating_rate: 0.0, ..machine };
        let without = file_time(unheated.as_bytes(), &moves).0;
        let least = if sets[0].ends_with("single-nozzle") { 10.0 + 15.0 / 2.0 } else { 6.9 };
        assert!(
            timed - without > least * (changes - 1.0),
            "{timed} with {changes} changes, {without} without"
        );
    }
}

#[test]
fn tools_that_come_again_soon_stay_hot_so_that_scripts_which_wait_before_they_take_one_wait_for_little() {
    let (print, settings) = pair(&[
        "prime_tower.flush_width=1",
        "tool_change.kind=tool-changer",
        "tools.1.idle_temperature=120",
        "tools.2.idle_temperature=120",
        "tool_change.script=M109 S{temperature[next_extruder]} T[next_extruder]\nT[next_extruder]",
    ]);
    assert!(text(&print).contains("\nM109 S210 T1\nT1\n"));
    let machine = Machine::new(&settings);
    let timed = timed_as_said(&print, &machine, 0.01);
    let unheated = text(&print).replace("; tool_heating_rate", ";");
    let waited = timed - file_time(unheated.as_bytes(), &Machine { heating_rate: 0.0, ..machine }).0;
    let changes = print.summary.tool_changes;
    let cooled = text(&print).matches("S120\n").count();
    assert!(cooled < changes && waited < 2.0 * changes as f64, "{waited} s, {cooled} times of {changes}");
}

#[test]
fn tools_are_heated_before_the_change_of_another_where_the_time_for_it_falls_into_that() {
    let folder = tempfile::tempdir().unwrap();
    let idle =
        ["tools.1.idle_temperature=100", "tools.2.idle_temperature=100", "tools.3.idle_temperature=100"];
    let sets = [
        "tool_change.kind=tool-changer",
        "tool_change.time=20",
        "tool_change.ahead=0",
        "tool_change.script=M109 S{temperature[next_extruder]} T[next_extruder]\nT[next_extruder]",
        "cooling.min_layer_time=0",
        "skirt.loops=0",
    ];
    let base = several(3, &[&sets[..], &idle].concat());
    let third = ("third", [40.0, 0.0, 0.0], [50.0, 20.0, 3.0]);
    let job = with_tools(boxes(&folder, &[LEFT, RIGHT, third]), &base, &[("right", 2), ("third", 3)]);
    let print = run(&job, &base).expect("a print");
    timed_as_said(&print, &Machine::new(&base), 0.01);
}

#[test]
fn a_tool_that_cools_down_is_heated_in_the_layers_before_as_long_as_that_takes() {
    let folder = tempfile::tempdir().unwrap();
    // Layers of some 6 s; the second tool prints a belt high up, and takes 60 s to be hot.
    let base = several(
        2,
        &[
            "tool_change.kind=tool-changer",
            "tools.2.idle_temperature=150",
            "tools.2.heating_rate=1",
            "tool_of.heights=6-6.4:2",
            "cooling.min_layer_time=6",
            "skirt.loops=0",
        ],
    );
    let print = run(&boxes(&folder, &[("post", [0.0; 3], [8.0, 8.0, 8.0])]), &base).expect("a print");
    let (before, _) = text(&print).split_once("\nT1\n").expect("a change");
    let (start, heating) = before.rsplit_once("\nM104 T1 S210\n").expect("it is heated before");
    let layers = heating.matches(";LAYER_CHANGE").count();
    assert!((2..20).contains(&layers), "{layers} layers before");
    let seconds = |text: &str| file_time(text.as_bytes(), &Machine::new(&base)).0;
    let heated_s = seconds(before) - seconds(start);
    assert!((58.0..75.0).contains(&heated_s), "{heated_s}");
}

/// By PrusaSlicer's rule each layer begins with the tool in use, if it has it, and the others follow by number.
#[test]
fn by_the_rule_loaded_first_a_layer_begins_with_the_tool_in_use_and_goes_on_by_number() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(4, &["tool_change.order=loaded-first", "tool_change.ahead=0", "skirt.loops=0"]);
    let tops_mm = [("one", 4.0), ("two", 2.0), ("three", 4.0), ("four", 3.0)];
    let places = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
    let posts: Vec<_> = tops_mm
        .iter()
        .zip(places)
        .map(|(&(name, top_mm), [x, y])| (name, [x, y, 0.0], [x + 8.0, y + 8.0, top_mm]))
        .collect();
    let job = with_tools(boxes(&folder, &posts), &base, &[("one", 3), ("two", 1), ("three", 2), ("four", 4)]);
    let print = run(&job, &base).expect("a print");
    let of_tools = [(2, 4.0), (0, 2.0), (1, 4.0), (3, 3.0)];
    let mut expected = Vec::new();
    let mut loaded = 0;
    for layer in 0..20 {
        let z_mm = 0.2 * f64::from(layer) + 0.1;
        let mut tools: Vec<u32> =
            of_tools.iter().filter(|(_, top)| z_mm < *top).map(|(tool, _)| *tool).collect();
        tools.sort_by_key(|tool| (*tool != loaded, *tool));
        loaded = *tools.last().expect("two posts go to the top");
        expected.extend(tools);
    }
    expected.dedup();
    let taken = |line: &str| line.strip_prefix('T').and_then(|tool| tool.parse().ok());
    let mut tools: Vec<u32> = text(&print).lines().filter_map(taken).collect();
    tools.insert(0, 0);
    tools.dedup();
    assert_eq!(tools, expected);
    assert_eq!(print.summary.tool_changes, expected.len() - 1);
}

/// The file without what is printed as a prime tower.
fn without_tower(text: &str) -> String {
    let (mut kept, mut tower) = (String::new(), false);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix(";TYPE:") {
            tower = name == "Wipe tower";
        }
        let bead = line.starts_with("G1 X") || line.starts_with("G1 Y");
        if !(tower && bead && line.contains(" E")) {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}

#[test]
fn a_tower_that_is_missing_from_a_file_is_found_at_every_change_that_needs_it() {
    for sets in [&[][..], &["tool_change.flush_into_infill=true", "infill.density=40%"]] {
        let (print, settings) = pair(&[sets, &["tool_change.flush_volume=90"]].concat());
        let found = |text: &str| {
            let report = report(text.as_bytes(), &settings);
            report
                .faults
                .iter()
                .filter(|fault| fault.kind == Kind::MissingFlush)
                .map(|fault| fault.count)
                .sum::<usize>()
        };
        assert_eq!(found(text(&print)), 0, "{sets:?}");
        assert_eq!(found(&without_tower(text(&print))), print.summary.tool_changes, "{sets:?}");
        // Who says nothing of a tower has none to miss.
        let other = without_tower(text(&print)).replace("; wipe_tower = 1\n", "");
        assert_eq!(found(&other), 0);
    }
}

#[test]
fn a_tower_that_is_missing_from_another_slicers_file_is_found_where_it_tells_the_flushes() {
    let (print, settings) = pair(&["tool_change.flush_volume=90"]);
    let theirs = text(&print).replace("; generated by Pathwright", "; generated by PrusaSlicer");
    // At the end, as they do.
    let [with, without] = [theirs.clone(), without_tower(&theirs)].map(|text| {
        let told: Vec<&str> = text.lines().filter(|line| line.contains("wip")).collect();
        let rest: Vec<&str> = text.lines().filter(|line| !line.contains("wip")).collect();
        kinds(&report(format!("{}\n{}\n", rest.join("\n"), told.join("\n")).as_bytes(), &settings))
    });
    assert_eq!((with, without), (vec![], vec![Kind::MissingFlush]));
}

/// Types of beads after each change of tool, in their order, without repetitions.
fn types_after_changes(print: &Print) -> Vec<Vec<String>> {
    let (mut all, mut begun): (Vec<Vec<String>>, bool) = (Vec::new(), false);
    for line in text(print).lines() {
        begun |= line == ";LAYER_CHANGE";
        if begun && matches!(line, "T0" | "T1" | "T2") {
            all.push(Vec::new());
        } else if let (Some(name), Some(last)) = (line.strip_prefix(";TYPE:"), all.last_mut()) {
            last.push(name.to_owned());
        }
    }
    all
}

#[test]
fn travels_within_the_tower_are_not_retracted() {
    let print = pair(&["tool_change.flush_volume=60", "retract.min_travel=0"]).0;
    let (mut begun, mut tower, mut retracted, mut far) = (false, false, false, 0);
    // Where the tower was left.
    let mut left: Option<[f64; 3]> = None;
    for step in replay(&print.text) {
        begun |= step.line.text.starts_with(b";LAYER_CHANGE");
        if step.line.code.is_some_and(|code| code.letter == b'T') {
            left = None;
        }
        match step.action {
            Action::Type(name) => tower = name == b"Wipe tower",
            Action::Stroke(stroke) if begun && stroke.extrudes() => {
                let from = left.filter(|from| tower && from[2] == stroke.from[2]);
                if from.is_some_and(|from| (from[0] - stroke.from[0]).hypot(from[1] - stroke.from[1]) > 0.3) {
                    assert!(!retracted, "from {left:?} to {:?}", stroke.from);
                    far += 1;
                }
                (left, retracted) = (tower.then_some(stroke.to), false);
            }
            Action::Stroke(stroke) => retracted |= stroke.retracts,
            _ => {}
        }
    }
    assert!(far >= print.summary.tool_changes, "{far} travels");
}

#[test]
fn tools_are_flushed_into_lines_so_wide_and_so_far_apart() {
    let sets =
        ["tool_change.flush_volume=200", "prime_tower.flush_width=2.5", "prime_tower.flush_spacing=1.2"];
    let (print, settings) = pair(&sets);
    let area_mm2 = profile::filament_area_mm2(Mm(1.75));
    let height_mm = settings.layer.height.0;
    let usual_mm2 = bead::area_mm2(settings.walls.width.0, height_mm);
    let wide_mm2 = bead::area_mm2(2.5 * settings.walls.width.0, height_mm);
    let (mut tower, mut layer, mut rows) = (false, 0, Vec::new());
    for step in replay(&print.text) {
        layer += usize::from(step.line.text.starts_with(b";LAYER_CHANGE"));
        match step.action {
            Action::Type(name) => tower = name == b"Wipe tower",
            Action::Stroke(stroke) if stroke.extrudes() && tower && layer > 1 && stroke.xy_mm > 5.0 => {
                let mm2 = stroke.fresh_mm3(area_mm2) / stroke.xy_mm;
                let is_wide = mm2 > 1.5 * usual_mm2;
                assert!((mm2 / if is_wide { wide_mm2 } else { usual_mm2 } - 1.0).abs() < 0.02, "{mm2} mm²");
                if is_wide && stroke.from[1] == stroke.to[1] {
                    rows.push((layer, stroke.from[1]));
                }
            }
            _ => {}
        }
    }
    let wanted_mm = 1.2 * bead::spacing_mm(2.5 * settings.walls.width.0, height_mm);
    let apart = rows.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1 - pair[0].1);
    assert!(apart.clone().count() > 20);
    assert!(apart.clone().all(|mm| (mm - wanted_mm).abs() < 0.002), "{:?}", apart.collect::<Vec<_>>());
}

#[test]
fn an_object_that_takes_flushes_is_whole_of_both_tools_and_spares_the_tower() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &["tool_change.flush_volume=60", "skirt.loops=0"]);
    let sink = ("sink", [0.0, 30.0, 0.0], [30.0, 50.0, 3.0]);
    let slice = |flush: bool| {
        let mut job = with_tools(boxes(&folder, &[LEFT, RIGHT, sink]), &base, &[("right", 2)]);
        if flush {
            let settings = base.clone().set("tool_of.flush", "true").expect("a flag");
            job.objects.push(ObjectSettings { object: "sink".into(), settings });
        }
        run(&job, &base).expect("a print")
    };
    let (without, with) = (slice(false), slice(true));
    let flushed = |print: &Print| print.summary.tools.iter().map(|tool| tool.flushed_mm3).sum::<f64>();
    assert!(flushed(&with) < 0.6 * flushed(&without), "{} of {}", flushed(&with), flushed(&without));
    let in_sink = |print: &Print| {
        let (mut tool, mut begun, mut sums) = (0, false, [0.0; 2]);
        for step in replay(&print.text) {
            begun |= step.line.text.starts_with(b";LAYER_CHANGE");
            if let Some(code) = step.line.code.filter(|code| code.letter == b'T') {
                tool = code.number as usize;
            }
            let Action::Stroke(stroke) = step.action else { continue };
            let [x, y, _] = stroke.to;
            if begun && stroke.extrudes() && (99.0..131.0).contains(&x) && (129.0..151.0).contains(&y) {
                sums[tool] += stroke.fresh_mm;
            }
        }
        sums
    };
    let ([all, none], [first, second]) = (in_sink(&without), in_sink(&with));
    assert!(none == 0.0 && near(first + second, all), "{all}, {first}, {second}");
    assert!(first > 0.1 * all && second > 0.1 * all, "{first}, {second} of {all}");
    assert_eq!(kinds(&report(&with.text, &base)), []);
}

#[test]
fn every_tool_passes_the_ooze_shield_before_it_prints_a_part() {
    let (print, settings) = pair(&["tool_change.ooze_shield=true", "tool_change.flush_volume=20"]);
    let changes = types_after_changes(&print);
    assert!(changes.len() > 10);
    for types in changes {
        assert_eq!(types[..2], ["Wipe tower", "Skirt/Brim"], "{types:?}");
    }
    let beads = print.beads();
    let shield: Vec<_> = beads.iter().filter(|bead| bead.kind == "Skirt/Brim").collect();
    // 2 mm around 35 × 20 mm, and half a width, with corners.
    let wanted = 2.0 * (35.0 + 20.0) + 8.0 * 2.225;
    let mut by_height: BTreeMap<i64, f64> = BTreeMap::new();
    for bead in &shield {
        *by_height.entry((bead.z_mm * 1000.0).round() as i64).or_default() += bead.length_mm();
    }
    assert_eq!(by_height.len(), 15, "as high as the parts, which both end at 3 mm: {by_height:?}");
    assert!(by_height.values().all(|mm| (mm - wanted).abs() < 0.5), "{wanted}: {by_height:?}");
    assert_eq!(kinds(&report(&print.text, &settings)), []);
}

/// A large box and a small one, which the program arranges on a bed of 120 mm.
fn on_a_full_bed(side_mm: f64, sets: &[&str]) -> (Job, Settings, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let small = ["bed.size=[120, 120]", "tool_change.flush_volume=20", "printer.flavor=marlin"];
    let base = several(2, &[&small, sets].concat());
    let mut job = boxes(
        &folder,
        &[("large", [0.0; 3], [side_mm, side_mm, 2.0]), ("small", [0.0; 3], [10.0, 10.0, 2.0])],
    );
    job.models.iter_mut().for_each(|model| model.at_mm = None);
    (with_tools(job, &base, &[("small", 2)]), base, folder)
}

#[test]
fn objects_leave_room_for_the_tower_where_the_bed_has_it() {
    for sets in [&["skirt.loops=0"][..], &["skirt.loops=1"]] {
        let (job, base, _folder) = on_a_full_bed(84.0, sets);
        let print = run(&job, &base).expect("the tower fits beside the large box");
        assert_eq!(kinds(&report(&print.text, &base)), [], "{sets:?}");
        let beads = print.beads();
        let reach = |kind: &str| {
            let of_kind = beads.iter().filter(|bead| bead.kind.contains(kind));
            of_kind
                .flat_map(|bead| bead.points.iter())
                .fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |[x0, y0, x1, y1], &[x, y]| {
                    [x0.min(x), y0.min(y), x1.max(x), y1.max(y)]
                })
        };
        let tower = reach("Wipe tower");
        let walls = beads.iter().filter(|bead| bead.kind.contains("erimeter"));
        let inside = |[x, y]: &[f64; 2]| {
            (tower[0] - 1.0..tower[2] + 1.0).contains(x) && (tower[1] - 1.0..tower[3] + 1.0).contains(y)
        };
        assert!(walls.flat_map(|bead| &bead.points).all(|point| !inside(point)), "{tower:?}");
        if sets[0].ends_with('1') {
            let skirt = reach("Skirt");
            let encloses =
                skirt[0] < tower[0] && skirt[1] < tower[1] && skirt[2] > tower[2] && skirt[3] > tower[3];
            assert!(encloses, "{skirt:?} around {tower:?}");
        }
    }
}

#[test]
fn a_bed_that_is_too_full_for_the_tower_is_told_so() {
    let (job, base, _folder) = on_a_full_bed(105.0, &["skirt.loops=0", "bed.size=[120, 120]"]);
    let error = run(&job, &base).err().expect("there is no room").to_string();
    assert!(error.contains("no room on the bed for the prime tower"), "{error}");
}

/// Widths of the beads of each tool by their types, after the first layer.
fn widths(print: &Print) -> BTreeMap<(u32, String), BTreeSet<String>> {
    let (mut tool, mut kind, mut layer) = (0, String::new(), 0);
    let mut widths: BTreeMap<(u32, String), BTreeSet<String>> = BTreeMap::new();
    let mut width = String::new();
    for line in text(print).lines() {
        layer += usize::from(line == ";LAYER_CHANGE");
        if let Some(number) = line.strip_prefix('T').and_then(|number| number.parse().ok()) {
            tool = number;
        } else if let Some(name) = line.strip_prefix(";TYPE:") {
            kind = name.to_owned();
        } else if let Some(mm) = line.strip_prefix(";WIDTH:") {
            width = mm.to_owned();
        } else if layer > 1 && line.starts_with("G1 X") && line.contains(" E") && !line.contains(" E-") {
            widths.entry((tool, kind.clone())).or_default().insert(width.clone());
        }
    }
    widths
}

#[test]
fn lines_are_as_wide_as_the_nozzle_of_their_tool_asks_or_as_it_says() {
    // Infill is fitted to its density, by a few hundredths.
    let is = |print: &Print, tool: u32, kind: &str, wanted_mm: f64| {
        let found = widths(print).remove(&(tool, kind.to_owned())).expect("beads of that type");
        let near = |width: &String| (width.parse::<f64>().unwrap() / wanted_mm - 1.0).abs() < 0.06;
        assert!(found.iter().all(near), "tool {tool}, {kind}: {found:?}, wanted {wanted_mm}");
    };
    let nozzle = "tools.2.printer.nozzle_diameter=0.6";
    let (print, settings) = pair(&[nozzle, "prime_tower.flush_width=1"]);
    for kind in ["Perimeter", "External perimeter", "Internal infill", "Wipe tower"] {
        is(&print, 0, kind, 0.45);
        is(&print, 1, kind, 0.675);
    }
    assert_eq!(kinds(&report(&print.text, &settings)), []);
    let (print, _) = pair(&[nozzle, "tools.2.walls.width=0.75"]);
    is(&print, 0, "Perimeter", 0.45);
    is(&print, 1, "Perimeter", 0.75);
    is(&print, 1, "External perimeter", 0.675);
    let (print, _) = pair(&[nozzle, "tool_of.infill=2"]);
    is(&print, 1, "Internal infill", 0.675);
    is(&print, 0, "Perimeter", 0.45);
}

#[test]
fn a_part_of_a_tool_with_another_nozzle_is_as_full_as_any() {
    let (print, _) = pair(&["tools.2.printer.nozzle_diameter=0.6", "infill.density=100%"]);
    let volumes = volumes(&print);
    assert!((volumes[&0][1] / 1200.0 - 1.0).abs() < 0.03, "{volumes:?}");
    assert!((volumes[&1][1] / 900.0 - 1.0).abs() < 0.03, "{volumes:?}");
}

#[test]
fn layers_of_many_short_beads_are_waited_for_as_the_file_is_timed() {
    let folder = tempfile::tempdir().unwrap();
    let heated =
        ["tools.1.idle_temperature=150", "tools.2.idle_temperature=150", "tool_change.kind=tool-changer"];
    let base = several(2, &[&heated[..], &["skirt.loops=0"]].concat());
    // Retractions and travels from pin to pin take most of the time.
    let pin = |n: usize| {
        let (x, y) = (5.0 * (n % 5) as f64, 30.0 + 5.0 * (n / 5) as f64);
        (["pin", "q", "r", "s", "t", "u", "v", "w", "x", "y"][n], [x, y, 0.0], [x + 2.0, y + 2.0, 4.0])
    };
    let pins: Vec<_> = (0..10).map(pin).collect();
    let tools: Vec<(&str, u32)> = pins.iter().map(|pin| (pin.0, 2)).collect();
    let cube = ("cube", [0.0; 3], [10.0, 10.0, 4.0]);
    let job = boxes(&folder, &[&[cube], &pins[..]].concat());
    let print = run(&with_tools(job, &base, &tools), &base).expect("a print");
    timed_as_said(&print, &Machine::new(&base), 0.005);
}
