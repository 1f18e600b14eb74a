//! Sections made here, and the paths that the toolpath stage makes of them.

use pathwright::geometry::{self, Point, Polygon, Region, Ring};
use pathwright::profile::Settings;
use pathwright::toolpath::{LayerPaths, ObjectLayer, Path, Planner, PlateLayer, Role, Shells, Width};
use pathwright::units::{Mm, Ratio};

pub const HEIGHT_MM: f64 = 0.2;

pub fn ring(points: &[(f64, f64)]) -> Ring {
    points.iter().map(|&(x, y)| Point::from_mm(x, y)).collect()
}

pub fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Region {
    let outer = ring(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)]);
    Region::from(Polygon { outer, holes: vec![] })
}

pub fn with_hole(region: Region, hole: &Region) -> Region {
    let mut polygons = region.into_polygons();
    let holes = hole.polygons().iter().map(|p| p.outer.iter().rev().copied().collect::<Ring>());
    polygons[0].holes.extend(holes);
    Region::disjoint(polygons)
}

/// The job that slicers are compared on.
pub fn job() -> Settings {
    let mut s = Settings::default();
    s.walls.count = 2;
    s.shell.top_layers = 4;
    s.shell.bottom_layers = 4;
    s.shell.top_width = Mm(0.45);
    s.infill.density = Ratio(0.2);
    s.first_layer.width = Mm(0.0);
    s.skirt.loops = 0;
    s
}

/// The paths of every layer of an object given by its sections, planned as a print is.
pub fn plan(sections: &[Region], settings: &Settings) -> Vec<LayerPaths> {
    plan_with(sections, settings, |planner, layers| {
        let samples: Vec<_> = layers[1..].iter().map(|layer| planner.sparse_sample(layer)).collect();
        planner.calibrate(&samples, HEIGHT_MM);
        if settings.infill.combine_layers > 1 {
            let areas: Vec<_> = layers.iter().map(|layer| (HEIGHT_MM, planner.sparse_area(layer))).collect();
            planner.combine(&areas);
        }
    })
}

/// The same, with what the planner is told before it begins.
pub fn plan_with(
    sections: &[Region],
    settings: &Settings,
    prepare: impl FnOnce(&mut Planner, &[PlateLayer<'_>]),
) -> Vec<LayerPaths> {
    let refs: Vec<&Region> = sections.iter().collect();
    let sequential = |n: usize, f: &(dyn Fn(usize) -> Region + Sync)| (0..n).map(f).collect();
    let shells = Shells::build(&refs, &vec![HEIGHT_MM; sections.len()], &settings.shell, &sequential);
    let nothing = Region::default();
    let section = |index: usize| PlateLayer {
        index,
        top_mm: HEIGHT_MM * (index + 1) as f64,
        height_mm: HEIGHT_MM,
        objects: vec![ObjectLayer {
            tool: None,
            style: None,
            share: None,
            is_first: true,
            object: 0,
            section: &sections[index],
            above: sections.get(index + 1).unwrap_or(&nothing),
            beneath: index.checked_sub(1).map(|below| &sections[below]),
            windows: shells.windows(index),
            windows_beneath: index.checked_sub(1).map(|below| shells.windows(below)).unwrap_or_default(),
        }],
    };
    let mut planner = Planner::new(settings.into(), &sections[0], HEIGHT_MM);
    let layers: Vec<PlateLayer<'_>> = (0..sections.len()).map(section).collect();
    prepare(&mut planner, &layers);
    layers.iter().map(|layer| planner.layer(layer)).collect()
}

pub fn of_role(layer: &LayerPaths, role: Role) -> Vec<&Path> {
    layer.paths.iter().filter(|p| p.role == role).collect()
}

pub fn length_mm(path: &Path) -> f64 {
    if path.closed {
        geometry::ring_length_mm(&path.points)
    } else {
        geometry::polyline_length_mm(&path.points)
    }
}

/// What a path covers beyond an X, beads lying side by side, in mm².
pub fn covers_beyond(path: &Path, x_mm: f64) -> f64 {
    let spacing_mm = |i: usize| {
        let width_mm = match &path.width {
            Width::Constant(width_mm) => *width_mm,
            Width::PerVertex(widths) => f64::from(widths[i]),
        };
        width_mm - path.height_mm * (1.0 - std::f64::consts::FRAC_PI_4)
    };
    let n = path.points.len();
    let edges = (0..if path.closed { n } else { n - 1 }).map(|i| (i, (i + 1) % n));
    let covered = edges.map(|(i, k)| {
        let [from_mm, to_mm] = [i, k].map(|v| path.points[v].mm()[0] - x_mm);
        let [less_mm, more_mm] = [from_mm.min(to_mm), from_mm.max(to_mm)];
        let share = match (less_mm, more_mm) {
            (0.0.., _) => 1.0,
            (_, ..=0.0) => 0.0,
            _ => more_mm / (more_mm - less_mm),
        };
        share * path.points[i].distance_mm(path.points[k]) * (spacing_mm(i) + spacing_mm(k)) / 2.0
    });
    covered.sum()
}
