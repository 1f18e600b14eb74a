//! Prints with several tools: who prints what, changes, the prime tower.

use std::collections::BTreeMap;

use crate::support::found::{kinds, report};
use crate::support::print::{Print, model, run, settings};
use pathwright::Observer;
use pathwright::estimate::Machine;
use pathwright::gcode::{Action, file_time, replay};
use pathwright::job::{Engine, Job, JobModel, ObjectSettings};
use pathwright::pipeline::Pipeline;
use pathwright::profile::{self, Settings};

/// The time that a file takes, in seconds; the summary says the same, but for a share.
#[track_caller]
pub fn timed_as_said(print: &Print, machine: &Machine, share: f64) -> f64 {
    let (said, timed) = (print.summary.total.total_s, file_time(&print.text, machine).0);
    assert!((said / timed - 1.0).abs() < share, "{said}, timed {timed}");
    timed
}

/// Settings of a printer with so many tools, each with filament of its own.
pub fn several(tools: usize, sets: &[&str]) -> Settings {
    let colors: Vec<String> =
        (1..=tools).map(|tool| format!("tools.{tool}.filament.color=#00000{tool}")).collect();
    let mut all: Vec<&str> =
        vec!["order.strategy=nearest", "filament.flow=1", "retract.z_hop=0.2", "gcode.relative_e=true"];
    all.extend(colors.iter().map(String::as_str));
    all.extend(sets);
    settings(&["standard-job"], &all)
}

/// Boxes at their places over a bed of 200 mm, each in a file of its own, from one corner to the other.
pub fn boxes(folder: &tempfile::TempDir, boxes: &[(&str, [f64; 3], [f64; 3])]) -> Job {
    let model = |(name, low, high): &(&str, [f64; 3], [f64; 3])| {
        let file = folder.path().join(format!("{name}.stl"));
        std::fs::write(&file, cuboid(*low, *high)).unwrap();
        let middle = [0, 1].map(|i| 100.0 + f64::midpoint(low[i], high[i]));
        JobModel { at_mm: Some([middle[0], middle[1], low[2]]), ..JobModel::from(file) }
    };
    Job { models: boxes.iter().map(model).collect(), ..Job::default() }
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> String {
    let corner = |number: usize| {
        let x = if matches!(number % 4, 1 | 2) { high[0] } else { low[0] };
        let y = if number % 4 > 1 { high[1] } else { low[1] };
        let z = if number > 3 { high[2] } else { low[2] };
        format!("vertex {x} {y} {z}\n")
    };
    let facets = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ];
    let facet = |[a, b, c]: [usize; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}{}{}endloop\nendfacet\n", corner(a), corner(b), corner(c))
    };
    format!("solid box\n{}endsolid box\n", facets.map(facet).concat())
}

/// The same with tools of the objects, from 1.
pub fn with_tools(job: Job, base: &Settings, tools: &[(&str, u32)]) -> Job {
    let own = |&(object, tool): &(&str, u32)| {
        let settings = base.clone().set("tool_of.object", &tool.to_string()).expect("a tool");
        ObjectSettings { object: object.into(), settings }
    };
    Job { objects: tools.iter().map(own).collect(), ..job }
}

/// What each tool extrudes along beads, mm³: into the prime tower, and elsewhere after the start script.
pub fn volumes(print: &Print) -> BTreeMap<u32, [f64; 2]> {
    let (mut tool, mut begun, mut tower) = (0, false, false);
    let mut volumes = BTreeMap::new();
    for step in replay(&print.text) {
        begun |= step.line.text.starts_with(b";LAYER_CHANGE");
        match step.action {
            Action::Type(name) => tower = name == b"Wipe tower",
            Action::Stroke(stroke) if begun && stroke.extrudes() => {
                let area_mm2 = profile::filament_area_mm2(pathwright::units::Mm(1.75));
                volumes.entry(tool).or_insert([0.0; 2])[usize::from(!tower)] += stroke.fresh_mm3(area_mm2);
            }
            _ => {}
        }
        if let Some(code) = step.line.code.filter(|code| code.letter == b'T') {
            tool = code.number;
        }
    }
    volumes
}

pub fn text(print: &Print) -> &str {
    std::str::from_utf8(&print.text).expect("text")
}

pub fn near(found: f64, wanted: f64) -> bool {
    (found / wanted - 1.0).abs() < 0.005
}

pub const LEFT: (&str, [f64; 3], [f64; 3]) = ("left", [0.0; 3], [20.0, 20.0, 3.0]);
pub const RIGHT: (&str, [f64; 3], [f64; 3]) = ("right", [20.0, 0.0, 0.0], [35.0, 20.0, 3.0]);

/// Two boxes side by side, each with a tool of its own.
pub fn pair(sets: &[&str]) -> (Print, Settings) {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &[&["skirt.loops=0"], sets].concat());
    let job = boxes(&folder, &[LEFT, RIGHT]);
    (run(&with_tools(job, &base, &[("right", 2)]), &base).expect("a print"), base)
}

#[test]
fn each_tool_prints_as_much_of_its_part_as_one_tool_of_the_part_alone() {
    let folder = tempfile::tempdir().unwrap();
    for density in ["infill.density=0%", "infill.density=100%"] {
        let (print, base) = pair(&[density, "shell.top_layers=0", "shell.bottom_layers=0"]);
        let volumes = volumes(&print);
        for (tool, part) in [(0, LEFT), (1, RIGHT)] {
            let one = Settings { tools: Vec::new(), ..base.clone() };
            let alone = run(&boxes(&folder, &[part]), &one).expect("a print").measure(&one).volume_mm3;
            assert!(near(volumes[&tool][1], alone), "{density}, {}: {volumes:?}, {alone}", part.0);
        }
    }
}

#[test]
fn what_parts_share_is_printed_once_by_the_later_one() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &["infill.density=100%", "skirt.loops=0"]);
    let job = boxes(
        &folder,
        &[("all", [0.0; 3], [30.0, 20.0, 3.0]), ("inside", [10.0, 5.0, 0.0], [20.0, 15.0, 3.0])],
    );
    let print = run(&with_tools(job, &base, &[("inside", 2)]), &base).expect("a print");
    let volumes = volumes(&print);
    // A full print is a little fuller than full.
    assert!((volumes[&0][1] / 1500.0 - 1.0).abs() < 0.03, "{volumes:?}");
    // All around, walls press into others by half of what the round sides of beads leave out.
    let more_mm = 0.1 * (1.0 - std::f64::consts::FRAC_PI_4);
    let larger = ("larger", [10.0 - more_mm, 5.0 - more_mm, 0.0], [20.0 + more_mm, 15.0 + more_mm, 3.0]);
    let one = Settings { tools: Vec::new(), ..base.clone() };
    let alone = run(&boxes(&folder, &[larger]), &one).expect("a print").measure(&one).volume_mm3;
    assert!(near(volumes[&1][1], alone), "{volumes:?}, {alone}");
}

#[test]
fn a_border_between_tools_is_no_surface() {
    let folder = tempfile::tempdir().unwrap();
    let stacked = |tool: u32| {
        let base = several(2, &["skirt.loops=0"]);
        let job = boxes(
            &folder,
            &[("low", [0.0; 3], [20.0, 20.0, 4.0]), ("high", [0.0, 0.0, 4.0], [20.0, 20.0, 8.0])],
        );
        let print = run(&with_tools(job, &base, &[("high", tool)]), &base).expect("a print");
        let top = |line: &&str| **line == *";TYPE:Top solid infill";
        text(&print).lines().filter(top).count()
    };
    assert_eq!(stacked(2), 1);
}

#[test]
fn one_tool_of_a_list_prints_the_bytes_of_a_printer_with_one() {
    let bytes =
        |settings: &Settings| run(&Job::of([model("calibration_cube")]), settings).expect("a print").text;
    let of_layers = |text: Vec<u8>| {
        let text = String::from_utf8(text).expect("text");
        let body = text.split_once(";LAYER_CHANGE").expect("layers").1;
        body.split(";TYPE:Custom").next().unwrap_or_default().to_owned()
    };
    let one = settings(
        &["standard-job"],
        &["order.strategy=nearest", "filament.flow=1", "retract.z_hop=0.2", "gcode.relative_e=true"],
    );
    assert!(of_layers(bytes(&one)) == of_layers(bytes(&several(2, &[]))));
}

#[test]
fn every_tool_is_taken_before_it_prints_and_heated_and_its_filament_is_back() {
    for kind in ["single-nozzle", "tool-changer", "heads"] {
        let (print, settings) = pair(&[
            &format!("tool_change.kind={kind}"),
            "tools.1.idle_temperature=150",
            "tools.2.idle_temperature=150",
            "tools.2.temperature.nozzle=230",
            "tools.2.temperature.nozzle_first_layer=230",
            "tool_change.flush_volume=20",
        ]);
        let lines: Vec<&str> = text(&print).lines().collect();
        let taken: Vec<usize> = (0..lines.len()).filter(|&i| lines[i] == "T0" || lines[i] == "T1").collect();
        let first_layer = lines.iter().position(|line| *line == ";LAYER_CHANGE").unwrap();
        assert!(taken[0] < first_layer, "the first tool is named before it prints");
        for &at in &taken[1..] {
            let before =
                lines[..at].iter().rev().find(|line| line.contains('E') && line.starts_with("G1")).unwrap();
            assert!(before.contains(" E-") || before.contains("E-"), "{kind}: pulled back: {before}");
            let after: Vec<&str> =
                lines[at..].iter().take_while(|line| !line.starts_with("G1")).copied().collect();
            let celsius = if lines[at] == "T1" { 230 } else { 210 };
            let wanted = match kind {
                "single-nozzle" => format!("M109 S{celsius}"),
                _ => format!("M109 {} S{celsius}", lines[at]),
            };
            assert!(after.contains(&wanted.as_str()), "{kind}: {after:?} has no {wanted}");
            let idle = lines[at.saturating_sub(3)..at].contains(&"M104 T0 S150")
                || lines[at.saturating_sub(3)..at].contains(&"M104 T1 S150");
            assert!(!idle || kind != "single-nozzle", "one heater for all: nothing is left to cool down");
        }
        assert_eq!(kinds(&report(&print.text, &settings)), [], "{kind}");
    }
}

#[test]
fn the_steps_of_a_change_come_in_the_order_that_firmware_needs() {
    for kind in ["tool-changer", "single-nozzle"] {
        let (print, _) = pair(&[
            &format!("tool_change.kind={kind}"),
            "tool_change.script=; change",
            "tool_change.flush_volume=20",
            "gcode.filament_start=; begin",
            "gcode.filament_end=; end",
            "tools.1.idle_temperature=150",
            "tools.2.idle_temperature=150",
            "tools.2.temperature.nozzle=230",
            "tools.2.temperature.nozzle_first_layer=230",
        ]);
        let lines: Vec<&str> = text(&print).lines().collect();
        let first = lines.iter().position(|line| *line == ";LAYER_CHANGE").expect("layers");
        let taken: Vec<usize> =
            (first..lines.len()).filter(|&i| lines[i] == "T0" || lines[i] == "T1").collect();
        assert!(taken.len() > 3, "{kind}: {} changes", taken.len());
        let is_bead = |line: &str| line.starts_with("G1 X") && line.contains(" E");
        for &at in &taken {
            let from = lines[..at].iter().rposition(|line| is_bead(line)).expect("a bead before");
            let to = at + lines[at..].iter().position(|line| is_bead(line)).expect("a bead behind");
            let (tool, celsius) = if lines[at] == "T1" { (1, 230) } else { (0, 210) };
            let idle = format!("M104 T{} S150", 1 - tool);
            let heat = match kind {
                "single-nozzle" => format!("M109 S{celsius}"),
                _ => format!("M109 T{tool} S{celsius}"),
            };
            let mut steps =
                vec!["G1 E-", &idle, "; end", "; change", lines[at], "; begin", &heat, "G1 X", "G1 E"];
            if kind == "single-nozzle" {
                // One heater for all: nothing is left to cool down, and the script has loaded the filament.
                steps.retain(|step| *step != idle && *step != "G1 E");
            }
            // A tool whose turn comes again before it would be hot does not cool down.
            steps.retain(|step| *step != idle || lines[from..at].contains(&idle.as_str()));
            let mut next = 0;
            for line in &lines[from + 1..=to] {
                next += usize::from(next < steps.len() && line.starts_with(steps[next]));
            }
            assert_eq!(
                next,
                steps.len(),
                "{kind}: {:?} is missing in {:#?}",
                steps.get(next),
                &lines[from..=to]
            );
        }
    }
}

#[test]
fn no_less_is_flushed_than_the_settings_list_and_the_tower_ends_with_the_last_change() {
    let folder = tempfile::tempdir().unwrap();
    let base =
        several(2, &["tool_change.flush_volumes=[0, 70, 30, 0]", "skirt.loops=0", "prime_tower.brim=0"]);
    let job = boxes(&folder, &[LEFT, ("right", RIGHT.1, [35.0, 20.0, 6.0])]);
    let print = run(&with_tools(job, &base, &[("right", 2)]), &base).expect("a print");
    let mut flushed = BTreeMap::new();
    let (mut tool, mut fresh, mut tower, mut top_mm) = (9, false, false, 0.0_f64);
    for step in replay(&print.text) {
        match step.action {
            Action::Type(name) => tower = name == b"Wipe tower",
            Action::Stroke(stroke) if stroke.extrudes() && tower => {
                let z_mm = stroke.to[2];
                top_mm = top_mm.max(z_mm);
                if fresh {
                    let area_mm2 = profile::filament_area_mm2(pathwright::units::Mm(1.75));
                    *flushed.entry((tool, (z_mm * 1000.0) as i64)).or_insert(0.0) +=
                        stroke.fresh_mm3(area_mm2);
                }
            }
            // Frame and lines of the tower are flushed into as well, but what comes after an object is not.
            Action::Stroke(stroke) if stroke.extrudes() => fresh = false,
            _ => {}
        }
        if let Some(code) = step.line.code.filter(|code| code.letter == b'T') {
            (fresh, tool, tower) = (tool != 9, code.number, false);
        }
    }
    assert!(flushed.len() > 10, "{flushed:?}");
    for ((tool, z), mm3) in flushed {
        let wanted = if tool == 0 { 30.0 } else { 70.0 };
        assert!(mm3 > 0.99 * wanted, "tool {tool} at {z}: {mm3}");
        assert!(tool == 0 || mm3 < 1.05 * wanted, "no more than that: {mm3}");
    }
    assert!((top_mm - 3.0).abs() < 0.21, "the left part ends at 3 mm, the tower at {top_mm}");
}

#[test]
fn scripts_of_a_change_know_both_tools() {
    let script = "; {previous_extruder} {current_extruder} to {next_extruder} at {toolchange_z}, {temperature[next_extruder]}";
    let (print, _) = pair(&[&format!("tool_change.script={script}"), "tools.2.temperature.nozzle=231"]);
    let change = text(&print)
        .lines()
        .position(|line| line.ends_with("to 1 at 0.6, 231") || line.ends_with("to 1 at 0.4, 231"));
    let at = change.unwrap_or_else(|| panic!("no change to tool 1 at the second or third layer"));
    assert_eq!(text(&print).lines().nth(at + 1), Some("T1"));
    let own = "T{next_extruder} P0";
    let (print, _) = pair(&[&format!("tool_change.script={own}")]);
    assert!(text(&print).lines().any(|line| line == "T1 P0"));
    assert_eq!(
        text(&print).lines().filter(|line| line.len() == 2 && line.starts_with('T')).count(),
        1,
        "the first"
    );
}

#[test]
fn a_tool_that_is_not_there_is_named_with_its_place() {
    let profile = |sets: &[&str]| {
        let sets = sets.iter().map(|set| {
            let (key, value) = set.split_once('=').unwrap();
            profile::Override { key: key.into(), value: value.into(), option: "--set" }
        });
        let error = profile::resolve(&[], &sets.collect::<Vec<_>>()).expect_err("a mistake");
        error.problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let two = "tools.2.filament.color=#FF0000";
    for (sets, wanted) in [
        (
            &["tool_of.object=2"][..],
            "--set: tool_of.object = 2: there is no such tool: the printer has one tool",
        ),
        (&[two, "tool_of.infill=3"], "tool_of.infill = 3: there is no such tool: the printer has 2 tools"),
        (&[two, "tool_change.flush_volumes=[1, 2]"], "2 volumes are listed, but 2 tools need 4"),
        (&[two, "tool_of.heights=5:2"], "`5:2` is no height with a tool"),
        (&["tools.2.layer.height=0.3"], "tools.2.layer.height = 0.3: it is the same for all tools"),
        (&["tools.2.filament.colour=red"], "did you mean `filament.color`?"),
        (&["tools.17.name=a"], "with N from 1 to 16"),
    ] {
        let found = profile(sets);
        assert!(found.contains(wanted), "{sets:?}: {found}");
    }
}

/// The boxes as one object of a 3MF file, as PrusaSlicer saves its parts, with an extruder for each.
fn project(folder: &tempfile::TempDir, parts: &[([f64; 3], [f64; 3], u32)]) -> Job {
    let (mut vertices, mut triangles, mut volumes) = (String::new(), String::new(), String::new());
    for (number, (low, high, extruder)) in parts.iter().enumerate() {
        let text = cuboid(*low, *high);
        let points: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("vertex ")).collect();
        for point in &points {
            let [x, y, z] = [0, 1, 2].map(|i| point.split(' ').nth(i).unwrap());
            vertices += &format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        }
        for corner in (0..points.len()).step_by(3).map(|corner| corner + number * points.len()) {
            triangles += &format!("<triangle v1=\"{corner}\" v2=\"{}\" v3=\"{}\"/>", corner + 1, corner + 2);
        }
        volumes += &format!(
            "<volume firstid=\"{}\" lastid=\"{}\"><metadata type=\"volume\" key=\"volume_type\" value=\"ModelPart\"/>\
             <metadata type=\"volume\" key=\"extruder\" value=\"{extruder}\"/></volume>",
            12 * number,
            12 * number + 11
        );
    }
    let model = format!(
        "<model unit=\"millimeter\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources>\
         <object id=\"1\" type=\"model\"><mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>\
         </object></resources><build><item objectid=\"1\"/></build></model>"
    );
    let config = format!(
        "<config><object id=\"1\" instances_count=\"1\"><metadata type=\"object\" key=\"extruder\" value=\"1\"/>{volumes}\
         </object></config>"
    );
    let relations = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
        <Relationship Target=\"/3D/3dmodel.model\" Id=\"r\" \
        Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let file = folder.path().join("parts.3mf");
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&file).unwrap());
    for (name, text) in [
        ("_rels/.rels", relations),
        ("3D/3dmodel.model", &model),
        ("Metadata/Slic3r_PE_model.config", &config),
    ] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut zip, text.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    Job::of([file])
}

#[test]
fn parts_of_a_file_have_the_extruders_that_it_names_and_one_tool_prints_all() {
    let folder = tempfile::tempdir().unwrap();
    let job = project(&folder, &[(LEFT.1, LEFT.2, 1), (RIGHT.1, RIGHT.2, 2)]);
    let base = several(2, &["skirt.loops=0"]);
    let (print, (apart, _)) = (run(&job, &base).expect("a print"), pair(&[]));
    let (found, wanted) = (volumes(&print), volumes(&apart));
    for tool in [0, 1] {
        assert!(near(found[&tool][1], wanted[&tool][1]), "{found:?}, {wanted:?}");
    }
    let one = Settings { tools: Vec::new(), ..base };
    let print = run(&job, &one).expect("a print");
    assert!(!text(&print).lines().any(|line| line.starts_with('T')), "one tool, without a change");
}

#[test]
fn roles_and_heights_have_the_tools_that_the_settings_name() {
    let folder = tempfile::tempdir().unwrap();
    let print = |sets: &[&str]| {
        let sets = [&["skirt.loops=0", "prime_tower.enabled=false"], sets].concat();
        run(&boxes(&folder, &[LEFT]), &several(2, &sets)).expect("a print")
    };
    let by_role = print(&["tool_of.infill=2", "tool_of.solid_infill=2"]);
    let mut kinds: BTreeMap<u32, std::collections::BTreeSet<String>> = BTreeMap::new();
    let (mut tool, mut begun, mut kind) = (0, false, String::new());
    for line in text(&by_role).lines() {
        begun |= line == ";LAYER_CHANGE";
        if let Some(name) = line.strip_prefix(";TYPE:") {
            kind = name.to_owned();
        } else if let Some(number) = line.strip_prefix('T').and_then(|text| text.parse().ok()) {
            tool = number;
        } else if begun && line.starts_with("G1 X") && line.contains(" E") && !line.contains(" E-") {
            kinds.entry(tool).or_default().insert(kind.clone());
        }
    }
    assert!(kinds[&0].iter().all(|kind| kind.contains("erimeter")), "{kinds:?}");
    assert!(kinds[&1].iter().all(|kind| kind.contains("infill")), "{kinds:?}");
    let by_height = print(&["tool_of.heights=1-2:2"]);
    let taken: Vec<&str> = text(&by_height)
        .lines()
        .filter(|line| matches!(*line, "T0" | "T1") || line.starts_with(";Z:"))
        .collect();
    let change = |tool: &str| taken.iter().rposition(|line| *line == tool).map(|at| taken[at - 1]);
    assert_eq!((change("T1"), change("T0")), (Some(";Z:1.2"), Some(";Z:2.2")));
}

#[test]
fn the_bytes_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &["order.strategy=optimized"]);
    let job = with_tools(boxes(&folder, &[LEFT, RIGHT]), &base, &[("right", 2)]);
    let [one, four] = [1, 4]
        .map(|threads| run(&Job { threads: Some(threads), ..job.clone() }, &base).expect("a print").text);
    assert!(one == four);
}

#[test]
fn the_tower_stands_clear_of_all_else_on_every_layer_up_to_its_top() {
    let (print, _) = pair(&["skirt.loops=1", "brim.width=2"]);
    let beads = print.beads();
    let (tower, others): (Vec<_>, Vec<_>) = beads.iter().partition(|bead| bead.kind == "Wipe tower");
    let reach = |beads: &[&crate::support::print::Bead]| {
        let points = beads.iter().flat_map(|bead| bead.points.iter());
        points.fold([f64::MAX, f64::MAX, f64::MIN, f64::MIN], |[x0, y0, x1, y1], &[x, y]| {
            [x0.min(x), y0.min(y), x1.max(x), y1.max(y)]
        })
    };
    let others: Vec<_> = others.into_iter().filter(|bead| bead.kind != "Custom").collect();
    let (a, b) = (reach(&tower), reach(&others));
    assert!(a[0] > b[2] + 2.0 || a[2] < b[0] - 2.0 || a[1] > b[3] + 2.0 || a[3] < b[1] - 2.0, "{a:?}, {b:?}");
    let heights: std::collections::BTreeSet<i64> =
        tower.iter().map(|bead| (bead.z_mm * 1000.0).round() as i64).collect();
    let top = *heights.last().expect("a tower");
    assert!(heights.iter().copied().eq((1..=top / 200).map(|layer| 200 * layer)), "{heights:?}");
}

#[test]
fn a_tower_that_has_no_room_is_refused_with_what_to_change() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &["prime_tower.position=[110, 110]"]);
    let job = with_tools(boxes(&folder, &[LEFT, RIGHT]), &base, &[("right", 2)]);
    let error = run(&job, &base).err().expect("it would stand in the part").to_string();
    assert!(error.contains("prime tower") && error.contains("prime_tower.position"), "{error}");
}

#[test]
fn the_best_order_of_tools_costs_no_more_than_any_rule() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(3, &["tool_change.flush_volumes=[0, 10, 90, 40, 0, 10, 10, 70, 0]"]);
    let third = ("back", [0.0, 20.0, 0.0], [35.0, 30.0, 3.0]);
    let job = with_tools(boxes(&folder, &[LEFT, RIGHT, third]), &base, &[("right", 2), ("back", 3)]);
    let rows = Pipeline.compare_tools(&job, &base, &Observer::none()).expect("a comparison");
    let best = rows.iter().find(|row| row.order == "optimal").expect("it is compared");
    assert_eq!(best.bound_s, Some(best.cost_s));
    assert!(rows.iter().all(|row| row.cost_s >= best.cost_s), "{rows:?}");
    let print = run(&job, &base).expect("a print");
    assert_eq!(print.summary.tool_changes as u64, best.changes);
    let fixed = Settings { tools: base.tools.clone(), ..several(3, &["tool_change.order=fixed"]) };
    let print = run(&job, &fixed).expect("a print");
    assert_eq!(Some(print.summary.tool_changes as u64), rows.first().map(|row| row.changes), "fixed");
}

#[test]
fn what_is_flushed_into_infill_spares_the_tower_and_comes_before_the_walls() {
    let flushed = |sets: &[&str]| {
        let (print, _) = pair(&[&["infill.density=40%", "tool_change.flush_volume=60"], sets].concat());
        let sum: f64 = print.summary.tools.iter().map(|tool| tool.flushed_mm3).sum();
        (print, sum)
    };
    let ((_, apart), (print, into)) = (flushed(&[]), flushed(&["tool_change.flush_into_infill=true"]));
    // The frame and its lines take some of the room that is left.
    assert!(into < 0.92 * apart, "{into} of {apart}");
    let (mut kinds, mut sparse) = (Vec::new(), 0);
    for line in text(&print).lines() {
        match line.strip_prefix(";TYPE:") {
            Some(kind) => kinds.push(kind.to_owned()),
            None if line == "T1" || line == "T0" => kinds.clear(),
            None => {}
        }
        let taken = kinds.iter().position(|kind| kind == "Internal infill");
        let walls = kinds.iter().position(|kind| kind.contains("erimeter"));
        if let (Some(taken), Some(walls)) = (taken, walls) {
            sparse += usize::from(taken < walls);
            kinds.clear();
        }
    }
    assert!(sparse > 3, "after {sparse} changes");
}
