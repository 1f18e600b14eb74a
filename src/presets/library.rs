//! All presets that there are: one found by its name, what fits it, and the three that print together.

use super::config::{Config, Dialect};
use super::cura::{self, Cura};
use super::error::PresetError;
use super::family::{Family, Kind, Listed, Source};
use super::files::Files;
use super::ini;
use super::orca::{self, Orca};
use super::prusa::Prusa;
use crate::near;

/// How many names a message lists.
const NAMED: usize = 10;

/// Presets from files and folders.
#[derive(Debug)]
pub struct Library {
    /// In the order of their first sources.
    families: Vec<Box<dyn Family>>,
    problems: Vec<PresetError>,
}

/// A printer, a print and a filament preset, and what they come to.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The printer preset.
    pub printer: Listed,
    /// The print preset.
    pub print: Listed,
    /// The filament preset.
    pub filament: Listed,
    /// Names of the print presets that fit the printer.
    pub prints: Vec<String>,
    /// Names of the filament presets that fit the printer and the print.
    pub filaments: Vec<String>,
    /// The three as one.
    pub config: Config,
    /// What is to be known of the choice.
    pub notes: Vec<String>,
}

/// Reads a family from sources; what cannot be read becomes a problem.
type Read = fn(&Files, &[&Source], &mut Vec<PresetError>) -> Box<dyn Family>;

/// A way to write presets.
struct Way {
    /// Whose it is.
    dialects: &'static [Dialect],
    /// Whether a file of that name, in small letters, may be of it.
    is_of_name: fn(&str) -> bool,
    /// Reads a family from sources.
    read: Read,
}

const WAYS: [Way; 3] = [
    Way {
        dialects: &[Dialect::Prusa, Dialect::Super],
        is_of_name: |name| !name.ends_with(".json") && !cura::is_file(name),
        read: |files, sources, problems| Box::new(Prusa::read(files, sources, problems)),
    },
    Way {
        dialects: &[Dialect::Orca],
        is_of_name: orca::is_preset,
        read: |files, sources, problems| Box::new(Orca::read(files, sources, problems)),
    },
    Way {
        dialects: &[Dialect::Cura],
        is_of_name: cura::is_preset,
        read: |files, sources, _| Box::new(Cura::read(files, sources)),
    },
];

/// Whether a source may hold presets of a way. Files are known by their names, folders may hold any.
fn may_hold(files: &Files, source: &Source, way: &Way) -> bool {
    let name = source.path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match source.dialect {
        Some(dialect) => way.dialects.contains(&dialect),
        None => files.is_dir(&source.path) || (way.is_of_name)(&name),
    }
}

/// Whether a file of that name may be read as presets, so that it is to be given.
pub fn is_preset_file(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    ini::is_preset(&name) || orca::is_preset(&name) || cura::is_file(&name)
}

impl Library {
    /// Reads what is in files and folders of this machine, those first that win where names are the same. What is not there is
    /// passed over.
    pub fn open(sources: &[Source]) -> Self {
        Self::open_in(&Files::default(), sources)
    }

    /// The same of files and folders from elsewhere.
    pub fn open_in(files: &Files, sources: &[Source]) -> Self {
        let there: Vec<&Source> = sources.iter().filter(|source| files.exists(&source.path)).collect();
        let mut problems = Vec::new();
        let mut families: Vec<(usize, Box<dyn Family>)> = Vec::new();
        for way in &WAYS {
            let Some(first) = there.iter().position(|source| may_hold(files, source, way)) else { continue };
            let own: Vec<&Source> =
                there.iter().filter(|source| may_hold(files, source, way)).copied().collect();
            families.push((first, (way.read)(files, &own, &mut problems)));
        }
        families.sort_by_key(|(first, _)| *first);
        let families = families.into_iter().map(|(_, family)| family).collect();
        Self { families, problems }
    }

    /// What could not be read.
    pub fn problems(&self) -> &[PresetError] {
        &self.problems
    }

    /// Every preset of a kind, those of one name in the order in which they are taken.
    pub fn listed(&self, kind: Kind) -> Vec<&Listed> {
        self.families.iter().flat_map(|family| family.listed(kind)).collect()
    }

    /// One preset with all that it inherits; of a printer also what the slicer has built in: bed, nozzle, firmware.
    ///
    /// # Errors
    /// It is not there, or does not resolve.
    pub fn preset(&self, kind: Kind, name: &str) -> Result<Config, PresetError> {
        let found = self.find(kind, name)?;
        found.family.preset(kind, &found.listed.name)
    }

    /// Every preset of a name, with whom to ask about it.
    fn named(&self, kind: Kind, name: &str) -> Vec<(&dyn Family, &Listed)> {
        let families = self.families.iter().map(AsRef::as_ref);
        families.flat_map(|family| family.named(kind, name).into_iter().map(move |l| (family, l))).collect()
    }

    /// The preset of that name, or of that former name; capitals do not count where it is clear what is meant.
    fn find(&self, kind: Kind, name: &str) -> Result<Found<'_>, PresetError> {
        let mut named = self.named(kind, name);
        if named.is_empty() {
            let now = self.families.iter().find_map(|family| family.renamed(kind, name));
            named = now.map(|now| self.named(kind, now)).unwrap_or_default();
        }
        if named.is_empty() {
            let mut alike = self.listed(kind).into_iter().filter(|l| l.name.eq_ignore_ascii_case(name));
            if let Some(first) = alike.next().filter(|first| alike.all(|other| other.name == first.name)) {
                named = self.named(kind, &first.name);
            }
        }
        let Some((&(family, taken), others)) = named.split_first() else {
            return Err(self.unknown(kind, name));
        };
        let mut notes = Vec::new();
        if !taken.name.eq_ignore_ascii_case(name) {
            notes.push(format!("{} preset `{name}` is now called `{}`", kind.name(), taken.name));
        }
        if !others.is_empty() {
            let files: Vec<&str> = others.iter().map(|(_, other)| &*other.place.file).collect();
            let (name, file) = (&taken.name, &taken.place.file);
            let kind = kind.name();
            notes.push(format!("{kind} preset `{name}` is taken from {file}, not from {}", files.join(", ")));
        }
        Ok(Found { family, listed: taken.clone(), notes })
    }

    fn unknown(&self, kind: Kind, name: &str) -> PresetError {
        let known = self.listed(kind);
        let near = near::names(name, known.iter().map(|listed| listed.name.as_str()), NAMED);
        PresetError::of(match near.as_slice() {
            [] => format!("there is no {} preset `{name}` among {}", kind.name(), known.len()),
            near => format!(
                "there is no {} preset `{name}`; did you mean {}?",
                kind.name(),
                quoted(near.iter().copied())
            ),
        })
    }

    /// A printer with a print and a filament that fit it; those not named are the printer's own choice, or else the first that
    /// fit.
    ///
    /// # Errors
    /// A name that there is not; a print or filament that does not fit, or none that does; presets that do not resolve.
    pub fn choose(
        &self,
        printer: &str,
        print: Option<&str>,
        filament: Option<&str>,
    ) -> Result<Chosen, PresetError> {
        let Found { family, listed: printer, mut notes } = self.find(Kind::Printer, printer)?;
        let at = printer.name.as_str();
        let prints = family.compatible(Kind::Print, at, None)?;
        let preferred = family.preferred(Kind::Print, at, None)?;
        let print = self.pick(family, Kind::Print, print, &prints, &preferred, [at, at], &mut notes)?;
        let filaments = family.compatible(Kind::Filament, at, Some(&print.name))?;
        let preferred = family.preferred(Kind::Filament, at, Some(&print.name))?;
        let whole = format!("{at}` with `{}", print.name);
        let filament =
            self.pick(family, Kind::Filament, filament, &filaments, &preferred, [at, &whole], &mut notes)?;
        let config = family.resolve(at, &print.name, &filament.name)?;
        Ok(Chosen { printer, print, filament, prints, filaments, config, notes })
    }

    /// One of those that fit: the one that is named, or the first of the preferred ones, or the likest of all. `at`: the printer,
    /// `whole`: what they fit, for messages.
    #[allow(clippy::too_many_arguments)]
    fn pick(
        &self,
        family: &dyn Family,
        kind: Kind,
        named: Option<&str>,
        fitting: &[String],
        preferred: &[String],
        [at, whole]: [&str; 2],
        notes: &mut Vec<String>,
    ) -> Result<Listed, PresetError> {
        let listed = |name: &str| family.named(kind, name).first().copied().cloned();
        let fits = |name: &&String| fitting.contains(name);
        let Some(name) = named else {
            let own = preferred.iter().find(fits);
            // Where none of the vendor's fits, it has forgotten to say so of the one that the printer asks for.
            if own.is_none()
                && !fitting.iter().any(|name| family.is_own(kind, at, name))
                && let Some(asked) = preferred.iter().find_map(|name| listed(name))
            {
                let (kind, name) = (kind.name(), &asked.name);
                notes.push(format!(
                    "{kind} preset `{name}`, which the printer asks for, does not say that it fits `{whole}`; it is taken, as \
                     no other of this vendor does"
                ));
                return Ok(asked);
            }
            let likest = || fitting.iter().min_by_key(|name| family.unlike(kind, at, name));
            let Some(taken) = own.or_else(likest).and_then(|name| listed(name)) else {
                return Err(PresetError::of(format!("no {} preset fits `{whole}`", kind.name())));
            };
            if let (None, Some(asked)) = (own, preferred.first()) {
                let (kind, count, taken) = (kind.name(), fitting.len(), &taken.name);
                notes.push(format!(
                    "{kind} preset `{asked}`, which the printer asks for, is not one of the {count} that fit; \
                     the likest of them is taken: `{taken}`"
                ));
            }
            return Ok(taken);
        };
        let known = listed(name).map(|listed| listed.name);
        let known = known.or_else(|| Some(family.renamed(kind, name)?.to_owned()));
        let known = known.or_else(|| fitting.iter().find(|fits| fits.eq_ignore_ascii_case(name)).cloned());
        if let Some(found) =
            known.clone().filter(|name| fitting.contains(name)).and_then(|name| listed(&name))
        {
            notes.extend(self.find(kind, &found.name).into_iter().flat_map(|found| found.notes));
            return Ok(found);
        }
        let near = near::names(name, fitting.iter().map(String::as_str), NAMED);
        let (mut shown, mut of) = (near, "near to it");
        if shown.is_empty() {
            shown = fitting.iter().take(NAMED).map(String::as_str).collect();
            of = "first";
        }
        let what = match known {
            Some(_) => format!("{} preset `{name}` is not for `{whole}`", kind.name()),
            None => format!("there is no {} preset `{name}`", kind.name()),
        };
        Err(PresetError::of(match fitting.len() {
            0 => format!("{what}; none is for `{whole}`"),
            count if count <= NAMED => {
                format!("{what}; those that fit: {}", quoted(fitting.iter().map(String::as_str)))
            }
            count => format!("{what}; {count} fit, {of}: {}", quoted(shown.into_iter())),
        }))
    }
}

/// A preset with whom to ask about it.
struct Found<'a> {
    family: &'a dyn Family,
    listed: Listed,
    notes: Vec<String>,
}

fn quoted<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
