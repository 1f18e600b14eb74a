//! What is known about a host: its kind, its address, and where its key is.

use std::fmt;
use std::path::PathBuf;

/// A key or password, which no message shows.
#[derive(Clone, PartialEq, Eq)]
pub struct Secret(String);

impl Secret {
    /// A secret without the blanks around it.
    pub fn new(text: &str) -> Self {
        Self(text.trim().to_owned())
    }

    pub(super) fn expose(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Secret(…)")
    }
}

/// The interface that a host speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostKind {
    /// OctoPrint, <https://docs.octoprint.org/en/master/api/>.
    OctoPrint,
    /// Moonraker in front of Klipper, <https://moonraker.readthedocs.io/>.
    Moonraker,
    /// PrusaLink, <https://github.com/prusa3d/Prusa-Link-Web/blob/master/spec/openapi.yaml>.
    PrusaLink,
    /// RepRapFirmware, alone (`rr_…`) or with a single-board computer (`/machine`), <https://github.com/Duet3D/RepRapFirmware/wiki/HTTP-requests>.
    Duet,
}

impl HostKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::OctoPrint, Self::Moonraker, Self::PrusaLink, Self::Duet];
    /// Their names.
    pub const NAMES: [&'static str; 4] = ["octoprint", "moonraker", "prusalink", "duet"];

    /// As it is written in the file of hosts.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// From its name, also as PrusaSlicer and OrcaSlicer call it in `host_type`.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "octoprint" => Some(Self::OctoPrint),
            // Both slicers offer `octoprint` for Klipper, too, which Moonraker understands to some extent.
            "moonraker" | "klipper" => Some(Self::Moonraker),
            "prusalink" => Some(Self::PrusaLink),
            "duet" | "repetier-duet" | "reprapfirmware" => Some(Self::Duet),
            _ => None,
        }
    }
}

/// Where a key is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KeySource {
    /// There is none: the host trusts this machine.
    None,
    /// In the file of hosts itself.
    Given(Secret),
    /// In a file of its own.
    File(PathBuf),
    /// In an environment variable.
    Variable(String),
}

impl KeySource {
    /// Where it is, not what it is.
    pub fn describe(&self) -> String {
        match self {
            Self::None => "none".into(),
            Self::Given(_) => "in the file of hosts".into(),
            Self::File(path) => format!("file {}", path.display()),
            Self::Variable(name) => format!("${name}"),
        }
    }

    /// The key.
    ///
    /// # Errors
    /// The file or the variable is not there or empty: what is wrong, and what to do.
    pub(super) fn read(&self) -> Result<Option<Secret>, (String, String)> {
        let secret = match self {
            Self::None => return Ok(None),
            Self::Given(secret) => secret.clone(),
            Self::File(path) => {
                let text = std::fs::read_to_string(path).map_err(|error| {
                    (format!("key file {}: {error}", path.display()), "write the key into it".to_owned())
                })?;
                Secret::new(text.lines().next().unwrap_or_default())
            }
            Self::Variable(name) => {
                let text = std::env::var(name)
                    .map_err(|_| (format!("${name} is not set"), "set it to the host's key".to_owned()))?;
                Secret::new(&text)
            }
        };
        if secret.expose().is_empty() || secret.expose().chars().any(|c| !(' '..='~').contains(&c)) {
            let place = self.describe();
            return Err((
                format!("the key ({place}) is empty or has characters that no key has"),
                "copy it again".into(),
            ));
        }
        Ok(Some(secret))
    }
}

/// A host by its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostEntry {
    /// How it is called here.
    pub name: String,
    /// The interface that it speaks.
    pub kind: HostKind,
    /// `http://address[:port][/folder]`, or `https://`.
    pub url: String,
    /// API key or password.
    pub key: KeySource,
    /// Who logs in with the password, where it is one (PrusaLink).
    pub user: Option<String>,
    /// Certificates (PEM) to be trusted besides the system's.
    pub ca: Option<PathBuf>,
    /// Printer preset that files are checked against.
    pub printer: Option<String>,
    /// Profiles that files are checked against.
    pub profile: Vec<String>,
    /// Where PrusaLink keeps files: `usb`, `local`, `sdcard`.
    pub storage: Option<String>,
}

impl HostEntry {
    /// A host without key.
    ///
    /// # Errors
    /// The address is none: what is expected.
    pub fn new(name: &str, kind: HostKind, url: &str) -> Result<Self, String> {
        Ok(Self {
            name: name.to_owned(),
            kind,
            url: address(url)?,
            key: KeySource::None,
            user: None,
            ca: None,
            printer: None,
            profile: Vec::new(),
            storage: None,
        })
    }
}

/// An address with its scheme and without a slash at its end.
fn address(text: &str) -> Result<String, String> {
    let text = text.trim();
    let wrong =
        || format!("`{text}` is no address; http://192.168.1.20 or https://printer.example:8443 is expected");
    let full = if text.contains("://") { text.to_owned() } else { format!("http://{text}") };
    let uri: http::Uri = full.parse().map_err(|_| wrong())?;
    if !matches!(uri.scheme_str(), Some("http" | "https")) || uri.host().is_none_or(str::is_empty) {
        return Err(wrong());
    }
    if uri.authority().is_some_and(|authority| authority.as_str().contains('@')) {
        return Err(format!(
            "the address of {} holds a password; give it as user and key instead",
            uri.host().unwrap_or_default()
        ));
    }
    if uri.query().is_some() {
        return Err(wrong());
    }
    Ok(full.trim_end_matches('/').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_secret_is_shown_by_no_debug_output() {
        let mut host = HostEntry::new("a", HostKind::OctoPrint, "10.0.0.1").unwrap();
        host.key = KeySource::Given(Secret::new("very-secret\n"));
        assert!(!format!("{host:?} {}", host.key.describe()).contains("very-secret"));
    }

    #[test]
    fn addresses_have_a_scheme_and_no_password() {
        for (typed, full) in [
            ("10.0.0.1", "http://10.0.0.1"),
            ("octopi.local:5000/", "http://octopi.local:5000"),
            ("https://a.example/printer/", "https://a.example/printer"),
            ("http://[::1]:7125", "http://[::1]:7125"),
        ] {
            assert_eq!(HostEntry::new("a", HostKind::Duet, typed).unwrap().url, full);
        }
        for wrong in ["", "ftp://a", "http://", "http://a/?key=1", "a b"] {
            assert!(
                HostEntry::new("a", HostKind::Duet, wrong).unwrap_err().contains("is no address"),
                "{wrong}"
            );
        }
        let error = HostEntry::new("a", HostKind::Duet, "http://me:secret@a").unwrap_err();
        assert!(error.contains("holds a password") && !error.contains("secret@"), "{error}");
    }

    #[test]
    fn kinds_have_the_names_of_other_slicers_as_well() {
        for kind in HostKind::ALL {
            assert_eq!(HostKind::from_name(kind.name()), Some(kind));
        }
        assert_eq!(HostKind::from_name("PrusaLink"), Some(HostKind::PrusaLink));
        assert_eq!(HostKind::from_name("flashair"), None);
    }
}
