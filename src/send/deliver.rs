//! A file to a host, whole or not at all, and its start, once or not at all.

use std::time::Duration;

use super::error::{Cause, SendError, Step};
use super::host::{Activity, HostState, PrintHost, Stored};
use super::patience::Patience;
use super::payload::Payload;

/// How long a host may take until it prints what it was asked to start.
const STARTING: Duration = Duration::from_secs(20);
/// How often it is asked then.
const ASKED: Duration = Duration::from_millis(300);
/// Of the free space so much stays for the host's own files.
const SPARE_BYTES: u64 = 1 << 20;
/// Longest name, which all of their file systems take.
const LONGEST_NAME: usize = 200;

/// What was sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delivery {
    /// The name under which it is stored.
    pub name: String,
    /// Whether the host told that what it stored is what was sent.
    pub is_verified: bool,
    /// Whether the host has added to the file: all commands are there, in their order.
    pub is_altered: bool,
}

/// Sends a file under a name, with the patience of the host, and compares what is stored there.
///
/// `told` is told how many bytes are sent, and begins anew when the upload does.
///
/// # Errors
/// There is a file of that name and `replace` is false; it does not fit; or what a host answers.
pub fn deliver(
    host: &dyn PrintHost,
    payload: &Payload,
    name: &str,
    replace: bool,
    told: &mut dyn FnMut(u64),
) -> Result<Delivery, SendError> {
    let name = file_name(name);
    let before = host.stored(&name)?;
    if before.is_some() && !replace {
        let message = format!("there is a file {name} already");
        let advice = "--replace overwrites it, --as NAME calls this one otherwise";
        return Err(SendError::new(host.name(), Step::Look, Cause::Exists, message, advice));
    }
    space(host, payload, before.as_ref())?;
    let mut attempts = 0;
    let stored_name = host.patience().with(|| {
        attempts += 1;
        // An upload whose answer was lost may have arrived, unless what is there was there before.
        if attempts > 1
            && let Some(stored) = host.stored(&name)?
            && stored.matches(payload) == Some(true)
            && (before.is_none() || stored.sha1.is_some())
        {
            return Ok(name.clone());
        }
        // What a broken attempt of ours has left may be overwritten.
        host.upload(&name, payload, replace || attempts > 1, told)
    })?;
    let stored = host.patience().with(|| {
        let missing = || fail(host, "it does not have the file", "send it again").transient();
        host.stored(&stored_name)?.ok_or_else(missing)
    })?;
    match stored.matches(payload) {
        Some(false) if host.has_commands(&stored_name, payload)? => {
            Ok(Delivery { name: stored_name, is_verified: true, is_altered: true })
        }
        Some(false) => {
            let bytes = stored.bytes.map_or_else(|| "another file".into(), |bytes| format!("{bytes} bytes"));
            let message = format!("it has {bytes} of {}, or others; nothing was started", payload.bytes);
            Err(fail(host, &message, "send it again with --replace"))
        }
        told => Ok(Delivery { name: stored_name, is_verified: told == Some(true), is_altered: false }),
    }
}

fn fail(host: &dyn PrintHost, message: &str, advice: &str) -> SendError {
    SendError::new(host.name(), Step::Verify, Cause::Damaged, message, advice)
}

fn space(host: &dyn PrintHost, payload: &Payload, before: Option<&Stored>) -> Result<(), SendError> {
    let Some(free) = host.free_bytes()? else { return Ok(()) };
    // The old file stays until the new one is complete.
    let needed = payload.bytes + SPARE_BYTES;
    if free >= needed {
        return Ok(());
    }
    let old = if before.is_some() { " beside the old one" } else { "" };
    let message =
        format!("it has {} MB free, and the file needs {} MB{old}", free >> 20, needed.div_ceil(1 << 20));
    Err(SendError::new(host.name(), Step::Look, Cause::Space, message, "delete files there"))
}

/// A name that every host takes as it is: of letters, digits and a few signs.
fn file_name(name: &str) -> String {
    let safe: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "._-+".contains(c) { c } else { '_' }).collect();
    let safe = safe.trim_start_matches('.');
    let from = safe.len().saturating_sub(LONGEST_NAME);
    safe[from..].to_owned()
}

/// Starts a stored file: asks once, and only a printer that is ready. That it prints is seen from its state.
///
/// # Errors
/// It is not ready; it refuses; or whether it has started cannot be found out.
pub fn start(host: &dyn PrintHost, name: &str) -> Result<(), SendError> {
    host.patience().with(|| {
        let before = ready(host)?;
        match host.start(name) {
            // Nothing was asked yet.
            Err(error) if error.is_unsent => Err(error),
            // It may have been heard: it is not asked again.
            Err(error) if error.is_transient => started(host, name, &before, Some(error)).map_err(for_good),
            Err(error) => Err(for_good(error)),
            Ok(()) => started(host, name, &before, None).map_err(for_good),
        }
    })
}

fn for_good(error: SendError) -> SendError {
    SendError { is_transient: false, ..error }
}

/// The state of a printer that is ready; refuses any other.
fn ready(host: &dyn PrintHost) -> Result<HostState, SendError> {
    let state = host.state()?;
    let advice = match state.activity {
        Activity::Ready => return Ok(state),
        Activity::Printing | Activity::Busy => "the file is stored there; start it when the printer is ready",
        Activity::Paused => "the file is stored there; resume or cancel what is paused first",
        Activity::Error => "the file is stored there; mend the printer first",
        Activity::Offline => "the file is stored there; connect the host to its printer first",
    };
    let message =
        format!("the printer is {} ({}); nothing was started", state.activity.name(), state.message);
    Err(SendError::new(host.name(), Step::Start, Cause::NotReady, message, advice))
}

/// Waits until the file prints, or has since the state before.
fn started(
    host: &dyn PrintHost,
    name: &str,
    before: &HostState,
    lost: Option<SendError>,
) -> Result<(), SendError> {
    let Patience { clock, pause, .. } = host.patience();
    let begun = clock();
    let longest = STARTING.min(host.patience().silence.max(ASKED * 4));
    loop {
        let state = host.state().map_err(|error| unclear(host, name, &error.to_string()))?;
        if prints(&state, name, before) {
            return Ok(());
        }
        if clock() > begun + longest {
            let said = lost.map_or_else(
                || format!("it is {} ({})", state.activity.name(), state.message),
                |lost| lost.message,
            );
            return Err(unclear(host, name, &said));
        }
        pause(ASKED);
    }
}

/// Whether a file prints, or has begun and ended since the state before.
fn prints(state: &HostState, name: &str, before: &HostState) -> bool {
    // Where a host does not tell the name, it can be no other.
    let is_ours = state.printing.file.as_deref().is_none_or(|file| file == name);
    let is_running = matches!(state.activity, Activity::Printing | Activity::Paused);
    let is_over = |state: &HostState| state.printing.file.as_deref() == Some(name) && state.ended.is_some();
    // What was over before is an earlier print of that name.
    (is_ours && is_running) || (is_over(state) && !is_over(before))
}

fn unclear(host: &dyn PrintHost, name: &str, said: &str) -> SendError {
    let message = format!("whether {name} has started is not known: {said}");
    let advice = "look at the printer; nothing was asked twice";
    SendError::new(host.name(), Step::Start, Cause::Unclear, message, advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::send::host::{Ended, Printing};

    fn state(activity: Activity, file: &str, ended: Option<Ended>) -> HostState {
        let printing = Printing { file: Some(file.into()), ..Printing::default() };
        HostState { activity, message: String::new(), printing, ended }
    }

    #[test]
    fn a_print_that_was_over_before_is_not_the_one_just_started() {
        let over = |name| state(Activity::Ready, name, Some(Ended::Done));
        let running = state(Activity::Printing, "a.gcode", None);
        assert!(!prints(&over("a.gcode"), "a.gcode", &over("a.gcode")), "the earlier one");
        assert!(prints(&running, "a.gcode", &over("a.gcode")), "it prints");
        assert!(prints(&over("a.gcode"), "a.gcode", &over("b.gcode")), "it was short");
        assert!(!prints(&running, "b.gcode", &over("b.gcode")), "another prints");
    }

    #[test]
    fn names_are_those_that_every_host_takes() {
        assert_eq!(file_name("a part (2)/ü\"x.gcode"), "a_part__2____x.gcode");
        assert_eq!(file_name(".hidden.gcode"), "hidden.gcode");
        assert!(file_name(&("x".repeat(300) + ".gcode")).ends_with("x.gcode"));
    }
}
