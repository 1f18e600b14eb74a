//! A proxy that breaks what passes it: cuts, delays, answers of its own.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use crate::stand_in::http::{self, Answer};

/// What is done to a request, or to its answer.
#[derive(Clone, Debug)]
pub enum Fault {
    /// The connection ends after so many bytes of the request.
    Cut(usize),
    /// The connection ends at once, without a byte of answer.
    Reset,
    /// The request is late.
    Delay(Duration),
    /// Nothing is ever answered.
    Hang,
    /// The proxy answers itself.
    Status(u16),
    /// It answers with a redirect.
    Redirect(String),
    /// It answers with something else than HTTP.
    Garbage,
    /// Its answer is longer than any is.
    Flood,
    /// The request arrives, and so many bytes of the answer.
    Truncate(usize),
    /// A byte of the request's body is another one.
    Flip,
}

/// Which requests are broken.
#[derive(Clone, Debug)]
pub struct Rule {
    /// What their first line begins with.
    pub begins: &'static str,
    /// How many of them, from the first on.
    pub times: u32,
    pub fault: Fault,
}

pub struct Proxy {
    pub address: SocketAddr,
    /// Requests that begin with what the rule says.
    pub hits: Arc<AtomicU32>,
}

impl Proxy {
    pub fn start(upstream: SocketAddr, rule: Rule) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let hits = Arc::new(AtomicU32::new(0));
        let counted = hits.clone();
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (rule, counted) = (rule.clone(), counted.clone());
                std::thread::spawn(move || {
                    // Whoever ends a connection ends it.
                    let _ = pass(stream, upstream, &rule, &counted);
                });
            }
        });
        Self { address, hits }
    }

    pub fn hits(&self) -> u32 {
        self.hits.load(Ordering::SeqCst)
    }
}

/// One request and its answer.
fn pass(mut client: TcpStream, upstream: SocketAddr, rule: &Rule, hits: &AtomicU32) -> std::io::Result<()> {
    let mut begin = vec![0; 1 << 16];
    let read = client.read(&mut begin)?;
    begin.truncate(read);
    let is_meant = begin.starts_with(rule.begins.as_bytes());
    if !is_meant || hits.fetch_add(1, Ordering::SeqCst) >= rule.times {
        return relay(client, upstream, &begin, usize::MAX);
    }
    match &rule.fault {
        Fault::Cut(bytes) => {
            let mut server = TcpStream::connect(upstream)?;
            let mut sent = begin.len().min(*bytes);
            server.write_all(&begin[..sent])?;
            let mut block = [0; 1024];
            while sent < *bytes {
                let read = client.read(&mut block)?;
                let part = read.min(bytes - sent);
                server.write_all(&block[..part])?;
                sent += part;
                if read == 0 {
                    break;
                }
            }
            server.shutdown(Shutdown::Both)
        }
        // What has not been read makes a reset of the end.
        Fault::Reset => Ok(()),
        Fault::Delay(time) => {
            std::thread::sleep(*time);
            relay(client, upstream, &begin, usize::MAX)
        }
        Fault::Hang => {
            // Until the client gives up.
            while client.read(&mut begin)? > 0 {}
            Ok(())
        }
        Fault::Status(status) => {
            drain(&mut client, &begin)?;
            let text = format!("{{\"error\":\"injected {status}\"}}");
            http::write(&mut client, &Answer(*status, Vec::new(), text.into_bytes()))
        }
        Fault::Redirect(to) => {
            drain(&mut client, &begin)?;
            http::write(&mut client, &Answer(307, vec![("Location".into(), to.clone())], Vec::new()))
        }
        Fault::Garbage => {
            drain(&mut client, &begin)?;
            client.write_all(b"220 smtp.example ready\r\n\r\n")
        }
        Fault::Flood => {
            drain(&mut client, &begin)?;
            client.write_all(b"HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n")?;
            loop {
                client.write_all(&[b'['; 1 << 16])?;
            }
        }
        Fault::Truncate(bytes) => relay(client, upstream, &begin, *bytes),
        Fault::Flip => {
            let mut whole = whole(&mut client, begin)?;
            let middle = whole.len() / 2;
            whole[middle] ^= 1;
            relay(client, upstream, &whole, usize::MAX)
        }
    }
}

/// Reads the rest of a request.
fn drain(client: &mut TcpStream, begin: &[u8]) -> std::io::Result<()> {
    let request = http::read(&mut begin.chain(client));
    request.map(|_| ()).ok_or_else(|| std::io::ErrorKind::UnexpectedEof.into())
}

/// A request with all of its body, as bytes.
fn whole(client: &mut TcpStream, mut begin: Vec<u8>) -> std::io::Result<Vec<u8>> {
    let head = begin.windows(4).position(|four| four == b"\r\n\r\n").map_or(begin.len(), |at| at + 4);
    let text = String::from_utf8_lossy(&begin[..head]).to_ascii_lowercase();
    let length =
        text.split("content-length: ").nth(1).and_then(|rest| rest.lines().next()?.parse().ok()).unwrap_or(0);
    let have = begin.len();
    begin.resize(head + length, 0);
    client.read_exact(&mut begin[have..])?;
    Ok(begin)
}

/// Passes a request on, and so much of the answer back.
fn relay(mut client: TcpStream, upstream: SocketAddr, begin: &[u8], most: usize) -> std::io::Result<()> {
    let mut server = TcpStream::connect(upstream)?;
    server.write_all(begin)?;
    let (mut from, mut to) = (client.try_clone()?, server.try_clone()?);
    std::thread::spawn(move || std::io::copy(&mut from, &mut to));
    let (mut block, mut left) = ([0; 1 << 14], most);
    while let Ok(read @ 1..) = server.read(&mut block) {
        let part = read.min(left);
        client.write_all(&block[..part])?;
        left -= part;
        if left == 0 {
            break;
        }
    }
    client.shutdown(Shutdown::Both)
}
