//! Reads profiles as written, ours and those of other slicers, and flattens what they inherit into assignments, parents first.

use std::io::Read;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::embedded::{self, EMBEDDED, EmbeddedProfile};
use super::error::{Origin, Problem};
use super::import::{self, Import};
use super::metadata;
use super::tools;
use crate::gcode::is_gcode;
use crate::limits;
use crate::near;
use crate::presets::{Config, is_foreign};

/// One `key = value`, and where it was written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Assignment {
    /// Dotted.
    pub key: String,
    pub value: Value,
    pub origin: Origin,
}

/// Collects assignments from profiles in the order in which they take effect.
#[derive(Default)]
pub(super) struct Reader {
    pub assignments: Vec<Assignment>,
    pub problems: Vec<Problem>,
    /// Notes about the profiles read.
    pub notes: Vec<Problem>,
    /// The profiles being read, outermost first, to notice one that inherits itself.
    open: Vec<Found>,
    /// Profiles read so far.
    count: usize,
    too_many: bool,
    /// Whether profiles are embedded ones alone.
    no_files: bool,
}

impl Reader {
    /// Reads a profile given on the command line: an embedded profile's name or a file's path.
    pub fn read(&mut self, name_or_path: &str, option: &'static str) {
        self.read_from(name_or_path, Path::new(""), &Origin::Option(option));
    }

    /// Reads an embedded profile; a file is never looked for.
    pub fn embedded(&mut self, name: &str) {
        let files = std::mem::replace(&mut self.no_files, true);
        self.read_from(name, Path::new(""), &Origin::Project);
        self.no_files = files;
    }

    /// Reads a project's profile, which inherits embedded profiles alone.
    pub fn text(&mut self, text: &str) {
        if text.len() as u64 > limits::PROFILE_BYTES {
            let most = limits::PROFILE_BYTES >> 20;
            return self.problem(&Origin::Project, format!("its profile is larger than {most} MB"));
        }
        let files = std::mem::replace(&mut self.no_files, true);
        match parsed(text) {
            Ok(table) => self.flatten(table, &Origin::Project, Path::new("")),
            Err(message) => {
                self.problem(&Origin::Project, format!("its profile is not valid TOML: {message}"));
            }
        }
        self.no_files = files;
    }

    /// `folder`: what relative paths start from; `asker`: who named the profile.
    fn read_from(&mut self, name_or_path: &str, folder: &Path, asker: &Origin) {
        if let Some(path) = foreign(name_or_path, folder).filter(|_| !self.no_files) {
            return self.import(&path);
        }
        let found = match self.no_files {
            true => embedded(name_or_path).ok_or_else(|| unknown_profile(name_or_path, "")),
            false => locate(name_or_path, folder),
        };
        let found = match found {
            Ok(found) => found,
            Err(message) => return self.problem(asker, message),
        };
        if matches!(asker, Origin::File(_)) && !found.stays_in(folder) {
            let message = format!(
                "inherits `{name_or_path}`, which is not in this profile's folder; name it with --profile"
            );
            return self.problem(asker, message);
        }
        self.count += 1;
        if self.count > limits::PROFILES || self.open.len() >= limits::PROFILE_DEPTH {
            if !std::mem::replace(&mut self.too_many, true) {
                let (most, depth) = (limits::PROFILES, limits::PROFILE_DEPTH);
                let message = format!("too many profiles: at most {most}, {depth} in a row");
                self.problem(asker, message);
            }
            return;
        }
        if let Some(first) = self.open.iter().position(|open| open.identity == found.identity) {
            let circle: Vec<String> =
                self.open[first..].iter().chain([&found]).map(|profile| profile.origin.to_string()).collect();
            return self.problem(asker, format!("profiles inherit in a circle: {}", circle.join(" → ")));
        }
        match found.text.table() {
            Ok(table) => {
                let (origin, folder) = (found.origin.clone(), found.folder.clone());
                self.open.push(found);
                self.flatten(table, &origin, &folder);
                self.open.pop();
            }
            Err(message) => self.problem(&found.origin, format!("is not valid TOML: {message}")),
        }
    }

    /// Reads a configuration of another slicer.
    fn import(&mut self, path: &Path) {
        let name = path.display().to_string();
        let origin = Origin::File(name.clone());
        match Import::read(path) {
            Ok(import) => {
                let note = import.summary(&format!("pathwright profiles show {name}"));
                self.notes.extend(note.map(|message| Problem { origin, setting: None, message }));
                self.take(import);
            }
            Err(message) => self.problem(&origin, message),
        }
    }

    /// Takes over what presets of another slicer, resolved by a library of them, come to.
    pub fn presets(&mut self, config: &Config) {
        self.take(Import::of(config));
    }

    fn take(&mut self, import: Import) {
        for taken in import.taken {
            self.assign(taken.key.to_owned(), taken.value, &Origin::Line(taken.place));
        }
        for (number, tool) in (1..).zip(import.tools) {
            self.assign(format!("tools.{number}"), Value::Table(Table::new()), &Origin::Variables);
            for taken in tool {
                self.assign(format!("tools.{number}.{}", taken.key), taken.value, &Origin::Line(taken.place));
            }
        }
        // After the settings, which take the place of variables that mean the same.
        for (name, value) in import.variables {
            self.assign(format!("variables.{name}"), value, &Origin::Variables);
        }
    }

    fn flatten(&mut self, mut table: Table, origin: &Origin, folder: &Path) {
        match table.remove("inherits").map(parents) {
            Some(Some(parents)) => {
                for parent in parents {
                    self.read_from(&parent, folder, origin);
                }
            }
            Some(None) => {
                self.problem(origin, "inherits: a profile's name, or a list of names, was expected".into());
            }
            None => {}
        }
        if let Some(description) = table.remove("description")
            && !description.is_str()
        {
            self.problem(origin, "description: a text in quotes was expected".into());
        }
        let tools = table.remove("tools").map(tools::flattened).unwrap_or_default();
        // Last, for a setting takes the place of variables that mean the same.
        let variables = table.remove_entry("variables");
        for (section, value) in table.into_iter().chain(variables) {
            match value {
                Value::Table(keys) => {
                    for (key, value) in keys {
                        self.assign([&section, ".", &key].concat(), value, origin);
                    }
                }
                value => self.assign(section, value, origin),
            }
        }
        for (key, value) in tools {
            match key.strip_suffix(".profile").zip(parents(value.clone())) {
                Some((tool, profiles)) => self.tool_profiles(tool, &profiles, folder, origin),
                None => self.assign(key, value, origin),
            }
        }
    }

    /// Takes over what profiles say that a tool may have of its own; `tool` is what its keys begin with.
    fn tool_profiles(&mut self, tool: &str, profiles: &[String], folder: &Path, origin: &Origin) {
        let first = self.assignments.len();
        for profile in profiles {
            self.read_from(profile, folder, origin);
        }
        let read = self.assignments.split_off(first);
        let own = read.into_iter().filter(|assignment| tools::may_differ(&assignment.key));
        self.assignments.extend(
            own.map(|assignment| Assignment { key: format!("{tool}.{}", assignment.key), ..assignment }),
        );
    }

    fn assign(&mut self, key: String, value: Value, origin: &Origin) {
        self.assignments.push(Assignment { key, value, origin: origin.clone() });
    }

    fn problem(&mut self, origin: &Origin, message: String) {
        self.problems.push(Problem { origin: origin.clone(), setting: None, message });
    }
}

fn parents(value: Value) -> Option<Vec<String>> {
    match value {
        Value::String(name) => Some(vec![name]),
        Value::Array(names) => names.into_iter().map(|n| n.as_str().map(str::to_owned)).collect(),
        _ => None,
    }
}

/// A profile as it was found.
struct Found {
    /// As the user named it.
    origin: Origin,
    /// The same however it is named.
    identity: PathBuf,
    text: Text,
    /// What its own relative paths start from.
    folder: PathBuf,
}

enum Text {
    Embedded(&'static EmbeddedProfile),
    File(String),
}

impl Text {
    fn table(&self) -> Result<Table, String> {
        match self {
            Self::Embedded(profile) => Ok(profile.table()),
            Self::File(text) => parsed(text),
        }
    }
}

impl Found {
    fn of_file(path: &Path, text: String) -> Self {
        Self {
            origin: Origin::File(path.display().to_string()),
            identity: path.canonicalize().unwrap_or_else(|_| path.to_owned()),
            text: Text::File(text),
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
        }
    }

    /// Whether it is an embedded profile or a file in a folder or below, links followed.
    fn stays_in(&self, folder: &Path) -> bool {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        matches!(self.origin, Origin::Embedded(_))
            || folder.canonicalize().is_ok_and(|folder| self.identity.starts_with(folder))
    }
}

/// An embedded profile.
fn embedded(name: &str) -> Option<Found> {
    embedded::find(name).map(|profile| Found {
        origin: Origin::Embedded(profile.name.into()),
        identity: profile.name.into(),
        text: Text::Embedded(profile),
        folder: PathBuf::new(),
    })
}

/// An embedded name wins over a file of that name; `./name` always means the file.
fn locate(name_or_path: &str, folder: &Path) -> Result<Found, String> {
    if let Some(profile) = embedded(name_or_path) {
        return Ok(profile);
    }
    let path = folder.join(name_or_path);
    if let Some(text) = told(&path) {
        return Ok(Found::of_file(&path, text));
    }
    let looks_like_path = name_or_path.contains(['/', '\\']) || name_or_path.ends_with(".toml");
    if !looks_like_path && !path.exists() {
        return Err(unknown_profile(name_or_path, "; or the path of a file"));
    }
    let failed = |error: std::io::Error| format!("cannot read profile `{}`: {error}", path.display());
    let mut text = String::new();
    let file = std::fs::File::open(&path).map_err(failed)?;
    file.take(limits::PROFILE_BYTES + 1).read_to_string(&mut text).map_err(failed)?;
    if text.len() as u64 > limits::PROFILE_BYTES {
        return Err(format!(
            "profile `{}` is larger than {} MB",
            path.display(),
            limits::PROFILE_BYTES >> 20
        ));
    }
    Ok(Found::of_file(&path, text))
}

/// The settings in G-code of ours. What cannot be read is reported where it is read as another slicer's.
fn told(path: &Path) -> Option<String> {
    is_gcode(path).then(|| metadata::told(path).ok().flatten()).flatten()
}

/// The path of a configuration of another slicer, if that is meant.
fn foreign(name_or_path: &str, folder: &Path) -> Option<PathBuf> {
    let path = folder.join(name_or_path);
    let is_foreign = embedded::find(name_or_path).is_none() && is_foreign(&path);
    (is_foreign && told(&path).is_none()).then_some(path)
}

/// Text of a profile as written, by name or path; a configuration of another slicer as a profile of ours.
///
/// # Errors
/// A message that names the known profiles, or says why the file cannot be read.
pub fn text(name_or_path: &str) -> Result<String, String> {
    if let Some(path) = foreign(name_or_path, Path::new("")) {
        let import = Import::read(&path).map_err(|message| format!("{name_or_path}: {message}"))?;
        return Ok(import::as_profile(name_or_path, &import));
    }
    locate(name_or_path, Path::new("")).map(|found| match found.text {
        Text::Embedded(profile) => profile.text.to_owned(),
        Text::File(text) => text,
    })
}

/// The text of another slicer's configuration (`.ini`) as a profile of ours; `name`: what it is called.
///
/// # Errors
/// It holds no configuration, or several presets of one kind.
pub fn converted(name: &str, ini: &str) -> Result<String, String> {
    let lines: Vec<String> = ini.lines().map(str::to_owned).collect();
    let config = Config::parse(&lines).map_err(|problem| format!("{name}: {problem}"))?;
    Ok(import::as_profile(name, &Import::of(&config)))
}

/// `or`: what else would do.
fn unknown_profile(name: &str, or: &str) -> String {
    let names = EMBEDDED.iter().map(|profile| profile.name);
    let hint = near::name(name, names.clone()).map(|near| format!("; did you mean `{near}`?"));
    format!(
        "no profile `{name}`{} Known: {}{or}",
        hint.unwrap_or_else(|| ".".into()),
        names.collect::<Vec<_>>().join(", ")
    )
}

/// Errors: the parser's message without its drawing of the source, led by the line.
fn parsed(text: &str) -> Result<Table, String> {
    text.parse().map_err(|error| one_line(&error, text))
}

fn one_line(error: &toml::de::Error, text: &str) -> String {
    let message = error.message().replace('\n', ", ");
    match error.span() {
        Some(span) => {
            let line = 1 + text.as_bytes().iter().take(span.start).filter(|b| **b == b'\n').count();
            format!("line {line}: {message}")
        }
        None => message,
    }
}
