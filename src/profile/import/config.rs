//! Configurations as PrusaSlicer, SuperSlicer and Slic3r write them: `key = value`, alone, in a bundle of presets, or as
//! comments at the end of G-code.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::gcode::is_gcode;

/// One value, and the line it stands on, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub value: String,
    pub line: usize,
}

/// Every key of a configuration.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Config {
    pub entries: BTreeMap<String, Entry>,
    /// Percentages of widths are of the nozzle, as in SuperSlicer, and not of the layer's height.
    pub is_super: bool,
}

/// A preset of a bundle: its name in brackets and what stands under it.
pub(super) type Preset = (String, Vec<(String, Entry)>);

/// Kinds of presets.
const KINDS: [&str; 3] = ["print", "filament", "printer"];

/// Whether a file of this name is read as a configuration of another slicer.
pub(in crate::profile) fn is_foreign(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    extension == "ini" || is_gcode(path)
}

impl Config {
    /// Reads an `.ini` file, or the configuration in a G-code file.
    ///
    /// # Errors
    /// The file cannot be read, holds no configuration, or several presets of one kind without saying which is meant.
    pub fn read(path: &Path) -> Result<Self, String> {
        let read = |error: std::io::Error| format!("cannot be read: {error}");
        let file = BufReader::new(File::open(path).map_err(read)?);
        let lines = file.split(b'\n').map(|line| line.map(|l| String::from_utf8_lossy(&l).into_owned()));
        if is_gcode(path) {
            let mut block = Block::default();
            for (index, line) in lines.enumerate() {
                block.line(line.map_err(read)?.trim(), index + 1);
            }
            return block.config();
        }
        let text: Vec<String> = lines.collect::<Result<_, _>>().map_err(read)?;
        Self::parse(&text)
    }

    /// The print, filament and printer presets of a bundle, each as it stands there.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn presets(path: &Path) -> Result<Vec<Preset>, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let lines: Vec<String> = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
        let mut presets = presets_of(&lines);
        presets.retain(|(name, _)| KINDS.iter().any(|kind| name.starts_with(&format!("{kind}:"))));
        Ok(presets)
    }

    /// Reads the lines of an `.ini` file.
    pub fn parse(lines: &[String]) -> Result<Self, String> {
        let presets = presets_of(lines);
        let config = Self::of(chosen(&presets)?);
        if config.entries.is_empty() { Err("holds no `key = value`".into()) } else { Ok(config) }
    }

    fn of(entries: BTreeMap<String, Entry>) -> Self {
        let is_super = entries.contains_key("first_layer_size_compensation");
        Self { entries, is_super }
    }

    /// A value that is there and not `nil` (for the first extruder), as written.
    pub fn text(&self, key: &str) -> Option<&str> {
        let value = self.entries.get(key)?.value.trim();
        let first = value.split(',').next().unwrap_or_default().trim();
        (first != "nil" && !value.is_empty()).then_some(value)
    }

    /// The first extruder's share of a value.
    pub fn first(&self, key: &str) -> Option<&str> {
        self.text(key).map(|text| text.split(',').next().unwrap_or_default().trim())
    }

    pub fn number(&self, key: &str) -> Option<f64> {
        self.first(key)?.parse().ok().filter(|n: &f64| n.is_finite())
    }

    /// A number, or a percentage of another.
    pub fn number_of(&self, key: &str, whole: Option<f64>) -> Option<f64> {
        match self.first(key)?.strip_suffix('%') {
            Some(percent) => Some(percent.trim().parse::<f64>().ok()? / 100.0 * whole?),
            None => self.number(key),
        }
    }

    pub fn flag(&self, key: &str) -> Option<bool> {
        match self.first(key)? {
            "1" | "true" | "enabled" => Some(true),
            "0" | "false" | "disabled" | "none" | "nowhere" => Some(false),
            _ => None,
        }
    }
}

/// A configuration among the comments of G-code: between marks, or else the last comments of the file.
#[derive(Default)]
struct Block {
    entries: BTreeMap<String, Entry>,
    is_super: bool,
    marked: bool,
    ended: bool,
}

impl Block {
    fn line(&mut self, line: &str, number: usize) {
        if self.ended || line.is_empty() {
            return;
        }
        let Some(comment) = line.strip_prefix(';') else {
            if !self.marked {
                self.entries.clear();
            }
            return;
        };
        match comment.trim() {
            "prusaslicer_config = begin" | "SuperSlicer_config = begin" => {
                self.entries.clear();
                self.marked = true;
                self.is_super = comment.contains("Super");
            }
            "prusaslicer_config = end" | "SuperSlicer_config = end" => self.ended = self.marked,
            text => {
                if let Some((key, value)) = assignment(text) {
                    self.entries.insert(key, Entry { value, line: number });
                }
            }
        }
    }

    /// A file of the marked kind, or Slic3r's, which states at least a layer height.
    fn config(self) -> Result<Config, String> {
        if !self.entries.contains_key("layer_height") || !self.entries.contains_key("perimeters") {
            return Err("holds no configuration of PrusaSlicer, SuperSlicer or Slic3r".into());
        }
        let mut config = Config::of(self.entries);
        config.is_super |= self.is_super;
        Ok(config)
    }
}

/// The sections of a file with their lines; what is in none comes first, without a name.
fn presets_of(lines: &[String]) -> Vec<Preset> {
    let mut presets: Vec<Preset> = vec![(String::new(), Vec::new())];
    for (index, line) in lines.iter().enumerate() {
        let line = line.trim().trim_start_matches('\u{feff}');
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            presets.push((name.trim().to_owned(), Vec::new()));
        } else if let Some((key, value)) = assignment(line)
            && let Some((_, entries)) = presets.last_mut()
        {
            entries.push((key, Entry { value, line: index + 1 }));
        }
    }
    presets
}

/// `key = value`, the key one of lower-case words.
fn assignment(line: &str) -> Option<(String, String)> {
    let (key, value) = line.split_once('=')?;
    let key = key.trim();
    let is_key = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    (!key.is_empty() && key.chars().all(is_key)).then(|| (key.to_owned(), value.trim().to_owned()))
}

/// What holds of all presets: those that `[presets]` names, or the only one of each kind; each with what it inherits.
fn chosen(presets: &[Preset]) -> Result<BTreeMap<String, Entry>, String> {
    let of_kind = |kind: &'static str| {
        presets.iter().filter(move |(name, _)| {
            name.strip_prefix(kind).is_some_and(|rest| rest.starts_with(':')) && !name.contains(":*")
        })
    };
    let active = presets.iter().find(|(name, _)| name == "presets");
    let mut all = BTreeMap::new();
    for (name, entries) in presets {
        if name.is_empty() || KINDS.contains(&name.as_str()) {
            all.extend(entries.iter().cloned());
        }
    }
    for kind in KINDS {
        let wanted = active.and_then(|(_, entries)| entries.iter().find(|(key, _)| key == kind));
        let wanted = wanted.map(|(_, entry)| format!("{kind}:{}", entry.value));
        let found: Vec<&Preset> = of_kind(kind).collect();
        let preset = match wanted.and_then(|wanted| found.iter().find(|(name, _)| *name == wanted)) {
            Some(preset) => preset,
            None => match found.as_slice() {
                [] => continue,
                [only] => only,
                several => {
                    let names: Vec<String> = several.iter().map(|(name, _)| format!("[{name}]")).collect();
                    return Err(format!("holds several {kind} presets; leave one: {}", names.join(", ")));
                }
            },
        };
        inherit(preset, kind, presets, &mut Vec::new(), &mut all);
    }
    Ok(all)
}

/// Adds what a preset inherits from others of the file, and then its own.
fn inherit<'a>(
    preset: &'a Preset,
    kind: &str,
    presets: &'a [Preset],
    open: &mut Vec<&'a str>,
    all: &mut BTreeMap<String, Entry>,
) {
    let (name, entries) = preset;
    if open.contains(&name.as_str()) {
        return;
    }
    open.push(name);
    let parents = entries.iter().filter(|(key, _)| key == "inherits");
    for parent in parents.flat_map(|(_, entry)| entry.value.split(';')) {
        let parent = format!("{kind}:{}", parent.trim());
        if let Some(parent) = presets.iter().find(|(name, _)| *name == parent) {
            inherit(parent, kind, presets, open, all);
        }
    }
    open.pop();
    all.extend(entries.iter().cloned());
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Config, String> {
        Config::parse(&text.lines().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn keys_know_their_lines() {
        let config = parsed("# by hand\n\nlayer_height = 0.2\nstart_gcode = G28 ; X=1\\nG1\n").unwrap();
        assert_eq!(config.entries["layer_height"], Entry { value: "0.2".into(), line: 3 });
        assert_eq!(config.text("start_gcode"), Some("G28 ; X=1\\nG1"));
    }

    #[test]
    fn percentages_are_of_something_and_nil_is_nothing() {
        let config = parsed("a = 50%\nb = nil\nc = 1500,1250\nd = nil,2\n").unwrap();
        assert_eq!(config.number_of("a", Some(30.0)), Some(15.0));
        assert_eq!((config.number_of("a", None), config.text("b")), (None, None));
        assert_eq!(config.number("c"), Some(1500.0), "the first extruder's");
        assert_eq!(config.number("d"), None);
    }

    #[test]
    fn of_a_bundle_the_active_presets_hold_with_what_they_inherit() {
        let bundle = "[print:*common*]\nperimeters = 2\nlayer_height = 0.3\n[print:A]\ninherits = *common*\n\
                      layer_height = 0.2\n[print:B]\nperimeters = 9\n[filament:PLA]\ntemperature = 210\n";
        let error = parsed(bundle).unwrap_err();
        assert!(error.contains("[print:A], [print:B]"), "{error}");
        let config = parsed(&format!("{bundle}[presets]\nprint = A\nfilament = PLA\n")).unwrap();
        assert_eq!(config.number("perimeters"), Some(2.0));
        assert_eq!(config.number("layer_height"), Some(0.2));
        assert_eq!(config.number("temperature"), Some(210.0));
    }

    #[test]
    fn gcode_holds_it_between_marks_or_at_its_end() {
        let read = |text: &str| {
            let mut block = Block::default();
            text.lines().enumerate().for_each(|(i, line)| block.line(line, i + 1));
            block.config()
        };
        let marked = "; layer_height = 9\nG1 X1\n; prusaslicer_config = begin\n; layer_height = 0.2\n\
                      ; perimeters = 2\n; prusaslicer_config = end\n; perimeters = 7\n";
        assert_eq!(read(marked).unwrap().number("perimeters"), Some(2.0));
        let slic3r =
            "; perimeters = 7\nG1 X1\n; filament used = 3mm\n; layer_height = 0.2\n; perimeters = 3\n";
        assert_eq!(read(slic3r).unwrap().number("perimeters"), Some(3.0));
        assert!(read("G1 X1\n;LAYER:1\n").is_err());
    }
}
