//! Where Cura's files are: `definitions`, `extruders`, `variants`, `quality`, `materials` in its folder of resources, or in that of
//! a user.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use super::definition::Definition;
use super::instance::Instance;
use crate::presets::error::PresetError;
use crate::presets::files::Files;

/// Folders nest no deeper than this.
const DEEPEST: usize = 6;

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

type Lazy = OnceLock<Result<Vec<Instance>, PresetError>>;

/// All files of Cura's presets, by kind.
#[derive(Debug, Default)]
pub(super) struct Folder {
    files: Files,
    machines: BTreeMap<String, Machine>,
    extruders: BTreeMap<String, Machine>,
    nozzle_files: BTreeSet<PathBuf>,
    quality_files: BTreeSet<PathBuf>,
    material_files: BTreeSet<PathBuf>,
    nozzles: Lazy,
    qualities: Lazy,
    materials: Lazy,
}

/// Whether a file of that name, in small letters, may be a definition.
pub(in crate::presets) fn is_preset(name: &str) -> bool {
    name.ends_with(".def.json")
}

/// Whether a file of that name, in small letters, may be one of these.
pub(in crate::presets) fn is_file(name: &str) -> bool {
    is_preset(name) || [".xml.fdm_material", ".inst.cfg"].iter().any(|ending| name.ends_with(ending))
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
            } else if name.ends_with(".xml.fdm_material") {
                self.material_files.insert(path);
            } else if name.ends_with(".inst.cfg") {
                let is_nozzle = path.components().any(|part| part.as_os_str() == "variants");
                let is_quality = path.components().any(|part| part.as_os_str() == "quality");
                if is_nozzle {
                    self.nozzle_files.insert(path);
                } else if is_quality {
                    self.quality_files.insert(path);
                }
            } else if depth < DEEPEST && self.files.is_dir(&path) {
                self.walk(&path, depth + 1);
            }
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
        read(&self.files, &self.nozzles, &self.nozzle_files, Instance::read)
    }

    /// All qualities.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn qualities(&self) -> Result<&[Instance], PresetError> {
        read(&self.files, &self.qualities, &self.quality_files, Instance::read)
    }

    /// All materials.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn materials(&self) -> Result<&[Instance], PresetError> {
        read(&self.files, &self.materials, &self.material_files, Instance::read_material)
    }
}

fn read<'a>(
    from: &Files,
    lazy: &'a Lazy,
    files: &BTreeSet<PathBuf>,
    read: fn(&Files, &Path) -> Result<Instance, PresetError>,
) -> Result<&'a [Instance], PresetError> {
    let all = lazy.get_or_init(|| files.iter().map(|path| read(from, path)).collect());
    all.as_ref().map(Vec::as_slice).map_err(Clone::clone)
}
