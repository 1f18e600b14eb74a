//! The program, with a file of hosts of its own.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use tempfile::TempDir;

/// A folder with a file of hosts and G-code.
pub struct Desk {
    pub folder: TempDir,
}

impl Desk {
    /// With one host, called `it`.
    pub fn with(kind: &str, url: &str, more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("[it]\nkind = \"{kind}\"\nurl = \"{url}\"\n{more}\n");
        std::fs::write(folder.path().join("hosts.toml"), text).unwrap();
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A small print: a calibration cube of 5 mm, with more settings.
    pub fn sliced(&self, name: &str, more: &[&str]) -> PathBuf {
        let path = self.path(name);
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl");
        let mut command = self.command();
        command.arg("slice").arg(model).args(["--quiet", "--scale", "0.25", "-o"]).arg(&path).args(more);
        let done = command.output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        path
    }

    /// The same with two tools, of which the second prints the infill of each layer.
    pub fn of_two_tools(&self, name: &str, more: &[&str]) -> PathBuf {
        let profile = self.path("two-tools.toml");
        let text = "inherits = [\"reprap-250\", \"pla\", \"0.2mm\"]\n[tool_change]\nkind = \"tool-changer\"\n\
                    [tool_of]\ninfill = 2\n[[tools]]\n[[tools]]\n";
        std::fs::write(&profile, text).unwrap();
        let profile = profile.display().to_string();
        let few =
            ["layer.height=0.3", "prime_tower.enabled=false", "shell.top_layers=1", "shell.bottom_layers=1"];
        let few: Vec<&str> = ["--profile", &profile]
            .into_iter()
            .chain(few.into_iter().flat_map(|set| ["--set", set]))
            .collect();
        self.sliced(name, &[&few, more].concat())
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("pathwright"));
        command.env("PATHWRIGHT_HOSTS", self.path("hosts.toml")).env("HOME", self.folder.path());
        for variable in
            ["XDG_CONFIG_HOME", "PATHWRIGHT_PRESETS", "HTTP_PROXY", "http_proxy", "ALL_PROXY", "all_proxy"]
        {
            command.env_remove(variable);
        }
        command
    }

    /// Runs the program: exit code, and all that it said.
    pub fn run(&self, args: &[&str]) -> (i32, String) {
        said(&self.command().args(args).output().unwrap())
    }

    /// Sends a file to `it`; no fault lasts longer than two seconds.
    pub fn send(&self, file: &Path, args: &[&str]) -> (i32, String) {
        let mut command = self.command();
        command.arg("send").arg(file).args(["--to", "it", "--retry", "2", "--host-timeout", "1"]).args(args);
        said(&command.output().unwrap())
    }

    /// Begins to send a file.
    pub fn begin(&self, file: &Path, args: &[&str]) -> Child {
        let mut command = self.command();
        command.arg("send").arg(file).args(["--to", "it"]).args(args);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }
}

/// Waits until a program that sends has seen its print start.
pub fn wait_until_started(sending: &mut Child) {
    let mut told = String::new();
    let mut errors = sending.stderr.take().unwrap();
    while !told.ends_with(" has started\n") {
        let mut byte = [0];
        assert_eq!(errors.read(&mut byte).unwrap(), 1, "it ended: {told}");
        told.push(char::from(byte[0]));
    }
    sending.stderr = Some(errors);
}

/// Exit code, and all that was said.
pub fn said(done: &Output) -> (i32, String) {
    let text = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    (done.status.code().unwrap_or(-1), text)
}
