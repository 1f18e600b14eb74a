//! A Duet, stood in for: a board of its own (`rr_…`) and one with a single-board computer (`/machine`), as
//! <https://github.com/Duet3D/RepRapFirmware/wiki/HTTP-requests> and
//! <https://github.com/Duet3D/DuetSoftwareFramework/wiki/REST-API> describe them. No firmware is behind it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

use serde_json::{Value, json};

use super::http::{Answer, Request, Server};

/// Its password.
pub const PASSWORD: &str = "open-sesame";

/// What a machine does.
#[derive(Default)]
pub struct Machine {
    pub files: BTreeMap<String, Vec<u8>>,
    pub status: &'static str,
    pub current: Option<String>,
    pub last: Option<String>,
    /// Files that were started.
    pub started: Vec<String>,
    /// How often it is asked until a print is over.
    pub polls: u32,
    /// How often it is asked while the next print lasts; zero: three times.
    pub lasts: u32,
    pub free_bytes: u64,
}

impl Machine {
    fn start(&mut self, command: &str) {
        let name = command.strip_prefix("M32 \"0:/gcodes/").and_then(|rest| rest.strip_suffix('"'));
        let name = name.expect("a file to start").to_owned();
        if self.files.contains_key(&name) && self.status == "idle" {
            self.started.push(name.clone());
            let polls = if self.lasts == 0 { 3 } else { self.lasts };
            (self.status, self.current, self.polls) = ("processing", Some(name), polls);
        }
    }

    /// Time passes with every question.
    fn pass(&mut self) {
        self.polls = self.polls.saturating_sub(u32::from(self.status == "processing"));
        if self.status == "processing" && self.polls == 0 {
            (self.status, self.last) = ("idle", self.current.take());
        }
    }

    fn model(&self) -> Value {
        let axes = ["X", "Y", "Z"].map(|letter| json!({ "letter": letter, "min": 0, "max": 250 }));
        json!({
            "boards": [{ "firmwareName": "RepRapFirmware (stand-in)", "firmwareVersion": "3.6", "name": "Duet" }],
            "move": {
                "axes": axes,
                      "kinematics": { "name": "cartesian" } },
            "network": { "name": "workshop" },
            "state": { "status": self.status },
            "volumes": [{ "freeSpace": self.free_bytes }],
            "job": {
                "file": { "fileName": self.current.as_ref().map(|name| format!("0:/gcodes/{name}")), "size": 100, "numLayers": 9 },
                "filePosition": 50, "layer": 4, "duration": 10,
                "lastFileName": self.last.as_ref().map(|name| format!("0:/gcodes/{name}")),
                "lastFileCancelled": false, "lastFileAborted": false
            }
        })
    }
}

/// A stand-in and its machine.
pub struct Duet {
    pub server: Server,
    machine: Arc<Mutex<Machine>>,
}

impl Duet {
    pub fn board() -> Self {
        Self::of(board)
    }

    pub fn computer() -> Self {
        Self::of(computer)
    }

    fn of(answer: fn(&mut Machine, &Request) -> Answer) -> Self {
        let machine = Machine { status: "idle", free_bytes: 1 << 30, ..Machine::default() };
        let machine = Arc::new(Mutex::new(machine));
        let shared = machine.clone();
        let server = Server::start(move |request| answer(&mut shared.lock().unwrap(), request));
        Self { server, machine }
    }

    pub fn machine(&self) -> MutexGuard<'_, Machine> {
        self.machine.lock().unwrap()
    }
}

/// `rr_…`: a session key is asked for with every request.
fn board(machine: &mut Machine, request: &Request) -> Answer {
    let query = |name: &str| request.query.get(name).cloned().unwrap_or_default();
    if request.path == "/rr_connect" {
        let err = i32::from(query("password") != PASSWORD);
        return Answer::json(
            200,
            &json!({ "err": err, "sessionTimeout": 8000, "sessionKey": 4711, "apiLevel": 2 }),
        );
    }
    if request.headers.get("x-session-key").map(String::as_str) != Some("4711") {
        return Answer::empty(401);
    }
    let name = query("name").trim_start_matches("0:/gcodes/").to_owned();
    let answer = match (request.method.as_str(), request.path.as_str()) {
        ("GET", "/rr_model") => {
            if query("key") == "job" {
                machine.pass();
            }
            json!({ "key": query("key"), "result": machine.model()[query("key")] })
        }
        ("GET", "/rr_fileinfo") => match machine.files.get(&name) {
            Some(file) => json!({ "err": 0, "size": file.len() }),
            None => json!({ "err": 1 }),
        },
        ("POST", "/rr_upload") => {
            let sum = format!("{:08x}", crc32fast::hash(&request.body));
            let is_right = query("crc32") == sum;
            if is_right {
                machine.files.insert(name, request.body.clone());
            }
            json!({ "err": i32::from(!is_right) })
        }
        ("GET", "/rr_gcode") => {
            machine.start(&query("gcode"));
            json!({ "buff": 250 })
        }
        _ => return Answer::empty(404),
    };
    Answer::json(200, &answer)
}

/// `/machine`: a session key, too, and files by their paths.
fn computer(machine: &mut Machine, request: &Request) -> Answer {
    if request.path == "/machine/connect" {
        return match request.query.get("password").map(String::as_str) == Some(PASSWORD) {
            true => Answer::json(200, &json!({ "sessionKey": "aabbcc" })),
            false => Answer::empty(403),
        };
    }
    if !request.path.starts_with("/machine/") {
        return Answer::empty(404);
    }
    if request.headers.get("x-session-key").map(String::as_str) != Some("aabbcc") {
        return Answer::empty(403);
    }
    let name = request.path.rsplit('/').next().unwrap_or_default().to_owned();
    match (request.method.as_str(), request.path.as_str()) {
        ("GET", "/machine/model") => {
            machine.pass();
            Answer::json(200, &machine.model())
        }
        ("POST", "/machine/code") => {
            machine.start(&String::from_utf8_lossy(&request.body));
            Answer::empty(200)
        }
        ("PUT", path) if path.starts_with("/machine/file/0:/gcodes/") => {
            machine.files.insert(name, request.body.clone());
            Answer::empty(201)
        }
        ("GET", path) if path.starts_with("/machine/fileinfo/") => match machine.files.get(&name) {
            Some(file) => Answer::json(200, &json!({ "size": file.len() })),
            None => Answer::empty(404),
        },
        _ => Answer::empty(404),
    }
}
