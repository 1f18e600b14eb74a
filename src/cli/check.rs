//! `pathwright check`.

use std::io;
use std::path::{Path, PathBuf};

use super::args::{CheckArgs, ShapeArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::plan;
use crate::check::{self, CheckReport, Survey};
use crate::gcode;
use crate::mesh::Mesh;
use crate::parallel;
use crate::plate::{self, Line};
use crate::profile::Settings;

/// Checks file by file. The exit code is that of the first one that cannot be read, or else tells whether any has an
/// error.
pub(super) fn run(args: &CheckArgs) -> Result<Exit, Failure> {
    parallel::take_part(0);
    let resolved = plan::settings(&args.settings, &[])?;
    let bodies = bodies(&args.model, &args.shape, &resolved.settings)?;
    if !bodies.is_empty() && args.files.iter().any(|file| file == Path::new("-")) {
        return Err(super::exit::usage(
            "with --model the file is read more than once; standard input cannot be",
        ));
    }
    let (mut unread, mut faulty) = (false, false);
    for path in &args.files {
        match check(path, &bodies, &resolved.settings) {
            Ok(report) => {
                faulty |= report.errors > 0;
                tell(&report, args)?;
            }
            Err(failure) => {
                console::fail(&failure);
                unread = true;
            }
        }
    }
    Ok(match (unread, faulty) {
        (true, _) => Exit::Input,
        (_, true) => Exit::Check,
        _ => Exit::Done,
    })
}

/// The bodies of all models.
fn bodies(paths: &[PathBuf], shape: &ShapeArgs, settings: &Settings) -> Result<Vec<(String, Mesh)>, Failure> {
    let mut bodies = Vec::new();
    for path in paths {
        let file = plate::read_file(path, &plan::shape(shape), Line::thinnest(settings), 1);
        let file = file.map_err(|error| Failure::new(Exit::Input, error))?;
        bodies.extend(file.layout.standing_bodies());
    }
    Ok(bodies)
}

fn tell(report: &CheckReport, args: &CheckArgs) -> Result<(), Failure> {
    match (args.quiet, args.json) {
        (true, _) => Ok(()),
        (_, true) => console::print_json(report),
        _ => console::print(&report.to_string()),
    }
}

fn check(path: &Path, bodies: &[(String, Mesh)], settings: &Settings) -> Result<CheckReport, Failure> {
    let failed = |error: io::Error| Failure::new(Exit::Input, format!("{}: {error}", path.display()));
    let open = || gcode::open(path);
    let read = || match path == Path::new("-") {
        true => check::check(gcode::open_stream(io::stdin().lock())?, settings, None),
        false => open().and_then(|file| check::check(file, settings, None)),
    };
    // The comparison reads the file by itself, beside the rules.
    let compare = || {
        let mut compared = CheckReport::default();
        if !bodies.is_empty() {
            let survey = Survey::of(open()?)?;
            check::against(bodies, &survey, open, settings, &mut compared)?;
        }
        Ok(compared)
    };
    let (report, compared) = crate::parallel::join(read, compare);
    let Some(mut report) = report.map_err(failed)? else {
        return Err(failed(io::Error::other("there are no moves in it; is it G-code?")));
    };
    report.join(compared.map_err(failed)?);
    report.file = path.display().to_string();
    Ok(report)
}
