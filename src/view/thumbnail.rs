//! Small pictures of a print, drawn without display or GPU.

use geometry::real;
use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::colors::{OTHER, ROLES, Rgb, SKIRT};
use super::scene::Scene;
use crate::plate::Plate;

/// The picture looks from the front left, 34° to the side and 34° from above: unit vectors to the right, up, and
/// towards the eye.
const RIGHT: [f32; 3] = [0.829_04, -0.559_19, 0.0];
const UP: [f32; 3] = [0.312_69, 0.463_58, 0.829_04];
const BACK: [f32; 3] = [-0.463_58, -0.687_29, 0.559_19];
/// Directions of the light, and its strength; some comes from everywhere.
const LIGHTS: [([f32; 3], f32); 2] = [([-0.454, 0.656, 0.605], 0.6), ([0.862, 0.123, 0.492], 0.2)];
const AMBIENT: f32 = 0.5;
/// Samples along each side of a pixel.
const SAMPLES: usize = 3;
/// Room left free at each side, as a share.
const MARGIN: f32 = 0.03;

/// Something with a surface.
pub trait Solid {
    /// Calls with every triangle and its colour, always in the same order. Millimetres.
    fn facets(&self, each: &mut dyn FnMut([[f32; 3]; 3], [u8; 3]));
}

impl Solid for Plate {
    fn facets(&self, each: &mut dyn FnMut([[f32; 3]; 3], Rgb)) {
        for object in &self.objects {
            let mesh = &self.meshes[object.mesh];
            let [x, y] = object.offset.mm();
            for triangle in mesh.triangles() {
                let corner = |vertex: u32| {
                    let [vx, vy, vz] = mesh.vertices()[vertex as usize];
                    [(vx + x) as f32, (vy + y) as f32, vz as f32]
                };
                each(triangle.map(corner), ROLES[0].color);
            }
        }
    }
}

/// Every bead is a box; what is no part of the object is left out.
impl Solid for Scene {
    fn facets(&self, each: &mut dyn FnMut([[f32; 3]; 3], Rgb)) {
        let strokes = || self.layers.iter().flat_map(|layer| &layer.strokes);
        let beside = |role: &u8| [SKIRT, OTHER].contains(role);
        // A file without roles is shown whole.
        let all = strokes().filter_map(|stroke| stroke.role).all(|role| beside(&role));
        for stroke in strokes() {
            let Some(role) = stroke.role.filter(|role| all || !beside(role)) else { continue };
            let delta = [stroke.to[0] - stroke.from[0], stroke.to[1] - stroke.from[1]];
            let scale = stroke.width_mm / 2.0 / real::hypot_f32(delta[0], delta[1]).max(f32::MIN_POSITIVE);
            let (along, side) = ([delta[0] * scale, delta[1] * scale], [-delta[1] * scale, delta[0] * scale]);
            // Corners of the top, then those below them.
            let corner = |i: usize| {
                let (end, ahead) = if i & 1 == 0 { (stroke.from, -1.0) } else { (stroke.to, 1.0) };
                let aside = if i & 2 == 0 { -1.0 } else { 1.0 };
                let z = if i & 4 == 0 { end[2] } else { end[2] - stroke.height_mm };
                [end[0] + ahead * along[0] + aside * side[0], end[1] + ahead * along[1] + aside * side[1], z]
            };
            for [a, b, c, d] in [[0, 1, 2, 3], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]] {
                for facet in [[a, b, c], [b, d, c]] {
                    each(facet.map(corner), ROLES[usize::from(role)].color);
                }
            }
        }
    }
}

/// Draws a picture of `width` × `height` pixels (at least 1, at most 2000 each) as PNG, the background transparent.
pub fn thumbnail(solid: &dyn Solid, size: [u32; 2]) -> Vec<u8> {
    picture(solid, size).encode_png().unwrap_or_default()
}

/// The pixels of a thumbnail.
pub(super) fn picture(solid: &dyn Solid, [width, height]: [u32; 2]) -> Pixmap {
    let (width, height) = (width.clamp(1, 2000), height.clamp(1, 2000));
    let mut canvas = Canvas::new(width as usize * SAMPLES, height as usize * SAMPLES);
    if let Some(fit) = Fit::new(solid, canvas.width as f32, canvas.height as f32) {
        solid.facets(&mut |corners, color| {
            canvas.facet(&corners.map(|corner| fit.pixel(corner)), &corners, color)
        });
    }
    let mut map = Pixmap::new(width, height).expect("a picture within these limits");
    for (index, pixel) in map.pixels_mut().iter_mut().enumerate() {
        *pixel = canvas.average(index % width as usize, index / width as usize);
    }
    map
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// From millimetres to samples, so that all of it is seen.
struct Fit {
    scale: f32,
    shift: [f32; 2],
}

impl Fit {
    /// The picture; `None` if nothing is visible.
    fn new(solid: &dyn Solid, width: f32, height: f32) -> Option<Self> {
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        solid.facets(&mut |corners, _| {
            for corner in corners {
                for (i, axis) in [RIGHT, UP].into_iter().enumerate() {
                    let at = dot(corner, axis);
                    low[i] = real::lesser(at, low[i]);
                    high[i] = real::greater(at, high[i]);
                }
            }
        });
        let size = [high[0] - low[0], high[1] - low[1]];
        if !size.iter().all(|mm| mm.is_finite()) {
            return None;
        }
        let inner = 1.0 - 2.0 * MARGIN;
        let scale = (width * inner / size[0].max(1e-3)).min(height * inner / size[1].max(1e-3));
        let shift =
            [width / 2.0 - scale * (low[0] + size[0] / 2.0), height / 2.0 + scale * (low[1] + size[1] / 2.0)];
        Some(Self { scale, shift })
    }

    /// Sample to the right, sample downwards, nearness.
    fn pixel(&self, point: [f32; 3]) -> [f32; 3] {
        [
            self.shift[0] + self.scale * dot(point, RIGHT),
            self.shift[1] - self.scale * dot(point, UP),
            dot(point, BACK),
        ]
    }
}

/// Samples with their nearness.
struct Canvas {
    width: usize,
    height: usize,
    near: Vec<f32>,
    color: Vec<Rgb>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        let samples = width * height;
        Self { width, height, near: vec![f32::NEG_INFINITY; samples], color: vec![[0; 3]; samples] }
    }

    /// Draws a triangle where nothing nearer is.
    fn facet(&mut self, [a, b, c]: &[[f32; 3]; 3], corners: &[[f32; 3]; 3], color: Rgb) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let span = |axis: usize, limit: usize| {
            let low = real::lesser(real::lesser(a[axis], b[axis]), c[axis]);
            let high = real::greater(real::greater(a[axis], b[axis]), c[axis]);
            (low - 0.5).ceil().max(0.0) as usize
                ..((high - 0.5).floor() + 1.0).clamp(0.0, limit as f32) as usize
        };
        let (columns, rows) = (span(0, self.width), span(1, self.height));
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        // Most samples around a small triangle are outside, which needs no division; most triangles are hidden.
        let outside = |doubled: f32| doubled != 0.0 && (doubled > 0.0) != (area > 0.0);
        let mut light = None;
        for y in rows {
            for x in columns.clone() {
                let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
                let u = (px - a[0]) * (c[1] - a[1]) - (py - a[1]) * (c[0] - a[0]);
                let v = (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]);
                if outside(u) || outside(v) {
                    continue;
                }
                let (u, v) = (u / area, v / area);
                let near = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
                let index = y * self.width + x;
                if u + v <= 1.0 && near > self.near[index] {
                    self.near[index] = near;
                    self.color[index] = *light.get_or_insert_with(|| shaded(corners, color));
                }
            }
        }
    }

    /// The pixel that a square of samples gives; as opaque as it is covered.
    fn average(&self, x: usize, y: usize) -> PremultipliedColorU8 {
        let (mut sum, mut covered) = ([0_usize; 3], 0_usize);
        for dy in 0..SAMPLES {
            for dx in 0..SAMPLES {
                let index = (y * SAMPLES + dy) * self.width + x * SAMPLES + dx;
                if self.near[index] > f32::NEG_INFINITY {
                    covered += 1;
                    for (sum, channel) in sum.iter_mut().zip(self.color[index]) {
                        *sum += usize::from(channel);
                    }
                }
            }
        }
        let all = SAMPLES * SAMPLES;
        let [r, g, b] = sum.map(|sum| (sum / all) as u8);
        let alpha = (255 * covered / all) as u8;
        PremultipliedColorU8::from_rgba(r, g, b, alpha).unwrap_or(PremultipliedColorU8::TRANSPARENT)
    }
}

/// The colour of a facet in the light, whichever side of it is seen.
fn shaded([a, b, c]: &[[f32; 3]; 3], color: Rgb) -> Rgb {
    let edge = |to: &[f32; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]];
    let (u, v) = (edge(b), edge(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let facing = dot(normal, BACK).signum() / dot(normal, normal).sqrt().max(f32::MIN_POSITIVE);
    let seen = [RIGHT, UP, BACK].map(|axis| dot(normal, axis) * facing);
    let light =
        LIGHTS.iter().fold(AMBIENT, |sum, (from, strength)| sum + strength * dot(seen, *from).max(0.0));
    color.map(|channel| (f32::from(channel) * light).min(255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Settings;

    fn scene() -> Scene {
        let text = b"M83\n;TYPE:Perimeter\nG1 X50 Y50 Z.2 F600\nG1 X60 E1\nG1 Y60 E1\nG1 X50 E1\nG1 Y50 E1";
        Scene::read(text, &Settings::default())
    }

    #[test]
    fn a_thumbnail_shows_the_print_on_nothing() {
        let map = Pixmap::decode_png(&thumbnail(&scene(), [64, 32])).unwrap();
        assert_eq!((map.width(), map.height()), (64, 32));
        let seen = map.pixels().iter().filter(|pixel| pixel.alpha() > 0).count();
        assert!((100..1500).contains(&seen), "{seen}");
        assert_eq!(map.pixels()[0].alpha(), 0);
    }

    #[test]
    fn nothing_gives_an_empty_picture() {
        let map = Pixmap::decode_png(&thumbnail(&Scene::default(), [8, 8])).unwrap();
        assert!(map.pixels().iter().all(|pixel| pixel.alpha() == 0));
    }
}
