//! What fuzzing does with bytes: each function takes any bytes and must come to an end without a panic. Used by the fuzz
//! targets, and by `tests/stages/fuzz.rs` on a stable toolchain.

#![allow(dead_code, reason = "each fuzz target uses one of them")]

pub mod shapes;

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;

use macros::Value;
use pathwright::check::{Survey, check};
use pathwright::gcode::{annotate, measure};
use pathwright::geometry;
use pathwright::mesh;
use pathwright::order::{self, Chain, LayerProblem, SeamRule, Watch, strategy};
use pathwright::plate::{self, Layout, Placement};
use pathwright::profile::{
    self, CostKind, Effort, OrderSettings, OrderStrategy, Override, Pattern, Scope, SeamPosition, Settings,
    WallGenerator,
};
use pathwright::slice;
use pathwright::units::Mm;
use shapes::Bytes;

use super::toolpath_plan::plan_with;

/// Any bytes as an STL file.
pub fn stl(bytes: &[u8]) {
    model("part.stl", bytes);
}

/// Any bytes as an OBJ file.
pub fn obj(bytes: &[u8]) {
    model("part.obj", bytes);
}

/// Any bytes as a 3MF file, or as the two texts in a sound archive: relations, a zero, the model.
pub fn threemf(bytes: &[u8]) {
    model("part.3mf", bytes);
    let end = bytes.iter().position(|&byte| byte == 0);
    let (relations, part) = end.map_or((&[][..], bytes), |end| (&bytes[..end], &bytes[end + 1..]));
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [("_rels/.rels", relations), ("3D/3dmodel.model", part)] {
        if !text.is_empty() {
            zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("a part");
            zip.write_all(text).expect("written");
        }
    }
    model("part.3mf", &zip.finish().expect("an archive").into_inner());
}

/// A file that is a model is repaired, placed and cut.
fn model(name: &str, bytes: &[u8]) {
    let Ok((mesh, report)) = mesh::from_bytes(Path::new(name), bytes) else { return };
    assert!(report.volume_mm3.is_finite());
    let settings = Settings::default();
    let item = Layout::single("part", mesh, 1);
    let Ok(plate) = plate::place(vec![item], &settings.bed, &Placement::default()) else { return };
    let layers = slice::slice(&plate, &settings.layer);
    let area_mm2: f64 = layers.iter().flat_map(|layer| &layer.sections).map(|s| s.region.area_mm2()).sum();
    assert!(area_mm2 >= 0.0);
}

/// Any text as a profile, in a file and as `--set`.
pub fn profile(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let folder = std::env::temp_dir().join(format!("pathwright-fuzz-{}", std::process::id()));
    let path = folder.join("any.toml");
    if std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, bytes)).is_ok() {
        let _ = profile::resolve(&[path.display().to_string()], &[]);
    }
    let _ = std::fs::remove_dir_all(&folder);
    let sets: Vec<Override> = text
        .lines()
        .filter_map(|line| line.split_once('='))
        .map(|(key, value)| Override { key: key.trim().into(), value: value.trim().into(), option: "--set" })
        .collect();
    if let Ok(resolved) = profile::resolve(&[], &sets) {
        assert!(profile::resolve(&[], &[]).is_ok() && resolved.settings.bed.height.0 > 0.0);
    }
}

/// Any text as a script, twice in a row and then from the start, and as a condition.
pub fn macros(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let names = BTreeMap::from([
        ("layer_z".to_owned(), Value::Real(0.3)),
        ("temperature".to_owned(), Value::from(vec![215, 230])),
        ("printer_notes".to_owned(), Value::from("MK4\nIS")),
        ("idle_temperature".to_owned(), Value::List(vec![Value::Nil, Value::Integer(100)])),
    ]);
    let twice = || {
        let mut state = macros::State::default();
        [(); 2].map(|()| macros::expand(&text, &names, &mut state))
    };
    let expanded = twice();
    assert_eq!(expanded, twice());
    for error in expanded.into_iter().filter_map(Result::err).chain(macros::holds(&text, &names).err()) {
        let line = text.split('\n').nth(error.line - 1).expect("a line of the script");
        assert!((1..=line.chars().count() + 1).contains(&error.column), "{error}");
    }
}

/// Any bytes through the reader of G-code, the checks and the sums.
pub fn gcode(bytes: &[u8]) {
    let settings = Settings::default();
    let mut survey = Survey::default();
    let report = check(bytes, &settings, Some(&mut survey)).expect("memory can be read");
    if let Some(report) = report {
        assert!(report.faults.iter().all(|fault| fault.count > 0 && !fault.first.is_empty()));
        let _ = report.to_string();
    }
    assert_eq!(annotate(bytes).map(|read| read.line.raw.len()).sum::<usize>(), bytes.len());
    let _ = measure(bytes, settings.filament.diameter);
}

/// Any bytes as binary G-code, and as the blocks of a file without checksums.
pub fn bgcode(bytes: &[u8]) {
    let headed = [&b"GCDE\x01\0\0\0\0\0"[..], bytes].concat();
    for bytes in [bytes, &headed] {
        let Ok(mut text) = bgcode::Text::open(Cursor::new(bytes)) else { continue };
        let mut read = Vec::new();
        text.read_to_end(&mut read).expect("what was read once");
        assert_eq!(text.seek(SeekFrom::End(0)).expect("an end"), read.len() as u64);
        let contents = bgcode::Contents::of(&*read).expect("memory can be read");
        let again = bgcode::pack(&contents, &*read, bgcode::Options::default(), Vec::new());
        let again = again.expect("memory can be written");
        let is_command = |line: &[u8]| !line.trim_ascii().is_empty() && !line.trim_ascii().starts_with(b";");
        if read.split(|byte| *byte == b'\n').any(is_command) {
            bgcode::Text::open(Cursor::new(again)).expect("what was written can be read");
        }
    }
}

/// Polygons that nobody would draw through offsets, walls, fills and the order of paths.
pub fn slicing(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let region = geometry::unite_rings(&shapes::rings(&mut bytes));
    let by_mm = f64::from(bytes.int(400)) / 100.0;
    let inset = geometry::offset(&region, -by_mm);
    // Corners are rounded to the grid.
    let around: usize = region.vertex_count() + inset.vertex_count();
    assert!(inset.area_mm2() <= region.area_mm2() + 1e-6 * (1 + around) as f64, "an inset grows");
    let _ = geometry::medial_axis(&region, 0.1, 1.0, 0.5);
    let narrow = geometry::difference(&region, &geometry::opening(&region, 0.5));
    let _ = geometry::medial_axis_in(&narrow, &region, 0.1, 1.0, 0.5, &geometry::KnownAxes::default());
    let mut settings = Settings::default();
    settings.infill.pattern = Pattern::ALL[bytes.int(Pattern::ALL.len() as u32) as usize].1;
    settings.walls.generator = WallGenerator::ALL[bytes.int(2) as usize].1;
    settings.walls.count = bytes.int(5);
    settings.walls.width = Mm(0.1 + f64::from(bytes.int(20)) / 20.0);
    settings.walls.external_width = settings.walls.width;
    settings.layer.elephant_foot = Mm(0.0);
    let sections = [region.clone(), geometry::offset(&region, 0.3), inset, region];
    let layers = plan_with(&sections, &settings, |_, _| ());
    assert!(layers.iter().flat_map(|layer| &layer.paths).all(|path| path.points.len() >= 2 || path.closed));
    let seam = SeamPosition::ALL[bytes.int(SeamPosition::ALL.len() as u32) as usize].1;
    let mut rule = SeamRule::new(seam);
    let pins: Vec<_> = layers.iter().map(|layer| rule.pins(layer)).collect();
    let scope = Scope::ALL[bytes.int(3) as usize].1;
    let cost = [CostKind::Length, CostKind::Time][bytes.int(2) as usize];
    let chain = Chain {
        settings: OrderSettings { scope, cost, effort: Effort::Fast, ..settings.order.clone() },
        cost: settings.order_cost(cost),
        detours: settings.detour_rule(),
        corners: settings.corners(),
        seam,
        origin: None,
    };
    for (layer, sequence) in layers.iter().zip(chain.solve_chunk(&layers, &pins, None, Watch::default())) {
        let layer = LayerProblem::new(layer, &None, scope);
        assert_eq!(order::check(&layer.problem, &layer.from_paths(&sequence)), Ok(()));
    }
}

/// Layers of random paths through every strategy and the checker.
pub fn ordering(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let name = OrderStrategy::ALL[bytes.int(OrderStrategy::ALL.len() as u32) as usize].1;
    let kind = [CostKind::Length, CostKind::Time][bytes.int(2) as usize];
    let layer = shapes::layer(&mut bytes);
    solve(&layer.problem(), name, kind);
}

fn solve(problem: &order::Problem<'_>, name: OrderStrategy, kind: CostKind) {
    let cost = Settings::default().order_cost(kind);
    let sequence = strategy(name).solve(problem, &cost, Effort::Fast);
    assert_eq!(order::check(problem, &sequence), Ok(()), "{name:?}");
}
