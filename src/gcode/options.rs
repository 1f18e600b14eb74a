//! The dialect and what is written in it.

use crate::estimate::Firmware;
use crate::options::{choice, section};
use crate::units::Mm;

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
