//! Where `slice` writes, with an engine that needs no model: only a complete result is ever seen.

use std::cell::RefCell;
use std::ffi::OsString;
use std::fs;
use std::path::Path;

use pathwright::Observer;
use pathwright::cli::{self, Exit};
use pathwright::job::{CheckError, Engine, FitError, InputError, Job, JobError, ReorderJob};
use pathwright::motion::PauseAt;
use pathwright::order::compare::StrategyRow;
use pathwright::output::Output;
use pathwright::profile::{OrderStrategy, Settings};
use pathwright::report::{ModelInfo, PaperRow, Reordered, Summary};

thread_local! {
    /// What the engine was asked to do.
    static SEEN: RefCell<Vec<(Job, Settings)>> = const { RefCell::new(Vec::new()) };
}

/// Writes the models' names; fails at one that is called `bad`.
struct Fake;

impl Engine for Fake {
    fn slice(
        &self,
        job: &Job,
        settings: &Settings,
        output: &mut Output,
        progress: &Observer<'_>,
    ) -> Result<Summary, JobError> {
        SEEN.with_borrow_mut(|seen| seen.push((job.clone(), settings.clone())));
        progress.begin(job.models.len());
        output.write(b";TIME:????\n")?;
        for model in &job.models {
            let name = model.path().file_stem().unwrap().to_string_lossy().into_owned();
            match name.as_str() {
                "bad" => return Err(JobError::Input(InputError::NoMoves)),
                "large" => return Err(JobError::DoesNotFit(FitError::Raft { top_mm: 300.0, bed_mm: 250.0 })),
                "wrong" => {
                    let (file, difference) = (name, "a path is lost".to_owned());
                    return Err(CheckError::Differs { file, difference }.into());
                }
                name => output.write(format!(";{name}\n").as_bytes())?,
            }
            progress.layer_done();
        }
        output.patch(6, b"0042")?;
        Ok(Summary::default())
    }

    fn compare(
        &self,
        _: &Job,
        _: &Settings,
        _: &[OrderStrategy],
        _: &Observer<'_>,
    ) -> Result<Vec<StrategyRow>, JobError> {
        Ok(Vec::new())
    }

    fn paper(&self, _: &Job, _: &Settings, _: &Observer<'_>) -> Result<Vec<PaperRow>, JobError> {
        Ok(Vec::new())
    }

    fn reorder(
        &self,
        _: &ReorderJob,
        _: &Settings,
        _: &mut Output,
        _: &Observer<'_>,
    ) -> Result<Reordered, JobError> {
        Ok(Reordered::default())
    }

    fn info(&self, job: &Job, _: &Settings) -> Result<ModelInfo, JobError> {
        let file = job.models[0].path().display().to_string();
        let (mesh, text) = (serde_json::Value::Null, String::new());
        Ok(ModelInfo { file, mesh, text, objects: 1, bodies: 1, fits: true, advice: None })
    }
}

/// Runs `slice --quiet` with these arguments; names of files are taken in the folder.
fn slice(folder: &Path, args: &[&str]) -> Exit {
    let in_folder =
        |arg: &&str| match arg.ends_with(".stl") || arg.ends_with(".gcode") || arg.ends_with("out") {
            true => folder.join(arg).into_os_string(),
            false => OsString::from(arg),
        };
    let start = ["pathwright", "slice", "--quiet"].map(OsString::from);
    cli::run(start.into_iter().chain(args.iter().map(in_folder)), &Fake)
}

fn files(folder: &Path) -> Vec<String> {
    let entries =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

fn seen() -> Vec<(Job, Settings)> {
    SEEN.with_borrow(Clone::clone)
}

#[test]
fn g_code_goes_beside_the_first_model() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(slice(folder.path(), &["a.stl", "b.stl"]), Exit::Done);
    assert_eq!(files(folder.path()), ["a.gcode"]);
    assert_eq!(fs::read_to_string(folder.path().join("a.gcode")).unwrap(), ";TIME:0042\n;a\n;b\n");
}

#[test]
fn each_model_gets_its_own_file_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    assert_eq!(slice(folder.path(), &["a.stl", "b.stl", "--each", "-o", "out"]), Exit::Done);
    assert_eq!(files(&folder.path().join("out")), ["a.gcode", "b.gcode"]);
}

#[test]
fn a_failure_leaves_no_file_and_the_old_one_untouched() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("old.gcode"), "old").unwrap();
    for (model, exit) in
        [("bad.stl", Exit::Input), ("large.stl", Exit::DoesNotFit), ("wrong.stl", Exit::Check)]
    {
        assert_eq!(slice(folder.path(), &[model, "-o", "old.gcode"]), exit);
        assert_eq!(slice(folder.path(), &[model]), exit);
    }
    assert_eq!(files(folder.path()), ["old.gcode"]);
    assert_eq!(fs::read_to_string(folder.path().join("old.gcode")).unwrap(), "old");
}

#[test]
fn with_each_the_good_models_are_sliced_and_the_first_failure_shows() {
    let folder = tempfile::tempdir().unwrap();
    let exit = slice(folder.path(), &["a.stl", "large.stl", "bad.stl", "b.stl", "--each"]);
    assert_eq!(exit, Exit::DoesNotFit);
    assert_eq!(files(folder.path()), ["a.gcode", "b.gcode"]);
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_directly() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(slice(folder.path(), &["a.stl", "-o", "/dev/null"]), Exit::Done);
    assert_eq!(slice(folder.path(), &["a.stl", "-o", "/dev/full"]), Exit::Output);
}

#[cfg(unix)]
#[test]
fn a_pipe_gets_the_bytes_that_a_file_gets() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.gcode");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    assert_eq!(slice(folder.path(), &["a.stl", "-o", "pipe.gcode"]), Exit::Done);
    assert_eq!(reader.join().unwrap(), ";TIME:0042\n;a\n");
    assert_eq!(files(folder.path()), ["pipe.gcode"]);
}

#[test]
fn options_reach_the_job() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        "a.stl",
        "--scale",
        "2",
        "--rotate",
        "-90,0,45",
        "--translate",
        "1,2,3",
        "--scale-to-fit",
        "--copies",
        "4",
        "--pause-at",
        "3",
        "--pause-at",
        "1.5mm",
        "--certify",
        "--threads",
        "2",
    ];
    assert_eq!(slice(folder.path(), &options), Exit::Done);
    let (job, _) = seen().remove(0);
    let transform = job.models[0].transform;
    assert_eq!((transform.scale, transform.rotate_deg), ([2.0; 3], [-90.0, 0.0, 45.0]));
    assert_eq!((job.translate_mm, job.scale_to_fit), ([1.0, 2.0, 3.0], true));
    assert_eq!((job.models[0].copies, job.certify, job.threads), (4, true, Some(2)));
    assert_eq!(job.pauses, [PauseAt::Layer(2), PauseAt::Height(1.5)]);
}

#[test]
fn ordering_options_win_over_set() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        "a.stl",
        "--order",
        "nearest",
        "--set",
        "order.strategy=greedy",
        "--scope",
        "island",
        "--seam",
        "rear",
    ];
    assert_eq!(slice(folder.path(), &options), Exit::Done);
    let (_, settings) = seen().remove(0);
    assert_eq!((settings.order.strategy.name(), settings.order.scope.name()), ("nearest", "island"));
    assert_eq!(settings.seam.position.name(), "rear");
}
