//! The file of hosts: TOML, one table for each.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::entry::{HostEntry, HostKind, KeySource, Secret};
use crate::near;

/// All hosts of a user.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hosts {
    /// The file; it need not be there.
    pub path: PathBuf,
    /// In the order of their names.
    pub entries: Vec<HostEntry>,
}

/// The file of hosts makes no sense, or a host is not in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostsError(String);

impl fmt::Display for HostsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for HostsError {}

/// A table of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    kind: String,
    url: String,
    key: Option<String>,
    key_file: Option<PathBuf>,
    key_env: Option<String>,
    user: Option<String>,
    ca: Option<PathBuf>,
    printer: Option<String>,
    #[serde(default)]
    profile: Vec<String>,
    storage: Option<String>,
}

impl Hosts {
    /// The hosts of a file; none where there is no file.
    ///
    /// # Errors
    /// It cannot be read, or says what makes no sense: file, host and mend.
    pub fn read(path: &Path) -> Result<Self, HostsError> {
        let failed = |message: String| HostsError(format!("{}: {message}", path.display()));
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(failed(error.to_string())),
        };
        // The parser's own message would quote the line, and the line may be the key's.
        let tables: BTreeMap<String, toml::Value> = toml::from_str(&text).map_err(|error| {
            let line =
                error.span().map_or(0, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
            failed(format!("line {line}: {}", error.message()))
        })?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let entries = tables.into_iter().map(|(name, table)| {
            let named = |message: String| failed(format!("[\"{name}\"]: {message}"));
            let table: Table = table.try_into().map_err(|error: toml::de::Error| {
                named(format!("{}; a host has kind, url and possibly key, key_file, key_env, user, ca, printer, profile, storage", error.message()))
            })?;
            entry(&name, table, &folder).map_err(named)
        });
        Ok(Self { path: path.to_owned(), entries: entries.collect::<Result<_, _>>()? })
    }

    /// The host of a name.
    ///
    /// # Errors
    /// There is none: the names that are like it.
    pub fn find(&self, name: &str) -> Result<&HostEntry, HostsError> {
        if let Some(found) = self.entries.iter().find(|entry| entry.name == name) {
            return Ok(found);
        }
        let names = self.entries.iter().map(|entry| entry.name.as_str());
        let hint = match near::name(name, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "`pathwright hosts add` makes one, `hosts list` shows them".into(),
        };
        Err(HostsError(format!("there is no host `{name}` in {}; {hint}", self.path.display())))
    }

    /// Writes a host at the end of the file, which nobody else may read when it is new.
    ///
    /// # Errors
    /// There is a host of that name, or the file cannot be written.
    pub fn add(&self, entry: &HostEntry) -> Result<(), HostsError> {
        let failed = |error: &dyn fmt::Display| HostsError(format!("{}: {error}", self.path.display()));
        if self.entries.iter().any(|known| known.name == entry.name) {
            return Err(failed(&format!(
                "there is a host `{}` already; change it there, or choose another name",
                entry.name
            )));
        }
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(|error| failed(&error))?;
        }
        let mut options = fs::OpenOptions::new();
        options.append(true).create(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&self.path).map_err(|error| failed(&error))?;
        let text = fs::read_to_string(&self.path).map_err(|error| failed(&error))?;
        let gap = match text.as_str() {
            "" => "",
            text if text.ends_with('\n') => "\n",
            _ => "\n\n",
        };
        file.write_all((gap.to_owned() + &table(entry)).as_bytes()).map_err(|error| failed(&error))
    }
}

fn entry(name: &str, table: Table, folder: &Path) -> Result<HostEntry, String> {
    if name.is_empty() || name.chars().any(|c| c.is_control() || c.is_whitespace()) {
        return Err("the name of a host has no blanks".into());
    }
    let kind = HostKind::from_name(&table.kind).ok_or_else(|| {
        let kinds = HostKind::NAMES.join(", ");
        format!("kind = \"{}\" is unknown; there are {kinds}", table.kind)
    })?;
    let beside = |path: PathBuf| folder.join(path);
    let key = match (table.key, table.key_file, table.key_env) {
        (None, None, None) => KeySource::None,
        (Some(key), None, None) => KeySource::Given(Secret::new(&key)),
        (None, Some(file), None) => KeySource::File(beside(file)),
        (None, None, Some(variable)) => KeySource::Variable(variable),
        _ => return Err("one of key, key_file and key_env is expected, not several".into()),
    };
    Ok(HostEntry {
        key,
        user: table.user,
        ca: table.ca.map(beside),
        printer: table.printer,
        profile: table.profile,
        storage: table.storage,
        ..HostEntry::new(name, kind, &table.url)?
    })
}

/// A host as its table.
fn table(entry: &HostEntry) -> String {
    let text = |text: &str| toml::Value::from(text).to_string();
    let mut out =
        format!("[{}]\nkind = {}\nurl = {}\n", text(&entry.name), text(entry.kind.name()), text(&entry.url));
    let path = |path: &PathBuf| path.display().to_string();
    let key = match &entry.key {
        KeySource::None => None,
        KeySource::Given(secret) => Some(("key", secret.expose().to_owned())),
        KeySource::File(file) => Some(("key_file", path(file))),
        KeySource::Variable(name) => Some(("key_env", name.clone())),
    };
    let more = [
        key,
        entry.user.clone().map(|user| ("user", user)),
        entry.ca.as_ref().map(|ca| ("ca", path(ca))),
        entry.printer.clone().map(|printer| ("printer", printer)),
        entry.storage.clone().map(|storage| ("storage", storage)),
    ];
    for (name, value) in more.into_iter().flatten() {
        let _ = writeln!(out, "{name} = {}", text(&value));
    }
    if !entry.profile.is_empty() {
        let _ = writeln!(out, "profile = {}", toml::Value::from(entry.profile.clone()));
    }
    out
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    fn written(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hosts.toml");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    #[test]
    fn what_is_added_is_read_again_and_comments_stay() {
        let (_folder, path) =
            written("# mine\n[\"shop/mk4\"]\nkind = \"prusalink\"\nurl = \"10.0.0.5\" # no newline");
        let mut new = HostEntry::new("desk", HostKind::Moonraker, "https://voron.local").unwrap();
        new.key = KeySource::Given(Secret::new("a\"b"));
        new.profile = vec!["fast.toml".into()];
        new.printer = Some("Voron \"2.4\"".into());
        Hosts::read(&path).unwrap().add(&new).unwrap();
        let hosts = Hosts::read(&path).unwrap();
        assert_eq!(hosts.find("desk").unwrap(), &new);
        assert_eq!(hosts.find("shop/mk4").unwrap().url, "http://10.0.0.5");
        assert!(fs::read_to_string(&path).unwrap().starts_with("# mine\n"));
        assert!(hosts.add(&new).unwrap_err().to_string().contains("already"));
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_is_for_its_owner_alone() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/hosts.toml");
        let hosts = Hosts::read(&path).unwrap();
        hosts.add(&HostEntry::new("a", HostKind::Duet, "10.0.0.1").unwrap()).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
    }

    #[test]
    fn mistakes_name_the_file_the_host_and_the_mend_and_show_no_key() {
        for (text, wanted) in [
            ("[a]\nkind = \"repetier\"\nurl = \"x\"", "there are octoprint, moonraker, prusalink, duet"),
            ("[a]\nkind = \"duet\"", "missing field `url`"),
            ("[a]\nkind = \"duet\"\nurl = \"x\"\nkey = \"secret\"\nkey_env = \"K\"", "not several"),
            ("[a]\nkind = \"duet\"\nurl = \"x\"\napikey = \"secret\"", "unknown field `apikey`"),
            ("[a]\nkind = \"duet\"\nkey = \"secret", "line 3"),
        ] {
            let (_folder, path) = written(text);
            let error = Hosts::read(&path).unwrap_err().to_string();
            assert!(
                error.contains("hosts.toml") && error.contains(wanted) && !error.contains("secret"),
                "{error}"
            );
        }
        let (_folder, path) = written("[\"shop/mk4\"]\nkind = \"duet\"\nurl = \"x\"");
        let error = Hosts::read(&path).unwrap().find("shop/mk3").unwrap_err().to_string();
        assert!(error.contains("did you mean `shop/mk4`"), "{error}");
    }
}
