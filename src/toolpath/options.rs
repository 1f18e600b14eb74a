//! Walls, shells, infill, support and what lies around the part.

use crate::options::{choice, section};
use crate::units::{Mm, MmPerS, MmPerS2, Ratio};

choice! {
    /// Which wall of an island is printed first.
    WallOrder {
        /// From the inside out: better overhangs.
        InnerFirst = "inner-first",
        /// From the outside in: better dimensions.
        OuterFirst = "outer-first",
    }
}
choice! {
    /// How wide walls are.
    WallGenerator {
        /// Walls of the given width, with single beads of fitting width in the remainder.
        Classic = "classic",
        /// Those in the middle of a thin part as wide as fits.
        Variable = "variable",
    }
}
choice! {
    /// Where a surface that nothing covers has the outermost wall alone.
    SingleOnTop {
        /// Nowhere.
        None = "none",
        /// On every top surface.
        Top = "top",
        /// On the last layer of an object.
        Topmost = "topmost",
    }
}
choice! {
    /// Infill pattern.
    Pattern {
        /// Parallel lines, turned by 90° from layer to layer.
        Rectilinear = "rectilinear",
        /// Parallel lines in the same direction on all layers.
        AlignedRectilinear = "aligned-rectilinear",
        /// Two crossing sets of lines in each layer.
        Grid = "grid",
        /// Three crossing sets of lines in each layer.
        Triangles = "triangles",
        /// Three sets of lines, hexagons between triangles.
        TriHexagon = "tri-hexagon",
        /// Cubes standing on a corner.
        Cubic = "cubic",
        /// The same, larger inside than near the surface.
        AdaptiveCubic = "adaptive-cubic",
        /// Triply periodic minimal surface.
        Gyroid = "gyroid",
        /// Hexagons with upright walls.
        Honeycomb = "honeycomb",
        /// Truncated octahedra.
        Honeycomb3d = "3d-honeycomb",
        /// Loops parallel to the outline.
        Concentric = "concentric",
        /// One curve through every cell of a square grid.
        Hilbert = "hilbert",
        /// Branches under roofs, nothing elsewhere.
        Lightning = "lightning",
    }
}
choice! {
    /// Which walls get a rough surface.
    FuzzyWalls {
        /// None.
        None = "none",
        /// The outermost.
        Outer = "outer",
        /// All.
        All = "all",
    }
}
choice! {
    /// How supports are built.
    SupportStyle {
        /// Straight columns.
        Grid = "grid",
        /// Branches that meet and avoid the part.
        Tree = "tree",
    }
}
choice! {
    /// Pattern of support columns.
    SupportPattern {
        /// In one direction.
        Rectilinear = "rectilinear",
        /// In two directions, twice as far apart.
        Grid = "grid",
    }
}
choice! {
    /// Where a brim lies.
    BrimSides {
        /// Around the part.
        Outer = "outer",
        /// In its holes.
        Inner = "inner",
        /// Around it and in its holes.
        Both = "both",
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
        min_feature: Mm = Mm(0.08); 0.05..=1.0,
        /// Thin parts are printed at least this wide.
        min_width: Mm = Mm(0.2); 0.05..=1.0,
        /// Fill gaps between walls, and walls too thin for a loop, with single beads of fitting width.
        gap_fill: bool = true,
        /// Where top surfaces have the outermost wall alone, and their lines reach up to it.
        single_on_top: SingleOnTop = SingleOnTop::None,
        /// Narrower top surfaces keep all walls.
        min_top_width: Mm = Mm(1.35); 0.0..=100.0,
        /// The first layer has the outermost wall alone.
        single_on_first_layer: bool = false,
        /// Loops that hang over by more than half of their width run the other way round on every other layer, so that they
        /// do not curl up more and more in one direction.
        reverse_overhangs: bool = false,
        /// What hangs over air and cannot be bridged, as it is not held at both sides, is filled along its walls, by beads that
        /// begin and end where the part is held.
        extra_on_overhangs: bool = true,
        /// The second wall begins where the outermost one ends: round sides of beads do not overlap there, and do not push
        /// the outermost wall outwards.
        precise: bool = false,
    }
}
section! {
    /// `[shell]`: solid top and bottom.
    ShellSettings {
        /// Solid layers under every top surface.
        top_layers: u32 = 5; 0..=10000,
        /// Solid layers above every bottom surface.
        bottom_layers: u32 = 4; 0..=10000,
        /// Minimum thickness of top and bottom shells, which get more layers where these are thin.
        min_thickness: Mm = Mm(0.7); 0.0..=100.0,
        /// Print each line of a top surface next to the one before, never between two others. Applies while a run is not
        /// interrupted: under any `order.scope` but `layer`.
        monotonic: bool = true,
        /// Lines of inner solid layers run along narrow areas, where they turn least often, instead of at `infill.angle`.
        fit_angle: bool = true,
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
        /// Line directions that layers cycle through, instead of `infill.angle` and the pattern's own rotation; empty: none.
        angles: Vec<f64> = Vec::new(); -360.0..=360.0, "°",
        /// How far line ends reach into the innermost wall, as a share of the line width.
        overlap: Ratio = Ratio(0.2); 0.0..=1.0,
        /// Join line ends along the wall.
        connect: bool = true,
        /// Length of the anchor along the wall at line ends that are not joined, at most.
        anchor: Mm = Mm(0.0); 0.0..=100.0,
        /// Combine the sparse infill of up to this many layers, in beads of their total height; at most the nozzle diameter.
        combine_layers: u32 = 1; 1..=50,
        /// Patches of sparse infill up to this size are solid; 0: none.
        solid_area: f64 = 0.0; 0.0..=1000000.0, "mm²",
        /// Every n-th layer is solid; 0: none.
        solid_every: u32 = 0; 0..=10000,
    }
}
section! {
    /// `[ironing]`: a second, thin pass over top surfaces.
    IroningSettings {
        /// Iron top surfaces.
        enabled: bool = false,
        /// Flow, as a share of a full layer.
        flow: Ratio = Ratio(0.1); 0.0..=1.0,
        /// Line spacing.
        spacing: Mm = Mm(0.1); 0.02..=1.0,
    }
}
section! {
    /// `[spiral]`: vase mode, one continuously rising wall on a solid bottom.
    SpiralSettings {
        /// Print in vase mode.
        enabled: bool = false,
        /// Each revolution blends from the outline below it to its own, so that no step shows where revolutions
        /// begin.
        smooth: bool = true,
    }
}
section! {
    /// `[fuzzy]`: a rough surface.
    FuzzySettings {
        /// Walls with fuzzy skin.
        walls: FuzzyWalls = FuzzyWalls::None,
        /// Displacement to either side of the wall, at most.
        thickness: Mm = Mm(0.3); 0.01..=2.0,
        /// Distance between displaced points.
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
        /// Speed of solid infill on it; 0: as of everything.
        infill_speed: MmPerS = MmPerS(0.0); 0.0..=2000.0,
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
        /// Continue one loop to the top of the part as a draft shield.
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
        /// Vertical gap between raft and part.
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
        /// Make support.
        enabled: bool = false,
        /// Columns or trees.
        style: SupportStyle = SupportStyle::Grid,
        /// Overhang angle from the vertical beyond which support is made.
        angle: f64 = 50.0; 0.0..=89.0, "°",
        /// Support stands on the bed only, never on the part.
        from_bed_only: bool = false,
        /// Overhangs that reach out less than this are printed without support.
        min_reach: Mm = Mm(0.8); 0.0..=10.0,
        /// Bridges up to this long are printed without support; 0: none.
        max_bridge: Mm = Mm(10.0); 0.0..=1000.0,
        /// Vertical gap between support and part, in whole layers, rounded up.
        z_gap: Mm = Mm(0.2); 0.0..=5.0,
        /// Horizontal gap between support and part.
        xy_gap: Mm = Mm(0.4); 0.0..=5.0,
        /// Pattern of columns.
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
        /// Span air with bridge lines side by side in the direction with the shortest spans.
        enabled: bool = true,
        /// Bridge lines are round; without, they are as wide, as high and as far apart as solid infill.
        thick: bool = true,
        /// Bridge flow: multiplies the cross-section of a round bridge line as thick as the nozzle diameter, or of one that is as
        /// solid infill.
        flow: f64 = 1.0; 0.1..=2.0,
        /// How far bridge lines extend over their anchors.
        anchor: Mm = Mm(1.0); 0.0..=20.0,
    }
}
section! {
    /// `[tool_of]`: which of `[[tools]]` prints what, counted from 1; objects may have their own. See [tools](tools.md).
    ToolOfSettings {
        /// Everything that has no tool of its own.
        object: u32 = 1; 1..=16,
        /// Walls, and gaps between them; 0: the object's tool.
        walls: u32 = 0; 0..=16,
        /// Sparse infill; 0: the object's tool.
        infill: u32 = 0; 0..=16,
        /// Solid infill, bridges and ironing; 0: the object's tool.
        solid_infill: u32 = 0; 0..=16,
        /// Support and rafts; 0: whichever tool is in use.
        support: u32 = 0; 0..=16,
        /// Dense support under the part, and the top of rafts; 0: the tool of support.
        support_interface: u32 = 0; 0..=16,
        /// Heights between which another tool prints the object, whatever the other keys say: 5-10:2, 20.5-24:3 (millimetres over the bed, tool); empty: none.
        heights: String = String::new(),
        /// The tools that are changed to are flushed into the object, inside and outside: it is printed with whichever tool is in use, in whichever color comes out. For single objects.
        flush: bool = false,
        /// How far inside of the outline the tool that is painted on it prints; 0: to where another piece of the outline is nearer.
        paint_depth: Mm = Mm(0.0); 0.0..=1000.0,
    }
}
section! {
    /// `[prime_tower]`: where tools are flushed that need it.
    PrimeTowerSettings {
        /// Print one where tools change; without it flushing is left to the change's script.
        enabled: bool = true,
        /// Width along X.
        width: Mm = Mm(35.0); 5.0..=500.0,
        /// Middle of the tower in bed coordinates, X and Y; empty: beside the objects.
        position: Vec<f64> = Vec::new(); -5000.0..=5000.0, "mm",
        /// Width of the brim around it.
        brim: Mm = Mm(3.0); 0.0..=50.0,
        /// Distance of the lines where a layer flushes nothing.
        line_distance: Mm = Mm(2.5); 0.5..=20.0,
        /// Width of the lines that tools are flushed into, of the other lines: the wider, the fewer turns.
        flush_width: Ratio = Ratio(2.0); 0.5..=5.0,
        /// Distance of these lines, of their width; on the first layer they touch each other.
        flush_spacing: Ratio = Ratio(1.0); 1.0..=5.0,
        /// Before the first layer, load and flush each tool that prints at the front edge of the bed, or at the back edge: the start script is told, which then primes none.
        at_start: bool = false,
    }
}
