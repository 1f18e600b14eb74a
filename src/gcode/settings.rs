//! What the writer needs to know.

use super::number::text;
use super::options::{Flavor, GcodeSettings, PrinterSettings, ToolChangeSettings, ToolSettings};
use crate::estimate::{Machine, MachineSettings};
use crate::motion::{FilamentSettings, RetractSettings, TemperatureSettings};
use crate::slice::LayerSettings;
use crate::toolpath::ToolId;
use crate::units::{Celsius, Mm, MmPerS, Seconds};

/// Facts of a print that are known before its first layer is planned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrintFacts {
    /// Number of layers.
    pub layers: usize,
    /// Smallest X and Y that are printed on, bed coordinates, millimetres.
    pub min_mm: [f64; 2],
    /// Largest X and Y.
    pub max_mm: [f64; 2],
    /// Top of the last layer, Z offset included.
    pub max_z_mm: f64,
    /// Seconds since 1970 that the header is dated with: `SOURCE_DATE_EPOCH`, or a fixed value, so that the same
    /// input gives the same bytes.
    pub dated: u64,
    /// Corners around what is printed on the first layer, bed coordinates, millimetres.
    pub first_layer_hull_mm: Vec<[f64; 2]>,
    /// Objects, copies counted once.
    pub objects: usize,
    /// Objects, copies counted.
    pub instances: usize,
    /// Name of the first model's file, without folder and ending.
    pub input_name: String,
    /// What is known of the tools, where there are several.
    pub tools: ToolFacts,
}

/// Which tools print, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolFacts {
    /// The tool that the print begins with.
    pub first: ToolId,
    /// Which tools print; empty: the printer has one.
    pub used: Vec<ToolId>,
    /// How often another tool is taken.
    pub changes: usize,
    /// There is a prime tower.
    pub tower: bool,
    /// Tools are primed before the first layer.
    pub primed: bool,
    /// Tools are flushed into an object.
    pub flushes_into_objects: bool,
}

impl PrintFacts {
    /// The box around the first layer: least and greatest X and Y. Where its hull is not known, that of the print.
    pub fn first_layer_box(&self) -> [[f64; 2]; 2] {
        let corners = self.first_layer_hull_mm.iter().map(|&corner| [corner, corner]);
        let joined = corners.reduce(|a, b| {
            [[0, 1].map(|i| f64::min(a[0][i], b[0][i])), [0, 1].map(|i| f64::max(a[1][i], b[1][i]))]
        });
        joined.unwrap_or([self.min_mm, self.max_mm])
    }
}

/// An object on the plate, as labelled for printers that can cancel single objects.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectLabel {
    /// Letters, digits and underscores; another for each object, also where case does not count.
    pub name: String,
    /// Corners of the convex hull of its paths in bed coordinates, millimetres; empty: it has none.
    pub polygon_mm: Vec<[f64; 2]>,
}

impl ObjectLabel {
    /// Labels of objects with these names, of which printers take only letters, digits and underscores.
    pub fn all(objects: impl IntoIterator<Item = (String, Vec<[f64; 2]>)>) -> Vec<Self> {
        let mut labels: Vec<Self> = Vec::new();
        for (name, polygon_mm) in objects {
            let words: Vec<&str> =
                name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()).collect();
            let plain = if words.is_empty() { "object".to_owned() } else { words.join("_") };
            let taken = |name: &str| labels.iter().any(|label| label.name.eq_ignore_ascii_case(name));
            let numbered = (labels.len()..).map(|n| format!("{plain}_{n}"));
            let name =
                std::iter::once(plain.clone()).chain(numbered).find(|name| !taken(name)).unwrap_or_default();
            labels.push(Self { name, polygon_mm });
        }
        labels
    }

    /// The middle of the box around it.
    pub fn center_mm(&self) -> [f64; 2] {
        let extent = |pick: fn(f64, f64) -> f64| {
            let points = self.polygon_mm.iter().copied();
            points.reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])]).unwrap_or_default()
        };
        let (low, high) = (extent(f64::min), extent(f64::max));
        [0, 1].map(|i| 0.5 * (low[i] + high[i]))
    }

    /// Its corners as JSON without blanks.
    pub(super) fn polygon(&self) -> String {
        let points = self.polygon_mm.iter().map(|p| format!("[{},{}]", text(p[0], 2), text(p[1], 2)));
        format!("[{}]", points.collect::<Vec<_>>().join(","))
    }
}

/// The settings of [`format_layer`](super::format_layer).
#[derive(Clone, Debug, PartialEq)]
pub struct WriterSettings {
    /// Firmware dialect.
    pub flavor: Flavor,
    /// E counts from the last move (M83) instead of from the layer's start (M82).
    pub relative_e: bool,
    /// Diameter of the filament.
    pub filament_diameter: Mm,
    /// Write G10 and G11 instead of E moves.
    pub firmware_retraction: bool,
    /// Lines of a pause, placeholders filled in; empty: the flavour's own.
    pub pause: String,
    /// Lines of a color change, placeholders filled in; empty: those of a pause.
    pub color_change: String,
    /// Names of the objects, where labels are wanted.
    pub objects: Vec<String>,
    /// Leave a blank line of fixed width in every layer, for M73.
    pub progress: bool,
    /// Scripts at changes of layer.
    pub layer_scripts: LayerScripts,
    /// Label objects by the flavour's commands.
    pub label_commands: bool,
    /// Label objects by comments.
    pub label_comments: bool,
    /// Each tool, where there are several.
    pub tools: Vec<ToolWriter>,
}

/// What the writer needs to know of a tool.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ToolWriter {
    pub filament_diameter: Mm,
    /// Where its nozzle is, seen from the first tool's, X and Y.
    pub offset_mm: [f64; 2],
    /// Temperature while another tool prints; 0: as while it prints.
    pub idle: Celsius,
    /// It has a heater of its own.
    pub has_heater: bool,
}

/// A line that a height follows, where a layer begins.
pub(crate) const BEFORE_LAYER_CHANGE: &str = ";BEFORE_LAYER_CHANGE";

/// Which scripts run at changes of layer, and what the writer has to restore after them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LayerScripts {
    /// There is one before the nozzle rises.
    pub before: bool,
    /// It says `;BEFORE_LAYER_CHANGE` itself.
    pub before_is_marked: bool,
    /// There is one after it has risen.
    pub after: bool,
    /// They run on the first layer as well.
    pub on_first: bool,
    /// The one after may move the nozzle.
    pub moves: bool,
    /// The one after may change how positions and E are counted.
    pub modes: bool,
    /// Speed of the return in X and Y.
    pub travel_speed: MmPerS,
    /// Speed of the return in Z.
    pub z_speed: MmPerS,
}

/// The settings of header, footer and scripts.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct GcodeOptions {
    pub printer: PrinterSettings,
    pub filament: FilamentSettings,
    pub temperature: TemperatureSettings,
    pub layer: LayerSettings,
    pub retract: RetractSettings,
    pub gcode: GcodeSettings,
    /// Limits that scripts are timed by.
    pub machine: Machine,
    /// Limits that the header states.
    pub limits: MachineSettings,
    /// Each tool, where there are several.
    pub tools: Vec<ToolOptions>,
    /// What takes flushes beside the tower.
    pub tool_change: ToolChangeSettings,
}

/// What header and footer say of a tool.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct ToolOptions {
    pub printer: PrinterSettings,
    pub filament: FilamentSettings,
    pub temperature: TemperatureSettings,
    pub tool: ToolSettings,
    /// How long a change to it takes.
    pub change: Seconds,
    /// What is flushed when each tool follows it, mm³.
    pub flushes_mm3: Vec<f64>,
    /// It has a heater of its own.
    pub has_heater: bool,
}
