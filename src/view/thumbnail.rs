//! Small pictures of a print, drawn without display or GPU.

use std::ops::Range;

use geometry::real;
use tiny_skia::{Pixmap, PremultipliedColorU8};

use super::colors::{OTHER, ROLES, Rgb, SKIRT};
use super::scene::Scene;
use crate::observer::Observer;
use crate::parallel::{self, Workers};
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

/// Triangles drawn between two questions whether to go on: a millisecond or less.
const TRIANGLES: usize = 4096;

/// Triangles of one colour over shared corners.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Millimetres.
    pub corners: &'a [[f32; 3]],
    /// Indices of the corners of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// Red, green, blue.
    pub color: [u8; 3],
    /// Whether it encloses a body, corners counter-clockwise seen from outside: what faces away is then hidden.
    pub is_closed: bool,
}

/// Something with a surface.
pub trait Solid: Sync {
    /// Calls with every part of the surface, always in the same order.
    fn surfaces(&self, each: &mut dyn FnMut(Surface<'_>));

    /// Asked again and again while it is drawn; unwinds if the drawing is to end.
    fn go_on(&self) {}
}

impl Solid for Plate {
    fn surfaces(&self, each: &mut dyn FnMut(Surface<'_>)) {
        for object in &self.objects {
            let mesh = &self.meshes[object.mesh];
            let [x, y] = object.offset.mm();
            let corner = |&[vx, vy, vz]: &[f64; 3]| [(vx + x) as f32, (vy + y) as f32, vz as f32];
            each(Surface {
                corners: &mesh.vertices().iter().map(corner).collect::<Vec<_>>(),
                triangles: mesh.triangles(),
                color: ROLES[0].color,
                is_closed: mesh.is_oriented() && mesh.is_closed(),
            });
        }
    }
}

/// The triangles of a bead: its corners are those of the top, then those below them.
const BEAD: [[u32; 3]; 10] = [
    [0, 1, 2],
    [1, 3, 2],
    [0, 1, 4],
    [1, 5, 4],
    [2, 3, 6],
    [3, 7, 6],
    [0, 2, 4],
    [2, 6, 4],
    [1, 3, 5],
    [3, 7, 5],
];

/// Every bead is a box; what is no part of the object is left out.
impl Solid for Scene {
    fn surfaces(&self, each: &mut dyn FnMut(Surface<'_>)) {
        let strokes = || self.layers.iter().flat_map(|layer| &layer.strokes);
        let beside = |role: &u8| [SKIRT, OTHER].contains(role);
        // A file without roles is shown whole.
        let all = strokes().filter_map(|stroke| stroke.role).all(|role| beside(&role));
        for stroke in strokes() {
            let Some(role) = stroke.role.filter(|role| all || !beside(role)) else { continue };
            let delta = [stroke.to[0] - stroke.from[0], stroke.to[1] - stroke.from[1]];
            let scale = stroke.width_mm / 2.0 / real::hypot_f32(delta[0], delta[1]).max(f32::MIN_POSITIVE);
            let (along, side) = ([delta[0] * scale, delta[1] * scale], [-delta[1] * scale, delta[0] * scale]);
            let corner = |i: usize| {
                let (end, ahead) = if i & 1 == 0 { (stroke.from, -1.0) } else { (stroke.to, 1.0) };
                let aside = if i & 2 == 0 { -1.0 } else { 1.0 };
                let z = if i & 4 == 0 { end[2] } else { end[2] - stroke.height_mm };
                [end[0] + ahead * along[0] + aside * side[0], end[1] + ahead * along[1] + aside * side[1], z]
            };
            each(Surface {
                corners: &std::array::from_fn::<_, 8, _>(corner),
                triangles: &BEAD,
                color: ROLES[usize::from(role)].color,
                is_closed: false,
            });
        }
    }
}

/// Draws a picture of `width` × `height` pixels (at least 1, at most 2000 each) as PNG, the background transparent.
pub fn thumbnail(solid: &dyn Solid, size: [u32; 2]) -> Vec<u8> {
    picture(solid, size).encode_png().unwrap_or_default()
}

/// The pixels of a thumbnail.
pub(super) fn picture(solid: &dyn Solid, [width, height]: [u32; 2]) -> Pixmap {
    let [width, height] = [width.clamp(1, 2000), height.clamp(1, 2000)];
    let mut map = Pixmap::new(width, height).expect("a picture within these limits");
    let [width, height] = [width as usize, height as usize];
    if let Some(fit) = Fit::new(solid, (width * SAMPLES) as f32, (height * SAMPLES) as f32) {
        // Each thread draws some rows.
        let parts = parallel::threads().min(height);
        let workers = Workers { observer: &Observer::none() };
        let drawn = workers.map(parts, |part| {
            let [first, end] = [part, part + 1].map(|part| part * height / parts);
            drawn(solid, &fit, width, first..end)
        });
        for (pixel, drawn) in map.pixels_mut().iter_mut().zip(drawn.into_iter().flatten()) {
            *pixel = drawn;
        }
    }
    map
}

/// The pixels of some rows.
fn drawn(solid: &dyn Solid, fit: &Fit, width: usize, rows: Range<usize>) -> Vec<PremultipliedColorU8> {
    let mut canvas = Canvas::new(width * SAMPLES, rows.start * SAMPLES..rows.end * SAMPLES);
    let mut samples = Vec::new();
    solid.surfaces(&mut |surface| {
        samples.clear();
        samples.extend(surface.corners.iter().map(|&corner| fit.sample(corner)));
        for triangles in surface.triangles.chunks(TRIANGLES) {
            solid.go_on();
            for &[a, b, c] in triangles {
                let [a, b, c] = [a as usize, b as usize, c as usize];
                let corners = &surface.corners;
                let color = || shaded(&[corners[a], corners[b], corners[c]], surface.color);
                canvas.triangle(&[samples[a], samples[b], samples[c]], surface.is_closed, color);
            }
        }
    });
    (0..rows.len()).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| canvas.average(x, y)).collect()
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
        solid.surfaces(&mut |surface| {
            for &corner in surface.corners {
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
    fn sample(&self, point: [f32; 3]) -> [f32; 3] {
        [
            self.shift[0] + self.scale * dot(point, RIGHT),
            self.shift[1] - self.scale * dot(point, UP),
            dot(point, BACK),
        ]
    }
}

/// The samples of some rows, with their nearness.
struct Canvas {
    width: usize,
    rows: Range<usize>,
    near: Vec<f32>,
    color: Vec<Rgb>,
}

impl Canvas {
    fn new(width: usize, rows: Range<usize>) -> Self {
        let samples = width * rows.len();
        Self { width, rows, near: vec![f32::NEG_INFINITY; samples], color: vec![[0; 3]; samples] }
    }

    /// Draws a triangle where nothing nearer is, if it faces the eye or need not.
    fn triangle(&mut self, corners: &[[f32; 3]; 3], must_face: bool, color: impl Fn() -> Rgb) {
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Rows go downwards.
        if area == 0.0 || !area.is_finite() || (must_face && area > 0.0) {
            return;
        }
        let columns = samples_between([a[0], b[0], c[0]], 0..self.width);
        let rows = samples_between([a[1], b[1], c[1]], self.rows.clone());
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        // Most samples around a small triangle are outside, which needs no division; most triangles are hidden.
        let is_outside = |doubled: f32| if area > 0.0 { doubled < 0.0 } else { doubled > 0.0 };
        let mut light = None;
        for y in rows {
            let middle = y as f32 + 0.5;
            // Of a sliver's box hardly anything is inside.
            let columns =
                if columns.len() > FEW { in_row(corners, middle, &columns) } else { columns.clone() };
            let py = middle - a[1];
            let row = (y - self.rows.start) * self.width;
            let (first, end) = (row + columns.start, row + columns.end);
            let mut x = columns.start as f32 + 0.5;
            for (nearest, color_there) in self.near[first..end].iter_mut().zip(&mut self.color[first..end]) {
                let px = x - a[0];
                x += 1.0;
                let u = px * (c[1] - a[1]) - py * (c[0] - a[0]);
                let v = (b[0] - a[0]) * py - (b[1] - a[1]) * px;
                if is_outside(u) || is_outside(v) {
                    continue;
                }
                let (u, v) = (u / area, v / area);
                let near = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2]);
                if u + v <= 1.0 && near > *nearest {
                    *nearest = near;
                    *color_there = *light.get_or_insert_with(&color);
                }
            }
        }
    }

    /// The pixel that a square of samples gives; as opaque as it is covered.
    fn average(&self, x: usize, y: usize) -> PremultipliedColorU8 {
        let (mut sum, mut covered) = ([0_usize; 3], 0_usize);
        for dy in 0..SAMPLES {
            let first = (y * SAMPLES + dy) * self.width + x * SAMPLES;
            let samples = first..first + SAMPLES;
            for (&near, color) in self.near[samples.clone()].iter().zip(&self.color[samples]) {
                if near > f32::NEG_INFINITY {
                    covered += 1;
                    for i in 0..3 {
                        sum[i] += usize::from(color[i]);
                    }
                }
            }
        }
        if covered == 0 {
            return PremultipliedColorU8::TRANSPARENT;
        }
        let all = SAMPLES * SAMPLES;
        let [r, g, b] = sum.map(|sum| (sum / all) as u8);
        let alpha = (255 * covered / all) as u8;
        PremultipliedColorU8::from_rgba(r, g, b, alpha).unwrap_or(PremultipliedColorU8::TRANSPARENT)
    }
}

/// Columns that are not worth finding out which of them a triangle covers.
const FEW: usize = 8;

/// What the coordinates of samples are accurate to, and more.
const NOISE: f32 = 1e-3;

/// The columns that a triangle covers in a row with this middle, and one or a few more on either side.
fn in_row(corners: &[[f32; 3]; 3], middle: f32, columns: &Range<usize>) -> Range<usize> {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for k in 0..3 {
        let (p, q) = (corners[k], corners[if k == 2 { 0 } else { k + 1 }]);
        let (top, bottom) = (real::lesser(p[1], q[1]), real::greater(p[1], q[1]));
        if middle < top - NOISE || middle > bottom + NOISE {
            continue;
        }
        let (left, right) = (real::lesser(p[0], q[0]), real::greater(p[0], q[0]));
        let slope = (q[0] - p[0]) / (q[1] - p[1]);
        let at = p[0] + (middle - p[1]) * slope;
        let beyond = 1.0 + slope.abs() * NOISE;
        // Of a level edge nothing is known but its ends.
        let [from, to] = if beyond.is_finite() { [at - beyond, at + beyond] } else { [left, right] };
        low = real::lesser(real::greater(from, left - 1.0), low);
        high = real::greater(real::lesser(to, right + 1.0), high);
    }
    let (first, end) = (columns.start as f32, columns.end as f32);
    let first = real::lesser(real::greater(low, first), end) as usize;
    first..(real::lesser(high + 1.0, end) as usize).max(first)
}

/// The samples among some whose middles lie between the least and the greatest of some numbers.
#[inline(always)]
fn samples_between([a, b, c]: [f32; 3], among: Range<usize>) -> Range<usize> {
    let low = real::lesser(real::lesser(a, b), c);
    let high = real::greater(real::greater(a, b), c);
    let [first, end] = [among.start as f32, among.end as f32];
    real::greater((low - 0.5).ceil(), first) as usize
        ..real::lesser(real::greater((high - 0.5).floor() + 1.0, first), end) as usize
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

    /// A ring, whose outside can be seen; whether that is said.
    struct Ring(bool);

    impl Solid for Ring {
        fn surfaces(&self, each: &mut dyn FnMut(Surface<'_>)) {
            const SIDES: u32 = 60;
            let angle = |i: u32| i as f32 / SIDES as f32 * std::f32::consts::TAU;
            let corner = |i: u32| {
                let [around, across] = [angle(i / SIDES), angle(i % SIDES)];
                let radius = 20.0 + 8.0 * across.cos();
                [radius * around.cos(), radius * around.sin(), 8.0 * across.sin()]
            };
            let at = |i: u32, j: u32| i % SIDES * SIDES + j % SIDES;
            let triangles = |i: u32, j: u32| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            };
            each(Surface {
                corners: &(0..SIDES * SIDES).map(corner).collect::<Vec<_>>(),
                triangles: &(0..SIDES * SIDES)
                    .flat_map(|i| triangles(i / SIDES, i % SIDES))
                    .collect::<Vec<_>>(),
                color: [200; 3],
                is_closed: self.0,
            });
        }
    }

    #[test]
    fn what_faces_away_of_a_closed_body_is_not_seen() {
        let [closed, whole] = [true, false].map(|is_closed| picture(&Ring(is_closed), [90, 60]));
        let pairs = || closed.pixels().iter().zip(whole.pixels());
        assert!(pairs().filter(|(_, whole)| whole.alpha() > 0).count() > 1000);
        // At its rim a sample may be of either side.
        assert!(pairs().filter(|(closed, whole)| closed != whole).count() < 10);
    }

    #[test]
    fn no_sample_of_a_triangle_is_left_out_of_its_rows() {
        let mut random = geometry::Random::new(1);
        let mut samples = 0;
        for round in 0..3000 {
            let mut number = |below: u32| random.below(below * 1000) as f32 / 1000.0;
            let from = [number(100), number(100)];
            // Slivers in all directions, level and upright ones among them.
            let (along, across) = ([number(200) - 100.0, number(200) - 100.0], number(2));
            let along =
                [if round % 5 == 0 { 0.0 } else { along[0] }, if round % 7 == 0 { 0.0 } else { along[1] }];
            let beside = [from[0] + along[0] / 3.0 + across, from[1] + along[1] / 2.0 - across];
            let corners = [from, [from[0] + along[0], from[1] + along[1]], beside].map(|[x, y]| [x, y, 0.0]);
            let [a, b, c] = corners.map(|corner| corner.map(f64::from));
            let side = |p: [f64; 3], q: [f64; 3], x: f64, y: f64| {
                (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            };
            for y in 0..100 {
                let columns = in_row(&corners, y as f32 + 0.5, &(0..100));
                for x in 0..100 {
                    let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                    let sides = [side(a, b, px, py), side(b, c, px, py), side(c, a, px, py)];
                    let is_inside =
                        sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0);
                    samples += usize::from(is_inside);
                    assert!(!is_inside || columns.contains(&x), "{corners:?}: {x} {y} not in {columns:?}");
                }
            }
        }
        assert!(samples > 10_000, "{samples}");
    }

    #[test]
    fn several_threads_draw_the_same_picture() {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let [alone, together] = [None, Some(threads)].map(|threads| {
            let draw = || picture(&Ring(false), [64, 40]);
            threads.map_or_else(draw, |threads| threads.install(draw))
        });
        assert_eq!(alone.data(), together.data());
    }

    #[test]
    fn nothing_gives_an_empty_picture() {
        let map = Pixmap::decode_png(&thumbnail(&Scene::default(), [8, 8])).unwrap();
        assert!(map.pixels().iter().all(|pixel| pixel.alpha() == 0));
    }
}
