//! Finished G-code in another order, from file to file: what must stay stays, and the travel gets shorter.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::support::print::{print, settings};
use crate::support::program::reorder;
use assert_cmd::cargo::cargo_bin_cmd;
use pathwright::estimate::Machine;
use pathwright::gcode::{Action, annotate, file_time, measure, replay};
use pathwright::profile::Settings;
use pathwright::reorder::verify;
use pathwright::units::Mm;

/// The result, which must differ from what it was made of.
fn reordered(text: &str, options: &[&str]) -> String {
    let (code, result, said) = reorder(text.as_bytes(), options);
    assert_eq!(code, 0, "{said}");
    let result = String::from_utf8(result.expect("a result")).expect("UTF-8");
    assert_ne!(result, text, "{said}");
    result
}

/// Writes G-code like a slicer does: lines of infill in a bad order, two layers.
struct Script {
    text: String,
    e: f64,
    relative: bool,
    /// How far filament is pushed that was pulled back by 1 mm.
    push: f64,
}

impl Script {
    fn new(relative: bool) -> Self {
        let mode = if relative { "M83" } else { "M82" };
        Self { text: format!("G28\nG90\n{mode}\nG1 X0 Y0 F6000\n"), e: 0.0, relative, push: 1.0 }
    }

    fn say(&mut self, line: &str) -> &mut Self {
        self.text += line;
        self.text += "\n";
        self
    }

    fn feed(&mut self, e: f64) -> String {
        self.e += e;
        if self.relative { format!("E{e:.5}") } else { format!("E{:.5}", self.e) }
    }

    /// A retracted travel.
    fn go(&mut self, x: f64, y: f64) -> &mut Self {
        let (pull, push) = (self.feed(-1.0), self.feed(self.push));
        // The position after pulling is what was before pushing.
        self.say(&format!("G1 {pull} F2400"))
            .say(&format!("G0 X{x} Y{y} F9000"))
            .say(&format!("G1 {push} F2400"))
    }

    fn line(&mut self, x: f64, y: f64, f: u32) -> &mut Self {
        let e = self.feed(0.3);
        self.say(&format!("G1 X{x} Y{y} {e} F{f}"))
    }

    /// Parallel lines, one of them in `order` after another.
    fn hatch(&mut self, x: f64, order: &[u32]) -> &mut Self {
        for &i in order {
            let y = f64::from(i) * 5.0;
            self.go(x, y).line(x + 20.0, y, 1200 + i);
        }
        self
    }

    fn layer(&mut self, index: u32) -> &mut Self {
        self.say(&format!(";LAYER:{index}"));
        let z = 0.2 * f64::from(index + 1);
        self.say(&format!("G1 Z{z:.1} F600"))
    }
}

const BAD: [u32; 8] = [0, 5, 2, 7, 1, 6, 3, 4];

fn two_layers(relative: bool) -> String {
    let mut script = Script::new(relative);
    script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD).layer(1).hatch(10.0, &BAD).say("M104 S0");
    script.text
}

/// Extruded strokes of each layer: ends in no order, filament and feed rate.
type Strokes = BTreeMap<Option<usize>, Vec<[i64; 6]>>;

fn strokes(text: &str) -> Strokes {
    let mut layers = Strokes::new();
    for read in annotate(text.as_bytes()) {
        let Action::Stroke(s) = read.action else { continue };
        if s.extrudes() {
            let key = |v: f64| (v * 1e5).round() as i64;
            let (mut a, mut b) = ([key(s.from[0]), key(s.from[1])], [key(s.to[0]), key(s.to[1])]);
            if a > b {
                (a, b) = (b, a);
            }
            let stroke = [a[0], a[1], b[0], b[1], key(s.fresh_mm), key(s.feed_mm_s)];
            layers.entry(read.context.layer).or_default().push(stroke);
        }
    }
    layers.values_mut().for_each(|strokes| strokes.sort_unstable());
    layers
}

/// Lines that begin with a text, with the number of strokes that extrude before each.
fn places(text: &str, begin: &str) -> Vec<(usize, String)> {
    let mut drawn = 0;
    let mut found = Vec::new();
    for step in replay(text.as_bytes()) {
        drawn += usize::from(matches!(step.action, Action::Stroke(s) if s.extrudes()));
        let line = String::from_utf8_lossy(step.line.text);
        if line.starts_with(begin) {
            found.push((drawn, line.into_owned()));
        }
    }
    found
}

#[test]
fn every_stroke_stays_and_the_travel_between_shrinks() {
    for relative in [false, true] {
        let text = two_layers(relative);
        let result = reordered(&text, &[]);
        assert_eq!(strokes(&text), strokes(&result), "relative: {relative}");
        let [before, after] = [&text, &result].map(|t| measure(t.as_bytes(), Mm(1.75)));
        assert!(after.travel_mm < 0.6 * before.travel_mm, "{} → {}", before.travel_mm, after.travel_mm);
        assert!((after.volume_mm3 - before.volume_mm3).abs() < 1e-6);
    }
}

#[test]
fn paths_move_whose_filament_is_pushed_a_little_less_than_it_was_pulled() {
    for relative in [false, true] {
        let mut script = Script { push: 0.9, ..Script::new(relative) };
        script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD);
        let result = reordered(&script.text, &[]);
        let [before, after] = [&script.text, &result].map(|t| measure(t.as_bytes(), Mm(1.75)));
        assert!(after.travel_mm < 0.6 * before.travel_mm, "{} → {}", before.travel_mm, after.travel_mm);
        assert!(after.retractions < before.retractions && after.print_mm == before.print_mm);
    }
}

#[test]
fn what_kisslicer_says_of_every_path_stops_none() {
    let path = |i: &u32| {
        let y = 5 * i;
        format!(
            "; Fan set to Cool value 50%\n;\n; 'Sparse Infill Path', 1.0 [feed mm/s], 30.0 [head mm/s]\n\
             G1 X10 Y{y} E0 F9000\n; 'Destring Prime'\nG1 E1 F1800\n; head speed 30.0, filament speed 1.0, preload 0.0\n\
             ; Prepare for Destring\nG1 X30 Y{y} E.5 F1800\n;\n\
             ; 'Destring/Wipe/Jump Path', 0.0 [feed mm/s], 9.5 [head mm/s]\n; 'Destring Suck'\nG1 E-1 F1800\n"
        )
    };
    let paths: String = BAD.iter().map(path).collect();
    let text = format!(
        "G28\nM83\n; BEGIN_LAYER_OBJECT z=0.2\nG1 Z.2 F600\nG1 E-1 F1800\n{paths}; END_LAYER_OBJECT z=0.2\n"
    );
    let result = reordered(&text, &[]);
    let [before, after] = [&text, &result].map(|t| measure(t.as_bytes(), Mm(1.75)));
    assert!(after.travel_mm < 0.6 * before.travel_mm, "{} → {}", before.travel_mm, after.travel_mm);
    assert!(result.ends_with("; END_LAYER_OBJECT z=0.2\n"));
}

#[test]
fn an_absolute_e_ends_where_it_ended() {
    let text = two_layers(false);
    let end = |text: &str| {
        let mut state = pathwright::gcode::State::default();
        pathwright::gcode::lines(text.as_bytes()).for_each(|line| {
            state.follow(&line);
        });
        (state.e * 1e5).round()
    };
    assert_eq!(end(&text), end(&reordered(&text, &[])));
}

#[test]
fn barriers_stay_where_they_are() {
    for barrier in
        ["T1", "M486 S1", "EXCLUDE_OBJECT_START NAME=a", "M600", "M104 S210", "FROBNICATE X=1", "; who knows"]
    {
        let mut script = Script::new(true);
        script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD).say(barrier).hatch(40.0, &BAD);
        let result = reordered(&script.text, &[]);
        assert_eq!(places(&script.text, barrier), places(&result, barrier));
    }
}

#[test]
fn fan_and_acceleration_travel_with_their_paths() {
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:FILL").say("M106 S10").say("M204 S500");
    for (n, &i) in BAD.iter().enumerate() {
        let y = f64::from(i) * 5.0;
        script.say(&format!("M106 S{}", 20 + i)).go(10.0, y).line(30.0, y, 1200);
        if n % 2 == 0 {
            script.say(&format!("M204 S{}", 1000 + i));
        }
    }
    // What is in force for each stroke.
    let in_force = |text: &str| {
        let (mut fan, mut acceleration) = (String::new(), String::new());
        let mut all = Vec::new();
        for step in replay(text.as_bytes()) {
            let line = String::from_utf8_lossy(step.line.text).into_owned();
            match step.action {
                Action::Stroke(s) if s.extrudes() => {
                    let y = s.to[1] as i64;
                    all.push((y, fan.clone(), acceleration.clone()));
                }
                _ if line.starts_with("M106") => fan = line,
                _ if line.starts_with("M204") => acceleration = line,
                _ => {}
            }
        }
        all.sort();
        all
    };
    assert_eq!(in_force(&script.text), in_force(&reordered(&script.text, &[])));
}

#[test]
fn statements_about_time_change_as_the_time_does_or_are_dropped() {
    let text = two_layers(true).replace(";LAYER:1\n", "M73 P50 R100\n;TIME_ELAPSED:300.5\n;LAYER:1\n");
    // In the midst of what changes places, too.
    let text = text.replacen(";LAYER:1\n", ";LAYER:1\nM73 C5\n", 1)
        + "M73 P100 R0\n; estimated printing time = 1h 0m 0s\n";
    let at = text.rfind("G0 X").expect("a travel");
    let text = format!(";TIME:3600\n{}M73 P75 R50\n{}", &text[..at], &text[at..]);
    let result = reordered(&text, &[]);
    let machine = Machine::new(&Settings::default());
    let [old, new] = [&text, &result].map(|t| file_time(t.as_bytes(), &machine).0);
    let said: Vec<&str> =
        result.lines().filter(|l| l.contains("TIME") || l.contains("73") || l.contains("time")).collect();
    assert!(new < 0.9 * old && said.len() == 6, "{old} → {new}: {said:?}");
    assert_eq!(said[0].trim_end(), format!(";TIME:{:.0}", 3600.0 * new / old));
    let left: Vec<f64> = said.iter().filter_map(|l| l.trim_end().split_once(" R")?.1.parse().ok()).collect();
    assert!(
        said[1].starts_with("M73 P5") && (left[0] - 100.0).abs() > 1.0 && left[1] < 50.0 && left[2] == 0.0,
        "{said:?}"
    );
    let elapsed: f64 = said[2].trim_end()[";TIME_ELAPSED:".len()..].parse().expect("a number");
    assert!((elapsed / 300.5 - new / old).abs() < 0.1, "{said:?}");
}

#[test]
fn nothing_to_gain_leaves_every_byte_and_says_so() {
    let mut script = Script::new(false);
    script.layer(0).say(";TYPE:FILL").go(10.0, 0.0).line(30.0, 0.0, 1200).go(30.0, 5.0).line(10.0, 5.0, 1200);
    let (code, result, said) = reorder(script.text.as_bytes(), &[]);
    assert_eq!((code, result.as_deref()), (0, Some(script.text.as_bytes())), "{said}");
    assert!(said.contains("unchanged"), "{said}");
}

#[test]
fn in_place_replaces_the_file_and_a_dry_run_does_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.gcode");
    let text = two_layers(true);
    std::fs::write(&file, &text).expect("written");
    let run = |option: &str| {
        cargo_bin_cmd!("pathwright").args(["reorder", option]).arg(&file).assert().success();
        std::fs::read_to_string(&file).expect("read")
    };
    assert_eq!(run("--dry-run"), text);
    assert_ne!(run("--in-place"), text);
    assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
}

#[test]
fn filament_is_primed_where_the_file_does_so_and_arcs_without_a_centre_stay() {
    // Found by mutation.
    let mut script = Script::new(true);
    script.say("G1 X5 Y5 F9000").say("G1 E3 F300").say("G1 X7 Y7 F9000").layer(0).say(";TYPE:FILL");
    script.hatch(10.0, &BAD).say("G2 X40 Y40 E1").hatch(50.0, &BAD);
    let result = reordered(&script.text, &["--scope", "layer"]);
    assert_eq!(places(&script.text, "G1 E3"), places(&result, "G1 E3"));
    assert_eq!(strokes(&script.text), strokes(&result));
}

#[test]
fn a_file_that_goes_on_in_inches_is_moved_up_to_there() {
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD).say("G20").line(1.0, 1.0, 90).line(2.0, 1.5, 90);
    let result = reordered(&script.text, &["--scope", "layer", "--cost", "length"]);
    assert_eq!(strokes(&script.text), strokes(&result));
}

#[test]
fn line_ends_stay_as_they_are() {
    let text = two_layers(true).replace('\n', "\r\n");
    let result = reordered(&text, &[]);
    assert!(result.lines().count() > 20 && result.split_inclusive('\n').all(|line| line.ends_with("\r\n")));
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let text = two_layers(false);
    let one = reordered(&text, &["--threads", "1"]);
    assert_eq!(one, reordered(&text, &["--threads", "3"]));
}

#[test]
fn directions_can_be_kept() {
    let text = two_layers(true);
    let starts = |text: &str| {
        let mut all: Vec<[i64; 2]> = replay(text.as_bytes())
            .filter_map(|step| match step.action {
                Action::Stroke(s) if s.extrudes() => Some([s.from[0] as i64, s.from[1] as i64]),
                _ => None,
            })
            .collect();
        all.sort_unstable();
        all
    };
    assert_eq!(starts(&text), starts(&reordered(&text, &["--keep-direction"])));
    assert_ne!(starts(&text), starts(&reordered(&text, &[])));
}

#[test]
fn types_keep_their_order_within_an_island_and_mix_only_at_layer_scope() {
    // Walls around infill, the infill drawn first.
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD).say(";TYPE:WALL-INNER");
    script.go(10.0, 0.0).line(10.0, 35.0, 1500).go(30.0, 35.0).line(30.0, 0.0, 1500);
    let last_fill = |text: &str| {
        let types: Vec<String> = places_of_types(text);
        types.iter().rposition(|t| t == "FILL").unwrap_or(0)
    };
    let feature = reordered(&script.text, &["--scope", "feature"]);
    assert_eq!(last_fill(&feature), 7);
}

/// The type of every stroke that extrudes.
fn places_of_types(text: &str) -> Vec<String> {
    let mut kind = String::new();
    let mut all = Vec::new();
    for step in replay(text.as_bytes()) {
        match step.action {
            Action::Type(name) => kind = String::from_utf8_lossy(name).into_owned(),
            Action::Stroke(s) if s.extrudes() => all.push(kind.clone()),
            _ => {}
        }
    }
    all
}

#[test]
fn a_spiral_and_sloped_beads_are_left_alone() {
    let mut text = String::from("G90\nM83\n;LAYER:0\nG1 Z0.2 F600\n");
    for i in 1..200 {
        let (sin, cos) = (f64::from(i) * 0.3).sin_cos();
        text += &format!(
            "G1 X{:.3} Y{:.3} Z{:.4} E0.05 F1200\n",
            50.0 + 9.0 * cos,
            50.0 + 9.0 * sin,
            0.2 + 0.001 * f64::from(i)
        );
    }
    let (code, result, said) = reorder(text.as_bytes(), &["--scope", "layer"]);
    assert_eq!((code, result.as_deref()), (0, Some(text.as_bytes())), "{said}");
}

#[test]
fn filament_retracted_on_the_move_after_a_travel_stays_on_that_move() {
    // Found by mutation: an E that falls behind makes a wipe of what was a bead.
    let text =
        "M82\nG1 F3000\nG1 X30 Y25 E1.6\nG1 X35 Y25\nG1 X40 Y20 E1.3\nG1 X41 Y20 E1.35\nG1 X50 Y20 E2\n";
    let (code, result, said) = reorder(text.as_bytes(), &[]);
    assert_eq!((code, result.as_deref()), (0, Some(text.as_bytes())), "{said}");
}

#[test]
fn filament_pulled_back_beyond_all_measure_does_no_harm() {
    // Found by fuzzing: the opposite of the least number there is overflowed.
    let text = "M82\nG1 F3000\nG1 X30 Y25 E1\nG1 E-9999999999999\nG1 E1\nG1 X40 Y20 E9\n";
    let (code, result, said) = reorder(text.as_bytes(), &[]);
    assert_eq!((code, result.as_deref()), (0, Some(text.as_bytes())), "{said}");
}

#[test]
fn a_line_that_lets_nothing_pass_leaves_the_nozzle_where_the_order_has_it() {
    // Found by mutation: the bead after it was taken to begin where the file's own order would have ended.
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:FILL").hatch(10.0, &BAD).say("FROBNICATE").line(35.0, 22.0, 1200);
    script.line(40.0, 22.0, 1200).hatch(50.0, &BAD);
    let result = reordered(&script.text, &["--scope", "layer"]);
    assert_eq!(strokes(&script.text), strokes(&result));
}

/// An outer wall with lines of infill inside, on either side of a slot: the straight travel crosses the wall.
fn slotted() -> String {
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:WALL-OUTER").go(0.0, 0.0);
    let outline = [(40, 0), (40, 40), (22, 40), (22, 10), (18, 10), (18, 40), (0, 40), (0, 0)];
    for (x, y) in outline {
        script.line(f64::from(x), f64::from(y), 900);
    }
    script.say(";TYPE:FILL");
    for i in [0, 1, 2, 3, 4, 5] {
        for x in [2.0, 26.0] {
            let y = 12.0 + 4.0 * f64::from(i);
            script.go(x, y).line(x + 12.0, y, 1200);
        }
    }
    script.text
}

#[test]
fn outer_walls_are_crossed_only_with_the_filament_pulled_back() {
    let result = reordered(&slotted(), &["--scope", "feature"]);
    let mut pulled = 0.0;
    for step in replay(result.as_bytes()) {
        let Action::Stroke(s) = step.action else { continue };
        pulled -= s.e_mm - s.fresh_mm;
        let crosses = (s.from[0] - 20.0) * (s.to[0] - 20.0) < 0.0 && s.from[1].min(s.to[1]) > 10.0;
        assert!(!crosses || s.extrudes() || pulled > 0.5, "{s:?}");
    }
}

#[test]
fn a_relative_move_of_an_end_script_begins_where_the_file_has_it() {
    let mut script = Script::new(true);
    script.layer(0).say(";TYPE:FILL").hatch(30.0, &BAD);
    // The last bead of the file ends at X50 Y20; another one would take the move out of the area.
    script.say("G91").say("G1 X-30 Y-15 F9000").say("G90").say("M84");
    let result = reordered(&script.text, &["--scope", "layer"]);
    let last = |text: &str| {
        let strokes = replay(text.as_bytes()).filter_map(|step| match step.action {
            Action::Stroke(stroke) => Some(stroke.to),
            _ => None,
        });
        strokes.last()
    };
    assert_eq!(last(&script.text), last(&result));
}

#[test]
fn retractions_grow_in_number_only_where_a_cost_is_asked_for() {
    let text = slotted() + &two_layers(true);
    let retractions = |text: &str| measure(text.as_bytes(), Mm(1.75)).retractions;
    for options in [&["--scope", "feature"][..], &["--scope", "layer", "--seam", "free"]] {
        assert!(retractions(&reordered(&text, options)) <= retractions(&text), "{options:?}");
    }
}

#[test]
fn finished_files_are_compared_like_models() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["a.gcode", "b.gcode"].map(|name| folder.path().join(name));
    for (file, text) in files.iter().zip([two_layers(true), slotted()]) {
        std::fs::write(file, text).expect("written");
    }
    let mut command = cargo_bin_cmd!("pathwright");
    let done = command.args(["compare", "--order", "as-sliced,optimized"]).args(&files).assert().success();
    let said = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    let links = |name: &str| -> Vec<f64> {
        let lines = said.lines().filter(|line| line.starts_with(name) && !line.contains("proved"));
        lines.filter_map(|line| line.split_whitespace().nth(1)?.parse().ok()).collect()
    };
    let (old, new) = (links("as-sliced"), links("optimized"));
    // Two files, and both together.
    assert!(old.len() == 3 && new.len() == 3 && said.contains("all models"), "{said}");
    assert!(new[0] < 0.6 * old[0] && new[1] <= old[1] && (new[2] - new[0] - new[1]).abs() < 0.11, "{said}");
}

#[test]
fn a_line_of_a_million_characters_and_binary_bytes_say_where_they_are() {
    let good = two_layers(true);
    let long = format!("{good}G1 X{}\n", "1".repeat(5_000_000));
    let (code, result, said) = reorder(long.as_bytes(), &[]);
    assert!(code == 3 && result.is_none() && said.contains("longer than 4 MB"), "{code} {said}");
    let (code, result, said) = reorder(format!("{good}\0").as_bytes(), &[]);
    let place = format!("line {}: binary", good.lines().count() + 1);
    assert!(code == 3 && result.is_none() && said.contains(&place), "{code} {said}");
}

#[test]
fn a_file_cut_off_within_a_line_prints_what_is_left_of_it() {
    let good = two_layers(false);
    let end = good.rfind(" E").expect("a bead");
    for cut in [end, end + 2, good.len() - 5] {
        let text = &good[..cut];
        let (code, result, said) = reorder(text.as_bytes(), &[]);
        assert_eq!(code, 0, "{said}");
        assert_eq!(strokes(text), strokes(&String::from_utf8(result.expect("a result")).expect("UTF-8")));
    }
}

#[test]
fn broken_files_are_refused_or_left_as_they_are() {
    let good = two_layers(false);
    let cut = &good[..good.len() * 2 / 3];
    let long = format!("{good};{}\n", "x".repeat(1_000_000));
    let huge = good.replace("X30 Y25", "X1e308 Y25");
    let nan = good.replace("X30 Y25", "XNaN Y25");
    for text in [
        cut,
        &long,
        &huge,
        &nan,
        &good.replace("G1 X30", "G1 X999999999999999999999"),
        "\n\n",
        "",
        "G1",
        ";",
        "M82\nG1 E",
    ] {
        let (code, result, said) = reorder(text.as_bytes(), &[]);
        // Done, or refused by the proof.
        assert!(code == 0 && result.is_some() || code == 7 && result.is_none(), "{code} {said}");
        if let Some(result) = result {
            assert_eq!(strokes(text), strokes(&String::from_utf8(result).expect("UTF-8")));
        }
    }
    let binary: Vec<u8> = b"GCDE".iter().copied().chain((0..=255).cycle().take(5000)).collect();
    let (code, result, said) = reorder(&binary, &[]);
    assert!(code == 3 && result.is_none() && said.contains("binary"), "{code} {said}");
}

#[test]
fn the_proof_holds_a_file_with_a_coordinate_beyond_all_measure_equal_to_itself() {
    let text = two_layers(false).replace("X30 Y25", &format!("X30 Y1{}", "0".repeat(60)));
    let verdict = verify(text.as_bytes(), text.as_bytes());
    assert_eq!(verdict.expect("read").err(), None);
}

#[test]
fn mutated_files_neither_panic_nor_hang_nor_print_anything_else() {
    let good = slotted() + &two_layers(false);
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        // SplitMix64, Steele, Lea & Flood 2014.
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((z ^ (z >> 27)) % below.max(1) as u64) as usize
    };
    let pieces = [
        "E",
        "-",
        ".",
        "\n",
        ";",
        "G91\n",
        "G92 E0\n",
        "M83\n",
        "G2 I1 J1 ",
        "G10\n",
        "G11\n",
        "G20\n",
        "\r",
        "NaN",
        "X",
        "G2 ",
        "G92\n",
        "Z9 ",
        ";LAYER:3\n",
        ";TYPE:\n",
        "M204 S1\n",
        "G28\n",
        "M200 D1.75\n",
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let files: Vec<PathBuf> = (0..200)
        .map(|n| {
            let mut text = good.clone().into_bytes();
            for _ in 0..1 + random(12) {
                let at = random(text.len());
                match random(3) {
                    0 => {
                        let end = (at + random(40)).min(text.len());
                        text.drain(at..end);
                    }
                    1 => {
                        text.splice(at..at, pieces[random(pieces.len())].bytes());
                    }
                    _ => text[at] = b" 0123456789.-XYZEFG;\n"[random(20)],
                }
            }
            let file = folder.path().join(format!("{n}.gcode"));
            std::fs::write(&file, text).expect("written");
            file
        })
        .collect();
    let mut command = cargo_bin_cmd!("pathwright");
    command
        .args(["reorder", "--dry-run", "--scope", "layer", "--seam", "free", "--order", "nearest"])
        .args(&files);
    let done = command.timeout(std::time::Duration::from_secs(600)).output().expect("runs");
    let said = String::from_utf8_lossy(&done.stderr);
    // Done, or refused by the reader; the proof's refusal would be 7, a panic 101, no code at all a kill.
    assert!(matches!(done.status.code(), Some(0 | 3)), "{said}");
}

#[test]
fn our_own_optimized_prints_have_next_to_nothing_left_to_gain() {
    // The last two have three walls, drawn depth by depth, which their names do not tell, and monotonic surfaces; of the
    // plate these walls merge between holes, and holes interrupt the lines of its top.
    let prints =
        [("plate_with_holes", &["standard-job"][..]), ("tilted_bracket", &[]), ("plate_with_holes", &[])];
    for (model, profiles) in prints {
        let text = print(model, &settings(profiles, &["order.strategy=optimized"])).text;
        let (code, result, said) = reorder(&text, &[]);
        assert_eq!(code, 0, "{said}");
        let [before, after] = [&text, &result.expect("a result")].map(|t| measure(t, Mm(1.75)).total_mm());
        assert!(after > 0.995 * before && after <= before + 1e-6, "{model}: {before} → {after}");
    }
}

#[test]
fn lines_of_a_monotonic_surface_keep_their_order() {
    let settings = settings(&[], &["order.strategy=as-sliced", "infill.density=0"]);
    let text = print("calibration_cube", &settings).text;
    let (code, result, said) = reorder(&text, &[]);
    let result = result.expect("a result");
    assert!(code == 0 && result != text, "{said}");
    let top = |text: &[u8]| {
        let (mut on_top, mut ends) = (false, Vec::new());
        for step in replay(text) {
            match step.action {
                Action::Type(kind) => on_top = kind == b"Top solid infill",
                Action::Stroke(s) if on_top && s.extrudes() => ends.push([s.from, s.to]),
                _ => {}
            }
        }
        ends
    };
    assert!(top(&text).len() > 50);
    assert!(top(&text) == top(&result), "{said}");
}
