//! Whom an encrypted connection trusts.

use std::sync::Arc;

use ureq::tls::{Certificate, PemItem, RootCerts, TlsConfig, parse_pem};

use super::entry::HostEntry;

/// The system's authorities, and the user's own.
pub(super) fn tls(entry: &HostEntry) -> Result<TlsConfig, (String, &'static str)> {
    let system = rustls_native_certs::load_native_certs().certs;
    let mut roots: Vec<Certificate<'static>> =
        system.iter().map(|certificate| Certificate::from_der(certificate).to_owned()).collect();
    if let Some(path) = &entry.ca {
        let failed = |error: &dyn std::fmt::Display| {
            (format!("{}: {error}", path.display()), "a file with certificates as PEM is expected")
        };
        let pem = std::fs::read(path).map_err(|error| failed(&error))?;
        let before = roots.len();
        for item in parse_pem(&pem) {
            if let PemItem::Certificate(certificate) = item.map_err(|error| failed(&error))? {
                roots.push(certificate);
            }
        }
        if roots.len() == before {
            return Err(failed(&"there is no certificate in it"));
        }
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    Ok(TlsConfig::builder()
        .root_certs(RootCerts::from(roots))
        .unversioned_rustls_crypto_provider(provider)
        .build())
}
