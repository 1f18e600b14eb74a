//! Planning, timing, formatting and reading a layer of a million moves; reordering a finished file.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pathwright::Observer;
use pathwright::estimate::{Firmware, Machine, Planner, Segment, layer_time};
use pathwright::gcode::{PrintFacts, Scripts, Timetable, WriterSettings, format_layer, measure};
use pathwright::geometry::{Point, Region};
use pathwright::job::{Engine, Job, ReorderJob};
use pathwright::motion::{Entry, LayerMoves, MotionSettings, plan_layer};
use pathwright::order::PathVisit;
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile::{Override, Settings, resolve};
use pathwright::toolpath::{Island, IslandId, LayerKind, LayerPaths, Path, Phase, Role, Width};
use pathwright::units::Mm;

const MOVES: u64 = 1_000_000;

/// Wobbly rings of 100 vertices, 0.6 mm apart, that no simplification can shorten.
fn layer() -> LayerPaths {
    let ring = |i: u64| {
        let center = (20.0 + (i % 100) as f64 * 2.0, 20.0 + (i / 100 % 100) as f64 * 2.0);
        let points = (0..100).map(|k| {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / 100.0).sin_cos();
            let radius_mm = 9.6 + if k % 2 == 0 { 0.05 } else { -0.05 };
            Point::from_mm(center.0 + radius_mm * cosine, center.1 + radius_mm * sine)
        });
        Path {
            role: Role::Perimeter,
            closed: true,
            points: points.collect(),
            width: Width::Constant(0.45),
            height_mm: 0.2,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        }
    };
    LayerPaths {
        index: 7,
        top_mm: 1.6,
        height_mm: 0.2,
        islands: vec![Island { object: 0, repeats: false, meets_others: false }],
        paths: (0..MOVES / 100).map(ring).collect(),
        outline: Region::default(),
        beneath: None,
        kind: LayerKind::Flat,
        entries: Default::default(),
        tools: Vec::new(),
        rams: Vec::new(),
        turn: Default::default(),
    }
}

/// A wobbly spiral, never at rest.
fn segments() -> Vec<Segment> {
    let line = |i: u64| {
        let (sine, cosine) = (i as f64 * 0.07).sin_cos();
        let length_mm = if i.is_multiple_of(2) { 0.6 } else { 0.4 };
        let delta = [length_mm * cosine, length_mm * sine, 0.0, 0.034 * length_mm];
        Segment { delta, speed: 60.0, acceleration: 1500.0, account: 0 }
    };
    (0..MOVES).map(line).collect()
}

fn plan(layer: &LayerPaths, settings: &Settings) -> LayerMoves {
    let sequence: Vec<PathVisit> =
        (0..layer.paths.len() as u32).map(|item| PathVisit { path: item, entry: 0 }).collect();
    plan_layer(layer, &sequence, Entry::default(), &MotionSettings::new(settings, &[]))
}

fn gcode(c: &mut Criterion) {
    let settings = Settings::default();
    let layer = layer();
    let moves = plan(&layer, &settings);
    let count = moves.moves.len() as u64;
    let facts = PrintFacts {
        layers: 1,
        max_mm: [250.0; 2],
        max_z_mm: 1.6,
        dated: 946_684_800,
        ..PrintFacts::default()
    };
    let scripts = Scripts::new(&settings, &facts).expect("no scripts");
    let writer = WriterSettings::new(&settings, &scripts, false);
    let bytes = format_layer(&moves, &writer).bytes;
    let machine = Machine::new(&settings);

    let mut group = c.benchmark_group("gcode");
    group.sample_size(10);
    group.throughput(Throughput::Elements(count));
    group.bench_function("plan", |b| b.iter(|| plan(black_box(&layer), &settings)));
    group.bench_function("estimate", |b| b.iter(|| layer_time(black_box(&moves), &machine)));
    let klipper = Machine::under(Firmware::Klipper, &settings);
    let segments = segments();
    group.throughput(Throughput::Elements(segments.len() as u64));
    group.bench_function("planner alone", |b| {
        b.iter(|| {
            let mut planner = Planner::new(&klipper);
            black_box(&segments).iter().for_each(|segment| planner.push(segment));
            planner.finish()
        })
    });
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("format", |b| b.iter(|| format_layer(black_box(&moves), &writer)));
    let five_mb = &bytes[..bytes.len().min(5_000_000)];
    group.throughput(Throughput::Bytes(five_mb.len() as u64));
    group.bench_function("time", |b| b.iter(|| Timetable::read(black_box(five_mb), &klipper)));
    group.bench_function("read", |b| b.iter(|| measure(black_box(five_mb), Mm(1.75))));
    group.finish();
}

/// Finished files through reading, ordering and writing; then with all that `reorder` does besides: the proof, the
/// times, the check. One file has long outlines, the other one many short travels between small islands.
fn reorder(c: &mut Criterion) {
    let settings = |set: &[(&str, &str)]| {
        let overrides: Vec<Override> = set
            .iter()
            .map(|(key, value)| Override { key: (*key).into(), value: (*value).into(), option: "--set" })
            .collect();
        resolve(&[], &overrides).expect("sound settings").settings
    };
    let folder = tempfile::tempdir().expect("a folder");
    let wanted = settings(&[("order.strategy", "nearest"), ("seam.position", "pinned")]);
    let mut group = c.benchmark_group("reorder");
    group.sample_size(10);
    for (name, height) in [("helical_gear", "0.02"), ("pin_forest", "0.1")] {
        let file = folder.path().join(name);
        let model = format!("{}/../models/{name}.stl", env!("CARGO_MANIFEST_DIR"));
        let job = Job { models: vec![model.into()], ..Job::default() };
        let mut output = Output::create(&file).expect("a file");
        let made = settings(&[("order.strategy", "as-sliced"), ("layer.height", height)]);
        Pipeline.slice(&job, &made, &mut output, &Observer::none()).expect("a print");
        output.commit().expect("written");

        group.throughput(Throughput::Bytes(std::fs::metadata(&file).expect("a file").len()));
        group.bench_function(BenchmarkId::new("nearest", name), |b| {
            b.iter(|| {
                let mut output = Output::nowhere().expect("a place");
                Pipeline.rewrite(&file, &wanted, &mut output).expect("written");
            });
        });
        let job = ReorderJob { file: file.clone(), ..ReorderJob::default() };
        group.bench_function(BenchmarkId::new("nearest, proven", name), |b| {
            b.iter(|| {
                let mut output = Output::nowhere().expect("a place");
                Pipeline.reorder(&job, &wanted, &mut output, &Observer::none()).expect("the same print")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, gcode, reorder);
criterion_main!(benches);
