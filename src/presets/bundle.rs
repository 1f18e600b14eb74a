//! Bundles of PrusaSlicer and SuperSlicer: presets as written, the names they inherit from, and what is in force.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::config::{Dialect, Place};
use super::error::PresetError;
use super::family::{Kind, Listed};
use super::files::Files;
use super::ini::{self, Line, Section};
use super::superslicer;
use super::value::texts;
use crate::limits;

/// What a complete preset states at least, by kind: one that does needs no parent.
const TELLING: [(Kind, [&str; 3]); 3] = [
    (Kind::Printer, ["bed_shape", "nozzle_diameter", "start_gcode"]),
    (Kind::Print, ["layer_height", "perimeters", "fill_density"]),
    (Kind::Filament, ["temperature", "bed_temperature", "filament_diameter"]),
];

/// How sections are named that name the files of a bundle, as AnkerMake Studio has them.
const PARTS: &str = "Path:";

/// A preset as written.
#[derive(Debug)]
pub(super) struct Preset {
    pub kind: Kind,
    pub name: String,
    /// The vendor whose bundle it is in; `None`: a user's.
    pub vendor: Option<Arc<str>>,
    pub listed: Listed,
    lines: Vec<Line>,
    /// Which file of the store.
    file: usize,
}

/// Preset and line of it, by key.
type Flat<'a> = BTreeMap<&'a str, (usize, usize)>;

/// One value in force, and where it was written.
#[derive(Clone, Debug)]
pub(super) struct Found<'a> {
    pub key: &'a str,
    pub value: &'a str,
    pub place: Place,
}

/// All presets of some files.
#[derive(Debug, Default)]
pub(super) struct Bundles {
    presets: Vec<Preset>,
    files: Vec<Arc<str>>,
    /// Those of a name, the one that is taken first.
    by_name: FxHashMap<(Kind, String), Vec<usize>>,
    /// Former names.
    formerly: FxHashMap<(Kind, String), usize>,
}

/// Whose sections these are, in a file of that path; `None`: a user's.
fn vendor<'a>(sections: impl Iterator<Item = &'a Section> + Clone, path: &str) -> Option<Arc<str>> {
    let mut own = sections.filter(|section| section.name == "vendor");
    let name = own.clone().find_map(|section| section.value("name").or(section.value("repo_id")));
    name.or_else(|| own.next().map(|_| path)).map(Into::into)
}

impl Bundles {
    /// Adds the presets of a bundle, with those of the files that it names.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn add_file(
        &mut self,
        files: &Files,
        path: &Path,
        dialect: Option<Dialect>,
    ) -> Result<(), PresetError> {
        let read = |path: &Path| -> Result<Vec<Section>, PresetError> {
            let lines = ini::lines(files, path).map_err(|message| unreadable(path, message))?;
            Ok(ini::sections(&lines))
        };
        let sections = read(path)?;
        let named = sections.iter().filter(|section| section.name.starts_with(PARTS));
        let folder = path.parent().unwrap_or(Path::new(""));
        let parts: Vec<PathBuf> =
            named.flat_map(|section| &section.lines).map(|line| folder.join(&line.value)).collect();
        let mut all = vec![(path.to_owned(), sections)];
        for part in parts {
            let sections = read(&part)?;
            all.push((part, sections));
        }
        let vendor = vendor(all.iter().flat_map(|(_, sections)| sections), &path.display().to_string());
        for (path, sections) in all {
            self.add_of_vendor(&path.display().to_string(), sections, dialect, vendor.clone());
        }
        Ok(())
    }

    /// Adds the sections of a bundle that are presets.
    pub fn add_sections(&mut self, path: &str, sections: Vec<Section>, dialect: Option<Dialect>) {
        let vendor = vendor(sections.iter(), path);
        self.add_of_vendor(path, sections, dialect, vendor);
    }

    fn add_of_vendor(
        &mut self,
        path: &str,
        sections: Vec<Section>,
        dialect: Option<Dialect>,
        vendor: Option<Arc<str>>,
    ) {
        let dialect = dialect.unwrap_or_else(|| Dialect::of_sections(&sections));
        let file = self.file(path);
        for Section { name, line, lines } in sections {
            let Some((kind, name)) = name.split_once(':') else { continue };
            let Some(kind) =
                [Kind::Printer, Kind::Print, Kind::Filament].into_iter().find(|k| k.name() == kind)
            else {
                continue;
            };
            self.add(kind, name.trim(), lines, file, line, vendor.clone(), dialect);
        }
    }

    /// Adds a user's preset, which has a file of its own, named like the preset.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn add_preset(
        &mut self,
        files: &Files,
        kind: Kind,
        path: &Path,
        dialect: Option<Dialect>,
    ) -> Result<(), PresetError> {
        let lines = ini::lines(files, path).map_err(|message| unreadable(path, message))?;
        let sections = ini::sections(&lines);
        let dialect = dialect.unwrap_or_else(|| Dialect::of_sections(&sections));
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let file = self.file(&path.display().to_string());
        let lines = sections.into_iter().filter(|section| section.name.is_empty()).flat_map(|s| s.lines);
        self.add(kind, &name, lines.collect(), file, 1, None, dialect);
        Ok(())
    }

    fn file(&mut self, path: &str) -> usize {
        self.files.push(path.into());
        self.files.len() - 1
    }

    #[allow(clippy::too_many_arguments)]
    fn add(
        &mut self,
        kind: Kind,
        name: &str,
        lines: Vec<Line>,
        file: usize,
        line: usize,
        vendor: Option<Arc<str>>,
        dialect: Dialect,
    ) {
        let index = self.presets.len();
        let former = lines.iter().filter(|line| line.key == "renamed_from");
        for former in former.flat_map(|line| texts(&line.value)) {
            self.formerly.entry((kind, former.into_owned())).or_insert(index);
        }
        let is_user = vendor.is_none();
        let place = Place::new(self.files[file].clone(), line, format!("{}:{name}", kind.name()));
        let listed = Listed { name: name.to_owned(), is_user, dialect, place };
        self.presets.push(Preset { kind, name: name.to_owned(), vendor, listed, lines, file });
        let presets = &self.presets;
        let same = self.by_name.entry((kind, name.to_owned())).or_default();
        // Users' before vendors', and else as they came.
        let at = same.iter().position(|&other| is_user && !presets[other].listed.is_user);
        same.insert(at.unwrap_or(same.len()), index);
    }

    /// Every preset that can be chosen; those of one name in the order in which they are taken.
    pub fn chosable(&self, kind: Kind) -> impl Iterator<Item = &Preset> {
        let of_kind = move |preset: &&Preset| preset.kind == kind && !preset.name.starts_with('*');
        let users = self.presets.iter().filter(of_kind).filter(|preset| preset.listed.is_user);
        users.chain(self.presets.iter().filter(of_kind).filter(|preset| !preset.listed.is_user))
    }

    /// The presets of a name, the one that is taken first.
    pub fn named(&self, kind: Kind, name: &str) -> impl Iterator<Item = &Preset> {
        let same = self.by_name.get(&(kind, name.to_owned()));
        same.into_iter().flatten().map(|&index| &self.presets[index])
    }

    /// The preset of a name that is taken.
    pub fn find(&self, kind: Kind, name: &str) -> Option<&Preset> {
        self.named(kind, name).next()
    }

    /// The preset that had a name formerly.
    pub fn formerly(&self, kind: Kind, name: &str) -> Option<&Preset> {
        self.formerly.get(&(kind, name.to_owned())).map(|&index| &self.presets[index])
    }

    fn index(&self, preset: &Preset) -> usize {
        let found = self.by_name.get(&(preset.kind, preset.name.clone()));
        let mut same = found.into_iter().flatten().copied();
        same.find(|&index| std::ptr::eq(&self.presets[index], preset)).unwrap_or_default()
    }

    /// The presets that one inherits from, the later ones winning, each with the line that says so. `Err`: a name and its line.
    fn parents(&self, index: usize) -> Result<Vec<(usize, usize)>, (String, usize)> {
        let preset = &self.presets[index];
        let mut parents = Vec::new();
        for line in preset.lines.iter().filter(|line| line.key == "inherits") {
            for name in texts(&line.value).iter().filter(|name| !name.is_empty()) {
                let same = self.by_name.get(&(preset.kind, name.clone().into_owned()));
                let mut same = same.into_iter().flatten().copied();
                // A user's preset may be named like the one that it is made from.
                let is_user = preset.vendor.is_none();
                let near =
                    |&other: &usize| self.presets[other].file == preset.file && !(is_user && other == index);
                let found = same.clone().find(|other| near(other)).or_else(|| {
                    // A vendor's bundle is complete, if in several files; a user's preset is of what is there.
                    let is_its = |other: usize| self.presets[other].vendor == preset.vendor;
                    same.find(|&other| if is_user { other != index } else { is_its(other) })
                });
                match found {
                    Some(found) => parents.push((found, line.line)),
                    None if preset.is_complete() => {}
                    None => return Err((name.clone().into_owned(), line.line)),
                }
            }
        }
        Ok(parents)
    }

    /// Every value of a preset, its own and those it inherits.
    ///
    /// # Errors
    /// A parent that is not there; presets that inherit in a circle, or too many one of the other.
    pub fn values(&self, preset: &Preset) -> Result<Vec<Found<'_>>, PresetError> {
        let flat = self.flat(self.index(preset), &mut Vec::new(), &mut FxHashMap::default())?;
        let found = flat.iter().map(|(&key, &(preset, line))| {
            let preset = &self.presets[preset];
            let Line { value, line, .. } = &preset.lines[line];
            Found { key, value, place: self.place(preset, *line) }
        });
        Ok(found.collect())
    }

    fn place(&self, preset: &Preset, line: usize) -> Place {
        Place { line, ..preset.listed.place.clone() }
    }

    fn flat<'a>(
        &'a self,
        index: usize,
        open: &mut Vec<usize>,
        known: &mut FxHashMap<usize, Rc<Flat<'a>>>,
    ) -> Result<Rc<Flat<'a>>, PresetError> {
        if let Some(flat) = known.get(&index) {
            return Ok(flat.clone());
        }
        let preset = &self.presets[index];
        let at = |line| self.place(preset, line);
        let parents = self.parents(index).map_err(|(name, line)| {
            PresetError::at(at(line), format!("inherits from `{name}`, which is not there"))
        })?;
        open.push(index);
        let mut flat = Flat::new();
        for (parent, line) in parents {
            if let Some(first) = open.iter().position(|&open| open == parent) {
                let circle = open[first..].iter().chain([&parent]);
                let names: Vec<&str> = circle.map(|&index| self.presets[index].name.as_str()).collect();
                let message = format!("presets inherit in a circle: {}", names.join(" → "));
                return Err(PresetError::at(at(line), message));
            }
            if open.len() >= limits::PROFILE_DEPTH {
                let message = format!("more than {} presets inherit one of the other", limits::PROFILE_DEPTH);
                return Err(PresetError::at(at(line), message));
            }
            flat.extend(self.flat(parent, open, known)?.iter().filter(|(key, _)| **key != "renamed_from"));
        }
        open.pop();
        for (number, line) in preset.lines.iter().enumerate() {
            flat.insert(&line.key, (index, number));
        }
        let flat = Rc::new(flat);
        known.insert(index, flat.clone());
        Ok(flat)
    }

    /// One value of a preset, its own or inherited; that of the parent named last, where several have it.
    pub fn value(&self, preset: &Preset, key: &str) -> Option<&str> {
        self.value_of(self.index(preset), key, &mut FxHashSet::default())
    }

    fn value_of(&self, index: usize, key: &str, seen: &mut FxHashSet<usize>) -> Option<&str> {
        // One that was looked at had no such value, or is looked at right now.
        if !seen.insert(index) || seen.len() > limits::PROFILES {
            return None;
        }
        let own = self.presets[index].lines.iter().rev().find(|line| line.key == key);
        own.map(|line| line.value.as_str()).or_else(|| {
            let parents = self.parents(index).ok()?;
            parents.into_iter().rev().find_map(|(parent, _)| self.value_of(parent, key, seen))
        })
    }

    /// The vendor of a preset, or of the one that a user's preset is made from.
    pub fn vendor<'a>(&'a self, preset: &'a Preset) -> Option<&'a str> {
        let mut preset = preset;
        for _ in 0..limits::PROFILE_DEPTH {
            if let Some(vendor) = &preset.vendor {
                return Some(vendor);
            }
            let (parent, _) = *self.parents(self.index(preset)).ok()?.first()?;
            preset = &self.presets[parent];
        }
        None
    }

    /// What a preset says it was made from; of a vendor's preset that is nobody's business.
    pub fn made_from<'a>(&self, preset: &'a Preset) -> &'a str {
        let own = preset.lines.iter().rfind(|line| line.key == "inherits" && preset.vendor.is_none());
        own.map(|line| line.value.as_str()).unwrap_or_default()
    }
}

impl Preset {
    /// Whether it states so much that it needs nothing of others: users' presets are written whole.
    fn is_complete(&self) -> bool {
        let telling = TELLING.iter().filter(|(kind, _)| *kind == self.kind).flat_map(|(_, keys)| keys);
        self.vendor.is_none() && telling.into_iter().all(|key| self.lines.iter().any(|line| line.key == *key))
    }
}

impl Dialect {
    /// PrusaSlicer's, or SuperSlicer's where a line is of the kind that only that one writes.
    fn of_sections(sections: &[Section]) -> Self {
        let mut lines = sections.iter().flat_map(|section| &section.lines);
        let is_super = lines.any(|line| superslicer::is_own_line(&line.key, &line.value));
        if is_super { Self::Super } else { Self::Prusa }
    }
}

fn unreadable(path: &Path, message: String) -> PresetError {
    PresetError::of(format!("{}: {message}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bundles(text: &str) -> Bundles {
        let mut bundles = Bundles::default();
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        bundles.add_sections("b.ini", ini::sections(&lines), None);
        bundles
    }

    fn values(bundles: &Bundles, name: &str) -> Result<BTreeMap<String, (String, usize)>, String> {
        let preset = bundles.find(Kind::Print, name).ok_or("not there")?;
        let found = bundles.values(preset).map_err(|error| error.to_string())?;
        Ok(found.into_iter().map(|f| (f.key.to_owned(), (f.value.to_owned(), f.place.line))).collect())
    }

    #[test]
    fn of_several_parents_the_later_one_wins_and_a_preset_over_them() {
        let bundles = bundles(
            "[vendor]\nname = V\n[print:*a*]\nx = 1\ny = 1\nz = 1\nrenamed_from = old\n[print:*b*]\ny = 2\nz = 2\n\
             [print:A]\ninherits = *a*; *b*\nz = 3\n",
        );
        let values = values(&bundles, "A").unwrap();
        let numbers = ["x", "y", "z"].map(|key| values[key].clone());
        assert_eq!(numbers, [("1".into(), 4), ("2".into(), 9), ("3".into(), 13)]);
        assert!(!values.contains_key("renamed_from"), "a former name is of one preset");
        let preset = bundles.find(Kind::Print, "A").unwrap();
        let alone = ["x", "y", "z"].map(|key| bundles.value(preset, key));
        assert_eq!(alone, [Some("1"), Some("2"), Some("3")]);
        let names: Vec<&str> = bundles.chosable(Kind::Print).map(|preset| preset.name.as_str()).collect();
        assert_eq!(names, ["A"]);
    }

    #[test]
    fn a_bundle_may_name_the_files_that_it_is_in() {
        let files = Files::given(
            [
                ("a/v.ini", "[vendor]\n[Path:Base]\n  base =base/b.ini\n[Path:M]\n  print =m/p.ini \n"),
                ("a/base/b.ini", "[vendor]\nname = V\n[print:*c*]\nx = 1\n"),
                ("a/m/p.ini", "[print:P]\ninherits = *c*\ny = 2\n"),
            ]
            .map(|(path, text)| (PathBuf::from(path), text.into())),
        );
        let mut bundles = Bundles::default();
        bundles.add_file(&files, Path::new("a/v.ini"), None).unwrap();
        let keys: Vec<String> = values(&bundles, "P").unwrap().into_keys().collect();
        assert_eq!(keys, ["inherits", "x", "y"]);
        let preset = bundles.find(Kind::Print, "P").unwrap();
        assert_eq!((preset.vendor.as_deref(), &*preset.listed.place.file), (Some("V"), "a/m/p.ini"));
        let error = bundles.add_file(&files, Path::new("a/m/none.ini"), None).unwrap_err().to_string();
        assert!(error.starts_with("a/m/none.ini: cannot be read"), "{error}");
    }

    #[test]
    fn a_circle_and_a_parent_that_is_missing_are_named_with_their_line() {
        let bundles = bundles(
            "[vendor]\n[print:A]\ninherits = B\n[print:B]\ninherits = C\n[print:C]\n\ninherits = B\n[print:D]\ninherits = E\n",
        );
        let circle = values(&bundles, "A").unwrap_err();
        assert_eq!(circle, "b.ini:8 [print:C]: presets inherit in a circle: B → C → B");
        let missing = values(&bundles, "D").unwrap_err();
        assert_eq!(missing, "b.ini:10 [print:D]: inherits from `E`, which is not there");
        assert_eq!(bundles.value(bundles.find(Kind::Print, "A").unwrap(), "x"), None, "and no hang");
    }

    #[test]
    fn ancestors_that_meet_again_and_again_are_read_once() {
        let mut text = "[vendor]\n[print:0]\nx = 1\n".to_owned();
        for n in 1..30 {
            text += &format!("[print:{n}]\ninherits = {};{}\ny = {n}\n", n - 1, n - 1);
        }
        let bundles = bundles(&text);
        assert_eq!(values(&bundles, "29").unwrap()["x"], ("1".into(), 3));
        assert_eq!(bundles.value(bundles.find(Kind::Print, "29").unwrap(), "z"), None);
    }

    #[test]
    fn a_users_preset_wins_and_may_inherit_from_a_vendors_of_the_same_name() {
        let mut bundles = bundles("[vendor]\n[print:A]\nx = 1\ny = 1\n");
        bundles.add_sections(
            "u.ini",
            ini::sections(&["[print:A]", "inherits = A", "x = 2"].map(str::to_owned)),
            None,
        );
        let values = values(&bundles, "A").unwrap();
        assert_eq!(values["x"].0, "2");
        assert_eq!(values["y"].0, "1");
    }

    #[test]
    fn a_complete_preset_of_a_user_needs_no_parent() {
        let bundles =
            bundles("[print:A]\ninherits = gone\nlayer_height = 0.2\nperimeters = 2\nfill_density = 5%\n");
        assert_eq!(values(&bundles, "A").unwrap()["perimeters"].0, "2");
    }
}
