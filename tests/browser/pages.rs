//! The pages in a real browser: they open, answer, and never stay blank.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use assert_cmd::cargo::cargo_bin_cmd;
use pathwright::profile::Settings;
use pathwright::view::{Print, Scene, layer_png, layer_svg, page};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::chromium::Browser;

/// What the scripts below have in common. `pixels(color)`: how many of a pane's pixels have nearly this colour.
const TOOLS: &str = "
    window.app = window.pathwright;
    window.put = (id, value, type = 'input') => {
      document.getElementById(id).value = value;
      document.getElementById(id).dispatchEvent(new Event(type, { bubbles: true }));
      app.render();
    };
    window.pixels = ([r, g, b], near = 24) => count((data, i) =>
      Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < near);
    window.count = (wanted) => {
      app.render();
      const from = document.querySelector('.pane canvas'), to = document.createElement('canvas');
      [to.width, to.height] = [from.width, from.height];
      const context = to.getContext('2d');
      context.drawImage(from, 0, 0);
      const { data } = context.getImageData(0, 0, to.width, to.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) count += wanted(data, i);
      return count;
    };
    window.OUTER = [0xe0, 0x7b, 0x00];
    window.shown = (id) => document.getElementById(id).textContent;";

struct Pages(TempDir);

impl Pages {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A page of G-code.
    fn gcode(&self, text: &str) -> PathBuf {
        let settings = Settings::default();
        let scene = Scene::read(text.as_bytes(), &settings);
        let path = self.0.path().join("page.html");
        fs::write(&path, page("page", &[Print::new("print".into(), scene, &settings)])).unwrap();
        path
    }

    /// A page made by the program.
    fn made(&self, args: &[&str], option: &str) -> PathBuf {
        let path = self.0.path().join("made.html");
        let mut command = cargo_bin_cmd!("pathwright");
        command.args(args).arg(option).arg(&path).current_dir(env!("CARGO_MANIFEST_DIR"));
        command.assert().success();
        path
    }
}

/// Squares above each other, 20 mm wide, each with a line of infill.
fn tower(layers: usize) -> String {
    let mut text = String::from("M83\nG1 X50 Y50 F6000\n");
    for layer in 0..layers {
        let z = 0.2 * (layer + 1) as f64;
        let side = 50.0 + 20.0 / (1 + layer % 3) as f64;
        let _ = write!(
            text,
            ";LAYER_CHANGE\nG1 Z{z:.3}\n;TYPE:External perimeter\n;WIDTH:0.5\n;HEIGHT:0.2\nG1 X50 Y50 F6000\n\
             G1 X{side} E1 F1200\nG1 Y{side} E1\nG1 X50 E1\nG1 Y50 E1\nG1 E-1\nG1 X52 Y52 F6000\nG1 E1\n\
             ;TYPE:Internal infill\nG1 X58 Y58 E1 F3000\n"
        );
    }
    text
}

fn number(value: Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

pub fn sliders_keys_and_the_legend_change_the_picture() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let pages = Pages::new();
    browser.resize(1000, 800, false);
    browser.open(&pages.gcode(&tower(6)), "view=2d&layer=1");
    browser.run(TOOLS);
    let outer = number(browser.run("pixels(OUTER)"));
    assert!(outer > 500.0, "{outer}");

    browser.run("put('layer', 3)");
    assert_eq!(browser.run("shown('layer-text')"), json!("3 / 6 · 0.60 mm"));
    assert!(number(browser.run("pixels(OUTER)")) < 0.7 * outer, "the third layer is smaller");
    browser.run("put('progress', app.longest() / 4)");
    assert!(number(browser.run("pixels(OUTER)")) < 0.4 * outer, "and only begun");

    browser.run("put('layer', 1)");
    browser.run("document.querySelector('#legend [data-key=role-0]').click()");
    assert_eq!(browser.run("pixels(OUTER)"), json!(0), "the walls are hidden");
    browser.run("document.querySelector('#legend [data-key=role-0]').click()");

    let press =
        |key: &str| format!("document.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))");
    browser.run(&press("End"));
    assert_eq!(browser.run("app.state.layer"), json!(5));
    browser.run(&press("ArrowDown"));
    assert_eq!(browser.run("app.state.layer"), json!(4));
    let before = number(browser.run("app.state.progress"));
    browser.run(&press("ArrowLeft"));
    assert!(number(browser.run("app.state.progress")) < before);

    browser.run("put('color', 'speed', 'change')");
    assert_eq!(browser.run("pixels(OUTER)"), json!(0), "walls have the colour of their speed");
    browser.run("put('color', 'role', 'change')");
    browser.run(&press("3"));
    assert!(number(browser.run("pixels(OUTER, 160)")) > 200.0, "the print is seen in space");
    // The frame of 16 ms that a step has is measured by work that takes so long here, so that the machine does not matter.
    let fastest = "(() => {
        const steps = [], frames = [], timed = (list, work) => {
          const begun = performance.now();
          work();
          list.push(performance.now() - begun);
        };
        for (let i = 0; i < 30; i++) {
          timed(steps, () => { app.goTo(i % 6); app.render(); });
          timed(frames, () => { window.sum = 0; for (let k = 1; k < 380000; k++) window.sum += Math.sin(k); });
        }
        return [Math.min(...steps), Math.min(...frames)];
      })()";
    let took = browser.run(fastest);
    assert!(number(took[0].clone()) <= number(took[1].clone()), "a step takes {took} ms of script");
    browser.run(
        "(() => { const strip = document.querySelector('.chart canvas'), box = strip.getBoundingClientRect();
         strip.dispatchEvent(new PointerEvent('pointerdown', { clientX: box.left + 9, clientY: box.top + 5 })); })()",
    );
    assert_eq!(browser.run("app.state.layer"), json!(0), "a click in a chart goes there");
    browser.run("put('rate', '500', 'change'); document.getElementById('play').click()");
    browser.run("new Promise((done) => setInterval(() => app.state.playing || done(), 20))");
    assert_eq!(browser.run("app.state.layer"), json!(5), "played to the end");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

pub fn strategies_stand_side_by_side_with_lengths_of_their_own() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let pages = Pages::new();
    let model = "models/plate_with_holes.stl";
    let args =
        ["compare", model, "--order", "nearest,optimized", "--scale", "0.5", "--set", "layer.height=0.3"];
    browser.open(&pages.made(&args, "--html"), "");
    browser.run(TOOLS);
    assert_eq!(browser.run("document.querySelectorAll('.pane canvas').length"), json!(2));
    let links = browser.run("app.prints.map((print) => print.total.link_mm)");
    assert!(number(links[1].clone()) < number(links[0].clone()), "{links}");
    let captions = browser.run("[...document.querySelectorAll('.caption')].map((node) => node.textContent)");
    assert!(captions[0].as_str().unwrap().starts_with("nearest") && captions[0] != captions[1], "{captions}");
    let cells =
        browser.run("[...document.querySelectorAll('#table tbody tr')].map((row) => row.cells.length)");
    assert_eq!(cells, json!([10, 10]), "links, gap, travel and time of layer and print");
    browser.run("put('layer', 2)");
    let text = browser
        .run("[...document.querySelectorAll('.pane canvas')].map((node) => node.getAttribute('aria-label'))");
    for label in text.as_array().unwrap() {
        assert!(label.as_str().unwrap().contains("layer 2:"), "{label}");
    }
    assert_eq!(browser.errors(), Vec::<String>::new());
}

pub fn where_times_are_ordered_for_their_gap_is_shown() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let pages = Pages::new();
    let args = ["compare", "models/calibration_cube.stl", "--order", "optimized", "--cost", "time"];
    browser.open(&pages.made(&args, "--html"), "");
    let gap = browser.run("pathwright.prints[0].time_bound.gap_s");
    let shown = format!("{:.1} %", 100.0 * number(gap));
    let figures = browser.run("[...document.querySelectorAll('dt')].find((node) => node.textContent === 'Gap in time').nextSibling.textContent");
    assert_eq!(figures, json!(shown));
    assert_eq!(browser.errors(), Vec::<String>::new());
}

pub fn a_window_as_small_as_a_phone_shows_all_of_it() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let pages = Pages::new();
    browser.resize(390, 844, true);
    browser.open(&pages.gcode(&tower(4)), "view=2d");
    browser.run(TOOLS);
    assert!(number(browser.run("pixels(OUTER)")) > 500.0);
    assert_eq!(browser.run("document.documentElement.scrollWidth"), json!(390), "nothing sticks out");
    let inside = browser.run(
        "['layer', 'progress', 'play', 'view-3d'].every((id) => {
           const box = document.getElementById(id).getBoundingClientRect();
           return box.width > 30 && box.height > 24 && box.left >= 0 && box.right <= 390 && box.bottom <= 844;
         })",
    );
    assert_eq!(inside, json!(true), "controls can be reached without scrolling");
    let before = browser.run("app.camera().mm");
    let finger = |name: &str, id: u32, x: u32| {
        format!(
            "document.querySelector('.pane canvas').dispatchEvent(new PointerEvent('{name}', \
             {{ pointerId: {id}, pointerType: 'touch', buttons: 1, clientX: {x}, clientY: 300 }}))"
        )
    };
    browser.run("HTMLCanvasElement.prototype.setPointerCapture = () => {}");
    for (name, id, x) in [("pointerdown", 1, 150), ("pointerdown", 2, 200), ("pointermove", 2, 300)] {
        browser.run(&finger(name, id, x));
    }
    assert!(number(browser.run("app.camera().mm")) < 0.5 * number(before), "two fingers zoom");
    assert_eq!(browser.errors(), Vec::<String>::new());
}

pub fn without_webgl_layers_are_drawn_all_the_same() {
    let mut browser = Browser::start(false);
    let pages = Pages::new();
    browser.resize(1000, 800, false);
    browser.open(&pages.gcode(&tower(3)), "view=3d&layer=1");
    browser.run(TOOLS);
    assert_eq!(
        browser.run("[app.state.mode, document.getElementById('view-3d').disabled]"),
        json!(["2d", true])
    );
    assert!(number(browser.run("pixels(OUTER)")) > 500.0);
    browser.run("put('color', 'order', 'change')");
    assert_eq!(browser.run("pixels(OUTER)"), json!(0));
    assert_eq!(browser.errors(), Vec::<String>::new());
}

pub fn odd_files_give_a_page_that_says_what_they_are() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let pages = Pages::new();
    let absurd = "M83\n;LAYER_CHANGE\nG1 X1e9 Y-99999999999 F600\nG1 X2 Y2 Z.2\nG1 X1 Y1\nG1 X9 E1\nG1 X9999 Y9999 E1\n";
    let mut many = String::from("M83\n");
    for layer in 1..=100_000 {
        let _ = write!(many, ";LAYER_CHANGE\nG1 X5 Z{:.2} F600\nG1 X9 E1\n", 0.09 * f64::from(layer));
    }
    for (text, notice, layers) in [
        ("G1 X9 Y9 F600\nG1 X20", "extrudes nothing", 1),
        (&*tower(1), "", 1),
        (absurd, "left out", 1),
        ("\u{0}\u{7f}junk G1X\nM83\nG1 X Y E\nG1 X5 E1 F\nG1 X9 E2 F600\nG1 X", "", 1),
        (&*many, "", 100_000),
    ] {
        browser.open(&pages.gcode(text), "");
        browser.run(TOOLS);
        assert_eq!(browser.run("app.layers"), json!(layers), "{text:.60}");
        // Darker than the grid.
        let drawn = number(browser.run("count((data, i) => data[i] < 160)"));
        assert!(drawn > 100.0, "{text:.60}: {drawn} pixels");
        browser.run("new Promise((done) => setInterval(() => app.panes[0].painter.work || done(), 20))");
        let said = browser.run("shown('notice')");
        assert!(
            said.as_str().unwrap().contains(notice) && said.as_str().unwrap().is_empty() == notice.is_empty(),
            "{said}"
        );
        assert_eq!(browser.errors(), Vec::<String>::new());
    }
}

pub fn svg_and_png_are_the_same_picture() {
    let browser = Browser::shared();
    let mut browser = browser.page();
    let scene = Scene::read(tower(1).as_bytes(), &Settings::default());
    let (svg, png) = (layer_svg(&scene, &scene.layers[0]), layer_png(&scene, &scene.layers[0], 300));
    let script = format!(
        "(async () => {{
           const image = new Image();
           image.src = 'data:image/svg+xml,' + encodeURIComponent({svg});
           await image.decode();
           const other = await createImageBitmap(new Blob([new Uint8Array({png})], {{ type: 'image/png' }}));
           const data = [image, other].map((picture) => {{
             const canvas = document.createElement('canvas');
             [canvas.width, canvas.height] = [other.width, other.height];
             const context = canvas.getContext('2d');
             context.drawImage(picture, 0, 0, canvas.width, canvas.height);
             return context.getImageData(0, 0, canvas.width, canvas.height).data;
           }});
           return data[0].reduce((sum, value, i) => sum + Math.abs(value - data[1][i]), 0) / data[0].length;
         }})()",
        svg = json!(svg),
        png = json!(png)
    );
    let difference = number(browser.run(&script));
    assert!(difference < 2.0, "channels differ by {difference} of 255 on average");
}
