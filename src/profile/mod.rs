//! Profiles: TOML as written (with `inherits`), or configurations of other slicers, resolved and validated once into
//! [`Settings`].
//!
//! Sources take effect in this order: the embedded `default`, each `--profile` in turn (what it inherits
//! first), each `--set` in turn. The later one wins, key by key; where each value came from is kept.

mod chosen;
mod conflicts;
mod dump;
mod embedded;
mod error;
mod flush;
mod import;
mod metadata;
mod of_tool;
mod resolve;
mod saved;
mod schema;
mod script;
mod settings;
mod source;
mod stages;
mod suggest;
mod tools;
mod value;
mod widths;

pub use chosen::preset_notes;
pub use dump::{dump_json, dump_toml, reference};
pub use embedded::{EMBEDDED, EmbeddedProfile, ProfileKind, find as embedded};
pub use error::{Origin, Problem, ProfileError};
pub use import::{Import, KeyFigures, Left, Taken, import_figures, import_page};
pub use metadata::binary_metadata;
pub(crate) use resolve::{Assignments, Layer, resolve_layers};
pub use resolve::{Override, Resolved, resolve, resolve_presets};
pub(crate) use saved::Refused;
pub use schema::{field, keys};
pub use script::{Moment, PLACEHOLDERS, PRINT_NAMES, ScriptRun, WholePrint, expand};
pub use settings::{SECTIONS, Settings};
pub use source::{converted, text};
pub use tools::{MOST_TOOLS, Tool};

pub use crate::estimate::MachineSettings;
pub use crate::gcode::{
    Flavor, GcodeSettings, PrinterSettings, ToolChangeKind, ToolChangeSettings, ToolSettings, thumbnail_list,
};
pub use crate::motion::{
    AccelerationSettings, CoolingSettings, FilamentSettings, RetractSettings, RoleFlowSettings,
    SpeedSettings, TemperatureSettings, TravelSettings, filament_area_mm2,
};
pub use crate::options::{Field, Kind, Section};
pub use crate::order::{
    CostKind, Effort, OrderSettings, OrderStrategy, Scope, SeamPosition, SeamSettings, ToolOrder,
};
pub use crate::plate::{BedOrigin, BedSettings, BedShape, PlateSettings, PrintSettings, Sequence};
pub use crate::slice::{LayerSettings, heights_from_lines, layer_heights};
pub use crate::toolpath::{
    BridgeSettings, BrimSettings, BrimSides, FirstLayerSettings, FuzzySettings, FuzzyWalls, InfillSettings,
    IroningSettings, Pattern, PrimeTowerSettings, RaftSettings, ShellSettings, SingleOnTop, SkirtSettings,
    SpiralSettings, SupportPattern, SupportSettings, SupportStyle, ToolOfSettings, WallGenerator, WallOrder,
    WallSettings,
};
