//! The page: one file with style, script and data, which opens without a network.

use serde_json::{Value, json};

use super::colors::{DARK, LIGHT, RAMP, ROLES, Rgb, Theme, hex};
use super::pack::{Packed, pack};
use super::scene::Scene;
use crate::profile::Settings;
use crate::report::{Measures, TimeBound};

const TEMPLATE: &str = include_str!("page/index.html");
/// That of the parts, which other pages have as well, and the page's own.
const STYLES: [&str; 2] = [include_str!("page/parts.css"), include_str!("page/style.css")];
/// In the order in which they need each other.
const SCRIPTS: [&str; 13] = [
    include_str!("page/dom.js"),
    include_str!("page/unpack.js"),
    include_str!("page/paint.js"),
    include_str!("page/camera.js"),
    include_str!("page/shaders.js"),
    include_str!("page/strokes.js"),
    include_str!("page/gl.js"),
    include_str!("page/canvas.js"),
    include_str!("page/pane.js"),
    include_str!("page/charts.js"),
    include_str!("page/legend.js"),
    include_str!("page/figures.js"),
    include_str!("page/app.js"),
];
/// What other pages use of them.
#[cfg(feature = "serve")]
const EXPORTS: &str = "App, FIELD, lights, program, rgb, GlPainter, TurnCamera, Pane, element, find, fixed, length, duration, \
    unpack, roleLengths, markCounts, strokeWords, glance, outlineOf";
const MAIN: &str = include_str!("page/main.js");

/// One of the prints of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Print {
    /// What it is called.
    pub name: String,
    /// What it draws.
    pub scene: Scene,
    /// Weight of its filament.
    pub filament_g: f64,
    /// How near to the least its links are in time, where that is known.
    pub time_bound: Option<TimeBound>,
}

impl Print {
    /// A print of the filament in the settings.
    pub fn new(name: String, scene: Scene, settings: &Settings) -> Self {
        let filament_g = scene.total.volume_mm3 / 1000.0 * settings.filament.density;
        Self { name, scene, filament_g, time_bound: None }
    }

    /// Takes links and lower bounds, of each layer and of all, and the bound of time from the caller. Nothing changes where
    /// those layers are others than the G-code's.
    #[must_use]
    pub fn with_bounds(
        mut self,
        layers: &[(f64, Option<f64>)],
        total: (f64, Option<f64>),
        time_bound: Option<TimeBound>,
    ) -> Self {
        if layers.len() != self.scene.layers.len() {
            return self;
        }
        for (layer, (link_mm, bound_mm)) in self.scene.layers.iter_mut().zip(layers) {
            layer.measures.link_mm = *link_mm;
            layer.measures.bound_mm = *bound_mm;
        }
        let measures = Measures { link_mm: total.0, ..self.scene.total };
        self.scene.total = match total.1 {
            Some(bound_mm) => measures.with_bound(bound_mm),
            None => measures,
        };
        self.time_bound = time_bound;
        self
    }
}

/// A page for one print, or for several side by side.
pub fn page(title: &str, prints: &[Print]) -> String {
    let mut data = String::new();
    let mut infos = Vec::new();
    for (index, print) in prints.iter().enumerate() {
        let packed = pack(&print.scene);
        infos.push(info(print, &packed));
        data += "<script type=\"text/plain\" id=\"print-";
        data += &format!("{index}\">{}</script>\n", packed.base64());
    }
    let mut head = palette();
    head["prints"] = infos.into();
    // Names may hold what would end the script.
    let head = head.to_string().replace('<', "\\u003c");
    let data = format!("<script type=\"application/json\" id=\"data\">{head}</script>\n{data}");
    let script = format!("\"use strict\";\n(() => {{\n{}\n{MAIN}}})();", SCRIPTS.join("\n"));
    fill(&[("title", &escape(title)), ("style", &STYLES.concat()), ("data", &data), ("script", &script)])
}

/// The page's parts as one module, for pages that are served: what they share, and the colours as `PALETTE`.
#[cfg(feature = "serve")]
pub(crate) fn parts_module() -> String {
    format!("{}\nconst PALETTE = {};\nexport {{ {EXPORTS}, PALETTE }};\n", SCRIPTS.join("\n"), palette())
}

/// The style of those parts.
#[cfg(feature = "serve")]
pub(crate) fn parts_style() -> &'static str {
    STYLES[0]
}

/// The colours of roles, values and themes.
fn palette() -> Value {
    json!({
        "roles": ROLES.iter().map(|role| json!({ "label": role.label, "color": hex(role.color) })).collect::<Vec<_>>(),
        "ramp": RAMP.map(hex),
        "themes": { "light": theme(&LIGHT), "dark": theme(&DARK) },
    })
}

/// What the first bytes of a preview say.
const MAGIC: &[u8; 4] = b"PWP1";

/// A print in packed form: `PWP1`, the length of the head (32 bits, little-endian), the head as JSON with the counts that
/// reading needs, then the strokes as `unpack.js` reads them, not deflated.
pub fn preview(print: &Print) -> Vec<u8> {
    let packed = pack(&print.scene);
    let head = info(print, &packed).to_string();
    let length = (head.len() as u32).to_le_bytes();
    [MAGIC.as_slice(), &length, head.as_bytes(), &packed.bytes].concat()
}

/// The template, each `<!--name-->` replaced by its text.
fn fill(values: &[(&str, &str)]) -> String {
    let mut parts = TEMPLATE.split("<!--");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("-->").unwrap_or(("", part));
        out += values.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text);
        out += rest;
    }
    out
}

fn info(print: &Print, packed: &Packed) -> Value {
    let [low, high] = print.scene.bounds().unwrap_or([[0.0; 2], [1.0; 2]]);
    json!({
        "name": print.name,
        "notes": notes(print),
        "strokes": packed.strokes,
        "marks": packed.marks,
        "layers": print.scene.layers.len(),
        "bounds": [low[0], low[1], high[0], high[1]],
        "total": print.scene.total,
        "filament_g": print.filament_g,
        "time_bound": print.time_bound,
    })
}

/// What people should know before they wonder.
fn notes(print: &Print) -> Vec<String> {
    let mut notes = Vec::new();
    if !print.scene.extrudes() {
        notes.push(format!("{} extrudes nothing: what is shown is travel.", print.name));
    }
    if print.scene.left_out > 0 {
        notes.push(format!(
            "{}: {} moves lead further than 10 m from the origin and are left out.",
            print.name, print.scene.left_out
        ));
    }
    notes
}

fn theme(theme: &Theme) -> Value {
    let color = |color: Rgb| hex(color);
    json!({
        "background": color(theme.background),
        "bed": color(theme.bed),
        "ink": color(theme.ink),
        "travel": color(theme.travel),
        "retraction": color(theme.retraction),
        "unretraction": color(theme.unretraction),
        "seam": color(theme.seam),
    })
}

/// Text as HTML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_whole_and_refers_to_nothing_outside() {
        let settings = Settings::default();
        let scene = Scene::read(b"M83\nG1 X9 Z.2 F600\nG1 Y9 E1", &settings);
        let name = "</script><b>&".to_owned();
        let print = Print::new(name.clone(), scene, &settings);
        let page = page(&name, &[print]);
        assert!(
            page.contains("<title>&lt;/script&gt;&lt;b&gt;&amp;</title>") && !page.contains("</script><b>")
        );
        assert!(!page.contains("<!--") && page.trim_end().ends_with("</html>"));
        assert!(!page.contains("src=") && !page.contains("href=") && !page.contains("https://"));
    }
}
