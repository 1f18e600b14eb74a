//! `pathwright reorder`.

use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use super::args::ReorderArgs;
use super::console;
use super::exit::{Exit, Failure};
use super::plan;
use super::watch::Watch;
use crate::gcode::{self, BinaryMetadata, Form, Parts};
use crate::job::{Engine, ReorderJob};
use crate::observer::Observer;
use crate::output::Output;
use crate::profile::{Override, Settings};
use crate::report::Reordered;

/// Where a result goes.
enum Destination {
    Nowhere,
    Stdout,
    File(PathBuf),
}

/// Reorders file by file. One that fails does not keep the others from being reordered; the exit code is that of the
/// first one that failed.
pub(super) fn run(args: &ReorderArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let watch = Watch::start(&args.limits, args.json)?;
    let settings = settings(args)?;
    let destinations: Vec<Destination> =
        args.files.iter().map(|file| destination(args, file)).collect::<Result<_, _>>()?;
    let mut exit = Exit::Done;
    for (file, destination) in args.files.iter().zip(&destinations) {
        match reorder(file, destination, &settings, args, engine, &watch) {
            Ok(report) => tell(&report, destination, args)?,
            Err(failure) => {
                let failure = watch.explained(failure);
                let failure = Failure { file: Some(file.display().to_string()), ..failure };
                console::fail_as(&failure, args.json)?;
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    Ok(exit)
}

/// The settings in force. Lengths count, and of a finished file outer walls keep their seams, unless something else is requested.
fn settings(args: &ReorderArgs) -> Result<Settings, Failure> {
    let seam = Override { key: "seam.position".into(), value: "pinned".into(), option: "--seam" };
    let asked = args.ordering.seam.is_some() || plan::sets(&args.settings, &seam.key);
    let mut shorthands = plan::shorthands(args.order.as_ref(), &args.ordering);
    if !asked {
        shorthands.push(seam);
    }
    shorthands.extend(plan::by_length(&args.settings, &args.ordering));
    let resolved = plan::settings(&args.settings, &shorthands)?;
    if !args.quiet {
        console::warn(&resolved.warnings);
    }
    Ok(resolved.settings)
}

fn destination(args: &ReorderArgs, file: &Path) -> Result<Destination, Failure> {
    let usage = |message: &str| Err(Failure::new(Exit::Usage, message));
    match &args.output {
        None if args.dry_run => Ok(Destination::Nowhere),
        None if args.in_place => Ok(Destination::File(file.to_owned())),
        None => usage("give a destination: -o PATH, --in-place or --dry-run"),
        Some(output) if output == Path::new("-") => match args.files.len() {
            1 if args.json => usage("--json and -o - both want standard output; give one of them a file"),
            1 => Ok(Destination::Stdout),
            _ => usage("several files cannot go to standard output; give -o a folder"),
        },
        Some(output) if output.is_dir() => match file.file_name() {
            Some(name) => Ok(Destination::File(output.join(name))),
            None => usage("one of the arguments is not a file"),
        },
        Some(_) if args.files.len() > 1 => usage("with several files, -o names a folder that exists"),
        Some(output) => Ok(Destination::File(output.clone())),
    }
}

fn reorder(
    file: &Path,
    destination: &Destination,
    settings: &Settings,
    args: &ReorderArgs,
    engine: &dyn Engine,
    watch: &Watch,
) -> Result<Reordered, Failure> {
    let form = Form::of_file(file);
    // In place a file stays what it is, whatever its name.
    let to = |path: &Path| if args.in_place { form } else { Form::of_name(path) };
    let parts = match form {
        Form::Package => Some(Parts::of(file).map_err(|error| unreadable(file, &error))?),
        _ => None,
    };
    if let (Destination::File(path), None) = (destination, &parts)
        && to(path) == Form::Package
    {
        return Err(plan::no_package(path));
    }
    let create = || match destination {
        Destination::Nowhere => Output::nowhere(),
        Destination::Stdout => Ok(Output::stdout()),
        Destination::File(path) => match to(path) {
            Form::Text => Output::create(path),
            Form::Binary => Output::create_binary(path, BinaryMetadata::default()),
            Form::Package => Output::create_package(path, parts.clone().unwrap_or_default()),
        },
    };
    let mut output = create()?;
    let job = ReorderJob {
        file: file.to_owned(),
        keep_direction: args.keep_direction,
        more_retractions: plan::asks_for_cost(&args.settings, &args.ordering),
        threads: Some(args.threads.map_or(0, Into::into)),
    };
    let mut report = engine.reorder(&job, settings, &mut output, &watch.over(Observer::none()))?;
    report.output = match destination {
        Destination::Nowhere => None,
        Destination::Stdout => Some("standard output".into()),
        Destination::File(path) => Some(path.display().to_string()),
    };
    let in_place = report.output.as_ref() == Some(&report.file);
    match destination {
        Destination::Nowhere => {}
        _ if report.changed => output.commit()?,
        _ if in_place => {}
        _ => {
            let as_it_is = match destination {
                Destination::File(path) => to(path) == form,
                _ => form == Form::Text,
            };
            let mut copy = match destination {
                // The same bytes as before.
                Destination::File(path) if as_it_is => Output::create(path)?,
                _ => create()?,
            };
            copy_to(file, as_it_is, &mut copy)?;
            copy.commit()?;
        }
    }
    Ok(report)
}

fn unreadable(file: &Path, error: &io::Error) -> Failure {
    Failure::new(Exit::Input, format!("{}: {error}", file.display()))
}

/// A file piece by piece: its bytes as they are, or its text.
fn copy_to(file: &Path, as_it_is: bool, copy: &mut Output) -> Result<(), Failure> {
    let failed = |error: io::Error| unreadable(file, &error);
    let mut input: Box<dyn BufRead> = match as_it_is {
        true => Box::new(BufReader::with_capacity(1 << 18, fs::File::open(file).map_err(failed)?)),
        false => Box::new(gcode::open(file).map_err(failed)?),
    };
    loop {
        let bytes = input.fill_buf().map_err(failed)?;
        if bytes.is_empty() {
            return Ok(());
        }
        copy.write(bytes)?;
        let read = bytes.len();
        input.consume(read);
    }
}

/// On standard output, or where the G-code went there, on standard error.
fn tell(report: &Reordered, destination: &Destination, args: &ReorderArgs) -> Result<(), Failure> {
    match destination {
        _ if args.quiet => Ok(()),
        _ if args.json => console::print_json(report),
        Destination::Stdout => {
            // If standard error is closed, no message is possible.
            let _ = write!(std::io::stderr(), "{report}");
            Ok(())
        }
        _ => console::print(&report.to_string()),
    }
}
