//! Pictures and pages on the command line, and pictures as they should look.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use pathwright::profile::Settings;
use pathwright::view::{Scene, layer_png, thumbnail};
use tiny_skia::Pixmap;

/// Two layers with every kind of stroke and mark.
const PRINT: &str = include_str!("../golden/print.gcode");

fn view(args: &[&str]) -> Command {
    let mut command = cargo_bin_cmd!("pathwright");
    command.arg("view").args(args);
    command
}

/// Compares with the stored picture: no channel differs by much on average. `PATHWRIGHT_BLESS=1` stores it anew.
fn looks_like(png: &[u8], name: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if std::env::var_os("PATHWRIGHT_BLESS").is_some() {
        fs::write(&path, png).unwrap();
    }
    let (now, then) = (Pixmap::decode_png(png).unwrap(), Pixmap::load_png(&path).unwrap());
    assert_eq!((now.width(), now.height()), (then.width(), then.height()), "{name}");
    let differences = now.data().iter().zip(then.data()).map(|(a, b)| f64::from(a.abs_diff(*b)));
    let average = differences.sum::<f64>() / now.data().len() as f64;
    assert!(average < 0.5, "{name} differs by {average} of 255 on average");
}

#[test]
fn layers_look_as_they_did() {
    let scene = Scene::read(PRINT.as_bytes(), &Settings::default());
    for (index, name) in ["layer-1.png", "layer-2.png"].into_iter().enumerate() {
        looks_like(&layer_png(&scene, &scene.layers[index], 240), name);
    }
}

#[test]
fn thumbnails_look_as_they_did() {
    let scene = Scene::read(PRINT.as_bytes(), &Settings::default());
    looks_like(&thumbnail(&scene, [120, 90]), "thumbnail.png");
}

#[test]
fn pictures_and_page_are_written_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("part.gcode"), PRINT).unwrap();
    let (gcode, svg, png, small) = (path("part.gcode"), path("a.svg"), path("a.png"), path("small.png"));
    view(&[&gcode, "--layer", "2", "--svg", &svg, "--png", &png, "--size", "90", "--thumbnail", &small])
        .assert()
        .success();
    assert!(!Path::new(&path("part.html")).exists(), "only pictures were asked for");
    assert!(fs::read_to_string(&svg).unwrap().contains("class=\"overhang-wall\""));
    assert_eq!(Pixmap::load_png(&png).unwrap().width().max(Pixmap::load_png(&png).unwrap().height()), 90);
    assert_eq!(Pixmap::load_png(&small).unwrap().width(), 90);
    view(&[&gcode]).assert().success();
    assert!(fs::read_to_string(path("part.html")).unwrap().contains("<title>part.gcode</title>"));
}

#[test]
fn what_cannot_be_shown_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("part.gcode"), PRINT).unwrap();
    fs::write(path("junk.gcode"), b"\xff\x00\x01 no print\n").unwrap();
    let (gcode, junk, missing) = (path("part.gcode"), path("junk.gcode"), path("no.gcode"));
    for (args, code, message) in [
        (&[&*junk][..], 3, "no moves"),
        (&[&*missing], 3, "no.gcode"),
        (&[&*gcode, "--layer", "3", "--svg", "x.svg"], 2, "layers 1 to 2"),
        (&[&*gcode, "--svg", "x.svg"], 2, "--layer"),
        (&[&*gcode, &junk], 2, "one G-code file"),
        (&[&*gcode, "-o", &gcode], 2, "replace"),
    ] {
        let done = view(args).output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.code() == Some(code) && text.contains(message), "{args:?}: {text}");
    }
}

/// The pictures in a file's header as hosts and printers read them: announced size, and the PNG from lines of base64
/// (RFC 4648) of the announced length.
fn thumbnails(gcode: &str) -> Vec<(String, Pixmap)> {
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut found = Vec::new();
    for part in gcode.split("; thumbnail begin ").skip(1) {
        let (head, rest) = part.split_once('\n').unwrap();
        let (size, announced) = head.split_once(' ').unwrap();
        let (lines, _) = rest.split_once("; thumbnail end\n").unwrap();
        let text: String = lines.lines().map(|line| line.strip_prefix("; ").unwrap()).collect();
        assert_eq!(text.len(), announced.parse::<usize>().unwrap());
        let bits = text.trim_end_matches('=').bytes().map(|b| digits.iter().position(|d| *d == b).unwrap());
        let bits: Vec<u8> =
            bits.flat_map(|value| (0..6).rev().map(move |i| (value >> i & 1) as u8)).collect();
        let png: Vec<u8> =
            bits.chunks_exact(8).map(|byte| byte.iter().fold(0, |sum, bit| sum << 1 | bit)).collect();
        found.push((size.to_owned(), Pixmap::decode_png(&png).unwrap()));
    }
    found
}

#[test]
fn sliced_files_carry_thumbnails_unless_told_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let sliced = |set: &str| {
        let path = folder.path().join("cube.gcode");
        let mut command = cargo_bin_cmd!("pathwright");
        command.current_dir(env!("CARGO_MANIFEST_DIR"));
        command.args([
            "slice",
            "models/calibration_cube.stl",
            "--set",
            "layer.height=0.3",
            "--set",
            set,
            "-q",
            "-o",
        ]);
        command.arg(&path).assert().success();
        fs::read_to_string(path).unwrap()
    };
    let text = sliced("gcode.thumbnails=16x16,48x32");
    assert!(text.starts_with("; generated by Pathwright"));
    let pictures = thumbnails(&text);
    assert_eq!(pictures.iter().map(|(size, _)| size.as_str()).collect::<Vec<_>>(), ["16x16", "48x32"]);
    for (size, picture) in &pictures {
        assert_eq!(*size, format!("{}x{}", picture.width(), picture.height()));
        let seen = picture.pixels().iter().filter(|pixel| pixel.alpha() == 255).count();
        assert!(seen * 5 > picture.pixels().len(), "{size}: the cube fills {seen} pixels");
    }
    assert!(
        text.contains("; estimated printing time (normal mode) = ") && !text.contains("(normal mode) =  ")
    );
    assert!(!sliced("gcode.thumbnails=").contains("thumbnail begin"));
}
