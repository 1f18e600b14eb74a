//! The program: signals, the pipeline, and an exit code.

use std::process::ExitCode;

use mimalloc::MiMalloc;
use pathwright::cli;
use pathwright::pipeline::Pipeline;

/// Most of what a slicing allocates is small and soon given back.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let handler = ctrlc::set_handler(cli::interrupted);
    if let Err(error) = handler {
        eprintln!("warning: an interrupt may leave a temporary file behind: {error}");
    }
    cli::run(std::env::args_os(), &Pipeline).into()
}
