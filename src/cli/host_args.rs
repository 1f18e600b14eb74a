//! The arguments of `pathwright send`, `slice --send` and `pathwright hosts`.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::PossibleValuesParser;
use clap::{Args, Subcommand, ValueHint};

use super::setting_args::{EXIT_CODES, PresetArgs, SettingArgs, seconds};
use crate::send::HostKind;

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct SendArgs {
    /// G-code file
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,

    /// Print host, as it is called in the file of hosts; `preset`: the one that the printer preset names
    #[arg(id = "to", long = "to", value_name = "HOST", required = true)]
    pub to: String,

    #[command(flatten)]
    pub delivery: DeliveryArgs,

    #[command(flatten)]
    pub settings: SettingArgs,

    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// How a file goes to a host.
#[derive(Debug, Args)]
pub(super) struct DeliveryArgs {
    /// Start the print, if the printer is ready
    #[arg(long, requires = "to", help_heading = "Print host")]
    pub start: bool,

    /// Follow the print to its end; Ctrl-C leaves it alone
    #[arg(long, requires = "start", help_heading = "Print host")]
    pub wait: bool,

    /// Overwrite a file of the same name on the host
    #[arg(long, requires = "to", help_heading = "Print host")]
    pub replace: bool,

    /// Name of the file on the host [default: its own]
    #[arg(long = "as", requires = "to", value_name = "NAME", help_heading = "Print host")]
    pub name: Option<String>,

    /// Send the file without checking it
    #[arg(long, requires = "to", help_heading = "Print host")]
    pub no_check: bool,

    #[command(flatten)]
    pub access: AccessArgs,
}

/// How hosts are reached.
#[derive(Debug, Args)]
pub(super) struct AccessArgs {
    /// Try again for so many seconds where a connection breaks or a host fails; 0: never
    #[arg(long, value_name = "SECONDS", default_value_t = 30, help_heading = "Print host")]
    pub retry: u32,

    /// Longest silence of a host, in seconds
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = seconds, help_heading = "Print host")]
    pub host_timeout: Duration,

    /// Trust these certificates (PEM), too
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Print host")]
    pub ca: Option<PathBuf>,

    /// The file of hosts [default: $PATHWRIGHT_HOSTS, or pathwright/hosts.toml beside other settings]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, help_heading = "Print host")]
    pub hosts: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct HostsArgs {
    #[command(subcommand)]
    pub command: HostsCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum HostsCommand {
    /// List the hosts: kind, address, and where the key is
    List {
        #[command(flatten)]
        access: AccessArgs,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Ask hosts who they are and what they do
    Test {
        /// Hosts [default: all]
        #[arg(value_name = "HOST")]
        names: Vec<String>,
        #[command(flatten)]
        access: AccessArgs,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    Add(Box<AddArgs>),
}

/// Write a host into the file of hosts
///
/// Its kind and address are given, or taken from a printer preset or a physical printer. A key is never an argument, as others see those.
#[derive(Debug, Args)]
pub(super) struct AddArgs {
    /// What it is called, such as shop/mk4
    #[arg(value_name = "NAME")]
    pub name: String,

    /// Interface that it speaks
    #[arg(long, value_name = "KIND", value_parser = PossibleValuesParser::new(HostKind::NAMES), required_unless_present_any = ["printer", "physical_printer"], requires = "url")]
    pub kind: Option<String>,

    /// Its address, such as http://192.168.1.20
    #[arg(long, value_name = "URL", requires = "kind")]
    pub url: Option<String>,

    /// Take kind, address, key, certificates and preset from a physical printer of PrusaSlicer or SuperSlicer
    #[arg(long, value_name = "NAME|PATH", value_hint = ValueHint::FilePath, conflicts_with = "kind")]
    pub physical_printer: Option<String>,

    /// Read the key from this file each time
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with_all = ["key_env", "key_stdin"])]
    pub key_file: Option<PathBuf>,

    /// Read the key from this environment variable each time
    #[arg(long, value_name = "VARIABLE", conflicts_with = "key_stdin")]
    pub key_env: Option<String>,

    /// Read the key from a line of standard input now, and write it into the file of hosts
    #[arg(long)]
    pub key_stdin: bool,

    /// Who logs in to PrusaLink; the key is the password
    #[arg(long, value_name = "NAME")]
    pub user: Option<String>,

    /// Where PrusaLink keeps files, such as usb
    #[arg(long, value_name = "NAME")]
    pub storage: Option<String>,

    /// Profile that files are checked against; repeatable
    #[arg(short, long, value_name = "NAME|PATH")]
    pub profile: Vec<String>,

    #[command(flatten)]
    pub presets: PresetArgs,

    #[command(flatten)]
    pub access: AccessArgs,
}
