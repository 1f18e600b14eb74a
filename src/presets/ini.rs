//! `.ini` files: sections of `key = value`, as bundles of presets and single configurations are written.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::limits;

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
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_ini = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ini")) && path.is_file()
    };
    let mut files: Vec<PathBuf> = entries.filter(is_ini).collect();
    files.sort();
    files
}

/// The lines of a text file, whatever its encoding.
///
/// # Errors
/// It cannot be read, or is larger than presets are.
pub(super) fn lines(path: &Path) -> Result<Vec<String>, String> {
    let mut lines = Vec::new();
    each_line(path, limits::PRESETS_BYTES, |_, line| lines.push(line.to_owned()))?;
    Ok(lines)
}

/// Does something with every line of a text file of at most `most` bytes, and its number, from 1.
///
/// # Errors
/// It cannot be read, or is larger.
pub(super) fn each_line(path: &Path, most: u64, mut work: impl FnMut(usize, &str)) -> Result<(), String> {
    let read = |error: std::io::Error| format!("cannot be read: {error}");
    let file = File::open(path).map_err(read)?;
    if file.metadata().map_err(read)?.len() > most {
        return Err(format!("is larger than {} MB", most >> 20));
    }
    for (index, line) in BufReader::new(file.take(most)).split(b'\n').enumerate() {
        work(index + 1, &String::from_utf8_lossy(&line.map_err(read)?));
    }
    Ok(())
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
