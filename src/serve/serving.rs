//! A server from its start to its end.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use tokio::net::TcpListener;
use tokio::sync::watch;

use super::config::Config;
use super::jobs::{Jobs, Runners};
use super::metrics::Metrics;
use super::shared::{self, Shared};
use super::streams::Streams;
use super::{listen, router};
use crate::presets::Printers;

/// Ends a server, from any thread: answers under way are finished, jobs are left for the next start.
#[derive(Clone, Debug)]
pub struct Ending(Arc<watch::Sender<bool>>);

impl Default for Ending {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(false)))
    }
}

impl Ending {
    /// Ends the server.
    pub fn end(&self) {
        self.0.send_replace(true);
    }
}

/// Why a server cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The address is taken, or not one of this machine.
    #[error("{address}: cannot be listened on: {source}; choose another with --listen")]
    Listen {
        /// Address and port.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// Certificate or key cannot be used.
    #[error("{0}")]
    Tls(String),
    /// The folder of jobs cannot be used.
    #[error("--data {0}")]
    Data(String),
    /// The system has no threads or files for it.
    #[error("the server cannot be started: {0}")]
    System(#[from] io::Error),
}

/// Answers until it is told to end. `ready` is called with the address when requests are taken.
///
/// # Errors
/// See [`ServeError`].
pub fn serve(config: Config, ending: &Ending, ready: impl FnOnce(SocketAddr)) -> Result<(), ServeError> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().thread_name("answer").build()?;
    let done = runtime.block_on(run(config, ending, ready));
    // What a page still slices is of no use to anybody.
    runtime.shutdown_background();
    done
}

async fn run(config: Config, ending: &Ending, ready: impl FnOnce(SocketAddr)) -> Result<(), ServeError> {
    let Config {
        listen: address,
        data,
        tokens,
        hosts,
        tls,
        limits,
        presets,
        threads,
        jobs_at_once,
        print_hosts,
        opened,
    } = config;
    let tls = tls.as_ref().map(listen::tls).transpose().map_err(ServeError::Tls)?;
    let failed = |source| ServeError::Listen { address, source };
    let listener = TcpListener::bind(address).await.map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    let shared = Arc::new(Shared {
        limits,
        tokens,
        hosts,
        tls: tls.is_some(),
        presets: Arc::new(presets),
        printers: Printers::default(),
        slicing: Arc::new(shared::pool(threads, "page")?),
        streams: Arc::new(Streams::default()),
        metrics: Metrics::default(),
        print_hosts,
        opened,
        ending: ending.0.subscribe(),
    });
    let jobs = Arc::new(Jobs::open(&data, shared.clone()).map_err(ServeError::Data)?);
    let runners = Runners::start(&jobs, jobs_at_once, threads)?;
    let router = router::router(&shared, &jobs);
    ready(address);
    listen::run(listener, router, tls, &shared.limits, ending.0.subscribe()).await;
    // It waits for the runs to be given back.
    let _ = tokio::task::spawn_blocking(|| runners.stop()).await;
    Ok(())
}
