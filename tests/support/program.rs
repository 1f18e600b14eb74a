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
