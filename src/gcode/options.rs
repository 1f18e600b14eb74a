//! The dialect and what is written in it.

use crate::estimate::Firmware;
use crate::options::{choice, section};
use crate::order::ToolOrder;
use crate::units::{Celsius, Mm, Mm3, Seconds};

choice! {
    /// Firmware dialect.
    Flavor {
        /// Marlin 2.
        Marlin = "marlin",
        /// Marlin 1, and what is like it: one acceleration for printing and travel.
        MarlinLegacy = "marlin-legacy",
        /// Klipper.
        Klipper = "klipper",
        /// RepRapFirmware 3.
        RepRapFirmware = "reprapfirmware",
    }
}
section! {
    /// `[printer]`: the machine's dialect.
    PrinterSettings {
        /// Name, written in the header.
        name: String = "RepRap 250".into(),
        /// Firmware dialect.
        flavor: Flavor = Flavor::Marlin,
        /// Nozzle diameter.
        nozzle_diameter: Mm = Mm(0.4); 0.1..=2.0,
    }
}
section! {
    /// `[gcode]`
    GcodeSettings {
        /// E counts from the last move (M83) instead of from the layer's start (M82).
        relative_e: bool = true,
        /// Write arcs (G2, G3) where the path follows one.
        arcs: bool = false,
        /// Greatest deviation of an arc from the path.
        arc_tolerance: Mm = Mm(0.02); 0.001..=0.5,
        /// Thumbnails in the header, for printers with a screen: width × height in pixels and a format (PNG where left out, JPG, QOI, COLPIC, BTT_TFT), such as 32x32,300x300/QOI; empty: none.
        thumbnails: String = "32x32,300x300".into(),
        /// Write binary G-code (`.bgcode`) where no output is named; a name decides for itself.
        binary: bool = false,
        /// Label objects (`EXCLUDE_OBJECT`, M486), so that a printer can cancel a single one.
        labels: bool = false,
        /// Label objects by comments, as plug-ins of OctoPrint read them.
        label_comments: bool = false,
        /// State `[machine]` at the start (M201, M203, M204, M205, M566, `SET_VELOCITY_LIMIT`) instead of relying on the firmware's own.
        limits: bool = false,
        /// Heat nozzle and bed where the start script does not, and switch them off where the end script does not.
        heat: bool = true,
        /// Leave out scripts that cannot be expanded, with a warning, instead of refusing the print.
        ignore_scripts: bool = false,
        /// Start script.
        start: String = String::new(),
        /// End script.
        end: String = String::new(),
        /// Script of the filament, after the start script.
        filament_start: String = String::new(),
        /// Script of the filament, before the end script.
        filament_end: String = String::new(),
        /// Script at each change of layer, before the nozzle rises; not on the first layer.
        before_layer: String = String::new(),
        /// Script at each change of layer, when the nozzle has risen; not on the first layer.
        after_layer: String = String::new(),
        /// Run the scripts of layer changes on the first layer as well.
        first_layer_scripts: bool = false,
        /// Script between objects that are printed one after the other.
        between_objects: String = String::new(),
        /// Pause script; empty: the flavor's own.
        pause: String = String::new(),
        /// Script of a color change; empty: that of a pause.
        color_change: String = String::new(),
        /// Name of the G-code file where none is given, with placeholders, such as {input_filename_base}_{layer_height}mm.gcode; empty: the model's.
        file_name: String = String::new(),
    }
}

choice! {
    /// How the machine comes to print with another tool.
    ToolChangeKind {
        /// One nozzle, to which a changer feeds one filament or another.
        SingleNozzle = "single-nozzle",
        /// Tools that are parked and picked up, each with a nozzle of its own.
        ToolChanger = "tool-changer",
        /// Several nozzles that stay on the carriage, or carriages of their own.
        Heads = "heads",
    }
}
impl ToolChangeKind {
    /// Whether each tool has a nozzle of its own, and with it a heater.
    pub(crate) fn has_nozzles(self) -> bool {
        self != Self::SingleNozzle
    }
}

section! {
    /// `[tool]`: what each tool has of its own; these values hold for those of `[[tools]]` that say nothing else. See [tools](tools.md).
    ToolSettings {
        /// Name, for messages and the summary.
        name: String = String::new(),
        /// Where the nozzle is, seen from the first tool's, where the firmware does not make up for it: X and Y.
        offset: [Mm; 2] = [Mm(0.0), Mm(0.0)]; -500.0..=500.0,
        /// Temperature while another tool prints; 0: as while it prints. Not of a single nozzle.
        idle_temperature: Celsius = Celsius(0.0); 0.0..=500.0,
        /// How quickly its nozzle is heated: from there in time for its turn, and by how long it is waited for; 0: not before.
        heating_rate: f64 = 2.0; 0.0..=100.0, "°C/s",
    }
}
section! {
    /// `[tool_change]`: from one of `[[tools]]` to another.
    ToolChangeSettings {
        /// How the machine changes.
        kind: ToolChangeKind = ToolChangeKind::SingleNozzle,
        /// Script of a change; where it names no tool (`T1`), that is said after it. Each of `[[tools]]` may have its own, by which one changes to it.
        script: String = String::new(),
        /// How long a change takes, without heating, flushing and the moves of its script.
        time: Seconds = Seconds(10.0); 0.0..=3600.0,
        /// Filament flushed at each change; 0: by a single nozzle what the colors of both filaments take (140 mm³ where one is not known), 15 mm³ by others.
        flush_volume: Mm3 = Mm3(0.0); 0.0..=5000.0,
        /// Least and most that is flushed by the colors.
        flush_limits: [Mm3; 2] = [Mm3(60.0), Mm3(500.0)]; 0.0..=5000.0,
        /// Multiplier of all flushes, whether listed or not.
        flush_multiplier: f64 = 1.0; 0.0..=10.0,
        /// Filament flushed from each tool (rows) to each other (columns), row by row; empty: `tool_change.flush_volume`.
        flush_volumes: Vec<f64> = Vec::new(); 0.0..=5000.0, "mm³",
        /// Flush into sparse infill, of whichever tool, which is then printed right after the change; the tower gets what is left.
        flush_into_infill: bool = false,
        /// Flush into support, as well, unless that has a tool of its own; then that tool alone is.
        flush_into_support: bool = false,
        /// Print a wall around all objects, as high as tools are changed, at which each tool passes before it prints a part.
        ooze_shield: bool = false,
        /// Distance of that wall from what is printed.
        ooze_shield_distance: Mm = Mm(2.0); 0.5..=50.0,
        /// How much higher a tool may print than what others are still to print beside it, so that it prints several layers before another is taken: where the objects of different tools are 2 mm apart, and nothing but the prime tower is flushed into; 0: all tools print layer by layer, as by heads, of which another nozzle would be in the way.
        ahead: Mm = Mm(0.4); 0.0..=0.5,
        /// Which tool prints when.
        order: ToolOrder = ToolOrder::Optimal,
        /// Time that a cubic millimetre of waste is worth, where tools are put into an order.
        waste_weight: f64 = 0.1; 0.0..=1000.0, "s/mm³",
    }
}

impl GcodeSettings {
    /// Whether objects are labelled in one way or the other.
    pub fn labels_objects(&self) -> bool {
        self.labels || self.label_comments
    }
}

impl From<Flavor> for Firmware {
    fn from(flavor: Flavor) -> Self {
        match flavor {
            Flavor::Marlin => Self::Marlin,
            Flavor::MarlinLegacy => Self::MarlinClassic,
            Flavor::Klipper => Self::Klipper,
            Flavor::RepRapFirmware => Self::RepRapFirmware,
        }
    }
}
