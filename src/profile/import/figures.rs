//! How much of what bundles of presets set is taken over.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use super::idle::{self, Idle};
use super::table::ROWS;
use crate::presets::bundle_values;

/// The keys that presets of bundles set, each once, by what becomes of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeyFigures {
    /// Those that a setting of ours comes from.
    pub taken: Vec<String>,
    /// Those that ask for nothing, with all the values that they have in the bundles.
    pub meaningless: Vec<String>,
    /// The others, and why they are not taken over.
    pub missing: Vec<(String, String)>,
}

/// Sorts the keys of all print, filament and printer presets in bundles of PrusaSlicer.
///
/// What is idle only while another key is off counts as missing.
///
/// # Errors
/// A file cannot be read.
pub fn import_figures(bundles: &[impl AsRef<Path>]) -> Result<KeyFigures, String> {
    let mut values: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in bundles {
        let path = path.as_ref();
        let found = bundle_values(path).map_err(|error| format!("{}: {error}", path.display()))?;
        for (key, value) in found {
            values.entry(key).or_default().insert(value);
        }
    }
    let mut figures = KeyFigures::default();
    for (key, values) in values {
        if ROWS.iter().any(|row| row.theirs.contains(&key.as_str())) {
            figures.taken.push(key);
        } else if idle::of(&key).any(|idle| is_always(idle, &values)) {
            figures.meaningless.push(key);
        } else {
            let reason = idle::reason(&key).to_owned();
            figures.missing.push((key, reason));
        }
    }
    Ok(figures)
}

/// Whether a key asks for nothing, whatever else a configuration says.
fn is_always(idle: &Idle, values: &BTreeSet<String>) -> bool {
    match idle {
        Idle::Always | Idle::OneTool => true,
        Idle::At(known) => {
            values.iter().filter(|value| !value.is_empty()).all(|value| idle::is_among(value, known))
        }
        Idle::Without(_) | Idle::While(..) => false,
    }
}

impl fmt::Display for KeyFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [self.taken.len(), self.meaningless.len(), self.missing.len()];
        let all: usize = counts.iter().sum();
        let percent = counts.map(|count| 100.0 * count as f64 / all.max(1) as f64);
        writeln!(f, "{all} keys")?;
        for (what, i) in [("taken over", 0), ("mean nothing here", 1), ("missing", 2)] {
            writeln!(f, "{:>5} {what} ({:.1} %)", counts[i], percent[i])?;
        }
        for (key, reason) in &self.missing {
            writeln!(f, "      {key}: {reason}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_is_counted_once_by_all_its_values() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bundle.ini");
        let text = "[vendor]\nname = V\n[print:a]\nlayer_height = 0.2\ninfill_first = 0\ninterface_shells = 1\n\
                    [print:b]\nlayer_height = 0.3\ninfill_first = 1\noverhangs = 1\nresolution = 0\n";
        std::fs::write(&path, text).unwrap();
        let figures = import_figures(&[path]).unwrap();
        assert_eq!(figures.taken, ["layer_height", "overhangs"]);
        assert_eq!(figures.meaningless, ["interface_shells", "resolution"]);
        assert_eq!(figures.missing, [("infill_first".into(), "walls are printed before infill".into())]);
        assert!(figures.to_string().starts_with("5 keys\n    2 taken over (40.0 %)\n"), "{figures}");
    }
}
