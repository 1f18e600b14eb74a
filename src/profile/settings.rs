//! Every setting: the sections of all stages, joined. Keys are `section.field`, spelled as the fields are.
//!
//! `Default` gives the embedded default profile: a generic RepRap 250 × 250 × 250, PLA, 0.2 mm.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::embedded::default_script;
use super::tools::Tool;
use crate::estimate::MachineSettings;
use crate::gcode::{GcodeSettings, PrinterSettings, ToolChangeSettings, ToolSettings};
use crate::motion::{
    AccelerationSettings, CoolingSettings, FilamentSettings, RetractSettings, RoleFlowSettings,
    SpeedSettings, SwapSettings, TemperatureSettings, TravelSettings,
};
use crate::options::{Field, Reader, Section};
use crate::order::{OrderSettings, SeamSettings};
use crate::plate::{BedSettings, PlateSettings, PrintSettings};
use crate::slice::LayerSettings;
use crate::toolpath::{
    BridgeSettings, BrimSettings, FirstLayerSettings, FuzzySettings, InfillSettings, IroningSettings,
    PrimeTowerSettings, RaftSettings, ShellSettings, SkirtSettings, SpiralSettings, SupportSettings,
    ToolOfSettings, WallSettings,
};

macro_rules! settings {
    ($($section:ident: $ty:ident,)*) => {
        /// Every setting in force.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(try_from = "Table")]
        #[allow(missing_docs)]
        pub struct Settings {
            $(pub $section: $ty,)*
            /// Names that scripts may use, with their values: those of another slicer's preset, or a profile's own.
            pub variables: BTreeMap<String, Value>,
            /// What each tool has of its own; empty: the printer has one.
            #[serde(skip_serializing_if = "Vec::is_empty")]
            pub tools: Vec<Tool>,
        }

        impl TryFrom<Table> for Settings {
            type Error = toml::de::Error;

            fn try_from(table: Table) -> Result<Self, Self::Error> {
                let (mut reader, mut read) = (Reader::new(table), Self::of_stages());
                $(reader.section(stringify!($section), &mut read.$section);)*
                reader.take("variables", &mut read.variables);
                reader.take("tools", &mut read.tools);
                reader.end(read)
            }
        }

        impl Settings {
            /// The defaults of all stages.
            pub(super) fn of_stages() -> Self {
                Self { $($section: $ty::default(),)* variables: BTreeMap::new(), tools: Vec::new() }
            }
        }

        /// Every section with its keys, in the order of the documentation.
        pub static SECTIONS: &[Section] = &[$(Section {
            name: stringify!($section),
            doc: $ty::DOC,
            fields: $ty::FIELDS,
        },)*];
    };
}

settings! {
    printer: PrinterSettings,
    bed: BedSettings,
    plate: PlateSettings,
    print: PrintSettings,
    machine: MachineSettings,
    filament: FilamentSettings,
    temperature: TemperatureSettings,
    layer: LayerSettings,
    walls: WallSettings,
    shell: ShellSettings,
    infill: InfillSettings,
    ironing: IroningSettings,
    spiral: SpiralSettings,
    fuzzy: FuzzySettings,
    first_layer: FirstLayerSettings,
    skirt: SkirtSettings,
    brim: BrimSettings,
    raft: RaftSettings,
    support: SupportSettings,
    bridge: BridgeSettings,
    seam: SeamSettings,
    order: OrderSettings,
    speed: SpeedSettings,
    acceleration: AccelerationSettings,
    flow: RoleFlowSettings,
    retract: RetractSettings,
    travel: TravelSettings,
    cooling: CoolingSettings,
    gcode: GcodeSettings,
    tool: ToolSettings,
    tool_of: ToolOfSettings,
    tool_change: ToolChangeSettings,
    swap: SwapSettings,
    prime_tower: PrimeTowerSettings,
}

impl Default for Settings {
    /// The defaults of all stages, with the scripts of the generic printer.
    fn default() -> Self {
        let mut settings = Self::of_stages();
        settings.gcode.start = default_script("start");
        settings.gcode.end = default_script("end");
        settings
    }
}

/// Sections and keys about tools: where a printer has one, nothing is said of them.
const OF_TOOLS: [&str; 7] = [
    "tool.",
    "tool_of.",
    "tool_change.",
    "swap.",
    "prime_tower.",
    "retract.change_length",
    "retract.change_extra",
];

impl Settings {
    /// The sections with the keys that matter to the printer.
    pub(super) fn keys_that_matter(&self) -> impl Iterator<Item = (&'static Section, &'static Field)> {
        let several = !self.tools.is_empty();
        let keys =
            SECTIONS.iter().flat_map(|section| section.fields.iter().map(move |field| (section, field)));
        keys.filter(move |(section, field)| {
            let key = format!("{}.{}", section.name, field.name);
            several || !OF_TOOLS.iter().any(|of_tools| key.starts_with(of_tools))
        })
    }
}
