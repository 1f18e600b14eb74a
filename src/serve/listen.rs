//! Connections: accepted, decrypted, timed, counted, and ended in order.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::ConnectInfo;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::{GracefulShutdown, Watcher};
use hyper_util::service::TowerToHyperService;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio::io::{AsyncRead, AsyncWrite, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, watch};
use tokio::time::{sleep, timeout};
use tokio_io_timeout::TimeoutStream;
use tokio_rustls::TlsAcceptor;
use tower::ServiceExt as _;

use super::config::TlsFiles;
use super::limits::Limits;

/// Size of the buffer for the head of a request, bytes; it is at most twice as large.
const HEAD_BYTES: usize = 32 << 10;
/// Most headers of a request.
const HEADERS: usize = 64;
/// Time in which a client must take something of what is sent to it.
const WRITE_TIME: Duration = Duration::from_secs(30);
/// Time to agree on encryption.
const HANDSHAKE_TIME: Duration = Duration::from_secs(10);
/// Time for answers under way when the server ends.
const END_TIME: Duration = Duration::from_secs(5);

/// Reads certificate and key.
///
/// # Errors
/// A file that cannot be read or does not hold them, a key that is not the certificate's.
pub(super) fn tls(files: &TlsFiles) -> Result<TlsAcceptor, String> {
    let cert = files.cert.display();
    let chain: Vec<CertificateDer<'_>> = CertificateDer::pem_file_iter(&files.cert)
        .and_then(Iterator::collect)
        .map_err(|error| format!("--tls-cert {cert}: {error}"))?;
    if chain.is_empty() {
        return Err(format!("--tls-cert {cert}: there is no certificate in it"));
    }
    let key = PrivateKeyDer::from_pem_file(&files.key)
        .map_err(|error| format!("--tls-key {}: {error}", files.key.display()))?;
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = rustls::ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .and_then(|config| config.with_no_client_auth().with_single_cert(chain, key))
        .map_err(|error| format!("--tls-cert {cert}: {error}"))?;
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// Answers until the server shall end.
pub(super) async fn run(
    listener: TcpListener,
    router: Router,
    tls: Option<TlsAcceptor>,
    limits: &Limits,
    mut ending: watch::Receiver<bool>,
) {
    let free = Arc::new(Semaphore::new(limits.connections));
    let graceful = GracefulShutdown::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = ending.wait_for(|ending| *ending) => break,
        };
        let (stream, peer) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                pause_after(&error).await;
                continue;
            }
        };
        let permit = free.clone().try_acquire_owned().ok();
        let (answering, tls) =
            (Answering { router: router.clone(), peer, head_time: limits.head_time }, tls.clone());
        tokio::spawn(connection(stream, answering, tls, permit, graceful.watcher()));
    }
    drop(listener);
    // Whoever is slower is cut off.
    let _ = timeout(END_TIME, graceful.shutdown()).await;
}

/// Connections that broke are nothing; where the system has no more files, ending ones give some back.
async fn pause_after(error: &io::Error) {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    if !matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset) {
        sleep(Duration::from_millis(50)).await;
    }
}

async fn connection(
    mut stream: TcpStream,
    answering: Answering,
    tls: Option<TlsAcceptor>,
    permit: Option<OwnedSemaphorePermit>,
    watcher: Watcher,
) {
    let Some(_permit) = permit else {
        let full = b"HTTP/1.1 503 Service Unavailable\r\nconnection: close\r\ncontent-length: 0\r\nretry-after: 5\r\n\r\n";
        // Over TLS nothing can be said, and whoever is gone need not know.
        if tls.is_none() {
            let _ = timeout(Duration::from_secs(1), stream.write_all(full)).await;
        }
        return;
    };
    // Without it answers wait for each other; a system that cannot is only slower.
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(WRITE_TIME));
    let stream = Box::pin(stream);
    match tls {
        None => answering.answer(stream, watcher).await,
        Some(tls) => {
            if let Ok(Ok(stream)) = timeout(HANDSHAKE_TIME, tls.accept(stream)).await {
                answering.answer(Box::pin(stream), watcher).await;
            }
        }
    }
}

/// What answers on a connection.
struct Answering {
    router: Router,
    peer: SocketAddr,
    head_time: Duration,
}

impl Answering {
    async fn answer<S>(self, stream: Pin<Box<S>>, watcher: Watcher)
    where
        S: AsyncRead + AsyncWrite + Send + 'static,
    {
        let peer = self.peer;
        let service = self.router.map_request(move |mut request: hyper::Request<hyper::body::Incoming>| {
            request.extensions_mut().insert(ConnectInfo(peer));
            request.map(axum::body::Body::new)
        });
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(self.head_time)
            .max_buf_size(HEAD_BYTES)
            .max_headers(HEADERS)
            .serve_connection(TokioIo::new(stream), TowerToHyperService::new(service));
        // Connections end in many ways, none of which is a mistake of the server.
        let _ = watcher.watch(connection).await;
    }
}
