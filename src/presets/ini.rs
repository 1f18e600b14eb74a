//! `.ini` files: sections of `key = value`, as bundles of presets and single configurations are written.

use std::path::{Path, PathBuf};

use super::files::Files;

/// One `key = value`, and its line, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Line {
    pub key: String,
    pub value: String,
    pub line: usize,
}

/// What stands under a name in brackets; before the first of them the name is empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Section {
    pub name: String,
    /// That of the name.
    pub line: usize,
    pub lines: Vec<Line>,
}

impl Section {
    /// The last value of a key.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.lines.iter().rev().find(|line| line.key == key).map(|line| line.value.as_str())
    }
}

/// The `.ini` files of a folder, by name.
pub(super) fn files(files: &Files, folder: &Path) -> Vec<PathBuf> {
    let is_ini = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        is_preset(&name) && files.is_file(path)
    };
    files.entries(folder).into_iter().filter(is_ini).collect()
}

/// Whether a file of that name, in small letters, may hold presets.
pub(super) fn is_preset(name: &str) -> bool {
    name.ends_with(".ini")
}

/// The lines of a text file, whatever its encoding.
///
/// # Errors
/// It cannot be read, or is larger than presets are.
pub(super) fn lines(files: &Files, path: &Path) -> Result<Vec<String>, String> {
    let bytes = files.small(path)?;
    let whole = bytes.strip_suffix(b"\n").unwrap_or(&bytes);
    if bytes.is_empty() {
        return Ok(Vec::new());
    }
    Ok(whole.split(|byte| *byte == b'\n').map(|line| String::from_utf8_lossy(line).into_owned()).collect())
}

/// The sections of a file, the first of them what precedes all names.
pub(super) fn sections(lines: &[String]) -> Vec<Section> {
    let mut sections = vec![Section::default()];
    for (index, line) in lines.iter().enumerate() {
        let line = line.trim().trim_start_matches('\u{feff}');
        let number = index + 1;
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            sections.push(Section { name: name.trim().to_owned(), line: number, lines: Vec::new() });
        } else if let Some((key, value)) = assignment(line)
            && let Some(section) = sections.last_mut()
        {
            section.lines.push(Line { key, value, line: number });
        }
    }
    sections
}

/// `key = value`, the key one of lower-case words.
pub(super) fn assignment(line: &str) -> Option<(String, String)> {
    let (key, value) = line.split_once('=')?;
    let key = key.trim();
    let is_key = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    (!key.is_empty() && key.chars().all(is_key)).then(|| (key.to_owned(), value.trim().to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_know_their_sections_and_lines() {
        let text = "\u{feff}# by hand\n; notes = 1\na = 1\n[print:X = 2]\n\nstart_gcode = G28 ; X=1\\nG1\na=2\na=3\n";
        let sections = sections(&text.lines().map(str::to_owned).collect::<Vec<_>>());
        let names: Vec<(&str, usize)> = sections.iter().map(|s| (s.name.as_str(), s.line)).collect();
        assert_eq!(names, [("", 0), ("print:X = 2", 4)]);
        assert_eq!(sections[0].lines, [Line { key: "a".into(), value: "1".into(), line: 3 }]);
        assert_eq!(sections[1].value("start_gcode"), Some("G28 ; X=1\\nG1"));
        assert_eq!(sections[1].value("a"), Some("3"), "the last one holds");
    }
}
