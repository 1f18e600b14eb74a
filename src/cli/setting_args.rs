//! Arguments that many commands share: settings and presets, exit codes.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint};

pub(super) const EXIT_CODES: &str = "\
Exit codes:
  0    done
  2    usage: invalid arguments
  3    a file is unreadable, invalid or too large, or there is nothing to print
  4    settings: unknown profile or key, value out of range, conflict, error in a script
  5    the models do not fit the printer, or cannot be printed one after the other
  6    the output cannot be written
  7    a check of the result or of the given file failed, or a part would start in mid-air
  8    --timeout is over
  9    --max-memory does not suffice
  10   a print host cannot be reached, is not trusted, or failed
  11   a print host refuses: key, name, space, or its printer is not ready
  12   the print that was waited for was cancelled or failed
  130  interrupted";

#[derive(Debug, Args)]
pub(super) struct PresetArgs {
    /// Printer preset of another slicer, or a project (3MF) with its settings; `pathwright printers` lists them. Profiles
    /// and --set win over presets
    #[arg(long, value_name = "NAME", help_heading = "Settings")]
    pub printer: Option<String>,

    /// Print preset that goes with --printer [default: the printer's own]
    #[arg(long, value_name = "NAME", requires = "printer", help_heading = "Settings")]
    pub print: Option<String>,

    /// Filament preset that goes with --printer [default: the printer's own]
    #[arg(long, value_name = "NAME", requires = "printer", help_heading = "Settings")]
    pub filament: Option<String>,

    /// File or folder of presets, before $PATHWRIGHT_PRESETS and the folders of the slicers on this machine; repeatable
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath, help_heading = "Settings")]
    pub presets: Vec<PathBuf>,
}

#[derive(Debug, Args)]
pub(super) struct SettingArgs {
    #[command(flatten)]
    pub presets: PresetArgs,

    /// Embedded profile, TOML file, or configuration of PrusaSlicer or SuperSlicer (.ini, .gcode, .bgcode); repeatable,
    /// the later one wins
    #[arg(short, long, value_name = "NAME|PATH", help_heading = "Settings")]
    pub profile: Vec<String>,

    /// One setting, such as walls.count=3 or infill.density=15%; repeatable, wins over profiles
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = assignment, help_heading = "Settings")]
    pub set: Vec<Assignment>,

    /// Leave out scripts that cannot be expanded, instead of refusing the print [gcode.ignore_scripts]
    #[arg(long, help_heading = "Settings")]
    pub ignore_scripts: bool,
}

/// `KEY=VALUE`.
#[derive(Clone, Debug)]
pub(super) struct Assignment {
    pub key: String,
    pub value: String,
}

pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    let time = text.trim().parse::<f64>().ok().filter(|seconds| *seconds > 0.0);
    let time = time.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| "a number of seconds above 0 is expected, such as 60".into())
}

pub(super) fn assignment(text: &str) -> Result<Assignment, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok(Assignment { key: key.trim().to_owned(), value: value.to_owned() })
        }
        _ => Err("KEY=VALUE is expected, such as walls.count=3".into()),
    }
}
