//! Prints with several tools: who prints what, changes, the prime tower.

use std::collections::BTreeMap;

use crate::support::found::{kinds, report};
use crate::support::print::{Print, model, run, settings};
use pathwright::Observer;
use pathwright::gcode::{Action, file_time, replay};
use pathwright::job::{Engine, Job, JobModel, ObjectSettings};
use pathwright::pipeline::Pipeline;
use pathwright::profile::{self, Settings};

/// Settings of a printer with so many tools, each with filament of its own.
pub(super) fn several(tools: usize, sets: &[&str]) -> Settings {
    let colors: Vec<String> =
        (1..=tools).map(|tool| format!("tools.{tool}.filament.color=#00000{tool}")).collect();
    let mut all: Vec<&str> =
        vec!["order.strategy=nearest", "filament.flow=1", "retract.z_hop=0.2", "gcode.relative_e=true"];
    all.extend(colors.iter().map(String::as_str));
    all.extend(sets);
    settings(&["standard-job"], &all)
}

/// Boxes at their places over a bed of 200 mm, each in a file of its own, from one corner to the other.
pub(super) fn boxes(folder: &tempfile::TempDir, boxes: &[(&str, [f64; 3], [f64; 3])]) -> Job {
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
pub(super) fn with_tools(job: Job, base: &Settings, tools: &[(&str, u32)]) -> Job {
    let own = |&(object, tool): &(&str, u32)| {
        let settings = base.clone().set("tool_of.object", &tool.to_string()).expect("a tool");
        ObjectSettings { object: object.into(), settings }
    };
    Job { objects: tools.iter().map(own).collect(), ..job }
}

/// What each tool extrudes along beads, mm³: into the prime tower, and elsewhere after the start script.
pub(super) fn volumes(print: &Print) -> BTreeMap<u32, [f64; 2]> {
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

pub(super) fn text(print: &Print) -> &str {
    std::str::from_utf8(&print.text).expect("text")
}

fn near(found: f64, wanted: f64) -> bool {
    (found / wanted - 1.0).abs() < 0.005
}

const LEFT: (&str, [f64; 3], [f64; 3]) = ("left", [0.0; 3], [20.0, 20.0, 3.0]);
const RIGHT: (&str, [f64; 3], [f64; 3]) = ("right", [20.0, 0.0, 0.0], [35.0, 20.0, 3.0]);

/// Two boxes side by side, each with a tool of its own.
pub(super) fn pair(sets: &[&str]) -> (Print, Settings) {
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
    // As a full print of one tool, which is a little fuller than full.
    let share = |tool: u32, wanted: f64| (volumes[&tool][1] / wanted - 1.0).abs() < 0.03;
    assert!(share(0, 1500.0) && share(1, 300.0), "{volumes:?}");
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
            assert_eq!(idle, kind != "single-nozzle");
        }
        assert_eq!(kinds(&report(&print.text, &settings)), [], "{kind}");
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

#[test]
fn the_summary_counts_changes_waits_and_scripts_as_the_file_is_timed() {
    let heated = ["tools.1.idle_temperature=150", "tools.2.idle_temperature=150"];
    let moved = "tool_change.script=G4 P1500";
    for sets in [
        &["tool_change.kind=single-nozzle", "tools.2.temperature.nozzle=240", moved][..],
        &["tool_change.kind=tool-changer", heated[0], heated[1], "tools.2.tool_change.time=4"],
    ] {
        let (print, settings) = pair(&[sets, &["tool_change.flush_volume=20"]].concat());
        let said = print.summary.total.total_s;
        let machine = pathwright::estimate::Machine::new(&settings);
        let timed = file_time(&print.text, &machine).0;
        assert!((said / timed - 1.0).abs() < 0.004, "{sets:?}: {said}, timed {timed}");
        let changes = print.summary.tool_changes as f64;
        // Neither changes nor what is waited for after them.
        let unheated = text(&print).replace("; tool_heating_rate", ";");
        let moves = pathwright::estimate::Machine {
            change_is_fixed: true,
            change_s: 0.0,
            heating_rate: 0.0,
            ..machine
        };
        let without = file_time(unheated.as_bytes(), &moves).0;
        let least = if sets[0].ends_with("single-nozzle") { 10.0 + 15.0 / 2.0 } else { 12.0 };
        assert!(
            timed - without > least * (changes - 1.0),
            "{timed} with {changes} changes, {without} without"
        );
    }
}

#[test]
fn a_layer_does_not_begin_with_a_cold_tool_where_another_can_print_while_it_heats() {
    let folder = tempfile::tempdir().unwrap();
    // Two tools on each layer, and three on one: the order of the others decides how long the third has to heat.
    let heated = |rate: &str| {
        let base = several(
            3,
            &[
                "tool_change.kind=tool-changer",
                "tool_change.flush_volume=1",
                "tools.3.idle_temperature=100",
                &format!("tools.3.heating_rate={rate}"),
                "skirt.loops=0",
            ],
        );
        let small = ("small", [20.0, 0.0, 0.0], [24.0, 4.0, 0.4]);
        let job = boxes(&folder, &[("left", LEFT.1, [20.0, 20.0, 0.4]), RIGHT, small]);
        let rows = Pipeline
            .compare_tools(&with_tools(job, &base, &[("right", 2), ("small", 3)]), &base, &Observer::none())
            .expect("a comparison");
        rows.into_iter().map(|row| (row.order.clone(), row.heat_s)).collect::<BTreeMap<String, f64>>()
    };
    let (slow, quick) = (heated("1"), heated("100"));
    assert!(slow["fixed"] > slow["optimal"] + 1.0, "{slow:?}");
    assert!(quick.values().all(|heat_s| *heat_s < 2.0), "{quick:?}");
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
    use pathwright::check::Kind;
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
    use pathwright::check::Kind;
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
fn widths(print: &Print) -> BTreeMap<(u32, String), std::collections::BTreeSet<String>> {
    let (mut tool, mut kind, mut layer) = (0, String::new(), 0);
    let mut widths: BTreeMap<(u32, String), std::collections::BTreeSet<String>> = BTreeMap::new();
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
    let (print, settings) = pair(&[nozzle]);
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
    let timed = file_time(&print.text, &pathwright::estimate::Machine::new(&base)).0;
    let said = print.summary.total.total_s;
    assert!((said / timed - 1.0).abs() < 0.005, "{said}, timed {timed}");
}
