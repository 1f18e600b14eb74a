//! PrusaLink, stood in for: version 1 of its interface, as
//! <https://github.com/prusa3d/Prusa-Link-Web/blob/master/spec/openapi.yaml> describes it. No printer is behind it.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use md5::{Digest, Md5};
use serde_json::json;

use crate::program::Desk;
use crate::stand_in::http::{Answer, Request, Server};

const PASSWORD: &str = "fgT7hbVy";

#[derive(Default)]
struct Machine {
    files: BTreeMap<String, Vec<u8>>,
    printing: Option<String>,
    polls: u32,
    is_finished: bool,
    started: Vec<String>,
}

/// Whether a request has the key, or an answer to the digest's challenge (RFC 7616 with MD5).
fn may(request: &Request) -> bool {
    if request.headers.get("x-api-key").map(String::as_str) == Some(PASSWORD) {
        return true;
    }
    let Some(answer) = request.headers.get("authorization").and_then(|text| text.strip_prefix("Digest "))
    else {
        return false;
    };
    let parts: BTreeMap<&str, &str> = answer
        .split(',')
        .filter_map(|part| part.trim().split_once('='))
        .map(|(name, value)| (name, value.trim_matches('"')))
        .collect();
    let sum = |text: String| Md5::digest(text).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let who = sum(format!("maker:Printer API:{PASSWORD}"));
    let what = sum(format!("{}:{}", request.method, request.target));
    let all = [&who, "once", parts["nc"], parts["cnonce"], parts["qop"], &what].join(":");
    parts["response"] == sum(all) && parts["uri"] == request.target
}

fn answer(machine: &mut Machine, request: &Request) -> Answer {
    if !may(request) {
        let challenge = "Digest realm=\"Printer API\", nonce=\"once\", qop=\"auth\"".to_owned();
        return Answer(401, vec![("WWW-Authenticate".into(), challenge)], Vec::new());
    }
    let name = request.path.strip_prefix("/api/v1/files/usb/").map(str::to_owned);
    match (request.method.as_str(), request.path.as_str(), name) {
        ("GET", "/api/version", _) => Answer::json(
            200,
            &json!({ "api": "2.0.0", "server": "2.1.2", "text": "PrusaLink", "hostname": "PrusaMK4" }),
        ),
        ("GET", "/api/v1/info", _) => {
            Answer::json(200, &json!({ "nozzle_diameter": 0.4, "hostname": "PrusaMK4" }))
        }
        ("GET", "/api/v1/storage", _) => Answer::json(
            200,
            &json!({ "storage_list": [
                { "type": "LOCAL", "path": "/local", "available": true, "read_only": true },
                { "type": "USB", "path": "/usb", "available": true, "read_only": false, "free_space": 1_u64 << 30 }
            ]}),
        ),
        ("GET", "/api/v1/status", _) => {
            let printing = machine.printing.is_some();
            let words = match (printing, machine.is_finished) {
                (true, _) => "PRINTING",
                (_, true) => "FINISHED",
                _ => "IDLE",
            };
            Answer::json(
                200,
                &json!({ "printer": { "state": words }, "job": { "progress": 50.0, "time_remaining": 60 } }),
            )
        }
        ("GET", "/api/v1/job", _) => {
            let Some(file) = machine.printing.clone() else { return Answer::empty(204) };
            machine.polls -= 1;
            if machine.polls == 0 {
                (machine.printing, machine.is_finished) = (None, true);
            }
            Answer::json(
                200,
                &json!({ "id": 1, "state": "PRINTING", "file": { "name": "A~1.GCO", "display_name": file } }),
            )
        }
        ("GET", _, Some(name)) => match machine.files.get(&name) {
            Some(file) => {
                Answer::json(200, &json!({ "name": name, "size": file.len(), "type": "PRINT_FILE" }))
            }
            None => Answer::empty(404),
        },
        ("PUT", _, Some(name)) => {
            assert_eq!(
                request.headers["print-after-upload"], "?0",
                "a start is asked for when all is stored"
            );
            if machine.files.contains_key(&name) && request.headers["overwrite"] != "?1" {
                return Answer::json(409, &json!({ "title": "File already exists" }));
            }
            machine.files.insert(name, request.body.clone());
            Answer::empty(201)
        }
        ("POST", _, Some(name)) => {
            if machine.printing.is_some() {
                return Answer::json(409, &json!({ "title": "Printer is busy" }));
            }
            machine.started.push(name.clone());
            (machine.printing, machine.polls, machine.is_finished) = (Some(name), 4, false);
            Answer::empty(204)
        }
        _ => Answer::empty(404),
    }
}

fn takes_and_prints(more: &str) {
    let machine = Arc::new(Mutex::new(Machine::default()));
    let shared = machine.clone();
    let server = Server::start(move |request| answer(&mut shared.lock().unwrap(), request));
    let desk = Desk::with("prusalink", &format!("http://{}", server.address), more);
    let file = desk.sliced("part.gcode", &[]);
    let (code, said) = desk.send(&file, &["--start", "--wait"]);
    assert!(code == 0 && said.contains("printed part.gcode"), "{code}: {said}");
    let machine = machine.lock().unwrap();
    assert_eq!(machine.files["part.gcode"], std::fs::read(&file).unwrap());
    assert_eq!(machine.started, ["part.gcode"]);
}

pub fn files_are_put_started_and_followed_with_a_digest() {
    takes_and_prints(&format!("user = \"maker\"\nkey = \"{PASSWORD}\""));
}

pub fn files_are_put_with_a_key() {
    takes_and_prints(&format!("key = \"{PASSWORD}\""));
}
