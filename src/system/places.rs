//! Where presets are looked for: what the user names, and the folders of the slicers that there are.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crate::presets::{Dialect, Source};

/// The environment variable that names more folders and files, like `PATH`.
pub(super) const VARIABLE: &str = "PATHWRIGHT_PRESETS";

/// The environment variable that names the file of print hosts.
#[cfg(feature = "send")]
pub const HOSTS: &str = "PATHWRIGHT_HOSTS";

/// What an operating system calls its folders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum System {
    Linux,
    MacOs,
    Windows,
}

impl System {
    fn this() -> Self {
        match std::env::consts::OS {
            "windows" => Self::Windows,
            "macos" => Self::MacOs,
            _ => Self::Linux,
        }
    }
}

/// A slicer, and what its folders are called.
struct Slicer {
    dialect: Dialect,
    /// In the folder of settings of a user; `*` stands for any version.
    settings: &'static str,
    /// Of a flatpak.
    flatpak: &'static str,
    /// On Linux, where packages put what is shared by all users.
    linux: &'static [&'static str],
    /// Under `/Applications`.
    macos: &'static [&'static str],
    /// Under the folder of programs.
    windows: &'static [&'static str],
}

/// Those with presets of their own first.
const SLICERS: &[Slicer] = &[
    Slicer {
        dialect: Dialect::Prusa,
        settings: "PrusaSlicer",
        flatpak: "com.prusa3d.PrusaSlicer",
        linux: &["PrusaSlicer/profiles", "prusa-slicer/profiles"],
        macos: &[
            "PrusaSlicer.app/Contents/Resources/profiles",
            "Original Prusa Drivers/PrusaSlicer.app/Contents/Resources/profiles",
        ],
        windows: &["Prusa3D/PrusaSlicer/resources/profiles"],
    },
    Slicer {
        dialect: Dialect::Super,
        settings: "SuperSlicer",
        flatpak: "com.github.superslicer.SuperSlicer",
        linux: &["SuperSlicer/profiles", "superslicer/profiles"],
        macos: &["SuperSlicer.app/Contents/Resources/profiles"],
        windows: &["SuperSlicer/resources/profiles"],
    },
    Slicer {
        dialect: Dialect::Orca,
        settings: "OrcaSlicer",
        flatpak: "com.orcaslicer.OrcaSlicer",
        linux: &["OrcaSlicer/profiles", "orca-slicer/profiles"],
        macos: &["OrcaSlicer.app/Contents/Resources/profiles"],
        windows: &["OrcaSlicer/resources/profiles"],
    },
    Slicer {
        dialect: Dialect::Orca,
        settings: "OrcaSlicer",
        flatpak: "io.github.softfever.OrcaSlicer",
        linux: &[],
        macos: &[],
        windows: &[],
    },
    Slicer {
        dialect: Dialect::Orca,
        settings: "BambuStudio",
        flatpak: "com.bambulab.BambuStudio",
        linux: &["BambuStudio/profiles", "bambu-studio/profiles"],
        macos: &["BambuStudio.app/Contents/Resources/profiles"],
        windows: &["Bambu Studio/resources/profiles"],
    },
    Slicer {
        dialect: Dialect::Orca,
        settings: "Creality/Creality Print/*",
        flatpak: "io.github.crealityofficial.CrealityPrint",
        linux: &["CrealityPrint/profiles"],
        macos: &["Creality Print.app/Contents/Resources/profiles"],
        windows: &["Creality/Creality Print */resources/profiles"],
    },
    Slicer {
        dialect: Dialect::Cura,
        settings: "cura/*",
        flatpak: "com.ultimaker.cura",
        linux: &["cura/resources"],
        macos: &[
            "UltiMaker Cura.app/Contents/Resources/share/cura/resources",
            "Ultimaker Cura.app/Contents/Resources/share/cura/resources",
        ],
        windows: &["UltiMaker Cura */share/cura/resources", "Ultimaker Cura */share/cura/resources"],
    },
];

/// Every place where presets may be, those that win first; `*` in a name stands for any text.
///
/// `named`: what the user names; `variable`: the value of an environment variable.
pub(super) fn places(
    named: &[PathBuf],
    system: System,
    home: Option<&Path>,
    variable: impl Fn(&str) -> Option<OsString>,
) -> Vec<Source> {
    let of = |dialect| move |path: PathBuf| Source { path, dialect };
    let mut places: Vec<Source> = named.iter().cloned().map(of(None)).collect();
    let more = variable(VARIABLE).unwrap_or_default();
    places.extend(std::env::split_paths(&more).filter(|path| !path.as_os_str().is_empty()).map(of(None)));
    let folder = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let in_home = |path: &str| home.map(|home| home.join(path));
    let settings = settings_folder(system, home, &variable);
    let data = match system {
        System::Linux => folder("XDG_DATA_HOME").or_else(|| in_home(".local/share")),
        System::MacOs | System::Windows => None,
    };
    places.extend(settings.iter().map(|folder| folder.join("pathwright/presets")).map(of(None)));
    for slicer in SLICERS {
        let mut add = |path: PathBuf| {
            let place = Source { path, dialect: Some(slicer.dialect) };
            if !places.contains(&place) {
                places.push(place);
            }
        };
        for folder in settings.iter().chain(&data) {
            add(folder.join(slicer.settings));
        }
        match system {
            System::Linux => {
                let (name, flatpak) = (slicer.settings, slicer.flatpak);
                for kind in ["config", "data"] {
                    in_home(&format!(".var/app/{flatpak}/{kind}/{name}")).map(&mut add);
                }
                in_home(&format!("snap/*/current/.config/{name}")).map(&mut add);
                let installed =
                    in_home(".local/share/flatpak").into_iter().chain([PathBuf::from("/var/lib/flatpak")]);
                let installed: Vec<PathBuf> = installed
                    .map(|root| root.join(format!("app/{flatpak}/current/active/files/share")))
                    .collect();
                let shared = ["/usr/local/share", "/usr/share", "/opt", "/snap/*/current/usr/share"];
                let shared = shared.iter().map(PathBuf::from).chain(installed);
                for folder in shared {
                    slicer.linux.iter().for_each(|name| add(folder.join(name)));
                }
            }
            System::MacOs => {
                let applications =
                    in_home("Applications").into_iter().chain([PathBuf::from("/Applications")]);
                for folder in applications {
                    slicer.macos.iter().for_each(|name| add(folder.join(name)));
                }
            }
            System::Windows => {
                let programs =
                    ["ProgramW6432", "ProgramFiles", "LOCALAPPDATA"].into_iter().filter_map(&folder);
                for folder in programs {
                    slicer.windows.iter().for_each(|name| add(folder.join(name)));
                }
            }
        }
    }
    places
}

/// Where programs keep a user's settings.
fn settings_folder(
    system: System,
    home: Option<&Path>,
    variable: impl Fn(&str) -> Option<OsString>,
) -> Option<PathBuf> {
    let folder = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let in_home = |path: &str| home.map(|home| home.join(path));
    match system {
        System::Linux => folder("XDG_CONFIG_HOME").or_else(|| in_home(".config")),
        System::MacOs => in_home("Library/Application Support"),
        System::Windows => folder("APPDATA").or_else(|| in_home("AppData/Roaming")),
    }
}

/// The file of print hosts on this machine: what is given, what the variable names, or beside other settings.
#[cfg(feature = "send")]
pub fn hosts_file(given: Option<&Path>) -> Option<PathBuf> {
    let folder =
        || settings_folder(System::this(), std::env::home_dir().as_deref(), |name| std::env::var_os(name));
    let named = given.map(Path::to_owned).or_else(|| std::env::var_os(HOSTS).map(PathBuf::from));
    named.or_else(|| Some(folder()?.join("pathwright/hosts.toml")))
}

/// The places of this machine.
pub(super) fn of_this_machine(named: &[PathBuf]) -> Vec<Source> {
    places(named, System::this(), std::env::home_dir().as_deref(), |name| std::env::var_os(name))
}

/// Those places that are there, one for each folder that a name with `*` stands for, later versions first.
pub(super) fn existing(places: &[Source]) -> Vec<Source> {
    let expanded = places.iter().flat_map(|place| {
        expanded(&place.path).into_iter().map(|path| Source { path, dialect: place.dialect })
    });
    expanded.filter(|place| place.path.exists()).collect()
}

fn expanded(path: &Path) -> Vec<PathBuf> {
    let mut found = vec![PathBuf::new()];
    for part in path.components() {
        let name = part.as_os_str().to_string_lossy();
        let Some((start, end)) = name.split_once('*') else {
            found.iter_mut().for_each(|path| path.push(part));
            continue;
        };
        let folders = |folder: PathBuf| {
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
            let fits = |entry: &std::fs::DirEntry| {
                let name = entry.file_name().to_string_lossy().into_owned();
                name.strip_prefix(start).is_some_and(|rest| rest.ends_with(end))
            };
            let mut paths: Vec<PathBuf> = entries.filter(fits).map(|entry| entry.path()).collect();
            paths.sort_by_key(|path| std::cmp::Reverse(version(path)));
            paths
        };
        found = found.into_iter().flat_map(folders).collect();
    }
    found
}

/// The numbers in a name, and the name: 5.10 is later than 5.9.
fn version(path: &Path) -> (Vec<u64>, OsString) {
    let name = path.file_name().unwrap_or_default();
    let text = name.to_string_lossy();
    let numbers = text.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok());
    (numbers.collect(), name.to_owned())
}

#[cfg(all(test, feature = "cli"))]
mod tests {
    use super::*;

    fn paths(system: System, variables: &[(&str, &str)]) -> Vec<String> {
        let variable = |name: &str| {
            variables.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value))
        };
        let places = places(&["mine.ini".into()], system, Some(Path::new("/home/me")), variable);
        places.iter().map(|place| place.path.to_string_lossy().replace('\\', "/")).collect()
    }

    #[test]
    fn what_the_user_names_comes_before_what_slicers_have() {
        let variable = if cfg!(windows) { "/a;/b" } else { "/a:/b" };
        let linux = paths(System::Linux, &[(VARIABLE, variable)]);
        assert_eq!(
            linux[..5],
            ["mine.ini", "/a", "/b", "/home/me/.config/pathwright/presets", "/home/me/.config/PrusaSlicer"]
        );
        let flatpak = "/home/me/.var/app/com.prusa3d.PrusaSlicer/config/PrusaSlicer";
        for path in [
            flatpak,
            "/home/me/.config/BambuStudio",
            "/home/me/.local/share/cura/*",
            "/usr/share/cura/resources",
        ] {
            assert!(linux.contains(&path.to_owned()), "{path}: {linux:#?}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn every_system_has_its_own_folders() {
        let moved = paths(System::Linux, &[("XDG_CONFIG_HOME", "/elsewhere")]);
        assert!(moved.contains(&"/elsewhere/OrcaSlicer".into()), "{moved:#?}");
        let ignored = paths(System::Linux, &[("XDG_CONFIG_HOME", "relative")]);
        assert!(
            ignored.contains(&"/home/me/.config/OrcaSlicer".into()),
            "as the standard of such folders has it"
        );
        let mac = paths(System::MacOs, &[]);
        assert!(mac.contains(&"/home/me/Library/Application Support/SuperSlicer".into()), "{mac:#?}");
        assert!(mac.contains(&"/Applications/OrcaSlicer.app/Contents/Resources/profiles".into()), "{mac:#?}");
        let windows = paths(System::Windows, &[("APPDATA", "/r"), ("ProgramFiles", "/p")]);
        assert!(windows.contains(&"/r/Creality/Creality Print/*".into()), "{windows:#?}");
        assert!(windows.contains(&"/p/Prusa3D/PrusaSlicer/resources/profiles".into()), "{windows:#?}");
    }

    #[test]
    fn later_versions_come_first() {
        let folder = tempfile::tempdir().unwrap();
        for version in ["5.9", "5.10", "4.2"] {
            std::fs::create_dir_all(folder.path().join("cura").join(version)).unwrap();
        }
        let place = Source { path: folder.path().join("cura/*"), dialect: Some(Dialect::Cura) };
        let gone = Source { path: folder.path().join("gone"), dialect: None };
        let names: Vec<String> = existing(&[gone, place])
            .iter()
            .map(|place| place.path.file_name().unwrap().to_string_lossy().into_owned())
            .collect();
        assert_eq!(names, ["5.10", "5.9", "4.2"]);
    }
}
