//! A Moonraker, stood in for, as <https://moonraker.readthedocs.io/en/latest/external_api/introduction/> describes it. It answers
//! pages from elsewhere where its `cors_domains` name them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

use serde_json::{Value, json};

use super::http::{Answer, Request, Server};

/// Its key.
pub const KEY: &str = "a1b2c3d4";

/// What it has.
#[derive(Default)]
pub struct Machine {
    pub files: BTreeMap<String, Vec<u8>>,
    pub started: Vec<String>,
    /// The origins that may ask it.
    pub cors_domains: Vec<String>,
}

/// A stand-in and its machine.
pub struct Moonraker {
    pub server: Server,
    machine: Arc<Mutex<Machine>>,
}

impl Moonraker {
    pub fn start() -> Self {
        let machine = Arc::new(Mutex::new(Machine::default()));
        let shared = machine.clone();
        let server = Server::start(move |request| answer(&mut shared.lock().unwrap(), request));
        Self { server, machine }
    }

    pub fn machine(&self) -> MutexGuard<'_, Machine> {
        self.machine.lock().unwrap()
    }
}

fn answer(machine: &mut Machine, request: &Request) -> Answer {
    let Answer(status, mut headers, body) = match request.method.as_str() {
        "OPTIONS" => Answer::empty(204),
        _ if request.headers.get("x-api-key").map(String::as_str) != Some(KEY) => Answer::empty(401),
        _ => told(machine, request),
    };
    if let Some(origin) = request.headers.get("origin")
        && machine.cors_domains.contains(origin)
    {
        let allowed = [
            ("Access-Control-Allow-Origin", origin.as_str()),
            ("Access-Control-Allow-Methods", "GET, POST, PUT, DELETE, OPTIONS"),
            ("Access-Control-Allow-Headers", "Origin, Accept, Content-Type, X-Requested-With, X-Api-Key"),
        ];
        headers.extend(allowed.map(|(name, value)| (name.to_owned(), value.to_owned())));
    }
    Answer(status, headers, body)
}

fn told(machine: &mut Machine, request: &Request) -> Answer {
    let result = match (request.method.as_str(), request.path.as_str()) {
        ("GET", "/server/info") => json!({ "klippy_state": "ready", "moonraker_version": "stand-in" }),
        ("GET", "/printer/info") => json!({ "hostname": "workshop", "software_version": "stand-in" }),
        ("GET", "/printer/objects/query") => json!({ "status": objects(machine) }),
        ("GET", "/server/files/directory") => {
            let files = machine.files.iter();
            let files: Vec<Value> =
                files.map(|(name, file)| json!({ "filename": name, "size": file.len() })).collect();
            json!({ "disk_usage": { "free": 1u64 << 30 }, "files": files })
        }
        ("POST", "/server/files/upload") => {
            let (name, file) = file_of(&request.body);
            machine.files.insert(name.clone(), file);
            return Answer::json(201, &json!({ "result": { "item": { "path": name } } }));
        }
        ("POST", "/printer/print/start") => {
            machine.started.push(request.query["filename"].clone());
            json!("ok")
        }
        _ => return Answer::empty(404),
    };
    Answer::json(200, &json!({ "result": result }))
}

fn objects(machine: &Machine) -> Value {
    let state = if machine.started.is_empty() { "standby" } else { "printing" };
    json!({
        "configfile": { "settings": { "extruder": { "nozzle_diameter": 0.4 }, "printer": { "kinematics": "corexy" } } },
        "toolhead": { "axis_minimum": [0, 0, 0, 0], "axis_maximum": [250, 250, 250, 0] },
        "print_stats": { "state": state, "filename": machine.started.last(), "message": "" },
        "virtual_sdcard": { "progress": 0.25 },
        "display_status": { "progress": 0.25 },
        "idle_timeout": { "state": "Idle" },
    })
}

/// Name and bytes of the file in a form.
fn file_of(form: &[u8]) -> (String, Vec<u8>) {
    let text = String::from_utf8_lossy(form);
    let at = text.find("filename=\"").expect("a file") + "filename=\"".len();
    let name = text[at..].split('"').next().unwrap().to_owned();
    let begin = at + text[at..].find("\r\n\r\n").unwrap() + 4;
    let end = text.rfind("\r\n--").unwrap();
    (name, text[begin..end].as_bytes().to_vec())
}
