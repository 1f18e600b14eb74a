//! A Duet with a single-board computer: `/machine`, <https://github.com/Duet3D/DuetSoftwareFramework/wiki/REST-API>.

use serde_json::Value;

use super::client::{Body, Client, Request, encoded};
use super::duet::{self, FOLDER};
use super::entry::Secret;
use super::error::{Cause, SendError, Step};
use super::host::{About, HostState, PrintHost, Stored};
use super::patience::Patience;
use super::payload::Payload;

pub(super) struct Computer {
    client: Client,
}

impl Computer {
    pub fn connect(client: Client, password: Option<Secret>) -> Result<Self, SendError> {
        let password = password.as_ref().map_or("", Secret::expose);
        let path = format!("/machine/connect?password={}", encoded(password));
        let told = client.json(Step::Ask, &path)?;
        if let Some(key) = told["sessionKey"].as_str() {
            client.set_header("X-Session-Key", Secret::new(key));
        }
        Ok(Self { client })
    }

    fn model(&self, step: Step) -> Result<Value, SendError> {
        self.client.json(step, "/machine/model")
    }

    fn path(file: &str) -> String {
        encoded(&format!("{FOLDER}{file}"))
    }
}

impl PrintHost for Computer {
    fn name(&self) -> &str {
        &self.client.host
    }

    fn patience(&self) -> &Patience {
        &self.client.patience
    }

    fn about(&self) -> Result<About, SendError> {
        let model = self.model(Step::Ask)?;
        let version =
            model["sbc"]["dsf"]["version"].as_str().or_else(|| model["state"]["dsfVersion"].as_str());
        let server = version.map(|version| format!("DuetSoftwareFramework {version}")).unwrap_or_default();
        Ok(duet::about(&model["boards"], &model["move"], &model["network"], &server))
    }

    fn state(&self) -> Result<HostState, SendError> {
        let model = self.model(Step::State)?;
        Ok(duet::state(&model["state"], &model["job"]))
    }

    fn free_bytes(&self) -> Result<Option<u64>, SendError> {
        Ok(duet::free_bytes(&self.model(Step::Look)?["volumes"]))
    }

    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError> {
        let path = format!("/machine/fileinfo/{}", Self::path(file));
        let Some(answer) = self.client.find(Step::Look, &path)? else { return Ok(None) };
        let found = self.client.read(Step::Look, &answer)?;
        Ok(Some(Stored { bytes: found["size"].as_u64(), sha1: None }))
    }

    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        _replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError> {
        let mut source = self.client.opened(payload, told)?;
        let answer = self.client.once(Request {
            step: Step::Upload,
            method: "PUT",
            path: format!("/machine/file/{}", Self::path(file)),
            headers: Vec::new(),
            body: Body::Stream("application/octet-stream".into(), payload.bytes, &mut source),
        })?;
        self.client.checked(Step::Upload, answer)?;
        Ok(file.to_owned())
    }

    fn start(&self, file: &str) -> Result<(), SendError> {
        let command = duet::start_command(file);
        let answer = self.client.once(Request::post(Step::Start, "/machine/code", Body::Text(&command)))?;
        let answer = self.client.checked(Step::Start, answer)?;
        let said = String::from_utf8_lossy(&answer.body).trim().to_owned();
        if said.starts_with("Error") {
            return Err(self.client.error(
                Step::Start,
                Cause::NotReady,
                format!("it answers: {said}"),
                "look at the printer",
            ));
        }
        Ok(())
    }
}
