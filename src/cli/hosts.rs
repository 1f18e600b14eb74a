//! `pathwright hosts`: the print hosts of a user.

use std::fmt::Write;
use std::io;

use serde_json::{Value, json};

use super::console;
use super::exit::{Exit, Failure, usage};
use super::host::{PRESET, line, of_physical_printer, of_preset, patience, read};
use super::host_args::{AccessArgs, AddArgs, HostsArgs, HostsCommand};
use crate::send::{self, About, HostEntry, HostKind, HostState, Hosts, KeySource, Secret, SendError};

pub(super) fn run(args: &HostsArgs) -> Result<Exit, Failure> {
    match &args.command {
        HostsCommand::List { access, json } => list(&read(access)?, *json),
        HostsCommand::Test { names, access, json } => test(names, access, *json),
        HostsCommand::Add(args) => add(args),
    }
}

fn list(hosts: &Hosts, is_json: bool) -> Result<Exit, Failure> {
    let rows = hosts.entries.iter();
    if is_json {
        let rows: Vec<Value> = rows
            .map(|host| json!({ "name": host.name, "kind": host.kind.name(), "url": host.url, "key": host.key.describe() }))
            .collect();
        console::print_json(&rows)?;
        return Ok(Exit::Done);
    }
    if hosts.entries.is_empty() {
        console::print(&format!("no hosts in {}; `pathwright hosts add` makes one\n", hosts.path.display()))?;
    }
    let width = hosts.entries.iter().map(|host| host.name.chars().count()).max().unwrap_or(0);
    let text = rows.fold(String::new(), |mut out, host| {
        let _ = writeln!(
            out,
            "{:<width$}  {:<9}  {}  key: {}",
            host.name,
            host.kind.name(),
            host.url,
            host.key.describe()
        );
        out
    });
    console::print(&text)?;
    Ok(Exit::Done)
}

/// What a host says of itself.
struct Told {
    about: About,
    state: HostState,
    free_bytes: Option<u64>,
}

fn ask(entry: &HostEntry, access: &AccessArgs) -> Result<Told, SendError> {
    let host = send::connect(entry, patience(access))?;
    Ok(Told { about: host.about()?, state: host.state()?, free_bytes: host.free_bytes()? })
}

/// Asks each host; the exit code is that of the first one that fails.
fn test(names: &[String], access: &AccessArgs, is_json: bool) -> Result<Exit, Failure> {
    let hosts = read(access)?;
    let mut entries: Vec<HostEntry> = match names {
        [] => hosts.entries.clone(),
        names => names.iter().map(|name| hosts.find(name).cloned()).collect::<Result<_, _>>()?,
    };
    let mut exit = Exit::Done;
    for entry in &mut entries {
        if access.ca.is_some() {
            entry.ca.clone_from(&access.ca);
        }
        match ask(entry, access) {
            Ok(told) if is_json => console::print_json(&json!({
                "name": entry.name, "about": told.about, "state": told.state, "free_bytes": told.free_bytes
            }))?,
            Ok(told) => console::print(&text_of(entry, &told))?,
            Err(error) => {
                let failure = Failure::from(error);
                exit = if exit == Exit::Done { failure.exit } else { exit };
                console::fail_as(&failure, is_json)?;
            }
        }
    }
    Ok(exit)
}

fn text_of(entry: &HostEntry, told: &Told) -> String {
    let about = &told.about;
    let mut words = vec![line(&told.state), about.software.clone()];
    words.extend(about.printer.clone());
    if !about.nozzles_mm.is_empty() {
        let nozzles: Vec<String> = about.nozzles_mm.iter().map(f64::to_string).collect();
        words.push(format!("nozzle {} mm", nozzles.join(" and ")));
    }
    if let Some(volume) = about.volume {
        let [x, y, z] = [0, 1, 2].map(|axis| volume.high[axis] - volume.low[axis]);
        words.push(format!("{x} x {y} x {z} mm"));
    }
    words.extend(told.free_bytes.map(|bytes| format!("{} MB free", bytes >> 20)));
    format!("{}: {}\n", entry.name, words.join("; "))
}

fn add(args: &AddArgs) -> Result<Exit, Failure> {
    let hosts = read(&args.access)?;
    let name = args.name.as_str();
    if name == PRESET || name.chars().any(char::is_whitespace) {
        return Err(usage(format!("`{name}` cannot be the name of a host; shop/mk4 would be one")));
    }
    let has_key = args.key_stdin || args.key_file.is_some() || args.key_env.is_some();
    let mut entry = match (&args.kind, &args.url, &args.physical_printer) {
        (Some(kind), Some(url), _) => {
            let kind = HostKind::from_name(kind).unwrap_or(HostKind::OctoPrint);
            let entry = HostEntry::new(name, kind, url).map_err(usage)?;
            HostEntry { printer: args.presets.printer.clone(), ..entry }
        }
        (_, _, Some(printer)) => of_physical_printer(name, printer, &args.presets, has_key)?,
        _ => HostEntry { name: name.to_owned(), ..of_preset(PRESET, &args.presets)? },
    };
    if let Some(file) = &args.key_file {
        // The file of hosts may be read from any folder.
        entry.key = KeySource::File(std::path::absolute(file).unwrap_or_else(|_| file.clone()));
    } else if let Some(variable) = &args.key_env {
        entry.key = KeySource::Variable(variable.clone());
    } else if args.key_stdin {
        let mut typed = String::new();
        io::stdin()
            .read_line(&mut typed)
            .map_err(|error| Failure::new(Exit::Input, format!("standard input: {error}")))?;
        entry.key = KeySource::Given(Secret::new(&typed));
    }
    entry.user = args.user.clone().or(entry.user);
    entry.storage.clone_from(&args.storage);
    entry.profile.clone_from(&args.profile);
    entry.ca =
        args.access.ca.as_ref().map(|ca| std::path::absolute(ca).unwrap_or_else(|_| ca.clone())).or(entry.ca);
    hosts.add(&entry)?;
    console::print(&format!(
        "{name}: written to {}; `pathwright hosts test {name}` asks it\n",
        hosts.path.display()
    ))?;
    Ok(Exit::Done)
}
