//! Every setting, one small struct per stage. Keys are `section.field`, spelled as the fields are.
//!
//! `Default` gives the embedded default profile: a generic RepRap 250 × 250 × 250, PLA, 0.2 mm.

use serde::{Deserialize, Serialize};

use super::schema::{Field, FieldType, Kind, Section, first_range, first_unit};
use crate::units::{Celsius, Mm, Mm3PerS, MmPerS, MmPerS2, Ratio, Seconds};

macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $text:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum $name { $($(#[$vdoc])* #[serde(rename = $text)] $variant,)* }

        impl $name {
            /// Every value with its spelling in profiles and on the command line.
            pub const ALL: &'static [(&'static str, $name)] = &[$(($text, $name::$variant),)*];

            /// The spellings alone.
            pub const NAMES: &'static [&'static str] = &[$($text,)*];

            /// The spelling in profiles and on the command line.
            pub fn name(self) -> &'static str {
                Self::NAMES[self as usize]
            }
        }

        impl FieldType for $name {
            const KIND: Kind = Kind::Choice($name::NAMES);
        }
    };
}

choice! {
    /// Firmware dialect.
    Flavor { /// Marlin 2.
        Marlin = "marlin", /// Klipper.
        Klipper = "klipper", /// RepRapFirmware 3.
        RepRapFirmware = "reprapfirmware", }
}
choice! {
    /// Outline of the bed.
    BedShape { /// `size` is width and depth.
        Rectangular = "rectangular", /// `size[0]` is the diameter.
        Round = "round", }
}
choice! {
    /// Where X 0, Y 0 lies on the bed.
    BedOrigin { /// Front left corner.
        Corner = "corner", /// The middle, as on deltas.
        Center = "center", }
}
choice! {
    /// Which wall of an island is printed first.
    WallOrder { /// From the inside out: better overhangs.
        InnerFirst = "inner-first", /// From the outside in: better dimensions.
        OuterFirst = "outer-first", }
}
choice! {
    /// How wide walls are.
    WallGenerator { /// As wide as asked for; single beads of fitting width in what is left.
        Classic = "classic", /// Those in the middle of a thin part as wide as fits.
        Variable = "variable", }
}
choice! {
    /// Infill pattern.
    Pattern { /// Parallel lines, turned by 90° from layer to layer.
        Rectilinear = "rectilinear", /// Parallel lines in the same direction on all layers.
        AlignedRectilinear = "aligned-rectilinear", /// Two crossing sets of lines in each layer.
        Grid = "grid", /// Three crossing sets of lines in each layer.
        Triangles = "triangles", /// Three sets of lines, hexagons between triangles.
        TriHexagon = "tri-hexagon", /// Cubes standing on a corner.
        Cubic = "cubic", /// The same, larger inside than near the surface.
        AdaptiveCubic = "adaptive-cubic", /// Triply periodic minimal surface.
        Gyroid = "gyroid", /// Hexagons with upright walls.
        Honeycomb = "honeycomb", /// Truncated octahedra.
        Honeycomb3d = "3d-honeycomb", /// Loops parallel to the outline.
        Concentric = "concentric", /// One curve through every cell of a square grid.
        Hilbert = "hilbert", /// Branches under roofs, nothing elsewhere.
        Lightning = "lightning", }
}
choice! {
    /// Which walls get a rough surface.
    FuzzyWalls { /// None.
        None = "none", /// The outermost.
        Outer = "outer", /// All.
        All = "all", }
}
choice! {
    /// How supports are built.
    SupportStyle { /// Straight columns.
        Grid = "grid", /// Branches that meet and avoid the part.
        Tree = "tree", }
}
choice! {
    /// Lines inside of support columns.
    SupportPattern { /// In one direction.
        Rectilinear = "rectilinear", /// In two directions, twice as far apart.
        Grid = "grid", }
}
choice! {
    /// Where a brim lies.
    BrimSides { /// Around the part.
        Outer = "outer", /// In its holes.
        Inner = "inner", /// Around it and in its holes.
        Both = "both", }
}
choice! {
    /// Where loops start and end.
    SeamPosition { /// Anywhere: ordering decides.
        Free = "free", /// The first vertex as sliced.
        Pinned = "pinned", /// In line with the layer below, in a corner where there is one.
        Aligned = "aligned", /// The rearmost vertex.
        Rear = "rear", /// The vertex nearest to where the nozzle is.
        Nearest = "nearest", /// Another vertex on each layer.
        Random = "random", }
}
choice! {
    /// How the order of paths in a layer is found.
    OrderStrategy { /// As the toolpath stage made them.
        AsSliced = "as-sliced", /// Nearest reachable end next.
        Nearest = "nearest", /// Multi-fragment: shortest link first.
        Greedy = "greedy", /// The 2016 algorithm.
        Christofides = "christofides", /// Christofides with no return leg.
        ChristofidesOpen = "christofides-open", /// Local search, then iterated local search.
        Optimized = "optimized", }
}
choice! {
    /// How far ordering may mix paths.
    Scope { /// Anywhere in the layer.
        Layer = "layer", /// A run (one role in one island) is never interrupted; roles of an island in order.
        Feature = "feature", /// As `feature`, and all runs of an island are consecutive.
        Island = "island", }
}
choice! {
    /// What ordering minimises.
    CostKind { /// Straight-line length of the links.
        Length = "length", /// Time of the travels, with retraction.
        Time = "time", }
}
choice! {
    /// What is printed after what.
    Sequence { /// All objects layer by layer.
        Layer = "layer", /// One object after the other.
        Object = "object", }
}
choice! {
    /// How long ordering may search.
    Effort { /// At most about 1 ms per 100 paths.
        Fast = "fast", /// The default.
        Normal = "normal", /// For the last percent.
        High = "high", }
}

/// A section of the settings: the struct, its defaults, and what is known about each key.
/// After the default come the allowed range and, where the type does not tell it, the unit.
macro_rules! section {
    ($(#[doc = $doc:literal])* $name:ident { $(
        $(#[doc = $fdoc:literal])* $field:ident: $ty:ty = $default:expr
            $(; $low:literal..=$high:literal $(, $unit:literal)?)?,
    )* }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($(#[doc = $fdoc])* pub $field: $ty,)* }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        impl $name {
            const DOC: &'static str = concat!($($doc),*);
            const FIELDS: &'static [Field] = &[$(Field {
                name: stringify!($field),
                doc: concat!($($fdoc),*),
                kind: <$ty as FieldType>::KIND,
                unit: first_unit(&[$($($unit,)?)?], <$ty as FieldType>::UNIT),
                range: first_range(&[$(($low as f64, $high as f64))?]),
            },)*];
        }
    };
}

section! {
    /// `[printer]`: the machine's dialect.
    PrinterSettings {
        /// Shown in headers.
        name: String = "RepRap 250".into(),
        /// Firmware dialect.
        flavor: Flavor = Flavor::Marlin,
        /// Nozzle bore.
        nozzle_diameter: Mm = Mm(0.4); 0.1..=2.0,
    }
}
section! {
    /// `[bed]`: the printable volume.
    BedSettings {
        /// Rectangular or round.
        shape: BedShape = BedShape::Rectangular,
        /// Width and depth; of a round bed the diameter, twice.
        size: [Mm; 2] = [Mm(250.0), Mm(250.0)]; 10.0..=5000.0,
        /// Printable height.
        height: Mm = Mm(250.0); 1.0..=5000.0,
        /// Corner or centre.
        origin: BedOrigin = BedOrigin::Corner,
    }
}
section! {
    /// `[plate]`: how several models share the bed.
    PlateSettings {
        /// Least distance between models, beyond what brim, raft and supports take.
        spacing: Mm = Mm(5.0); 0.0..=200.0,
        /// Arrange models; without, they stay where their files put them.
        arrange: bool = true,
        /// What a file places relative to each other stays so, where it fits the bed; without, only what interlocks does.
        keep_layout: bool = true,
        /// Models may be turned by quarters to fit.
        turn: bool = false,
        /// Turn every model onto the side on which it stands firmly and needs the least support.
        orient: bool = false,
    }
}
section! {
    /// `[print]`: what is printed after what.
    PrintSettings {
        /// Layer by layer, or object by object, the lowest first.
        sequence: Sequence = Sequence::Layer,
        /// How far the print head reaches from the nozzle: objects printed one after the other are so far apart.
        clearance_radius: Mm = Mm(45.0); 1.0..=200.0,
        /// How far above the nozzle the gantry hangs: no object but the last may be higher.
        clearance_height: Mm = Mm(20.0); 1.0..=1000.0,
    }
}
section! {
    /// `[machine]`: limits that the time estimate and the ordering's time cost use.
    MachineSettings {
        /// Top speed of X, Y, Z and E.
        max_speed: [MmPerS; 4] = [MmPerS(300.0), MmPerS(300.0), MmPerS(15.0), MmPerS(80.0)]; 0.1..=5000.0,
        /// Largest acceleration of X, Y, Z and E.
        max_acceleration: [MmPerS2; 4] = [MmPerS2(3000.0), MmPerS2(3000.0), MmPerS2(100.0), MmPerS2(800.0)]; 1.0..=100000.0,
        /// Speed at which a 90° corner is taken (Klipper).
        square_corner_velocity: MmPerS = MmPerS(5.0); 0.0..=100.0,
        /// Step that the extruder's speed may make at a corner (Klipper's `instantaneous_corner_velocity`).
        extruder_corner_velocity: MmPerS = MmPerS(1.0); 0.0..=100.0,
        /// Least share of a move to cruise (Klipper).
        min_cruise_ratio: Ratio = Ratio(0.5); 0.0..=0.99,
        /// Junction deviation (Marlin); 0: the one that takes a 90° corner at `square_corner_velocity`.
        junction_deviation: Mm = Mm(0.0); 0.0..=1.0,
        /// Step that the speed of X, Y, Z and E may make (RepRapFirmware, classic jerk).
        jerk: [MmPerS; 4] = [MmPerS(10.0), MmPerS(10.0), MmPerS(0.4), MmPerS(5.0)]; 0.01..=1000.0,
    }
}
section! {
    /// `[filament]`: the material.
    FilamentSettings {
        /// Kind, as printed in headers: PLA, PETG, …
        material: String = "PLA".into(),
        /// Diameter of the strand.
        diameter: Mm = Mm(1.75); 0.5..=5.0,
        /// g/cm³.
        density: f64 = 1.24; 0.1..=25.0, "g/cm³",
        /// Price of a kilogram, in whatever currency.
        cost: f64 = 20.0; 0.0..=100000.0, "per kg",
        /// Extrusion multiplier.
        flow: f64 = 1.0; 0.1..=3.0,
        /// Linear or pressure advance; 0 leaves the firmware's value alone.
        pressure_advance: f64 = 0.0; 0.0..=10.0, "s",
        /// Largest flow the hot end melts; 0: not limited.
        max_flow: Mm3PerS = Mm3PerS(0.0); 0.0..=1000.0,
    }
}
section! {
    /// `[temperature]`: 0 leaves a heater alone.
    TemperatureSettings {
        /// Nozzle from the second layer on.
        nozzle: Celsius = Celsius(205.0); 0.0..=500.0,
        /// Nozzle on the first layer.
        nozzle_first_layer: Celsius = Celsius(210.0); 0.0..=500.0,
        /// Bed from the second layer on.
        bed: Celsius = Celsius(60.0); 0.0..=200.0,
        /// Bed on the first layer.
        bed_first_layer: Celsius = Celsius(60.0); 0.0..=200.0,
    }
}
section! {
    /// `[layer]`: heights and where the sections lie.
    LayerSettings {
        /// Height of the layers from the second on.
        height: Mm = Mm(0.2); 0.01..=2.0,
        /// Height of the first layer.
        first_height: Mm = Mm(0.2); 0.01..=2.0,
        /// Heights follow the surface, thinner where it is nearly level; `height` then holds for rafts alone.
        adaptive: bool = false,
        /// How fine adaptive heights are: at 0 all are `max_height`, at 1 nearly level surfaces get `min_height`.
        quality: Ratio = Ratio(0.5); 0.0..=1.0,
        /// Least height of an adaptive layer.
        min_height: Mm = Mm(0.08); 0.01..=2.0,
        /// Greatest height of an adaptive layer.
        max_height: Mm = Mm(0.28); 0.01..=2.0,
        /// Heights by height over the bed, such as `0:0.2, 10:0.1` for layers of 0.1 mm from 10 mm on; empty: `height` throughout.
        heights: String = String::new(),
        /// Added to every Z in the G-code.
        z_offset: Mm = Mm(0.0); -5.0..=5.0,
        /// Sections grow (+) or shrink (−) by this on every side.
        xy_compensation: Mm = Mm(0.0); -2.0..=2.0,
        /// The first layer shrinks by this on every side (elephant foot).
        elephant_foot: Mm = Mm(0.0); 0.0..=2.0,
        /// Gaps between bodies that are narrower than twice this are closed, so that they become one.
        closing_radius: Mm = Mm(0.02); 0.0..=0.5,
        /// Vertices that move the outline less than this are dropped.
        resolution: Mm = Mm(0.0125); 0.0..=0.5,
    }
}
section! {
    /// `[walls]`: perimeters.
    WallSettings {
        /// Number of walls.
        count: u32 = 3; 0..=100,
        /// Width of inner walls.
        width: Mm = Mm(0.45); 0.05..=5.0,
        /// Width of the outermost wall.
        external_width: Mm = Mm(0.45); 0.05..=5.0,
        /// Fixed or variable width.
        generator: WallGenerator = WallGenerator::Variable,
        /// Inner or outer first.
        order: WallOrder = WallOrder::InnerFirst,
        /// Parts of a section thinner than this are left out.
        min_feature: Mm = Mm(0.16); 0.05..=1.0,
        /// Thin parts are printed at least this wide.
        min_width: Mm = Mm(0.2); 0.05..=1.0,
        /// Fill what is left between walls, and walls too thin for a loop, with single beads of fitting width.
        gap_fill: bool = true,
    }
}
section! {
    /// `[shell]`: solid top and bottom.
    ShellSettings {
        /// Solid layers under every top surface.
        top_layers: u32 = 5; 0..=10000,
        /// Solid layers above every bottom surface.
        bottom_layers: u32 = 4; 0..=10000,
        /// Top and bottom are at least this thick, with more layers than the above where those are thin.
        min_thickness: Mm = Mm(0.7); 0.0..=100.0,
        /// Top surfaces in lines each beside the one before, never between two others. Holds while a run is not
        /// interrupted: under any `order.scope` but `layer`.
        monotonic: bool = true,
        /// Line width of solid infill.
        width: Mm = Mm(0.45); 0.05..=5.0,
        /// Line width of top surfaces.
        top_width: Mm = Mm(0.42); 0.05..=5.0,
    }
}
section! {
    /// `[infill]`: the inside.
    InfillSettings {
        /// Pattern of sparse infill.
        pattern: Pattern = Pattern::Rectilinear,
        /// Share of the inside that is filled.
        density: Ratio = Ratio(0.15); 0.0..=1.0,
        /// Line width of sparse infill.
        width: Mm = Mm(0.45); 0.05..=5.0,
        /// Direction of the first layer's lines, degrees from the X axis.
        angle: f64 = 45.0; -360.0..=360.0, "°",
        /// Directions of the layers' lines in turn, instead of `infill.angle` and the pattern's own turning; empty: none.
        angles: Vec<f64> = Vec::new(); -360.0..=360.0, "°",
        /// How far line ends reach into the innermost wall, as a share of the line width.
        overlap: Ratio = Ratio(0.2); 0.0..=1.0,
        /// Join line ends along the wall.
        connect: bool = true,
        /// How far line ends that are not joined run on along the wall, at most.
        anchor: Mm = Mm(0.0); 0.0..=100.0,
        /// Sparse infill only on every so many layers, in beads as high as all of them; no higher than the nozzle's bore.
        combine_layers: u32 = 1; 1..=50,
        /// One layer in so many is solid; 0: none.
        solid_every: u32 = 0; 0..=10000,
    }
}
section! {
    /// `[ironing]`: a second, thin pass over top surfaces.
    IroningSettings {
        /// Whether there is one.
        enabled: bool = false,
        /// What it deposits, as a share of a full layer.
        flow: Ratio = Ratio(0.1); 0.0..=1.0,
        /// Distance of its lines.
        spacing: Mm = Mm(0.1); 0.02..=1.0,
    }
}
section! {
    /// `[spiral]`: one wall in one line that rises all the way, on a solid bottom (vase mode).
    SpiralSettings {
        /// Print so.
        enabled: bool = false,
        /// Each turn glides from the outline below it to its own, so that no step shows where turns begin.
        smooth: bool = true,
    }
}
section! {
    /// `[fuzzy]`: a rough surface.
    FuzzySettings {
        /// Which walls have it.
        walls: FuzzyWalls = FuzzyWalls::None,
        /// How far they leave their line to either side.
        thickness: Mm = Mm(0.3); 0.01..=2.0,
        /// Distance of the points that are moved.
        distance: Mm = Mm(0.8); 0.05..=10.0,
    }
}
section! {
    /// `[first_layer]`: what holds for the layer on the bed.
    FirstLayerSettings {
        /// Line width of everything on it; 0: as elsewhere.
        width: Mm = Mm(0.5); 0.0..=5.0,
        /// Speed of everything on it; 0: as elsewhere.
        speed: MmPerS = MmPerS(20.0); 0.0..=2000.0,
        /// Extrusion multiplier.
        flow: f64 = 1.0; 0.1..=3.0,
        /// Acceleration of everything on it; 0: as elsewhere.
        acceleration: MmPerS2 = MmPerS2(500.0); 0.0..=100000.0,
    }
}
section! {
    /// `[skirt]`
    SkirtSettings {
        /// Loops around everything; 0: none.
        loops: u32 = 1; 0..=100,
        /// Distance from part or brim.
        distance: Mm = Mm(3.0); 0.0..=100.0,
        /// Layers it is printed on.
        layers: u32 = 1; 1..=10000,
        /// Go on up to the top of the part with one loop, to shield it from draughts.
        draft_shield: bool = false,
        /// More loops until this much filament (path length) is primed.
        min_length: Mm = Mm(0.0); 0.0..=10000.0,
    }
}
section! {
    /// `[brim]`
    BrimSettings {
        /// Width around the part; 0: none.
        width: Mm = Mm(0.0); 0.0..=100.0,
        /// Distance from the part.
        gap: Mm = Mm(0.0); 0.0..=10.0,
        /// On which sides of the part's outlines.
        sides: BrimSides = BrimSides::Outer,
        /// Only around parts of the footprint smaller than this; 0: around all.
        max_area: f64 = 0.0; 0.0..=1000000.0, "mm²",
    }
}
section! {
    /// `[raft]`: layers of support under the whole print.
    RaftSettings {
        /// Number of layers; 0: none.
        layers: u32 = 0; 0..=100,
        /// Free height between raft and part.
        gap: Mm = Mm(0.2); 0.0..=5.0,
        /// Width beyond the part.
        margin: Mm = Mm(3.0); 0.0..=100.0,
        /// Share of the lower layers that is filled; the upper two are solid.
        density: Ratio = Ratio(0.5); 0.05..=1.0,
    }
}
section! {
    /// `[support]`
    SupportSettings {
        /// Hold up overhangs.
        enabled: bool = false,
        /// Columns or trees.
        style: SupportStyle = SupportStyle::Grid,
        /// Walls that lean out further than this from the vertical are held.
        angle: f64 = 50.0; 0.0..=89.0, "°",
        /// Support stands on the bed only, never on the part.
        from_bed_only: bool = false,
        /// Overhangs that reach out less than this are printed without support.
        min_reach: Mm = Mm(0.8); 0.0..=10.0,
        /// Bridges up to this long are printed without support; 0: none.
        max_bridge: Mm = Mm(10.0); 0.0..=1000.0,
        /// Free height between support and part, in whole layers, rounded up.
        z_gap: Mm = Mm(0.2); 0.0..=5.0,
        /// Free distance between support and the part's sides.
        xy_gap: Mm = Mm(0.4); 0.0..=5.0,
        /// Lines inside of columns.
        pattern: SupportPattern = SupportPattern::Rectilinear,
        /// Share of a column that the lines inside its outline fill.
        density: Ratio = Ratio(0.1); 0.0..=1.0,
        /// Direction of the lines, degrees from the X axis.
        line_angle: f64 = 0.0; -360.0..=360.0, "°",
        /// Line width of support.
        width: Mm = Mm(0.4); 0.05..=5.0,
        /// Dense layers under the part.
        interface_layers: u32 = 2; 0..=100,
        /// Share of them that is filled.
        interface_density: Ratio = Ratio(0.75); 0.0..=1.0,
        /// Trees: how far branches may lean, degrees from the vertical.
        branch_angle: f64 = 40.0; 5.0..=60.0, "°",
        /// Trees: diameter of a branch at its tip.
        branch_diameter: Mm = Mm(2.0); 0.5..=20.0,
        /// Trees: by how much the sides of a branch widen downwards, degrees from the vertical.
        branch_taper: f64 = 2.0; 0.0..=30.0, "°",
    }
}
section! {
    /// `[bridge]`: solid infill over air; its speed is `speed.bridge`, its fan `cooling.bridge_fan`.
    BridgeSettings {
        /// Span air with threads side by side in the direction in which they reach hold soonest.
        enabled: bool = true,
        /// Thickness of the threads: multiplies the cross-section of one as thick as the nozzle's bore.
        flow: f64 = 1.0; 0.1..=2.0,
        /// How far they reach over what holds them.
        anchor: Mm = Mm(1.0); 0.0..=20.0,
    }
}
section! {
    /// `[seam]`
    SeamSettings {
        /// The rule.
        position: SeamPosition = SeamPosition::Free,
        /// Loops end this much before they would close, so that the ends leave no blob.
        gap: Mm = Mm(0.05); 0.0..=2.0,
        /// Way on which the outermost wall rises from nothing at its start, and fades out on top of that; 0: none.
        scarf: Mm = Mm(0.0); 0.0..=100.0,
    }
}
section! {
    /// `[order]`
    OrderSettings {
        /// How the order is found.
        strategy: OrderStrategy = OrderStrategy::Optimized,
        /// How far paths may mix.
        scope: Scope = Scope::Feature,
        /// What is minimised.
        cost: CostKind = CostKind::Length,
        /// How long is searched.
        effort: Effort = Effort::Normal,
        /// Each layer starts where the last one ended.
        chain: bool = true,
        /// Least distance from the end of one layer to the start of the next; 0: none.
        layer_distance: Mm = Mm(0.0); 0.0..=1000.0,
    }
}
section! {
    /// `[speed]`
    SpeedSettings {
        /// Outermost wall.
        external_perimeter: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Inner walls.
        perimeter: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Sparse infill.
        infill: MmPerS = MmPerS(80.0); 0.1..=2000.0,
        /// Solid infill.
        solid: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Top surfaces.
        top: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Ironing.
        ironing: MmPerS = MmPerS(15.0); 0.1..=2000.0,
        /// Bridges.
        bridge: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Walls that hang over by more than a quarter, a half and three quarters of their width.
        overhang: [MmPerS; 3] = [MmPerS(35.0), MmPerS(25.0), MmPerS(15.0)]; 0.1..=2000.0,
        /// Gap fill.
        gap_fill: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Support.
        support: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Skirt and brim.
        skirt: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Travel in X and Y.
        travel: MmPerS = MmPerS(150.0); 0.1..=2000.0,
        /// Travel in Z.
        z: MmPerS = MmPerS(10.0); 0.1..=500.0,
    }
}
section! {
    /// `[acceleration]`: 0 leaves the firmware's value alone.
    AccelerationSettings {
        /// Everything without a value of its own.
        default: MmPerS2 = MmPerS2(1500.0); 0.0..=100000.0,
        /// Outermost wall.
        external_perimeter: MmPerS2 = MmPerS2(1000.0); 0.0..=100000.0,
        /// Travel.
        travel: MmPerS2 = MmPerS2(2000.0); 0.0..=100000.0,
    }
}
section! {
    /// `[retract]`
    RetractSettings {
        /// Filament pulled back; 0: none.
        length: Mm = Mm(1.0); 0.0..=20.0,
        /// Speed of pulling back.
        speed: MmPerS = MmPerS(40.0); 0.1..=500.0,
        /// Speed of pushing forward again.
        unretract_speed: MmPerS = MmPerS(40.0); 0.1..=500.0,
        /// Fed beyond what was pulled back, with the first millimetres of the next bead.
        extra: Mm = Mm(0.0); -5.0..=5.0,
        /// Travels shorter than this are not retracted.
        min_travel: Mm = Mm(1.5); 0.0..=1000.0,
        /// Nozzle lift while retracted.
        z_hop: Mm = Mm(0.0); 0.0..=10.0,
        /// Lift on travels inside the part, too, and not only on those that cross an outer wall.
        z_hop_inside: bool = false,
        /// Way back over the last path while pulling back; 0: none.
        wipe: Mm = Mm(0.0); 0.0..=50.0,
        /// Way at the end of a bead on which nothing is fed any more before a retraction; 0: none.
        coast: Mm = Mm(0.0); 0.0..=10.0,
        /// Leave lengths and speeds to the firmware (G10, G11).
        firmware: bool = false,
    }
}
section! {
    /// `[travel]`
    TravelSettings {
        /// Go round holes and outer walls, inside the part, instead of over them.
        avoid_crossing: bool = true,
        /// By how much that may lengthen a travel; longer detours are not made.
        max_detour: Mm = Mm(20.0); 0.0..=10000.0,
        /// Travels that stay inside the part are not retracted up to this length.
        retract_inside: Mm = Mm(5.0); 0.0..=10000.0,
    }
}
section! {
    /// `[cooling]`
    CoolingSettings {
        /// Layers shorter than this are slowed down; 0: never.
        min_layer_time: Seconds = Seconds(8.0); 0.0..=3600.0,
        /// But not below this speed.
        min_speed: MmPerS = MmPerS(10.0); 0.1..=500.0,
        /// Fan on ordinary layers.
        fan: Ratio = Ratio(1.0); 0.0..=1.0,
        /// Layers at the start without fan.
        fan_off_layers: u32 = 1; 0..=10000,
        /// Layer from which the fan has its full value; it ramps up to there.
        full_fan_layer: u32 = 3; 0..=10000,
        /// Least fan on bridges.
        bridge_fan: Ratio = Ratio(1.0); 0.0..=1.0,
        /// Least fan on walls that hang over by more than half their width.
        overhang_fan: Ratio = Ratio(1.0); 0.0..=1.0,
    }
}
section! {
    /// `[gcode]`
    GcodeSettings {
        /// E counts from the last move (M83) instead of from the layer's start (M82).
        relative_e: bool = true,
        /// Write arcs (G2, G3) where the path follows one.
        arcs: bool = false,
        /// How far an arc may leave the path.
        arc_tolerance: Mm = Mm(0.02); 0.001..=0.5,
        /// Pictures of the print in the header, for printers with a screen: width × height in pixels, such as 32x32,300x300; empty: none.
        thumbnails: String = "32x32,300x300".into(),
        /// Say which object every bead belongs to (`EXCLUDE_OBJECT`, M486), so that one can be cancelled.
        labels: bool = false,
        /// State `[machine]` at the start (M201, M203, M205, M566, `SET_VELOCITY_LIMIT`) instead of relying on the firmware's own.
        limits: bool = false,
        /// Script before the print.
        start: String = super::embedded::default_script("start"),
        /// Script after the print.
        end: String = super::embedded::default_script("end"),
        /// Script at a pause; empty: the flavour's own.
        pause: String = String::new(),
    }
}

macro_rules! settings {
    ($($section:ident: $ty:ident,)*) => {
        /// Every setting in force.
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        #[allow(missing_docs)]
        pub struct Settings { $(pub $section: $ty,)* }

        /// Every section with its keys, in the order of the documentation.
        pub const SECTIONS: &[Section] = &[$(Section {
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
    retract: RetractSettings,
    travel: TravelSettings,
    cooling: CoolingSettings,
    gcode: GcodeSettings,
}
