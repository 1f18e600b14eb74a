//! A layer as SVG.

use std::fmt::Write;

use super::colors::hex;
use super::picture::{Picture, Shape};
use super::scene::{Layer, Scene};

/// Draws a layer to scale: one user unit is a millimetre. Shapes of one kind are grouped under a class named after it.
pub fn layer_svg(scene: &Scene, layer: &Layer) -> String {
    let Picture { frame: [left, bottom, width, height], background, shapes } = Picture::new(scene, layer);
    let mut out = String::new();
    let y = |y: f32| bottom + height - y;
    // Writing to a string does not fail.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.2} {height:.2}\" width=\"{width:.2}mm\" \
         height=\"{height:.2}mm\" role=\"img\">\n<title>Layer at {:.2} mm: {:.1} mm printed, {:.1} mm travelled</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n\
         <g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n",
        layer.z_mm,
        layer.measures.print_mm,
        layer.measures.travel_mm,
        hex(background)
    );
    let mut open: Option<String> = None;
    for shape in &shapes {
        let (label, style) = match shape {
            Shape::Line { label, color, width_mm, .. } => {
                (label, format!("stroke=\"{}\" stroke-width=\"{width_mm:.3}\"", hex(*color)))
            }
            Shape::Mark { label, color, rim_mm, .. } => (
                label,
                format!(
                    "fill=\"{}\" stroke=\"{}\" stroke-width=\"{rim_mm:.3}\" paint-order=\"stroke\"",
                    hex(*color),
                    hex(background)
                ),
            ),
        };
        if open.as_ref() != Some(&style) {
            let class = label.to_lowercase().replace(' ', "-");
            let end = if open.is_some() { "</g>\n" } else { "" };
            let _ = writeln!(out, "{end}<g class=\"{class}\" {style}>");
            open = Some(style);
        }
        let (points, end) = match shape {
            Shape::Line { points, .. } => (points, ""),
            Shape::Mark { points, .. } => (points, "Z"),
        };
        out += "<path d=\"M";
        for (i, point) in points.iter().enumerate() {
            let gap = if i > 0 { " " } else { "" };
            let _ = write!(out, "{gap}{:.2},{:.2}", point[0] - left, y(point[1]));
        }
        let _ = writeln!(out, "{end}\"/>");
    }
    out + if open.is_some() { "</g>\n</g>\n</svg>\n" } else { "</g>\n</svg>\n" }
}
