//! The program: arguments, the pipeline, and an exit code.

use std::process::ExitCode;

use mimalloc::MiMalloc;
use pathwright::cli;
use pathwright::pipeline::Pipeline;

/// Most of what a slicing allocates is small and soon given back.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    cli::run(std::env::args_os(), &Pipeline).into()
}
