//! Exact minimum-cost perfect matching on nearest-neighbour graphs and on points.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use pathwright::geometry::Point;
use pathwright::order::matching;

/// Reproducible points in a square of 200 mm (a linear congruential generator, Knuth's MMIX constants).
fn points(count: usize) -> Vec<Point> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % 20_000_000) as i32
    };
    (0..count).map(|_| Point::new(next(), next())).collect()
}

/// Ten nearest neighbours of each point, and the pairs of points next to each other by x, so that a perfect matching exists.
fn ten_nearest(points: &[Point]) -> Vec<matching::Edge> {
    let mut pairs = Vec::new();
    for (u, at) in points.iter().enumerate() {
        let mut near: Vec<(i64, u32)> = points.iter().map(|p| p.distance2(*at)).zip(0..).collect();
        near.select_nth_unstable(10);
        pairs.extend(
            near[..=10]
                .iter()
                .map(|&(_, v)| v)
                .filter(|&v| v != u as u32)
                .map(|v| (v.min(u as u32), v.max(u as u32))),
        );
    }
    let mut by_x: Vec<u32> = (0..points.len() as u32).collect();
    by_x.sort_unstable_by_key(|&v| points[v as usize]);
    pairs.extend(by_x.chunks_exact(2).map(|p| (p[0].min(p[1]), p[0].max(p[1]))));
    pairs.sort_unstable();
    pairs.dedup();
    pairs.iter().map(|&(u, v)| (u, v, matching::distance(points[u as usize], points[v as usize]))).collect()
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("matching");
    group.sample_size(10);
    for count in [1_000, 10_000] {
        let points = points(count);
        let edges = ten_nearest(&points);
        group.bench_with_input(BenchmarkId::new("ten-nearest", count), &edges, |b, edges| {
            b.iter(|| matching::perfect(count, edges));
        });
        group.bench_with_input(BenchmarkId::new("points", count), &points, |b, points| {
            b.iter(|| matching::euclidean(points));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
