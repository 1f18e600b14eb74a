//! The program: signals, the pipeline, and an exit code.

use std::process::ExitCode;

use pathwright::cli::{self, Exit};
use pathwright::output;
use pathwright::pipeline::Pipeline;

fn main() -> ExitCode {
    // On an interrupt nothing has to be asked: what is incomplete is removed, and the process ends at once.
    let handler = ctrlc::set_handler(|| output::abandon_and_exit(Exit::Interrupted as i32));
    if let Err(error) = handler {
        eprintln!("warning: an interrupt may leave a temporary file behind: {error}");
    }
    cli::run(std::env::args_os(), &Pipeline).into()
}
