//! `pathwright info`.

use super::args::InfoArgs;
use super::console;
use super::exit::{Exit, Failure};
use super::plan;
use crate::job::Engine;

/// Reports the contents of every readable model. The exit code is that of the first one that cannot.
pub(super) fn run(args: &InfoArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let resolved = plan::settings(&args.settings, &[])?;
    let transform = plan::transform(&args.models);
    let mut exit = Exit::Done;
    for model in &args.models.files {
        match engine.info(model, &transform, &resolved.settings) {
            Ok(info) if args.json => console::print_json(&info)?,
            Ok(info) => console::print(&info.to_string())?,
            Err(error) => {
                let failure = Failure::from(error);
                console::fail(&failure);
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    Ok(exit)
}
