//! Tools that are loaded and flushed at an edge of the bed before the first layer.

use crate::support::found::{kinds, report};
use crate::support::print::{Print, run};
use crate::swap::SWAPPING;
use crate::tools::{LEFT, RIGHT, boxes, pair, several, text, timed_as_said, with_tools};
use pathwright::check::Kind;
use pathwright::estimate::Machine;
use pathwright::gcode::{Action, replay};

const AT_START: &str = "prime_tower.at_start=true";

/// Tools in the order in which they print before the first bead of the part, with the volume and the farthest Y of each turn.
fn primed(print: &Print) -> Vec<(u32, f64, f64)> {
    let (mut tool, mut begun, mut turns) = (None, false, Vec::<(u32, f64, f64)>::new());
    for step in replay(&print.text) {
        begun |= step.line.text.starts_with(b";LAYER_CHANGE");
        match step.action {
            Action::Type(name) if begun && name != b"Wipe tower" => break,
            Action::Stroke(stroke) if begun && stroke.extrudes() => {
                let tool = tool.unwrap_or(0);
                if turns.last().is_none_or(|turn| turn.0 != tool) {
                    turns.push((tool, 0.0, 0.0));
                }
                let turn = turns.last_mut().expect("it is there");
                (turn.1, turn.2) = (turn.1 + stroke.fresh_mm3(2.405), turn.2.max(stroke.to[1]));
            }
            _ => {}
        }
        // The tower follows in the first layer.
        if begun && step.line.text.starts_with(b";LAYER:") && !turns.is_empty() {
            break;
        }
        if let Some(code) = step.line.code.filter(|code| code.letter == b'T') {
            tool = Some(code.number);
        }
    }
    turns
}

#[test]
fn each_tool_is_primed_at_the_front_edge_and_the_one_that_prints_first_is_flushed_last() {
    let (print, settings) = pair(&[AT_START, "tool_change.flush_volume=90"]);
    let turns = primed(&print);
    assert_eq!(turns.len(), 2, "{turns:?}");
    assert!((turns[0].1 / 20.0 - 1.0).abs() < 0.05 && (turns[1].1 / 90.0 - 1.0).abs() < 0.05, "{turns:?}");
    assert!(turns.iter().all(|turn| turn.2 < 20.0), "{turns:?}");
    let (_, part) = text(&print).split_once("\n;TYPE:External perimeter").expect("walls");
    let first = text(&print)[..text(&print).len() - part.len()].lines().rfind(|line| line.starts_with('T'));
    assert_eq!(first, Some(format!("T{}", turns[1].0).as_str()));
    assert_eq!(kinds(&report(&print.text, &settings)), []);
}

#[test]
fn before_the_last_tool_the_one_is_primed_that_is_flushed_out_of_it_with_least() {
    let folder = tempfile::tempdir().unwrap();
    let third = ("third", [40.0, 0.0, 0.0], [50.0, 20.0, 3.0]);
    for (volumes, order) in
        [("[0,50,50,90,0,50,40,50,0]", vec![1, 2, 0]), ("[0,50,50,40,0,50,90,50,0]", vec![2, 1, 0])]
    {
        let sets = [AT_START, "skirt.loops=0", "tool_change.order=fixed"];
        let flushes = format!("tool_change.flush_volumes={volumes}");
        let base = several(3, &[&sets[..], &[&flushes]].concat());
        let job = with_tools(boxes(&folder, &[LEFT, RIGHT, third]), &base, &[("right", 2), ("third", 3)]);
        let print = run(&job, &base).expect("a print");
        let tools: Vec<u32> = primed(&print).iter().map(|turn| turn.0).collect();
        assert_eq!(tools, order, "{volumes}");
    }
}

#[test]
fn the_start_script_is_told_whether_tools_are_primed() {
    let script = "gcode.start=G28\nG1 X5 Y5 Z5 F3000\n;{if has_single_extruder_multi_material_priming}none{else}own{endif} first {initial_tool}";
    let (with, _) = pair(&[AT_START, script, "tool_change.flush_volume=60"]);
    let (without, _) = pair(&[script, "tool_change.flush_volume=60"]);
    let first = primed(&with)[0].0;
    assert!(text(&with).contains(&format!("\n;none first {first}\n")));
    assert!(text(&without).contains("\n;own first "));
}

#[test]
fn the_first_filament_is_taken_and_fed_where_it_is_primed() {
    let (print, settings) = pair(&[&SWAPPING[..], &[AT_START]].concat());
    let (_, begun) = text(&print).split_once(";LAYER_CHANGE").expect("a layer");
    let lines: Vec<&str> = begun.lines().collect();
    let take = lines.iter().position(|line| *line == "T0" || *line == "T1").expect("it is taken");
    assert!(lines[..take].iter().all(|line| !line.contains(" E")), "{:?}", &lines[..take]);
    let fed = |line: &&str| line.strip_prefix("G1 E")?.split(' ').next()?.parse::<f64>().ok();
    let fed_mm: f64 = lines[take + 1..].iter().map_while(fed).sum();
    assert!((fed_mm - 60.0).abs() < 0.01, "{fed_mm} mm");
    assert_eq!(kinds(&report(&print.text, &settings)), []);
}

#[test]
fn priming_counts_in_the_summary_as_the_file_is_timed() {
    let (print, settings) = pair(&[&SWAPPING[..], &[AT_START]].concat());
    timed_as_said(&print, &Machine::new(&settings), 0.01);
}

#[test]
fn where_the_edges_of_the_bed_are_taken_the_start_script_primes() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &[AT_START, "bed.size=[200, 200]", "skirt.loops=0", "tool_change.flush_volume=60"]);
    let job = boxes(
        &folder,
        &[
            ("left", [-60.0, -98.0, 0.0], [-20.0, 98.0, 1.0]),
            ("right", [-20.0, -98.0, 0.0], [0.0, 98.0, 1.0]),
        ],
    );
    let print = run(&with_tools(job, &base, &[("right", 2)]), &base).expect("a print");
    assert!(print.summary.warnings.iter().any(|warning| warning.contains("prime the tools")));
    assert_eq!(text(&print).matches("\n;LAYER:0\n").count(), 1);
}

#[test]
fn a_tool_that_is_not_primed_in_a_file_that_says_so_is_found() {
    let (print, settings) = pair(&["tool_change.flush_volume=60"]);
    let told = text(&print).replace(
        "; single_extruder_multi_material_priming = 0",
        "; single_extruder_multi_material_priming = 1",
    );
    assert_eq!(kinds(&report(told.as_bytes(), &settings)), [Kind::UnprimedTool]);
}
