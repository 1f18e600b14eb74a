//! `pathwright slice`.

use std::io::Write;
use std::path::PathBuf;

use super::args::SliceArgs;
use super::console::{self, Bar};
use super::exit::{Exit, Failure};
use super::plan::{Destination, Plan, Task, named};
use crate::gcode::is_binary_name;
use crate::job::Engine;
use crate::observer::Observer;
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::profile::{Settings, binary_metadata};
use crate::report::Summary;

/// Slices plate by plate. One that fails does not keep the others from being sliced; the exit code is that of the
/// first one that failed.
pub(super) fn run(args: &SliceArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let mut plan = Plan::new(args)?;
    if !args.quiet {
        console::warn(&plan.settings.warnings);
    }
    if plan.tasks.len() < 2 {
        return slice_all(&plan, args, engine);
    }
    // All share the threads of the first.
    let threads = plan.tasks.iter_mut().map(|task| task.job.threads.take()).reduce(|first, _| first);
    let work = |_: Workers<'_>| slice_all(&plan, args, engine);
    parallel::run(threads.flatten(), &Observer::none(), work).unwrap_or(Ok(Exit::Interrupted))
}

fn slice_all(plan: &Plan, args: &SliceArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let mut exit = Exit::Done;
    let mut written = Vec::new();
    for task in &plan.tasks {
        match slice(task, &plan.settings.settings, args, engine, &mut written) {
            Ok(summary) => report(&summary, task, args)?,
            Err(failure) => {
                console::fail(&failure);
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    Ok(exit)
}

fn slice(
    task: &Task,
    settings: &Settings,
    args: &SliceArgs,
    engine: &dyn Engine,
    written: &mut Vec<PathBuf>,
) -> Result<Summary, Failure> {
    let mut output = match &task.destination {
        Destination::Stdout => Output::stdout(),
        Destination::File(path) if is_binary_name(path) => {
            Output::create_binary(path, binary_metadata(settings))?
        }
        Destination::File(path) => Output::create(path)?,
    };
    let bar = Bar::on_terminal(!args.quiet && !args.no_progress);
    let observer = Bar::observer(bar.as_ref());
    let result = engine.slice(&task.job, settings, &mut output, &observer);
    if let Some(bar) = bar {
        bar.remove();
    }
    let mut summary = result?;
    let mut path = match &task.destination {
        Destination::Stdout => None,
        Destination::File(path) => Some(path.clone()),
    };
    if let (Some(path), Some(name), true) = (&mut path, &summary.file_name, task.unnamed) {
        *path = named(path, name, &task.job, written)?;
        output.rename(&path.file_name().unwrap_or_default().to_string_lossy());
    }
    output.commit()?;
    written.extend(path.clone());
    summary.models = task.job.models.iter().map(|path| path.display().to_string()).collect();
    summary.output = path.map_or_else(|| "standard output".into(), |path| path.display().to_string());
    Ok(summary)
}

/// On standard output, or where the G-code went there, on standard error.
fn report(summary: &Summary, task: &Task, args: &SliceArgs) -> Result<(), Failure> {
    if args.quiet {
        return Ok(());
    }
    console::warn(&summary.warnings);
    if args.json {
        return console::print_json(summary);
    }
    match &task.destination {
        Destination::File(_) => console::print(&summary.to_string()),
        Destination::Stdout => {
            // If standard error is closed, no message is possible.
            let _ = write!(std::io::stderr(), "{summary}");
            Ok(())
        }
    }
}
