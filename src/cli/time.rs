//! `pathwright time`.

use std::io;
use std::path::Path;

use super::args::TimeArgs;
use super::console;
use super::exit::{Exit, Failure};
use crate::estimate::{Firmware, Machine};
use crate::gcode::{self, Timetable};
use crate::profile;
use crate::report::PrintTime;

/// Times every file that can be read. The exit code is that of the first one that cannot.
pub(super) fn run(args: &TimeArgs) -> Result<Exit, Failure> {
    let limits: Vec<String> = args.limits.iter().cloned().collect();
    let resolved = profile::resolve(&limits, &[])?;
    let settings = &resolved.settings;
    let named = args.machine.as_deref().and_then(Firmware::named);
    let firmware = named.unwrap_or(settings.printer.flavor.into());
    let machine = Machine::under(firmware, settings);
    let mut exit = Exit::Done;
    for path in &args.files {
        match read(path, &machine) {
            Ok(times) => {
                let report = PrintTime::new(path.display().to_string(), firmware, &times);
                if args.json {
                    console::print_json(&report)?;
                } else {
                    console::print(&report.to_string())?;
                }
            }
            Err(error) => {
                console::fail(&Failure::new(Exit::Input, format!("{}: {error}", path.display())));
                exit = Exit::Input;
            }
        }
    }
    Ok(exit)
}

fn read(path: &Path, machine: &Machine) -> io::Result<Timetable> {
    if path == Path::new("-") {
        return Timetable::read(gcode::open_stream(io::stdin().lock())?, machine);
    }
    Timetable::read(gcode::open(path)?, machine)
}
