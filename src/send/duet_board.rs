//! A Duet board by itself: `rr_…`, <https://github.com/Duet3D/RepRapFirmware/wiki/HTTP-requests>.

use serde_json::Value;

use super::client::{Body, Client, Request, encoded};
use super::duet::{self, FOLDER};
use super::entry::Secret;
use super::error::{Cause, SendError, Step};
use super::host::{About, HostState, PrintHost, Stored};
use super::patience::Patience;
use super::payload::Payload;

/// Where nobody set a password.
const DEFAULT_PASSWORD: &str = "reprap";

pub(super) struct Board {
    client: Client,
    password: Secret,
}

impl Board {
    /// Logs in; the client again where there is no such interface.
    pub fn connect(client: Client, password: Option<Secret>) -> Result<Result<Self, Client>, SendError> {
        let board = Self { client, password: password.unwrap_or_else(|| Secret::new(DEFAULT_PASSWORD)) };
        Ok(if board.log_in(Step::Ask)? { Ok(board) } else { Err(board.client) })
    }

    /// Whether there is something to log in to.
    fn log_in(&self, step: Step) -> Result<bool, SendError> {
        let path = format!("/rr_connect?password={}&sessionKey=yes", encoded(self.password.expose()));
        let Some(answer) = self.client.find(step, &path)? else { return Ok(false) };
        let told = self.client.read(step, &answer)?;
        let fail = |message: &str, advice: &str| Err(self.client.error(step, Cause::Key, message, advice));
        match told["err"].as_i64() {
            Some(1) => {
                return fail(
                    "it answers that the password is wrong",
                    "the key of the host is its password (M551)",
                );
            }
            Some(2) => {
                return fail("it answers that too many are logged in", "close pages of Duet Web Control");
            }
            _ => {}
        }
        if let Some(key) = told["sessionKey"].as_u64() {
            self.client.set_header("X-Session-Key", Secret::new(&key.to_string()));
        }
        Ok(true)
    }

    /// Gets JSON; logs in again where the session is over.
    fn json(&self, step: Step, path: &str) -> Result<Value, SendError> {
        match self.client.json(step, path) {
            Err(error) if error.cause == Cause::Key => {
                self.log_in(step)?;
                self.client.json(step, path)
            }
            done => done,
        }
    }

    fn model(&self, step: Step, key: &str) -> Result<Value, SendError> {
        Ok(self.json(step, &format!("/rr_model?key={key}&flags=v"))?["result"].take())
    }
}

impl PrintHost for Board {
    fn name(&self) -> &str {
        &self.client.host
    }

    fn patience(&self) -> &Patience {
        &self.client.patience
    }

    fn about(&self) -> Result<About, SendError> {
        let [boards, movement, network] = ["boards", "move", "network"].map(|key| self.model(Step::Ask, key));
        Ok(duet::about(&boards?, &movement?, &network?, ""))
    }

    fn state(&self) -> Result<HostState, SendError> {
        Ok(duet::state(&self.model(Step::State, "state")?, &self.model(Step::State, "job")?))
    }

    fn free_bytes(&self) -> Result<Option<u64>, SendError> {
        Ok(duet::free_bytes(&self.model(Step::Look, "volumes")?))
    }

    fn stored(&self, file: &str) -> Result<Option<Stored>, SendError> {
        let path = format!("/rr_fileinfo?name={}", encoded(&format!("{FOLDER}{file}")));
        let found = self.json(Step::Look, &path)?;
        Ok((found["err"] == 0).then(|| Stored { bytes: found["size"].as_u64(), sha1: None }))
    }

    fn upload(
        &self,
        file: &str,
        payload: &Payload,
        _replace: bool,
        told: &mut dyn FnMut(u64),
    ) -> Result<String, SendError> {
        let name = encoded(&format!("{FOLDER}{file}"));
        let path = format!("/rr_upload?name={name}&crc32={:08x}", payload.crc32);
        let mut source = self.client.opened(payload, told)?;
        let body = Body::Stream("application/octet-stream".into(), payload.bytes, &mut source);
        let answer = self.client.once(Request::post(Step::Upload, path, body))?;
        if answer.status == 401 {
            self.log_in(Step::Upload)?;
            return Err(self.client.error(Step::Upload, Cause::Key, "the session was over", "").transient());
        }
        let answer = self.client.checked(Step::Upload, answer)?;
        let told = self.client.read(Step::Upload, &answer)?;
        if told["err"] != 0 {
            let message =
                format!("it answers {told}: what arrived is not what was sent, or cannot be stored");
            return Err(self
                .client
                .error(Step::Upload, Cause::Damaged, message, "has its card enough space?")
                .transient());
        }
        Ok(file.to_owned())
    }

    fn start(&self, file: &str) -> Result<(), SendError> {
        let path = format!("/rr_gcode?gcode={}", encoded(&duet::start_command(file)));
        let answer = self.client.once(Request::get(Step::Start, path))?;
        self.client.checked(Step::Start, answer).map(|_| ())
    }
}
