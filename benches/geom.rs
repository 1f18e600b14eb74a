//! Speed of the geometry kernel on outlines like those of real layers.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pathwright::geometry::{
    Clipper, Point, Region, Ring, difference, intersection, medial_axis, offset, scan_lines, union_all,
    unite_rings,
};

/// An outline with lobes and a fine ripple, scaled about its centre.
fn outline(vertices: usize, ripple_mm: f64, scale: f64) -> Ring {
    (0..vertices)
        .map(|i| {
            let angle = i as f64 / vertices as f64 * TAU;
            let r = scale * (20.0 + 5.0 * (5.0 * angle).sin() + ripple_mm * (61.0 * angle).cos());
            Point::from_mm(100.0 + r * angle.cos(), 100.0 + r * angle.sin())
        })
        .collect()
}

/// An outline with a hole.
fn section(vertices: usize, ripple_mm: f64, scale: f64) -> Region {
    let mut hole = outline(vertices / 4, 0.0, 0.3 / scale);
    hole.reverse();
    unite_rings(&[outline(vertices - vertices / 4, ripple_mm, scale), hole])
}

fn offsets(c: &mut Criterion) {
    for vertices in [500, 5000] {
        let smooth = section(vertices, 0.05, 1.0);
        c.bench_function(&format!("inset {vertices} smooth"), |b| {
            b.iter(|| offset(black_box(&smooth), -0.45))
        });
        // Ripples too deep and narrow for the inset: parts meet, and the overlaps must be found.
        let rough = section(vertices, 4.0, 1.0);
        c.bench_function(&format!("inset {vertices} rough"), |b| b.iter(|| offset(black_box(&rough), -0.45)));
    }
    let plate = plate_with_holes();
    c.bench_function("inset plate with 400 holes", |b| b.iter(|| offset(black_box(&plate), -0.45)));
}

fn plate_with_holes() -> Region {
    let corner = |x, y| Point::from_mm(x, y);
    let mut rings =
        vec![vec![corner(0.0, 0.0), corner(100.0, 0.0), corner(100.0, 100.0), corner(0.0, 100.0)]];
    for i in 0..400 {
        let (x, y) = (2.5 + f64::from(i % 20) * 5.0, 2.5 + f64::from(i / 20) * 5.0);
        rings.push(
            (0..24)
                .map(|k| -f64::from(k) / 24.0 * TAU)
                .map(|a| corner(x + 1.5 * a.cos(), y + 1.5 * a.sin()))
                .collect(),
        );
    }
    unite_rings(&rings)
}

fn booleans(c: &mut Criterion) {
    let layer = section(1000, 0.05, 1.0);
    let next = section(1000, 0.05, 1.001);
    let twin = layer.clone();
    let far = layer.translated(Point::from_mm(100.0, 0.0));
    let mut group = c.benchmark_group("boolean 1000");
    group
        .bench_function("intersection near-identical", |b| b.iter(|| intersection(black_box(&layer), &next)));
    group.bench_function("difference near-identical", |b| b.iter(|| difference(black_box(&layer), &next)));
    group.bench_function("intersection identical", |b| b.iter(|| intersection(black_box(&layer), &twin)));
    group.bench_function("intersection apart", |b| b.iter(|| intersection(black_box(&layer), &far)));
    group.bench_function("union of three", |b| b.iter(|| union_all(black_box([&layer, &next, &far]))));
    let rings: Vec<Ring> = layer.rings().cloned().collect();
    group.bench_function("unite rings", |b| b.iter(|| unite_rings(black_box(&rings))));
}

fn lines(c: &mut Criterion) {
    let layer = section(1000, 0.05, 1.0);
    c.bench_function("hatch 1000 at 0.45 mm", |b| b.iter(|| scan_lines(black_box(&layer), 0.785, 0.45, 0.0)));
    let wave: Vec<Point> = (0..4000)
        .map(|i| f64::from(i) * 0.02)
        .map(|x| Point::from_mm(70.0 + x, 100.0 + 3.0 * x.sin()))
        .collect();
    c.bench_function("clip a wave of 4000", |b| b.iter(|| Clipper::new(black_box(&layer)).clip(&wave)));
}

fn axes(c: &mut Criterion) {
    for vertices in [500, 5000] {
        let outline = section(vertices, 0.05, 1.0);
        let band = difference(&outline, &offset(&outline, -0.6));
        let name = format!("medial axis {} vertices", band.vertex_count());
        c.bench_function(&name, |b| b.iter(|| medial_axis(black_box(&band), 0.1, 1.0, 0.5)));
    }
}

criterion_group!(benches, offsets, booleans, lines, axes);
criterion_main!(benches);
