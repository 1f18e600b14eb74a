//! OctoPrint: <https://docs.octoprint.org/en/master/api/>.

use std::io::BufReader;

use serde_json::{Value, json};

use super::altered;
use super::client::{Body, Client, Request, encoded};
use super::error::{Cause, SendError, Step};
use super::form::Form;
use super::host::{About, Activity, Ended, HostState, PrintHost, Printing, Stored, Volume};
use super::patience::Patience;
use super::payload::Payload;

pub(super) struct OctoPrint {
    client: Client,
}

impl OctoPrint {
    pub fn new(client: Client) -> Self {
        Self { client }
    }
}

impl PrintHost for OctoPrint {
    fn name(&self) -> &str {
        &self.client.host
    }

    fn patience(&self) -> &Patience {
        &self.client.patience
    }

    fn about(&self) -> Result<About, SendError> {
        let version = self.client.json(Step::Ask, "/api/version")?;
        let software = version["text"].as_str().unwrap_or("OctoPrint").to_owned();
        let profiles = self.client.json(Step::Ask, "/api/printerprofiles")?;
        let profiles = profiles["profiles"].as_object();
        let current = profiles.and_then(|all| {
            all.values()
                .find(|one| one["current"] == true)
                .or_else(|| all.values().find(|one| one["default"] == true))
        });
        let Some(current) = current else { return Ok(About { software, ..About::default() }) };
        let printer = current["model"].as_str().filter(|model| !model.is_empty()).map(str::to_owned);
        let nozzles_mm = current["extruder"]["nozzleDiameter"].as_f64().into_iter().collect();
        Ok(About { software, printer, nozzles_mm, volume: volume(&current["volume"]) })
    }

    fn state(&self) -> Result<HostState, SendError> {
        let job = self.client.json(Step::State, "/api/job")?;
        // 409: it is not connected to its printer, which the job's state says in words.
        let answer = self.client.patience.with(|| {
            let answer =
                self.client.once(Request::get(Step::State, "/api/printer?exclude=temperature,sd"))?;
            if answer.status == 409 { Ok(None) } else { self.client.checked(Step::State, answer).map(Some) }
        })?;
        let flags = match answer {
            Some(answer) => Some(self.client.read(Step::State, &answer)?["state"]["flags"].clone()),
            None => None,
        };
        Ok(state(&job, flags.as_ref()))
    }

    fn free_bytes(&self) -> Result<Option<u64>, SendError> {
        let files = self.client.json(Step::Look, "/api/files/local?recursive=false")?;
        Ok(files["free"].as_u64())
    }

    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError> {
        let path = format!("/api/files/local/{}", encoded(file));
        let Some(answer) = self.client.find(Step::Look, &path)? else { return Ok(None) };
        let found = self.client.read(Step::Look, &answer)?;
        let sha1 = found["hash"].as_str().filter(|hash| hash.len() == 40).map(str::to_owned);
        Ok(Some(Stored { bytes: found["size"].as_u64(), sha1 }))
    }

    /// Plug-ins that cancel objects or tell times have their marks written into it.
    fn has_commands(&self, file: &str, payload: &Payload) -> Result<bool, SendError> {
        let path = format!("/downloads/files/local/{}", encoded(file));
        self.client.read_all(Step::Verify, &path, &|stored| {
            let sent = BufReader::new(payload.raw()?);
            altered::has_commands(sent, BufReader::new(stored))
        })
    }

    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError> {
        let refuse = if replace { "false" } else { "true" };
        let form = Form::new(
            &[("select", "false"), ("print", "false"), ("noOverwrite", refuse)],
            file,
            &payload.sha256,
        );
        let answer = self.client.post_form(&form, "/api/files/local", payload, told)?;
        if answer.status == 409 {
            return Err(self.client.exists(&answer, file));
        }
        let answer = self.client.checked(Step::Upload, answer)?;
        let stored = self.client.read(Step::Upload, &answer)?;
        let path = stored["files"]["local"]["path"].as_str();
        path.map(str::to_owned).ok_or_else(|| {
            let message = "its answer does not say where the file is";
            self.client
                .error(Step::Upload, Cause::Answer, message, "is its kind the one in the file of hosts?")
                .transient()
        })
    }

    fn start(&self, file: &str) -> Result<(), SendError> {
        let path = format!("/api/files/local/{}", encoded(file));
        let command = json!({ "command": "select", "print": true });
        let answer = self.client.once(Request::post(Step::Start, path, Body::Json(&command)))?;
        self.client.checked(Step::Start, answer).map(|_| ())
    }
}

fn volume(volume: &Value) -> Option<Volume> {
    let [width, depth, height] = ["width", "depth", "height"].map(|side| volume[side].as_f64());
    let [width, depth, height] = [width?, depth?, height?];
    let corner = volume["origin"] != "center";
    let low = if corner { [0.0; 3] } else { [-width / 2.0, -depth / 2.0, 0.0] };
    let high = [low[0] + width, low[1] + depth, height];
    Some(Volume { low, high, is_round: volume["formFactor"] == "circular" })
}

/// What `/api/job` and the flags of `/api/printer` say; without flags it is not connected.
fn state(job: &Value, flags: Option<&Value>) -> HostState {
    let is = |flag: &str| flags.is_some_and(|flags| flags[flag] == true);
    let any = |names: &[&str]| names.iter().any(|name| is(name));
    let activity = match flags {
        None => Activity::Offline,
        Some(_) if any(&["cancelling", "finishing"]) => Activity::Busy,
        Some(_) if any(&["pausing", "paused"]) => Activity::Paused,
        Some(_) if any(&["printing", "resuming"]) => Activity::Printing,
        Some(_) if any(&["error"]) => Activity::Error,
        Some(_) if any(&["ready"]) => Activity::Ready,
        Some(_) if any(&["closedOrError"]) => Activity::Offline,
        Some(_) => Activity::Busy,
    };
    let progress = &job["progress"];
    let file = job["job"]["file"]["path"].as_str().or_else(|| job["job"]["file"]["name"].as_str());
    let completion = progress["completion"].as_f64();
    let words = job["state"].as_str().unwrap_or_default();
    // OctoPrint 2 takes the share from the printer, which may stop short of all.
    let is_whole = completion.is_some_and(|percent| percent >= 100.0)
        || progress["filepos"].as_u64().is_some_and(|at| Some(at) == job["job"]["file"]["size"].as_u64());
    let ended = match (activity, file) {
        (Activity::Ready, Some(_)) if is_whole => Some(Ended::Done),
        (Activity::Ready, Some(_)) => Some(Ended::Cancelled),
        (Activity::Error | Activity::Offline, Some(_)) => Some(Ended::Failed),
        _ => None,
    };
    let message = match job["error"].as_str() {
        Some(error) => format!("{words}: {error}"),
        None => words.to_owned(),
    };
    HostState {
        activity,
        message,
        printing: Printing {
            file: file.map(str::to_owned),
            progress: completion.map(|percent| percent / 100.0),
            passed_s: progress["printTime"].as_f64(),
            left_s: progress["printTimeLeft"].as_f64(),
            ..Printing::default()
        },
        ended,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_flags_say_what_it_does() {
        let job = json!({ "job": { "file": { "path": "a.gcode" } }, "progress": { "completion": 40.0 }, "state": "?" });
        for (flags, activity) in [
            (json!({ "ready": true, "operational": true }), Activity::Ready),
            (json!({ "printing": true }), Activity::Printing),
            (json!({ "printing": true, "cancelling": true }), Activity::Busy),
            (json!({ "printing": true, "pausing": true }), Activity::Paused),
            (json!({ "paused": true }), Activity::Paused),
            (json!({ "error": true, "closedOrError": true }), Activity::Error),
            (json!({ "closedOrError": true }), Activity::Offline),
            (json!({}), Activity::Busy),
        ] {
            assert_eq!(state(&job, Some(&flags)).activity, activity, "{flags}");
        }
        let of = |at: u64| json!({ "job": { "file": { "path": "a.gcode", "size": 10 } }, "progress": { "completion": 90.0, "filepos": at } });
        let ready = json!({ "ready": true });
        assert_eq!(state(&of(10), Some(&ready)).ended, Some(Ended::Done), "as OctoPrint 2 tells it");
        assert_eq!(state(&of(9), Some(&ready)).ended, Some(Ended::Cancelled));
        assert_eq!(state(&job, None).activity, Activity::Offline);
        assert_eq!(state(&job, Some(&json!({ "ready": true }))).ended, Some(Ended::Cancelled));
    }
}
