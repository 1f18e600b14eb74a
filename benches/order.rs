//! Time of each strategy on synthetic layers of 1,000, 5,000 and 20,000 paths, and of the order of tools.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use pathwright::geometry::Point;
use pathwright::order::tools::{ToolLayer, ToolOrder, ToolProblem, order_tools};
use pathwright::order::{Cost, Item, Problem, Run, Shape, strategy};
use pathwright::profile::{Effort, OrderStrategy, Scope};

/// Round islands on a square grid, each with an outer loop of 48 vertices and lines across it.
struct Layer {
    lines: Vec<(u32, [Point; 2])>,
    loops: Vec<(u32, Vec<Point>)>,
}

const LINES: usize = 19;

impl Layer {
    fn new(paths: usize) -> Self {
        let islands = paths / (LINES + 1);
        let columns = (islands as f64).sqrt().ceil() as usize;
        let mut layer = Self { lines: Vec::new(), loops: Vec::new() };
        for island in 0..islands {
            // A little out of line, so that few distances are equal.
            let jitter = ((island * 7919) % 97) as f64 / 97.0;
            let (x, y) =
                ((island % columns) as f64 * 12.0 + jitter, (island / columns) as f64 * 12.0 - jitter);
            let run = 2 * island as u32;
            let vertex = |k: usize| {
                let angle = k as f64 / 48.0 * std::f64::consts::TAU;
                Point::from_mm(x + 5.0 * angle.cos(), y + 5.0 * angle.sin())
            };
            layer.loops.push((run, (0..48).map(vertex).collect()));
            for line in 0..LINES {
                let across = (line as f64 + 0.5) / LINES as f64 * 9.0 - 4.5;
                let half = (4.7f64 * 4.7 - across * across).max(0.04).sqrt();
                let ends = [Point::from_mm(x - half, y + across), Point::from_mm(x + half, y + across)];
                layer.lines.push((run + 1, ends));
            }
        }
        layer
    }

    fn problem(&self, scope: Scope) -> Problem<'_> {
        let loops = self.loops.iter().map(|(run, points)| Item { run: *run, shape: Shape::Loop(points) });
        let lines = self.lines.iter().map(|&(run, ends)| Item { run, shape: Shape::Open(ends) });
        let runs = (0..2 * self.loops.len() as u32).map(|run| Run {
            stage: 1,
            island: run / 2,
            layer: 0,
            rank: run % 2,
        });
        let start = Some(Point::default());
        Problem { items: loops.chain(lines).collect(), runs: runs.collect(), scope, start, end: None }
    }
}

fn order(criterion: &mut Criterion) {
    for &(_, scope) in &[Scope::ALL[0], Scope::ALL[1]] {
        let mut group = criterion.benchmark_group(scope.name());
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(200))
            .measurement_time(Duration::from_secs(2));
        for paths in [1_000, 5_000, 20_000] {
            let layer = Layer::new(paths);
            let problem = layer.problem(scope);
            group.throughput(Throughput::Elements(problem.items.len() as u64));
            let mut bench = |name: OrderStrategy, effort: Effort, label: &str| {
                group.bench_function(BenchmarkId::new(label, paths), |bencher| {
                    bencher.iter(|| strategy(name).solve(&problem, &Cost::Length, effort));
                });
            };
            for &(label, name) in
                OrderStrategy::ALL.iter().filter(|(_, name)| *name != OrderStrategy::Optimized)
            {
                bench(name, Effort::Normal, label);
            }
            bench(OrderStrategy::Optimized, Effort::Fast, "optimized-fast");
            bench(OrderStrategy::Optimized, Effort::Normal, "optimized-normal");
        }
    }
}

/// 16 tools on 1,000 layers: of four kinds, and each with others.
fn tools(criterion: &mut Criterion) {
    let mixed = |k: u32| k.wrapping_mul(2_654_435_761).rotate_left(15).wrapping_mul(2_246_822_519) >> 9;
    let change: Vec<Vec<u32>> =
        (0..16).map(|a| (0..16).map(|b| 10_000 + mixed(16 * a + b) % 110_000).collect()).collect();
    let problem = |set_of: &dyn Fn(u32) -> u32| {
        let tools = |set: u32| (0..16).filter(|tool| set >> tool & 1 == 1).collect();
        let layer = |k| ToolLayer { tools: tools(set_of(k)), before: Vec::new() };
        ToolProblem { layers: (0..1000).map(layer).collect(), change: change.clone(), loaded: Some(0) }
    };
    let mut group = criterion.benchmark_group("tools");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    for (label, problem) in [
        ("all-on-every-layer", problem(&|_| 0xffff)),
        ("four-kinds", problem(&|k| [0xffff, 0x0fff, 0xfff0, 0x3ffc][k as usize % 4])),
        ("each-other", problem(&|k| mixed(k) & 0xffff)),
        ("twelve-and-more", problem(&|k| mixed(k) & 0xffff | 0x0ff0 | 0xf << (k % 4 * 4))),
    ] {
        group.bench_function(label, |bencher| bencher.iter(|| order_tools(&problem, ToolOrder::Optimal)));
    }
}

criterion_group!(benches, order, tools);
criterion_main!(benches);
