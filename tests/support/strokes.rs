//! Every stroke of a print by the tool that draws it.

use super::print::Print;
use pathwright::gcode::{Action, replay};
use pathwright::profile::{self, Settings};

/// A stroke on the part by a tool, counted from 1.
#[derive(Debug)]
pub struct Line {
    pub tool: u32,
    pub layer: usize,
    pub kind: String,
    /// Its ends, from the middle of the bed.
    pub ends: [[f64; 2]; 2],
    /// Its middle, from that of the bed.
    pub at: [f64; 2],
    /// As the file has it.
    pub width_mm: f64,
    pub volume_mm3: f64,
}

/// The strokes of the layers, those of the prime tower left out.
pub fn lines(print: &Print, settings: &Settings) -> Vec<Line> {
    let (mut tool, mut layer, mut kind, mut width_mm, mut lines) = (0, None, String::new(), 0.0, Vec::new());
    let middle = settings.bed.middle_mm();
    for step in replay(&print.text) {
        match step.action {
            Action::Type(name) => kind = String::from_utf8_lossy(name).into_owned(),
            Action::Stroke(s)
                if s.extrudes() && s.xy_mm > 0.0 && kind != "Wipe tower" && kind != "Custom" =>
            {
                if let Some(layer) = layer {
                    let [from, to] = [s.from, s.to].map(|end| [0, 1].map(|i| end[i] - middle[i]));
                    let at = [0, 1].map(|i| f64::midpoint(from[i], to[i]));
                    let volume_mm3 = s.fresh_mm3(profile::filament_area_mm2(settings.filament.diameter));
                    let (tool, kind) = (tool + 1, kind.clone());
                    lines.push(Line { tool, layer, kind, ends: [from, to], at, width_mm, volume_mm3 });
                }
            }
            _ if step.line.text == b";LAYER_CHANGE" => layer = Some(layer.map_or(0, |layer| layer + 1)),
            _ => {
                let text = std::str::from_utf8(step.line.text).unwrap_or_default();
                if let Some(width) = text.strip_prefix(";WIDTH:") {
                    width_mm = width.parse().expect("a width");
                }
            }
        }
        if let Some(code) = step.line.code.filter(|code| code.letter == b'T') {
            tool = code.number;
        }
    }
    lines
}

/// What lines extrude.
pub fn volume_mm3<'a>(lines: impl Iterator<Item = &'a Line>) -> f64 {
    lines.map(|line| line.volume_mm3).sum()
}
