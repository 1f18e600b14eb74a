//! Who can use the page, and how: with a token, after a reload, with fingers, with weak eyes.

use serde_json::json;

use crate::app::{READY, SHOWN, model, no_errors, open, set};
use crate::chromium::Browser;
use crate::server::Server;

/// What is on the plate will be there after a reload.
const KEPT: &str = "pathwright.connection.memory.pending === null";

pub fn a_reload_keeps_plate_and_settings() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl"), &model("tilted_bracket.stl")]);
    set(&mut browser, "infill.density", "35%");
    let project = "JSON.stringify(pathwright.desk.project)";
    let before = browser.run(project);
    browser.wait(KEPT);
    browser.reload(READY);
    browser.wait(SHOWN);
    assert_eq!(browser.run(project), before);
    // It is drawn with the next frame.
    browser.wait("pathwright.plate.instances.length === 2");
    // It is a plate like any other: it can be changed, and slices.
    set(&mut browser, "infill.density", "20%");
    no_errors(&mut browser);
}

pub fn a_service_with_tokens_asks_for_one() {
    let (token, other) = ("0123456789abcdef0123", "not-this-token-at-all");
    let server = Server::with_token(token);
    let browser = Browser::shared();
    let mut browser = browser.page();
    browser.resize(1280, 720, false);
    browser.visit(&server.address, "document.getElementById('login')?.open");
    browser.picture("app-13-token");
    browser.type_into("#token", other);
    browser.wait("document.querySelector('#login [role=alert]').textContent.includes('not known')");
    browser.type_into("#token", token);
    browser.wait(READY);
    assert_eq!(browser.run("document.getElementById('login').open"), json!(false));
    browser.drop_files("#plate > canvas", &[&model("calibration_cube.stl")]);
    browser.wait(SHOWN);
    browser.wait(KEPT);
    // Answers with 401 are in the console, which is as it should be.
    browser.reload(READY);
    browser.wait(SHOWN);
    no_errors(&mut browser);
}

pub fn fingers_move_turn_and_enlarge() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("calibration_cube.stl")]);
    browser.wait("pathwright.plate.chosen");
    let place = |browser: &mut Browser, point: &str| -> [f64; 2] {
        let found = browser.run(&format!(
            "(() => {{ const {{ plate }} = pathwright, box = plate.canvas.getBoundingClientRect(), at = plate.chosen.at;
               const [x, y] = plate.project({point}); return [x + box.x, y + box.y]; }})()"
        ));
        [0, 1].map(|i| found[i].as_f64().unwrap())
    };
    // A corner of its top, away from the handles.
    let from = place(&mut browser, "[at[0] - 8, at[1] - 8, 20]");
    let to = place(&mut browser, "[at[0] + 22, at[1] + 12, 20]");
    browser.touch(&[[from], [to]]);
    browser.wait("Math.abs(pathwright.desk.project.models[0].at_mm?.[0] - 155) < 2");

    let camera = "JSON.stringify(pathwright.plate.camera)";
    let before = browser.run(camera);
    let empty = place(&mut browser, "[15, 15, 0]");
    browser.touch(&[[empty], [[empty[0] + 60.0, empty[1] - 20.0]]]);
    browser.wait(&format!("{camera} !== {}", json!(before)));

    let size = "(() => { const { plate } = pathwright, [a, b] = [[0, 0, 0], [100, 0, 0]].map((p) => plate.project(p)); \
        return Math.hypot(a[0] - b[0], a[1] - b[1]); })()";
    let before = browser.run(size).as_f64().unwrap();
    let pinch = |far: f64| [[empty[0] - far, empty[1]], [empty[0] + far, empty[1]]];
    browser.touch(&[pinch(30.0), pinch(60.0)]);
    let after = browser.run(size).as_f64().unwrap();
    assert!(after > 1.5 * before, "{before} to {after} pixels");
    no_errors(&mut browser);
}

/// Texts on their background with less than the contrast of WCAG 2.2, 1.4.3 (AA): 4.5, of large texts 3.
const PALE: &str = "(() => {
    const context = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const pixel = (colors) => {
      context.clearRect(0, 0, 1, 1);
      for (const color of colors) { context.fillStyle = color; context.fillRect(0, 0, 1, 1); }
      return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
    };
    const light = (rgb) => {
      const [r, g, b] = rgb.map((v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const pale = [];
    for (const node of document.querySelectorAll('body *')) {
      const own = [...node.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
      if (!own || !node.checkVisibility({ opacityProperty: true, visibilityProperty: true }) || node.closest(':disabled')) continue;
      const style = getComputedStyle(node), behind = [];
      for (let at = node; at; at = at.parentElement) behind.unshift(getComputedStyle(at).backgroundColor);
      const [a, b] = [light(pixel(['white', ...behind, style.color])), light(pixel(['white', ...behind]))];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), size = parseFloat(style.fontSize);
      const least = size >= 24 || (size >= 18.66 && style.fontWeight >= 700) ? 3 : 4.5;
      if (ratio < least) pale.push(`${node.tagName}.${node.className} ${node.textContent.trim().slice(0, 30)}: ${ratio.toFixed(2)}`);
    }
    return pale;
  })()";

pub fn texts_are_readable_for_weak_eyes() {
    let server = Server::start();
    let browser = Browser::shared();
    let mut browser = browser.page();
    open(&mut browser, &server, &[&model("broken_box.stl")]);
    set(&mut browser, "infill.density", "35%");
    for _ in 0..2 {
        for view in ["plate", "2d", "3d"] {
            browser.click(&format!("#view-{view}"));
            assert_eq!(browser.run(PALE), json!([]), "{view}");
        }
        browser.click("#theme");
    }
    no_errors(&mut browser);
}
