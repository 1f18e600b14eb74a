//! Arguments as typed. What they mean is decided in [`super::plan`].

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;

use super::deferred::Deferred;
pub(super) use super::setting_args::{Assignment, EXIT_CODES, PresetArgs, SettingArgs};
use super::setting_args::{assignment, seconds};
use crate::estimate::Firmware;
use crate::mesh::UNITS;
use crate::motion::PauseAt;
use crate::order::{CostKind, Effort, OrderStrategy, Scope, SeamPosition};

/// Slices models for RepRap-class printers and orders their toolpaths near-optimally.
#[derive(Debug, Parser)]
#[command(name = "pathwright", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Slice models into G-code
    ///
    /// All models are placed on one plate, side by side, and written to one file next to the first model (part.stl gives
    /// part.gcode), or with --each to one file per model.
    Slice(Deferred<SliceArgs>),
    /// Print the key of a result without slicing: a hash of all that its bytes depend on
    ///
    /// Takes the arguments of `slice` and prints one line for each G-code file that it would write. The key depends on the
    /// contents and names of the models, the settings in force and the version of the program; not on folders or threads.
    Key(Deferred<SliceArgs>),
    /// Compare ordering strategies on the layers of models or finished G-code
    ///
    /// Each model is sliced once; the paths of a G-code file are used as they are. The layers are ordered by each strategy.
    /// The table shows the links (straight lines from path end to path start), a lower bound on their length, and the gap of
    /// each strategy to it.
    Compare(Deferred<CompareArgs>),
    /// Shorten the travel in finished G-code from any slicer
    ///
    /// The paths within each layer are reordered; everything else stays. The result is read back and compared layer by layer
    /// before it replaces anything. If nothing improves, the file is not changed.
    Reorder(Deferred<ReorderArgs>),
    /// Preview a print: an HTML page for the browser, or pictures
    ///
    /// Of a G-code file from any slicer, or of models, which are sliced first. The page is one file that needs no network; it
    /// is written next to the input (part.gcode gives part.html), unless -o names another file or only pictures are requested.
    View(Deferred<ViewArgs>),
    /// Show what models contain, what was repaired, and whether they fit the printer
    Info(Deferred<InfoArgs>),
    /// Estimate the print time of G-code from any slicer
    ///
    /// Moves are planned as the firmware plans them, with the machine's limits and those that the file sets. The time is
    /// reported in total, by role and, with --json, by layer. Heating, homing and pauses are not included.
    Time(Deferred<TimeArgs>),
    /// Check G-code from any slicer before it is printed
    ///
    /// Reports every fault with its line, layer and severity, and exits with code 7 if one is an error. With --model the print
    /// is also compared with its model: missing islands, material outside, beads over air, volume.
    Check(Deferred<CheckArgs>),
    /// Show profiles and settings
    Profiles(Deferred<ProfilesArgs>),
    /// List the printers of other slicers' presets
    ///
    /// Presets are looked for in what --presets names, in $PATHWRIGHT_PRESETS, in the folder pathwright/presets beside other
    /// settings, and in the folders of PrusaSlicer, SuperSlicer, OrcaSlicer, Bambu Studio, Creality Print and Cura.
    Printers(Deferred<PrintersArgs>),
    /// Send G-code to a print host: OctoPrint, Moonraker, PrusaLink or Duet
    ///
    /// The file is checked first, against what the host tells of its printer, and compared afterwards with what is stored
    /// there. `pathwright hosts` shows the hosts that there are.
    #[cfg(feature = "send")]
    Send(Deferred<super::host_args::SendArgs>),
    /// List, test and add print hosts
    ///
    /// They are in a TOML file, pathwright/hosts.toml beside other settings, a table for each: docs/hosts.md.
    #[cfg(feature = "send")]
    Hosts(Deferred<super::host_args::HostsArgs>),
    /// Arrange, slice and look at prints on a page in the browser
    ///
    /// The page is on this machine alone, and needs no network. It ends with Ctrl-C.
    #[cfg(feature = "serve")]
    App(Deferred<super::app::AppArgs>),
    /// Slice for others: a service over HTTP
    ///
    /// Takes jobs, keeps them and their results in a folder, and has the page of `pathwright app`. Answers on this machine
    /// alone unless --listen says otherwise; then a token is needed, and encryption: that of a proxy, or --tls-cert.
    /// docs/service.md describes the requests.
    #[cfg(feature = "serve")]
    Serve(Deferred<super::serve::ServeArgs>),
    /// Print a completion script for a shell
    Completions { shell: Shell },
    /// Print a man page
    Man {
        /// Command to describe; without it, the whole program
        command: Option<String>,
    },
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct SliceArgs {
    #[command(flatten)]
    pub models: ModelArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Write to this file (.bgcode: binary), or into this folder; - for standard output
    #[arg(short, long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub output: Option<PathBuf>,

    /// Write the plate as a project (3MF) instead of slicing it; `slice` of that file gives the same G-code
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["output", "each", "json", "translate", "scale_to_fit"])]
    pub save_project: Option<PathBuf>,

    /// Write one G-code file per model, instead of one plate with all of them
    #[arg(long)]
    pub each: bool,

    /// Number of copies of each model
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub copies: u32,

    /// Print one object after the other, the lowest first [print.sequence]
    #[arg(long, help_heading = "Plate")]
    pub sequential: bool,

    /// Arrange all objects, including those that a file positions relative to each other [plate.keep_layout]
    #[arg(long, help_heading = "Plate", conflicts_with = "no_arrange")]
    pub arrange: bool,

    /// Keep models at the coordinates in their files [plate.arrange]
    #[arg(long, help_heading = "Plate")]
    pub no_arrange: bool,

    /// Also print parts that start in mid-air
    #[arg(long)]
    pub allow_floating: bool,

    /// Rotate every model onto the side that needs the least support [plate.orient]
    #[arg(long, help_heading = "Plate")]
    pub orient: bool,

    /// Override a setting for some objects, such as b.stl:infill.density=40%; repeatable, wins over --set
    #[arg(long, value_name = "NAME:KEY=VALUE", value_parser = object_setting, help_heading = "Plate", conflicts_with = "each")]
    pub object: Vec<ObjectAssignment>,

    /// Enforce support inside this body, given in the first model's coordinates; repeatable
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Support")]
    pub support_enforcer: Vec<PathBuf>,

    /// Block support inside this body, given in the first model's coordinates; repeatable
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Support")]
    pub support_blocker: Vec<PathBuf>,

    /// Pause before this layer (12) or height (12.4mm), for a filament change; repeatable
    #[arg(long, value_name = "WHERE")]
    pub pause_at: Vec<PauseAt>,

    /// Change to filament of another color before this layer (12) or height (12.4mm); repeatable
    #[arg(long, value_name = "WHERE")]
    pub color_change_at: Vec<PauseAt>,

    /// Ordering strategy [order.strategy]
    #[arg(long, value_name = "STRATEGY", value_parser = PossibleValuesParser::new(OrderStrategy::NAMES), help_heading = "Ordering")]
    pub order: Option<String>,

    #[command(flatten)]
    pub ordering: OrderingArgs,

    /// Certify the order: compute a lower bound and the gap to it
    #[arg(long, help_heading = "Ordering")]
    pub certify: bool,

    /// Label the objects in the G-code, so that a printer can cancel a single one [gcode.labels]
    #[arg(long)]
    pub labels: bool,

    /// Spiral vase mode: one continuously rising wall on a solid bottom [spiral.enabled]
    #[arg(long, help_heading = "Modes")]
    pub vase: bool,

    /// Variable layer heights from a table: on each line a height above the bed and a layer height [layer.heights]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Modes")]
    pub layer_heights: Option<PathBuf>,

    /// Worker threads [default: $RAYON_NUM_THREADS, or all cores]; the result is the same
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    #[command(flatten)]
    pub limits: LimitArgs,

    /// Send the G-code to this print host; `preset`: the one that the printer preset names
    #[cfg(feature = "send")]
    #[arg(id = "to", long = "send", value_name = "HOST", help_heading = "Print host")]
    pub to: Option<String>,

    #[cfg(feature = "send")]
    #[command(flatten)]
    pub delivery: super::host_args::DeliveryArgs,

    /// Print the summary as JSON, one line per file written; of a failure a line with its kind, message, object and file
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,

    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,

    /// No progress bar, even on a terminal
    #[arg(long)]
    pub no_progress: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct CompareArgs {
    #[command(flatten)]
    pub models: ModelArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Strategies, separated by commas [default: all]
    #[arg(long, value_name = "A,B,C", value_delimiter = ',', value_parser = PossibleValuesParser::new(OrderStrategy::NAMES), help_heading = "Ordering")]
    pub order: Vec<String>,

    #[command(flatten)]
    pub ordering: OrderingArgs,

    /// Compare orders of tools instead, for all models on one plate
    #[arg(long, conflicts_with_all = ["order", "scope", "csv", "html", "paper", "no_bound"])]
    pub tools: bool,

    /// With --tools: override a setting for some objects, such as b.stl:tool=2; repeatable, wins over --set
    #[arg(long, value_name = "NAME:KEY=VALUE", value_parser = object_setting, requires = "tools")]
    pub object: Vec<ObjectAssignment>,

    /// Print the table of the paper of 2016 (docs/paper.md); models are sliced first
    #[arg(long, conflicts_with_all = ["order", "scope", "json", "csv"])]
    pub paper: bool,

    /// Write an HTML page that shows the strategies side by side; one model only
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    pub html: Option<PathBuf>,

    /// Skip the lower bounds, which take longer than the ordering
    #[arg(long, help_heading = "Ordering")]
    pub no_bound: bool,

    /// Worker threads [default: $RAYON_NUM_THREADS, or all cores]; the result is the same
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    #[command(flatten)]
    pub limits: LimitArgs,

    /// Print JSON with every layer, one line per model
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,

    /// Print comma-separated values, one line per model, strategy and layer
    #[arg(long)]
    pub csv: bool,

    /// No progress bar, even on a terminal
    #[arg(long)]
    pub no_progress: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct ReorderArgs {
    /// G-code files
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,

    /// Write to this file (.bgcode: binary), or into this folder; - for standard output
    #[arg(short, long, value_name = "PATH", value_hint = ValueHint::AnyPath, conflicts_with_all = ["in_place", "dry_run"])]
    pub output: Option<PathBuf>,

    /// Replace the files, as slicers expect of a post-processing script
    #[arg(long)]
    pub in_place: bool,

    /// Only report what would be saved
    #[arg(long, conflicts_with = "in_place")]
    pub dry_run: bool,

    /// Print no open path backwards; loops keep their direction in any case
    #[arg(long, help_heading = "Ordering")]
    pub keep_direction: bool,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Ordering strategy [order.strategy]
    #[arg(long, value_name = "STRATEGY", value_parser = PossibleValuesParser::new(OrderStrategy::NAMES), help_heading = "Ordering")]
    pub order: Option<String>,

    #[command(flatten)]
    pub ordering: OrderingArgs,

    /// Worker threads [default: $RAYON_NUM_THREADS, or all cores]; the result is the same
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    #[command(flatten)]
    pub limits: LimitArgs,

    /// Print what was saved as JSON, one line per file
    #[arg(long, conflicts_with = "quiet")]
    pub json: bool,

    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct ViewArgs {
    #[command(flatten)]
    pub models: ModelArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Write the page to this file; - for standard output
    #[arg(short, long, value_name = "PATH", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,

    /// The layer of --svg and --png, counted from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), help_heading = "Pictures")]
    pub layer: Option<u32>,

    /// Write a layer as SVG, to scale
    #[arg(long, value_name = "PATH", requires = "layer", value_hint = ValueHint::FilePath, help_heading = "Pictures")]
    pub svg: Option<PathBuf>,

    /// Write a layer as PNG
    #[arg(long, value_name = "PATH", requires = "layer", value_hint = ValueHint::FilePath, help_heading = "Pictures")]
    pub png: Option<PathBuf>,

    /// Color --svg and --png by the tool that prints, instead of what it prints
    #[arg(long, help_heading = "Pictures")]
    pub by_tool: bool,

    /// Write a picture of the whole print as PNG, without background
    #[arg(long, value_name = "PATH", value_hint = ValueHint::FilePath, help_heading = "Pictures")]
    pub thumbnail: Option<PathBuf>,

    /// Longer side of a PNG, in pixels [default: 1200, of a thumbnail 300]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2000), help_heading = "Pictures")]
    pub size: Option<u32>,

    /// Ordering strategy [order.strategy]
    #[arg(long, value_name = "STRATEGY", value_parser = PossibleValuesParser::new(OrderStrategy::NAMES), help_heading = "Ordering")]
    pub order: Option<String>,

    #[command(flatten)]
    pub ordering: OrderingArgs,

    /// Certify the order of models: compute a lower bound and show the gap to it
    #[arg(long, help_heading = "Ordering")]
    pub certify: bool,

    /// Worker threads [default: $RAYON_NUM_THREADS, or all cores]; the result is the same
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,

    /// No progress bar, even on a terminal
    #[arg(long)]
    pub no_progress: bool,
}

/// How paths are ordered, whatever the strategy.
#[derive(Debug, Args)]
pub(super) struct OrderingArgs {
    /// How far paths of different kinds and islands may be mixed [order.scope]
    #[arg(long, value_parser = PossibleValuesParser::new(Scope::NAMES), help_heading = "Ordering")]
    pub scope: Option<String>,

    /// What is minimised [order.cost]
    #[arg(long, value_parser = PossibleValuesParser::new(CostKind::NAMES), help_heading = "Ordering")]
    pub cost: Option<String>,

    /// Where loops start and end [seam.position]
    #[arg(long, value_name = "POSITION", value_parser = PossibleValuesParser::new(SeamPosition::NAMES), help_heading = "Ordering")]
    pub seam: Option<String>,

    /// How long to search [order.effort]
    #[arg(long, value_parser = PossibleValuesParser::new(Effort::NAMES), help_heading = "Ordering")]
    pub effort: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    pub models: ModelArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Print JSON, one line per model
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub(super) struct ModelArgs {
    /// Models (STL, 3MF, OBJ), or a project; - for standard input
    #[arg(required = true, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,

    /// What the model on standard input is called
    #[arg(long, value_name = "NAME", default_value = "model")]
    pub stdin_name: PathBuf,

    #[command(flatten)]
    pub shape: ShapeArgs,

    /// Offset from the center of the bed, in mm
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, help_heading = "Transform")]
    pub translate: Option<Triple>,

    /// Shrink a model that is larger than the bed until it fits
    #[arg(long, help_heading = "Transform")]
    pub scale_to_fit: bool,
}

/// What a run may take.
#[derive(Debug, Args)]
pub(super) struct LimitArgs {
    /// End with code 8 after so many seconds, and write nothing
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = "Limits")]
    pub timeout: Option<Duration>,

    /// End with code 9 where more memory is needed, such as 512M or 2G, and write nothing
    #[arg(long, value_name = "SIZE", value_parser = size, help_heading = "Limits")]
    pub max_memory: Option<u64>,
}

#[derive(Debug, Args)]
pub(super) struct ShapeArgs {
    /// Unit of the models [default: mm, or what a 3MF says]
    #[arg(long, value_name = "UNIT", value_parser = PossibleValuesParser::new(UNITS.map(|(name, _)| name)), help_heading = "Transform")]
    pub unit: Option<String>,

    /// Scale by one factor, or by one per axis
    #[arg(long, value_name = "F|X,Y,Z", value_parser = scale, help_heading = "Transform")]
    pub scale: Option<Triple>,

    /// Rotate about X, then Y, then Z, in degrees
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true, help_heading = "Transform")]
    pub rotate: Option<Triple>,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct TimeArgs {
    /// G-code files; - for standard input
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,

    /// Firmware whose motion planning is modelled [default: that of the limits]
    #[arg(long, value_name = "FIRMWARE", value_parser = PossibleValuesParser::new(Firmware::ALL.map(|(name, _)| name)))]
    pub machine: Option<String>,

    /// Embedded profile or TOML file whose [machine] section has the limits [default: those of the generic printer]
    #[arg(long, value_name = "NAME|FILE")]
    pub limits: Option<String>,

    /// One of its settings, such as tool_change.time=12, which holds whatever the file says of changes; repeatable
    #[arg(short, long, value_name = "KEY=VALUE", value_parser = assignment)]
    pub set: Vec<Assignment>,

    /// Print JSON, one line per file
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct CheckArgs {
    /// G-code files; - for standard input
    #[arg(required = true, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,

    /// Model to compare with, at whatever position and in any number of copies; repeatable
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    pub model: Vec<PathBuf>,

    #[command(flatten)]
    pub shape: ShapeArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Print JSON, one line per file
    #[arg(long)]
    pub json: bool,

    /// Print nothing; the result is the exit code
    #[arg(short, long, conflicts_with = "json")]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub(super) struct ProfilesArgs {
    #[command(subcommand)]
    pub command: Option<ProfilesCommand>,
}

#[derive(Debug, Subcommand)]
pub(super) enum ProfilesCommand {
    /// List the embedded profiles
    List,
    /// Print a profile as written, or another slicer's configuration as a profile
    Show {
        #[arg(value_name = "NAME|PATH")]
        name: String,
    },
    /// Print all effective settings and where each came from, as a profile
    Dump {
        #[command(flatten)]
        settings: SettingArgs,
        /// As JSON
        #[arg(long)]
        json: bool,
    },
    /// Print the reference of all keys, as Markdown
    Reference,
    /// Print what is imported from the configurations of other slicers, as Markdown
    Imports {
        /// Bundles of presets (.ini): print how many of their keys are taken over instead
        #[arg(value_name = "BUNDLE")]
        bundles: Vec<PathBuf>,
    },
}

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(super) struct PrintersArgs {
    #[command(subcommand)]
    pub command: Option<PrintersCommand>,

    /// Words that a printer's name, file or slicer has, in any order
    #[arg(value_name = "WORDS")]
    pub words: Vec<String>,

    /// File or folder of presets; repeatable
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub presets: Vec<PathBuf>,

    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum PrintersCommand {
    Show(ShowPrinterArgs),
}

/// Print what a printer's presets come to: every setting with where it comes from, and what is not taken over
#[derive(Debug, Args)]
pub(super) struct ShowPrinterArgs {
    /// Printer preset
    #[arg(value_name = "NAME")]
    pub name: String,

    /// Print preset [default: the printer's own]
    #[arg(long, value_name = "NAME")]
    pub print: Option<String>,

    /// Filament preset [default: the printer's own]
    #[arg(long, value_name = "NAME")]
    pub filament: Option<String>,

    /// File or folder of presets; repeatable
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    pub presets: Vec<PathBuf>,

    /// Print JSON, with the other slicer's complete configuration and the presets that fit
    #[arg(long)]
    pub json: bool,
}

/// Three numbers, for X, Y and Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triple(pub [f64; 3]);

/// `NAME:KEY=VALUE`.
#[derive(Clone, Debug)]
pub(super) struct ObjectAssignment {
    pub object: String,
    pub setting: Assignment,
}

/// The name may hold colons: the key is what stands between the last one before the `=` and it.
fn object_setting(text: &str) -> Result<ObjectAssignment, String> {
    let wrong = || "NAME:KEY=VALUE is expected, such as part.stl:infill.density=40%".to_owned();
    let split = text.match_indices(':').map(|(at, _)| (&text[..at], &text[at + 1..])).find(|(_, rest)| {
        let key = rest.split('=').next().unwrap_or_default();
        rest.contains('=')
            && (key.contains('.') || ["tool", "flush"].contains(&key.trim()))
            && key.chars().all(|c| c.is_ascii_lowercase() || "._ ".contains(c))
    });
    match split {
        Some((object, setting)) if !object.is_empty() => Ok(ObjectAssignment {
            object: object.to_owned(),
            setting: assignment(setting).map(named_in_full).map_err(|_| wrong())?,
        }),
        _ => Err(wrong()),
    }
}

/// `tool=2` is short for the tool of an object, `flush=true` for flushing into it.
fn named_in_full(setting: Assignment) -> Assignment {
    let key = match setting.key.as_str() {
        "tool" => "tool_of.object".to_owned(),
        "flush" => "tool_of.flush".to_owned(),
        _ => setting.key,
    };
    Assignment { key, ..setting }
}

/// A number of bytes: K, M and G are powers of 1024.
fn size(text: &str) -> Result<u64, String> {
    let upper = text.trim().to_ascii_uppercase();
    let number = upper.trim_end_matches('B').trim_end_matches('I');
    let (number, unit) = match number.chars().last() {
        Some('K') => (&number[..number.len() - 1], 1_u64 << 10),
        Some('M') => (&number[..number.len() - 1], 1 << 20),
        Some('G') => (&number[..number.len() - 1], 1 << 30),
        _ => (number, 1),
    };
    let bytes = number.trim().parse::<f64>().map(|number| number * unit as f64);
    match bytes {
        Ok(bytes) if bytes.is_finite() && bytes >= 1.0 => Ok(bytes as u64),
        _ => Err("a size is expected, such as 512M or 2G".into()),
    }
}

fn triple(text: &str) -> Result<Triple, String> {
    let wrong = || "three numbers are expected, such as 0,0,45".to_owned();
    let numbers: Vec<f64> =
        text.split(',').map(|n| n.trim().parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
    match <[f64; 3]>::try_from(numbers) {
        Ok(numbers) if numbers.iter().all(|n| n.is_finite()) => Ok(Triple(numbers)),
        _ => Err(wrong()),
    }
}

fn scale(text: &str) -> Result<Triple, String> {
    let factors = match text.trim().parse::<f64>() {
        Ok(factor) => Ok(Triple([factor; 3])),
        Err(_) => triple(text),
    };
    match factors {
        Ok(factors) if factors.0.iter().all(|f| f.is_finite() && *f > 0.0) => Ok(factors),
        _ => Err("a factor above 0 is expected, such as 25.4, or three, such as 1,1,2".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn an_object_may_have_colons_in_its_name() {
        let typed = object_setting("C:\\a b.stl:infill.density=40%").unwrap();
        assert_eq!(typed.object, "C:\\a b.stl");
        assert_eq!((typed.setting.key.as_str(), typed.setting.value.as_str()), ("infill.density", "40%"));
        for wrong in ["infill.density=40%", ":infill.density=4", "part:infill", "part:=3"] {
            assert!(object_setting(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_size_has_a_unit_or_is_in_bytes() {
        for (text, bytes) in [("512M", 512 << 20), ("1.5GiB", 3 << 29), ("2g", 2 << 30), ("4096", 4096)] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "M", "-1G", "x", "0"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_scale_is_one_factor_or_three() {
        assert_eq!(scale("25.4").unwrap().0, [25.4; 3]);
        assert_eq!(scale("1, 2,3").unwrap().0, [1.0, 2.0, 3.0]);
        for wrong in ["0", "-1", "1,2", "1,2,0", "inf", "x"] {
            assert!(scale(wrong).is_err(), "{wrong}");
        }
    }
}
