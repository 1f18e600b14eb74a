//! Broken meshes made from good ones. What is random depends on the number of the facet only.

use super::{Facets, ball, inside_out};

/// A point well inside of a shape, and how far its surface is.
pub type Inside = ([f32; 3], f32);

/// Breaks a mesh.
pub type Breakage = fn(&Facets, Inside) -> Facets;

/// Every kind of breakage, by name.
pub const BREAKAGES: [(&str, Breakage); 8] = [
    ("holes", |good, _| holes(good)),
    ("30 % flipped", |good, _| flipped(good)),
    ("duplicated", |good, _| [good.clone(), good.clone()].concat()),
    ("T-junctions", |good, _| t_junctions(good)),
    ("2 µm noise", |good, _| noisy(good)),
    ("self-union", |good, (middle, radius)| [good.clone(), ball(middle, 0.8 * radius, 2)].concat()),
    ("inside out", |good, _| inside_out(good.clone())),
    ("slivers", |good, _| slivers(good)),
];

/// Breaks a share of a mesh, where a number says.
pub type Damage = fn(&Facets, f32, usize) -> Facets;

/// Kinds of damage to a part of a mesh, by name.
pub const DAMAGES: [(&str, Damage); 9] = [
    ("sound", |good, _, _| good.clone()),
    ("repeated", |good, share, seed| [good.clone(), some(good, share, seed)].concat()),
    ("repeated in reverse", |good, share, seed| [good.clone(), inside_out(some(good, share, seed))].concat()),
    ("a region repeated in reverse", |good, share, seed| {
        [good.clone(), inside_out(near(good, share, seed).0)].concat()
    }),
    ("flipped", |good, share, seed| {
        let turn = |(i, [a, b, c]): (usize, &[[f32; 3]; 3])| {
            if random(i + 1000 * seed) < 0.6 * share { [*b, *a, *c] } else { [*a, *b, *c] }
        };
        good.iter().enumerate().map(turn).collect()
    }),
    ("a region flipped", |good, share, seed| {
        let (region, rest) = near(good, 0.8 * share, seed);
        [rest, inside_out(region)].concat()
    }),
    ("missing", |good, share, seed| some(good, 1.0 - 0.1 * share, seed)),
    ("a region missing", |good, share, seed| near(good, share, seed).1),
    ("fins", |good, share, seed| {
        let fin = |[a, b, c]: [[f32; 3]; 3]| [a, b, [0, 1, 2].map(|i| 1.5 * c[i] - 0.2 * a[i])];
        [good.clone(), some(good, 0.1 * share, seed).into_iter().map(fin).collect()].concat()
    }),
];

/// About a share of the facets.
fn some(good: &Facets, share: f32, seed: usize) -> Facets {
    let chosen = good.iter().enumerate().filter(|(i, _)| random(i + 1000 * seed) < share);
    chosen.map(|(_, facet)| *facet).collect()
}

/// A share of the facets that lie together, and the others.
fn near(good: &Facets, share: f32, seed: usize) -> (Facets, Facets) {
    let middle_of = |f: &[[f32; 3]; 3]| [0, 1, 2].map(|i| f[0][i] + f[1][i] + f[2][i]);
    let from = middle_of(&good[seed % good.len()]);
    let far = |f: &[[f32; 3]; 3]| {
        let at = middle_of(f);
        (0..3).map(|i| (at[i] - from[i]).powi(2)).sum::<f32>()
    };
    let mut sorted = good.clone();
    sorted.sort_by(|a, b| far(a).total_cmp(&far(b)));
    let rest = sorted.split_off((share * good.len() as f32) as usize);
    (sorted, rest)
}

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
