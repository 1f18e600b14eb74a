//! Print hosts as commands name and show them.

use std::path::PathBuf;
use std::time::Duration;

use super::console;
use super::exit::{Exit, Failure, usage};
use super::host_args::AccessArgs;
use super::presets;
use super::setting_args::PresetArgs;
use crate::presets::Config;
use crate::send::{self, Activity, HostEntry, HostKind, HostState, Hosts, KeySource, Patience, Secret};
use crate::system;

/// What a host is called that a printer preset names.
pub(super) const PRESET: &str = "preset";

/// What PrusaSlicer writes for a user and a password that it keeps in the system's store.
const IN_STORE: &str = "stored";

/// The file of hosts.
pub(super) fn read(access: &AccessArgs) -> Result<Hosts, Failure> {
    let path = system::hosts_file(access.hosts.as_deref()).ok_or_else(|| {
        Failure::new(
            Exit::Settings,
            format!(
                "there is no folder for settings; name the file of hosts with --hosts or ${}",
                system::HOSTS
            ),
        )
    })?;
    Ok(Hosts::read(&path)?)
}

/// A host by its name, or the one that a printer preset names.
pub(super) fn entry(name: &str, args: &PresetArgs, access: &AccessArgs) -> Result<HostEntry, Failure> {
    let mut entry = match name == PRESET {
        true => of_preset(name, args)?,
        false => read(access)?.find(name)?.clone(),
    };
    if access.ca.is_some() {
        entry.ca.clone_from(&access.ca);
    }
    Ok(entry)
}

/// The host that a printer preset names.
pub(super) fn of_preset(name: &str, args: &PresetArgs) -> Result<HostEntry, Failure> {
    let chosen = presets::chosen(args)?.ok_or_else(|| {
        usage(format!("`{PRESET}` is the host of a printer preset; name one with --printer"))
    })?;
    let text = |key: &str| text(&chosen.config, key);
    let mut entry = of_values(name, text).map_err(|message| {
        Failure::new(Exit::Settings, format!("--printer {}: {message}", chosen.printer.name))
    })?;
    entry.printer.clone_from(&args.printer);
    Ok(entry)
}

/// The host of a physical printer of another slicer, and the first preset that it prints with. `has_key`: its key is given.
pub(super) fn of_physical_printer(
    name: &str,
    printer: &str,
    args: &PresetArgs,
    has_key: bool,
) -> Result<HostEntry, Failure> {
    let printer = system::physical_printer(printer, &args.presets)?;
    let text = |key: &str| printer.value(key).map(str::to_owned);
    let failed = |message: String| {
        Failure::new(Exit::Settings, format!("--physical-printer {}: {message}", printer.name))
    };
    let entry = of_values(name, text).map_err(failed)?;
    if !has_key && entry.key == KeySource::None && printer.value("printhost_password") == Some(IN_STORE) {
        return Err(failed(
            "its password is in the system's store, which is not read; give it with --key-stdin, --key-file or --key-env"
                .into(),
        ));
    }
    Ok(HostEntry { printer: args.printer.clone().or(printer.presets.first().cloned()), ..entry })
}

/// The host that the keys of a preset or a physical printer name.
fn of_values(name: &str, text: impl Fn(&str) -> Option<String>) -> Result<HostEntry, String> {
    let url = text("print_host").ok_or("it names no print_host")?;
    let kind = text("host_type").unwrap_or_else(|| "octoprint".into());
    let kind = HostKind::from_name(&kind)
        .ok_or_else(|| format!("host_type = {kind} is none of {}", HostKind::NAMES.join(", ")))?;
    let mut entry = HostEntry::new(name, kind, &url)?;
    let is_login = text("printhost_authorization_type").as_deref() == Some("user");
    let key = if is_login { text("printhost_password") } else { text("printhost_apikey") };
    let key = key.filter(|key| key != IN_STORE);
    entry.key = key.map_or(KeySource::None, |key| KeySource::Given(Secret::new(&key)));
    entry.user = text("printhost_user").filter(|user| is_login && user != IN_STORE);
    entry.ca = text("printhost_cafile").map(PathBuf::from);
    Ok(entry)
}

/// A text of a preset, under either slicer's name for it.
fn text(config: &Config, key: &str) -> Option<String> {
    let raw = config.raw.get(key).map(|raw| raw.value.as_str());
    let value = config.entries.get(key).map(|entry| entry.value.as_str()).or(raw)?;
    let value = value.trim().trim_matches('"');
    (!value.is_empty() && value != "nil").then(|| value.to_owned())
}

/// How long hosts are waited for; what is tried again is told.
pub(super) fn patience(access: &AccessArgs) -> Patience {
    let told = |error: &send::SendError| console::tell(format_args!("{error}: trying again"));
    Patience {
        retry: Duration::from_secs(access.retry.into()),
        silence: access.host_timeout,
        told,
        ..Patience::default()
    }
}

/// What a printer does, in a line.
pub(super) fn line(state: &HostState) -> String {
    let print = &state.printing;
    let mut words = vec![state.activity.name().to_owned()];
    let is_running = matches!(state.activity, Activity::Printing | Activity::Paused);
    if let (Some(file), true) = (&print.file, is_running) {
        words.push(file.clone());
    }
    if let (Some(progress), true) = (print.progress, is_running) {
        words.push(format!("{:.0} %", progress * 100.0));
    }
    if let (Some(layer), true) = (print.layer, is_running) {
        words.push(match print.layers {
            Some(layers) => format!("layer {layer} of {layers}"),
            None => format!("layer {layer}"),
        });
    }
    if let (Some(left), true) = (print.left_s, is_running) {
        words.push(format!("{} left", duration(left)));
    }
    words.join(", ")
}

fn duration(seconds: f64) -> String {
    let minutes = (seconds / 60.0).ceil() as u64;
    if minutes < 60 {
        format!("{minutes} min")
    } else {
        format!("{} h {:02} min", minutes / 60, minutes % 60)
    }
}
