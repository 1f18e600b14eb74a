//! PrusaLink, version 1 of its interface: <https://github.com/prusa3d/Prusa-Link-Web/blob/master/spec/openapi.yaml>.

use serde_json::Value;

use super::client::{Body, Client, Request, encoded};
use super::error::{Cause, SendError, Step};
use super::host::{About, Activity, Ended, HostState, PrintHost, Printing, Stored};
use super::patience::Patience;
use super::payload::Payload;

pub(super) struct PrusaLink {
    client: Client,
    /// The storage that the user names.
    storage: Option<String>,
}

impl PrusaLink {
    pub fn new(client: Client, storage: Option<String>) -> Self {
        Self { client, storage }
    }

    /// The path of the storage that files go to, and its free space.
    fn storage(&self) -> Result<(String, Option<u64>), SendError> {
        let listed = self.client.json(Step::Look, "/api/v1/storage")?;
        let storages: Vec<&Value> = listed["storage_list"].as_array().into_iter().flatten().collect();
        let path =
            |storage: &Value| storage["path"].as_str().unwrap_or_default().trim_matches('/').to_owned();
        let usable = |storage: &&&Value| storage["available"] == true && storage["read_only"] != true;
        let found = match &self.storage {
            Some(wanted) => storages.iter().find(|storage| path(storage) == wanted.trim_matches('/')),
            None => storages.iter().find(usable),
        };
        let names: Vec<String> = storages.iter().map(|storage| path(storage)).collect();
        let found = found.filter(|storage| usable(storage)).ok_or_else(|| {
            let message = format!("no storage can be written to (it has {})", names.join(", "));
            self.client.error(
                Step::Look,
                Cause::NotReady,
                message,
                "put a USB drive in, or name another `storage` in the file of hosts",
            )
        })?;
        Ok((path(found), found["free_space"].as_u64()))
    }

    fn path(&self, file: &str) -> Result<String, SendError> {
        Ok(format!("/api/v1/files/{}/{}", self.storage()?.0, encoded(file)))
    }
}

impl PrintHost for PrusaLink {
    fn name(&self) -> &str {
        &self.client.host
    }

    fn patience(&self) -> &Patience {
        &self.client.patience
    }

    fn about(&self) -> Result<About, SendError> {
        let version = self.client.json(Step::Ask, "/api/version")?;
        let info = self.client.json(Step::Ask, "/api/v1/info")?;
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let diameter = info["nozzle_diameter"].as_f64().or_else(|| version["nozzle_diameter"].as_f64());
        let printer = [&info["hostname"], &version["hostname"], &version["original"]];
        Ok(About {
            software: format!("{} {}", text(&version["text"]), text(&version["server"])).trim().to_owned(),
            printer: printer.iter().find_map(|name| name.as_str()).map(str::to_owned),
            nozzles_mm: diameter.into_iter().collect(),
            volume: None,
        })
    }

    fn state(&self) -> Result<HostState, SendError> {
        let status = self.client.json(Step::State, "/api/v1/status")?;
        // Without a job there is nothing to tell of it.
        let job = self.client.get(Step::State, "/api/v1/job")?;
        let job = if job.body.is_empty() { Value::Null } else { self.client.read(Step::State, &job)? };
        Ok(state(&status, &job))
    }

    fn free_bytes(&self) -> Result<Option<u64>, SendError> {
        Ok(self.storage()?.1)
    }

    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError> {
        let Some(answer) = self.client.find(Step::Look, &self.path(file)?)? else { return Ok(None) };
        let found = self.client.read(Step::Look, &answer)?;
        Ok(Some(Stored { bytes: found["size"].as_u64(), sha1: None }))
    }

    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError> {
        let path = self.path(file)?;
        let mut source = self.client.opened(payload, told)?;
        let answer = self.client.once(Request {
            step: Step::Upload,
            method: "PUT",
            path,
            headers: vec![
                ("Overwrite", if replace { "?1" } else { "?0" }.to_owned()),
                ("Print-After-Upload", "?0".to_owned()),
            ],
            body: Body::Stream("text/x.gcode".into(), payload.bytes, &mut source),
        })?;
        if answer.status == 409 && !replace {
            return Err(self.client.exists(&answer, file));
        }
        self.client.checked(Step::Upload, answer)?;
        Ok(file.to_owned())
    }

    fn start(&self, file: &str) -> Result<(), SendError> {
        let answer = self.client.once(Request::post(Step::Start, self.path(file)?, Body::None))?;
        self.client.checked(Step::Start, answer).map(|_| ())
    }
}

fn state(status: &Value, job: &Value) -> HostState {
    let words = status["printer"]["state"].as_str().or_else(|| job["state"].as_str()).unwrap_or("unknown");
    let activity = match words {
        "IDLE" | "READY" | "FINISHED" | "STOPPED" => Activity::Ready,
        "PRINTING" => Activity::Printing,
        "PAUSED" => Activity::Paused,
        "ERROR" | "ATTENTION" => Activity::Error,
        _ => Activity::Busy,
    };
    let ended = match words {
        "FINISHED" => Some(Ended::Done),
        "STOPPED" => Some(Ended::Cancelled),
        "ERROR" => Some(Ended::Failed),
        _ => None,
    };
    let told = |name: &str| status["job"][name].as_f64().or_else(|| job[name].as_f64());
    let file = job["file"]["display_name"].as_str().or_else(|| job["file"]["name"].as_str());
    let reason = status["printer"]["status_printer"]["message"]
        .as_str()
        .filter(|text| !text.is_empty() && *text != "OK");
    HostState {
        activity,
        message: reason
            .map_or_else(|| words.to_lowercase(), |reason| format!("{}: {reason}", words.to_lowercase())),
        printing: Printing {
            file: file.map(str::to_owned),
            progress: told("progress").map(|percent| percent / 100.0),
            passed_s: told("time_printing"),
            left_s: told("time_remaining"),
            ..Printing::default()
        },
        ended,
    }
}
