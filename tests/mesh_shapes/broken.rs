//! Broken meshes made from good ones. What is random depends on the number of the facet only.

use super::{Facets, ball, inside_out};

/// A point well inside of a shape, and how far its surface is.
pub type Inside = ([f32; 3], f32);

/// Breaks a mesh.
pub type Way = fn(&Facets, Inside) -> Facets;

/// Every way to break a mesh, by name.
pub const WAYS: [(&str, Way); 8] = [
    ("holes", |good, _| holes(good)),
    ("30 % flipped", |good, _| flipped(good)),
    ("duplicated", |good, _| [good.clone(), good.clone()].concat()),
    ("T-junctions", |good, _| t_junctions(good)),
    ("2 µm noise", |good, _| noisy(good)),
    ("self-union", |good, (middle, radius)| [good.clone(), ball(middle, 0.8 * radius, 2)].concat()),
    ("inside out", |good, _| inside_out(good.clone())),
    ("slivers", |good, _| slivers(good)),
];

/// A number that looks random, from 0 to 1.
fn random(seed: usize) -> f32 {
    let mut z = (seed as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (z >> 40) as f32 / (1 << 24) as f32
}

/// One facet in fifty is missing.
fn holes(good: &Facets) -> Facets {
    let kept = good.iter().enumerate().filter(|(i, _)| i % 50 != 7);
    kept.map(|(_, facet)| *facet).collect()
}

fn flipped(good: &Facets) -> Facets {
    let turned = |(i, [a, b, c]): (usize, &[[f32; 3]; 3])| {
        if random(i) < 0.3 { [*b, *a, *c] } else { [*a, *b, *c] }
    };
    good.iter().enumerate().map(turned).collect()
}

fn middle(p: [f32; 3], q: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|i| (p[i] + q[i]) / 2.0)
}

/// One facet in five is split at an edge that its neighbour does not split.
fn t_junctions(good: &Facets) -> Facets {
    let split = |(i, &[a, b, c]): (usize, &[[f32; 3]; 3])| {
        let m = middle(a, b);
        if i % 5 == 0 { vec![[a, m, c], [m, b, c]] } else { vec![[a, b, c]] }
    };
    good.iter().enumerate().flat_map(split).collect()
}

/// Every corner of every facet is somewhere else by up to 2 µm along each axis.
fn noisy(good: &Facets) -> Facets {
    let moved = |i: usize, k: usize, p: [f32; 3]| {
        [0, 1, 2].map(|axis| p[axis] + 0.004 * (random(9 * i + 3 * k + axis) - 0.5))
    };
    good.iter().enumerate().map(|(i, f)| [0, 1, 2].map(|k| moved(i, k, f[k]))).collect()
}

/// One facet in seven is split into three, one of which is a micrometre wide.
fn slivers(good: &Facets) -> Facets {
    let split = |(i, &[a, b, c]): (usize, &[[f32; 3]; 3])| {
        let (m, center) = (middle(a, b), middle(middle(a, b), c));
        let far = (0..3).map(|k| (center[k] - m[k]).powi(2)).sum::<f32>().sqrt();
        let p = [0, 1, 2].map(|k| m[k] + (center[k] - m[k]) / far * 0.001);
        if i % 7 == 0 { vec![[a, b, p], [b, c, p], [c, a, p]] } else { vec![[a, b, c]] }
    };
    good.iter().enumerate().flat_map(split).collect()
}
