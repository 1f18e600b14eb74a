//! Orders the paths of existing G-code files again, with several strategies, and prints what that saves.
//!
//!     cargo run --release --example order_gcode -- [scope] [length|time] [fast|normal|high] [chunks] FILE.gcode …

use pathwright::geom::{Point, Region};
use pathwright::order::{Chain, Cost, Pins, SeamRule, TravelTime, Visit, chunk_len, ends_on_path};
use pathwright::profile::{CostKind, Effort, OrderSettings, OrderStrategy, Scope, SeamPosition};
use pathwright::toolpath::{LayerPaths, Path, Role, Width};
use pathwright::units::Mm;

fn role(name: &str) -> Role {
    let name = name.to_ascii_lowercase();
    let has = |part: &str| name.contains(part);
    if has("skirt") || has("brim") {
        Role::Skirt
    } else if has("support") {
        Role::Support
    } else if has("outer") || has("external") {
        Role::ExternalPerimeter
    } else if has("inner") || has("perimeter") {
        Role::Perimeter
    } else if has("gap") {
        Role::GapFill
    } else if has("skin") || has("solid") {
        Role::SolidInfill
    } else if has("bridge") {
        Role::BridgeInfill
    } else {
        Role::InternalInfill
    }
}

/// The extruded paths of a file, layer by layer. An island ends where roles begin again.
fn read(file: &str) -> Vec<LayerPaths> {
    let text = std::fs::read_to_string(file).expect("a readable file");
    let mut layers: Vec<LayerPaths> = Vec::new();
    let (mut at, mut e, mut z, mut relative) = ([0.0f64; 2], 0.0, 0.0, false);
    let mut kind = Role::InternalInfill;
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut flush = |points: &mut Vec<[f64; 2]>, z: f64, kind: Role| {
        let taken = std::mem::take(points);
        let mut points: Vec<Point> = taken.iter().map(|p| Point::from_mm(p[0], p[1])).collect();
        points.dedup();
        if points.len() < 2 {
            return;
        }
        if layers.last().is_none_or(|layer| layer.top_mm != z) {
            layers.push(LayerPaths {
                index: layers.len(),
                top_mm: z,
                height_mm: 0.2,
                islands: Vec::new(),
                paths: Vec::new(),
                outline: Region::default(),
                beneath: None,
            });
        }
        let paths = &mut layers.last_mut().expect("just pushed").paths;
        let closed = points.len() > 3 && points[0].distance_mm(points[points.len() - 1]) < 0.15;
        if closed {
            points.pop();
        }
        let island = paths.last().map_or(0, |last: &Path| last.island + u32::from(last.role > kind));
        paths.push(Path {
            role: kind,
            closed,
            points,
            width: Width::Constant(0.45),
            height_mm: 0.2,
            island,
            rank: kind as u32,
        });
    };
    for line in text.lines() {
        if let Some(name) = line.strip_prefix(";TYPE:") {
            flush(&mut points, z, kind);
            kind = role(name);
        }
        let code = line.split(';').next().unwrap_or("");
        let mut words = code.split_whitespace();
        let value = |letter: char| -> Option<f64> {
            code.split_whitespace().find_map(|word| word.strip_prefix(letter)?.parse().ok())
        };
        match words.next() {
            Some("M82") => relative = false,
            Some("M83") => relative = true,
            Some("G92") => e = value('E').unwrap_or(e),
            Some("G0" | "G1") => {
                let to = [value('X').unwrap_or(at[0]), value('Y').unwrap_or(at[1])];
                let fed = value('E').map_or(0.0, |to| if relative { to } else { to - e });
                e = value('E').unwrap_or(e);
                let moved = to != at;
                if moved && fed > 0.0 {
                    if points.is_empty() {
                        points.push(at);
                    }
                    points.push(to);
                } else if moved {
                    flush(&mut points, z, kind);
                }
                at = to;
                if let Some(to) = value('Z')
                    && to != z
                {
                    flush(&mut points, z, kind);
                    z = to;
                }
            }
            _ => {}
        }
    }
    flush(&mut points, z, kind);
    layers.sort_by(|a, b| a.top_mm.total_cmp(&b.top_mm));
    layers
}

fn link_mm(layers: &[LayerPaths], sequences: &[Vec<Visit>], cost: &Cost) -> f64 {
    let (mut at, mut total) = (None, 0.0);
    for (layer, sequence) in layers.iter().zip(sequences) {
        for &visit in sequence {
            let (enter, leave) = ends_on_path(layer, visit);
            total += at.map_or(0.0, |from| cost.link(from, enter));
            at = Some(leave);
        }
    }
    total
}

/// As the pipeline does it: chunks from free starts, then their heads again.
fn in_chunks(chain: &Chain, layers: &[LayerPaths], pins: &[Pins]) -> Vec<Vec<Visit>> {
    let len = chunk_len(layers.len());
    let mut chunks: Vec<_> = layers
        .chunks(len)
        .zip(pins.chunks(len))
        .map(|(layers, pins)| chain.solve_chunk(layers, pins, None))
        .collect();
    for chunk in 1..chunks.len() {
        let first = chunk * len;
        let start =
            chunks[chunk - 1].last().and_then(|s| s.last()).map(|&v| ends_on_path(&layers[first - 1], v).1);
        let next = chunks[chunk].get(1).map(|sequence| (&layers[first + 1], sequence.as_slice()));
        let head = chain.resolve_head((&layers[first], &pins[first]), chunks[chunk][0].clone(), next, start);
        chunks[chunk][0] = head;
    }
    chunks.concat()
}

/// Processor time of this thread (Linux), which a busy machine does not stretch.
fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(f64::NAN) * 1e-9
}

fn main() {
    let mut scope = Scope::Layer;
    let mut kind = CostKind::Length;
    let time = Cost::Time(TravelTime {
        speed_mm_s: 150.0,
        acceleration_mm_s2: 3000.0,
        retract_from_mm: 1.5,
        retract_s: 0.05,
        ..TravelTime::default()
    });
    let mut files = Vec::new();
    let mut only = None;
    let mut chunked = false;
    for argument in std::env::args().skip(1) {
        if let Some((_, value)) = Scope::ALL.iter().find(|(name, _)| *name == argument) {
            scope = *value;
        } else if let Some((_, value)) = CostKind::ALL.iter().find(|(name, _)| *name == argument) {
            kind = *value;
        } else if argument == "chunks" {
            chunked = true;
        } else if let Some((_, value)) = Effort::ALL.iter().find(|(name, _)| *name == argument) {
            only = Some(*value);
        } else {
            files.push(argument);
        }
    }
    let layers: Vec<_> = files.iter().map(|file| read(file)).collect();
    let paths: usize = layers.iter().flatten().map(|layer| layer.paths.len()).sum();
    let loops = layers.iter().flatten().flat_map(|layer| &layer.paths).filter(|path| path.closed).count();
    let vertices: usize =
        layers.iter().flatten().flat_map(|l| &l.paths).filter(|p| p.closed).map(|p| p.points.len()).sum();
    println!("{scope:?} {kind:?}: {paths} paths, {loops} loops with {vertices} vertices");
    let mut runs = vec![];
    for &(_, name) in OrderStrategy::ALL.iter().filter(|(_, name)| *name != OrderStrategy::Optimized) {
        runs.push((name, Effort::Normal));
    }
    for effort in
        [Effort::Fast, Effort::Normal, Effort::High].into_iter().filter(|e| only.is_none_or(|o| o == *e))
    {
        runs.push((OrderStrategy::Optimized, effort));
    }
    let mut nearest = [0.0; 2];
    for (name, effort) in runs {
        let (mut length, mut seconds, mut took) = (0.0, 0.0, 0.0);
        let mut each = String::new();
        for layers in &layers {
            let chain = Chain {
                settings: OrderSettings {
                    strategy: name,
                    effort,
                    scope,
                    layer_distance: Mm(0.0),
                    ..Default::default()
                },
                cost: if kind == CostKind::Time { time } else { Cost::Length },
                seam: SeamPosition::Free,
                origin: None,
            };
            let mut rule = SeamRule::new(SeamPosition::Free);
            let pins: Vec<_> = layers.iter().map(|layer| rule.pins(layer)).collect();
            let begin = cpu_s();
            let sequences = if chunked {
                in_chunks(&chain, layers, &pins)
            } else {
                chain.solve_chunk(layers, &pins, None)
            };
            took += cpu_s() - begin;
            let link = link_mm(layers, &sequences, &Cost::Length);
            each += &format!(" {link:7.0}");
            length += link;
            seconds += link_mm(layers, &sequences, &time);
        }
        if name == OrderStrategy::Nearest {
            nearest = [length, seconds];
        }
        println!(
            "{:17} {:7} {length:9.0} mm ({:.3}) {seconds:8.1} s ({:.3}) {:7.3} ms/100 paths |{each}",
            name.name(),
            effort.name(),
            length / nearest[0],
            seconds / nearest[1],
            took * 1e5 / paths as f64
        );
    }
}
