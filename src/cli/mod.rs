//! The command line: arguments as typed → what they mean → the library → exit code.

#[cfg(feature = "serve")]
mod app;
mod args;
mod check;
mod compare;
mod console;
mod deferred;
mod exit;
mod given;
#[cfg(feature = "send")]
mod host;
#[cfg(feature = "send")]
mod host_args;
#[cfg(feature = "send")]
mod hosts;
mod info;
mod interrupt;
mod pages;
mod plan;
mod presets;
mod printers;
mod profiles;
mod projects;
mod reorder;
#[cfg(feature = "send")]
mod send;
#[cfg(feature = "serve")]
mod serve;
mod setting_args;
mod slice;
mod time;
mod view;
mod watch;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::Parser;

pub use exit::Exit;

use args::{Arguments, Command};

use crate::job::Engine;
use crate::limits;
use crate::system;

/// Runs the program with these arguments (its name first) and reports to standard output and standard error.
pub fn run(args: impl IntoIterator<Item = OsString>, engine: &dyn Engine) -> Exit {
    limits::watch_memory(system::memory::available_bytes);
    let args: Vec<OsString> = args.into_iter().collect();
    slice::begin(&args);
    let args = match Arguments::try_parse_from(args) {
        Ok(args) => args,
        Err(message) => {
            // If the terminal is gone, no message is possible. `--help` is not a failure.
            let _ = message.print();
            return if message.use_stderr() { Exit::Usage } else { Exit::Done };
        }
    };
    // A slicing listens before it begins its output.
    if !matches!(args.command, Command::Slice(_)) {
        interrupt::listen();
    }
    let done = match &args.command {
        Command::Slice(args) => slice::run(args, engine),
        Command::Key(args) => slice::keys(args),
        Command::Compare(args) => compare::run(args, engine),
        Command::View(args) => view::run(args, engine),
        Command::Reorder(args) => reorder::run(args, engine),
        Command::Info(args) => info::run(args, engine),
        Command::Time(args) => time::run(args),
        Command::Check(args) => check::run(args),
        Command::Profiles(args) => profiles::run(args),
        Command::Printers(args) => printers::run(args),
        #[cfg(feature = "send")]
        Command::Send(args) => send::run(args),
        #[cfg(feature = "send")]
        Command::Hosts(args) => hosts::run(args),
        #[cfg(feature = "serve")]
        Command::App(args) => app::run(args),
        #[cfg(feature = "serve")]
        Command::Serve(args) => serve::run(args),
        Command::Completions { shell } => pages::completions(*shell),
        Command::Man { command } => pages::man(command.as_deref()),
    };
    // G-code on standard output stays alone there.
    let to_file = |output: &Option<PathBuf>| output.as_deref() != Some(Path::new("-"));
    let json = match &args.command {
        Command::Slice(args) | Command::Key(args) => args.json && to_file(&args.output),
        Command::Compare(args) => args.json,
        Command::Reorder(args) => args.json && to_file(&args.output),
        #[cfg(feature = "send")]
        Command::Send(args) => args.json,
        _ => false,
    };
    done.unwrap_or_else(|failure| match console::fail_as(&failure, json) {
        Ok(()) => failure.exit,
        Err(_) => Exit::Output,
    })
}
