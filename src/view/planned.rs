//! Paths that are planned but not ordered yet, as a scene.

use geometry::real;

use super::colors;
use super::scene::{Layer, Scene, Stroke};
use crate::report::Measures;
use crate::toolpath::{Path, Width};

/// Planned paths of a layer.
#[derive(Clone, Debug)]
pub struct PlannedLayer<'a> {
    /// Height of the nozzle, millimetres.
    pub z_mm: f64,
    /// In any order.
    pub paths: Vec<&'a Path>,
}

impl Scene {
    /// What planned paths draw: beads without travel, speed and time.
    pub fn planned(layers: &[PlannedLayer<'_>]) -> Self {
        let mut scene = Self { layers: layers.iter().map(layer).collect(), ..Self::default() };
        scene.total.print_mm = scene.layers.iter().map(|layer| layer.measures.print_mm).sum();
        scene
    }
}

fn layer(planned: &PlannedLayer<'_>) -> Layer {
    let mut strokes = Vec::with_capacity(planned.paths.iter().map(|path| path.points.len()).sum());
    let z = planned.z_mm as f32;
    for path in &planned.paths {
        let (points, role) = (&path.points, colors::index(Some(path.role)));
        let at = |i: usize| {
            let [x, y] = points[i].mm();
            [x as f32, y as f32, z]
        };
        let edges = if path.closed { points.len() } else { points.len().saturating_sub(1) };
        for (from, to) in (0..edges).map(|i| (i, (i + 1) % points.len())) {
            let width_mm = match &path.width {
                Width::Constant(width_mm) => *width_mm as f32,
                Width::PerVertex(widths) => (widths[from] + widths[to]) / 2.0,
            };
            strokes.push(Stroke {
                tool: 0,
                from: at(from),
                to: at(to),
                role: Some(role),
                width_mm,
                height_mm: path.height_mm as f32,
                speed_mm_s: 0.0,
                flow_mm3_s: 0.0,
            });
        }
    }
    let length_mm = |stroke: &Stroke| {
        f64::from(real::hypot_f32(stroke.to[0] - stroke.from[0], stroke.to[1] - stroke.from[1]))
    };
    let print_mm = strokes.iter().map(length_mm).sum();
    let measures = Measures { print_mm, total_mm: print_mm, ..Measures::default() };
    Layer { z_mm: planned.z_mm, strokes, marks: Vec::new(), measures }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::{IslandId, Phase, Role};
    use geometry::Point;

    #[test]
    fn a_loop_returns_to_its_start_in_the_role_and_width_that_it_has() {
        let path = Path {
            role: Role::ExternalPerimeter,
            closed: true,
            points: [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)].map(|(x, y)| Point::from_mm(x, y)).to_vec(),
            width: Width::Constant(0.5),
            height_mm: 0.2,
            island: Some(IslandId(0)),
            phase: Phase::Wall(0),
            tool: None,
        };
        let scene = Scene::planned(&[PlannedLayer { z_mm: 0.4, paths: vec![&path] }]);
        let layer = &scene.layers[0];
        assert_eq!((layer.strokes.len(), layer.measures.print_mm), (3, 12.0));
        assert_eq!(layer.strokes[2].to, [0.0, 0.0, 0.4]);
        assert!(layer.strokes.iter().all(|stroke| stroke.role == Some(0) && stroke.width_mm == 0.5));
    }
}
