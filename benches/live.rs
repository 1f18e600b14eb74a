//! How long a page waits: for walls and the whole print after an upload and after changed settings, and for the next
//! slicing to begin. Two threads, medians and 95th percentiles of 20; where the system tells it, also the median time of the
//! processor, of both threads together, which a busy machine hardly changes.
//!
//! `cargo bench -p pathwright-benches --bench live -- [MODEL]`; without one, the Benchy beside the project, or else a bundled
//! model.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use pathwright::job::{Project, ProjectModel};
use pathwright::live::{Event, Options, Session, Spawn, Subscription};

const RUNS: usize = 20;
const LIMIT: Duration = Duration::from_secs(120);

fn clock() -> Duration {
    static BEGUN: OnceLock<Instant> = OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}

/// The time, and the processor's time of this program; 0 where that is unknown.
type Moment = [Duration; 2];
type Took = [Duration; 2];

fn now() -> Moment {
    // Fields 14 and 15 after the name in brackets, in hundredths of a second.
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit_once(')').map_or("", |(_, fields)| fields).split_whitespace();
    let ticks: u64 = fields.skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
    [clock(), Duration::from_millis(10 * ticks)]
}

fn model() -> PathBuf {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let given = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let benchy = root.join("../shared/models/open/3DBenchy.stl");
    let bundled = root.join("models/helical_gear.stl");
    given.map_or_else(|| if benchy.exists() { benchy } else { bundled }, PathBuf::from)
}

fn pool() -> Spawn {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    let pool = Arc::new(pool);
    Arc::new(move |work| pool.spawn(work))
}

struct Watched {
    session: Session,
    events: Receiver<(Moment, Event)>,
    _subscription: Subscription,
}

fn watched(spawn: &Spawn) -> Watched {
    let session = Session::new(Options {
        spawn: spawn.clone(),
        clock,
        library: None,
        models_bytes: 1 << 30,
        kept_bytes: 1 << 30,
    });
    let (sender, events) = channel();
    let subscription = session.subscribe(move |event| sender.send((now(), event.clone())).is_ok());
    Watched { session, events, _subscription: subscription }
}

impl Watched {
    /// How long it took from then to an event of a revision.
    fn until(&self, then: Moment, revision: u64, name: &str) -> Took {
        loop {
            let (at, event) = self.events.recv_timeout(LIMIT).expect("an event");
            assert!(event.name() != "failed", "{event:?}");
            if event.revision() == revision && event.name() == name {
                return [0, 1].map(|i| at[i].saturating_sub(then[i]));
            }
        }
    }

    fn both(&self, then: Moment, revision: u64) -> [Took; 2] {
        [self.until(then, revision, "walls"), self.until(then, revision, "done")]
    }
}

fn project(file: &str, profiles: &[&str], settings: &[(&str, String)]) -> Project {
    Project {
        profiles: profiles.iter().map(|name| (*name).to_owned()).collect(),
        settings: settings.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect(),
        models: vec![ProjectModel { file: file.to_owned(), ..ProjectModel::default() }],
        ..Project::default()
    }
}

fn report(what: &str, times: Vec<Took>) {
    let sorted = |which: usize| {
        let mut times: Vec<f64> = times.iter().map(|took| took[which].as_secs_f64() * 1e3).collect();
        times.sort_by(f64::total_cmp);
        times
    };
    let (real, used) = (sorted(0), sorted(1));
    let (median, high) = (real[real.len() / 2], real[(real.len() * 95).div_ceil(100) - 1]);
    let used = used[used.len() / 2];
    println!("{what:<40} median {median:8.1} ms   95 % {high:8.1} ms   processor {used:7.0} ms");
}

fn report_both(what: &str, times: Vec<[Took; 2]>) {
    report(&format!("{what}: walls"), times.iter().map(|both| both[0]).collect());
    report(&format!("{what}: print"), times.iter().map(|both| both[1]).collect());
}

fn main() {
    let path = model();
    let (name, contents) = ("model.stl", std::fs::read(&path).expect("a model"));
    let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    let name = Path::new(name).with_extension(ending).display().to_string();
    println!("{}: {} bytes, {RUNS} runs, 2 threads", path.display(), contents.len());
    let spawn = pool();
    for profiles in [&[][..], &["standard-job"]] {
        println!("profile {}", profiles.first().unwrap_or(&"default"));
        let upload = |_| {
            let watched = watched(&spawn);
            let then = now();
            let file = watched.session.add_model(&name, contents.clone()).expect("a model").file;
            let revision = watched.session.set_project(project(&file, profiles, &[]));
            watched.both(then, revision)
        };
        report_both("upload", (0..RUNS).map(upload).collect());

        let watched = watched(&spawn);
        let file = watched.session.add_model(&name, contents.clone()).expect("a model").file;
        let mut changes: Vec<(&str, Vec<String>)> = Vec::new();
        changes.push(("infill.density", (0..RUNS).map(|i| format!("{}%", 10 + i)).collect()));
        changes.push(("walls.count", (0..RUNS).map(|i| (2 + i % 3).to_string()).collect()));
        changes.push(("speed.perimeter", (0..RUNS).map(|i| (30 + i).to_string()).collect()));
        changes
            .push(("layer.height", (0..RUNS).map(|i| format!("{:.3}", 0.18 + 0.002 * i as f64)).collect()));
        for (key, values) in changes {
            let change = |value: &String| {
                let then = now();
                let revision = watched.session.set_project(project(&file, profiles, &[(key, value.clone())]));
                watched.both(then, revision)
            };
            report_both(key, values.iter().map(change).collect());
        }

        // Overtaken at moments spread over a slicing.
        let revision = watched.session.set_project(project(&file, profiles, &[]));
        let whole = watched.until(now(), revision, "done");
        let overtake = |run: usize| {
            let height = |more: usize| ("layer.height", format!("{:.3}", 0.2 + 0.001 * more as f64));
            watched.session.set_project(project(&file, profiles, &[height(2 * run)]));
            std::thread::sleep(whole[0] * run as u32 / RUNS as u32);
            let then = now();
            let revision = watched.session.set_project(project(&file, profiles, &[height(2 * run + 1)]));
            let begun = watched.until(then, revision, "resolved");
            watched.until(then, revision, "done");
            begun
        };
        report("overtaken: the next one begins after", (0..RUNS).map(overtake).collect());
        let results = watched.session.results(watched.session.latest()).expect("results");
        let length = |bytes: &Option<Arc<[u8]>>| bytes.as_ref().map_or(0, |bytes| bytes.len());
        let (walls, preview, gcode) = (
            length(&results.walls),
            length(&results.preview),
            results.gcode().map_or(0, |gcode| gcode.len()),
        );
        println!("bytes: walls {walls}, preview {preview}, G-code {gcode}");
    }
}
