//! Loading, and cutting all layers. Aim: binary STL read, welded and repaired at 400 MB/s or more.

use std::path::{Path, PathBuf};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use pathwright::mesh::load;
use pathwright::plate::{Layout, Placement, place};
use pathwright::profile::{BedSettings, LayerSettings};
use pathwright::slice::Slicer;

fn inputs() -> Vec<PathBuf> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let names = [
        "models/plate_with_holes.stl",
        "../shared/models/seed/3DHackerTest.stl",
        "../shared/models/seed/TortureTestV2.stl",
        "../shared/models/open/3DBenchy.stl",
    ];
    names.map(|name| root.join(name)).into_iter().filter(|path| path.exists()).collect()
}

fn mesh(c: &mut Criterion) {
    for path in inputs() {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = std::fs::metadata(&path).map_or(0, |file| file.len());
        let mut group = c.benchmark_group(&name);
        group.sample_size(20).throughput(Throughput::Bytes(bytes));
        group.bench_function("load", |b| {
            b.iter(|| load(&path));
        });
        let (mesh, _) = load(&path).expect("the models are sound");
        let items = vec![Layout::single(name, mesh, 1)];
        let plate = place(items, &BedSettings::default(), &Placement::default()).expect("the models fit");
        group.bench_function("prepare", |b| b.iter(|| Slicer::new(&plate, &LayerSettings::default())));
        let slicer = Slicer::new(&plate, &LayerSettings::default());
        group.bench_function("cut", |b| {
            b.iter(|| (0..slicer.spans().len()).map(|i| slicer.layer(i)).collect::<Vec<_>>());
        });
    }
}

criterion_group!(benches, mesh);
criterion_main!(benches);
