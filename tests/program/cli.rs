//! The program as users and scripts call it: arguments, exit codes, messages, pages.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;

fn pathwright(args: &[&str]) -> Command {
    let mut command = cargo_bin_cmd!("pathwright");
    command.args(args);
    command
}

/// Standard output of a run that must end with this exit code, and standard error.
fn run(args: &[&str], code: i32) -> (String, String) {
    let done = pathwright(args).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(done.stdout), text(done.stderr));
    assert_eq!(done.status.code(), Some(code), "{args:?}\n{out}\n{err}");
    (out, err)
}

#[test]
fn each_command_says_of_itself_what_the_list_of_all_says() {
    let help = run(&["--help"], 0).0;
    let list =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let commands = list.filter_map(|line| line.trim().split_once("  ")).filter(|(name, _)| *name != "help");
    let mut count = 0;
    for (name, about) in commands {
        let own = run(&[name, "--help"], 0).0;
        assert!(own.starts_with(about.trim()), "{name}: {own}");
        count += 1;
    }
    assert!(count >= 10, "{help}");
}

#[test]
fn version_and_help_are_no_failure() {
    assert!(run(&["--version"], 0).0.starts_with("pathwright "));
    assert!(run(&["--help"], 0).0.contains("130  interrupted"));
    assert!(run(&["slice", "--help"], 0).0.contains("5    the models do not fit the printer"));
}

#[test]
fn arguments_that_make_no_sense_are_usage_errors() {
    for args in [
        &["slice"][..],
        &["frobnicate"],
        &["slice", "a.stl", "--copies", "0"],
        &["slice", "a.stl", "--threads", "0"],
        &["slice", "a.stl", "--scale", "0"],
        &["slice", "a.stl", "--rotate", "1,2"],
        &["slice", "a.stl", "--set", "walls.count"],
        &["slice", "a.stl", "--order", "best"],
        &["slice", "a.stl", "--pause-at", "never"],
        &["slice", "a.stl", "--json", "--quiet"],
        &["slice", "a.stl", "--json", "-o", "-"],
        &["slice", "a.stl", "b.stl", "--each", "-o", "-"],
        &["slice", "a.stl", "b.stl", "--each", "-o", "no-such-folder"],
        &["slice", "a.stl", "-o", "no-such-folder/"],
        &["slice", "a.stl", "-o", ""],
        &["man", "frobnicate"],
    ] {
        let (out, err) = run(args, 2);
        assert!(out.is_empty() && !err.is_empty(), "{args:?}");
    }
}

#[test]
fn settings_of_an_object_are_refused_where_they_concern_the_plate() {
    let (_, err) =
        run(&["slice", "a.stl", "--object", "a.stl:layer.height=0.1", "--object", "a:speed.top=9"], 4);
    assert!(err.contains("--object: layer.height = 0.1: all objects of a plate share their layers"), "{err}");
    assert!(err.contains("speed.top = 9: how the nozzle moves is decided for whole layers"), "{err}");
    let (_, err) = run(&["slice", "a.stl", "--object", "a.stl:infill.densty=10%"], 4);
    assert!(err.contains("did you mean `infill.density`?"), "{err}");
    run(&["slice", "a.stl", "--object", "infill.density=10%"], 2);
    run(&["slice", "a.stl", "--no-arrange", "--copies", "2"], 2);
    run(&["slice", "a.stl", "--no-arrange", "--orient"], 4);
}

#[test]
fn negative_numbers_need_no_tricks() {
    let (_, err) = run(&["slice", "no-such.stl", "--translate", "-5,0,0", "--rotate", "-90,0,0"], 3);
    assert!(err.contains("no-such.stl"), "{err}");
}

#[test]
fn a_model_that_is_not_there_is_an_input_error() {
    for command in ["slice", "info"] {
        let (_, err) = run(&[command, "no-such.stl"], 3);
        assert!(err.starts_with("error: no-such.stl: "), "{err}");
    }
}

#[test]
fn the_time_of_a_file_is_told_by_role_and_layer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gcode");
    // 100 mm at 100 mm/s and 3000 mm/s²: a second, and a thirtieth for speeding up and slowing down.
    let text = "G28\nG1 Z0.2 F600\nM83\n;LAYER_CHANGE\n;TYPE:External perimeter\nG1 X100 E4 F6000\nG4 P500\n\
                ;LAYER_CHANGE\nG1 E-1 F2400\nG1 Z0.4 F600\nG1 X0 F9000\nG1 E1 F2400\nG1 X100 E4 F6000\n";
    fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    for machine in ["klipper", "marlin", "marlin-classic", "reprapfirmware"] {
        let (out, _) = run(&["time", path, "--machine", machine, "--json"], 0);
        let json: serde_json::Value = serde_json::from_str(&out).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        assert_eq!((json["machine"].as_str(), json["layer_count"].as_u64()), (Some(machine), Some(2)));
        let wall_s = number(&json["by_role"]["External perimeter"]);
        let rest_s = if machine == "marlin-classic" { 0.9 } else { 1.0 };
        assert!((wall_s - 2.0 * (1.0 + rest_s / 30.0)).abs() < 0.02, "{machine}: {wall_s}");
        assert_eq!(number(&json["by_role"]["Wait"]), 0.5);
        let layers: f64 =
            json["layers"].as_array().unwrap().iter().map(|layer| number(&layer["total_s"])).sum();
        assert!((layers + number(&json["before_s"]) - number(&json["total_s"])).abs() < 1e-9);
    }
    assert!(run(&["time", path], 0).0.contains("without heating up, homing, pauses"));
    run(&["time", path, "--machine", "abacus"], 2);
    run(&["time", path, "--limits", "no-such-profile"], 4);
    run(&["time", "no-such.gcode"], 3);
}

#[test]
fn a_check_tells_by_its_exit_code_whether_there_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let print = "M109 S210\nG28\nG90\nM83\n;LAYER:0\nG1 X10 Y10 Z.2 F600\nG1 X20 E.3\nM104 S0\n";
    let good = file("good.gcode", print);
    assert!(run(&["check", &good], 0).0.contains("nothing wrong was found"));
    let faulty = file("faulty.gcode", &print.replace("X20", "X-20"));
    let (table, _) = run(&["check", &faulty, &good], 7);
    assert!(table.contains("outside-bed") && table.contains("line 7, layer 1: to X-20.000"), "{table}");
    let (json, _) = run(&["check", "--json", &faulty], 7);
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&report["errors"], &report["print_mm"]), (&1.into(), &30.0.into()));
    assert_eq!(run(&["check", "-q", &faulty], 7), (String::new(), String::new()));
    let poem = file("poem.gcode", "no moves at all\n");
    assert!(run(&["check", &poem, &good], 3).1.contains("is it G-code?"));
    run(&["check", "missing.gcode"], 3);
    run(&["check", "-", "--model", "models/calibration_cube.stl"], 2);
}

#[test]
fn a_model_is_compared_as_large_and_turned_as_it_was_sliced() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.gcode").display().to_string();
    let model = "models/calibration_cube.stl";
    let shape = ["--scale", "0.5,1,0.2", "--rotate", "0,0,30"];
    run(&[&["slice", model, "-q", "-o", &out], &shape[..]].concat(), 0);
    let beside = |shape: &[&str], code| run(&[&["check", &out, "--model", model], shape].concat(), code).0;
    assert!(beside(&shape, 0).contains("nothing wrong was found"));
    assert!(beside(&[], 7).contains("not-placed"));
}

#[test]
fn what_is_too_much_is_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let fine = ["layer.height=0.01", "layer.first_height=0.01", "bed.height=5000"];
    let out = path("a.gcode");
    let mut args = vec!["slice", "models/calibration_cube.stl", "--scale", "1,1,200", "-o", &out];
    args.extend(fine.iter().flat_map(|set| ["--set", *set]));
    assert!(run(&args, 3).1.contains("400000 layers; at most 100000"));
    // Files of zeros that take no place.
    let sparse = |name: &str, bytes: u64| fs::File::create(path(name)).and_then(|file| file.set_len(bytes));
    if sparse("large.stl", 5 << 30).is_ok() {
        assert!(run(&["info", &path("large.stl")], 3).1.contains("more than 4 GB"));
    }
    if cfg!(target_os = "linux") && sparse("medium.stl", 3 << 30).is_ok() {
        let program = assert_cmd::cargo::cargo_bin!("pathwright").display().to_string();
        let limited = format!("ulimit -v 3000000; exec '{program}' info '{}'", path("medium.stl"));
        let done = Command::new("sh").args(["-c", &limited]).output().unwrap();
        let message = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(3), "{message}");
        assert!(message.contains("of memory are needed"), "{message}");
    }
}

#[test]
fn every_bad_setting_has_its_line() {
    let (_, err) = run(&["slice", "a.stl", "--set", "walls.cuont=3", "--set", "infill.density=150%"], 4);
    let lines: Vec<&str> = err.lines().collect();
    assert_eq!(lines.len(), 2, "{err}");
    assert!(
        lines[0].starts_with("error: --set: walls.cuont = 3: unknown key; did you mean `walls.count`?"),
        "{err}"
    );
    assert!(lines[1].starts_with("error: --set: infill.density = \"150%\": a share from 0 to 1"), "{err}");
}

#[test]
fn an_unknown_profile_is_a_settings_error() {
    let (_, err) = run(&["slice", "a.stl", "--profile", "ender3"], 4);
    assert!(err.contains("did you mean `ender-3`?"), "{err}");
    let (_, err) = run(&["profiles", "show", "ender3"], 4);
    assert!(err.contains("did you mean `ender-3`?"), "{err}");
}

#[test]
fn two_models_that_would_write_one_file_are_refused() {
    let (_, err) = run(&["slice", "a.stl", "a.obj", "--each"], 2);
    assert!(err.contains("a.stl and a.obj would both be written to a.gcode"), "{err}");
    run(&["slice", "a.stl", "./a.stl", "--each"], 2);
}

#[test]
fn a_model_is_never_overwritten() {
    let (_, err) = run(&["slice", "a.stl", "-o", "./a.stl"], 2);
    assert!(err.contains("would replace a model"), "{err}");
    run(&["slice", "part.gcode"], 2);
}

#[test]
fn an_output_that_cannot_be_written_is_an_output_error() {
    let (_, err) = run(&["slice", "a.stl", "-o", "no/such/folder/a.gcode"], 6);
    assert_eq!(err, "error: no/such/folder/a.gcode: cannot be written: there is no such folder\n");
}

#[test]
fn profiles_are_listed_shown_and_dumped() {
    let (list, _) = run(&["profiles"], 0);
    assert_eq!(run(&["profiles", "list"], 0).0, list);
    for name in ["default", "standard-job", "prusa-i3", "delta-round", "petg", "0.3mm"] {
        assert!(list.lines().any(|line| line.split_whitespace().nth(1) == Some(name)), "{name}");
    }
    assert!(run(&["profiles", "show", "petg"], 0).0.contains("inherits = \"pla\""));
    let (dump, _) = run(&["profiles", "dump", "--profile", "petg", "--set", "walls.count=2"], 0);
    assert!(dump.contains("count = 2 # --set") && dump.contains("material = \"PETG\" # profile petg"));
    let (json, _) = run(&["profiles", "dump", "--json"], 0);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["layer.height"]["value"], 0.2);
}

#[test]
fn unwise_settings_are_warned_about() {
    let (_, err) = run(&["profiles", "dump", "--set", "layer.height=0.35"], 0);
    assert!(err.starts_with("warning: --set: layer.height = 0.35: "), "{err}");
}

#[test]
fn completions_and_man_pages_are_printed() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(run(&["completions", shell], 0).0.contains("scale-to-fit"), "{shell}");
    }
    assert!(run(&["man"], 0).0.starts_with(".ie"));
    assert!(run(&["man", "slice"], 0).0.contains("scale\\-to\\-fit"));
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_ends_a_listing_quietly() {
    use std::process::Stdio;
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("pathwright"))
        .args(["profiles", "dump"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let done = child.wait_with_output().unwrap();
    assert_eq!((done.status.code(), done.stderr), (Some(0), Vec::new()));
}

/// The run waits for its model, which is a pipe that nobody writes, when the signal comes.
#[cfg(unix)]
#[test]
fn an_interrupt_removes_what_is_incomplete() {
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};
    let folder = tempfile::tempdir().unwrap();
    let (model, output) = (folder.path().join("model.stl"), folder.path().join("part.gcode"));
    assert!(Command::new("mkfifo").arg(&model).status().unwrap().success());
    fs::write(&output, "old").unwrap();
    for signal in ["-INT", "-TERM"] {
        let mut child = Command::new(assert_cmd::cargo::cargo_bin!("pathwright"))
            .args(["slice".as_ref(), model.as_os_str(), "-o".as_ref(), output.as_os_str()])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let started = Instant::now();
        while entries(folder.path()) != 3 {
            assert!(started.elapsed() < Duration::from_secs(120), "no temporary file");
            sleep(Duration::from_millis(5));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130));
        assert_eq!(entries(folder.path()), 2);
        assert_eq!(fs::read_to_string(&output).unwrap(), "old");
    }
}

#[cfg(unix)]
fn entries(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}
