//! The slicer in a browser, used as people use it: dropped files, mouse and keys, and the file that is saved in the end.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::json;
use tempfile::TempDir;

use crate::chromium::Browser;
use crate::server::Server;

pub const READY: &str = "window.pathwright?.desk.schema && pathwright.desk.state !== 'starting'";
/// The newest change is sliced and shown.
pub const SHOWN: &str = "pathwright.desk.state === 'done' && !document.querySelector('#stale:not([hidden])') \
    && !document.getElementById('preview').hidden";

pub fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

/// A page with a model on its plate, sliced.
pub fn open(browser: &mut Browser, server: &Server, models: &[&Path]) {
    browser.resize(1280, 720, false);
    browser.visit(&server.address, READY);
    browser.drop_files("#plate > canvas", models);
    browser.wait(&format!("pathwright.desk.project.models.length === {}", models.len()));
    browser.wait(SHOWN);
}

/// The file that the page saves.
pub fn saved(browser: &mut Browser, folder: &Path) -> Vec<u8> {
    browser.save_to(folder);
    browser.wait(SHOWN);
    browser.click("#save");
    one_file(folder, "gcode")
}

/// The only file with this extension, once it is there.
fn one_file(folder: &Path, extension: &str) -> Vec<u8> {
    let begun = Instant::now();
    loop {
        let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let found: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
        if let [path] = &*found {
            return fs::read(path).unwrap();
        }
        assert!(begun.elapsed() < Duration::from_secs(30), "nothing is saved");
        sleep(Duration::from_millis(30));
    }
}

/// What the command line that the page shows writes, run where these models are.
pub fn by_command(browser: &mut Browser, models: &[&Path]) -> Vec<u8> {
    let line = browser.run("document.getElementById('command-text').value");
    let line = line.as_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for path in models {
        fs::copy(path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let words = line.strip_prefix("pathwright ").unwrap_or_else(|| panic!("{line}"));
    let words: Vec<_> =
        words.split_whitespace().map(|word| word.trim_matches('\'').trim_matches('"')).collect();
    let mut command = cargo_bin_cmd!("pathwright");
    command.args(&words).args(["-o", "by-command.gcode"]).current_dir(folder.path());
    command.assert().success();
    fs::read(folder.path().join("by-command.gcode")).unwrap()
}

/// Sets a setting by searching for it and typing.
pub fn set(browser: &mut Browser, key: &str, value: &str) {
    browser.run("pathwright.desk.doneBefore = pathwright.desk.done?.revision");
    browser.type_into("#search", key);
    browser.type_into(&format!("[data-key='{key}'] input"), value);
    browser.wait("pathwright.desk.done?.revision !== pathwright.desk.doneBefore");
    browser.wait(SHOWN);
}

fn strokes(browser: &mut Browser) -> u64 {
    browser.run("pathwright.preview.prints[0].strokes").as_u64().unwrap()
}

/// Nothing went wrong on the page. What is asked for while a newer revision replaces it is gone, as the service promises.
pub fn no_errors(browser: &mut Browser) {
    let is_replaced = |error: &String| error.contains("410 (Gone)") && error.contains("/revisions/");
    let errors: Vec<String> = browser.errors().into_iter().filter(|error| !is_replaced(error)).collect();
    assert_eq!(errors, Vec::<String>::new());
}

pub fn a_model_is_dropped_turned_sliced_and_saved_as_the_command_line_says() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    let bracket = model("tilted_bracket.stl");
    open(&mut browser, &server, &[&bracket]);
    browser.picture("app-1-dropped");

    browser.type_into("#transform [aria-label^='Angle Z']", "45");
    browser.wait("pathwright.desk.project.models[0].rotate_deg[2] === 45");
    browser.type_into("#presets input", "prusa-i3");
    browser.wait("pathwright.desk.project.profiles.includes('prusa-i3')");
    browser.wait("pathwright.desk.resolved.bed.size_mm[1] === 210");
    browser.wait(SHOWN);
    let before = strokes(&mut browser);
    set(&mut browser, "infill.density", "40%");
    assert_ne!(strokes(&mut browser), before, "the preview shows the infill");
    browser.wait("document.querySelector('#results .change')");
    browser.picture("app-2-infill");

    browser.click("#view-2d");
    browser.run("document.getElementById('layer').focus(); pathwright.preview.goTo(49)");
    browser.click("#pause-here");
    browser.wait("pathwright.desk.project.pauses[0] === '50'");
    browser.wait(SHOWN);
    assert_eq!(browser.run("document.querySelectorAll('#stops .stop').length"), json!(1));
    browser.picture("app-3-pause");

    let gcode = saved(&mut browser, folder.path());
    assert!(gcode == by_command(&mut browser, &[&bracket]), "the same bytes as the command line's");
    assert!(
        String::from_utf8_lossy(&gcode).contains("M601") || String::from_utf8_lossy(&gcode).contains("M0")
    );
    no_errors(&mut browser);
}

pub fn several_objects_of_a_file_are_printed_as_the_command_line_says() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    let path = folder.path().join("pair.3mf");
    fs::write(&path, pair()).unwrap();
    open(&mut browser, &server, &[&path]);
    assert_eq!(browser.run("pathwright.plate.instances[0].parts.length"), json!(2));
    browser.picture("app-4-several");
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let gcode = saved(&mut browser, &out);
    assert!(gcode == by_command(&mut browser, &[&path]), "the same bytes as the command line's");

    browser.click("#objects .note button");
    browser.wait("pathwright.desk.project.models.length === 2");
    browser.wait(SHOWN);
    assert_eq!(browser.run("pathwright.plate.instances.length"), json!(2));
    no_errors(&mut browser);
}

/// A 3MF of two boxes beside each other.
fn pair() -> Vec<u8> {
    use std::io::Write;
    let points: String = (0..8)
        .map(|i| {
            format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", 10 * (i & 1), 10 * (i >> 1 & 1), 8 * (i >> 2))
        })
        .collect();
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let triangles: String =
        faces.iter().map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>")).collect();
    let object = |id| {
        format!(
            "<object id=\"{id}\" name=\"box {id}\" type=\"model\"><mesh><vertices>{points}</vertices><triangles>{triangles}</triangles></mesh></object>"
        )
    };
    let xml = format!(
        "<?xml version=\"1.0\"?><model unit=\"millimeter\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\
         <resources>{}{}</resources><build><item objectid=\"1\"/>\
         <item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 15 4 0\"/></build></model>",
        object(1),
        object(2)
    );
    let types = "<?xml version=\"1.0\"?><Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
        <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
        <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>";
    let relations = "<?xml version=\"1.0\"?><Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
        <Relationship Target=\"/3D/3dmodel.model\" Id=\"r\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in
        [("[Content_Types].xml", types), ("_rels/.rels", relations), ("3D/3dmodel.model", &*xml)]
    {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

pub fn broken_models_tell_what_was_repaired_and_junk_why_it_is_none() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    let broken = model("broken_box.stl");
    open(&mut browser, &server, &[&broken]);
    let note = browser.run("document.querySelector('#objects .note').textContent");
    assert!(note.as_str().unwrap().starts_with("Repaired: "), "{note}");
    browser.picture("app-5-repaired");
    let gcode = saved(&mut browser, folder.path());
    assert!(gcode == by_command(&mut browser, &[&broken]));
    no_errors(&mut browser);

    let junk = folder.path().join("junk.stl");
    fs::write(&junk, "solid nothing at all").unwrap();
    browser.drop_files("#plate > canvas", &[&junk]);
    browser.wait("document.querySelector('.notice.error')");
    let said = browser.run("document.querySelector('.notice.error p').textContent");
    assert!(said.as_str().unwrap().contains("junk.stl"), "{said}");
    assert_eq!(browser.run("pathwright.desk.project.models.length"), json!(1));
    browser.picture("app-6-junk");
}

pub fn what_does_not_fit_is_red_says_why_and_is_mended_by_undo() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.type_into("#transform [aria-label^='Size X']", "400");
    browser.wait("pathwright.desk.state === 'failed' && document.querySelector('.object.bad .why')");
    let why = browser.run("document.querySelector('.object.bad .why').textContent");
    assert!(!why.as_str().unwrap().is_empty());
    assert_eq!(browser.run("document.getElementById('save').disabled"), json!(true));
    let red = "(() => {
        pathwright.plate.render();
        const from = pathwright.plate.canvas, to = document.createElement('canvas'), context = to.getContext('2d');
        [to.width, to.height] = [from.width, from.height];
        context.drawImage(from, 0, 0);
        const { data } = context.getImageData(0, 0, to.width, to.height);
        let count = 0;
        for (let i = 0; i < data.length; i += 4) count += data[i] > 90 && data[i] > 2.2 * data[i + 1];
        return count;
      })()";
    let large = browser.run(red).as_u64().unwrap();
    assert!(large > 10_000, "{large} red pixels");
    browser.picture("app-7-too-large");
    browser.click("#undo");
    browser.wait(SHOWN);
    assert_eq!(browser.run("document.querySelector('.object.bad')"), json!(null));
    no_errors(&mut browser);
}

pub fn of_many_changes_the_last_is_what_is_saved() {
    let (server, folder) = (Server::start(), TempDir::new().unwrap());
    let browser = Browser::shared();
    let mut browser = browser.page();
    let gear = model("helical_gear.stl");
    open(&mut browser, &server, &[&gear]);
    // Each of them cancels the slicing before it.
    browser.run(
        "(async () => {
           for (const percent of [5, 10, 20, 30, 35]) {
             const { desk } = pathwright;
             desk.change({ ...desk.project, settings: { 'infill.density': `${percent}%` } });
             await new Promise((done) => setTimeout(done, 60));
           }
         })()",
    );
    browser.wait("pathwright.desk.state === 'done' && pathwright.desk.resolved.settings['infill.density'].includes('35')");
    let gcode = saved(&mut browser, folder.path());
    let line = browser.run("document.getElementById('command-text').value");
    assert!(line.as_str().unwrap().contains("35%"), "{line}");
    assert!(gcode == by_command(&mut browser, &[&gear]));
    no_errors(&mut browser);
}

pub fn a_page_outlives_its_server() {
    let mut server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    let (port, before) = (server.port, strokes(&mut browser));
    server.kill();
    browser.wait("pathwright.desk.state === 'offline'");
    let said = browser.run("document.getElementById('state-text').textContent");
    assert!(said.as_str().unwrap().contains("No answer"), "{said}");
    browser.picture("app-8-offline");
    // What is changed meanwhile is not lost.
    browser.run("pathwright.desk.change({ ...pathwright.desk.project, settings: { 'walls.count': '4' } })");
    let _again = Server::on(port, &[]);
    browser.wait(SHOWN);
    browser.wait("pathwright.desk.resolved.settings['walls.count'] === '4'");
    browser.wait(&format!("pathwright.preview.prints[0].strokes !== {before}"));
}

pub fn handles_move_turn_and_scale_and_undo_takes_it_back() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    // Two places in the window: of a handle, or of the object itself, and where it is dragged to.
    let places = |browser: &mut Browser, from: &str, to: &str| -> [[f64; 2]; 2] {
        let script = format!(
            "(() => {{ const {{ plate }} = pathwright, box = plate.canvas.getBoundingClientRect(), at = plate.chosen.at;
               return [{from}, {to}].map((p) => plate.project(p)).map(([x, y]) => [x + box.x, y + box.y]); }})()"
        );
        let found = browser.run(&script);
        [0, 1].map(|i| [0, 1].map(|k| found[i][k].as_f64().unwrap()))
    };
    let model = "pathwright.desk.project.models[0]";
    browser.wait("pathwright.plate.chosen");
    let [from, to] = places(&mut browser, "[at[0], at[1], 20]", "[at[0] + 30, at[1] + 20, 20]");
    browser.drag(from, to);
    browser
        .wait(&format!("Math.abs({model}.at_mm?.[0] - 155) < 1.5 && Math.abs({model}.at_mm[1] - 145) < 1.5"));

    browser.click("#gizmo-turn");
    browser.wait("pathwright.plate.handles.length === 3");
    let [from, to] = places(&mut browser, "plate.handles[2].points[3]", "plate.handles[2].points[9]");
    browser.drag(from, to);
    browser.wait(&format!("{model}.rotate_deg[2] === 45"));
    browser.picture("app-9-turned");

    browser.click("#gizmo-scale");
    browser.wait("pathwright.plate.handles.length === 4");
    let [from, to] = places(
        &mut browser,
        "plate.handles[3].points[1]",
        "plate.handles[3].points[1].map((v, i) => v + (v - plate.handles[3].points[0][i]))",
    );
    browser.drag(from, to);
    browser.wait(&format!("Math.abs({model}.scale[0] - 2) < 0.3 && {model}.scale[0] === {model}.scale[2]"));

    for _ in 0..3 {
        browser.click("#undo");
    }
    browser.wait(&format!("{model}.scale[0] === 1 && {model}.rotate_deg[2] === 0 && !{model}.at_mm"));
    // It stands where it is clicked on only when it has been placed anew.
    browser.wait(SHOWN);
    browser.click("#gizmo-face");
    browser.wait("pathwright.plate.faces?.length >= 6");
    let [_, on] = places(&mut browser, "at", "[at[0], at[1] - 10, 10]");
    browser.drag(on, on);
    browser.wait(&format!("{model}.rotate_deg.some((angle) => Math.abs(angle) === 90)"));
    no_errors(&mut browser);
}

pub fn two_strategies_stand_side_by_side() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.click("#compare");
    browser.click("#comparing button.main");
    browser.wait(
        "pathwright.preview.prints.length === 2 && document.querySelectorAll('#table tbody tr').length === 2",
    );
    let table = browser.run("document.getElementById('table').textContent");
    assert!(table.as_str().unwrap().contains("nearest"), "{table}");
    // Proofs take longer, and come after.
    browser.wait("document.getElementById('table').textContent.includes('Gap in time')");
    browser.picture("app-10-compare");
    browser.click("#end-compare");
    browser.wait("pathwright.preview.prints.length === 1");
    no_errors(&mut browser);
}

pub fn settings_are_found_changed_and_taken_back() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.type_into("#search", "retract length");
    let found = browser.run(
        "[...document.querySelectorAll('.setting')].filter((n) => n.offsetParent).map((n) => n.dataset.key)",
    );
    assert!(found.as_array().unwrap().contains(&json!("retract.length")), "{found}");
    set(&mut browser, "layer.height", "0.3");
    browser.wait("document.querySelector(\"[data-key='layer.height']\").classList.contains('changed')");
    browser.click("[data-key='layer.height'] .back");
    browser.wait("!('layer.height' in pathwright.desk.project.settings)");
    browser.wait(SHOWN);

    browser.type_into("[data-key='layer.height'] input", "90");
    browser.wait("document.querySelector(\"[data-key='layer.height'] .problem:not([hidden])\")");
    assert_eq!(browser.run("pathwright.desk.state"), json!("failed"));
    browser.picture("app-11-problem");
    browser.click("#undo");
    browser.wait(SHOWN);

    browser.click("#settings .top .pair button:last-child");
    browser.type_into("#search", "density");
    browser.type_into("[data-key='infill.density'] input", "80%");
    browser.wait("pathwright.desk.project.models[0].settings['infill.density'] === '80%'");
    browser.wait(SHOWN);
    no_errors(&mut browser);
}

pub fn it_works_on_a_tablet_in_the_dark() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.resize(820, 1180, true);
    browser.click("#theme");
    browser.click("#show-settings");
    browser.wait("document.getElementById('right').getBoundingClientRect().right <= 820");
    browser.wait("getComputedStyle(document.getElementById('right')).visibility === 'visible'");
    browser.picture("app-12-tablet");
    let small = browser.run(
        "[...document.querySelectorAll('header button, footer button')].filter((n) => n.offsetParent)
           .filter((n) => { const box = n.getBoundingClientRect(); return box.height < 24 || box.right > 821 || box.left < 0; }).map((n) => n.id)",
    );
    assert_eq!(small, json!([]), "buttons that fingers cannot press");
    browser.click("#show-settings");
    browser.click("#theme");
    // Every control has a name for those who do not see it.
    let nameless = browser.run(
        "[...document.querySelectorAll('button, input, select, textarea')].filter((n) => n.type !== 'hidden')
           .filter((n) => !(n.getAttribute('aria-label') || n.labels?.length || n.textContent.trim() || n.title))
           .map((n) => n.outerHTML.slice(0, 80))",
    );
    assert_eq!(nameless, json!([]));
    no_errors(&mut browser);
    browser.resize(1280, 720, false);
}
