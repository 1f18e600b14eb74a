//! Tests with what others made, which lies beside the project in `../shared`: models, G-code, an independent reader.
//! A test whose files are not there, or whose Python is not, is listed as ignored and says what it misses.

#[path = "../support/mod.rs"]
mod support;

mod gcode;
mod gcode_time;
mod gcode_yardstick;
mod macros;
mod models;
mod preset_keys;
mod preset_scripts;
mod presets;
mod profile;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use libtest_mimic::{Arguments, Trial};

/// A file or folder of the shared ones.
fn shared(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name)
}

/// Those of some shared files that are there, of which there must be one.
fn present(names: &[&str]) -> Vec<PathBuf> {
    let paths: Vec<PathBuf> = names.iter().map(|name| shared(name)).filter(|path| path.exists()).collect();
    assert!(!paths.is_empty(), "none of {names:?} is in ../shared");
    paths
}

/// The shared files in a folder with this extension, of which there must be one.
fn listed(folder: &str, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(shared(folder)).expect("a folder").flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|found| found == extension));
    files.sort();
    assert!(!files.is_empty(), "{folder} holds no {extension}");
    files
}

fn python() -> bool {
    let mut command = Command::new("python3");
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// What a test needs.
enum Need {
    Shared(&'static str),
    Python,
}

impl Need {
    /// What to call it where it is missing.
    fn missing(&self) -> Option<String> {
        match self {
            Self::Shared(name) => (!shared(name).exists()).then(|| format!("no ../shared/{name}")),
            Self::Python => (!python()).then(|| "no python3".into()),
        }
    }
}

/// The tests of a list, each with what it needs.
macro_rules! trials {
    ($($test:path: $($need:expr),+;)*) => {
        vec![$(trial(stringify!($test), &[$($need),+], $test)),*]
    };
}

fn trial(name: &str, needs: &[Need], test: fn()) -> Trial {
    let missing = needs.iter().find_map(Need::missing);
    let ignored = missing.is_some();
    let run = move || {
        test();
        Ok(())
    };
    Trial::test(name, run).with_kind(missing.unwrap_or_default()).with_ignored_flag(ignored)
}

const GCODE: Need = Need::Shared("gcode");
const MODELS: Need = Need::Shared("models");
const PRESETS: Need = Need::Shared("presets/vendor");
const YARDSTICK: Need = Need::Shared("tools/gcode_yardstick.py");

fn main() -> ExitCode {
    let trials = trials! {
        gcode::other_slicers_files_have_no_errors: GCODE;
        gcode::files_of_other_slicers_print_the_same_afterwards: GCODE;
        gcode_time::print_times_agree_with_klippers_planner_within_a_thousandth: GCODE;
        gcode_yardstick::an_independent_reader_finds_the_same_and_no_fault: YARDSTICK, Need::Python;
        macros::scripts_and_conditions_of_presets_are_read: Need::Shared("presets/vendor");
        models::full_prints_deposit_the_volume_of_the_mesh: MODELS;
        models::sparse_infill_fills_its_share: MODELS;
        models::an_independent_reader_finds_no_fault_and_the_same_figures: MODELS, YARDSTICK, Need::Python;
        models::models_have_the_volume_that_is_known_of_them: MODELS;
        models::sections_agree_with_an_independent_cut: MODELS;
        presets::resolved_configurations_are_those_of_the_slicer: PRESETS;
        presets::printers_with_several_extruders_print_two_parts: PRESETS;
        presets::every_preset_of_a_vendor_resolves: PRESETS;
        presets::what_fits_a_printer_is_what_fits_it_in_the_slicer: PRESETS;
        preset_scripts::scripts_are_expanded_as_by_their_slicer: PRESETS;
        preset_scripts::scripts_of_configurations_that_leave_defaults_out_expand_alike: PRESETS;
        preset_scripts::filaments_are_taken_out_and_put_in_at_changes: PRESETS;
        preset_keys::most_keys_of_presets_are_taken_over: PRESETS;
        preset_keys::configurations_of_printers_resolve: PRESETS;
        preset_keys::limits_are_stated_as_their_slicer_states_them: PRESETS;
        profile::whole_configurations_in_gcode_resolve: GCODE;
        profile::the_standard_job_of_others_gives_ours: Need::Shared("peers/prusa.ini");
    };
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
