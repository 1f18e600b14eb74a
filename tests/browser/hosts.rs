//! From the plate to a print host, which is stood in for.

use crate::app::{model, open};
use crate::chromium::Browser;
use crate::server::Server;
use crate::stand_in::duet::{Duet, PASSWORD};

/// Writes down all that is shown of an upload.
const WATCH: &str = "
    window.shown = [];
    const bar = document.getElementById('print-bar');
    new MutationObserver((changes) => {
        for (const { addedNodes } of changes) for (const { textContent } of addedNodes) window.shown.push(textContent, `bar ${bar.value}`);
    }).observe(document.getElementById('print-said'), { childList: true })";

pub fn a_print_is_sent_started_and_followed() {
    let duet = Duet::board();
    let folder = tempfile::tempdir().unwrap();
    let hosts = folder.path().join("hosts.toml");
    let gone = "[gone]\nkind = \"duet\"\nurl = \"http://127.0.0.1:9\"\n";
    let text = format!(
        "[desk]\nkind = \"duet\"\nurl = \"http://{}\"\nkey = \"{PASSWORD}\"\n{gone}",
        duet.server.address
    );
    std::fs::write(&hosts, text).unwrap();
    let server = Server::with_hosts(&hosts);
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.click("#print");
    let says = |text: &str| format!("document.getElementById('printing').textContent.includes({text:?})");
    browser.wait(&says("desk: ready"));
    browser.wait(&says("gone: gone, asking who it is: nothing listens there"));
    browser.run("document.querySelector('input[value=desk]').checked = true");
    browser.click("#print-start");
    browser.run(WATCH);
    browser.click("#print-send");
    browser.wait(&says("calibration_cube.gcode prints on desk."));
    let shown = browser.run("window.shown.join('|')").to_string();
    let said = ["Sending…", "Sending: ", "All of "].map(|text| shown.find(text).unwrap_or(usize::MAX));
    assert!(
        said.is_sorted() && said[2] < usize::MAX && shown.contains(" MB is sent; desk stores it"),
        "{shown}"
    );
    assert!(shown.contains("bar 100") && shown.contains(" % of "), "{shown}");
    assert_eq!(browser.run("document.getElementById('print-bar').hidden"), true);
    browser.wait(&says("printing, calibration_cube.gcode, 50 %, layer 4 of 9"));
    assert_eq!(duet.machine().started, ["calibration_cube.gcode"]);
    duet.machine().polls = 1;
    browser.wait(&says("desk: ready"));
    // It is there now: not without being asked.
    browser.click("#print-send");
    browser.wait(&says("there is a file calibration_cube.gcode already"));
    assert!(!browser.run("document.body.innerHTML").to_string().contains(PASSWORD), "the page knows no key");
}
