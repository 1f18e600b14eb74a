//! `pathwright serve`.

use std::fs;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use clap::{Args, ValueHint};

use super::console;
use super::exit::{Exit, Failure};
use crate::presets::Library;
use crate::serve::{Config, Ending, Limits, ServeError, TlsFiles, Tokens, serve};
use crate::system;

#[derive(Debug, Args)]
pub(super) struct ServeArgs {
    /// Address and port to listen on
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    listen: SocketAddr,

    /// Folder of jobs and results; it is made where it is not there
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    data: PathBuf,

    /// Tokens of those who may use the service: one on each line, after a name if there are several
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    token_file: Option<PathBuf>,

    /// Name by which the server is called, besides localhost and addresses; repeatable
    #[arg(long, value_name = "NAME")]
    host: Vec<String>,

    /// Certificate (PEM) to encrypt with; without it encryption is the proxy's
    #[arg(long, value_name = "FILE", requires = "tls_key", value_hint = ValueHint::FilePath)]
    tls_cert: Option<PathBuf>,

    /// Private key (PEM) of the certificate
    #[arg(long, value_name = "FILE", requires = "tls_cert", value_hint = ValueHint::FilePath)]
    tls_key: Option<PathBuf>,

    /// File or folder of presets; repeatable
    #[arg(long, value_name = "PATH", value_hint = ValueHint::AnyPath)]
    presets: Vec<PathBuf>,

    /// Threads that slice one job; 0: as many as the machine has cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,

    /// Jobs sliced at once; 0: one for every two cores
    #[arg(long, value_name = "N", default_value_t = 0)]
    jobs_at_once: usize,

    #[command(flatten)]
    limits: LimitArgs,
}

/// What a server does at most.
#[derive(Debug, Args)]
#[command(next_help_heading = "Limits")]
struct LimitArgs {
    /// Largest request, in MiB
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().upload_bytes >> 20)]
    max_upload: u64,

    /// Most facets of a job
    #[arg(long, value_name = "N", default_value_t = Limits::default().facets)]
    max_facets: u64,

    /// Most jobs that wait
    #[arg(long, value_name = "N", default_value_t = Limits::default().waiting)]
    max_waiting: usize,

    /// Most jobs of one client that wait or run
    #[arg(long, value_name = "N", default_value_t = Limits::default().jobs_per_client)]
    max_jobs_per_client: usize,

    /// Largest models of one client whose jobs wait or run, together, in MiB
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().bytes_per_client >> 20)]
    max_bytes_per_client: u64,

    /// Longest time for a job, in seconds
    #[arg(long, value_name = "S", default_value_t = Limits::default().job_time.as_secs())]
    max_job_time: u64,

    /// Most that results take on the disk, in MiB; the oldest go first
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().quota_bytes >> 20)]
    max_disk: u64,

    /// Most finished jobs that are remembered; the oldest are forgotten first
    #[arg(long, value_name = "N", default_value_t = Limits::default().jobs_kept)]
    max_jobs_kept: usize,

    /// Most memory that all jobs under way may be estimated to need, in MiB
    #[arg(long, value_name = "MIB", default_value_t = Limits::default().memory_bytes >> 20)]
    max_memory: u64,

    /// Most connections
    #[arg(long, value_name = "N", default_value_t = Limits::default().connections)]
    max_connections: usize,

    /// Time for the head of a request, in seconds
    #[arg(long, value_name = "S", default_value_t = Limits::default().head_time.as_secs())]
    max_head_time: u64,

    /// Time for the body of a request, in seconds; one more for every 16 KiB
    #[arg(long, value_name = "S", default_value_t = Limits::default().body_time.as_secs())]
    max_body_time: u64,

    /// Most event streams
    #[arg(long, value_name = "N", default_value_t = Limits::default().streams)]
    max_streams: usize,

    /// Most event streams of one client
    #[arg(long, value_name = "N", default_value_t = Limits::default().streams_per_client)]
    max_streams_per_client: usize,

    /// Most pages at once
    #[arg(long, value_name = "N", default_value_t = Limits::default().sessions)]
    max_sessions: usize,

    /// How long a closed page can come back, in seconds
    #[arg(long, value_name = "S", default_value_t = Limits::default().session_time.as_secs())]
    max_session_time: u64,

    /// How often a job is begun again when the server died while it was sliced
    #[arg(long, value_name = "N", default_value_t = Limits::default().attempts)]
    max_attempts: u32,
}

impl LimitArgs {
    fn limits(&self) -> Limits {
        Limits {
            upload_bytes: self.max_upload << 20,
            facets: self.max_facets,
            waiting: self.max_waiting,
            jobs_per_client: self.max_jobs_per_client,
            bytes_per_client: self.max_bytes_per_client << 20,
            job_time: Duration::from_secs(self.max_job_time),
            quota_bytes: self.max_disk << 20,
            jobs_kept: self.max_jobs_kept,
            memory_bytes: self.max_memory << 20,
            connections: self.max_connections,
            head_time: Duration::from_secs(self.max_head_time),
            body_time: Duration::from_secs(self.max_body_time),
            streams: self.max_streams,
            streams_per_client: self.max_streams_per_client,
            sessions: self.max_sessions,
            session_time: Duration::from_secs(self.max_session_time),
            attempts: self.max_attempts,
        }
    }
}

/// The server of this process, which an interrupt ends.
static SERVER: Mutex<Option<Ending>> = Mutex::new(None);

/// Ends the server of this process, the first time in order; whether there was one that is not ending yet.
pub(super) fn end() -> bool {
    let server = SERVER.lock().unwrap_or_else(PoisonError::into_inner).take();
    server.inspect(Ending::end).is_some()
}

/// Serves until an interrupt.
pub(super) fn run(args: &ServeArgs) -> Result<Exit, Failure> {
    let tokens = match &args.token_file {
        None if !args.listen.ip().is_loopback() => {
            let message = format!(
                "--listen {}: whoever reaches this address could use the service; give --token-file, or listen on \
                 127.0.0.1",
                args.listen
            );
            return Err(Failure::new(Exit::Usage, message));
        }
        None => Tokens::default(),
        Some(path) => {
            let failed = |error: String| {
                Failure::new(Exit::Usage, format!("--token-file {}: {error}", path.display()))
            };
            let text = fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
            Tokens::parse(&text).map_err(failed)?
        }
    };
    let tls = args.tls_cert.clone().zip(args.tls_key.clone()).map(|(cert, key)| TlsFiles { cert, key });
    let scheme = if tls.is_some() { "https" } else { "http" };
    let config = Config {
        listen: args.listen,
        data: args.data.clone(),
        tokens,
        hosts: args.host.clone(),
        tls,
        limits: args.limits.limits(),
        presets: library(&args.presets)?,
        threads: args.threads,
        jobs_at_once: args.jobs_at_once,
        print_hosts: None,
        opened: Vec::new(),
    };
    serve_until_interrupted(config, |address| {
        // That nobody reads it is no reason not to serve.
        let _ = console::print(&format!("listening on {scheme}://{address}\n"));
    })
}

/// Serves until an interrupt. `ready` gets the address.
pub(super) fn serve_until_interrupted(
    config: Config,
    ready: impl FnOnce(SocketAddr),
) -> Result<Exit, Failure> {
    let ending = Ending::default();
    *SERVER.lock().unwrap_or_else(PoisonError::into_inner) = Some(ending.clone());
    serve(config, &ending, ready)?;
    Ok(Exit::Done)
}

/// The presets of this machine, and before them those of files and folders that are named; there may be none.
pub(super) fn library(named: &[PathBuf]) -> Result<Library, Failure> {
    if let Some(gone) = named.iter().find(|path| !path.exists()) {
        return Err(Failure::new(Exit::Settings, format!("--presets {}: is not there", gone.display())));
    }
    let library = system::all_presets(named);
    console::warn(library.problems());
    Ok(library)
}

impl From<ServeError> for Failure {
    fn from(error: ServeError) -> Self {
        let exit = match error {
            ServeError::Data(_) => Exit::Output,
            _ => Exit::Usage,
        };
        Self::new(exit, error)
    }
}
