//! What a connection that fails means.

use super::client::Client;
use super::error::{Cause, SendError, Step};

impl Client {
    /// What a connection that fails means.
    pub(super) fn broken(&self, step: Step, error: ureq::Error) -> SendError {
        use std::io::ErrorKind as Io;
        use ureq::{Error, Timeout};
        let fail = |cause, message: String, advice: &str| self.error(step, cause, message, advice);
        let unreachable = |message: &str, advice: &str, is_unsent: bool| SendError {
            is_unsent,
            ..fail(Cause::Unreachable, format!("{message} ({})", self.base), advice).transient()
        };
        let power = match self.base.starts_with("https:") {
            true => "is it on, and in this network, and are address and port right, and is it not http://?",
            false => "is it on, and in this network, and are address and port right?",
        };
        // The standard library has no kind for it.
        let is_name = |error: &std::io::Error| error.to_string().contains("failed to lookup address");
        let unknown = || SendError {
            is_transient: false,
            ..unreachable("its name is not known", "is the address right?", true)
        };
        let rustls = match &error {
            Error::Rustls(error) => Some(error),
            Error::Io(error) => error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()),
            _ => None,
        };
        if let Some(rustls) = rustls {
            return self.untrusted(step, rustls);
        }
        match error {
            Error::HostNotFound => unknown(),
            Error::Io(error) if is_name(&error) => unknown(),
            Error::ConnectionFailed => unreachable("no connection", power, true),
            Error::Timeout(Timeout::Resolve | Timeout::Connect) => {
                unreachable("no connection in time", power, true)
            }
            Error::Timeout(_) => unreachable(
                &format!("no answer within {} s", self.patience.silence.as_secs_f32()),
                "is it busy? --timeout waits longer",
                false,
            ),
            Error::Io(error) => match error.kind() {
                Io::ConnectionRefused => unreachable("nothing listens there", power, true),
                Io::HostUnreachable | Io::NetworkUnreachable => {
                    unreachable("there is no route to it", power, true)
                }
                Io::TimedOut | Io::WouldBlock => {
                    unreachable("no answer in time", "is it busy? --timeout waits longer", false)
                }
                Io::Other => fail(Cause::File, error.to_string(), "try again when nothing else writes it"),
                _ => unreachable(&format!("the connection broke: {error}"), power, false),
            },
            Error::Protocol(error) => {
                let message = format!("its answer is no HTTP ({error})");
                fail(Cause::Answer, message, "are its address and port right?").transient()
            }
            Error::BodyExceedsLimit(_) | Error::LargeResponseHeader(..) => {
                fail(Cause::Answer, "its answer is far too long".into(), "are its address and kind right?")
            }
            error => unreachable(&error.to_string(), power, false),
        }
    }

    /// What is wrong with an encrypted connection.
    fn untrusted(&self, step: Step, error: &rustls::Error) -> SendError {
        use rustls::CertificateError as Wrong;
        let (message, advice) = match error {
            rustls::Error::InvalidCertificate(wrong) => match wrong {
                Wrong::Expired | Wrong::ExpiredContext { .. } => (
                    "its certificate has expired".to_owned(),
                    "renew it on the host, or set this machine's clock",
                ),
                Wrong::NotValidYet | Wrong::NotValidYetContext { .. } => {
                    ("its certificate is not valid yet".to_owned(), "are the clocks of both machines right?")
                }
                Wrong::UnknownIssuer => (
                    "its certificate is signed by nobody that is trusted here".to_owned(),
                    "--ca FILE, or `ca` in the file of hosts, trusts its own authority",
                ),
                Wrong::NotValidForName | Wrong::NotValidForNameContext { .. } => (
                    "its certificate is for another name".to_owned(),
                    "write the name in the certificate as `url`",
                ),
                wrong => (format!("its certificate is not trusted: {wrong:?}"), "look at it with a browser"),
            },
            error => (
                format!("no encrypted connection: {error}"),
                "is it http:// and not https://, or another port?",
            ),
        };
        self.error(step, Cause::Certificate, message, advice)
    }
}
