//! Slices a model from code, and checks what was made.
//!
//!     cargo run --release --example slice -- PART.stl PART.gcode [PROFILE …]

use std::path::PathBuf;
use std::process::ExitCode;

use pathwright::Observer;
use pathwright::check::check;
use pathwright::job::{Engine, Job};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [model, file, profiles @ ..] = arguments.as_slice() else {
        eprintln!("PART.stl PART.gcode [PROFILE …]");
        return ExitCode::from(2);
    };
    match slice(model.into(), file.into(), profiles) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// What a slicing came to, and what a reader of the file thinks of it.
fn slice(model: PathBuf, file: PathBuf, profiles: &[String]) -> Result<String, Box<dyn std::error::Error>> {
    let resolved = profile::resolve(profiles, &[])?;
    let job = Job { models: vec![model.into()], ..Job::default() };
    let mut output = Output::create(&file)?;
    let summary = Pipeline.slice(&job, &resolved.settings, &mut output, &Observer::none())?;
    // Until now nothing is to be seen of the file.
    output.commit()?;
    let report = check(std::fs::File::open(&file)?, &resolved.settings, None)?;
    Ok(format!("{summary}{}", report.map(|report| report.to_string()).unwrap_or_default()))
}
