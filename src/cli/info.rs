//! `pathwright info`.

use super::args::InfoArgs;
use super::console;
use super::exit::{Exit, Failure};
use super::plan::{self, Sources};
use crate::job::{Engine, Job};
use crate::parallel;

/// Reports the contents of every readable model, and of those of projects. The exit code is that of the first one that cannot.
pub(super) fn run(args: &InfoArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    parallel::take_part(0);
    let sources = Sources::new(&args.settings, Vec::new())?;
    let mut exit = Exit::Done;
    for plate in plan::plates(&args.models, &sources)? {
        let mut seen: Vec<Job> = Vec::new();
        for model in &plate.job.models {
            let job = Job { models: vec![model.clone()], ..plate.job.clone() };
            if seen.contains(&job) {
                continue;
            }
            match engine.info(&job, &plate.settings.settings) {
                Ok(info) if args.json => console::print_json(&info)?,
                Ok(info) => console::print(&info.to_string())?,
                Err(error) => {
                    let failure = Failure::from(error);
                    console::fail(&failure);
                    exit = if exit == Exit::Done { failure.exit } else { exit };
                }
            }
            seen.push(job);
        }
    }
    Ok(exit)
}
