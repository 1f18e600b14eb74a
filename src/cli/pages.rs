//! `pathwright completions` and `pathwright man`, made from the arguments' own definition.

use clap::CommandFactory;
use clap_complete::Shell;

use super::args::Arguments;
use super::console;
use super::exit::{Exit, Failure};

pub(super) fn completions(shell: Shell) -> Result<Exit, Failure> {
    let mut page = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "pathwright", &mut page);
    print(&page)
}

/// The man page of the program or of one of its commands.
pub(super) fn man(command: Option<&str>) -> Result<Exit, Failure> {
    let mut program = Arguments::command();
    program.build();
    let described = match command {
        None => program,
        Some(name) => match program.find_subcommand(name) {
            Some(found) => found.clone(),
            None => {
                let names: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
                return Err(Failure::new(Exit::Usage, format!("no command `{name}`: {}", names.join(", "))));
            }
        },
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(described).render(&mut page).map_err(|error| Failure::new(Exit::Output, error))?;
    print(&page)
}

fn print(page: &[u8]) -> Result<Exit, Failure> {
    console::print(&String::from_utf8_lossy(page))?;
    Ok(Exit::Done)
}
