//! What the service tells about itself, and what its documentation shows.

use std::collections::BTreeSet;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::http::Request;
use crate::server::{Server, model_path};

#[test]
fn the_description_names_every_answer_and_is_of_version_3_1() {
    let server = Server::new();
    let api = server.get("/v1/openapi.json").json();
    assert_eq!(api["openapi"], "3.1.0");
    let paths = api["paths"].as_object().unwrap();
    for path in ["/v1/jobs", "/v1/jobs/{id}/gcode", "/v1/reorder", "/v1/schema", "/healthz", "/metrics"] {
        assert!(paths.contains_key(path), "{path}");
    }
    let operations = paths.values().flat_map(|path| path.as_object().unwrap().values());
    let mut ids = BTreeSet::new();
    for operation in operations.filter(|operation| operation.is_object()) {
        let id = operation["operationId"].as_str().unwrap();
        assert!(ids.insert(id.to_owned()), "{id} twice");
        assert!(operation["responses"].get("401").is_some(), "{id}");
    }
}

#[test]
fn every_setting_is_described() {
    let server = Server::new();
    let schema = server.get("/v1/schema").json();
    let groups = schema["groups"].as_array().unwrap();
    let settings: Vec<&Value> =
        groups.iter().flat_map(|group| group["settings"].as_array().unwrap()).collect();
    let keys: Vec<&str> = settings.iter().map(|setting| setting["key"].as_str().unwrap()).collect();
    let known: Vec<String> = pathwright::profile::keys().map(|(key, _)| key).collect();
    assert_eq!(keys, known);
    let density = settings.iter().find(|setting| setting["key"] == "infill.density").unwrap();
    assert_eq!((density["kind"].as_str(), density["per_object"].as_bool()), (Some("percent"), Some(true)));
    let bare = settings.iter().filter(|setting| setting["default"].is_null());
    assert_eq!(bare.count(), 0, "a setting without a default");
}

#[test]
fn a_configuration_of_another_slicer_becomes_a_profile() {
    let server = Server::new();
    let ini = "layer_height = 0.15\nfill_density = 35%\nno_such_key = 1\n";
    let converted = |text: &str| {
        server.send(Request::new("POST", "/v1/profiles/convert?name=mine.ini").body("text/plain", text))
    };
    let profile = converted(ini).text();
    for line in ["height = 0.15", "density = 0.35", "no_such_key"] {
        assert!(profile.contains(line), "{line}:\n{profile}");
    }
    assert_eq!(converted("nothing").status, 422);
}

#[test]
fn the_page_and_its_headers_are_there() {
    let server = Server::new();
    let page = server.get("/");
    assert_eq!((page.status, page.header("content-type")), (200, Some("text/html; charset=utf-8")));
    assert!(page.header("content-security-policy").unwrap().contains("default-src 'none'"));
    assert_eq!(page.header("x-content-type-options"), Some("nosniff"));
    assert_eq!(server.send(Request::new("POST", "/")).status, 405);
}

#[test]
fn the_server_ends_in_order_when_it_is_interrupted() {
    if cfg!(not(unix)) {
        return;
    }
    let mut server = Server::new();
    let id = server.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(server.wait(), Some(0));
}

#[test]
fn what_reaches_beyond_this_machine_needs_a_token() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = crate::server::program();
    command.args(["serve", "--listen", "0.0.0.0:0", "--data"]).arg(folder.path());
    let done = command.output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.code() == Some(2) && said.contains("--token-file"), "{said}");
}

#[test]
fn the_examples_of_the_documentation_work() {
    if !Command::new("curl")
        .arg("--version")
        .stdout(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
    {
        eprintln!("curl is not installed: the examples were not run");
        return;
    }
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/service.md")).unwrap();
    let blocks = page.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let examples: Vec<&str> = blocks.collect();
    assert!(examples.len() > 3);
    let token = "0123456789abcdef0123456789abcdef";
    let server = Server::with_tokens(token, token);
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(model_path("calibration_cube.stl"), folder.path().join("part.stl")).unwrap();
    let script = format!("set -eu\n{}", examples.join("\n"));
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(folder.path());
    command.env("SERVER", format!("http://{}", server.address)).env("TOKEN", token);
    let done = command.output().unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{said}");
    let gcode = std::fs::read(folder.path().join("part.gcode")).unwrap();
    assert!(gcode.len() > 10_000, "{said}");
}
