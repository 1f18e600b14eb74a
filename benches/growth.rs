//! How the work of a slicing grows with triangles, with layers, and with paths per layer.
//!
//! `cargo bench -p pathwright-benches --bench growth --profile quick` prints instructions at the standard job on one thread and
//! draws them into `docs/pictures/growth.svg`, relative to the smallest of each series. Valgrind counts.

mod counted;

use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use counted::{count, slice_if_asked};
use plotters::prelude::*;

/// The program's allocator.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

type Corner = [f64; 3];
type Facet = [Corner; 3];

/// Models of growing size.
struct Series {
    name: &'static str,
    sizes: Vec<usize>,
    /// The model of a size, and how much of what is counted it has.
    model: fn(usize) -> (Vec<Facet>, usize),
}

/// Instructions of one series: how much there is, and millions.
type Counts = Vec<(f64, f64)>;

/// A dented ball of 60 mm, of `size` by 2 · `size` patches.
fn ball(size: usize) -> (Vec<Facet>, usize) {
    let corner = |i: usize, j: usize| {
        let (u, v) = (i as f64 / size as f64 * TAU / 2.0, (j % (2 * size)) as f64 / size as f64 * TAU / 2.0);
        let radius = 28.0 + 2.0 * (9.0 * u).sin() * (12.0 * v).sin() * u.sin();
        [radius * u.sin() * v.cos(), radius * u.sin() * v.sin(), radius * u.cos()]
    };
    let mut facets = Vec::new();
    for (i, j) in (0..size).flat_map(|i| (0..2 * size).map(move |j| (i, j))) {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        if i + 1 < size {
            facets.push([a, b, c]);
        }
        if i > 0 {
            facets.push([a, c, d]);
        }
    }
    let count = facets.len();
    (facets, count)
}

/// A prism over a ring of corners.
fn prism(ring: &[[f64; 2]], height: f64, facets: &mut Vec<Facet>) {
    let middle = [0, 1].map(|i| ring.iter().map(|corner| corner[i]).sum::<f64>() / ring.len() as f64);
    for (k, a) in ring.iter().enumerate() {
        let b = ring[(k + 1) % ring.len()];
        let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
        facets.push([at(*a, 0.0), at(b, 0.0), at(b, height)]);
        facets.push([at(*a, 0.0), at(b, height), at(*a, height)]);
        facets.push([at(middle, 0.0), at(b, 0.0), at(*a, 0.0)]);
        facets.push([at(middle, height), at(*a, height), at(b, height)]);
    }
}

/// A star of this many layers of 0.2 mm.
fn star(layers: usize) -> (Vec<Facet>, usize) {
    let corner = |k: usize| {
        let (angle, radius) = (k as f64 / 64.0 * TAU, 25.0 + 5.0 * (k as f64 / 64.0 * 8.0 * TAU).cos());
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut facets = Vec::new();
    prism(&(0..64).map(corner).collect::<Vec<_>>(), 0.2 * layers as f64, &mut facets);
    (facets, layers)
}

/// `side` by `side` pins of two walls, five layers high.
fn pins(side: usize) -> (Vec<Facet>, usize) {
    let mut facets = Vec::new();
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let corner = |k: usize| {
            let angle = k as f64 / 8.0 * TAU;
            [2.2 * i as f64 + 0.75 * angle.cos(), 2.2 * j as f64 + 0.75 * angle.sin()]
        };
        prism(&(0..8).map(corner).collect::<Vec<_>>(), 1.0, &mut facets);
    }
    (facets, 2 * side * side)
}

fn write_stl(facets: &[Facet], path: &Path) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    file.write_all(&[0; 80])?;
    file.write_all(&(facets.len() as u32).to_le_bytes())?;
    for facet in facets {
        // Normals are not read.
        file.write_all(&[0; 12])?;
        for value in facet.iter().flatten() {
            file.write_all(&(*value as f32).to_le_bytes())?;
        }
        file.write_all(&[0; 2])?;
    }
    file.flush()
}

/// Lines of growth on logarithmic axes, with a dashed one of what is linear.
fn draw(all: &[(&str, Counts)], path: &Path) -> Result<(), Box<dyn Error>> {
    let last = all.iter().filter_map(|(_, counts)| Some((counts[0], *counts.last()?)));
    let most =
        last.map(|(a, b)| [b.0 / a.0, b.1 / a.1]).fold([1.0_f64; 2], |m, v| [0, 1].map(|i| m[i].max(v[i])));
    let area = SVGBackend::new(path, (720, 480)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d((0.9..1.1 * most[0]).log_scale(), (0.9..1.1 * most[1]).log_scale())?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("times as many triangles, layers, paths per layer")
        .y_desc("times as many instructions")
        .draw()?;
    let linear = [1.0, most[0].min(most[1])].map(|x| (x, x));
    chart
        .draw_series(DashedLineSeries::new(linear, 6, 4, BLACK.mix(0.5).stroke_width(1)))?
        .label("linear")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], BLACK.mix(0.5)));
    for (k, (name, counts)) in all.iter().enumerate() {
        let color = [RGBColor(31, 119, 180), RGBColor(214, 39, 40), RGBColor(44, 160, 44)][k % 3];
        let (first, base) = counts[0];
        let points = counts.iter().map(|&(size, count)| (size / first, count / base));
        chart
            .draw_series(LineSeries::new(points.clone(), color.stroke_width(2)))?
            .label(*name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(2)));
        chart.draw_series(points.map(|point| Circle::new(point, 4, color.filled())))?;
    }
    chart.configure_series_labels().position(SeriesLabelPosition::UpperLeft).border_style(BLACK).draw()?;
    area.present()?;
    Ok(())
}

fn main() -> ExitCode {
    if slice_if_asked() {
        return ExitCode::SUCCESS;
    }
    let series = [
        Series { name: "triangles", sizes: vec![90, 180, 360, 720], model: ball },
        Series { name: "layers", sizes: vec![75, 150, 300, 600, 1200], model: star },
        Series { name: "paths per layer", sizes: vec![8, 16, 32, 64, 104], model: pins },
    ];
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("part.stl");
    let mut all = Vec::new();
    for Series { name, sizes, model: make } in series {
        let mut counts = Counts::new();
        for size in sizes {
            let (facets, much) = make(size);
            write_stl(&facets, &model).expect("the model is written");
            let Some(millions) = count(&model, folder.path()) else {
                println!("nothing counts instructions here: Valgrind is missing, or a model was not sliced");
                return ExitCode::SUCCESS;
            };
            let each = millions / much as f64 * 1000.0;
            println!("{much:9} {name:16} {millions:10.1} million instructions, {each:8.1} thousand each");
            counts.push((much as f64, millions));
        }
        all.push((name, counts));
    }
    let picture = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures/growth.svg");
    draw(&all, &picture).expect("the picture is drawn");
    ExitCode::SUCCESS
}
