//! Profiles and options → settings: later sources win, every value is checked, every problem is reported.

use std::collections::BTreeMap;

use rustc_hash::FxHashSet;
use toml::{Table, Value};

use super::conflicts;
use super::embedded;
use super::error::{Origin, Problem, ProfileError};
use super::script::setting_names;
use super::settings::Settings;
use super::source::{Assignment, Reader};
use super::tools;
use super::value::{check, shortened, shown, typed_value};
use crate::limits;
use crate::parallel;
use crate::presets::Config;

/// A setting given on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Dotted key.
    pub key: String,
    /// As typed: `3`, `15%`, `inner-first`, `[220, 220]`.
    pub value: String,
    /// The option it came by, such as `--set`.
    pub option: &'static str,
}

/// Where settings are taken from, one on top of the other.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Layer<'a> {
    /// Presets of another slicer.
    Presets(&'a Config),
    /// An embedded profile's name, or a file.
    Profile(&'a str),
    /// The name of an embedded profile, never a file.
    Embedded(&'a str),
    /// A project's profile, as TOML. It inherits embedded profiles alone.
    Text(&'a str),
    /// A project's setting: dotted key, and value as typed.
    Setting(&'a str, &'a str),
    /// A setting of the command line.
    Override(&'a Override),
}

/// The settings in force, and where each came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Valid, alone and together.
    pub settings: Settings,
    /// Dotted key → where the value in force was written. Holds every key.
    pub origins: BTreeMap<String, Origin>,
    /// What is allowed but unwise.
    pub warnings: Vec<Problem>,
}

/// Resolves the default profile, then `profiles` (names or paths) in turn, then `overrides` in turn.
///
/// # Errors
/// Every problem of every source at once (up to a hundred): unreadable or unknown profiles, circles of `inherits`, unknown
/// keys, values of the wrong type or out of range, and settings that contradict each other.
///
/// # Examples
/// ```
/// use pathwright::profile::resolve;
/// let resolved = resolve(&["petg".into()], &[])?;
/// assert_eq!(resolved.settings.filament.material, "PETG");
/// assert_eq!(resolved.origins["filament.material"].to_string(), "profile petg");
/// # Ok::<(), pathwright::profile::ProfileError>(())
/// ```
pub fn resolve(profiles: &[String], overrides: &[Override]) -> Result<Resolved, ProfileError> {
    let profiles = profiles.iter().map(|profile| Layer::Profile(profile));
    resolve_layers(profiles.chain(overrides.iter().map(Layer::Override)))
}

/// The same with presets of another slicer on the default profile, below all others.
///
/// # Errors
/// As [`resolve`].
pub fn resolve_presets(
    presets: &Config,
    profiles: &[String],
    overrides: &[Override],
) -> Result<Resolved, ProfileError> {
    let profiles = profiles.iter().map(|profile| Layer::Profile(profile));
    resolve_layers(
        [Layer::Presets(presets)].into_iter().chain(profiles).chain(overrides.iter().map(Layer::Override)),
    )
}

/// Resolves the default profile with layers on top, the later ones over the earlier ones.
///
/// # Errors
/// As [`resolve`].
pub(crate) fn resolve_layers<'a>(
    layers: impl IntoIterator<Item = Layer<'a>> + Send,
) -> Result<Resolved, ProfileError> {
    Assignments::read(layers).resolved()
}

/// What layers assign on top of the default profile, as it is written.
pub(crate) struct Assignments {
    default: Reader,
    own: Reader,
}

impl Assignments {
    /// Reads the layers, the later ones over the earlier ones.
    pub fn read<'a>(layers: impl IntoIterator<Item = Layer<'a>> + Send) -> Self {
        let default = [Layer::Embedded(embedded::DEFAULT)];
        let (own, default) = parallel::join(|| read_layers(layers), || read_layers(default));
        Self { default, own }
    }

    /// What they come to.
    ///
    /// # Errors
    /// As [`resolve`].
    pub fn resolved(self) -> Result<Resolved, ProfileError> {
        let Self { default, own } = self;
        // What has another value in the end need not be looked at.
        let others: FxHashSet<&str> =
            own.assignments.iter().map(|assignment| assignment.key.as_str()).collect();
        let is_kept = |assignment: &Assignment| !others.contains(assignment.key.as_str());
        let kept: Vec<Assignment> = default.assignments.into_iter().filter(is_kept).collect();
        let assignments = kept.into_iter().chain(own.assignments);
        let mut problems = [default.problems, own.problems].concat();
        let Assigned { settings, origins, warnings } =
            assigned(Settings::of_stages(), assignments, &mut problems);
        if problems.is_empty() {
            let warnings = own.notes.into_iter().chain(warnings).collect();
            Ok(Resolved { settings, origins, warnings })
        } else {
            Err(ProfileError { problems })
        }
    }
}

/// What layers assign.
fn read_layers<'a>(layers: impl IntoIterator<Item = Layer<'a>>) -> Reader {
    let mut reader = Reader::default();
    for layer in layers {
        let (key, value, origin) = match layer {
            Layer::Presets(presets) => {
                reader.presets(presets);
                continue;
            }
            Layer::Profile(profile) => {
                reader.read(profile, "--profile");
                continue;
            }
            Layer::Embedded(name) => {
                reader.embedded(name);
                continue;
            }
            Layer::Text(text) => {
                reader.text(text);
                continue;
            }
            Layer::Setting(key, value) => (key, value, Origin::Project),
            Layer::Override(Override { key, value, option }) => {
                (key.as_str(), value.as_str(), Origin::Option(option))
            }
        };
        reader.assignments.push(Assignment { key: key.to_owned(), value: typed_value(key, value), origin });
    }
    reader
}

/// Settings after assignments, with what they brought.
struct Assigned {
    settings: Settings,
    origins: BTreeMap<String, Origin>,
    warnings: Vec<Problem>,
}

/// Makes assignments in turn, and looks at the whole. Ends early where the list of problems is full.
fn assigned(
    settings: Settings,
    assignments: impl IntoIterator<Item = Assignment>,
    problems: &mut Vec<Problem>,
) -> Assigned {
    let mut table = Table::try_from(&settings).expect("settings are a table");
    // Of a setting that was written several times, the last place counts.
    let mut origins: Vec<(String, Origin)> = Vec::new();
    let mut refused = Vec::new();
    let mut has_variables = !settings.variables.is_empty();
    for Assignment { key, value, origin } in assignments {
        if problems.len() >= limits::PROFILE_PROBLEMS {
            let message = format!("only the first {} problems are listed", limits::PROFILE_PROBLEMS);
            problems.push(Problem { origin, setting: None, message });
            return Assigned { settings, origins: origins.into_iter().collect(), warnings: Vec::new() };
        }
        match check(&key, &value) {
            Ok(()) if key == "tools" => drop(table.remove("tools")),
            Ok(()) if key.starts_with(tools::TOOLS) => {
                if let Some(tool) = tools::number(&key) {
                    tools_up_to(&mut table, tool);
                } else if let Ok((tool, own)) = tools::split(&key) {
                    assign_to_tool(&mut table, tool, &own, value);
                    if has_variables {
                        forget_variables(&mut table, &own);
                    }
                    origins.push((format!("{}{}.{own}", tools::TOOLS, tool + 1), origin));
                }
            }
            Ok(()) => {
                if let Some((section, name)) = key.split_once('.')
                    && let Some(Value::Table(section)) = table.get_mut(section)
                {
                    section.insert(name.to_owned(), value);
                }
                has_variables |= key.starts_with("variables.");
                if has_variables {
                    forget_variables(&mut table, &key);
                }
                origins.push((key, origin));
            }
            Err(message) => {
                let setting = Some((shortened(&key), shown(&value)));
                problems.push(Problem { origin, setting, message });
                refused.push(key);
            }
        }
    }

    let settings = Settings::try_from(table).expect("every value was checked");
    let origins = origins.into_iter().collect();
    let found = conflicts::find(&settings, &origins);
    // A value that was refused leaves an older one in its place, which must not be blamed for a conflict.
    problems.extend(
        found
            .errors
            .into_iter()
            .filter(|c| !c.keys.iter().any(|k| refused.iter().any(|r| r == k)))
            .map(|c| c.problem),
    );
    Assigned { settings, origins, warnings: found.warnings }
}

/// The tables of at least so many tools, and one more.
fn tools_up_to(table: &mut Table, last: usize) -> &mut Vec<Value> {
    let tools = table.entry("tools").or_insert_with(|| Value::Array(Vec::new()));
    let Value::Array(tools) = tools else { unreachable!("tools are a list") };
    while tools.len() <= last {
        tools.push(Value::Table(Table::new()));
    }
    tools
}

/// Gives a tool a value of its own.
fn assign_to_tool(table: &mut Table, tool: usize, key: &str, value: Value) {
    let Some((section, name)) = key.split_once('.') else { return };
    let Value::Table(own) = &mut tools_up_to(table, tool)[tool] else { return };
    let section = own.entry(section).or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(section) = section {
        section.insert(name.to_owned(), value);
    }
}

/// Leaves out the variables that mean a setting which has a new value.
fn forget_variables(table: &mut Table, key: &str) {
    if let Some(Value::Table(variables)) = table.get_mut("variables") {
        for (name, _) in setting_names().filter(|(_, of)| *of == key) {
            variables.remove(name);
        }
    }
}

impl Settings {
    /// The default profile with others on top, each the name of an embedded one or a file (a profile, or another slicer's
    /// configuration).
    ///
    /// # Errors
    /// As [`resolve`].
    pub fn load(profiles: &[&str]) -> Result<Self, ProfileError> {
        let profiles: Vec<String> = profiles.iter().map(|&profile| profile.to_owned()).collect();
        resolve(&profiles, &[]).map(|resolved| resolved.settings)
    }

    /// The default profile with presets of another slicer on top, which a [`Library`](crate::presets::Library) resolved.
    ///
    /// # Errors
    /// Values that contradict each other.
    pub fn of_presets(presets: &Config) -> Result<Self, ProfileError> {
        resolve_presets(presets, &[], &[]).map(|resolved| resolved.settings)
    }

    /// The same with another value, written as on the command line: `15%`, `0.2`, `inner-first`, `[220, 220]`.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong type or out of range, settings that contradict each other.
    pub fn set(self, key: &str, value: &str) -> Result<Self, ProfileError> {
        self.set_all(&[(key, value)])
    }

    /// The same with another value; `None`: it is not allowed with the others.
    pub(super) fn with(&self, key: &str, value: Value) -> Option<Self> {
        let mut problems = Vec::new();
        let assignment = Assignment { key: key.to_owned(), value, origin: Origin::Project };
        let Assigned { settings, .. } = assigned(self.clone(), [assignment], &mut problems);
        problems.is_empty().then_some(settings)
    }

    /// The same with other values, of which each may only be allowed with the others.
    ///
    /// # Errors
    /// As [`Settings::set`], every problem at once.
    pub fn set_all(self, values: &[(&str, &str)]) -> Result<Self, ProfileError> {
        let assignments = values.iter().map(|&(key, typed)| Assignment {
            key: key.to_owned(),
            value: typed_value(key, typed),
            origin: Origin::Option("set"),
        });
        let mut problems = Vec::new();
        let Assigned { settings, .. } = assigned(self, assignments, &mut problems);
        if problems.is_empty() { Ok(settings) } else { Err(ProfileError { problems }) }
    }
}
