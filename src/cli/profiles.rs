//! `pathwright profiles`.

use std::fmt::Write;

use super::args::{ProfilesArgs, ProfilesCommand};
use super::console;
use super::exit::{Exit, Failure};
use super::plan;
use crate::profile::{self, EMBEDDED};

pub(super) fn run(args: &ProfilesArgs) -> Result<Exit, Failure> {
    match args.command.as_ref().unwrap_or(&ProfilesCommand::List) {
        ProfilesCommand::List => console::print(&list())?,
        ProfilesCommand::Show { name } => {
            let text = profile::text(name).map_err(|message| Failure::new(Exit::Settings, message))?;
            console::print(&text)?;
        }
        ProfilesCommand::Dump { settings, json } => {
            let resolved = plan::settings(settings, &[])?;
            console::warn(&resolved.warnings);
            match json {
                true => console::print_json(&profile::dump_json(&resolved))?,
                false => console::print(&profile::dump_toml(&resolved))?,
            }
        }
        ProfilesCommand::Imports { bundles } if bundles.is_empty() => {
            console::print(&profile::import_page())?
        }
        ProfilesCommand::Imports { bundles } => {
            let figures = profile::import_figures(bundles);
            let figures = figures.map_err(|message| Failure::new(Exit::Settings, message))?;
            console::print(&figures.to_string())?;
        }
        ProfilesCommand::Reference => console::print(&profile::reference())?,
    }
    Ok(Exit::Done)
}

fn list() -> String {
    EMBEDDED.iter().fold(String::new(), |mut out, profile| {
        let _ = writeln!(out, "{:<9} {:<15} {}", profile.kind.name(), profile.name, profile.description());
        out
    })
}
