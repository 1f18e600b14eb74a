//! `pathwright app` as a process that ends with the test.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// The program, answering on a port of this machine.
pub struct Server {
    process: Child,
    /// Address of its page.
    pub address: String,
    /// Its port.
    pub port: u16,
}

impl Server {
    /// Starts it on any free port.
    pub fn start() -> Self {
        Self::on(0, &[])
    }

    /// Starts it on a port, with models to begin with.
    pub fn on(port: u16, models: &[&Path]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_pathwright"))
            .args(["app", "--no-browser", "--threads", "2", "--port", &port.to_string()])
            .args(models)
            // Presets of whoever runs the tests are no part of them.
            .env("HOME", std::env::temp_dir())
            .env_remove("PATHWRIGHT_PRESETS")
            .env_remove("XDG_CONFIG_HOME")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
        let first = lines.next().expect("it says where it is").unwrap();
        let address = first.split(' ').next().unwrap().to_owned();
        std::thread::spawn(move || lines.for_each(drop));
        let port = address.trim_end_matches('/').rsplit_once(':').unwrap().1.parse().unwrap();
        Self { process, address, port }
    }

    /// Ends it at once.
    pub fn kill(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.kill();
    }
}
