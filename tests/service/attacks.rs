//! What is tried against servers, and what comes of it.

use std::io::{Read, Write};
use std::time::{Duration, Instant};

use serde_json::json;

use crate::http::{self, Request, connect};
use crate::server::{Server, model_path, peak_bytes};

const CUBE: &str = "calibration_cube.stl";

fn cube() -> Vec<u8> {
    std::fs::read(model_path(CUBE)).unwrap()
}

fn lives(server: &Server) {
    assert_eq!(server.get("/healthz").status, 200);
}

/// A job of a project with the cube; the answer to it, or how the job ended.
fn outcome(server: &Server, project: &serde_json::Value) -> String {
    let (project, cube) = (project.to_string(), cube());
    let parts = [("project", None, project.as_bytes()), ("model", Some(CUBE), cube.as_slice())];
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&parts));
    match answer.status {
        202 => server.ended(answer.json()["id"].as_str().unwrap()).to_string(),
        _ => format!("{}: {}", answer.status, answer.message()),
    }
}

#[test]
fn a_foreign_host_is_refused() {
    let server = Server::new();
    let answer = server.send(Request::get("/v1/jobs").header("host", "evil.example:80"));
    assert!(answer.status == 403 && answer.message().contains("--host"), "{}", answer.text());
}

#[test]
fn a_foreign_page_is_refused_and_gets_no_leave_to_read() {
    let server = Server::new();
    for (name, value) in
        [("origin", "https://evil.example"), ("origin", "null"), ("sec-fetch-site", "cross-site")]
    {
        let answer = server.send(Request::get("/v1/jobs").header(name, value));
        assert_eq!(answer.status, 403, "{name}: {value}");
        assert_eq!(answer.header("access-control-allow-origin"), None);
    }
    let asked = Request::new("OPTIONS", "/v1/jobs").header("origin", "https://evil.example");
    assert_eq!(server.send(asked.header("access-control-request-method", "POST")).status, 403);
}

#[test]
fn without_a_token_nothing_is_told() {
    let token = "0123456789abcdef";
    let server = Server::with_tokens(token, token);
    for path in ["/v1/jobs", "/v1/schema", "/v1/printers", "/metrics", "/v1/opened", "/v1/jobs/x/gcode"] {
        for header in ["", "Bearer", "Bearer 0123456789abcdeg", "Basic 0123456789abcdef"] {
            let answer = Request::get(path).header("authorization", header).send(server.address).unwrap();
            assert_eq!(answer.status, 401, "{path}: {header}");
        }
        let in_address = Request::get(&format!("{path}?token={token}")).send(server.address).unwrap();
        assert_eq!(in_address.status, 401);
    }
    let login =
        Request::new("POST", "/v1/login").body("application/json", json!({ "token": token }).to_string());
    let cookie = login.send(server.address).unwrap().header("set-cookie").unwrap().to_owned();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    let cookie = cookie.split(';').next().unwrap();
    assert_eq!(Request::get("/v1/jobs").header("cookie", cookie).send(server.address).unwrap().status, 200);
}

#[test]
fn no_path_of_a_client_reaches_the_disk() {
    let server = Server::new();
    for path in [
        "/assets/../../etc/passwd",
        "/assets/..%2f..%2fetc%2fpasswd",
        "/v1/jobs/..%2f..%2fetc%2fpasswd/gcode",
    ] {
        assert_eq!(server.get(path).status, 404, "{path}");
    }
    let secret = server.data().parent().unwrap().join("secret.toml");
    std::fs::write(&secret, "[infill]\ndensity = 0.77\n").unwrap();
    let secret = secret.to_str().unwrap();
    for project in [
        json!({ "profiles": [secret] }),
        json!({ "profiles": ["../../etc/passwd"] }),
        json!({ "profile": format!("inherits = \"{secret}\"") }),
        json!({ "presets": { "printer": secret } }),
        json!({ "models": [{ "file": "/etc/passwd" }] }),
    ] {
        let said = outcome(&server, &project);
        assert!(said.starts_with("422") && !said.contains("0.77"), "{project}: {said}");
    }
    let cube = cube();
    let parts = [("model", Some("../../../escaped.stl"), cube.as_slice())];
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&parts));
    let job = server.ended(answer.json()["id"].as_str().unwrap());
    assert_eq!((job["state"].as_str(), job["name"].as_str()), (Some("done"), Some("escaped.gcode")), "{job}");
}

#[test]
fn archives_are_unpacked_within_limits() {
    let server = Server::with(&["--max-upload", "64"]);
    let bomb = bomb();
    assert!(bomb.len() < 4 << 20);
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&[("model", Some("bomb.3mf"), &bomb)]));
    assert_eq!(answer.status, 202, "{}", answer.text());
    let job = server.ended(answer.json()["id"].as_str().unwrap());
    assert_eq!(job["state"], "failed", "{job}");
    lives(&server);
    assert!(peak_bytes(&server) < 1 << 30, "{} MiB", peak_bytes(&server) >> 20);
}

/// A 3MF file of two gigabytes of spaces.
fn bomb() -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let relations = r#"<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;
    zip.start_file("_rels/.rels", options).unwrap();
    zip.write_all(relations.as_bytes()).unwrap();
    zip.start_file("3D/3dmodel.model", options).unwrap();
    zip.write_all(br#"<?xml version="1.0"?><model "#).unwrap();
    let spaces = vec![b' '; 1 << 20];
    for _ in 0..2048 {
        zip.write_all(&spaces).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn uploads_beyond_the_limit_are_cut_off_and_leave_nothing() {
    let server = Server::with(&["--max-upload", "1"]);
    let head =
        "POST /v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: multipart/form-data; boundary=x\r\n";
    let mut stream = connect(server.address).unwrap();
    stream.write_all(format!("{head}content-length: 10737418240\r\n\r\n").as_bytes()).unwrap();
    let answer = http::read(&mut stream).unwrap();
    assert!(answer.status == 413 && answer.message().contains("--max-upload"), "{}", answer.text());

    let mut stream = connect(server.address).unwrap();
    stream.write_all(format!("{head}transfer-encoding: chunked\r\n\r\n").as_bytes()).unwrap();
    let part = b"--x\r\ncontent-disposition: form-data; name=\"model\"; filename=\"a.stl\"\r\n\r\n";
    stream.write_all(format!("{:x}\r\n", part.len()).as_bytes()).unwrap();
    stream.write_all(part).unwrap();
    let chunk = vec![b'x'; 1 << 16];
    let sent = (0..10_000).take_while(|_| {
        let whole = stream.write_all(b"\r\n10000\r\n").and_then(|()| stream.write_all(&chunk));
        whole.is_ok()
    });
    let sent = sent.count();
    assert!(sent < 1000, "{sent} chunks were taken");
    let left = || std::fs::read_dir(server.data().join("tmp")).unwrap().count();
    let begun = Instant::now();
    while left() > 0 && begun.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(left(), 0);
    lives(&server);
}

#[test]
fn slow_clients_are_cut_off() {
    let server = Server::with(&["--max-head-time", "1", "--max-body-time", "1"]);
    let mut head = connect(server.address).unwrap();
    head.write_all(b"GET /healthz HTTP/1.1\r\nhost: loc").unwrap();
    let mut body = connect(server.address).unwrap();
    body.write_all(
        b"POST /v1/login HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99\r\n\r\n{",
    )
    .unwrap();
    let answer = http::read(&mut body).unwrap();
    assert!(answer.status == 408 && answer.message().contains("--max-body-time"), "{}", answer.text());
    let mut rest = Vec::new();
    let begun = Instant::now();
    // Closed, in whatever way.
    let _ = head.read_to_end(&mut rest);
    assert!(begun.elapsed() < Duration::from_secs(10));
    lives(&server);
}

#[test]
fn malformed_forms_are_refused() {
    let server = Server::new();
    let kind = "multipart/form-data; boundary=x";
    for (kind, body, status) in [
        (kind, "", 400),
        (kind, "no boundary at all", 400),
        (kind, "--x\r\n\r\n", 400),
        (kind, "--x\r\ncontent-disposition: form-data; name=\"model\"; filename=\"a\"\r\n\r\nabc", 400),
        (kind, "--x\r\ncontent-disposition: form-data; name=\"nobody\"\r\n\r\nabc\r\n--x--\r\n", 400),
        (kind, "--x\r\ncontent-disposition: form-data; name=\"project\"\r\n\r\n{\r\n--x--\r\n", 400),
        (kind, "--x--\r\n", 400),
        ("multipart/form-data", "--x--\r\n", 400),
        ("application/json", "{}", 415),
    ] {
        let answer = server.send(Request::new("POST", "/v1/jobs").body(kind, body));
        assert_eq!(answer.status, status, "{body:?}: {}", answer.text());
        assert!(!answer.message().is_empty());
    }
    assert_eq!(std::fs::read_dir(server.data().join("tmp")).unwrap().count(), 0);
}

#[test]
fn oversized_heads_are_refused() {
    let server = Server::new();
    let large = Request::get("/healthz").header("x", &"y".repeat(1_000_000)).send(server.address);
    assert!(large.is_err() || large.unwrap().status == 431);
    let mut many = Request::get("/healthz");
    for index in 0..500 {
        many = many.header(&format!("x-{index}"), "y");
    }
    let many = many.send(server.address);
    assert!(many.is_err() || many.unwrap().status == 431);
    lives(&server);
}

#[test]
fn a_thousand_event_streams_leave_room_for_others() {
    let server =
        Server::with(&["--max-streams", "50", "--max-streams-per-client", "40", "--jobs-at-once", "1"]);
    let slow = json!({ "layer.height": "0.05", "order.effort": "high" });
    let id = server.accepted("helical_gear.stl", &slow);
    let mut open = Vec::new();
    for _ in 0..1000 {
        let Ok(mut stream) = connect(server.address) else { continue };
        let text = format!("GET /v1/jobs/{id}/events HTTP/1.1\r\nhost: localhost\r\n\r\n");
        if stream.write_all(text.as_bytes()).is_ok() {
            open.push(stream);
        }
    }
    let begun = Instant::now();
    let refused = Request::get(&format!("/v1/jobs/{id}/events")).send(server.address);
    assert!(begun.elapsed() < Duration::from_secs(2));
    // Either its own limit, or that of connections while the refused ones are closed, which may close this one, too.
    let status = refused.map_or(503, |answer| answer.status);
    assert!(matches!(status, 429 | 503 | 200), "{status}");
    drop(open);
    let begun = Instant::now();
    while Request::get("/healthz").send(server.address).map_or(503, |answer| answer.status) != 200 {
        assert!(begun.elapsed() < Duration::from_secs(5));
    }
    assert_eq!(server.send(Request::new("DELETE", &format!("/v1/jobs/{id}"))).status, 204);
}

#[test]
fn deep_nesting_overflows_nothing() {
    let server = Server::new();
    let deep = |open: &str, close: &str| open.repeat(100_000) + &close.repeat(100_000);
    let text = format!("{{\"settings\":{}}}", deep("[", "]"));
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&[("project", None, text.as_bytes())]));
    assert_eq!(answer.status, 400);
    lives(&server);
    for project in [
        json!({ "profile": format!("a = {}", deep("[", "]")) }),
        json!({ "profile": format!("a{} = 1", ".a".repeat(100_000)) }),
        json!({ "settings": { "layer.height": deep("[", "]") } }),
        json!({ "settings": { "gcode.start": format!("{{{}}}", deep("(", "1)")) } }),
        json!({ "settings": { "gcode.start": format!("{{{}1}}", "-".repeat(100_000)) } }),
        json!({ "settings": { "gcode.start": format!("{{{}1}}", "!".repeat(100_000)) } }),
        json!({ "settings": { "gcode.start": format!("{}{}", "{if 1}".repeat(100_000), "{endif}".repeat(100_000)) } }),
        json!({ "settings": { "gcode.start": format!("{{{}1{}}}", "1 ? ".repeat(50_000), ": 1".repeat(50_000)) } }),
        json!({ "settings": { "gcode.start": format!("{{1{}}}", " + 1".repeat(100_000)) } }),
    ] {
        let said = outcome(&server, &project);
        assert!(!said.contains("mistake of this program"), "{said:.300}");
        lives(&server);
    }
}

#[test]
fn models_that_claim_more_than_they_have_are_refused() {
    let server = Server::with(&["--max-facets", "1000"]);
    let mut claims = vec![0; 84];
    claims[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let answer =
        server.send(Request::new("POST", "/v1/jobs").form(&[("model", Some("claims.stl"), &claims)]));
    assert_eq!(server.ended(answer.json()["id"].as_str().unwrap())["state"], "failed");
    let gear = std::fs::read(model_path("helical_gear.stl")).unwrap();
    let answer = server.send(Request::new("POST", "/v1/jobs").form(&[("model", Some("gear.stl"), &gear)]));
    assert!(answer.status == 413 && answer.message().contains("--max-facets"), "{}", answer.text());
}

#[test]
fn a_job_that_takes_too_long_is_ended() {
    let server = Server::with(&["--max-job-time", "1"]);
    let slow = json!({ "layer.height": "0.01", "layer.first_height": "0.01", "infill.density": "100%" });
    let id = server.submit("helical_gear.stl", &slow).json();
    let Some(id) = id["id"].as_str() else { panic!("{id}") };
    let job = server.ended(id);
    assert!(job["error"]["message"].as_str().unwrap().contains("--max-job-time"), "{job}");
    lives(&server);
}

#[test]
fn requests_that_could_be_read_in_two_ways_are_refused() {
    let server = Server::new();
    for head in [
        "POST /v1/login HTTP/1.1\r\nhost: localhost\r\ncontent-length: 4\r\ntransfer-encoding: chunked\r\n\r\n0\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nhost: localhost\r\nhost: evil.example\r\n\r\n",
        "GET /healthz HTTP/1.1\r\n\r\n",
        "GET /healthz HTTP/1.1\r\nhost: localhost\r\ncontent-length: 1\r\ncontent-length: 2\r\n\r\n",
        "\x16\x03\x01 no HTTP at all\r\n\r\n",
    ] {
        let mut stream = connect(server.address).unwrap();
        stream.write_all(head.as_bytes()).unwrap();
        let answer = http::read(&mut stream);
        assert!(
            answer.is_err() || (400..500).contains(&answer.as_ref().unwrap().status),
            "{head}: {answer:?}"
        );
    }
    assert_eq!(server.send(Request::new("TRACE", "/healthz")).status, 405);
}
