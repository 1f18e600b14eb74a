//! Many clients at once, and a machine that fails meanwhile: no job is lost, none is done twice, none is wrong.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, RwLock};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::http::{Answer, Request};
use crate::server::{Server, model_path, peak_bytes, sliced};

/// How much is tried.
#[derive(Clone, Copy, Debug)]
struct Load {
    clients: usize,
    jobs: usize,
    kills: usize,
    between: Duration,
}

/// What came of it.
#[derive(Debug, Default)]
struct Seen {
    /// Jobs by their results, with how often each was begun.
    runs: BTreeMap<String, u64>,
    /// How long `/healthz` took, in the order of time.
    health: Vec<Duration>,
    peak_bytes: u64,
    seconds: f64,
}

const MODELS: [&str; 3] = ["calibration_cube.stl", "thin_wall_comb.stl", "tilted_bracket.stl"];

/// Every second job is the same for all clients.
fn job(client: usize, job: usize) -> (&'static str, Value) {
    let whose = if job.is_multiple_of(2) { 0 } else { client + 1 };
    let height = 0.24 + 0.001 * job as f64 + 0.00003 * whose as f64;
    (MODELS[job % MODELS.len()], json!({ "layer.height": format!("{height:.5}") }))
}

/// Sends a request until there is an answer: the server may be dead.
fn answered(server: &RwLock<Server>, request: &Request) -> Answer {
    let begun = Instant::now();
    loop {
        let address = server.read().unwrap().address;
        match request.send(address) {
            Ok(answer) if answer.status < 500 && answer.status != 429 => return answer,
            other => assert!(begun.elapsed() < Duration::from_secs(900), "{other:?}"),
        }
        std::thread::sleep(Duration::from_millis(100));
    }
}

fn try_load(load: Load) -> Seen {
    let token = |client: usize| format!("client-{client}-0123456789");
    let tokens: String = (0..load.clients).map(|client| format!("c{client} {}\n", token(client))).collect();
    let server = RwLock::new(Server::with_tokens(&tokens, &token(0)));
    let (seen, is_over, left) =
        (Mutex::new(Seen::default()), AtomicBool::new(false), AtomicUsize::new(load.clients));
    type Made = BTreeMap<String, (&'static str, Value, Vec<u8>)>;
    let made: Mutex<Made> = Mutex::default();
    let begun = Instant::now();
    let client = |client: usize| {
        let bearer = format!("Bearer {}", token(client));
        let request = |method: &str, path: &str| Request::new(method, path).header("authorization", &bearer);
        let send = |number: usize| {
            let (model, settings) = job(client, number);
            let (contents, project) =
                (std::fs::read(model_path(model)).unwrap(), json!({ "settings": settings }).to_string());
            let parts = [("project", None, project.as_bytes()), ("model", Some(model), contents.as_slice())];
            // Whether a job was accepted by a server that died before it could say so, its key tells.
            let request =
                request("POST", "/v1/jobs").header("Idempotency-Key", &format!("job-{number}")).form(&parts);
            let answer = answered(&server, &request);
            assert_eq!(answer.status, 202, "{}", answer.text());
            answer.json()["id"].as_str().unwrap().to_owned()
        };
        let ids: Vec<String> = (0..load.jobs).map(send).collect();
        for (number, id) in ids.iter().enumerate() {
            let done = loop {
                let answer = answered(&server, &request("GET", &format!("/v1/jobs/{id}")));
                assert_eq!(answer.status, 200, "a job is lost: {}", answer.text());
                let view = answer.json();
                match view["state"].as_str() {
                    Some("waiting" | "running") => std::thread::sleep(Duration::from_millis(200)),
                    _ => break view,
                }
            };
            assert_eq!(done["state"], "done", "{done}");
            let gcode = answered(&server, &request("GET", &format!("/v1/jobs/{id}/gcode"))).body;
            let (model, settings) = job(client, number);
            let mut made = made.lock().unwrap();
            let first =
                made.entry(format!("{model} {settings}")).or_insert_with(|| (model, settings, gcode.clone()));
            assert!(first.2 == gcode, "job {number} of client {client}: others got other bytes");
            drop(made);
            let (key, runs) = (done["key"].as_str().unwrap().to_owned(), done["runs"].as_u64().unwrap());
            seen.lock().unwrap().runs.insert(key, runs);
        }
        if left.fetch_sub(1, Ordering::SeqCst) == 1 {
            is_over.store(true, Ordering::SeqCst);
        }
    };
    let kill = || {
        for _ in 0..load.kills {
            std::thread::sleep(load.between);
            let mut server = server.write().unwrap();
            let peak = peak_bytes(&server);
            server.kill_and_restart();
            let mut seen = seen.lock().unwrap();
            seen.peak_bytes = seen.peak_bytes.max(peak);
        }
    };
    let ask = || {
        while !is_over.load(Ordering::SeqCst) {
            let server = server.read().unwrap();
            let begun = Instant::now();
            assert_eq!(Request::get("/healthz").send(server.address).unwrap().status, 200);
            seen.lock().unwrap().health.push(begun.elapsed());
            drop(server);
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    std::thread::scope(|scope| {
        (0..load.clients).for_each(|number| drop(scope.spawn(move || client(number))));
        scope.spawn(kill);
        scope.spawn(ask);
    });
    let mut seen = seen.into_inner().unwrap();
    seen.peak_bytes = seen.peak_bytes.max(peak_bytes(&server.read().unwrap()));
    seen.seconds = begun.elapsed().as_secs_f64();
    // Only now: it takes as much time as the server had.
    for (what, (model, settings, gcode)) in made.into_inner().unwrap() {
        assert!(gcode == sliced(model, &settings), "{what}: other bytes than from the command line");
    }
    seen
}

/// Results that there are; each was begun once, but where the server died meanwhile.
fn check_runs(seen: &Seen, load: Load) {
    let keys = load.jobs.div_ceil(2) + load.jobs / 2 * load.clients;
    assert_eq!(seen.runs.len(), keys);
    let more: u64 = seen.runs.values().map(|runs| runs - 1).sum();
    assert!(more <= load.kills as u64, "{more} runs more than results");
}

#[test]
fn every_accepted_job_ends_with_the_right_bytes_whatever_happens_to_the_server() {
    let load = Load { clients: 4, jobs: 10, kills: 2, between: Duration::from_secs(3) };
    check_runs(&try_load(load), load);
}

/// The whole: `cargo test --profile quick --test service -- --ignored --nocapture sixteen`.
#[test]
#[ignore = "takes minutes"]
fn sixteen_clients_with_fifty_jobs_each_while_the_server_dies_twenty_times() {
    let load = Load { clients: 16, jobs: 50, kills: 20, between: Duration::from_secs(8) };
    let mut seen = try_load(load);
    check_runs(&seen, load);
    seen.health.sort_unstable();
    let part = |share: usize| seen.health[(seen.health.len() * share / 100).min(seen.health.len() - 1)];
    println!(
        "{} jobs, {} results in {:.0} s; /healthz {} times: median {:?}, 99th percentile {:?}, longest {:?}; \
         most memory {} MiB; runs more than results {}",
        load.clients * load.jobs,
        seen.runs.len(),
        seen.seconds,
        seen.health.len(),
        part(50),
        part(99),
        part(100),
        seen.peak_bytes >> 20,
        seen.runs.values().map(|runs| runs - 1).sum::<u64>(),
    );
    assert!(part(99) < Duration::from_millis(100));
    assert!(seen.peak_bytes < 1 << 30);
}
