//! The page without a server: static files, and a plain server for them that ends with the test.

use std::cell::Cell;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::json;

use crate::app::{READY, SHOWN, by_command, model, no_errors, open, saved, set};
use crate::chromium::Browser;
use crate::server::Server;
use crate::stand_in::moonraker::{KEY, Moonraker};

thread_local! {
    static CHOSEN: Cell<bool> = const { Cell::new(false) };
}

/// The folder that `cargo run -p xtask -- site` has made, by the variable `PATHWRIGHT_SITE`.
pub fn folder() -> Option<PathBuf> {
    std::env::var_os("PATHWRIGHT_SITE").map(PathBuf::from)
}

/// Does a test of the page with the static files in place of the program.
pub fn instead(test: fn()) {
    CHOSEN.set(true);
    test();
}

/// Whether this test is about the static files.
pub fn is_chosen() -> bool {
    CHOSEN.get()
}

/// Serves files of a folder, one request on one connection, and nothing else.
pub struct Files {
    pub port: u16,
    ending: Arc<AtomicBool>,
}

impl Files {
    pub fn serve(folder: &Path) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let (ending, folder) = (Arc::new(AtomicBool::new(false)), folder.to_owned());
        let is_ending = ending.clone();
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                if is_ending.load(Ordering::Relaxed) {
                    return;
                }
                // Browsers open connections that they do not use.
                let folder = folder.clone();
                std::thread::spawn(move || stream.map(|stream| answer(stream, &folder)));
            }
        });
        Self { port, ending }
    }

    /// Answers no more.
    pub fn end(&self) {
        self.ending.store(true, Ordering::Relaxed);
        let _ = TcpStream::connect(("127.0.0.1", self.port));
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        self.end();
    }
}

fn answer(mut stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let first = lines.next().unwrap_or_else(|| Ok(String::new()))?;
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    let path = first.split(' ').nth(1).unwrap_or_default().trim_start_matches('/');
    let path = if path.is_empty() { "index.html" } else { path };
    let kind = match path.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "wasm" => "application/wasm",
        _ => "application/octet-stream",
    };
    let (status, body) = match fs::read(folder.join(path)) {
        Ok(body) if !path.contains("..") => ("200 OK", body),
        _ => ("404 Not Found", Vec::new()),
    };
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(&body)
}

pub fn a_model_is_sliced_to_the_bytes_of_the_program_and_nobody_else_is_asked() {
    let (server, folder) = (Server::start(), tempfile::tempdir().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    let gear = model("helical_gear.stl");
    open(&mut browser, &server, &[&gear]);
    let gcode = saved(&mut browser, folder.path());
    assert!(gcode == by_command(&mut browser, &[&gear]), "the same bytes as the command line's");
    let asked = browser.run(
        "[...new Set(performance.getEntriesByType('resource').map(({ name }) => new URL(name)).filter(({ protocol }) => protocol !== 'blob:').map(({ origin }) => origin))]",
    );
    assert_eq!(asked, json!([format!("http://127.0.0.1:{}", server.port)]));
    no_errors(&mut browser);
}

pub fn what_is_dropped_while_the_module_loads_waits_for_it() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    browser.visit(&server.address, "window.pathwright");
    browser.drop_files("#plate > canvas", &[&model("calibration_cube.stl")]);
    browser.wait(SHOWN);
    no_errors(&mut browser);
}

pub fn it_works_without_a_network_after_the_first_visit() {
    let mut server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    browser.resize(1280, 720, false);
    browser.visit(&server.address, READY);
    browser.wait("navigator.serviceWorker.controller");
    server.kill();
    browser.reload(READY);
    browser.drop_files("#plate > canvas", &[&model("calibration_cube.stl")]);
    browser.wait(SHOWN);
    set(&mut browser, "infill.density", "35%");
}

pub fn after_the_first_visit_it_has_threads_and_slices_to_the_same_bytes() {
    let (server, folder) = (Server::start(), tempfile::tempdir().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    browser.visit(&server.address, READY);
    browser.wait("navigator.serviceWorker.controller");
    browser.reload(READY);
    assert_eq!(browser.run("crossOriginIsolated"), json!(true));
    let gear = model("helical_gear.stl");
    browser.drop_files("#plate > canvas", &[&gear]);
    browser.wait(SHOWN);
    let threads = browser.run("pathwright.engine.slicing.workers.length");
    assert_eq!(threads, browser.run("Math.min(navigator.hardwareConcurrency, 8)"));
    let gcode = saved(&mut browser, folder.path());
    assert!(gcode == by_command(&mut browser, &[&gear]), "the same bytes as the command line's");
    no_errors(&mut browser);
}

pub fn what_takes_too_much_memory_ends_with_a_message_and_the_page_goes_on() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    // So does the worker of a module that has no more memory.
    browser.run(
        "pathwright.engine.slicing.end(Object.assign(new Error('it takes more memory than there is'), { kind: 'limit' }))",
    );
    browser.wait("pathwright.desk.state === 'failed'");
    assert_eq!(browser.run("pathwright.desk.error.kind"), json!("limit"));
    set(&mut browser, "infill.density", "35%");
    no_errors(&mut browser);
}

/// A vendor's bundle, as PrusaSlicer keeps it.
const BUNDLE: &str = "[vendor]\nname = Acme\n[printer:Acme One]\nnozzle_diameter = 0.4\nbed_shape = 0x0,180x0,180x170,0x170\n\
    gcode_flavor = marlin2\ndefault_print_profile = Fine\n[print:Coarse]\nlayer_height = 0.3\n[print:Fine]\nlayer_height = 0.1\n\
    [filament:Soft]\nfilament_diameter = 1.75\ntemperature = 222\nfirst_layer_temperature = 222\n";

pub fn presets_are_those_of_a_folder_that_is_dropped_and_stay_until_they_are_forgotten() {
    let (server, folder) = (Server::start(), tempfile::tempdir().unwrap());
    let slicer = folder.path().join("MySlicer");
    fs::create_dir_all(slicer.join("vendor")).unwrap();
    fs::write(slicer.join("vendor/Acme.ini"), BUNDLE).unwrap();
    fs::write(slicer.join("notes.txt"), "none of them").unwrap();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.drop_files("#plate > canvas", &[&slicer]);
    browser.wait("document.getElementById('notices').textContent.includes('1 printers of MySlicer')");
    assert_eq!(browser.run("pathwright.desk.project.models.length"), json!(1), "a folder is no model");
    browser.type_into("#presets input", "acme");
    browser.wait("pathwright.desk.project.presets.printer === 'Acme One'");
    browser.wait("pathwright.desk.resolved.bed.size_mm[0] === 180");
    browser.wait(SHOWN);
    assert_eq!(browser.run("pathwright.desk.resolved.settings['layer.height']"), json!("0.1"));
    browser.run("[...document.querySelectorAll('#presets [role=combobox]')][1].click()");
    browser.wait("document.querySelector('#presets').textContent.includes('Coarse')");
    browser.reload(READY);
    browser.wait("pathwright.desk.resolved?.bed.size_mm[0] === 180");
    browser.wait(SHOWN);
    assert_eq!(browser.run("document.getElementById('preset-folders').textContent"), json!("MySlicer✕"));
    browser.click("#preset-folders button");
    browser.wait("pathwright.desk.state === 'failed'");
    assert_eq!(browser.run("document.getElementById('preset-folders').textContent"), json!(""));
    no_errors(&mut browser);
}

pub fn a_print_goes_to_a_host_that_allows_the_page_and_one_that_does_not_tells_what_to_set() {
    let (server, moonraker) = (Server::start(), Moonraker::start());
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    let (address, origin) = (moonraker.server.address, format!("http://127.0.0.1:{}", server.port));
    assert_eq!(
        browser.run(&format!("fetch('http://{address}/').then(() => 'asked', () => 'forbidden')")),
        json!("forbidden")
    );
    assert!(moonraker.server.seen().is_empty(), "the page asks nobody whom it was not given");
    browser.errors();
    browser.click("#print");
    browser.run("document.getElementById('host-kind').value = 'moonraker'");
    for (field, text) in [("url", address.to_string()), ("key", KEY.into()), ("name", "voron".into())] {
        browser.run(&format!("document.getElementById('host-{field}').value = {text:?}"));
    }
    browser.run("window.before = true");
    browser.run("document.getElementById('host-add').click()");
    browser.wait(&format!("!window.before && {READY} && {SHOWN}"));
    browser.click("#print");
    let says = |text: &str| format!("document.getElementById('printing').textContent.includes({text:?})");
    browser.wait(&says("either it cannot be reached"));
    browser.wait(&says(&format!("`cors_domains:` with the line `{origin}`")));
    moonraker.machine().cors_domains.push(origin);
    browser.wait(&says("voron: ready"));
    browser.click("#print-start");
    browser.click("#print-send");
    browser.wait(&says("calibration_cube.gcode prints on voron."));
    let sent = moonraker.machine().files["calibration_cube.gcode"].clone();
    assert!(sent == by_command(&mut browser, &[&model("calibration_cube.stl")]), "the same bytes");
    assert_eq!(moonraker.machine().started, ["calibration_cube.gcode"]);
    browser.wait(&says("printing, calibration_cube.gcode, 25 %"));
    assert!(!browser.run("document.body.innerHTML").to_string().contains(KEY), "no key is shown");
}
