//! Instructions of a slicing at the standard job on one thread, as Valgrind counts them.

use std::path::Path;
use std::process::Command;

use pathwright::Observer;
use pathwright::job::{Engine, Job};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile;

/// The word that asks a benchmark to slice a model instead.
const SLICE: &str = "--slice";

/// Slices a model if the arguments ask for it.
pub fn slice_if_asked() -> bool {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let asked = arguments.first().is_some_and(|word| word == SLICE);
    if let (true, [_, model, output, ..]) = (asked, arguments.as_slice()) {
        slice(Path::new(model), Path::new(output));
    }
    asked
}

fn slice(model: &Path, output: &Path) {
    let settings = profile::resolve(&["standard-job".into()], &[]).expect("an embedded profile").settings;
    let job = Job { models: vec![model.into()], ..Job::default() };
    let mut output = Output::create(output).expect("a file");
    Pipeline.slice(&job, &settings, &mut output, &Observer::none()).expect("a print");
    output.commit().expect("written");
}

/// Millions of instructions of slicing a model; `None` without Valgrind.
pub fn count(model: &Path, folder: &Path) -> Option<f64> {
    let counts = folder.join("counts");
    let status = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--callgrind-out-file={}", counts.display()))
        .arg(std::env::current_exe().expect("this program"))
        .args([SLICE.as_ref(), model.as_os_str(), folder.join("part.gcode").as_os_str()])
        .status();
    if !status.ok()?.success() {
        return None;
    }
    let text = std::fs::read_to_string(counts).ok()?;
    let total =
        text.lines().find_map(|line| line.strip_prefix("summary:").or(line.strip_prefix("totals:")))?;
    total.trim().parse::<f64>().ok().map(|total| total / 1e6)
}
