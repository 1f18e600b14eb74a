//! Physical printers of PrusaSlicer and SuperSlicer: which host a printer has, and which presets it prints with.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use super::config::Place;
use super::error::PresetError;
use super::family::Source;
use super::files::Files;
use super::ini;
use super::value::{texts, unescaped};
use crate::near;

/// The folder of them beside the presets.
const FOLDER: &str = "physical_printer";
/// How many names a message lists.
const NAMED: usize = 10;

/// A printer with its host.
#[derive(Clone)]
pub struct PhysicalPrinter {
    /// Its name: that of its file.
    pub name: String,
    /// Names of the printer presets that it prints with.
    pub presets: Vec<String>,
    /// A key is among them.
    values: BTreeMap<String, String>,
}

impl fmt::Debug for PhysicalPrinter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PhysicalPrinter").field("name", &self.name).finish_non_exhaustive()
    }
}

impl PhysicalPrinter {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or is none of a printer that melts.
    pub fn read(path: &Path) -> Result<Self, PresetError> {
        let wrong = |message: String| PresetError::at(Place::new(path.display().to_string(), 0, ""), message);
        let lines = ini::lines(&Files::default(), path).map_err(wrong)?;
        let head = ini::sections(&lines).swap_remove(0);
        let names = texts(head.value("preset_names").unwrap_or_default());
        let presets = names.into_iter().map(Cow::into_owned).filter(|name| !name.is_empty()).collect();
        let values: BTreeMap<String, String> =
            head.lines.into_iter().map(|line| (line.key, unescaped(&line.value))).collect();
        if values.get("printer_technology").is_some_and(|technology| technology == "SLA") {
            return Err(wrong("is a printer that hardens resin".into()));
        }
        if !values.contains_key("print_host") {
            return Err(wrong("names no print_host; is it a physical printer?".into()));
        }
        Ok(Self { name: stem(path), presets, values })
    }

    /// The one of a name in folders of presets.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn find(sources: &[Source], name: &str) -> Result<Self, PresetError> {
        let files: Vec<PathBuf> = sources
            .iter()
            .flat_map(|source| ini::files(&Files::default(), &source.path.join(FOLDER)))
            .collect();
        let found = files.iter().find(|file| stem(file) == name);
        if let Some(file) = found.or_else(|| files.iter().find(|file| stem(file).eq_ignore_ascii_case(name)))
        {
            return Self::read(file);
        }
        let names: Vec<String> = files.iter().map(|file| stem(file)).collect();
        let like = near::names(name, names.iter().map(String::as_str), NAMED);
        let hint = match (like.as_slice(), names.as_slice()) {
            ([], []) => format!("; no folder of presets has a folder {FOLDER}"),
            ([], names) => format!("; there are: {}", names[..names.len().min(NAMED)].join(", ")),
            (like, _) => format!("; did you mean `{}`?", like.join("`, `")),
        };
        Err(PresetError::of(format!("there is no physical printer `{name}`{hint}")))
    }

    /// A value that is not empty.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.values.get(key).map(|value| value.trim()).filter(|value| !value.is_empty())
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().map(OsStr::to_string_lossy).unwrap_or_default().into_owned()
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    #[test]
    fn one_is_found_by_its_name_and_shows_no_key() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join(FOLDER);
        std::fs::create_dir(&place).unwrap();
        let text = "# by hand\nhost_type = prusalink\npreset_names = \"My MK4\";Other\nprint_host = 10.0.0.7\n\
                    printhost_apikey = very-secret\nprinthost_cafile = C:\\\\ca.pem\nprinthost_user = \n";
        std::fs::write(place.join("Shop MK4.ini"), text).unwrap();
        let resin = "printer_technology = SLA\nprint_host = 10.0.0.8\n";
        std::fs::write(place.join("SL1.ini"), resin).unwrap();
        let sources = [Source { path: folder.path().to_owned(), dialect: None }];
        let found = PhysicalPrinter::find(&sources, "shop mk4").unwrap();
        assert_eq!((found.name.as_str(), found.presets.len()), ("Shop MK4", 2));
        assert_eq!(found.presets[0], "My MK4");
        assert_eq!(
            (found.value("printhost_cafile"), found.value("printhost_user")),
            (Some("C:\\ca.pem"), None)
        );
        assert!(!format!("{found:?}").contains("very-secret"));
        for (name, wanted) in
            [("SL1", "hardens resin"), ("Shop MK3", "did you mean `Shop MK4`"), ("?", "there are: SL1")]
        {
            let error = PhysicalPrinter::find(&sources, name).unwrap_err().to_string();
            assert!(error.contains(wanted), "{error}");
        }
    }
}
