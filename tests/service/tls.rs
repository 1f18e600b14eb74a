//! A server with a certificate of its own. Needs curl; where there is none, these tests say so and do nothing.

use std::path::Path;
use std::process::{Command, Output};

use crate::server::{Server, program};

/// Writes a certificate for `localhost` and its key.
fn certificate(folder: &Path) -> [String; 2] {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let files = [("cert.pem", made.cert.pem()), ("key.pem", made.signing_key.serialize_pem())];
    files.map(|(name, text)| {
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    })
}

fn curl(arguments: &[&str]) -> Option<Output> {
    let done = Command::new("curl").args(["-sS", "--max-time", "20"]).args(arguments).output();
    if done.is_err() {
        eprintln!("curl is not installed: encryption was not tried");
    }
    done.ok()
}

#[test]
fn with_a_certificate_it_answers_whoever_trusts_it_and_nobody_in_the_clear() {
    let folder = tempfile::tempdir().unwrap();
    let [cert, key] = certificate(folder.path());
    let server = Server::with(&["--tls-cert", &cert, "--tls-key", &key]);
    let port = server.address.port();
    let address = format!("https://localhost:{port}/healthz");
    let Some(trusting) = curl(&["--cacert", &cert, &address]) else { return };
    assert!(String::from_utf8_lossy(&trusting.stdout).contains("\"ok\""), "{trusting:?}");
    // 60: the certificate is not known to curl.
    assert_eq!(curl(&[&address]).unwrap().status.code(), Some(60));
    let plain = curl(&[&format!("http://localhost:{port}/healthz")]).unwrap();
    assert!(!String::from_utf8_lossy(&plain.stdout).contains("\"ok\""), "{plain:?}");
}

#[test]
fn a_certificate_that_is_none_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let [cert, key] = certificate(folder.path());
    std::fs::write(&cert, "no certificate").unwrap();
    let mut command = program();
    command.args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(folder.path().join("data"));
    let done = command.args(["--tls-cert", &cert, "--tls-key", &key]).output().unwrap();
    assert!(!done.status.success());
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(said.contains("cert.pem"), "{said}");
}
