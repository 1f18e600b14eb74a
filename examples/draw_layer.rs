//! Draws one layer of a G-code file: beads by role, travels red, retracted ones dashed.
//!
//!     cargo run --release --example draw_layer -- FILE.gcode LAYER OUT.png

use pathwright::gcode::{Action, annotate};
use pathwright::toolpath::Role;
use tiny_skia::{Color, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

/// Pixels for a millimetre, and around the drawing.
const SCALE: f64 = 12.0;
const MARGIN: f64 = 20.0;

/// A straight piece of the nozzle's path.
struct Piece {
    from: [f64; 2],
    to: [f64; 2],
    role: Option<Role>,
    extrudes: bool,
    retracted: bool,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, layer, out] = arguments.as_slice() else {
        eprintln!("FILE.gcode LAYER OUT.png");
        std::process::exit(2);
    };
    let text = std::fs::read(file).expect("a readable file");
    let layer: usize = layer.parse().expect("a layer's index");
    let pieces = pieces(&text, layer);
    draw(&pieces).save_png(out).expect("a writable file");
    let travel_mm: f64 = pieces.iter().filter(|p| !p.extrudes).map(length).sum();
    println!("{} strokes, {travel_mm:.1} mm of travel", pieces.len());
}

fn length(piece: &Piece) -> f64 {
    (piece.to[0] - piece.from[0]).hypot(piece.to[1] - piece.from[1])
}

fn pieces(text: &[u8], layer: usize) -> Vec<Piece> {
    let (mut pieces, mut pulled) = (Vec::new(), 0.0);
    for read in annotate(text) {
        match read.action {
            Action::Stroke(stroke) => {
                pulled -= stroke.e_mm - stroke.fresh_mm;
                if read.context.layer == Some(layer) && stroke.xy_mm > 0.0 {
                    pieces.push(Piece {
                        from: [stroke.from[0], stroke.from[1]],
                        to: [stroke.to[0], stroke.to[1]],
                        role: read.context.role,
                        extrudes: stroke.extrudes(),
                        retracted: pulled > 1e-6,
                    });
                }
            }
            Action::FirmwareRetract => pulled = 1.0,
            Action::FirmwareUnretract => pulled = 0.0,
            _ => {}
        }
    }
    pieces
}

fn draw(pieces: &[Piece]) -> Pixmap {
    let beads = || pieces.iter().filter(|p| p.extrudes).flat_map(|p| [p.from, p.to]);
    let low = [0, 1].map(|i| beads().map(|p| p[i]).fold(f64::INFINITY, f64::min));
    let high = [0, 1].map(|i| beads().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max));
    let size = [0, 1].map(|i| ((high[i] - low[i]) * SCALE + 2.0 * MARGIN).clamp(1.0, 8000.0) as u32);
    let mut image = Pixmap::new(size[0], size[1]).expect("a size");
    image.fill(Color::WHITE);
    for (travels, piece) in [false, true].into_iter().flat_map(|t| pieces.iter().map(move |p| (t, p))) {
        if travels == piece.extrudes {
            continue;
        }
        let place = |p: [f64; 2]| {
            (((p[0] - low[0]) * SCALE + MARGIN) as f32, ((high[1] - p[1]) * SCALE + MARGIN) as f32)
        };
        let mut path = PathBuilder::new();
        let ((x0, y0), (x1, y1)) = (place(piece.from), place(piece.to));
        path.move_to(x0, y0);
        path.line_to(x1, y1);
        let Some(path) = path.finish() else { continue };
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        let [r, g, b] = colour(piece);
        paint.set_color_rgba8(r, g, b, 255);
        let width = if piece.extrudes { 3.0 } else { 1.2 };
        let dash = if piece.retracted { StrokeDash::new(vec![6.0, 4.0], 0.0) } else { None };
        let stroke = Stroke { width, dash, ..Stroke::default() };
        image.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
    }
    image
}

fn colour(piece: &Piece) -> [u8; 3] {
    match piece.role {
        _ if !piece.extrudes => [220, 0, 0],
        Some(Role::ExternalPerimeter | Role::OverhangPerimeter) => [20, 60, 140],
        Some(Role::Perimeter) => [90, 140, 220],
        Some(Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface) => [150, 150, 150],
        _ => [170, 200, 150],
    }
}
