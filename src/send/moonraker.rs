//! Moonraker, in front of Klipper: <https://moonraker.readthedocs.io/en/latest/external_api/introduction/>.

use serde_json::Value;

use super::client::{Body, Client, Request, encoded};
use super::error::{Cause, SendError, Step};
use super::form::Form;
use super::host::{About, Activity, Ended, HostState, PrintHost, Printing, Stored, Volume};
use super::patience::Patience;
use super::payload::Payload;

const OBJECTS: &str = "/printer/objects/query?print_stats&virtual_sdcard&display_status&idle_timeout";

pub(super) struct Moonraker {
    client: Client,
}

impl Moonraker {
    pub fn new(client: Client) -> Self {
        Self { client }
    }

    fn result(&self, step: Step, path: &str) -> Result<Value, SendError> {
        Ok(self.client.json(step, path)?["result"].take())
    }
}

impl PrintHost for Moonraker {
    fn name(&self) -> &str {
        &self.client.host
    }

    fn patience(&self) -> &Patience {
        &self.client.patience
    }

    fn about(&self) -> Result<About, SendError> {
        let info = self.result(Step::Ask, "/server/info")?;
        let software = format!("Moonraker {}", info["moonraker_version"].as_str().unwrap_or_default());
        if info["klippy_state"] != "ready" {
            return Ok(About { software, ..About::default() });
        }
        let printer = self.result(Step::Ask, "/printer/info")?;
        let firmware = match printer["app"].as_str() {
            Some(app) if !app.is_empty() => app,
            _ => "Klipper",
        };
        let software =
            format!("{software}, {firmware} {}", printer["software_version"].as_str().unwrap_or_default());
        let objects = self.result(Step::Ask, "/printer/objects/query?configfile=settings&toolhead")?;
        let (settings, toolhead) =
            (&objects["status"]["configfile"]["settings"], &objects["status"]["toolhead"]);
        let extruders =
            settings.as_object().into_iter().flatten().filter(|(name, _)| name.starts_with("extruder"));
        let nozzles_mm = extruders.filter_map(|(_, extruder)| extruder["nozzle_diameter"].as_f64()).collect();
        Ok(About {
            software,
            printer: printer["hostname"].as_str().map(str::to_owned),
            nozzles_mm,
            volume: volume(toolhead, &settings["printer"]["kinematics"]),
        })
    }

    fn state(&self) -> Result<HostState, SendError> {
        let info = self.result(Step::State, "/server/info")?;
        let klippy = info["klippy_state"].as_str().unwrap_or("disconnected");
        if klippy != "ready" {
            // What Klipper says of itself, where it says anything.
            let told = self.result(Step::State, "/printer/info").ok();
            let said = told.and_then(|told| Some(told["state_message"].as_str()?.lines().next()?.to_owned()));
            let activity = match klippy {
                "startup" => Activity::Busy,
                "error" | "shutdown" => Activity::Error,
                _ => Activity::Offline,
            };
            let message =
                said.map_or_else(|| format!("Klipper is {klippy}"), |said| format!("{klippy}: {said}"));
            let ended = (activity != Activity::Busy).then_some(Ended::Failed);
            return Ok(HostState { activity, message, printing: Printing::default(), ended });
        }
        Ok(state(&self.result(Step::State, OBJECTS)?["status"]))
    }

    fn free_bytes(&self) -> Result<Option<u64>, SendError> {
        let folder = self.result(Step::Look, "/server/files/directory?path=gcodes")?;
        Ok(folder["disk_usage"]["free"].as_u64())
    }

    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError> {
        let folder = self.result(Step::Look, "/server/files/directory?path=gcodes")?;
        let files = folder["files"].as_array().into_iter().flatten();
        let found = files.into_iter().find(|found| found["filename"] == file);
        Ok(found.map(|found| Stored { bytes: found["size"].as_u64(), sha1: None }))
    }

    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        _replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError> {
        let fields = [("root", "gcodes"), ("print", "false"), ("checksum", payload.sha256.as_str())];
        let form = Form::new(&fields, file, &payload.sha256);
        let answer = self.client.post_form(&form, "/server/files/upload", payload, told)?;
        let refused = |cause, advice: &str| self.client.refused(Step::Upload, &answer, cause, advice);
        match answer.status {
            // Forbidden is what it says of a file that is being printed.
            403 => {
                return Err(refused(
                    Cause::NotReady,
                    "the file of this name is being printed; wait for its end, or use --as NAME",
                ));
            }
            422 => return Err(refused(Cause::Damaged, "the connection changes what is sent").transient()),
            _ => {}
        }
        let answer = self.client.checked(Step::Upload, answer)?;
        let stored = self.client.read(Step::Upload, &answer)?;
        let item = &stored.get("result").unwrap_or(&stored)["item"];
        item["path"].as_str().map(str::to_owned).ok_or_else(|| {
            let message = "its answer does not say where the file is";
            self.client
                .error(Step::Upload, Cause::Answer, message, "is its kind the one in the file of hosts?")
                .transient()
        })
    }

    fn start(&self, file: &str) -> Result<(), SendError> {
        let path = format!("/printer/print/start?filename={}", encoded(file));
        let answer = self.client.once(Request::post(Step::Start, path, Body::None))?;
        self.client.checked(Step::Start, answer).map(|_| ())
    }
}

fn volume(toolhead: &Value, kinematics: &Value) -> Option<Volume> {
    let corner = |name: &str| -> Option<[f64; 3]> {
        let values: Vec<f64> = toolhead[name].as_array()?.iter().take(3).filter_map(Value::as_f64).collect();
        values.try_into().ok()
    };
    let (low, high) = (corner("axis_minimum")?, corner("axis_maximum")?);
    let is_round = kinematics.as_str().is_some_and(|kinematics| kinematics.contains("delta"));
    ((0..3).all(|axis| low[axis] < high[axis])).then_some(Volume { low, high, is_round })
}

/// What Klipper's objects say.
fn state(objects: &Value) -> HostState {
    let (stats, card) = (&objects["print_stats"], &objects["virtual_sdcard"]);
    let words = stats["state"].as_str().unwrap_or("standby");
    let ended = match words {
        "complete" => Some(Ended::Done),
        "cancelled" => Some(Ended::Cancelled),
        "error" => Some(Ended::Failed),
        _ => None,
    };
    let activity = match words {
        "printing" => Activity::Printing,
        "paused" => Activity::Paused,
        // Something else than a file is being done.
        _ if objects["idle_timeout"]["state"] == "Printing" => Activity::Busy,
        _ => Activity::Ready,
    };
    let number = |value: &Value| value.as_u64().and_then(|n| u32::try_from(n).ok());
    let progress = card["progress"].as_f64().or_else(|| objects["display_status"]["progress"].as_f64());
    let passed_s = stats["print_duration"].as_f64();
    let left_s = match (progress, passed_s) {
        (Some(share), Some(passed)) if share > 0.01 && ended.is_none() => {
            Some(passed * (1.0 - share) / share)
        }
        _ => None,
    };
    let message = match stats["message"].as_str() {
        Some(message) if !message.is_empty() => format!("{words}: {message}"),
        _ => words.to_owned(),
    };
    HostState {
        activity,
        message,
        printing: Printing {
            file: stats["filename"].as_str().filter(|name| !name.is_empty()).map(str::to_owned),
            progress: if ended == Some(Ended::Done) { Some(1.0) } else { progress },
            layer: number(&stats["info"]["current_layer"]),
            layers: number(&stats["info"]["total_layer"]),
            passed_s,
            left_s,
        },
        ended,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_print_is_followed_by_its_objects() {
        let mut objects = json!({
            "print_stats": {
                "state": "printing", "filename": "a.gcode", "print_duration": 30.0, "message": "",
                "info": { "current_layer": 3, "total_layer": 9 }
            },
            "virtual_sdcard": { "progress": 0.25 },
            "idle_timeout": { "state": "Printing" }
        });
        let seen = state(&objects);
        assert_eq!(
            (seen.activity, seen.printing.layer, seen.printing.left_s),
            (Activity::Printing, Some(3), Some(90.0))
        );
        objects["print_stats"]["state"] = "standby".into();
        assert_eq!(state(&objects).activity, Activity::Busy);
        objects["idle_timeout"]["state"] = "Idle".into();
        assert_eq!((state(&objects).activity, state(&objects).ended), (Activity::Ready, None));
        objects["print_stats"]["state"] = "complete".into();
        assert_eq!(
            (state(&objects).printing.progress, state(&objects).ended),
            (Some(1.0), Some(Ended::Done))
        );
    }
}
