//! The server as a process of its own, on a port of its own, which ends with the test.

use std::io::{BufRead, BufReader, Read};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::http::{Answer, Request};

/// The server.
pub struct Server {
    pub address: SocketAddr,
    process: Running,
    options: Vec<String>,
    data: PathBuf,
    token: Option<String>,
    _folder: TempDir,
}

impl Server {
    /// With more options.
    pub fn with(options: &[&str]) -> Self {
        Self::start(tempfile::tempdir().unwrap(), options)
    }

    pub fn new() -> Self {
        Self::with(&[])
    }

    /// With a token that each request has.
    pub fn with_tokens(tokens: &str, own: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("tokens");
        std::fs::write(&file, tokens).unwrap();
        let options = ["--token-file", file.to_str().unwrap()];
        Self { token: Some(own.to_owned()), ..Self::start(folder, &options) }
    }

    fn start(folder: TempDir, options: &[&str]) -> Self {
        let data = folder.path().join("data");
        let options: Vec<String> = options.iter().map(|&option| option.to_owned()).collect();
        let (process, address) = started(&data, &options);
        Self { address, process: Running(process), options, data, token: None, _folder: folder }
    }

    /// Ends it at once, as a failing machine would, and starts it again on the same folder.
    pub fn kill_and_restart(&mut self) {
        self.process.end();
        let (process, address) = started(&self.data, &self.options);
        (self.process, self.address) = (Running(process), address);
    }

    /// Its exit code, when it has ended by itself.
    pub fn wait(&mut self) -> Option<i32> {
        self.process.0.wait().unwrap().code()
    }

    /// What it has on the disk.
    pub fn data(&self) -> &Path {
        &self.data
    }

    pub fn id(&self) -> u32 {
        self.process.0.id()
    }

    pub fn send(&self, request: Request) -> Answer {
        let request = match &self.token {
            Some(token) => request.header("authorization", &format!("Bearer {token}")),
            None => request,
        };
        request.send(self.address).unwrap()
    }

    pub fn get(&self, path: &str) -> Answer {
        self.send(Request::get(path))
    }

    /// Sends a job for one model.
    pub fn submit(&self, model: &str, settings: &Value) -> Answer {
        let contents = std::fs::read(model_path(model)).unwrap();
        let project = json!({ "settings": settings }).to_string();
        self.send(
            Request::new("POST", "/v1/jobs")
                .form(&[("project", None, project.as_bytes()), ("model", Some(model), &contents)]),
        )
    }

    /// The id of an accepted job.
    pub fn accepted(&self, model: &str, settings: &Value) -> String {
        let answer = self.submit(model, settings);
        assert_eq!(answer.status, 202, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    /// The job when it has ended.
    pub fn ended(&self, id: &str) -> Value {
        let begun = Instant::now();
        loop {
            let job = self.get(&format!("/v1/jobs/{id}")).json();
            if !matches!(job["state"].as_str(), Some("waiting" | "running")) {
                return job;
            }
            assert!(begun.elapsed() < Duration::from_secs(300), "{job}");
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// The G-code of a job when it is done.
    pub fn gcode(&self, id: &str) -> Vec<u8> {
        let job = self.ended(id);
        assert_eq!(job["state"], "done", "{job}");
        let answer = self.get(&format!("/v1/jobs/{id}/gcode"));
        assert_eq!(answer.status, 200, "{}", answer.text());
        answer.body
    }

    /// A figure of `/metrics`.
    pub fn figure(&self, name: &str) -> f64 {
        let text = self.get("/metrics").text();
        let line = text.lines().find(|line| line.split(' ').next() == Some(name));
        line.and_then(|line| line.split(' ').nth(1)?.parse().ok()).unwrap_or(0.0)
    }
}

/// A process that ends with its owner.
struct Running(Child);

impl Running {
    fn end(&mut self) {
        // It may be dead already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.end();
    }
}

/// A program of this project, ready to be started.
pub fn program() -> Command {
    Command::new(assert_cmd::cargo::cargo_bin!("pathwright"))
}

/// Presets of the machine that the tests run on are not looked for.
fn started(data: &Path, options: &[String]) -> (Child, SocketAddr) {
    let mut command = program();
    command.args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(data).args(options);
    command
        .env("HOME", data.parent().unwrap())
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("PATHWRIGHT_PRESETS");
    let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.trim().rsplit('/').next().unwrap().parse();
    (process, address.unwrap_or_else(|_| panic!("`{line}` is no address")))
}

pub fn model_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

/// What the command line makes of a model.
pub fn sliced(model: &str, settings: &Value) -> Vec<u8> {
    let mut command = program();
    command.arg("slice").arg(model_path(model)).args(["--quiet", "-o", "-"]);
    for (key, value) in settings.as_object().unwrap() {
        command.args(["--set", &format!("{key}={}", value.as_str().unwrap())]);
    }
    let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut gcode = Vec::new();
    process.stdout.take().unwrap().read_to_end(&mut gcode).unwrap();
    assert!(process.wait().unwrap().success());
    gcode
}

/// The most memory that the server ever had.
pub fn peak_bytes(server: &Server) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", server.id())).unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.and_then(|peak| peak.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) << 10
}
