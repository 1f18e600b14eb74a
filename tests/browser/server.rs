//! `pathwright app` as a process that ends with the test.

use std::ffi::OsString;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use tempfile::TempDir;

use crate::site::{self, Files};

/// The program, answering on a port of this machine.
pub struct Server {
    process: Option<Child>,
    files: Option<Files>,
    /// Address of its page.
    pub address: String,
    /// Its port.
    pub port: u16,
    _folder: Option<TempDir>,
}

impl Server {
    /// Starts it on any free port; where that is chosen, static files in its place.
    pub fn start() -> Self {
        if site::is_chosen() {
            let files = Files::serve(&site::folder().expect("the page as static files"));
            let address = format!("http://127.0.0.1:{}/", files.port);
            return Self { process: None, address, port: files.port, files: Some(files), _folder: None };
        }
        Self::on(0, &[])
    }

    /// Starts it on a port, with models to begin with.
    pub fn on(port: u16, models: &[&Path]) -> Self {
        let mut command = Command::new(program());
        command.args(["app", "--no-browser", "--threads", "2", "--port", &port.to_string()]).args(models);
        Self::run(command, None)
    }

    /// Starts it with a file of print hosts.
    pub fn with_hosts(file: &Path) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pathwright"));
        command.args(["app", "--no-browser", "--threads", "2"]).env("PATHWRIGHT_HOSTS", file);
        Self::run(command, None)
    }

    /// `pathwright serve` with a token.
    pub fn with_token(token: &str) -> Self {
        let folder = TempDir::new().unwrap();
        let file = folder.path().join("tokens");
        fs::write(&file, token).unwrap();
        let mut command = Command::new(program());
        command
            .args(["serve", "--threads", "2", "--listen", "127.0.0.1:0", "--data"])
            .arg(folder.path().join("data"));
        command.arg("--token-file").arg(file);
        Self::run(command, Some(folder))
    }

    fn run(mut command: Command, folder: Option<TempDir>) -> Self {
        // Presets of whoever runs the tests are no part of them.
        command
            .env("HOME", std::env::temp_dir())
            .env_remove("PATHWRIGHT_PRESETS")
            .env_remove("XDG_CONFIG_HOME");
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let first = lines.next().expect("it says where it is").unwrap();
        let address = first.split(' ').find(|word| word.starts_with("http")).expect("an address").to_owned();
        std::thread::spawn(move || lines.for_each(drop));
        let port = address.trim_end_matches('/').rsplit_once(':').unwrap().1.parse().unwrap();
        Self { process: Some(process), files: None, address, port, _folder: folder }
    }

    /// Ends it at once.
    pub fn kill(&mut self) {
        if let Some(process) = &mut self.process {
            let _ = process.kill();
            let _ = process.wait();
        }
        self.files = None;
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.kill();
    }
}

/// The program; the variable `PATHWRIGHT_PROGRAM` names that of another build, to be measured.
fn program() -> OsString {
    std::env::var_os("PATHWRIGHT_PROGRAM").unwrap_or_else(|| env!("CARGO_BIN_EXE_pathwright").into())
}
