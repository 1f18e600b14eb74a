//! Small prints made by hand: layers of loops, zigzags and single beads, planned and written as the pipeline
//! would.

use pathwright::estimate::{LayerTime, Machine, cool, layer_time};
use pathwright::gcode::{
    GcodeOptions, PrintFacts, Scripts, Totals, WriterSettings, footer, format_layer, header,
};
use pathwright::geometry::{Point, Region};
use pathwright::motion::{Entry, LayerMoves, MotionSettings, PauseAt, exit, plan_layer};
use pathwright::order::PathVisit;
use pathwright::profile::Settings;
use pathwright::toolpath::bead::area_mm2;
use pathwright::toolpath::{Island, IslandId, LayerKind, LayerPaths, Path, Phase, Role, Width};
use pathwright::units::{Mm, Mm3, Seconds};

/// Heats, homes, primes along the front edge, and lifts.
pub const START: &str = "\
G90
M83
M140 S{bed_temp}
M104 S{nozzle_temp}
G28
M190 S{bed_temp}
M109 S{nozzle_temp}
G92 E0
G1 Z2 F{z_f}
G1 X10 Y5 F{travel_f}
G1 Z0.28 F{z_f}
G1 X110 E10 F1500
G1 Y5.4
G1 X10 E10
G92 E0
G1 Z2 F{z_f}
";

/// Retracts, lifts off the part, then presents it, and switches everything off.
pub const END: &str = "\
M83
G1 E-{retract_length} F{retract_f}
G90
M83
G1 Z{park_z} F{z_f}
G1 X{bed_min_x} Y{bed_max_y} F{travel_f}
M106 S0
M104 S0
M140 S0
M84
";

/// The default settings without start and end script and with closed loops: what is written is what the layers hold.
pub fn bare() -> Settings {
    let mut settings = Settings::default();
    settings.seam.gap = Mm(0.0);
    (settings.gcode.start, settings.gcode.end) = (String::new(), String::new());
    settings
}

/// A path of 0.45 mm beads, 0.2 mm high.
pub fn path(role: Role, closed: bool, points: &[(f64, f64)]) -> Path {
    Path {
        role,
        closed,
        points: points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect(),
        width: Width::Constant(0.45),
        height_mm: 0.2,
        island: Some(IslandId(0)),
        phase: Phase::Wall(0),
        tool: None,
    }
}

/// A regular polygon.
pub fn ring(role: Role, center: (f64, f64), radius_mm: f64, corners: u32) -> Path {
    let turn = std::f64::consts::TAU / f64::from(corners);
    let points: Vec<(f64, f64)> = (0..corners)
        .map(|i| (turn * f64::from(i)).sin_cos())
        .map(|(sine, cosine)| (center.0 + radius_mm * cosine, center.1 + radius_mm * sine))
        .collect();
    path(role, true, &points)
}

/// Lines 1 mm apart, joined at their ends.
pub fn zigzag(role: Role, corner: (f64, f64), size_mm: f64) -> Path {
    let points: Vec<(f64, f64)> = (0..size_mm as u32 * 2)
        .map(|i| (f64::from(i / 2), if i.div_ceil(2) % 2 == 0 { 0.0 } else { size_mm }))
        .map(|(dx, dy)| (corner.0 + dx, corner.1 + dy))
        .collect();
    path(role, false, &points)
}

/// A layer with these paths.
pub fn layer(index: usize, paths: Vec<Path>) -> LayerPaths {
    LayerPaths {
        index,
        top_mm: 0.2 * (index + 1) as f64,
        height_mm: 0.2,
        islands: vec![Island { object: 0, repeats: false, meets_others: false }],
        paths,
        outline: Region::default(),
        beneath: None,
        kind: LayerKind::Flat,
        entries: Default::default(),
        tools: Vec::new(),
        rams: Vec::new(),
        turn: Default::default(),
    }
}

/// Layers of every kind of path: two round walls, infill, a bridge, a bead of changing width.
pub fn mixed(layers: usize) -> Vec<LayerPaths> {
    (0..layers)
        .map(|i| {
            let mut thin = path(Role::GapFill, false, &[(140.0, 100.0), (143.0, 101.0), (146.3, 101.0)]);
            thin.width = Width::PerVertex(vec![0.3, 0.6, 0.35]);
            layer(
                i,
                vec![
                    ring(Role::Perimeter, (110.0, 110.0), 9.55, 100),
                    ring(Role::ExternalPerimeter, (110.0, 110.0), 10.0, 120),
                    zigzag(Role::InternalInfill, (104.0, 104.0), 12.0),
                    zigzag(Role::BridgeInfill, (150.0, 150.0), 8.0),
                    thin,
                ],
            )
        })
        .collect()
}

/// All paths in order, loops entered at their third vertex, open paths every other time backwards.
pub fn sequence(layer: &LayerPaths) -> Vec<PathVisit> {
    (0..layer.paths.len() as u32)
        .map(|item| PathVisit {
            path: item,
            entry: if layer.paths[item as usize].closed { 2 } else { item % 2 },
        })
        .collect()
}

/// Plans every layer, with cooling.
pub fn plan(layers: &[LayerPaths], settings: &Settings, pauses: &[PauseAt]) -> Vec<(LayerMoves, LayerTime)> {
    let motion = MotionSettings::new(settings, pauses);
    let machine = Machine::new(settings);
    let mut from = Entry::default();
    layers
        .iter()
        .map(|layer| {
            let sequence = sequence(layer);
            let mut moves = plan_layer(layer, &sequence, from.clone(), &motion);
            from = exit(layer, &sequence, std::mem::take(&mut from), &motion);
            let time = cool(&mut moves, layer.turn.elsewhere, &settings.cooling, &machine);
            assert_eq!(time, layer_time(&moves, &machine));
            (moves, time)
        })
        .collect()
}

/// A whole file.
pub fn print(layers: &[LayerPaths], settings: &Settings, pauses: &[PauseAt]) -> String {
    let facts = PrintFacts {
        layers: layers.len(),
        min_mm: [100.0, 100.0],
        max_mm: [160.0, 160.0],
        max_z_mm: 0.2 * layers.len() as f64,
        dated: 946_684_800,
        ..PrintFacts::default()
    };
    let scripts = Scripts::new(settings, &facts).expect("scripts are right");
    let writer = WriterSettings::new(settings, &scripts, true);
    let header = header(&GcodeOptions::from(settings), &facts, &scripts, true);
    let mut bytes = header.bytes;
    let mut slots = header.slots;
    let mut totals = Totals { volume: Mm3(volume_mm3(layers, settings)), ..Default::default() };
    for (moves, time) in plan(layers, settings, pauses) {
        let text = format_layer(&moves, &writer);
        slots.extend(text.progress.map(|mut slot| {
            slot.offset += bytes.len();
            slot
        }));
        bytes.extend_from_slice(&text.bytes);
        totals.layer_starts.push(totals.time);
        totals.time += time.total();
    }
    for slot in slots {
        bytes[slot.offset..slot.offset + slot.width].copy_from_slice(&totals.fill(&slot, &settings.filament));
    }
    bytes.extend_from_slice(&footer(&GcodeOptions::from(settings), &facts, &scripts, &totals));
    String::from_utf8(bytes).expect("text")
}

/// Volume of all paths by the flow model, computed independently of the planner.
pub fn volume_mm3(layers: &[LayerPaths], settings: &Settings) -> f64 {
    let mut total = 0.0;
    for layer in layers {
        let first = if layer.index == 0 { settings.first_layer.flow } else { 1.0 };
        for path in &layer.paths {
            let n = path.points.len();
            let flow = settings.filament.flow * first * settings.flow.of(path.role);
            let area = |i: usize| match (&path.width, path.role) {
                (Width::Constant(w), Role::BridgeInfill) => std::f64::consts::PI / 4.0 * w * w,
                (Width::PerVertex(w), Role::BridgeInfill) => {
                    std::f64::consts::PI / 4.0 * f64::from(w[i]).powi(2)
                }
                (Width::Constant(w), _) => area_mm2(*w, path.height_mm),
                (Width::PerVertex(w), _) => area_mm2(f64::from(w[i]), path.height_mm),
            };
            for i in 0..if path.closed { n } else { n - 1 } {
                let j = (i + 1) % n;
                let length_mm = path.points[i].distance_mm(path.points[j]);
                total += 0.5 * (area(i) + area(j)) * length_mm * flow;
            }
        }
    }
    total
}

/// Seconds of every layer.
pub fn seconds(layers: &[LayerPaths], settings: &Settings) -> Vec<Seconds> {
    plan(layers, settings, &[]).iter().map(|(_, time)| time.total()).collect()
}
