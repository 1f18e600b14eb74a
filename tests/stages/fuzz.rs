//! The functions of the fuzz targets on random and damaged input, without a fuzzer; cases that once failed are kept.
//!
//! `PATHWRIGHT_FUZZ_SECONDS=600 cargo test --profile quick --test stages -- --ignored fuzz::NAME` continues for longer.

use crate::support::cases;
use std::time::{Duration, Instant};

/// Deterministic random numbers: splitmix64 (Steele, Lea & Flood 2014, <https://doi.org/10.1145/2660193.2660195>).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn bytes(&mut self, most: usize) -> Vec<u8> {
        (0..self.below(most)).map(|_| self.next() as u8).collect()
    }

    /// Bytes replaced, removed, repeated, or exchanged for words that matter.
    fn damaged(&mut self, seed: &[u8], words: &[&str]) -> Vec<u8> {
        let mut bytes = seed.to_vec();
        for _ in 0..1 + self.below(8) {
            let at = self.below(bytes.len() + 1);
            let end = (at + self.below(24)).min(bytes.len());
            match self.below(5) {
                0 if at < bytes.len() => bytes[at] = self.next() as u8,
                1 => drop(bytes.drain(at..end)),
                2 => {
                    let part = bytes[at..end].to_vec();
                    bytes.splice(at..at, part);
                }
                3 => {
                    let word = words[self.below(words.len())];
                    drop(bytes.splice(at..end, word.bytes()));
                }
                _ if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
                _ => {}
            }
        }
        bytes
    }
}

/// A number from the environment.
fn variable(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Runs so many cases, the same for a seed on every machine, or continues for as long as the environment says. A case that
/// panics is printed.
fn run(cases: Option<u64>, mut make: impl FnMut(&mut Random) -> Vec<u8>, case: fn(&[u8])) {
    let time = Duration::from_secs(variable("PATHWRIGHT_FUZZ_SECONDS").unwrap_or(60));
    let seed = match cases {
        Some(_) => variable("PROPTEST_RNG_SEED").unwrap_or(1),
        None => std::process::id().into(),
    };
    let (begin, mut random, mut count) = (Instant::now(), Random(seed), 0_u64);
    let mut slowest = (Duration::ZERO, 0);
    while cases.map_or(begin.elapsed() < time, |cases| count < cases) {
        let bytes = make(&mut random);
        let begun = Instant::now();
        if std::panic::catch_unwind(|| case(&bytes)).is_err() {
            panic!("case {count}: {}", hex(&bytes));
        }
        slowest = slowest.max((begun.elapsed(), bytes.len()));
        count += 1;
    }
    println!("{count} cases, the slowest {:.3} s with {} bytes", slowest.0.as_secs_f64(), slowest.1);
    assert!(slowest.0 < Duration::from_secs(60), "a case takes {:?}", slowest.0);
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

const GCODE: &str = "M104 S210\nG28\nM109 S210\nG21\nG90\nM83\n;LAYER:0\n;TYPE:WALL-OUTER\nG1 Z.2 F600\n\
    G1 X10 Y10 F9000\nG1 X20.125 Y10 E.3 F1200\nG2 X30 Y20 I5 J5 E1\nG1 E-1 F2400\nG1 X5 Y5\nG1 E1\n\
    G10\nG11\nG92 E0 X3\nG91\nG1 X-1 E.1\nM220 S50\nT1\nM82\nG20\nSET_VELOCITY_LIMIT ACCEL=3000\nM84\n";
const GCODE_WORDS: &[&str] = &[
    "G1 ",
    "G2 ",
    "G92",
    "G28 X",
    "X1e7",
    "nan",
    "inf",
    "E-99999999999",
    "\n",
    ";LAYER:1\n",
    "F0",
    "G20\n",
    "M82\n",
    "R-1",
    "I0 J0",
    "99999999999999999999",
    "-.",
    "*",
    "M200 D1\n",
    "Z-5",
    "X1e9 Y-1e9",
    "M104 S0\n",
];
const PROFILE: &str = "inherits = [\"pla\"]\n[layer]\nheight = 0.2\n[walls]\ncount = 3\nwidth = 0.45\n[bed]\n\
    size = [250, 250]\nshape = \"round\"\n[gcode]\nstart = '''\nG28\nM104 S{nozzle_temp}\n'''\n";
const PROFILE_WORDS: &[&str] = &[
    "inherits = ",
    "\"any.toml\"",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "= 1e999",
    "nan",
    "-1",
    "'''",
    "\"",
    "\\u0000",
    "[gcode]\n",
    "start = \"{\"",
    "9223372036854775808",
    "true",
    "\n",
    "layer.height = 0\n",
    "{nozzle_temp}",
];

const SCRIPT: &str = "M104 S{temperature[0] - 45}\n{if printer_notes =~ /.*(MK4|XL).*/ and layer_z < 0.5}[temperature_1]\
    {elsif is_nil(idle_temperature[0]) then local a = (1, 2.5); a[1]; else}{global b = repeat(3, \"x\" + layer_z)}{b[2]}\
    {endif}\n{size(temperature) == 2 ? round(max(1, 7 / 2.)) : zdigits(random(1, 6), 5, 2)} {{x}}\n\
    {interpolate_table(layer_z, (0, 1), (1, 5))} {one_of(\"a\", ~\"b.*\", /a/)} [idle_temperature]";
const SCRIPT_WORDS: &[&str] = &[
    "{",
    "}",
    "{{",
    "[",
    "]",
    "(",
    ")",
    "\"",
    "/",
    ";",
    "{if ",
    "{else}",
    "{endif}",
    " then ",
    "local a = ",
    "global b = ",
    "a = a + a;",
    "9223372036854775807",
    "-",
    "1e308 * ",
    "x{1000}{1000}",
    "repeat(99999, ",
    "layer_z",
    "temperature",
    "? 1 : ",
    "\n",
];

fn tetrahedron() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 5.0]];
    let mut data = vec![0; 80];
    data.extend(4_u32.to_le_bytes());
    for facet in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        data.extend([0; 12]);
        data.extend(facet.iter().flat_map(|&i: &usize| corners[i]).flat_map(f32::to_le_bytes));
        data.extend([0; 2]);
    }
    data
}

const STL_WORDS: &[&str] = &[
    "solid",
    "facet normal 0 0 1\n",
    "outer loop\n",
    "vertex 0 0 1e5\n",
    "vertex 1 2 3\n",
    "endloop\n",
    "nan",
    "endfacet\n",
    "endsolid",
    "\0\0\u{1}\u{2}",
    "\n",
];

const OBJ: &str = "# box\no part\nv 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 5\nvn 0 0 1\ng side\nf 1 3 2\nf 1//1 2//1 4//1\n\
    f -3/1 -2/2 -1/3\nf 3 1 4\nusemtl red\n";
const OBJ_WORDS: &[&str] = &[
    "v ",
    "f ",
    "\n",
    "-1",
    "0",
    "99999999999",
    "1e39",
    "nan",
    "/",
    "//",
    "1 2 3 4 5",
    "v 1 2\n",
    "v 0 0 1e5\n",
];
const MODEL: &str = "<model unit=\"millimeter\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\
    <resources><object id=\"1\" type=\"model\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"20\" y=\"0\" \
    z=\"0\"/><vertex x=\"0\" y=\"20\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"5\"/></vertices><triangles><triangle v1=\"0\" \
    v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"2\" v2=\"0\" \
    v3=\"3\"/></triangles></mesh></object><object id=\"2\"><components><component objectid=\"1\" transform=\"1 0 0 0 1 0 0 \
    0 1 5 0 0\"/></components></object></resources><build><item objectid=\"2\"/><item objectid=\"1\" transform=\"0 1 0 -1 \
    0 0 0 0 1 60 0 0\"/></build></model>";
const LATTICE: &str = "<model unit=\"millimeter\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
    xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" requiredextensions=\"b\" \
    xmlns:s=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/balls/2020/07\"><resources><object id=\"1\"><mesh>\
    <vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"9\" y=\"0\" z=\"7\"/></vertices><b:beamlattice radius=\"2\" \
    minlength=\"0.1\" cap=\"butt\" s:ballmode=\"all\" s:ballradius=\"3\"><b:beams><b:beam v1=\"0\" v2=\"1\"/><b:beam v1=\"1\" \
    v2=\"0\" r1=\"1\" r2=\"2\" cap1=\"hemisphere\" cap2=\"sphere\"/></b:beams><s:balls><s:ball vindex=\"1\" r=\"4\"/></s:balls>\
    </b:beamlattice></mesh></object></resources><build><item objectid=\"1\"/></build></model>";
const MODEL_WORDS: &[&str] = &[
    "<b:beam v1=\"0\" v2=\"0\"/>",
    "radius=\"1e-30\"",
    "1e300",
    "mixed",
    "\"",
    "<",
    "/>",
    ">",
    "\0",
    "&lt;",
    "<!--",
    "]]>",
    "<component objectid=\"2\"/>",
    "<item objectid=\"2\"/>",
    "unit=\"inch\"",
    "nan",
    "1e39",
    "-1",
    "4294967296",
    "id=\"2\"",
    "type=\"support\"",
    "<triangle v1=\"0\" v2=\"0\" v3=\"9\"/>",
    "p:path=\"/3D/3dmodel.model\"",
];

/// The blocks of a small file without checksums, in one of all ways to write it.
fn blocks(random: &mut Random) -> Vec<u8> {
    use bgcode::{Checksum, Compression, Encoding, Options};
    let compressions =
        [Compression::None, Compression::Deflate, Compression::Heatshrink11, Compression::Heatshrink12];
    let encodings = [Encoding::None, Encoding::MeatPack, Encoding::MeatPackComments];
    let mut compression = || compressions[random.below(4)];
    let (metadata, slicer, gcode) = (compression(), compression(), compression());
    let options =
        Options { checksum: Checksum::None, metadata, slicer, gcode, encoding: encodings[random.below(3)] };
    let text = format!("{BGCODE}{GCODE}");
    let contents = bgcode::Contents::of(text.as_bytes()).expect("memory can be read");
    let bytes = bgcode::pack(&contents, text.as_bytes(), options, Vec::new()).expect("memory can be written");
    bytes[10..].to_vec()
}

const BGCODE: &str = "; generated by S 1 on Monday\n; printer_model = P\n; thumbnail_QOI begin 4x4 8\n; cW9pZg==\n\
    ; thumbnail_QOI end\n; filament used [g] = 5\n; s_config = begin\n; a = 1\n; s_config = end\n";
const BGCODE_WORDS: &[&str] = &[
    "\0\0\0\0",
    "\u{1}\0",
    "\u{1}\0\0\0\u{4}\0\0\0\0\0G28\n",
    "\u{5}\0\0\0",
    "\u{3}\0\u{1}\0",
    "\u{7f}\u{7f}",
    "=",
    "\n",
    "; thumbnail begin 1x1 4",
    "G1 X",
];

macro_rules! targets {
    ($($name:ident, $long:ident, $cases:literal, $case:path, $make:expr;)*) => { $(
        #[test]
        fn $name() {
            run(Some($cases), $make, $case);
        }

        #[test]
        #[ignore = "takes as long as it is told to"]
        fn $long() {
            run(None, $make, $case);
        }
    )* };
}

targets! {
    any_model, any_model_for_long, 8000, cases::stl, |r: &mut Random| match r.below(4) {
        0 => r.bytes(400),
        1 => {
            let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 1\nvertex 0 9 5\nendloop\nendfacet\nendsolid";
            r.damaged(text.as_bytes(), STL_WORDS)
        }
        _ => r.damaged(&tetrahedron(), STL_WORDS),
    };
    any_obj, any_obj_for_long, 16000, cases::obj, |r: &mut Random| r.damaged(OBJ.as_bytes(), OBJ_WORDS);
    any_3mf, any_3mf_for_long, 4000, cases::threemf, |r: &mut Random| {
        let seed = if r.below(2) == 0 { MODEL } else { LATTICE };
        r.damaged(seed.as_bytes(), MODEL_WORDS)
    };
    any_profile, any_profile_for_long, 400, cases::profile, |r: &mut Random| r.damaged(PROFILE.as_bytes(), PROFILE_WORDS);
    any_script, any_script_for_long, 800, cases::macros, |r: &mut Random| match r.below(8) {
        0 => r.bytes(100),
        _ => r.damaged(SCRIPT.as_bytes(), SCRIPT_WORDS),
    };
    any_gcode, any_gcode_for_long, 80, cases::gcode, |r: &mut Random| match r.below(8) {
        0 => r.bytes(400),
        _ => r.damaged(GCODE.as_bytes(), GCODE_WORDS),
    };
    any_bgcode, any_bgcode_for_long, 600, cases::bgcode, |r: &mut Random| match r.below(8) {
        0 => r.bytes(400),
        _ => {
            let seed = blocks(r);
            r.damaged(&seed, BGCODE_WORDS)
        }
    };
    any_polygons, any_polygons_for_long, 40, cases::slicing, |r: &mut Random| r.bytes(600);
    any_order, any_order_for_long, 3000, cases::ordering, |r: &mut Random| r.bytes(900);
}
