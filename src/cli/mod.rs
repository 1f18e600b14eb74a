//! The command line: arguments as typed → what they mean → the library → exit code.

mod args;
mod check;
mod compare;
mod console;
mod exit;
mod info;
mod pages;
mod plan;
mod profiles;
mod reorder;
mod slice;
mod time;
mod view;

use std::ffi::OsString;

use clap::Parser;

pub use exit::Exit;

use args::{Command, LowArgs};

use crate::job::Engine;

/// Does what the arguments (with the program's name first) ask for, and reports to standard output and standard error.
pub fn run(args: impl IntoIterator<Item = OsString>, engine: &dyn Engine) -> Exit {
    let args = match LowArgs::try_parse_from(args) {
        Ok(args) => args,
        Err(message) => {
            // If the terminal is gone, there is nobody to tell. `--help` is not a failure.
            let _ = message.print();
            return if message.use_stderr() { Exit::Usage } else { Exit::Done };
        }
    };
    let done = match &args.command {
        Command::Slice(args) => slice::run(args, engine),
        Command::Compare(args) => compare::run(args, engine),
        Command::View(args) => view::run(args, engine),
        Command::Reorder(args) => reorder::run(args, engine),
        Command::Info(args) => info::run(args, engine),
        Command::Time(args) => time::run(args),
        Command::Check(args) => check::run(args),
        Command::Profiles(args) => profiles::run(args),
        Command::Completions { shell } => pages::completions(*shell),
        Command::Man { command } => pages::man(command.as_deref()),
    };
    done.unwrap_or_else(|failure| {
        console::fail(&failure);
        failure.exit
    })
}
