//! Writes the models in `models/`: small, one feature each, the same bytes every time.
//!
//! `cargo run --example make_models`

mod mesh;
mod solid;

use std::f64::consts::PI;
use std::fs::File;
use std::path::Path;

use mesh::Mesh;
use solid::{Outline, Solid, circle, hole, rectangle};

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    std::fs::create_dir_all(&folder)?;
    let models = [
        ("calibration_cube", calibration_cube()),
        ("plate_with_holes", plate_with_holes()),
        ("thin_wall_comb", thin_wall_comb()),
        ("overhang_and_bridge", overhang_and_bridge()),
        ("hollow_vase", hollow_vase()),
        ("pin_forest", pin_forest()),
        ("tilted_bracket", tilted_bracket()),
        ("helical_gear", helical_gear()),
        ("nested_shells", nested_shells()),
        ("broken_box", broken_box()),
    ];
    for (name, solid) in models {
        let path = folder.join(name).with_extension("stl");
        let facets: Vec<stl_io::Triangle> = solid.facets.iter().map(facet).collect();
        stl_io::write_stl(&mut File::create(&path)?, facets.iter())?;
        println!("{}: {} facets", path.display(), facets.len());
        if name == "tilted_bracket" {
            let mesh = Mesh::of(&facets);
            std::fs::write(path.with_extension("obj"), mesh.obj())?;
            std::fs::write(path.with_extension("3mf"), mesh.threemf()?)?;
        }
    }
    Ok(())
}

fn facet(corners: &[[f64; 3]; 3]) -> stl_io::Triangle {
    let [a, b, c] = *corners;
    let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    stl_io::Triangle {
        normal: stl_io::Normal::new(normal.map(|n| (n / length) as f32)),
        vertices: corners.map(|p| stl_io::Vertex::new(p.map(|x| x as f32))),
    }
}

/// 20 mm, with a square pocket 5 mm deep in its top.
fn calibration_cube() -> Solid {
    let (outside, pocket) = (rectangle([0.0; 2], [20.0; 2]), hole(rectangle([6.0; 2], [14.0; 2])));
    let mut cube = Solid::default();
    cube.face(std::slice::from_ref(&outside), 0.0, false);
    cube.wall(&outside, 0.0, 20.0);
    cube.face(&[outside, pocket.clone()], 20.0, true);
    cube.wall(&pocket, 15.0, 20.0);
    cube.face(&[hole(pocket)], 15.0, true);
    cube
}

/// 60 × 40 × 3 mm with 9 × 6 holes of 1 to 5 mm.
fn plate_with_holes() -> Solid {
    let mut outlines = vec![rectangle([0.0; 2], [60.0, 40.0])];
    for row in 0..6 {
        for column in 0..9 {
            let middle = [6.0 + 6.0 * f64::from(column), 5.0 + 6.0 * f64::from(row)];
            outlines.push(hole(circle(middle, 0.5 + 0.25 * f64::from(column), 16 + 2 * column as usize)));
        }
    }
    Solid::prism(&outlines, 0.0, 3.0)
}

/// Teeth of 0.3 to 2.4 mm on a bar.
fn thin_wall_comb() -> Solid {
    let mut profile: Outline = vec![[0.0, 0.0], [46.0, 0.0], [46.0, 2.0]];
    let mut x = 44.0;
    for tooth in 0..12 {
        let width = 2.4 - 0.2 * f64::from(tooth) + if tooth == 11 { 0.1 } else { 0.0 };
        profile.extend([[x, 2.0], [x, 12.0], [x - width, 12.0], [x - width, 2.0]]);
        x -= width + 2.4;
    }
    profile.push([0.0, 2.0]);
    Solid::profile(&[profile], 15.0)
}

/// A tower with steps that overhang by 30° to 75° from the vertical, and windows whose lintels are bridges of 10 to 20 mm.
fn overhang_and_bridge() -> Solid {
    let mut profile: Outline = vec![[-30.0, 0.0], [0.0, 0.0], [0.0, 5.0]];
    for (step, degrees) in [30.0_f64, 45.0, 60.0, 75.0].into_iter().enumerate() {
        let (z, out) = (5.0 + 7.0 * step as f64, 4.0 * degrees.to_radians().tan());
        profile.extend([[out, z + 4.0], [out, z + 5.0], [0.0, z + 5.0], [0.0, z + 7.0]]);
    }
    profile.extend([[0.0, 35.0], [-30.0, 35.0]]);
    let windows = [20.0, 15.0, 10.0].into_iter().zip([4.0, 14.0, 24.0]);
    let mut outlines = vec![profile];
    outlines.extend(
        windows.map(|(span, z)| hole(rectangle([-15.0 - span / 2.0, z], [-15.0 + span / 2.0, z + 6.0]))),
    );
    Solid::profile(&outlines, 10.0)
}

/// Walls of 1.2 mm around a curved inside, on a floor of 2 mm.
fn hollow_vase() -> Solid {
    let radius = |z: f64| 14.0 + 5.0 * (z / 45.0 * 2.0 * PI).sin();
    let heights: Vec<f64> = (0..=22).map(|i| f64::from(i) * 45.0 / 22.0).collect();
    let mut profile = vec![[0.0, 0.0]];
    profile.extend(heights.iter().map(|&z| [radius(z), z]));
    profile.extend(heights.iter().rev().filter(|&&z| z > 2.0).map(|&z| [radius(z) - 1.2, z]));
    profile.extend([[radius(2.0) - 1.2, 2.0], [0.0, 2.0]]);
    Solid::lathe(&profile, 64)
}

/// 6 × 6 pins of 1 to 3.5 mm, 8 to 18 mm high, on a plate.
fn pin_forest() -> Solid {
    let plate = rectangle([0.0; 2], [36.0; 2]);
    let mut solid = Solid::default();
    solid.face(std::slice::from_ref(&plate), 0.0, false);
    solid.wall(&plate, 0.0, 1.6);
    let mut top = vec![plate];
    for row in 0..6 {
        for column in 0..6 {
            let middle = [3.0 + 6.0 * f64::from(column), 3.0 + 6.0 * f64::from(row)];
            let pin = circle(middle, 0.5 + 0.25 * f64::from(column), 20);
            let tip = 8.0 + 2.0 * f64::from(row);
            solid.wall(&pin, 1.6, tip);
            solid.face(std::slice::from_ref(&pin), tip, true);
            top.push(hole(pin));
        }
    }
    solid.face(&top, 1.6, true);
    solid
}

/// An L with two holes and a round corner, leaning over by 30°.
fn tilted_bracket() -> Solid {
    let mut outline = vec![[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [16.0, 10.0]];
    let fillet = |i: i32| PI * 1.5 - f64::from(i) * PI / 24.0;
    outline.extend((1..12).map(|i| [16.0 + 6.0 * fillet(i).cos(), 16.0 + 6.0 * fillet(i).sin()]));
    outline.extend([[10.0, 16.0], [10.0, 30.0], [0.0, 30.0]]);
    let holes = [[33.0, 5.0], [5.0, 24.0]].map(|middle| hole(circle(middle, 2.6, 40)));
    let outlines = [vec![outline], holes.to_vec()].concat();
    let lean = (PI / 6.0).tan();
    Solid::loft(&outlines, &[0.0, 16.0], |[x, y], z| [x + lean * z, y, z])
}

/// 18 trapezoidal teeth, twisted by 20° over 8 mm, with a bore.
fn helical_gear() -> Solid {
    let mut outline = Vec::new();
    for tooth in 0..18 {
        for (share, radius) in [(0.0, 13.0), (0.3, 13.0), (0.45, 16.5), (0.85, 16.5)] {
            let angle = (f64::from(tooth) + share) * PI / 9.0;
            outline.push([radius * angle.cos(), radius * angle.sin()]);
        }
    }
    let heights: Vec<f64> = (0..=16).map(|i| f64::from(i) * 0.5).collect();
    Solid::loft(&[outline, hole(circle([0.0; 2], 4.0, 48))], &heights, |[x, y], z| {
        let (sin, cos) = (z / 8.0 * PI / 9.0).sin_cos();
        [x * cos - y * sin, x * sin + y * cos, z]
    })
}

/// A ball-shaped cavity in a cube.
fn nested_shells() -> Solid {
    let profile: Vec<[f64; 2]> = (0..=24)
        .map(|i| match i {
            0 => [0.0, 4.0],
            24 => [0.0, 20.0],
            _ => [8.0 * (f64::from(i) * PI / 24.0).sin(), 12.0 - 8.0 * (f64::from(i) * PI / 24.0).cos()],
        })
        .collect();
    let ball = Solid::lathe(&profile, 48);
    Solid::prism(&[rectangle([-12.0; 2], [12.0; 2])], 0.0, 24.0).with(ball.inside_out())
}

/// A round box with everything that goes wrong in files: facets missing, repeated, turned over, collapsed, moved apart
/// by 5 µm, and a vertex in the middle of a neighbour's edge.
fn broken_box() -> Solid {
    let outlines = [circle([0.0; 2], 15.0, 36), hole(circle([0.0; 2], 6.0, 24))];
    let heights: Vec<f64> = (0..=8).map(|i| f64::from(i) * 1.5).collect();
    let mut solid = Solid::loft(&outlines, &heights, |[x, y], z| [x, y, z]);
    let count = solid.facets.len();
    for i in (0..count).step_by(7) {
        solid.facets[i].swap(1, 2);
    }
    for i in (0..count).step_by(40) {
        solid.facets.push(solid.facets[i]);
    }
    let corner = solid.facets[10][0];
    solid.facets.push([corner, corner, solid.facets[10][1]]);
    for p in solid.facets[500].iter_mut() {
        p[0] += 0.005;
    }
    let [a, b, c] = solid.facets[300];
    let middle = [0, 1, 2].map(|i| (a[i] + b[i]) / 2.0);
    solid.facets[300] = [a, middle, c];
    solid.facets.push([middle, b, c]);
    solid.facets.swap_remove(420);
    solid.facets.swap_remove(421);
    solid
}
