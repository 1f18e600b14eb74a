//! Jobs from their request to their result.

use std::sync::Arc;

use pathwright::Observer;
use pathwright::job::{ModelFile, ModelFiles, Project};
use pathwright::pipeline::Pipeline;
use serde_json::json;

use crate::http::Request;
use crate::server::{Server, model_path, sliced};

const CUBE: &str = "calibration_cube.stl";

#[test]
fn a_job_gives_the_bytes_of_the_command_line() {
    let server = Server::new();
    let settings = json!({ "infill.density": "15%", "layer.height": "0.3" });
    let id = server.accepted(CUBE, &settings);
    assert!(server.gcode(&id) == sliced(CUBE, &settings), "other bytes");
    let job = server.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(job["name"], "calibration_cube.gcode");
    let summary = server.get(&format!("/v1/jobs/{id}/summary")).json();
    assert!(summary["total_s"].as_f64().unwrap() > 60.0, "{summary}");
}

#[test]
fn what_was_sliced_before_is_there_at_once_and_made_once() {
    let server = Server::new();
    let settings = json!({ "layer.height": "0.3" });
    let first = server.accepted(CUBE, &settings);
    server.ended(&first);
    let again = server.submit(CUBE, &json!({ "layer.height": "0.30" })).json();
    assert_eq!(again["state"], "done", "{again}");
    assert_ne!(again["id"], first.as_str());
    assert_eq!(server.figure("pathwright_runs_begun_total"), 1.0);
}

#[test]
fn a_repeated_request_is_one_job() {
    let server = Server::new();
    let contents = std::fs::read(model_path(CUBE)).unwrap();
    let send = |project: &str| {
        let parts = [("project", None, project.as_bytes()), ("model", Some(CUBE), contents.as_slice())];
        server.send(Request::new("POST", "/v1/jobs").header("Idempotency-Key", "order 7").form(&parts))
    };
    let first = send("{}");
    assert_eq!(send("{}").json()["id"], first.json()["id"]);
    assert_eq!(send(r#"{"settings":{"walls.count":"4"}}"#).status, 422);
}

#[test]
fn the_gcode_comes_in_parts_and_only_if_it_is_another() {
    let server = Server::new();
    let id = server.accepted(CUBE, &json!({ "layer.height": "0.3" }));
    let gcode = server.gcode(&id);
    let path = format!("/v1/jobs/{id}/gcode");
    let part = server.send(Request::get(&path).header("range", "bytes=10-19"));
    assert_eq!((part.status, part.body.as_slice()), (206, &gcode[10..20]));
    assert_eq!(part.header("content-range").unwrap(), format!("bytes 10-19/{}", gcode.len()));
    let end = server.send(Request::get(&path).header("range", "bytes=-5"));
    assert_eq!((end.status, end.body.as_slice()), (206, &gcode[gcode.len() - 5..]));
    assert_eq!(server.send(Request::get(&path).header("range", "bytes=999999999-")).status, 416);
    let tag = part.header("etag").unwrap();
    assert_eq!(server.send(Request::get(&path).header("if-none-match", tag)).status, 304);
    let other = Request::get(&path).header("range", "bytes=0-1").header("if-range", "\"other\"");
    assert_eq!(server.send(other).body.len(), gcode.len());
}

#[test]
fn pictures_and_the_page_are_made_when_they_are_asked_for() {
    let server = Server::new();
    let id = server.accepted(CUBE, &json!({ "layer.height": "0.3" }));
    server.ended(&id);
    let get = |name: &str| server.get(&format!("/v1/jobs/{id}/{name}"));
    for (name, kind, begin) in [
        ("thumbnail.png?size=64", "image/png", &b"\x89PNG"[..]),
        ("layers/3.png", "image/png", b"\x89PNG"),
        ("layers/3.svg", "image/svg+xml", b"<svg"),
        ("preview.html", "text/html; charset=utf-8", b"<!"),
    ] {
        let answer = get(name);
        assert_eq!((answer.status, answer.header("content-type")), (200, Some(kind)), "{name}");
        assert!(answer.body.starts_with(begin), "{name}: {}", answer.text());
        assert!(answer.header("content-security-policy").unwrap().starts_with("sandbox"), "{name}");
    }
    assert_eq!(get("layers/99999.png").status, 404);
    assert_eq!(get("layers/0.svg").status, 404);
}

#[test]
fn events_follow_a_job_to_its_end() {
    let server = Server::new();
    let id = server.accepted(CUBE, &json!({ "layer.height": "0.1" }));
    let events = server.get(&format!("/v1/jobs/{id}/events"));
    assert_eq!(events.header("content-type"), Some("text/event-stream"));
    let text = events.text();
    let states: Vec<String> = text
        .lines()
        .filter_map(|line| line.strip_prefix("data: "))
        .map(|data| {
            serde_json::from_str::<serde_json::Value>(data).unwrap()["state"].as_str().unwrap().to_owned()
        })
        .collect();
    assert_eq!(states.last().map(String::as_str), Some("done"), "{text}");
}

#[test]
fn a_cancelled_job_has_no_result_and_a_deleted_one_is_gone() {
    let server = Server::with(&["--jobs-at-once", "1"]);
    let settings = json!({ "layer.height": "0.05", "infill.density": "90%", "order.effort": "high" });
    let first = server.accepted(CUBE, &settings);
    let second = server.accepted(CUBE, &json!({ "layer.height": "0.06" }));
    for id in [&second, &first] {
        let answer = server.send(Request::new("POST", &format!("/v1/jobs/{id}/cancel")));
        assert_eq!(answer.json()["state"], "cancelled", "{}", answer.text());
        assert_eq!(server.get(&format!("/v1/jobs/{id}/gcode")).status, 410);
    }
    assert_eq!(server.send(Request::new("DELETE", &format!("/v1/jobs/{first}"))).status, 204);
    assert_eq!(server.get(&format!("/v1/jobs/{first}")).status, 404);
}

#[test]
fn a_failed_job_says_why_and_where() {
    let server = Server::new();
    let refused = server.submit(CUBE, &json!({ "walls.count": "many" }));
    assert_eq!((refused.status, refused.json()["error"]["key"].as_str()), (422, Some("walls.count")));
    let contents = std::fs::read(model_path(CUBE)).unwrap();
    let project = json!({ "models": [{ "file": CUBE, "scale": [99.0, 99.0, 99.0] }] }).to_string();
    let parts = [("project", None, project.as_bytes()), ("model", Some(CUBE), contents.as_slice())];
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&parts)).json();
    let job = server.ended(answer["id"].as_str().unwrap());
    assert_eq!(
        (job["state"].as_str(), job["error"]["kind"].as_str()),
        (Some("failed"), Some("does_not_fit"))
    );
}

#[test]
fn a_server_that_is_killed_goes_on_where_it_was() {
    let mut server = Server::with(&["--jobs-at-once", "1"]);
    let settings = |height: &str| json!({ "layer.height": height });
    let heights = ["0.1", "0.15", "0.25", "0.3"];
    let ids = heights.map(|height| server.accepted(CUBE, &settings(height)));
    server.kill_and_restart();
    for (id, height) in ids.iter().zip(heights) {
        assert!(server.gcode(id) == sliced(CUBE, &settings(height)), "{height}");
    }
    server.kill_and_restart();
    assert_eq!(server.get(&format!("/v1/jobs/{}", ids[0])).json()["state"], "done", "results are kept");
    let inputs = std::fs::read_dir(server.data().join("inputs")).unwrap().count();
    assert_eq!(inputs, 0, "inputs of finished jobs are not");
}

#[test]
fn the_oldest_results_go_when_the_disk_quota_is_reached() {
    let server = Server::with(&["--max-disk", "1"]);
    let job = |height: &str| {
        let id = server.accepted(CUBE, &json!({ "layer.height": height }));
        server.ended(&id);
        id
    };
    let ids: Vec<String> = ["0.10", "0.11", "0.12", "0.13"].into_iter().map(job).collect();
    let first = server.get(&format!("/v1/jobs/{}", ids[0])).json();
    assert_eq!(first["state"], "expired", "{first}");
    let gone = server.get(&format!("/v1/jobs/{}/gcode", ids[0]));
    assert!(gone.status == 410 && gone.message().contains("--max-disk"), "{}", gone.text());
    assert_eq!(server.get(&format!("/v1/jobs/{}", ids[3])).json()["state"], "done");
    assert!(server.figure("pathwright_kept_bytes") <= 1048576.0);
}

#[test]
fn clients_do_not_see_each_others_jobs() {
    let (ana, ben) = ("ana-0123456789abcdef", "ben-0123456789abcdef");
    let server = Server::with_tokens(&format!("ana {ana}\nben {ben}\n"), ana);
    let id = server.accepted(CUBE, &json!({ "layer.height": "0.3" }));
    server.ended(&id);
    let of_ben = Request::get(&format!("/v1/jobs/{id}")).header("authorization", &format!("Bearer {ben}"));
    assert_eq!(of_ben.send(server.address).unwrap().status, 404);
}

#[test]
fn finished_gcode_is_reordered_checked_and_timed() {
    let server = Server::new();
    let gcode = sliced(CUBE, &json!({ "layer.height": "0.3", "order.strategy": "as-sliced" }));
    let model = std::fs::read(model_path(CUBE)).unwrap();
    let gcode_part = ("gcode", Some("cube.gcode"), gcode.as_slice());
    let send = |path: &str, parts: &[(&str, Option<&str>, &[u8])]| {
        let answer = server.send(Request::new("POST", path).form(parts));
        assert_eq!(answer.status, 200, "{path}: {}", answer.text());
        answer
    };
    let report = send("/v1/reorder?report=true", &[gcode_part]).json();
    assert!(report["after"]["travel_mm"].as_f64() < report["before"]["travel_mm"].as_f64(), "{report}");
    assert!(send("/v1/reorder", &[gcode_part]).body.len() > 1000);
    assert!(send("/v1/time", &[gcode_part]).json()["total_s"].as_f64().unwrap() > 60.0);
    let checked = send("/v1/check", &[gcode_part, ("model", Some(CUBE), &model)]).json();
    assert_eq!(checked["errors"], 0, "{checked}");
}

#[test]
fn a_project_file_is_the_job_that_it_describes() {
    let server = Server::new();
    let contents = std::fs::read(model_path(CUBE)).unwrap();
    let text = json!({
        "settings": { "layer.height": "0.3" },
        "models": [{ "file": CUBE, "rotate_deg": [0.0, 0.0, 30.0], "copies": 2 }]
    });
    let project: Project = serde_json::from_value(text.clone()).unwrap();
    let observer = Observer::none();
    let model = ModelFile::read(CUBE, contents.clone(), &observer).unwrap();
    let files = ModelFiles::from([(CUBE.to_owned(), Arc::new(model))]);
    let (settings, job) = (project.resolve(None).unwrap().settings, project.job(&files, None).unwrap());
    let file = Pipeline.project_file(&project, &files, &job, &settings, &observer).unwrap();
    let send = |parts: &[(&str, Option<&str>, &[u8])]| {
        let answer = server.send(Request::new("POST", "/v1/jobs").form(parts));
        assert_eq!(answer.status, 202, "{}", answer.text());
        server.gcode(answer.json()["id"].as_str().unwrap())
    };
    let of_parts = send(&[("project", None, text.to_string().as_bytes()), ("model", Some(CUBE), &contents)]);
    assert!(send(&[("model", Some("plate.3mf"), &file)]) == of_parts, "other bytes");
}
