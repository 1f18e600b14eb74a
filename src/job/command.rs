//! The command line that prints what a project prints.

use super::model::ModelFiles;
use super::project::{ModelRole, Project, ProjectModel};

impl Project {
    /// The command line that gives the same bytes, run where its models are; `None`: only the project saved as a file does.
    /// `files` tell how many objects each has.
    pub fn command(&self, files: &ModelFiles) -> Option<String> {
        let is_whole = |model: &ProjectModel| match model.object {
            None => true,
            Some(object) => {
                object == 0 && files.get(&model.file).is_some_and(|file| file.objects().len() == 1)
            }
        };
        let parts: Vec<&ProjectModel> = self.of(ModelRole::Part).collect();
        let first = *parts.first()?;
        let is_alike = |model: &ProjectModel| {
            (model.scale, model.rotate_deg) == (first.scale, first.rotate_deg)
                && model.at_mm.is_none()
                && is_whole(model)
                && (model.role != ModelRole::Part || model.copies == first.copies)
        };
        let is_simple = self.profile.trim().is_empty() && first.scale.iter().all(|factor| *factor > 0.0);
        if !is_simple || !self.models.iter().all(is_alike) {
            return None;
        }
        let mut words = vec!["pathwright".to_owned(), "slice".to_owned()];
        words.extend(parts.iter().map(|model| path(&model.file)));
        let mut option = |name: &str, value: String| words.extend([name.to_owned(), quoted(&value)]);
        let list = |numbers: [f64; 3]| numbers.map(|x| x.to_string()).join(",");
        match first.scale {
            [1.0, 1.0, 1.0] => {}
            [x, y, z] if x == y && y == z => option("--scale", x.to_string()),
            scale => option("--scale", list(scale)),
        }
        if first.rotate_deg != [0.0; 3] {
            option("--rotate", list(first.rotate_deg));
        }
        if first.copies > 1 {
            option("--copies", first.copies.to_string());
        }
        let presets = &self.presets;
        for (name, preset) in
            [("--printer", &presets.printer), ("--print", &presets.print), ("--filament", &presets.filament)]
        {
            preset.iter().for_each(|preset| option(name, preset.clone()));
        }
        self.profiles.iter().for_each(|profile| option("--profile", profile.clone()));
        self.settings.iter().for_each(|(key, value)| option("--set", format!("{key}={value}")));
        for model in parts.iter().filter(|model| !model.settings.is_empty()) {
            // A name means all that are called so.
            if parts.iter().filter(|other| other.file == model.file).count() > 1 || is_3mf(&model.file) {
                return None;
            }
            let settings = model.settings.iter();
            settings.for_each(|(key, value)| option("--object", format!("{}:{key}={value}", model.file)));
        }
        self.of(ModelRole::SupportEnforcer).for_each(|body| option("--support-enforcer", body.file.clone()));
        self.of(ModelRole::SupportBlocker).for_each(|body| option("--support-blocker", body.file.clone()));
        self.pauses.iter().for_each(|at| option("--pause-at", at.clone()));
        self.color_changes.iter().for_each(|at| option("--color-change-at", at.clone()));
        let switches = [(self.allow_floating, "--allow-floating"), (self.certify, "--certify")];
        words.extend(switches.iter().filter(|switch| switch.0).map(|switch| switch.1.to_owned()));
        Some(words.join(" "))
    }

    fn of(&self, role: ModelRole) -> impl Iterator<Item = &ProjectModel> {
        self.models.iter().filter(move |model| model.role == role)
    }
}

/// Names of objects in such a file may be those of files.
fn is_3mf(file: &str) -> bool {
    file.to_ascii_lowercase().ends_with(".3mf")
}

/// A file's name that is not taken for an option.
fn path(name: &str) -> String {
    if name.starts_with('-') { quoted(&format!("./{name}")) } else { quoted(name) }
}

/// A word as a POSIX shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-+./,=%:@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        assert_eq!(quoted("walls.count=3"), "walls.count=3");
        assert_eq!(quoted("a b's"), r"'a b'\''s'");
        assert_eq!(quoted(""), "''");
        assert_eq!(path("-x.stl"), "./-x.stl");
    }
}
