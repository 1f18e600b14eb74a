//! `pathwright slice`.

use std::ffi::OsString;
use std::io::Write;
#[cfg(feature = "send")]
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;

use super::args::SliceArgs;
use super::console::{self, Bar};
use super::exit::{Exit, Failure, usage};
use super::interrupt;
use super::plan::{Destination, Plan, Plate, Task, named, no_package};
use super::projects;
use super::watch::Watch;
use crate::gcode::Form;
use crate::job::Engine;
use crate::output::Output;
use crate::parallel;
use crate::profile::{Resolved, binary_metadata};
use crate::report::Summary;

/// Begins what a slicing needs while its arguments, of which the first is the program, are read: workers, and another thread's
/// listening for interrupts. Nothing if they are not a slicing's, or may say how many workers there are.
pub(super) fn begin(args: &[OsString]) {
    let is_slicing = args.get(1).is_some_and(|command| command == "slice");
    if is_slicing && !args.iter().any(|arg| arg.as_encoded_bytes().starts_with(b"--threads")) {
        parallel::take_part(0);
        parallel::aside(interrupt::listen);
    }
}

/// Slices plate by plate. One that fails does not keep the others from being sliced; the exit code is that of the
/// first one that failed.
pub(super) fn run(args: &SliceArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let watch = Watch::start(&args.limits, args.json)?;
    parallel::take_part(args.threads.map_or(0, Into::into));
    let plan = Plan::new(args)?;
    if args.json && plan.tasks.iter().any(|task| task.destination == Destination::Stdout) {
        return Err(usage("--json and the G-code both want standard output; give -o a file"));
    }
    #[cfg(feature = "send")]
    if args.to.is_some() && plan.tasks.iter().any(|task| task.destination == Destination::Stdout) {
        return Err(usage("--send needs a file; leave out -o -"));
    }
    if !args.quiet {
        let mut told: Vec<&Arc<Resolved>> = Vec::new();
        for settings in plan.tasks.iter().map(|task| &task.plate.settings) {
            if !told.iter().any(|known| Arc::ptr_eq(known, settings)) {
                console::warn(&settings.warnings);
                told.push(settings);
            }
        }
    }
    // From here on something could be left incomplete.
    interrupt::listen();
    if let (Some(path), [task]) = (&args.save_project, plan.tasks.as_slice()) {
        return projects::save(path, task, args);
    }
    slice_all(&plan, args, engine, &watch)
}

/// Prints the keys of the results.
pub(super) fn keys(args: &SliceArgs) -> Result<Exit, Failure> {
    for task in &Plan::new(args)?.tasks {
        let settings = &task.plate.settings.settings;
        let is_binary = match &task.destination {
            Destination::File(path) => Form::of_name(path) == Form::Binary,
            Destination::Stdout => false,
        };
        let key = task.plate.job.key(settings, is_binary)?;
        match args.json {
            true => console::print_json(&serde_json::json!({ "key": key, "models": names(&task.plate) }))?,
            false => console::print(&(key + "\n"))?,
        }
    }
    Ok(Exit::Done)
}

fn slice_all(plan: &Plan, args: &SliceArgs, engine: &dyn Engine, watch: &Watch) -> Result<Exit, Failure> {
    let mut exit = Exit::Done;
    let mut written = Vec::new();
    for task in &plan.tasks {
        match slice(task, args, engine, &mut written, watch).map_err(|failure| watch.explained(failure)) {
            Ok(summary) => {
                report(&summary, task, args)?;
                #[cfg(feature = "send")]
                if let Some(to) = &args.to {
                    super::send::sliced(Path::new(&summary.output), to, args)?;
                }
            }
            Err(failure) => {
                let input = names(&task.plate).swap_remove(0);
                let failure = Failure { file: failure.file.clone().or(Some(input)), ..failure };
                console::fail_as(&failure, args.json)?;
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    Ok(exit)
}

fn names(plate: &Plate) -> Vec<String> {
    plate.inputs.iter().map(|path| path.display().to_string()).collect()
}

fn slice(
    task: &Task,
    args: &SliceArgs,
    engine: &dyn Engine,
    written: &mut Vec<PathBuf>,
    watch: &Watch,
) -> Result<Summary, Failure> {
    let settings = &task.plate.settings.settings;
    let mut output = match &task.destination {
        Destination::Stdout => Output::stdout(),
        Destination::File(path) => match Form::of_name(path) {
            Form::Text => Output::create(path)?,
            Form::Binary => Output::create_binary(path, binary_metadata(settings))?,
            Form::Package => return Err(no_package(path)),
        },
    };
    let bar = Bar::on_terminal(!args.quiet && !args.no_progress);
    let observer = watch.over(Bar::observer(bar.as_ref()));
    let result = engine.slice(&task.plate.job, settings, &mut output, &observer);
    if let Some(bar) = bar {
        bar.remove();
    }
    let mut summary = result?;
    let mut path = match &task.destination {
        Destination::Stdout => None,
        Destination::File(path) => Some(path.clone()),
    };
    if let (Some(path), Some(name), true) = (&mut path, &summary.file_name, task.unnamed) {
        *path = named(path, name, &task.plate.inputs, written)?;
        output.rename(&path.file_name().unwrap_or_default().to_string_lossy());
    }
    output.commit()?;
    written.extend(path.clone());
    summary.models = names(&task.plate);
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
