//! RepRapFirmware's object model, which both of its interfaces give: <https://github.com/Duet3D/RepRapFirmware/wiki/Object-Model-Documentation>.

use serde_json::Value;

use super::host::{About, Activity, Ended, HostState, Printing, Volume};

/// Where both keep files to be printed.
pub(super) const FOLDER: &str = "0:/gcodes/";

/// The command that starts a file.
pub(super) fn start_command(file: &str) -> String {
    format!("M32 \"{FOLDER}{file}\"")
}

/// `boards`, `move` and `network` of the model.
pub(super) fn about(boards: &Value, movement: &Value, network: &Value, server: &str) -> About {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let board = &boards[0];
    let mut software = format!("{} {}", text(&board["firmwareName"]), text(&board["firmwareVersion"]));
    if !server.is_empty() {
        software = format!("{software}, {server}");
    }
    let axis = |letter: &str, end: &str| {
        movement["axes"].as_array()?.iter().find(|axis| axis["letter"] == letter)?[end].as_f64()
    };
    let corner = |end: &str| Some([axis("X", end)?, axis("Y", end)?, axis("Z", end)?]);
    let is_round = movement["kinematics"]["name"].as_str().is_some_and(|name| name.contains("delta"));
    About {
        software: software.trim().to_owned(),
        printer: network["name"].as_str().or_else(|| board["name"].as_str()).map(str::to_owned),
        nozzles_mm: Vec::new(),
        volume: corner("min").zip(corner("max")).map(|(low, high)| Volume { low, high, is_round }),
    }
}

/// Free space of the volume that files are kept on.
pub(super) fn free_bytes(volumes: &Value) -> Option<u64> {
    volumes[0]["freeSpace"].as_u64()
}

/// `state` and `job` of the model.
pub(super) fn state(state: &Value, job: &Value) -> HostState {
    let words = state["status"].as_str().unwrap_or("disconnected");
    let activity = match words {
        "idle" => Activity::Ready,
        "processing" | "simulating" | "resuming" => Activity::Printing,
        "paused" | "pausing" => Activity::Paused,
        "halted" | "off" => Activity::Error,
        "disconnected" => Activity::Offline,
        _ => Activity::Busy,
    };
    let number = |value: &Value| value.as_u64().and_then(|n| u32::try_from(n).ok());
    let current = job["file"]["fileName"].as_str().filter(|name| !name.is_empty());
    let last = job["lastFileName"].as_str().filter(|name| !name.is_empty());
    let is_running = matches!(activity, Activity::Printing | Activity::Paused | Activity::Busy);
    let name = if is_running { current } else { last };
    let ended = match (activity, last) {
        (Activity::Ready, Some(_)) if job["lastFileCancelled"] == true => Some(Ended::Cancelled),
        (Activity::Ready, Some(_)) if job["lastFileAborted"] == true => Some(Ended::Failed),
        (Activity::Ready, Some(_)) => Some(Ended::Done),
        (Activity::Error | Activity::Offline, _) => Some(Ended::Failed),
        _ => None,
    };
    let (at, size) = (job["filePosition"].as_f64(), job["file"]["size"].as_f64());
    let progress = match (ended, at, size) {
        (Some(Ended::Done), ..) => Some(1.0),
        (_, Some(at), Some(size)) if size > 0.0 && is_running => Some((at / size).min(1.0)),
        _ => None,
    };
    let left = &job["timesLeft"];
    HostState {
        activity,
        message: words.to_owned(),
        printing: Printing {
            file: name.map(|path| path.rsplit('/').next().unwrap_or(path).to_owned()),
            progress,
            layer: number(&job["layer"]),
            layers: number(&job["file"]["numLayers"]),
            passed_s: job["duration"].as_f64(),
            left_s: left["slicer"]
                .as_f64()
                .or_else(|| left["filament"].as_f64())
                .or_else(|| left["file"].as_f64()),
        },
        ended,
    }
}
