//! Single configurations: an exported `.ini` file, or the one in G-code.

use std::io::BufRead;
use std::path::Path;

use super::bundle::{Bundles, Found};
use super::config::{Config, Dialect, Place};
use super::family::Kind;
use super::files::Files;
use super::ini::{self, Section, assignment};
use super::keys::key_type;
use super::{project, superslicer};
use crate::gcode::{self, is_gcode};

/// Whether a file of this name is read as a configuration of another slicer: `.ini`, G-code, a project (3MF).
pub fn is_foreign(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    extension == "ini" || is_gcode(path) || project::is_project(path)
}

/// What the print, filament and printer presets of a bundle set: keys and values as they stand there.
///
/// # Errors
/// The file cannot be read.
pub fn bundle_values(path: &Path) -> Result<Vec<(String, String)>, String> {
    let kinds = ["print:", "filament:", "printer:"];
    let sections = ini::sections(&ini::lines(&Files::default(), path)?);
    let presets =
        sections.into_iter().filter(|section| kinds.iter().any(|kind| section.name.starts_with(kind)));
    Ok(presets.flat_map(|section| section.lines).map(|line| (line.key, line.value)).collect())
}

impl Config {
    /// Reads an `.ini` file, or the configuration in a G-code file or a project.
    ///
    /// # Errors
    /// The file cannot be read, holds no configuration, or several presets of one kind without saying which is meant.
    pub fn read(path: &Path) -> Result<Self, String> {
        let file = path.display().to_string();
        if project::is_project(path) {
            return project::read(path);
        }
        if is_gcode(path) {
            let mut block = Block::default();
            let read = |error: std::io::Error| format!("cannot be read: {error}");
            for (index, line) in gcode::open(path).map_err(read)?.split(b'\n').enumerate() {
                block.line(String::from_utf8_lossy(&line.map_err(read)?).trim(), index + 1);
            }
            return block.config(&file);
        }
        Self::of_sections(&file, ini::sections(&ini::lines(&Files::default(), path)?))
    }

    /// Reads the lines of an `.ini` file.
    ///
    /// # Errors
    /// As [`Config::read`].
    pub fn parse(lines: &[String]) -> Result<Self, String> {
        Self::of_sections("", ini::sections(lines))
    }

    /// Reads the lines of a file of that name, written in a dialect.
    ///
    /// # Errors
    /// As [`Config::read`].
    pub(super) fn of_lines(file: &str, lines: &[String], dialect: Dialect) -> Result<Self, String> {
        let config = Self::of_sections(file, ini::sections(lines))?;
        Ok(if dialect == Dialect::Super { config.of_superslicer() } else { config })
    }

    fn of_sections(file: &str, sections: Vec<Section>) -> Result<Self, String> {
        const KINDS: [Kind; 3] = [Kind::Print, Kind::Filament, Kind::Printer];
        let is_free = |section: &&Section| {
            section.name.is_empty() || KINDS.iter().any(|kind| kind.name() == section.name)
        };
        let free: Vec<Section> = sections.iter().filter(is_free).cloned().collect();
        let active = sections.iter().find(|section| section.name == "presets").cloned();
        let mut bundles = Bundles::default();
        bundles.add_sections(file, sections, None);
        let mut found = Vec::new();
        for kind in KINDS {
            let wanted = active.as_ref().and_then(|active| active.value(kind.name()));
            let mut chosable = bundles.chosable(kind);
            let preset = match (wanted.and_then(|name| bundles.find(kind, name)), chosable.next()) {
                (Some(wanted), _) => wanted,
                (None, None) => continue,
                (None, Some(only)) if chosable.next().is_none() => only,
                (None, Some(_)) => return Err(several(file, &bundles)),
            };
            found.extend(bundles.values(preset).map_err(|error| error.to_string())?);
        }
        let mut config = Self::default();
        let free = free.iter().flat_map(|section| {
            let preset = &section.name;
            section.lines.iter().map(move |line| (line, Place::new(file, line.line, preset.as_str())))
        });
        for (line, place) in free {
            config.set_both(&line.key, &line.value, key_type(&line.key), place);
        }
        for Found { key, value, place } in found {
            config.set_both(key, value, key_type(key), place);
        }
        if config.entries.is_empty() { Err("holds no `key = value`".into()) } else { Ok(config.named()) }
    }

    /// With the dialect that its keys are of.
    fn named(self) -> Self {
        let is_super = self.entries.iter().any(|(key, entry)| superslicer::is_own_line(key, &entry.value));
        if is_super { self.of_superslicer() } else { self }
    }

    /// Of SuperSlicer, in PrusaSlicer's words.
    fn of_superslicer(self) -> Self {
        if self.dialect == Dialect::Super {
            return self;
        }
        let mut own = Self { dialect: Dialect::Super, of_object: self.of_object, ..Self::default() };
        let said = self.entries.iter().map(|(key, entry)| {
            let value = self.lists.get(key).map_or(&entry.value, |(_, all)| all);
            (key.as_str(), value.as_str(), &entry.place)
        });
        for (key, value, place) in superslicer::called_today(said) {
            own.set_both(key, value, superslicer::find_key(key).map(|key| key.kind), place.clone());
        }
        superslicer::translate(&mut own);
        own
    }
}

fn several(file: &str, bundles: &Bundles) -> String {
    let count = |kind: Kind| bundles.chosable(kind).count();
    let [printers, prints, filaments] = [Kind::Printer, Kind::Print, Kind::Filament].map(count);
    format!(
        "holds {printers} printer, {prints} print and {filaments} filament presets; \
         `pathwright printers --presets \"{file}\"` lists the printers, \
         and `--presets \"{file}\" --printer NAME` takes one"
    )
}

/// A configuration among the comments of G-code: between marks, or else the last comments of the file.
#[derive(Default)]
struct Block {
    lines: Vec<ini::Line>,
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
                self.lines.clear();
            }
            return;
        };
        match comment.trim() {
            "prusaslicer_config = begin" | "SuperSlicer_config = begin" => {
                self.lines.clear();
                self.marked = true;
                self.is_super = comment.contains("Super");
            }
            "prusaslicer_config = end" | "SuperSlicer_config = end" => self.ended = self.marked,
            text => {
                if let Some((key, value)) = assignment(text) {
                    self.lines.push(ini::Line { key, value, line: number });
                }
            }
        }
    }

    /// A file of the marked kind, or Slic3r's, which states at least a layer height.
    fn config(self, file: &str) -> Result<Config, String> {
        let mut config = Config::default();
        for ini::Line { key, value, line } in &self.lines {
            config.set_both(key, value, key_type(key), Place::new(file, *line, ""));
        }
        if !config.entries.contains_key("layer_height") || !config.entries.contains_key("perimeters") {
            return Err("holds no configuration of PrusaSlicer, SuperSlicer or Slic3r".into());
        }
        Ok(if self.is_super { config.of_superslicer() } else { config.named() })
    }
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
        assert_eq!(config.entries["layer_height"].place.line, 3);
        assert_eq!(config.text("start_gcode"), Some("G28 ; X=1\\nG1"));
    }

    #[test]
    fn of_a_bundle_the_active_presets_hold_with_what_they_inherit() {
        let bundle = "[print:*common*]\nperimeters = 2\nlayer_height = 0.3\n[print:A]\ninherits = *common*\n\
                      layer_height = 0.2\n[print:B]\nperimeters = 9\n[filament:PLA]\ntemperature = 210\n";
        let error = parsed(bundle).unwrap_err();
        assert!(error.contains("0 printer, 2 print and 1 filament presets"), "{error}");
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
            block.config("x.gcode")
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
