//! Which side of a shell is outside.

use super::doubts::Doubtful;
use super::rays;
use crate::mesh::edges::NO_TWIN;
use crate::mesh::measure::{extend, facet_measures};

/// A shell is looked at from this many of its corners.
const MOST_CORNERS: usize = 16;

/// All shells together from this many.
const MOST_IN_ALL: usize = 4000;

/// One connected part of a mesh.
#[derive(Clone, Copy)]
struct Shell {
    min: [f32; 3],
    max: [f32; 3],
    /// Positive where facets face outwards.
    volume_mm3: f64,
    area_mm2: f64,
    facets: usize,
}

/// Fewer facets enclose nothing.
const LEAST_FACETS: usize = 4;

impl Shell {
    const NOTHING: Self = Self {
        min: [f32::INFINITY; 3],
        max: [f32::NEG_INFINITY; 3],
        volume_mm3: 0.0,
        area_mm2: 0.0,
        facets: 0,
    };

    fn encloses(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.min[i] && other.max[i] <= self.max[i])
    }

    fn box_mm3(&self) -> f32 {
        (0..3).map(|i| self.max[i] - self.min[i]).product()
    }

    /// An open sheet has no inside: its volume is noise beside its area (in units of 1 µm).
    fn is_inside_out(&self) -> bool {
        self.volume_mm3 < -1e-3 * self.area_mm2
    }
}

/// The flipped facets, and the measures of the shells afterwards.
pub(super) struct Outcome {
    pub turned: usize,
    pub volume_mm3: f64,
    pub area_mm2: f64,
    /// Shells that may be cavities or bodies.
    pub doubts: Vec<Doubtful>,
}

/// Turns shells that face inwards, unless they bound a cavity.
///
/// A mesh whose volume is negative as a whole is turned as a whole first. Then a shell that still faces inwards is a
/// cavity if the nearest facet around it, seen from its corners, shows its back; else it is turned. A shell with doubtful
/// facets, of which nearly as many faced in as out, is a cavity wherever it can be one.
pub(super) fn turn_outwards(
    vertices: &[[f32; 3]],
    triangles: &mut [[u32; 3]],
    twins: &mut [u32],
    shell_of: &[u32],
    shell_count: usize,
    doubtful: &[bool],
) -> Outcome {
    let mut shells = measure(vertices, triangles, shell_of, shell_count);
    let mut turn = vec![false; shell_count];
    let mut in_doubt = vec![false; shell_count];
    for (&shell, _) in shell_of.iter().zip(doubtful).filter(|(_, doubtful)| **doubtful) {
        in_doubt[shell as usize] = true;
    }
    // Their orientation is chance: it says nothing of the others.
    for (shell, _) in in_doubt.iter().enumerate().filter(|(_, in_doubt)| **in_doubt) {
        turn[shell] = shells[shell].volume_mm3 < 0.0;
        shells[shell].volume_mm3 = shells[shell].volume_mm3.abs();
    }
    if shells.iter().map(|s| s.volume_mm3).sum::<f64>() < 0.0 && shells.iter().any(Shell::is_inside_out) {
        turn.iter_mut().for_each(|turn| *turn ^= true);
        shells.iter_mut().for_each(|s| s.volume_mm3 = -s.volume_mm3);
    }
    // From the largest box to the smallest, so that the shells around one are settled before it.
    let mut inward: Vec<usize> =
        (0..shell_count).filter(|&s| shells[s].is_inside_out() || in_doubt[s]).collect();
    inward.sort_by(|&a, &b| shells[b].box_mm3().total_cmp(&shells[a].box_mm3()).then(a.cmp(&b)));
    let is_enclosed =
        |inner: usize| (0..shell_count).any(|s| s != inner && shells[s].encloses(&shells[inner]));
    let enclosed: Vec<bool> = inward.iter().map(|&inner| is_enclosed(inner)).collect();
    let looking: Vec<usize> = inward.iter().zip(&enclosed).filter(|(_, e)| **e).map(|(&s, _)| s).collect();
    let mut views = views(vertices, triangles, shell_of, shell_count, &looking).into_iter();
    let mut doubts = Vec::new();
    for (&inner, enclosed) in inward.iter().zip(enclosed) {
        let is_cavity = enclosed && views.next().is_some_and(|views| show_backs(&views, shell_of, &turn));
        let Shell { min, max, volume_mm3, .. } = shells[inner];
        if is_cavity && in_doubt[inner] {
            let cause =
                "a shell inside another, with as many facets that face in as out, was taken for a cavity";
            doubts.push(Doubtful { cause, volume_mm3: volume_mm3.abs(), min, max });
        }
        if is_cavity == (volume_mm3 > 0.0) {
            turn[inner] ^= true;
            shells[inner].volume_mm3 = -volume_mm3;
        }
    }
    let turned = match turn.contains(&true) {
        true => turn_facets(triangles, twins, |t| turn[shell_of[t] as usize]),
        false => 0,
    };
    Outcome {
        turned,
        volume_mm3: shells.iter().map(|s| s.volume_mm3).sum(),
        area_mm2: shells.iter().map(|s| s.area_mm2).sum(),
        doubts,
    }
}

/// Turns facets; partners of half-edges must turn together.
pub(in crate::mesh) fn turn_facets(
    triangles: &mut [[u32; 3]],
    twins: &mut [u32],
    turn: impl Fn(usize) -> bool,
) -> usize {
    let mut turned = 0;
    for (t, triangle) in triangles.iter_mut().enumerate() {
        if turn(t) {
            triangle.swap(1, 2);
            // The first and the last half-edge change places.
            twins.swap(3 * t, 3 * t + 2);
            turned += 1;
            for twin in twins[3 * t..3 * t + 3].iter_mut().filter(|twin| **twin != NO_TWIN) {
                *twin = *twin / 3 * 3 + 2 - *twin % 3;
            }
        }
    }
    turned
}

/// What the rays from a corner meet first, of other shells: the facet, and whether from its back.
type View = [Option<(u32, bool)>; rays::COUNT];

/// The views from corners of some shells.
fn views(
    vertices: &[[f32; 3]],
    triangles: &[[u32; 3]],
    shell_of: &[u32],
    shell_count: usize,
    looking: &[usize],
) -> Vec<Vec<View>> {
    if looking.is_empty() {
        return Vec::new();
    }
    let mut members: Vec<Option<Vec<u32>>> = vec![None; shell_count];
    looking.iter().for_each(|&shell| members[shell] = Some(Vec::new()));
    for (t, &shell) in (0..).zip(shell_of) {
        if let Some(members) = &mut members[shell as usize] {
            members.push(t);
        }
    }
    // Of thousands of shells each is looked at less closely.
    let most = (MOST_IN_ALL / shell_count).clamp(1, MOST_CORNERS);
    let (mut origins, mut counts) = (Vec::new(), Vec::with_capacity(looking.len()));
    for &shell in looking {
        let own = members[shell].take().unwrap_or_default();
        let corners = own.iter().step_by(own.len().div_ceil(most).max(1));
        counts.push(corners.len());
        origins.extend(corners.map(|&t| (vertices[triangles[t as usize][0] as usize], shell as u32)));
    }
    let (points, owners): (Vec<[f32; 3]>, Vec<u32>) = origins.into_iter().unzip();
    let mut nearest: Vec<[f32; rays::COUNT]> = vec![[f32::MAX; rays::COUNT]; points.len()];
    let mut views: Vec<View> = vec![[None; rays::COUNT]; points.len()];
    rays::for_each_hit(vertices, triangles, &points, |hit| {
        let (corner, ray) = hit.ray;
        let other = shell_of[hit.facet as usize] != owners[corner];
        if other && hit.distance < nearest[corner][ray] {
            nearest[corner][ray] = hit.distance;
            views[corner][ray] = Some((hit.facet, hit.leaves));
        }
    });
    let mut views = views.into_iter();
    counts.into_iter().map(|count| views.by_ref().take(count).collect()).collect()
}

/// Whether the nearest facets of other shells, seen from corners of one, show their backs. A shell that is seen
/// otherwise from some corners crosses another and is no cavity.
fn show_backs(views: &[View], shell_of: &[u32], turn: &[bool]) -> bool {
    let is_back = |&(facet, leaves): &(u32, bool)| leaves != turn[shell_of[facet as usize] as usize];
    // Two of three rays decide, so that one that grazes an edge does not.
    let shows_back = |view: &&View| view.iter().flatten().filter(|hit| is_back(hit)).count() >= 2;
    let others = views.len() - views.iter().filter(shows_back).count();
    !views.is_empty() && 5 * others <= views.len()
}

fn measure(vertices: &[[f32; 3]], triangles: &[[u32; 3]], shell_of: &[u32], count: usize) -> Vec<Shell> {
    let mut shells = vec![Shell::NOTHING; count];
    if let [only] = shells.as_mut_slice() {
        vertices.iter().for_each(|&p| extend(&mut only.min, &mut only.max, p));
    } else {
        // The shell that a vertex was added to: most are corners of some six facets of one.
        let mut added = vec![u32::MAX; vertices.len()];
        for (triangle, &shell) in triangles.iter().zip(shell_of) {
            for &v in triangle {
                if std::mem::replace(&mut added[v as usize], shell) != shell {
                    let shell = &mut shells[shell as usize];
                    extend(&mut shell.min, &mut shell.max, vertices[v as usize]);
                }
            }
        }
    }
    let middle = |shell: &Shell| [0, 1, 2].map(|i| f64::from(shell.min[i] + shell.max[i]) / 2.0);
    let middles: Vec<[f64; 3]> = shells.iter().map(middle).collect();
    let corner = |v: u32| {
        let [x, y, z] = vertices[v as usize];
        [f64::from(x), f64::from(y), f64::from(z)]
    };
    for (&[a, b, c], &shell) in triangles.iter().zip(shell_of) {
        let (volume, area) = facet_measures([corner(a), corner(b), corner(c)], middles[shell as usize]);
        let shell = &mut shells[shell as usize];
        shell.volume_mm3 += volume;
        shell.area_mm2 += area;
        shell.facets += 1;
    }
    for sheet in shells.iter_mut().filter(|shell| shell.facets < LEAST_FACETS) {
        sheet.volume_mm3 = 0.0;
    }
    shells
}
