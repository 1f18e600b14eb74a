//! Sessions: a plate that is always sliced.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use pathwright::job::{Engine, PresetNames, Project, ProjectModel};
use pathwright::live::{Event, Failure, Options, Session, Spawn, Subscription};
use pathwright::options::{Field, Kind};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile::{keys, resolve};
use pathwright::view::{self, Scene};
use pathwright::{Observer, Settings};
use proptest::prelude::*;

use crate::support::mesh_shapes::{cuboid, stl};

type Told = Arc<Mutex<Vec<Event>>>;

fn options(spawn: Spawn) -> Options {
    Options { spawn, clock: || Duration::ZERO, library: None, models_bytes: 1 << 24, kept_bytes: 1 << 26 }
}

/// What is to be done is done before the question is answered.
fn at_once() -> Spawn {
    Arc::new(|work| work())
}

fn followed(session: &Session) -> (Told, Subscription) {
    let told = Told::default();
    let sender = told.clone();
    let subscription = session.subscribe(move |event| {
        sender.lock().unwrap().push(event.clone());
        true
    });
    (told, subscription)
}

fn names(told: &Told) -> Vec<&'static str> {
    told.lock().unwrap().iter().map(Event::name).collect()
}

/// A slab with a beam that sticks out over its edge.
fn shape() -> Vec<u8> {
    stl(&[cuboid([0.0; 3], [10.0, 10.0, 1.2]), cuboid([3.0, 3.0, 1.2], [14.0, 7.0, 2.4])].concat())
}

fn project(settings: &[(&str, &str)]) -> Project {
    Project {
        settings: settings.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect(),
        models: vec![ProjectModel { file: "shape.stl".into(), ..ProjectModel::default() }],
        allow_floating: true,
        ..Project::default()
    }
}

fn session(spawn: Spawn) -> Session {
    let session = Session::new(options(spawn));
    session.add_model("shape.stl", shape()).unwrap();
    session
}

/// The G-code of a project that nothing was sliced before.
fn fresh(session: &Session, project: &Project) -> Vec<u8> {
    let (job, settings) = (session.job(project).unwrap(), session.settings(project).unwrap().settings);
    let mut output = Output::memory();
    Pipeline.slice(&job, &settings, &mut output, &Observer::none()).unwrap();
    output.into_bytes()
}

#[test]
fn events_come_in_order_and_the_print_is_that_of_a_first_slicing() {
    let session = session(at_once());
    let (told, _subscription) = followed(&session);
    let revision = session.set_project(project(&[]));
    let mut names = names(&told);
    names.dedup();
    assert_eq!(
        names,
        ["resolved", "progress", "placed", "progress", "walls", "progress", "done"],
        "{told:?}"
    );
    let results = session.results(revision).unwrap();
    let gcode = results.gcode().unwrap();
    assert!(gcode[..] == fresh(&session, &project(&[]))[..]);
    let scene = Scene::read(&gcode, &Settings::default());
    let shown = view::Print::new("shape.gcode".into(), scene, &Settings::default());
    assert!(
        results.preview.unwrap()[..] == view::preview(&shown)[..],
        "the preview is not that of the G-code"
    );
    assert_eq!(results.name, "shape.gcode");
}

#[test]
fn the_walls_have_every_layer_and_no_infill() {
    let session = session(at_once());
    let revision = session.set_project(project(&[]));
    let results = session.results(revision).unwrap();
    let walls = results.walls.unwrap();
    let length = u32::from_le_bytes(walls[4..8].try_into().unwrap()) as usize;
    let head: serde_json::Value = serde_json::from_slice(&walls[8..8 + length]).unwrap();
    assert_eq!((&walls[..4], head["layers"].as_u64()), (b"PWP1".as_slice(), Some(12)));
    let printed_mm = head["total"]["print_mm"].as_f64().unwrap();
    assert!(printed_mm > 0.0 && printed_mm < results.summary.unwrap().total.print_mm);
}

#[test]
fn of_a_burst_of_changes_only_the_last_is_sliced() {
    type Work = Box<dyn FnOnce() + Send>;
    let waiting: Arc<Mutex<VecDeque<Work>>> = Arc::default();
    let queue = waiting.clone();
    let session = session(Arc::new(move |work| queue.lock().unwrap().push_back(work)));
    let (told, _subscription) = followed(&session);
    let revisions: Vec<u64> =
        (1..=9).map(|n| session.set_project(project(&[("walls.count", &n.to_string())]))).collect();
    assert_eq!(waiting.lock().unwrap().len(), 1, "one slicing at a time");
    loop {
        let work = waiting.lock().unwrap().pop_front();
        let Some(work) = work else { break };
        work();
    }
    let told = told.lock().unwrap();
    assert!(told.iter().all(|event| Some(&event.revision()) == revisions.last()), "{told:?}");
    assert!(told.last().is_some_and(Event::is_last));
}

#[test]
fn who_comes_late_is_told_what_is_known() {
    let session = session(at_once());
    session.set_project(project(&[]));
    session.set_project(project(&[("infill.density", "30%")]));
    let (told, _subscription) = followed(&session);
    assert_eq!(names(&told), ["resolved", "placed", "walls", "done"]);
    assert!(told.lock().unwrap().iter().all(|event| event.revision() == 2));
    let Some(Event::Done(done)) = told.lock().unwrap().last().cloned() else { panic!("it is done") };
    assert!(done.before.is_some_and(|before| before.filament_g < done.summary.filament_g));
}

#[test]
fn two_prints_are_kept() {
    let session = session(at_once());
    let revisions = ["1", "2", "3"].map(|count| session.set_project(project(&[("walls.count", count)])));
    let kept = revisions.map(|revision| session.results(revision).is_some_and(|r| r.is_complete()));
    assert_eq!(kept, [false, true, true]);
}

#[test]
fn two_projects_can_be_compared() {
    let session = session(at_once());
    let (told, _subscription) = followed(&session);
    let [a, b] = session.compare([project(&[]), project(&[("layer.height", "0.3")])]);
    let done = |revision: u64| session.results(revision).unwrap().summary.unwrap().layer_count;
    assert_eq!((done(a), done(b)), (12, 8));
    assert_eq!(names(&told).iter().filter(|name| **name == "done").count(), 2);
}

#[test]
fn wrong_settings_are_told_and_nothing_is_sliced() {
    let session = session(at_once());
    let (told, _subscription) = followed(&session);
    let mut wrong = project(&[("walls.count", "many"), ("layer.height", "0.3")]);
    wrong.models[0].settings.insert("infill.density".into(), "900%".into());
    session.set_project(wrong.clone());
    wrong.settings.remove("walls.count");
    session.set_project(wrong);
    assert_eq!(names(&told), ["resolved", "resolved"]);
    let told = told.lock().unwrap();
    let problems = |event: &Event| match event {
        Event::Resolved(resolved) => {
            assert_eq!(resolved.settings["layer.height"], "0.3", "what is sound is shown");
            resolved.problems.iter().map(|p| (p.key.clone().unwrap_or_default(), p.model)).collect()
        }
        _ => Vec::new(),
    };
    assert_eq!(problems(&told[0]), [("walls.count".to_owned(), None)]);
    assert_eq!(problems(&told[1]), [("infill.density".to_owned(), Some(0))]);
}

#[test]
fn what_does_not_fit_is_shown_with_the_reason() {
    let session = session(at_once());
    let (told, _subscription) = followed(&session);
    let mut large = project(&[]);
    large.models.push(ProjectModel { scale: [30.0, 30.0, 1.0], ..large.models[0].clone() });
    session.set_project(large.clone());
    large.models[0].at_mm = Some([20.0, 20.0, 0.0]);
    large.models[1] = ProjectModel { at_mm: Some([400.0, 20.0, 0.0]), ..large.models[0].clone() };
    session.set_project(large);
    let placed = |event: &Event| match event {
        Event::Placed(placed) => Some(
            placed.objects.iter().map(|object| (object.model, object.reason.is_some())).collect::<Vec<_>>(),
        ),
        _ => None,
    };
    let told = told.lock().unwrap();
    let placed: Vec<_> = told.iter().filter_map(placed).collect();
    assert_eq!(placed, [[(0, false), (1, true)], [(0, false), (1, true)]], "{told:?}");
    let failed = told.iter().filter_map(|event| match event {
        Event::Failed(failed) => Some(failed.error.kind),
        _ => None,
    });
    assert_eq!(failed.collect::<Vec<_>>(), [pathwright::live::FaultKind::DoesNotFit; 2]);
}

#[test]
fn a_panic_is_a_failure_and_the_session_goes_on() {
    static BROKEN: AtomicBool = AtomicBool::new(true);
    fn clock() -> Duration {
        assert!(!BROKEN.load(Ordering::Relaxed), "this clock is broken");
        Duration::ZERO
    }
    let session = Session::new(Options { clock, ..options(at_once()) });
    session.add_model("shape.stl", shape()).unwrap();
    let (told, _subscription) = followed(&session);
    session.set_project(project(&[]));
    BROKEN.store(false, Ordering::Relaxed);
    session.set_project(project(&[]));
    let names = names(&told);
    assert!(names.contains(&"failed") && names.last() == Some(&"done"), "{names:?}");
}

#[test]
fn models_have_names_and_room_of_their_own() {
    let session = session(at_once());
    assert_eq!(session.add_model("shape.stl", shape()).unwrap().file, "shape (2).stl");
    let full = Session::new(Options { models_bytes: 1000, ..options(at_once()) });
    assert!(matches!(full.add_model("shape.stl", shape()), Err(Failure::Limit(_))));
}

#[test]
fn arranged_positions_give_the_same_print() {
    let session = session(at_once());
    let mut two = project(&[]);
    two.models[0].copies = 2;
    let arranged = session.arrange(&two).unwrap();
    assert_eq!(arranged.models.len(), 2);
    assert!(fresh(&session, &arranged) == fresh(&session, &two));
}

#[test]
fn a_model_on_its_edge_is_turned_upright() {
    let session = session(at_once());
    let mut leaning = project(&[]);
    leaning.models[0].rotate_deg = [90.0, 0.0, 30.0];
    let upright = session.orient(&leaning, 0).unwrap();
    let height_mm = |project: &Project| {
        let job = session.job(project).unwrap();
        let (plate, _) = Pipeline.placed(&job, &Settings::default(), &Observer::none()).unwrap();
        plate.meshes[0].bounds()[1][2]
    };
    assert!(height_mm(&leaning) > 9.0 && height_mm(&upright) < 2.5);
}

/// Another value for a key, near its default, if there is one.
fn another(key: &str, field: &Field, step: u8) -> String {
    let defaults = resolve(&[], &[]).unwrap();
    let default = serde_json::to_value(&defaults.settings).unwrap();
    let (section, name) = key.split_once('.').unwrap();
    let value = &default[section][name];
    let number = |value: &serde_json::Value| {
        let (low, high) = field.range.unwrap_or((0.0, 1e6));
        let value = value.as_f64().unwrap_or(0.0);
        let factor = [0.8, 1.25, 1.1, 0.0][usize::from(step % 4)];
        let moved = if value == 0.0 { 0.1 * high.min(f64::from(step)) } else { value * factor };
        moved.clamp(low, high)
    };
    match field.kind {
        Kind::Number | Kind::Share => format!("{:.4}", number(value)),
        Kind::Count => (value.as_u64().unwrap_or(0) + u64::from(step % 3)).to_string(),
        Kind::Flag => (value != true).to_string(),
        Kind::Choice(words) => words[usize::from(step) % words.len()].to_owned(),
        Kind::Numbers(_) | Kind::List => {
            let numbers: Vec<String> =
                value.as_array().into_iter().flatten().map(|value| format!("{:.4}", number(value))).collect();
            format!("[{}]", numbers.join(", "))
        }
        Kind::Text if key == "gcode.thumbnails" => format!("{0}x{0}/PNG", 16 + step % 4),
        Kind::Text => format!("; {step}"),
    }
}

/// Changes of a project, of which each is sliced after the others, and as if it were the first.
fn changes_are_sliced_as_if_they_were_the_first(changes: impl Iterator<Item = (String, String)>) {
    let session = session(at_once());
    let mut current = project(&[("order.effort", "fast")]);
    for (key, value) in changes {
        let mut next = current.clone();
        next.settings.insert(key.clone(), value.clone());
        let (Ok(resolved), Ok(job)) = (session.settings(&next), session.job(&next)) else { continue };
        let mut output = Output::memory();
        let wanted = Pipeline.slice(&job, &resolved.settings, &mut output, &Observer::none());
        let revision = session.set_project(next.clone());
        let got = session.results(revision).and_then(|results| results.gcode());
        assert_eq!(wanted.is_ok(), got.is_some(), "{key} = {value}: {:?}", wanted.err());
        if let Some(got) = got {
            assert!(got[..] == output.into_bytes()[..], "{key} = {value} after {:?}", current.settings);
            current = next;
        }
    }
}

#[test]
fn no_setting_is_overlooked_when_results_are_used_again() {
    let all = keys().map(|(key, field)| {
        let value = another(&key, field, 1);
        (key, value)
    });
    // Each alone, then back.
    let back = |(key, value): (String, String)| {
        let default = resolve(&[], &[]).unwrap();
        let value_was = pathwright::profile::dump_json(&default)[&key]["value"].clone();
        let was = value_was.as_str().map_or_else(|| value_was.to_string(), str::to_owned);
        [(key.clone(), value), (key, was)]
    };
    changes_are_sliced_as_if_they_were_the_first(all.flat_map(back));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn sequences_of_changes_are_sliced_as_if_each_were_the_first(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12)
    ) {
        let all: Vec<(String, &Field)> = keys().collect();
        let change = |(index, step): (prop::sample::Index, u8)| {
            let (key, field) = &all[index.index(all.len())];
            (key.clone(), another(key, field, step))
        };
        changes_are_sliced_as_if_they_were_the_first(changes.into_iter().map(change));
    }
}

#[test]
fn presets_without_a_library_are_a_problem() {
    let session = session(at_once());
    let (told, _subscription) = followed(&session);
    let presets = PresetNames { printer: Some("Any".into()), ..PresetNames::default() };
    session.set_project(Project { presets, ..project(&[]) });
    assert_eq!(names(&told), ["resolved"]);
}
