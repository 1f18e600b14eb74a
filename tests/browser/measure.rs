//! Times of the page, printed for whoever asks:
//! `PATHWRIGHT_PROGRAM=target/release/pathwright cargo test --test browser -- --ignored measure --nocapture`.

use std::path::PathBuf;
use std::time::Instant;

use crate::app::{READY, SHOWN, model};
use crate::chromium::Browser;
use crate::server::Server;

/// Slices the model that the variable `PATHWRIGHT_MODEL` names, changes settings, and prints how long it took until each result
/// was shown, and every task of the page that took longer than 50 ms: without WebGL and with it, which here means that the
/// processor draws all that a graphics card would.
pub fn how_long_the_page_is_busy() {
    for webgl in [false, true] {
        println!("WebGL: {webgl}");
        try_page(&mut Browser::start(webgl));
    }
}

fn try_page(browser: &mut Browser) {
    let path = std::env::var_os("PATHWRIGHT_MODEL").map_or_else(|| model("helical_gear.stl"), PathBuf::from);
    let server = Server::start();
    browser.resize(1280, 720, false);
    browser.visit(&server.address, READY);
    browser.run(
        "window.tasks = []; new PerformanceObserver((list) => tasks.push(...list.getEntries().map((e) => Math.round(e.duration))))
           .observe({ type: 'longtask' })",
    );
    let begun = Instant::now();
    browser.drop_files("#plate > canvas", &[&path]);
    browser.wait("pathwright.desk.project.models.length === 1");
    browser.wait(SHOWN);
    println!("{}: shown after {} ms", path.display(), begun.elapsed().as_millis());
    let tasks = |browser: &mut Browser| browser.run("tasks.splice(0).join(', ')");
    println!("  tasks over 50 ms, in ms: {}", tasks(browser));
    for (key, value) in [
        ("infill.density", "30%"),
        ("walls.count", "3"),
        ("speed.infill", "70"),
        ("layer.height", "0.3"),
        ("infill.density", "10%"),
        ("infill.pattern", "gyroid"),
    ] {
        let begun = Instant::now();
        browser.run(&format!(
            "(() => {{ const {{ desk }} = pathwright; desk.doneBefore = desk.done?.revision;
               desk.change({{ ...desk.project, settings: {{ ...desk.project.settings, '{key}': '{value}' }} }}); }})()"
        ));
        browser.wait("pathwright.desk.done?.revision !== pathwright.desk.doneBefore");
        browser.wait(SHOWN);
        let took_ms = begun.elapsed().as_millis();
        println!("{key} = {value}: shown after {took_ms} ms; tasks over 50 ms: {}", tasks(browser));
    }
}
