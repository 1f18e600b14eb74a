//! `pathwright app`.

use std::fs;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};

use super::console::{self, file_name};
use super::exit::{Exit, Failure};
use super::serve::{library, serve_until_interrupted};
use crate::serve::{Config, Limits, Tokens};

#[derive(Debug, Args)]
pub(super) struct AppArgs {
    /// Models or projects to begin with
    #[arg(value_name = "MODEL", value_hint = ValueHint::FilePath)]
    files: Vec<PathBuf>,

    /// Port to listen on; 0: any that is free
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,

    /// Print the address instead of opening the browser
    #[arg(long)]
    no_browser: bool,

    /// File or folder of presets; repeatable
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    presets: Vec<PathBuf>,

    /// Threads that slice; 0: as many as the machine has cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

/// Serves the page until an interrupt.
pub(super) fn run(args: &AppArgs) -> Result<Exit, Failure> {
    let opened = args.files.iter().map(|path| read(path)).collect::<Result<_, _>>()?;
    let data = tempfile::tempdir()
        .map_err(|error| Failure::new(Exit::Output, format!("no folder for temporary files: {error}")))?;
    let config = Config {
        listen: SocketAddr::from((Ipv4Addr::LOCALHOST, args.port)),
        data: data.path().to_owned(),
        tokens: Tokens::default(),
        hosts: Vec::new(),
        tls: None,
        limits: Limits { upload_bytes: crate::limits::MODEL_BYTES, ..Limits::default() },
        presets: library(&args.presets)?,
        threads: args.threads,
        jobs_at_once: 1,
        print_hosts: crate::system::hosts_file(None),
        opened,
    };
    serve_until_interrupted(config, |address| {
        let address = format!("http://{address}/");
        // That nobody reads it is no reason not to serve.
        let _ = console::print(&format!("{address} (Ctrl-C ends it)\n"));
        if !args.no_browser
            && let Err(error) = open::that_detached(&address)
        {
            console::warn(&[format!("no browser could be opened ({error}); open {address} yourself")]);
        }
    })
}

fn read(path: &Path) -> Result<(String, Vec<u8>), Failure> {
    let failed = |error: String| Failure::new(Exit::Input, format!("{}: {error}", path.display()));
    let bytes = fs::metadata(path).map_err(|error| failed(error.to_string()))?.len();
    if bytes > crate::limits::MODEL_BYTES {
        return Err(failed(format!("the file has more than {} GB", crate::limits::MODEL_BYTES >> 30)));
    }
    crate::limits::check_memory(bytes).map_err(failed)?;
    let data = fs::read(path).map_err(|error| failed(error.to_string()))?;
    Ok((file_name(path), data))
}
