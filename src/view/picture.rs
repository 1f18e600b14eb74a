//! A layer as shapes in the plane, in the order in which they are painted. SVG and PNG draw the same.

use super::colors::{LIGHT, ROLES, Rgb, TOOLS};
use super::scene::{Layer, MarkKind, Scene};

/// Room around the print, as a share of its larger side.
const MARGIN: f32 = 0.04;

/// Something to paint. Millimetres, Y upwards.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// A line with round ends and corners. `label`: what it shows.
    Line { label: &'static str, color: Rgb, width_mm: f32, points: Vec<[f32; 2]> },
    /// A small filled shape, with a rim that sets it off.
    Mark { label: &'static str, color: Rgb, rim_mm: f32, points: Vec<[f32; 2]> },
}

/// A layer to paint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    /// Left, bottom, width and height.
    pub frame: [f32; 4],
    pub background: Rgb,
    pub shapes: Vec<Shape>,
}

impl Picture {
    /// Beads first, in the order in which they are printed, then travel, then marks. All layers of a scene get the same
    /// frame.
    pub fn new(scene: &Scene, layer: &Layer) -> Self {
        let [low, high] = scene.bounds().unwrap_or([[0.0; 2], [1.0; 2]]);
        let side = (high[0] - low[0]).max(high[1] - low[1]).max(1.0);
        let margin = side * MARGIN;
        let frame = [
            low[0] - margin,
            low[1] - margin,
            high[0] - low[0] + 2.0 * margin,
            high[1] - low[1] + 2.0 * margin,
        ];
        // Thin, but still seen where the print is large.
        let travel_mm = (side / 450.0).clamp(0.08, 1.0);
        let mut shapes = beads(layer, scene.by_tool);
        shapes.extend(travels(layer, travel_mm));
        for kind in [MarkKind::Seam, MarkKind::Unretraction, MarkKind::Retraction] {
            let marks = layer.marks.iter().filter(|mark| mark.kind == kind);
            shapes.extend(marks.map(|mark| sign(kind, [mark.at[0], mark.at[1]], 3.0 * travel_mm)));
        }
        Self { frame, background: LIGHT.background, shapes }
    }
}

/// The sign of a mark, as in the page: retraction ▼ and unretraction ▲ touch the point with their tip, seam ◆.
fn sign(kind: MarkKind, at: [f32; 2], size_mm: f32) -> Shape {
    let (label, color, corners) = match kind {
        MarkKind::Retraction => ("Retraction", LIGHT.retraction, &[[-0.8, 1.5], [0.8, 1.5], [0.0, 0.0]][..]),
        MarkKind::Unretraction => {
            ("Un-retraction", LIGHT.unretraction, &[[-0.8, -1.5], [0.8, -1.5], [0.0, 0.0]][..])
        }
        MarkKind::Seam => ("Seam", LIGHT.seam, &[[-0.7, 0.0], [0.0, 0.7], [0.7, 0.0], [0.0, -0.7]][..]),
    };
    let points = corners.iter().map(|[x, y]| [at[0] + x * size_mm, at[1] + y * size_mm]).collect();
    Shape::Mark { label, color, rim_mm: 0.25 * size_mm, points }
}

fn beads(layer: &Layer, by_tool: bool) -> Vec<Shape> {
    let mut shapes = Vec::new();
    for stroke in &layer.strokes {
        let Some(role) = stroke.role.and_then(|role| ROLES.get(usize::from(role))) else { continue };
        let width_mm = (stroke.width_mm * 1000.0).round() / 1000.0;
        let (label, color) = match by_tool {
            true => TOOLS[usize::from(stroke.tool) % TOOLS.len()],
            false => (role.label, role.color),
        };
        extend(&mut shapes, stroke.from, stroke.to, (label, color, width_mm));
    }
    shapes
}

fn travels(layer: &Layer, width_mm: f32) -> Vec<Shape> {
    // The path to the first bead belongs to the start script.
    let first = layer.strokes.iter().position(|s| s.role.is_some()).unwrap_or(0);
    let mut shapes = Vec::new();
    for stroke in layer.strokes[first..].iter().filter(|s| s.role.is_none()) {
        extend(&mut shapes, stroke.from, stroke.to, ("Travel", LIGHT.travel, width_mm));
    }
    shapes
}

/// Adds a stroke to the last line if it continues there.
fn extend(shapes: &mut Vec<Shape>, from: [f32; 3], to: [f32; 3], look: (&'static str, Rgb, f32)) {
    let (from, to) = ([from[0], from[1]], [to[0], to[1]]);
    if let Some(Shape::Line { label, width_mm, points, .. }) = shapes.last_mut()
        && (*label, *width_mm) == (look.0, look.2)
        && points.last() == Some(&from)
    {
        points.push(to);
        return;
    }
    shapes.push(Shape::Line { label: look.0, color: look.1, width_mm: look.2, points: vec![from, to] });
}
