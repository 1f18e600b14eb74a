//! Whatever happens to a run, the old output stays whole or the new one is whole. Linux and other Unixes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("pathwright").to_path_buf()
}

fn cube() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl")
}

/// A quick slicing of the cube into a file.
fn slicing(output: &Path) -> Command {
    let mut command = Command::new(program());
    command.arg("slice").arg(cube()).args(["--profile", "standard-job", "--order", "nearest", "-q", "-o"]);
    command.arg(output);
    command
}

/// The same, under a shell that sets things up first.
fn shell(setup: &str, output: &Path) -> Output {
    let quoted = |path: &Path| format!("'{}'", path.display());
    let run = format!(
        "{setup} {} slice {} --profile standard-job --order nearest -q -o {}",
        quoted(&program()),
        quoted(&cube()),
        quoted(output)
    );
    Command::new("sh").args(["-c", &run]).output().expect("a shell")
}

fn whole() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("whole.gcode");
    assert!(slicing(&output).status().unwrap().success());
    fs::read(output).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn message(done: &Output) -> String {
    String::from_utf8_lossy(&done.stderr).into_owned()
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.gcode");
    fs::write(&output, "old").unwrap();
    // A limit on the size of files stands in for the end of the disk.
    let done = shell("trap '' XFSZ; ulimit -f 64; exec", &output);
    assert_eq!(done.status.code(), Some(6), "{}", message(&done));
    assert_eq!(fs::read_to_string(&output).unwrap(), "old");
    assert_eq!(names(folder.path()), ["part.gcode"]);
    if Path::new("/dev/full").exists() {
        let done = shell("exec", Path::new("/dev/full"));
        assert_eq!(done.status.code(), Some(6));
        assert!(message(&done).contains("the disk is full"), "{}", message(&done));
    }
}

#[test]
fn a_full_file_system_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let mount = format!(
        "unshare -rm sh -c 'mount -t tmpfs -o size=256k tmpfs \"$1\" && echo old > \"$1/part.gcode\" && \
         shift && \"$@\"; code=$?; cat {0}/part.gcode; ls -A {0} | wc -l; exit $code' sh {0}",
        folder.path().display()
    );
    let done = shell(&mount, &folder.path().join("part.gcode"));
    // Not everybody may mount.
    if message(&done).contains("disk is full") {
        assert_eq!(done.status.code(), Some(6));
        assert_eq!(String::from_utf8_lossy(&done.stdout), "old\n1\n");
    }
}

/// A run that waits for its model, which comes through a pipe, with its output begun.
struct Waiting {
    child: Child,
    model: PathBuf,
}

impl Waiting {
    fn new(models: &Path, output: &Path) -> Self {
        let model = models.join("model.stl");
        assert!(Command::new("mkfifo").arg(&model).status().unwrap().success());
        let child = Command::new(program())
            .args(["slice".as_ref(), model.as_os_str(), "-q".as_ref(), "-o".as_ref(), output.as_os_str()])
            .args(["--profile", "standard-job", "--order", "nearest"])
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let folder = output.parent().unwrap();
        let begun = Instant::now();
        while !names(folder).iter().any(|name| name.starts_with(".pathwright-")) {
            assert!(begun.elapsed() < Duration::from_secs(120), "no temporary file");
            sleep(Duration::from_millis(5));
        }
        Self { child, model }
    }

    fn feed(self, bytes: &[u8]) -> Output {
        let mut pipe = fs::OpenOptions::new().write(true).open(&self.model).unwrap();
        // The run may have seen enough.
        let _ = pipe.write_all(bytes);
        drop(pipe);
        self.child.wait_with_output().unwrap()
    }
}

#[test]
fn a_folder_that_vanishes_is_an_output_error() {
    let folder = tempfile::tempdir().unwrap();
    let gone = folder.path().join("gone");
    fs::create_dir(&gone).unwrap();
    let run = Waiting::new(folder.path(), &gone.join("part.gcode"));
    fs::remove_dir_all(&gone).unwrap();
    let done = run.feed(&fs::read(cube()).unwrap());
    assert_eq!(done.status.code(), Some(6), "{}", message(&done));
    assert!(!gone.exists());
}

#[test]
fn a_model_cut_off_while_it_is_read_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let output = out.join("part.gcode");
    fs::write(&output, "old").unwrap();
    let model = fs::read(cube()).unwrap();
    let done = Waiting::new(folder.path(), &output).feed(&model[..model.len() / 2 + 7]);
    assert_eq!(done.status.code(), Some(3), "{}", message(&done));
    assert!(message(&done).contains("ends early"), "{}", message(&done));
    assert_eq!(
        (fs::read_to_string(&output).unwrap(), names(&out)),
        ("old".into(), vec!["part.gcode".into()])
    );
}

#[test]
fn a_file_changed_while_it_is_reordered_is_refused_or_done_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("a.gcode"), folder.path().join("b.gcode"));
    let text = whole();
    for pause_ms in [0, 20, 60, 120] {
        fs::write(&input, &text).unwrap();
        fs::write(&output, "old").unwrap();
        let mut child = Command::new(program())
            .args(["reorder".as_ref(), input.as_os_str(), "-q".as_ref(), "-o".as_ref(), output.as_os_str()])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        sleep(Duration::from_millis(pause_ms));
        fs::OpenOptions::new().write(true).open(&input).unwrap().set_len(text.len() as u64 / 2).unwrap();
        let code = child.wait().unwrap().code();
        let written = fs::read(&output).unwrap();
        match code {
            Some(0) => assert!(written.ends_with(b"\n") || written.len() >= text.len() / 2),
            Some(3 | 7) => assert_eq!(written, b"old"),
            code => panic!("{code:?}"),
        }
        assert_eq!(names(folder.path()), ["a.gcode", "b.gcode"]);
    }
}

#[test]
fn killed_at_any_moment_the_output_is_the_old_or_the_new() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.gcode");
    let new = whole();
    let begun = Instant::now();
    assert!(slicing(&output).status().unwrap().success());
    let took = begun.elapsed();
    let old: &[u8] = b"old";
    for round in 0..18_u32 {
        let signal = ["-KILL", "-INT", "-TERM"][round as usize % 3];
        fs::write(&output, old).unwrap();
        let mut child = slicing(&output).stderr(Stdio::null()).spawn().unwrap();
        sleep(took * (round * 7 % 18) / 16);
        // It may be over already.
        let _ = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
        let status = child.wait().unwrap();
        let found = fs::read(&output).unwrap();
        assert!(found == old || found == new, "{signal} in round {round}: {} bytes", found.len());
        if signal != "-KILL" && status.code().is_some() {
            assert!(matches!(status.code(), Some(0 | 130)), "{status}");
            // It may come between the renaming and the end.
            assert!(status.code() != Some(0) || found == new, "{status}");
        }
    }
    // Only a run that is killed outright may leave its temporary file.
    assert!(names(folder.path()).len() <= 1 + 6, "{:?}", names(folder.path()));
    // One that is killed in the middle on any machine, as it waits for its model.
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.gcode");
    fs::write(&output, old).unwrap();
    let mut run = Waiting::new(folder.path(), &output);
    run.child.kill().unwrap();
    assert_eq!(run.child.wait().unwrap().code(), None);
    assert_eq!(fs::read(&output).unwrap(), old);
}

#[test]
fn a_reader_that_goes_away_ends_the_run_quietly() {
    let mut child = Command::new(program())
        .args(["slice".as_ref(), cube().as_os_str()])
        .args(["--profile", "standard-job", "--order", "nearest", "-q", "-o", "-"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let done = child.wait_with_output().unwrap();
    assert_eq!((done.status.code(), message(&done)), (Some(6), String::new()));
}

#[test]
fn neither_terminal_nor_home_nor_room_for_temporary_files_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.gcode");
    for setup in
        ["HOME=/proc TMPDIR=/proc XDG_CONFIG_HOME=/proc exec", "exec setsid", "exec 0<&- 1>&- 2>&-; exec"]
    {
        let done = shell(setup, &output);
        assert_eq!(done.status.code(), Some(0), "{setup}: {}", message(&done));
        assert_eq!(fs::read(&output).unwrap(), whole(), "{setup}");
        fs::remove_file(&output).unwrap();
    }
}

#[test]
fn of_two_runs_that_write_one_file_one_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("part.gcode");
    let runs: Vec<Child> = (0..3).map(|_| slicing(&output).spawn().unwrap()).collect();
    for mut run in runs {
        assert!(run.wait().unwrap().success());
    }
    assert_eq!(fs::read(&output).unwrap(), whole());
    assert_eq!(names(folder.path()), ["part.gcode"]);
}
