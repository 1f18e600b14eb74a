//! Puts finished G-code into a better order, from code.
//!
//!     cargo run --release --example reorder -- PART.gcode SHORTER.gcode

use std::path::Path;
use std::process::ExitCode;

use pathwright::Observer;
use pathwright::job::{Engine, JobError, ReorderJob};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile::Settings;
use pathwright::report::Reordered;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, shorter] = arguments.as_slice() else {
        eprintln!("PART.gcode SHORTER.gcode");
        return ExitCode::from(2);
    };
    match reorder(file.as_ref(), shorter.as_ref()) {
        Ok(report) => {
            print!("{report}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn reorder(file: &Path, shorter: &Path) -> Result<Reordered, JobError> {
    let job = ReorderJob { file: file.to_owned(), ..ReorderJob::default() };
    let mut output = Output::create(shorter)?;
    let report = Pipeline.reorder(&job, &Settings::default(), &mut output, &Observer::none())?;
    // What was written is of use only if it is better.
    if report.changed {
        output.commit()?;
    }
    Ok(report)
}
