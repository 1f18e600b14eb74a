//! A layer as PNG.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke as Pen, Transform,
};

use super::colors::Rgb;
use super::picture::{Picture, Shape};
use super::scene::{Layer, Scene};

/// Draws a layer, its longer side `side` pixels long (at least 1, at most 2000).
pub fn layer_png(scene: &Scene, layer: &Layer, side: u32) -> Vec<u8> {
    let Picture { frame: [left, bottom, width, height], background, shapes } = Picture::new(scene, layer);
    let scale = side.clamp(1, 2000) as f32 / width.max(height);
    let pixels = |mm: f32| ((mm * scale).round() as u32).max(1);
    // A picture within these limits can always be made.
    let Some(mut map) = Pixmap::new(pixels(width), pixels(height)) else { return Vec::new() };
    let [r, g, b] = background;
    map.fill(Color::from_rgba8(r, g, b, 255));
    let to_pixels = Transform::from_row(scale, 0.0, 0.0, -scale, -left * scale, (bottom + height) * scale);
    for shape in &shapes {
        match shape {
            Shape::Line { color, width_mm, points, .. } => {
                let pen = Pen {
                    width: *width_mm,
                    line_cap: LineCap::Round,
                    line_join: LineJoin::Round,
                    ..Pen::default()
                };
                if let Some(path) = polyline(points, false) {
                    map.stroke_path(&path, &paint(*color), &pen, to_pixels, None);
                }
            }
            Shape::Mark { color, rim_mm, points, .. } => {
                let pen = Pen { width: *rim_mm, ..Pen::default() };
                if let Some(path) = polyline(points, true) {
                    map.stroke_path(&path, &paint(background), &pen, to_pixels, None);
                    map.fill_path(&path, &paint(*color), FillRule::Winding, to_pixels, None);
                }
            }
        }
    }
    map.encode_png().unwrap_or_default()
}

fn paint(color: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b] = color;
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

/// `None` of what has no extent.
fn polyline(points: &[[f32; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, point) in points.iter().enumerate() {
        match i {
            0 => builder.move_to(point[0], point[1]),
            _ => builder.line_to(point[0], point[1]),
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}
