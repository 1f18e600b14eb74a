//! Scripts of a print: where they run, what they see, and what is put back after them. Read back from the G-code.

use std::fs;

use assert_cmd::Command;

use crate::support::print::{model, print, run, settings};
use pathwright::job::{Job, JobError};

fn text(name: &str, sets: &[&str]) -> String {
    String::from_utf8(print(name, &settings(&[], sets)).text).expect("text")
}

/// The layers of a print, each from its change on.
fn layers(text: &str) -> Vec<&str> {
    text.split(";LAYER_CHANGE\n").skip(1).collect()
}

#[test]
fn scripts_run_once_at_every_change_of_layer_but_the_first() {
    let sets = ["gcode.before_layer=;EARLIER {layer_num} {layer_z}", "gcode.after_layer=;LATER {layer_num}"];
    let text = text("calibration_cube", &sets);
    let layers = layers(&text);
    assert!(!layers[0].contains(";EARLIER") && !layers[0].contains(";LATER"));
    for (index, layer) in layers.iter().enumerate().skip(1) {
        let z = layer.lines().next().and_then(|line| line.strip_prefix(";Z:")).expect("a height");
        let z: f64 = z.parse().expect("a number");
        let before = format!(";EARLIER {index} {}\n", (z * 1000.0).round() / 1000.0);
        let before = layer.find(&before).unwrap_or_else(|| panic!("{before} is not in layer {index}"));
        let after = layer.find(&format!(";LATER {index}\n")).expect("the other script");
        let risen = layer.find(&format!("Z{}", (z * 1000.0).round() / 1000.0)).unwrap_or(0);
        assert!(before < after && risen < after, "layer {index}: the nozzle rises between the two");
        assert_eq!(layer.matches(";EARLIER").count() + layer.matches(";LATER").count(), 2);
    }
    assert!(layers.len() > 90);
}

#[test]
fn a_script_that_moves_the_nozzle_changes_no_bead() {
    let plain = print("calibration_cube", &settings(&[], &[]));
    let mut own = settings(&[], &[]);
    own.gcode.after_layer = "G91\nG1 Z5 F600\nG90\nG1 X5 Y5 F9000\nM400".into();
    let moved = print("calibration_cube", &own);
    let beads = |print: &crate::support::print::Print| -> Vec<[i64; 7]> {
        let rounded = |v: f64| (v * 1e3).round() as i64;
        let strokes = print.strokes().into_iter().filter(|s| s.extrudes() && s.xy_mm > 0.0);
        strokes
            .map(|s| {
                let e = (s.e_mm * 1e5).round() as i64;
                let [a, b, c] = s.from.map(rounded);
                let [d, f, g] = s.to.map(rounded);
                [a, b, c, d, f, g, e]
            })
            .collect()
    };
    assert_eq!(beads(&plain), beads(&moved));
}

#[test]
fn temperatures_are_stated_once() {
    let text =
        text("calibration_cube", &["temperature.nozzle_first_layer=215", "temperature.bed_first_layer=60"]);
    let layers = layers(&text);
    let stated = |layer: &str, command: &str| layer.lines().filter(|line| line.starts_with(command)).count();
    assert_eq!(stated(layers[0], "M104") + stated(layers[0], "M140"), 0, "the start script has heated");
    assert_eq!(stated(layers[1], "M104"), 1, "another temperature");
    let rest: usize = layers[2..layers.len() - 1].iter().map(|layer| stated(layer, "M104")).sum();
    assert_eq!(rest, 0);
}

#[test]
fn the_end_script_sees_the_whole_print() {
    let mut own = settings(&[], &[]);
    own.gcode.end +=
        "; {total_layer_count} {layer_num} {max_layer_z} {extruded_weight_total > 1} {print_time}\n";
    let text = String::from_utf8(print("calibration_cube", &own).text).expect("text");
    let line = text.lines().rfind(|line| line.starts_with("; 100 99 20 true ")).expect("the line");
    assert!(line.ends_with('m') || line.ends_with('s'), "{line}");
}

#[test]
fn a_script_runs_between_objects_that_are_printed_one_after_the_other() {
    let mut own = settings(&[], &["print.sequence=object"]);
    own.gcode.between_objects = "M117 {current_object_idx}".into();
    let job = Job::of(vec![model("calibration_cube"); 3]);
    let text = String::from_utf8(run(&job, &own).expect("a print").text).expect("text");
    let said: Vec<&str> = text.lines().filter(|line| line.starts_with("M117")).collect();
    assert_eq!(said, ["M117 1", "M117 2"]);
}

#[test]
fn objects_are_labelled_by_comments_where_plug_ins_read_them() {
    let job = Job::of(vec![model("calibration_cube"); 2]);
    let labelled = run(&job, &settings(&[], &["gcode.label_comments=true"])).expect("a print");
    let plain = run(&job, &settings(&[], &[])).expect("a print");
    let text = String::from_utf8(labelled.text).expect("text");
    let count = |what: &str| text.lines().filter(|line| line.starts_with(what)).count();
    assert_eq!(
        count("; printing object "),
        count("; stop printing object ") + 1,
        "the end script is no object"
    );
    assert!(count("; printing object calibration_cube id:0 copy 0") > 100);
    let fed = |text: &str| -> Vec<String> {
        let moves = text.lines().filter(|line| line.starts_with("G1 "));
        moves
            .filter_map(|line| line.split(' ').find(|word| word.starts_with('E')).map(str::to_owned))
            .collect()
    };
    assert_eq!(fed(&text), fed(&String::from_utf8_lossy(&plain.text)), "the same is drawn");
}

#[test]
fn a_color_change_has_a_script_of_its_own() {
    let mut own = settings(&[], &[]);
    (own.gcode.pause, own.gcode.color_change) =
        ("M601".into(), "M600 ; extruder {color_change_extruder}".into());
    let at = |layer: &str| layer.parse().expect("a layer");
    let job = Job {
        models: vec![model("calibration_cube").into()],
        pauses: vec![at("5")],
        color_changes: vec![at("9")],
        ..Job::default()
    };
    let text = String::from_utf8(run(&job, &own).expect("a print").text).expect("text");
    let layers = layers(&text);
    assert!(layers[4].contains("\nM601\n") && layers[8].contains("\nM600 ; extruder 0\n"));
    assert_eq!((text.matches("M601").count(), text.matches("M600").count()), (1, 1));
}

#[test]
fn a_script_that_fails_on_the_way_leaves_no_file() {
    let mut own = settings(&[], &[]);
    own.gcode.after_layer = "{if layer_num == 50}{no_such_name}{endif}".into();
    let job = Job { models: vec![model("calibration_cube").into()], ..Job::default() };
    match run(&job, &own) {
        Err(JobError::Script { mistakes }) => {
            assert!(mistakes[0].starts_with("gcode.after_layer: line 1, column"), "{mistakes:?}");
        }
        other => panic!("{:?}", other.map(|print| print.summary)),
    }
}

#[test]
fn an_unknown_name_is_exit_code_4_and_ignored_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.gcode");
    let slice = |more: &[&str]| {
        let mut command = Command::cargo_bin("pathwright").expect("the program");
        command.arg("slice").arg(model("calibration_cube")).arg("-o").arg(&out);
        command.args(["--set", "gcode.before_layer=M117 {layer_nun}"]).args(more).assert()
    };
    let refused = slice(&[]).code(4);
    let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(told.contains("did you mean `layer_num`?"), "{told}");
    assert!(!out.exists());
    slice(&["--ignore-scripts"]).code(0);
    assert!(!fs::read_to_string(&out).expect("a file").contains("M117"));
}

#[test]
fn the_settings_name_the_file_where_nobody_else_does() {
    let folder = tempfile::tempdir().expect("a folder");
    let slice = |more: &[&str]| {
        let mut command = Command::cargo_bin("pathwright").expect("the program");
        let name = "gcode.file_name={input_filename_base}_{layer_height}mm_{filament_type[0]}.gcode";
        command.arg("slice").arg(model("calibration_cube")).arg("-o").arg(folder.path());
        command.args(["--set", name, "-q"]).args(more).assert().code(0);
    };
    slice(&[]);
    assert!(folder.path().join("calibration_cube_0.2mm_PLA.gcode").exists());
    slice(&["--set", "gcode.binary=true"]);
    assert!(folder.path().join("calibration_cube_0.2mm_PLA.bgcode").exists());
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2);
}
