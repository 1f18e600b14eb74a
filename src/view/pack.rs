//! A scene in few bytes, for the page.
//!
//! Numbers are whole multiples of a unit, written as LEB128 varints; those that can be negative are zigzag-coded first,
//! positions are differences. A stroke begins where the one before ended, so only its end is written; the nozzle's
//! jumps (homing, G92) are strokes of their own. What a stroke has in common with the one before is left out. The page's
//! `unpack.js` reads it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::deflate::compress_to_vec_zlib;

use super::scene::{Layer, MarkKind, Scene, Stroke};

/// Units: positions, widths and heights, lengths and volumes of layers (mm, mm³); cross-sections (mm²); speeds (mm/s).
const POSITION: f64 = 0.005;
const BEAD_MM: f64 = 0.01;
const LENGTH: f64 = 0.01;
const SECTION_MM2: f64 = 0.002;
const SPEED_MM_S: f64 = 0.1;
const SECONDS: f64 = 0.001;

/// Low half of the byte that begins an entry, where it is no role: travel, a jump, a mark.
const TRAVEL: u8 = 13;
const JUMP: u8 = 14;
const MARK: u8 = 15;
/// A mark of this kind says which tool draws what follows.
const TOOL: u8 = 3;
/// High half: what has changed. A mark has its kind there.
const Z: u8 = 1 << 4;
const BEAD: u8 = 1 << 5;
const SECTION: u8 = 1 << 6;
const SPEED: u8 = 1 << 7;

/// How hard is compressed: beyond this little is won.
const LEVEL: u8 = 7;

/// A packed scene.
pub(super) struct Packed {
    pub bytes: Vec<u8>,
    /// Strokes in it, with jumps.
    pub strokes: usize,
    /// Marks in it.
    pub marks: usize,
}

impl Packed {
    /// Deflated (RFC 1950), in base64.
    pub fn base64(&self) -> String {
        STANDARD.encode(compress_to_vec_zlib(&self.bytes, LEVEL))
    }
}

/// Packs a scene.
pub(super) fn pack(scene: &Scene) -> Packed {
    let mut packer = Packer::default();
    for layer in &scene.layers {
        packer.layer(layer);
    }
    let Packer { out, strokes, marks, .. } = packer;
    Packed { bytes: out, strokes, marks }
}

#[derive(Default)]
struct Packer {
    out: Vec<u8>,
    strokes: usize,
    marks: usize,
    z: i64,
    at: [i64; 3],
    bead: [u64; 2],
    section: u64,
    speed: u64,
    tool: u8,
}

impl Packer {
    fn layer(&mut self, layer: &Layer) {
        let measures = &layer.measures;
        let z = ticks(layer.z_mm, POSITION);
        self.signed(z - self.z);
        self.z = z;
        self.amount(measures.total_s, SECONDS);
        for value in [measures.print_mm, measures.travel_mm, measures.link_mm, measures.volume_mm3] {
            self.amount(value, LENGTH);
        }
        self.unsigned(measures.travels as u64);
        self.unsigned(measures.retractions as u64);
        self.unsigned(measures.bound_mm.map_or(0, |bound_mm| 1 + count(bound_mm, LENGTH)));

        // The number of entries is known when they are written.
        let head = std::mem::take(&mut self.out);
        let mut entries = 0;
        let mut marks = layer.marks.iter().peekable();
        for (index, stroke) in layer.strokes.iter().enumerate() {
            while let Some(mark) = marks.next_if(|mark| mark.before as usize <= index) {
                entries += self.jump(mark.at) + self.mark(mark.kind);
            }
            entries += self.tool(stroke.tool) + self.jump(stroke.from) + self.stroke(stroke);
        }
        for mark in marks {
            entries += self.jump(mark.at) + self.mark(mark.kind);
        }
        let body = std::mem::replace(&mut self.out, head);
        self.unsigned(entries);
        self.out.extend_from_slice(&body);
    }

    /// Each of these writes at most one entry and says how many it wrote.
    fn mark(&mut self, kind: MarkKind) -> u64 {
        self.out.push(MARK | (kind as u8) << 4);
        self.marks += 1;
        1
    }

    fn tool(&mut self, tool: u8) -> u64 {
        if tool == self.tool {
            return 0;
        }
        self.tool = tool;
        self.out.push(MARK | TOOL << 4);
        self.unsigned(tool.into());
        1
    }

    fn jump(&mut self, to: [f32; 3]) -> u64 {
        if to.map(|mm| ticks(mm.into(), POSITION)) == self.at {
            return 0;
        }
        self.out.push(JUMP | Z);
        self.go(to, true);
        self.strokes += 1;
        1
    }

    fn stroke(&mut self, stroke: &Stroke) -> u64 {
        let bead = [stroke.width_mm, stroke.height_mm].map(|mm| count(mm.into(), BEAD_MM));
        let section_mm2 = f64::from(stroke.flow_mm3_s) / f64::from(stroke.speed_mm_s).max(1e-3);
        let section = count(section_mm2, SECTION_MM2);
        let speed = count(stroke.speed_mm_s.into(), SPEED_MM_S);
        let lifted = ticks(stroke.to[2].into(), POSITION) != self.at[2];
        let extrudes = stroke.role.is_some();
        let changed = [
            (lifted, Z),
            (extrudes && bead != self.bead, BEAD),
            (extrudes && section != self.section, SECTION),
            (speed != self.speed, SPEED),
        ];
        let flags = changed.iter().filter(|c| c.0).fold(0, |flags, c| flags | c.1);
        self.out.push(stroke.role.unwrap_or(TRAVEL) | flags);
        self.go(stroke.to, lifted);
        if flags & BEAD != 0 {
            for ticks in bead {
                self.unsigned(ticks);
            }
            self.bead = bead;
        }
        if flags & SECTION != 0 {
            self.unsigned(section);
            self.section = section;
        }
        if flags & SPEED != 0 {
            self.unsigned(speed);
            self.speed = speed;
        }
        self.strokes += 1;
        1
    }

    fn go(&mut self, to: [f32; 3], lifted: bool) {
        let to = to.map(|mm| ticks(mm.into(), POSITION));
        let axes = if lifted { 3 } else { 2 };
        for (axis, &tick) in to.iter().enumerate().take(axes) {
            self.signed(tick - self.at[axis]);
            self.at[axis] = tick;
        }
    }

    fn amount(&mut self, value: f64, unit: f64) {
        self.unsigned(count(value, unit));
    }

    fn signed(&mut self, value: i64) {
        self.unsigned(((value << 1) ^ (value >> 63)) as u64);
    }

    fn unsigned(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.out.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.out.push(value as u8);
    }
}

fn ticks(value: f64, unit: f64) -> i64 {
    (value / unit).round() as i64
}

/// Never negative, and no more than a 32-bit number can hold, since scripts count with these.
fn count(value: f64, unit: f64) -> u64 {
    ticks(value, unit).clamp(0, u32::MAX.into()) as u64
}
