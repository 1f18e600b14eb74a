//! Projects that Cura has saved (3MF): the machine's stacks with all that they are made of, in the folder `Cura`.

use std::path::PathBuf;

use super::added::Added;
use super::presets::{Cura, SET};
use crate::presets::config::{Config, Dialect};
use crate::presets::error::PresetError;
use crate::presets::family::{Family, Source};
use crate::presets::files::Files;

/// Where they are in the package.
const FOLDER: &str = "Cura/";

/// Whether a file of a package is one of these.
pub(in crate::presets) fn is_project(part: &str) -> bool {
    part.strip_prefix(FOLDER).is_some_and(|name| super::folder::is_file(&name.to_ascii_lowercase()))
}

/// What a machine in a project comes to as it was set. `parts`: the files that are of [projects](is_project), with their content.
///
/// # Errors
/// They are damaged, or there is no machine among them.
pub(in crate::presets) fn project(parts: Vec<(String, Vec<u8>)>) -> Result<Config, PresetError> {
    let files = Files::given(parts.into_iter().map(|(part, bytes)| (placed(&part, &bytes), bytes)));
    let root = Source { path: FOLDER.trim_end_matches('/').into(), dialect: Some(Dialect::Cura) };
    let cura = Cura::read(&files, &[&root]);
    let added = Added::all(cura.folder.stacks()?).next();
    let added = added.ok_or_else(|| PresetError::of("holds no machine of Cura"))?;
    let machine = cura.machine(&added.machine.name)?;
    let material = cura.loaded(&machine)?.ok_or_else(|| PresetError::of("holds no material of Cura"))?;
    cura.resolve(&added.machine.name, SET, &material.name)
}

/// Where Cura has a file otherwise: by what it is, its name with the web's escapes.
fn placed(part: &str, bytes: &[u8]) -> PathBuf {
    let name = part.strip_prefix(FOLDER).unwrap_or(part).replace('%', "%25").replace('+', "%2B");
    let says = |text: &str| memchr::memmem::find(bytes, text.as_bytes()).is_some();
    let folder = match () {
        () if name.ends_with(".def.json") && says("\"extruder_nr\"") && !says("\"machine_width\"") => {
            "extruders"
        }
        () if says("type = variant") => "variants",
        () if says("type = quality_changes") => "quality_changes",
        () if says("type = quality") => "quality",
        () if says("type = intent") => "intent",
        () => "user",
    };
    PathBuf::from(FOLDER).join(folder).join(name)
}
