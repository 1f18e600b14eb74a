//! The real OctoPrint, with its virtual printer.

use std::net::SocketAddr;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::process::{Running, free_address, listens, program, wait_for};
use crate::program::{Desk, said, wait_until_started};
use crate::proxy::{Fault, Proxy, Rule};
use crate::stand_in::http::call;

const KEY: &str = "4F2B9C6E7D8A41C0B3E5F60718293A4B";

const CONFIG: &str = "\
accessControl: {salt: aeiou}
server:
  firstRun: false
  onlineCheck: {enabled: false}
  pluginBlacklist: {enabled: false}
  seenWizards: {backup: null, corewizard: 4, tracking: null, classicwebcam: 1}
plugins:
  virtual_printer: {enabled: true, throttle: 0.0}
  _disabled: [achievements, announcements, appkeys, backup, classicwebcam, discovery, errortracking, file_check, firmware_check, gcodeviewer, health_check, pi_support, softwareupdate, tracking]
serial: {autoconnect: true, port: VIRTUAL, baudrate: 115200}
";

const USERS: &str = "\
_version: 2
tester:
  active: true
  apikey: 4F2B9C6E7D8A41C0B3E5F60718293A4B
  groups: [users, admins]
  password: none
  permissions: []
  settings: {}
";

/// An OctoPrint with a folder of its own.
struct OctoPrint {
    process: Running,
    address: SocketAddr,
    folder: TempDir,
}

impl OctoPrint {
    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("config.yaml"), CONFIG).unwrap();
        std::fs::write(folder.path().join("users.yaml"), USERS).unwrap();
        let address = free_address();
        let process = Self::process(&folder, address);
        let it = Self { process, address, folder };
        it.ready();
        it
    }

    fn process(folder: &TempDir, address: SocketAddr) -> Running {
        let mut command = program("octoprint", "octoprint");
        command.args(["--basedir"]).arg(folder.path()).args([
            "serve",
            "--iknowwhatimdoing",
            "--host",
            "127.0.0.1",
        ]);
        command.args(["--port", &address.port().to_string()]);
        Running::start(command, &folder.path().join("out.log"))
    }

    /// Waits for its printer.
    fn ready(&self) {
        wait_for("OctoPrint", || {
            listens(self.address) && self.get("/api/printer")["state"]["flags"]["ready"] == true
        });
    }

    /// A power cut, and power again.
    fn restart(&mut self) {
        self.process.kill();
        self.process = Self::process(&self.folder, self.address);
    }

    fn get(&self, path: &str) -> Value {
        serde_json::from_slice(&call(self.address, "GET", path, KEY, "").1).unwrap_or_default()
    }

    fn desk(&self, address: SocketAddr, key: &str) -> Desk {
        Desk::with("octoprint", &format!("http://{address}"), &format!("key = \"{key}\""))
    }

    fn stored(&self, name: &str) -> Option<Vec<u8>> {
        std::fs::read(self.folder.path().join("uploads").join(name)).ok()
    }
}

pub fn it_is_printed_to_its_end_and_starts_again_after_a_power_cut() {
    let mut host = OctoPrint::start();
    let desk = host.desk(host.address, KEY);
    let file = desk.sliced("part.gcode", &["--set", "layer.height=0.3", "--pause-at", "4"]);
    let whole = std::fs::read(&file).unwrap();

    let (code, told) = host.desk(host.address, "FFFF9C6E7D8A41C0B3E5F60718293A4B").send(&file, &["--start"]);
    assert!(code == 11 && told.contains("it answers 403") && !told.contains("FFFF9C6E"), "{code}: {told}");
    assert!(host.stored("part.gcode").is_none());

    // The power fails while the file arrives; the program goes on trying until it is back.
    let proxy =
        Proxy::start(host.address, Rule { begins: "POST /api/files", times: 1, fault: Fault::Cut(20_000) });
    let slow = host.desk(proxy.address, KEY);
    let sending = slow.begin(&file, &["--retry", "60"]);
    wait_for("the upload", || proxy.hits() > 0);
    host.restart();
    let (code, told) = said(&sending.wait_with_output().unwrap());
    assert!(code == 0 && told.contains("compared") && told.contains("trying again"), "{code}: {told}");
    assert_eq!(host.stored("part.gcode"), Some(whole.clone()));
    host.ready();

    // It prints up to the pause, and nothing else is started meanwhile.
    assert_eq!(desk.send(&file, &["--start"]).0, 11, "a file of this name is there");
    let printing = desk.begin(&file, &["--replace", "--start", "--wait", "--retry", "10"]);
    wait_for("the pause", || host.get("/api/printer")["state"]["flags"]["paused"] == true);
    let at = host.get("/api/job")["progress"]["filepos"].as_u64().unwrap() as usize;
    // What has been sent when it pauses has begun the fourth layer at most.
    let layers = String::from_utf8_lossy(&whole[..at]).matches(";LAYER_CHANGE").count();
    assert!((3..=4).contains(&layers), "paused at layer {layers}");
    let (code, told) = desk.send(&file, &["--as", "other.gcode", "--start"]);
    assert!(code == 11 && told.contains("the printer is paused"), "{code}: {told}");
    let resumed = call(
        host.address,
        "POST",
        "/api/job",
        KEY,
        &json!({ "command": "pause", "action": "resume" }).to_string(),
    );
    assert_eq!(resumed.0, 204);
    let (code, told) = said(&printing.wait_with_output().unwrap());
    assert!(code == 0 && told.contains("printed part.gcode"), "{code}: {told}");
    assert_eq!(host.get("/api/job")["progress"]["completion"], 100.0);

    // Cancelled at the host, and a power cut while it prints.
    let mut printing = desk.begin(&file, &["--replace", "--start", "--wait"]);
    wait_until_started(&mut printing);
    assert_eq!(
        call(host.address, "POST", "/api/job", KEY, &json!({ "command": "cancel" }).to_string()).0,
        204
    );
    let (code, told) = said(&printing.wait_with_output().unwrap());
    assert!(code == 12 && told.contains("part.gcode was cancelled"), "{code}: {told}");
    let mut printing = desk.begin(&file, &["--replace", "--start", "--wait", "--retry", "2"]);
    wait_until_started(&mut printing);
    host.process.kill();
    let (code, told) = said(&printing.wait_with_output().unwrap());
    assert!(code == 10 && told.contains("it, following the print: "), "{code}: {told}");
    host.restart();
    host.ready();
    let (code, told) = desk.send(&file, &["--replace"]);
    assert!(code == 0 && host.stored("part.gcode") == Some(whole), "{code}: {told}");
}

pub fn analysis_and_thumbnails_are_those_of_the_print() {
    let folder = tempfile::tempdir().unwrap();
    let desk = Desk { folder };
    let file = desk.sliced("part.gcode", &["--set", "skirt.loops=0", "--set", "gcode.start=G28"]);
    let mut analyse = program("octoprint", "octoprint");
    analyse.args(["analysis", "gcode", "--speed-x=18000", "--speed-y=18000", "--max-t=10"]).arg(&file);
    let done = analyse.output().unwrap();
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    let height = number_after(&text, "height:");
    let [width, depth] = ["width:", "depth:"].map(|name| number_after(&text, name));
    assert_eq!(height, 5.0, "{text}");
    for side in [width, depth] {
        // Paths run half a bead inside of the cube's faces.
        assert!((4.4..=5.0).contains(&side), "{text}");
    }
    let mut thumbnails: Command = program("octoprint", "gcode-thumbnail-tool");
    let done = thumbnails.arg("analyse").arg(&file).output().unwrap();
    let text = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    assert!(text.contains("32x32") && text.contains("300x300"), "{text}");
}

fn number_after(text: &str, name: &str) -> f64 {
    let rest = text.split(name).nth(1).unwrap_or_else(|| panic!("{name} is not in {text}"));
    rest.split_whitespace().next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}
