//! Filament that is taken out of a single nozzle and put in at a change of tool.

use crate::support::found::{kinds, report};
use crate::support::print::Print;
use crate::tools::{pair, text, timed_as_said};
use pathwright::check::Kind;
use pathwright::estimate::Machine;
use pathwright::gcode::{Action, replay};
use pathwright::profile::{self, Settings};
use pathwright::units::Mm;

/// A printer whose filament is parked 80 mm behind the nozzle, behind a tube of 20 mm around 40 mm.
pub const SWAPPING: [&str; 12] = [
    "swap.parking=80",
    "swap.extra_load=-20",
    "swap.cooling_tube=40",
    "swap.cooling_tube_length=20",
    "swap.cooling_moves=2",
    "swap.cooling_speed=[2, 5]",
    "swap.unload_start_speed=25",
    "swap.unload_speed=24",
    "swap.load_start_speed=20",
    "swap.load_speed=10",
    "swap.ramming=[4, 8, 12]",
    "tool_change.flush_volume=60",
];

fn swapping(more: &[&str]) -> (Print, Settings) {
    pair(&[&SWAPPING, more].concat())
}

/// Length and speed (mm/s) of each move of filament alone around a change of tool, before it and after it; of each change
/// after the first layer has begun.
fn around_changes(print: &Print) -> Vec<[Vec<(f64, f64)>; 2]> {
    let mut changes: Vec<[Vec<(f64, f64)>; 2]> = Vec::new();
    let (mut begun, mut alone, mut after) = (false, Vec::new(), false);
    for step in replay(&print.text) {
        begun |= step.line.text.starts_with(b";LAYER_CHANGE");
        match step.action {
            Action::Stroke(stroke) if stroke.xy_mm > 0.0 && (stroke.extrudes() || stroke.e_mm < 0.0) => {
                (alone, after) = (Vec::new(), false);
            }
            Action::Stroke(stroke) if stroke.e_mm != 0.0 => {
                let speed = (stroke.feed_mm_s * 10.0).round() / 10.0;
                let moved = ((stroke.e_mm * 1000.0).round() / 1000.0, speed);
                match changes.last_mut() {
                    Some([_, loading]) if after => loading.push(moved),
                    _ => alone.push(moved),
                }
            }
            _ => {}
        }
        if step.line.code.is_some_and(|code| code.letter == b'T') && begun {
            changes.push([std::mem::take(&mut alone), Vec::new()]);
            after = true;
        }
    }
    changes
}

#[test]
fn a_filament_is_pulled_out_slower_and_slower_cooled_and_parked_and_the_next_one_fed() {
    let (print, settings) = swapping(&[]);
    let changes = around_changes(&print);
    assert!(changes.len() > 10);
    for [out, back] in &changes {
        // 15 mm at once, 35 mm into the tube, to and fro in it, and on to where it is parked.
        let cooled = [(20.0, 2.0), (-20.0, 3.0), (20.0, 4.0), (-20.0, 5.0)];
        let wanted =
            [&[(-15.0, 25.0), (-24.5, 24.0), (-7.0, 12.0), (-3.5, 7.2)][..], &cooled, &[(-30.0, 33.0)]];
        assert_eq!(out, &wanted.concat());
        // The tower is there, so that nothing is pulled back on the way to where it is flushed.
        assert_eq!(back, &[(12.0, 20.0), (42.0, 10.0), (6.0, 1.0)]);
    }
    assert_eq!(kinds(&report(&print.text, &settings)), []);
}

#[test]
fn the_tip_is_shaped_in_the_tower_before_the_change_at_the_flows_that_are_listed() {
    let (print, _) = swapping(&[]);
    let area_mm2 = profile::filament_area_mm2(Mm(1.75));
    // Volume and time at each flow, in the beads before a change that lie in the tower.
    let (mut tower, mut begun, mut beads, mut rams) = (false, false, Vec::new(), Vec::new());
    for step in replay(&print.text) {
        begun |= step.line.text.starts_with(b";LAYER_CHANGE");
        match step.action {
            Action::Type(name) => (tower, beads) = (name == b"Wipe tower", Vec::new()),
            Action::Stroke(stroke) if stroke.extrudes() && tower => {
                let mm3 = stroke.fresh_mm3(area_mm2);
                beads.push((mm3, mm3 * stroke.feed_mm_s / stroke.xy_mm));
            }
            _ => {}
        }
        if step.line.code.is_some_and(|code| code.letter == b'T') && begun {
            rams.push(std::mem::take(&mut beads));
        }
    }
    assert!(rams.len() > 10);
    for ram in rams {
        let at = |wanted: f64| -> f64 {
            ram.iter().filter(|(_, flow)| (flow / wanted - 1.0).abs() < 0.02).map(|(mm3, _)| mm3).sum()
        };
        for flow in [4.0, 8.0, 12.0] {
            assert!((at(flow) / (0.25 * flow) - 1.0).abs() < 0.03, "{flow} mm³/s: {ram:?}");
        }
    }
}

#[test]
fn without_a_tower_nothing_is_rammed_but_the_filament_is_taken_out() {
    let (print, _) = swapping(&["prime_tower.enabled=false"]);
    let changes = around_changes(&print);
    assert!(changes.len() > 10);
    for [out, _] in changes {
        let (pulled_mm, _): (Vec<f64>, Vec<f64>) = out.into_iter().unzip();
        assert!((pulled_mm.iter().sum::<f64>() + 80.0).abs() < 1e-6, "{pulled_mm:?}");
    }
}

#[test]
fn pressure_advance_is_off_while_a_tip_is_shaped_and_on_again_for_the_next_one() {
    let (print, _) = swapping(&["filament.pressure_advance=0.04", "tools.2.filament.pressure_advance=0.06"]);
    let body = text(&print).split_once(";LAYER_CHANGE").expect("layers").1;
    let stated: Vec<&str> =
        body.lines().filter(|line| line.starts_with("M900") || matches!(*line, "T0" | "T1")).collect();
    for change in stated.chunks(3) {
        let next = if change[1] == "T1" { "M900 K0.06" } else { "M900 K0.04" };
        assert_eq!((change[0], change[2]), ("M900 K0", next), "{change:?}");
    }
}

#[test]
fn the_sensor_is_off_while_a_tip_is_shaped_and_on_again_after_each_change() {
    // A tool changer keeps the filament in its nozzle, but may shape its tip.
    for sets in [&[][..], &["tool_change.kind=tool-changer", "swap.parking=0"]] {
        let (print, _) = swapping(&[&["swap.sensor_off=true"], sets].concat());
        let body = text(&print).split_once(";LAYER_CHANGE").expect("layers").1;
        let sensor: Vec<&str> = body.lines().filter(|line| line.starts_with("M591")).collect();
        assert_eq!(sensor.len(), 2 * print.summary.tool_changes, "{sets:?}");
        assert!(sensor.chunks(2).all(|pair| pair == ["M591 S0", "M591 R"]), "{sets:?}: {sensor:?}");
    }
}

#[test]
fn what_a_swap_waits_counts_in_the_time_of_the_print_as_the_file_is_timed() {
    let (print, settings) = swapping(&["swap.delay=3", "swap.ramming_cooler=20"]);
    timed_as_said(&print, &Machine::new(&settings), 0.004);
}

/// A tip is shaped by pushing out what has melted, faster than more melts; beads are no faster.
#[test]
fn ramming_may_be_faster_than_filament_melts_and_beads_may_not() {
    let (print, settings) = swapping(&["filament.max_flow=11"]);
    assert_eq!(kinds(&report(&print.text, &settings)), []);
    let slower = settings.set_all(&[("filament.max_flow", "3"), ("swap.ramming", "[3]")]).unwrap();
    assert_eq!(kinds(&report(&print.text, &slower)), [Kind::Flow]);
}

#[test]
fn the_motor_has_a_higher_current_from_the_first_ram_until_the_next_filament_is_there() {
    let (print, settings) = swapping(&["swap.high_current=true"]);
    let body = text(&print).split_once(";LAYER_CHANGE").expect("layers").1;
    let mut turns = body.split("M907 E750\n");
    turns.next();
    let mut count = 0;
    for turn in turns {
        let (inside, after) = turn.split_once("M907 E550\n").expect("it is lowered again");
        assert_eq!(inside.lines().filter(|line| matches!(*line, "T0" | "T1")).count(), 1, "{inside}");
        assert!(!after.lines().any(|line| matches!(line, "T0" | "T1")), "another change");
        count += 1;
    }
    assert_eq!(count, print.summary.tool_changes);
    assert_eq!(kinds(&report(&print.text, &settings)), []);
}
