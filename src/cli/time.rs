//! `pathwright time`.

use std::io;
use std::path::Path;

use super::args::{Assignment, TimeArgs};
use super::console;
use super::exit::{Exit, Failure};
use crate::estimate::{Firmware, Machine};
use crate::gcode::{self, Timetable};
use crate::profile::{self, Override};
use crate::report::PrintTime;

/// Times every file that can be read. The exit code is that of the first one that cannot.
pub(super) fn run(args: &TimeArgs) -> Result<Exit, Failure> {
    let limits: Vec<String> = args.limits.iter().cloned().collect();
    let set = |Assignment { key, value }: &Assignment| Override {
        key: key.clone(),
        value: value.clone(),
        option: "--set",
    };
    let resolved = profile::resolve(&limits, &args.set.iter().map(set).collect::<Vec<_>>())?;
    let settings = &resolved.settings;
    let named = args.machine.as_deref().and_then(Firmware::named);
    let firmware = named.unwrap_or(settings.printer.flavor.into());
    let change_is_fixed = args.set.iter().any(|set| set.key == "tool_change.time");
    let machine = Machine { change_is_fixed, ..Machine::under(firmware, settings) };
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
    let times = match path == Path::new("-") {
        true => Timetable::read(gcode::open_stream(io::stdin().lock())?, machine)?,
        false => Timetable::read(gcode::open(path)?, machine)?,
    };
    match times.layers() == 0 && times.total_s() == 0.0 {
        true => Err(io::Error::other("there are no moves in it; is it G-code?")),
        false => Ok(times),
    }
}
