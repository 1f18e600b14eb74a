//! `pathwright send`, and `slice --send`.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::args::SliceArgs;
use super::console::{self, file_name};
use super::exit::{Exit, Failure};
use super::host::{self, line, patience};
use super::host_args::{DeliveryArgs, SendArgs};
use super::plan;
use super::setting_args::{PresetArgs, SettingArgs};
use crate::observer::Observer;
use crate::parallel::{self, Workers};
use crate::profile::Settings;
use crate::send::{self, FileFacts, HostEntry, Payload, PrintHost};

/// What an interrupt would interrupt, and what to say of it.
static INTERRUPTED: Mutex<Option<String>> = Mutex::new(None);

/// Says what an interrupt leaves on a host.
pub(super) fn interrupted() {
    if let Ok(said) = INTERRUPTED.try_lock()
        && let Some(said) = said.as_ref()
    {
        let _ = writeln!(io::stderr(), "\n{said}");
    }
}

fn on_interrupt(said: Option<String>) {
    if let Ok(mut place) = INTERRUPTED.lock() {
        *place = said;
    }
}

pub(super) fn run(args: &SendArgs) -> Result<Exit, Failure> {
    let entry = host::entry(&args.to, &args.settings.presets, &args.delivery.access)?;
    deliver(&args.file, &entry, &args.settings, &args.delivery, args.json)?;
    Ok(Exit::Done)
}

/// Sends what has been sliced.
pub(super) fn sliced(file: &Path, to: &str, args: &SliceArgs) -> Result<(), Failure> {
    let entry = host::entry(to, &args.settings.presets, &args.delivery.access)?;
    deliver(file, &entry, &args.settings, &args.delivery, args.json)
}

fn deliver(
    file: &Path,
    entry: &HostEntry,
    settings: &SettingArgs,
    args: &DeliveryArgs,
    is_json: bool,
) -> Result<(), Failure> {
    let unreadable = |error: io::Error| Failure::new(Exit::Input, format!("{}: {error}", file.display()));
    let payload = Payload::of(file).map_err(unreadable)?;
    let host = send::connect(entry, patience(&args.access))?;
    let about = host.about()?;
    if !args.no_check {
        let facts = FileFacts::read(&payload).map_err(unreadable)?;
        console::warn(&send::examine(&entry.name, entry.kind, &about, &facts)?);
        let settings = printer_settings(entry, settings)?;
        let check = |_: Workers<'_>| send::check(&entry.name, &payload, &about, settings);
        parallel::run(Some(0), &Observer::none(), check).unwrap_or(Ok(()))?;
    }
    let name = args.name.clone().unwrap_or_else(|| file_name(file));
    on_interrupt(Some(format!("interrupted; nothing was started on {}", entry.name)));
    let bar = Bytes::on_terminal(payload.bytes);
    let sent = send::deliver(host.as_ref(), &payload, &name, args.replace, &mut |done| {
        if let Some(bar) = &bar {
            bar.0.set_position(done);
        }
    });
    if let Some(bar) = bar {
        bar.0.finish_and_clear();
    }
    let sent = sent?;
    if sent.is_altered {
        console::tell(format_args!(
            "{}: it has written into {} (plug-ins do); all commands are there, in their order",
            entry.name, sent.name
        ));
    }
    let mut ended = None;
    if args.start {
        on_interrupt(Some(format!(
            "interrupted; {} may have been started on {}: look at the printer",
            sent.name, entry.name
        )));
        send::start(host.as_ref(), &sent.name)?;
        if args.wait {
            ended = Some(follow(host.as_ref(), &sent.name)?);
        }
    }
    on_interrupt(None);
    if is_json {
        return console::print_json(&json!({ "sent": {
            "host": entry.name,
            "name": sent.name,
            "bytes": payload.bytes,
            "sha256": payload.sha256,
            "verified": sent.is_verified,
            "started": args.start,
            "ended": ended.is_some(),
        }}));
    }
    let how = match (args.start, ended.is_some()) {
        (_, true) => "printed",
        (true, _) => "printing",
        _ => "stored",
    };
    let compared = if sent.is_verified { ", compared" } else { "" };
    console::print(&format!("{}: {how} {} ({} bytes{compared})\n", entry.name, sent.name, payload.bytes))
}

/// Follows a print; on a terminal with layer, progress and time left.
fn follow(host: &dyn PrintHost, name: &str) -> Result<(), Failure> {
    on_interrupt(Some(format!("{name} goes on printing on {}; it is followed no longer", host.name())));
    console::tell(format_args!("{}: {name} has started", host.name()));
    let bar = io::stderr().is_terminal().then(ProgressBar::new_spinner);
    let done = send::follow(host, name, &mut |state| {
        if let Some(bar) = &bar {
            bar.set_message(line(state));
            bar.tick();
        }
        true
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    done.map(|_| ()).map_err(Failure::from)
}

/// Settings that a file is checked with: those that are given, or those in the file of hosts.
fn printer_settings(entry: &HostEntry, given: &SettingArgs) -> Result<Option<Settings>, Failure> {
    let is_given = given.presets.printer.is_some() || !given.profile.is_empty() || !given.set.is_empty();
    if is_given {
        return Ok(Some(plan::settings(given, &[])?.settings));
    }
    if entry.printer.is_none() && entry.profile.is_empty() {
        return Ok(None);
    }
    let known = SettingArgs {
        presets: PresetArgs {
            printer: entry.printer.clone(),
            print: None,
            filament: None,
            presets: given.presets.presets.clone(),
        },
        profile: entry.profile.clone(),
        set: Vec::new(),
        ignore_scripts: true,
    };
    Ok(Some(plan::settings(&known, &[])?.settings))
}

/// Bytes sent.
struct Bytes(ProgressBar);

impl Bytes {
    fn on_terminal(bytes: u64) -> Option<Self> {
        if !io::stderr().is_terminal() {
            return None;
        }
        let style =
            ProgressStyle::with_template("{bar:40} {bytes}/{total_bytes}, {bytes_per_sec}, {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
        Some(Self(ProgressBar::new(bytes).with_style(style)))
    }
}
