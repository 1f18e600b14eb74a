//! Tools that print several layers before another is taken, where objects are apart.

use std::collections::BTreeMap;

use crate::support::found::{kinds, report};
use crate::support::print::{Print, run};
use crate::tools::{boxes, near, several, text, volumes, with_tools};
use pathwright::Observer;
use pathwright::gcode::{Action, replay};
use pathwright::job::Engine;
use pathwright::pipeline::Pipeline;
use pathwright::profile::Settings;

const LEFT: (&str, [f64; 3], [f64; 3]) = ("left", [0.0; 3], [15.0, 15.0, 6.0]);

/// A box of the first tool and one of the second, which are so far apart, with a tool of each for both.
fn print(apart_mm: f64, sets: &[&str]) -> (Print, Settings, u64) {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &[&["tool_change.flush_volume=60"], sets].concat());
    let right = ("right", [15.0 + apart_mm, 0.0, 0.0], [30.0 + apart_mm, 15.0, 6.0]);
    let job = with_tools(boxes(&folder, &[LEFT, right]), &base, &[("right", 2)]);
    let rows = Pipeline.compare_tools(&job, &base, &Observer::none()).expect("a comparison");
    let best = rows.iter().find(|row| row.order == "optimal").expect("it is compared").changes;
    (run(&job, &base).expect("a print"), base, best)
}

#[test]
fn a_tool_that_may_be_a_layer_ahead_is_changed_half_as_often() {
    let (by_layer, _, _) = print(8.0, &[]);
    let (ahead, settings, compared) = print(8.0, &["tool_change.ahead=0.2"]);
    let changes = [&by_layer, &ahead].map(|print| print.summary.tool_changes);
    // The first layers come one by one.
    assert!(changes[1] <= changes[0] / 2 + 2, "{changes:?}");
    assert_eq!(compared, changes[1] as u64);
    assert_eq!(kinds(&report(&ahead.text, &settings)), []);
    for (tool, [_, part]) in volumes(&by_layer) {
        let now = volumes(&ahead)[&tool][1];
        assert!(near(now, part), "tool {tool}: {now} mm³, {part} layer by layer");
    }
    let [layers, now] = [&by_layer, &ahead].map(|print| &print.summary.layers);
    let heights = |layers: &[pathwright::report::LayerSummary]| -> Vec<f64> {
        layers.iter().map(|layer| layer.z_mm).collect()
    };
    assert_eq!(heights(now), heights(layers), "each layer counts once");
}

#[test]
fn what_is_nearer_than_2_mm_is_printed_layer_by_layer() {
    let [by_layer, ahead] = [&[][..], &["tool_change.ahead=0.2"]].map(|sets| print(1.8, sets).0);
    assert_eq!(by_layer.summary.tool_changes, ahead.summary.tool_changes);
}

#[test]
fn the_nozzle_is_no_further_below_what_stands_than_is_allowed_and_passes_over_it() {
    for sets in [&["tool_change.ahead=0.4"][..], &["tool_change.ahead=0.4", "prime_tower.enabled=false"]] {
        let (ahead, _, _) = print(8.0, &[sets, &["skirt.loops=0"]].concat());
        // Tops of what stands left, right, and elsewhere.
        let mut tops: BTreeMap<usize, f64> = BTreeMap::new();
        let place = |at: [f64; 3]| match at {
            [_, y, _] if !(99.0..116.0).contains(&y) => 2,
            [x, ..] if (99.0..116.0).contains(&x) => 0,
            [x, ..] if (122.0..139.0).contains(&x) => 1,
            _ => 2,
        };
        let (mut begun, mut deepest) = (false, 0.0_f64);
        for step in replay(&ahead.text) {
            begun |= step.line.text.starts_with(b";LAYER_CHANGE");
            let Action::Stroke(stroke) = step.action else { continue };
            if !begun || stroke.xy_mm == 0.0 {
                continue;
            }
            let [from, to] = [stroke.from, stroke.to].map(place);
            let highest = tops.values().copied().fold(0.0, f64::max);
            let z_mm = stroke.from[2].min(stroke.to[2]);
            if stroke.extrudes() {
                deepest = deepest.max(highest - z_mm);
                let top = tops.entry(to).or_default();
                *top = top.max(z_mm);
            } else if from != to {
                assert!(z_mm > highest - 1e-6, "from {:?} to {:?} below {highest}", stroke.from, stroke.to);
            }
        }
        assert!((deepest - 0.4).abs() < 1e-6, "{deepest}");
        assert!(text(&ahead).contains(";LAYER:9\n"));
    }
}

/// The numbers of the layers, as they begin in a file.
fn begun(print: &Print) -> Vec<usize> {
    text(print).lines().filter_map(|line| line.strip_prefix(";LAYER:")?.parse().ok()).collect()
}

#[test]
fn what_is_awaited_finds_all_layers_before_it_printed() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(2, &["tool_change.flush_volume=60", "tool_change.ahead=0.4"]);
    let right = ("right", [23.0, 0.0, 0.0], [38.0, 15.0, 6.0]);
    for stop in ["10", "11"] {
        let mut job = with_tools(boxes(&folder, &[LEFT, right]), &base, &[("right", 2)]);
        job.pauses = vec![stop.parse().unwrap()];
        let print = run(&job, &base).expect("a print");
        let text = text(&print);
        let (before, after) = text.split_once("\nM0").or_else(|| text.split_once("\nM600")).expect("a pause");
        let numbers = |part: &str| -> Vec<usize> {
            part.lines().filter_map(|line| line.strip_prefix(";LAYER:")?.parse().ok()).collect()
        };
        let stop: usize = stop.parse().unwrap();
        assert!(numbers(after).iter().all(|layer| *layer + 1 >= stop), "{:?}", numbers(after));
        assert!(numbers(before).iter().all(|layer| *layer < stop), "{:?}", numbers(before));
    }
}

#[test]
fn by_default_tools_print_several_layers_unless_another_nozzle_is_in_the_way() {
    for (kind, is_ahead) in [("single-nozzle", true), ("tool-changer", true), ("heads", false)] {
        let ahead = format!("tool_change.ahead={}", Settings::default().tool_change.ahead.0);
        let (print, _, _) = print(8.0, &[&ahead, &format!("tool_change.kind={kind}")]);
        assert_eq!(begun(&print).windows(2).any(|pair| pair[1] < pair[0]), is_ahead, "{kind}");
    }
}

#[test]
fn objects_of_other_heights_are_as_high_as_others_where_tools_change() {
    let folder = tempfile::tempdir().unwrap();
    let base = several(3, &["tool_change.flush_volume=60", "tool_change.ahead=0.4"]);
    let third = ("third", [46.0, 0.0, 0.0], [61.0, 15.0, 6.0]);
    for top_mm in [4.2, 4.4, 4.6] {
        let lower = ("lower", [23.0, 0.0, 0.0], [38.0, 15.0, top_mm]);
        let job = with_tools(boxes(&folder, &[LEFT, lower, third]), &base, &[("lower", 2), ("third", 3)]);
        let print = run(&job, &base).expect("a print");
        let (mut z_mm, mut highest_mm, mut changes, mut begun) = (0.0_f64, 0.0_f64, 0, false);
        for step in replay(&print.text) {
            begun |= step.line.text.starts_with(b";LAYER_CHANGE");
            if begun && matches!(step.line.text, b"T0" | b"T1" | b"T2") {
                changes += 1;
                assert!(z_mm > highest_mm - 1e-6, "a change at {z_mm} mm beside {highest_mm} mm");
            }
            let Action::Stroke(stroke) = step.action else { continue };
            z_mm = stroke.to[2];
            if begun && stroke.extrudes() && stroke.xy_mm > 0.0 {
                highest_mm = highest_mm.max(z_mm);
            }
        }
        assert!(changes > 10, "{changes}");
    }
}

/// How long the parts of layers above the first ones take at least: their beads at their speeds, seconds.
fn parts_s(print: &Print) -> Vec<f64> {
    let (mut parts, mut tower) = (Vec::new(), false);
    for step in replay(&print.text) {
        if step.line.text.starts_with(b";LAYER_CHANGE") {
            parts.push(0.0);
        }
        match step.action {
            Action::Type(name) => tower = name == b"Wipe tower",
            Action::Stroke(stroke) if stroke.extrudes() && !tower => {
                if let Some(part_s) = parts.last_mut() {
                    *part_s += stroke.xy_mm / stroke.feed_mm_s;
                }
            }
            _ => {}
        }
    }
    parts.split_off(6)
}

#[test]
fn what_other_tools_take_is_time_to_cool_but_for_half_of_the_least_time() {
    let of = |least_s: f64, change_s: f64| {
        let sets = [
            "tool_change.ahead=0.4".to_owned(),
            format!("cooling.min_layer_time={least_s}"),
            format!("tool_change.time={change_s}"),
        ];
        parts_s(&print(8.0, &sets.each_ref().map(String::as_str)).0)
    };
    let shortest = |parts: &[f64]| parts.iter().copied().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let full = of(0.0, 0.0);
    let full_s = shortest(&full);
    assert_eq!(of(1.9 * full_s, 200.0), full);
    let sum = |change_s: f64| of(6.0 * full_s, change_s).iter().sum::<f64>();
    assert!(sum(0.0) > 1.1 * sum(200.0), "{} s, {} s", sum(0.0), sum(200.0));
    // Half of it, most of which is beads at their speeds.
    let (least_s, mut halved) = (10.0 * full_s, of(10.0 * full_s, 200.0));
    halved.sort_by(f64::total_cmp);
    let usual_s = halved[2 * halved.len() / 3];
    assert!((0.9..=1.1).contains(&(2.0 * usual_s / least_s)), "{usual_s} s of {least_s} s");
}
