//! Loading, and cutting all layers. Aim: binary STL read, welded and repaired at 400 MB/s or more.

use std::path::{Path, PathBuf};

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use pathwright::mesh::{Item, Placement, from_bytes, place};
use pathwright::profile::{BedSettings, LayerSettings};
use pathwright::slice::Slicer;

fn inputs() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
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
        let data = std::fs::read(&path).expect("the file was there a moment ago");
        let mut group = c.benchmark_group(&name);
        group.sample_size(20).throughput(Throughput::Bytes(data.len() as u64));
        group.bench_function("load", |b| {
            b.iter_batched(|| data.clone(), |data| from_bytes(&path, data), BatchSize::LargeInput);
        });
        let (mesh, _) = from_bytes(&path, data.clone()).expect("the models are sound");
        let items = vec![Item { name, mesh, copies: 1 }];
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
