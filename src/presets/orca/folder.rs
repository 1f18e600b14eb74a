//! Where the files of presets are: a vendor's index and the folder beside it, or folders of a user's own.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::json::File;
use crate::presets::config::Place;
use crate::presets::error::PresetError;
use crate::presets::family::Kind;
use crate::presets::files::Files;

/// How deep indices are looked for in a folder that a caller names.
const DEEPEST: usize = 4;

/// The lists of an index, and the folders of a user, by kind.
const KINDS: [(Kind, &str, &str); 3] = [
    (Kind::Printer, "machine_list", "machine"),
    (Kind::Print, "process_list", "process"),
    (Kind::Filament, "filament_list", "filament"),
];

/// The vendor whose filaments all others build on.
const LIBRARY: &str = "OrcaFilamentLibrary";

/// A preset, read when it is asked for.
#[derive(Debug)]
pub(super) struct Preset {
    pub name: String,
    path: PathBuf,
    files: Files,
    file: OnceLock<Result<File, PresetError>>,
}

impl Preset {
    fn new(files: &Files, name: String, path: PathBuf) -> Self {
        Self { name, path, files: files.clone(), file: OnceLock::new() }
    }

    /// What it says itself.
    ///
    /// # Errors
    /// Its file cannot be read, or is damaged.
    pub fn file(&self) -> Result<&File, PresetError> {
        let read = || File::read(&self.files, &as_spelled(&self.files, &self.path));
        self.file.get_or_init(read).as_ref().map_err(Clone::clone)
    }

    /// Where it begins.
    pub fn place(&self) -> Place {
        Place::new(self.path.display().to_string(), 1, self.name.as_str())
    }

    /// Whether it can be chosen, and is not there for others to inherit from alone. One that cannot be read can be chosen, so
    /// that the reason is told.
    pub fn can_be_chosen(&self) -> bool {
        self.file().map_or(true, |file| file.text("instantiation") != "false")
    }
}

/// A path with its name as the folder has it: indices are often written where capitals do not count.
fn as_spelled(files: &Files, path: &Path) -> PathBuf {
    if files.exists(path) {
        return path.to_owned();
    }
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return path.to_owned() };
    let is_same = |other: &PathBuf| other.file_name().is_some_and(|other| other.eq_ignore_ascii_case(name));
    files.entries(folder).into_iter().find(is_same).unwrap_or_else(|| path.to_owned())
}

/// Presets that name each other: those of a vendor, or of a user.
#[derive(Debug, Default)]
pub(super) struct Folder {
    pub is_user: bool,
    /// Whether all others may inherit from its filaments.
    pub is_library: bool,
    /// In the order of the index.
    presets: HashMap<Kind, Vec<Preset>>,
    by_name: HashMap<Kind, HashMap<String, usize>>,
    /// Models of machines, by name.
    models: HashMap<String, Preset>,
}

impl Folder {
    /// Its presets of a kind.
    pub fn presets(&self, kind: Kind) -> &[Preset] {
        self.presets.get(&kind).map_or(&[], Vec::as_slice)
    }

    /// A preset by its name.
    pub fn find(&self, kind: Kind, name: &str) -> Option<&Preset> {
        let at = *self.by_name.get(&kind)?.get(name)?;
        self.presets(kind).get(at)
    }

    /// The model of a machine.
    pub fn model(&self, name: &str) -> Option<&Preset> {
        self.models.get(name)
    }

    fn add(&mut self, kind: Kind, preset: Preset) {
        let presets = self.presets.entry(kind).or_default();
        self.by_name.entry(kind).or_default().entry(preset.name.clone()).or_insert(presets.len());
        presets.push(preset);
    }

    /// Presets are also known by their files, where no other is called so.
    fn add_stems(&mut self, kind: Kind) {
        let (Some(presets), Some(by_name)) = (self.presets.get(&kind), self.by_name.get_mut(&kind)) else {
            return;
        };
        for (at, preset) in presets.iter().enumerate() {
            let stem = preset.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            by_name.entry(stem).or_insert(at);
        }
    }

    /// A vendor: what its index lists, in the folder of the same name.
    fn vendor(files: &Files, index: &File, at: &Path) -> Result<Self, PresetError> {
        let root = at.with_extension("");
        let is_library = at.file_stem().is_some_and(|stem| stem == LIBRARY);
        let mut vendor = Self { is_library, ..Self::default() };
        for (name, path) in items(index, "machine_model_list")? {
            vendor.models.insert(name.clone(), Preset::new(files, name, root.join(path)));
        }
        for (kind, list, _) in KINDS {
            for (name, path) in items(index, list)? {
                vendor.add(kind, Preset::new(files, name, root.join(path)));
            }
            vendor.add_stems(kind);
        }
        Ok(vendor)
    }
}

/// Name and path of each item of a list of an index.
fn items(index: &File, list: &str) -> Result<Vec<(String, PathBuf)>, PresetError> {
    #[derive(serde::Deserialize)]
    struct Item {
        name: String,
        sub_path: PathBuf,
    }
    let Some(written) = index.get(list) else { return Ok(Vec::new()) };
    let item = |text: &String| {
        serde_json::from_str::<Item>(text).map(|item| (item.name, item.sub_path)).map_err(|_| {
            let place = Place::new(index.path.clone(), written.line, "");
            PresetError::at(place, format!("`{list}` holds what has no `name` and `sub_path`: {text}"))
        })
    };
    written.values.iter().map(item).collect()
}

/// Every folder of presets that a caller's file or folder holds; what cannot be read becomes a problem.
pub(super) fn find(files: &Files, path: &Path, problems: &mut Vec<PresetError>) -> Vec<Folder> {
    let mut folders = Vec::new();
    if files.is_dir(path) {
        walk(files, path, 0, &mut folders, problems);
    } else if is_json(path) {
        single(files, path, &mut folders, problems);
    }
    folders
}

/// A file: an index, with the filaments that all vendors share, or a preset.
fn single(files: &Files, path: &Path, folders: &mut Vec<Folder>, problems: &mut Vec<PresetError>) {
    let file = match File::read(files, path) {
        Ok(file) => file,
        Err(error) => return problems.push(error),
    };
    if is_index(&file) {
        vendor(files, &file, path, folders, problems);
        let library = path.with_file_name(LIBRARY).with_extension("json");
        if library != path && files.is_file(&library) {
            single(files, &library, folders, problems);
        }
    } else if let Some(kind) = kind(&file) {
        let mut own = Folder { is_user: true, ..Folder::default() };
        own.add(kind, named(files, path, Some(file)));
        folders.push(own);
    }
}

fn vendor(
    files: &Files,
    index: &File,
    path: &Path,
    folders: &mut Vec<Folder>,
    problems: &mut Vec<PresetError>,
) {
    match Folder::vendor(files, index, path) {
        Ok(vendor) => folders.push(vendor),
        Err(error) => problems.push(error),
    }
}

fn is_index(file: &File) -> bool {
    KINDS.iter().any(|(_, list, _)| file.get(list).is_some_and(|written| written.is_list))
}

/// What a single preset is about.
fn kind(file: &File) -> Option<Kind> {
    match file.text("type") {
        "machine" => return Some(Kind::Printer),
        "process" => return Some(Kind::Print),
        "filament" => return Some(Kind::Filament),
        _ => {}
    }
    let ids = [
        ("printer_settings_id", Kind::Printer),
        ("print_settings_id", Kind::Print),
        ("filament_settings_id", Kind::Filament),
    ];
    ids.into_iter().find(|(id, _)| file.get(id).is_some()).map(|(_, kind)| kind)
}

fn is_json(path: &Path) -> bool {
    is_preset(&path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase())
}

/// Whether a file of that name, in small letters, may be an index or a preset.
pub(in crate::presets) fn is_preset(name: &str) -> bool {
    name.ends_with(".json") && !name.ends_with(".def.json")
}

/// A preset that is called as it says itself, or else as its file is.
fn named(files: &Files, path: &Path, read: Option<File>) -> Preset {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let preset = Preset::new(files, String::new(), path.to_owned());
    if let Some(file) = read {
        let _ = preset.file.set(Ok(file));
    }
    let own = preset.file().map(|file| file.text("name").to_owned()).unwrap_or_default();
    Preset { name: if own.is_empty() { stem } else { own }, ..preset }
}

fn walk(
    files: &Files,
    folder: &Path,
    depth: usize,
    folders: &mut Vec<Folder>,
    problems: &mut Vec<PresetError>,
) {
    let entries = files.entries(folder);
    let mut vendors: Vec<PathBuf> = Vec::new();
    for path in entries.iter().filter(|path| is_json(path) && files.is_dir(&path.with_extension(""))) {
        match File::read(files, path) {
            Ok(file) if is_index(&file) => {
                vendors.push(path.with_extension(""));
                vendor(files, &file, path, folders, problems);
            }
            Ok(_) => {}
            Err(error) => problems.push(error),
        }
    }
    let mut own = Folder { is_user: true, ..Folder::default() };
    for path in entries.iter().filter(|path| files.is_dir(path) && !vendors.contains(path)) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        match KINDS.iter().find(|(.., kind)| *kind == name) {
            Some((kind, ..)) => loose(files, path, *kind, &mut own),
            None if depth < DEEPEST => walk(files, path, depth + 1, folders, problems),
            None => {}
        }
    }
    if !own.presets.is_empty() {
        folders.push(own);
    }
}

/// A user's presets of a kind: those in a folder, and in the folder `base` in it.
fn loose(files: &Files, folder: &Path, kind: Kind, own: &mut Folder) {
    for path in files.entries(folder) {
        if files.is_dir(&path) {
            loose(files, &path, kind, own);
        } else if is_json(&path) {
            own.add(kind, named(files, &path, None));
        }
    }
}
