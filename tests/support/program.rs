//! The program, run on texts.

use assert_cmd::cargo::cargo_bin_cmd;

/// Runs `pathwright reorder` on a text. Exit code, result if there is one, and what was said.
pub fn reorder(text: &[u8], options: &[&str]) -> (i32, Option<Vec<u8>>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let (input, output) = (folder.path().join("in.gcode"), folder.path().join("out.gcode"));
    std::fs::write(&input, text).expect("written");
    let mut command = cargo_bin_cmd!("pathwright");
    command.arg("reorder").arg(&input).arg("-o").arg(&output).args(options);
    let done = command.output().expect("runs");
    let said = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    (done.status.code().unwrap_or(-1), std::fs::read(&output).ok(), said)
}

/// Runs the program with arguments.
pub fn output(args: &[&str]) -> std::process::Output {
    cargo_bin_cmd!("pathwright").args(args).env_remove("SOURCE_DATE_EPOCH").output().expect("runs")
}

/// Runs the program with arguments and something on its standard input.
pub fn output_with_input(args: &[&str], input: &[u8]) -> std::process::Output {
    let mut command = cargo_bin_cmd!("pathwright");
    command.args(args).env_remove("SOURCE_DATE_EPOCH").write_stdin(input).output().expect("runs")
}

/// Runs the program with arguments; it must not fail.
pub fn succeed(args: &[&str]) {
    let done = output(args);
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
}
