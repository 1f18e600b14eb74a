//! Where Cura's files are: `definitions`, `extruders`, `variants`, `quality`, `intent`, `materials` in its folder of resources or
//! that of a user; there also `machine_instances`, and changes in `definition_changes`, `quality_changes` and `user`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use super::definition::Definition;
use super::instance::{self, Instance};
use super::profile;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// Folders nest no deeper than this.
const DEEPEST: usize = 6;

/// Folders of containers of values.
const KNOWN: [&str; 6] = ["variants", "quality", "intent", "definition_changes", "quality_changes", "user"];

/// A definition of a machine or an extruder, read when it is asked for.
#[derive(Debug)]
pub(super) struct Machine {
    /// By which others name it: its file without endings.
    pub id: String,
    pub file: Arc<str>,
    path: PathBuf,
    files: Files,
    definition: OnceLock<Result<Definition, PresetError>>,
}

impl Machine {
    fn new(files: &Files, path: PathBuf) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let id = name.strip_suffix(".def.json").unwrap_or(&name).to_owned();
        let file = path.display().to_string().into();
        Self { id, file, path, files: files.clone(), definition: OnceLock::new() }
    }

    /// What it says itself.
    ///
    /// # Errors
    /// Its file cannot be read, or is damaged.
    pub fn definition(&self) -> Result<&Definition, PresetError> {
        self.definition
            .get_or_init(|| Definition::read(&self.files, &self.path))
            .as_ref()
            .map_err(Clone::clone)
    }

    /// Its name; that of its file if it cannot be read.
    pub fn name(&self) -> &str {
        self.definition().map_or(&self.id, |definition| &definition.name)
    }

    /// Whether it can be chosen, and is not there for others to inherit from alone. One that cannot be read can be chosen, so
    /// that the reason is told.
    pub fn is_visible(&self) -> bool {
        self.definition().map_or(true, |definition| {
            definition.about("visible").and_then(serde_json::Value::as_bool).unwrap_or(false)
        })
    }
}

/// All files of Cura's presets, by kind.
#[derive(Debug, Default)]
pub(super) struct Folder {
    files: Files,
    machines: BTreeMap<String, Machine>,
    extruders: BTreeMap<String, Machine>,
    nozzles: Instances,
    qualities: Instances,
    intents: Instances,
    materials: Instances,
    changes: Instances,
    stacks: Instances,
}

/// Containers of a kind, read when they are asked for.
#[derive(Debug, Default)]
struct Instances {
    /// In the order of the sources; of two of one name the first is taken.
    files: Vec<PathBuf>,
    read: OnceLock<Result<Vec<Instance>, PresetError>>,
}

impl Instances {
    /// All of them, each file as `read` makes of it.
    fn all(
        &self,
        files: &Files,
        read: fn(&Files, &Path) -> Result<Vec<Instance>, PresetError>,
    ) -> Result<&[Instance], PresetError> {
        let all = || -> Result<Vec<Instance>, PresetError> {
            let mut seen = BTreeSet::new();
            let once = self.files.iter().filter(|path| seen.insert(*path));
            let read: Vec<Vec<Instance>> = once.map(|path| read(files, path)).collect::<Result<_, _>>()?;
            Ok(read.into_iter().flatten().collect())
        };
        self.read.get_or_init(all).as_ref().map(Vec::as_slice).map_err(Clone::clone)
    }
}

/// Whether a file of that name, in small letters, may be a definition or an exported profile.
pub(in crate::presets) fn is_preset(name: &str) -> bool {
    name.ends_with(".def.json") || name.ends_with(profile::ENDING)
}

/// Whether a file of that name, in small letters, may be one of these.
pub(in crate::presets) fn is_file(name: &str) -> bool {
    is_preset(name) || instance::ENDINGS.iter().any(|ending| name.ends_with(ending))
}

impl Folder {
    /// An empty one, for files from there.
    pub fn of(files: &Files) -> Self {
        Self { files: files.clone(), ..Self::default() }
    }

    /// Adds a folder, or a file among its like.
    pub fn add(&mut self, path: &Path) {
        if self.files.is_dir(path) {
            self.walk(path, 0);
        } else if is_profile(path) {
            self.changes.files.push(path.to_owned());
        } else if let Some(resources) = path.parent().and_then(Path::parent) {
            // A definition needs those that it inherits from, and what is beside them.
            self.walk(resources, 0);
        }
    }

    fn walk(&mut self, folder: &Path, depth: usize) {
        let parent = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for path in self.files.entries(folder) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if name.ends_with(".def.json") {
                let machine = Machine::new(&self.files, path);
                let is_extruder = parent == "extruders" || machine.id == "fdmextruder";
                let all = if is_extruder { &mut self.extruders } else { &mut self.machines };
                all.entry(machine.id.clone()).or_insert(machine);
            } else if let Some(instances) = self.of_file(&path) {
                instances.files.push(path);
            } else if depth < DEEPEST && self.files.is_dir(&path) {
                self.walk(&path, depth + 1);
            }
        }
    }

    /// Where a file of containers belongs: to what the innermost folder of a known name is for.
    fn of_file(&mut self, path: &Path) -> Option<&mut Instances> {
        let name = path.file_name()?.to_string_lossy();
        if is_profile(path) {
            return Some(&mut self.changes);
        }
        match *instance::ENDINGS.iter().find(|ending| name.ends_with(**ending))? {
            ".xml.fdm_material" => Some(&mut self.materials),
            ".inst.cfg" => {
                let folders = path.parent()?.iter().rev();
                let innermost =
                    folders.filter_map(|folder| folder.to_str()).find(|name| KNOWN.contains(name));
                Some(match innermost? {
                    "variants" => &mut self.nozzles,
                    "quality" => &mut self.qualities,
                    "intent" => &mut self.intents,
                    _ => &mut self.changes,
                })
            }
            _ => Some(&mut self.stacks),
        }
    }

    /// All definitions of machines.
    pub fn machines(&self) -> impl Iterator<Item = &Machine> {
        self.machines.values()
    }

    /// A machine by what others name it.
    pub fn machine(&self, id: &str) -> Option<&Machine> {
        self.machines.get(id)
    }

    /// An extruder by what others name it.
    pub fn extruder(&self, id: &str) -> Option<&Machine> {
        self.extruders.get(id)
    }

    /// All nozzles.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn nozzles(&self) -> Result<&[Instance], PresetError> {
        self.nozzles.all(&self.files, Instance::read)
    }

    /// All qualities.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn qualities(&self) -> Result<&[Instance], PresetError> {
        self.qualities.all(&self.files, Instance::read)
    }

    /// All intents: what vendors change of a quality for a purpose.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn intents(&self) -> Result<&[Instance], PresetError> {
        self.intents.all(&self.files, Instance::read)
    }

    /// All materials.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn materials(&self) -> Result<&[Instance], PresetError> {
        self.materials.all(&self.files, Instance::read_material)
    }

    /// All that users have changed: of machines, of qualities, and since.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn changes(&self) -> Result<&[Instance], PresetError> {
        self.changes.all(&self.files, profile::read)
    }

    /// All stacks of containers: of machines that users have added, and of their extruders.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn stacks(&self) -> Result<&[Instance], PresetError> {
        self.stacks.all(&self.files, Instance::read)
    }
}

fn is_profile(path: &Path) -> bool {
    path.to_string_lossy().to_ascii_lowercase().ends_with(profile::ENDING)
}
