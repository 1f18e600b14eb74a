//! The real OctoPrint, with its virtual printer.

use std::net::SocketAddr;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::process::{Running, free_address, listens, program, wait_for};
use crate::program::{Desk, said, wait_until_started};
use crate::proxy::{Fault, Proxy, Rule};
use crate::stand_in::http::call;

const KEY: &str = "4F2B9C6E7D8A41C0B3E5F60718293A4B";

/// Its printer is warm already, as it would take its time.
const CONFIG: &str = "\
accessControl: {salt: aeiou}
server:
  firstRun: false
  onlineCheck: {enabled: false}
  pluginBlacklist: {enabled: false}
  seenWizards: {backup: null, corewizard: 4, tracking: null, classicwebcam: 1}
plugins:
  virtual_printer: {enabled: true, numExtruders: 2, throttle: 0.0, simulated_errors: [], ambientTemperature: 220.0}
  _disabled: [achievements, announcements, appkeys, backup, classicwebcam, discovery, errortracking, file_check, firmware_check, gcodeviewer, health_check, pi_support, softwareupdate, tracking]
serial: {autoconnect: true, port: VIRTUAL, baudrate: 115200}
";

/// A print with a pause.
const PAUSED: [&str; 4] = ["--set", "layer.height=0.3", "--pause-at", "4"];

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
        Self::in_folder(tempfile::tempdir().unwrap())
    }

    /// With what stands in for cancelling objects.
    fn that_cancels() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("plugins")).unwrap();
        let plugin = folder.path().join("plugins/cancel_object.py");
        std::fs::write(plugin, include_str!("cancel_object.py")).unwrap();
        Self::in_folder(folder)
    }

    fn in_folder(folder: TempDir) -> Self {
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

    fn post(&self, path: &str, body: &Value) {
        assert_eq!(call(self.address, "POST", path, KEY, &body.to_string()).0, 204, "{path} {body}");
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
    let file = desk.sliced("part.gcode", &PAUSED);
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
    host.post("/api/job", &json!({ "command": "pause", "action": "resume" }));
    let (code, told) = said(&printing.wait_with_output().unwrap());
    assert!(code == 0 && told.contains("printed part.gcode"), "{code}: {told}");
    assert_eq!(host.get("/api/job")["progress"]["filepos"], whole.len() as u64);

    // Cancelled at the host, and a power cut while it prints.
    let mut printing = desk.begin(&file, &["--replace", "--start", "--wait"]);
    wait_until_started(&mut printing);
    host.post("/api/job", &json!({ "command": "cancel" }));
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

/// The marks of M486 and the comments: each leaves out what belongs to the second of two objects, and nothing else.
pub fn an_object_is_cancelled_and_the_other_printed_to_its_end() {
    let host = OctoPrint::that_cancels();
    let desk = host.desk(host.address, KEY);
    let log = host.folder.path().join("data/cancel_object/sent.gcode");
    for (name, labels, begins, ends) in [
        ("firmware.gcode", &["--labels"][..], "M486 S1", "M486 S-1"),
        (
            "comments.gcode",
            &["--set", "gcode.label_comments=true"],
            "; printing object calibration_cube_2",
            "; stop printing object",
        ),
    ] {
        let more = [&["--copies", "2"], &PAUSED[..], labels].concat();
        let file = desk.sliced(name, &more);
        // The stand-in remembers what was cancelled in the file before.
        let is_first = labels.len() == 1;
        let printing = desk.begin(&file, &["--start", "--wait"]);
        wait_for("the pause", || host.get("/api/printer")["state"]["flags"]["paused"] == true);
        let before = std::fs::read_to_string(&log).unwrap();
        if is_first {
            host.post("/api/printer/command", &json!({ "command": "M486 P1" }));
        }
        host.post("/api/job", &json!({ "command": "pause", "action": "resume" }));
        let (code, told) = said(&printing.wait_with_output().unwrap());
        assert!(code == 0 && told.contains(&format!("printed {name}")), "{code}: {told}");
        assert!(told.contains("compared") && told.contains("has written into") != is_first, "{told}");

        let (mut inside, mut wanted, mut left_out) = (false, Vec::new(), 0);
        let text = std::fs::read_to_string(&file).unwrap();
        let paused = text.lines().position(|line| line == "M600").unwrap();
        for (number, line) in text.lines().enumerate() {
            inside = (inside && !line.starts_with(ends)) || line.starts_with(begins);
            let command = line.split(';').next().unwrap_or_default().trim();
            let is_cancelled = inside && (!is_first || number > paused && command.starts_with("G1"));
            left_out += usize::from(is_cancelled && !command.is_empty());
            if !is_cancelled && !command.is_empty() {
                wanted.push(command);
            }
        }
        let sent = std::fs::read_to_string(&log).unwrap();
        std::fs::remove_file(&log).unwrap();
        let differs = wanted.iter().zip(sent.lines()).find(|(wanted, sent)| *wanted != sent);
        assert!(differs.is_none() && wanted.len() == sent.lines().count(), "{name}: {differs:?}");
        assert!(left_out > 100 && before.len() < sent.len(), "{name}: {left_out}");
    }
}

/// It is sent as it is, each change of tool where it stands.
pub fn two_tools_are_printed_with_to_the_end() {
    let mut host = OctoPrint::that_cancels();
    let two = json!({ "profile": { "extruder": { "count": 2 } } });
    let (status, _) = call(host.address, "PATCH", "/api/printerprofiles/_default", KEY, &two.to_string());
    assert_eq!(status, 200);
    host.restart();
    host.ready();
    let desk = host.desk(host.address, KEY);
    let file = desk.of_two_tools("tools.gcode", &[]);
    let (code, told) = said(&desk.begin(&file, &["--start", "--wait"]).wait_with_output().unwrap());
    assert!(code == 0 && told.contains("printed tools.gcode"), "{code}: {told}");
    let sent = std::fs::read_to_string(host.folder.path().join("data/cancel_object/sent.gcode")).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    let of_tools = |text: &str| -> Vec<String> {
        let commands = text.lines().map(|line| line.split(';').next().unwrap_or_default().trim());
        commands.filter(|line| line.starts_with('T') || line.contains(" T")).map(str::to_owned).collect()
    };
    assert!(of_tools(&text).len() > 20);
    assert_eq!(of_tools(&sent), of_tools(&text));
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

/// PrintTimeGenius adds up numbers and units behind `; estimated printing time … =`, and takes the minutes left from M73.
pub fn times_stand_where_its_plug_ins_look() {
    let desk = Desk { folder: tempfile::tempdir().unwrap() };
    let file = desk.path("part.gcode");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl");
    let done = desk.command().arg("slice").arg(model).args(["--json", "-o"]).arg(&file).output().unwrap();
    let ours: Value = serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{}", said(&done).1));
    let total_s = ours["total_s"].as_f64().unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    let told: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("; estimated printing time (normal mode) = "))
        .map(|time| {
            let seconds = |part: &str| {
                let (number, unit) = part.split_at(part.len() - 1);
                let unit_s = [("d", 86_400.0), ("h", 3600.0), ("m", 60.0), ("s", 1.0)];
                number.parse::<f64>().unwrap() * unit_s.iter().find(|(name, _)| *name == unit).unwrap().1
            };
            time.split_whitespace().map(seconds).sum()
        })
        .collect();
    assert!(
        told.len() == 2 && told.iter().all(|told| (told - total_s).abs() <= 1.0),
        "{told:?} for {total_s}"
    );
    let left: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("M73 P")?.split_once(" R")?.1.trim().parse().ok())
        .collect();
    assert_eq!(left.len() as u64, ours["layer_count"].as_u64().unwrap());
    assert!((60.0 * left[0] - total_s).abs() <= 60.0 && left.is_sorted_by(|a, b| a >= b), "{left:?}");
}

fn number_after(text: &str, name: &str) -> f64 {
    let rest = text.split(name).nth(1).unwrap_or_else(|| panic!("{name} is not in {text}"));
    rest.split_whitespace().next().and_then(|number| number.parse().ok()).unwrap_or(f64::NAN)
}
