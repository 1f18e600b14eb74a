//! Which side of a shell is outside.

use parry3d::math::Vector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::TriMesh;

use super::edges::NO_TWIN;
use super::facet_measures;

/// One connected part of a mesh.
#[derive(Clone, Copy)]
struct Shell {
    min: [f32; 3],
    max: [f32; 3],
    /// Positive where facets face outwards.
    volume_mm3: f64,
    area_mm2: f64,
}

impl Shell {
    const NOTHING: Self =
        Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3], volume_mm3: 0.0, area_mm2: 0.0 };

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

/// Turns shells that face inwards, unless they bound a cavity. Returns the number of facets turned.
///
/// A mesh whose volume is negative as a whole is turned as a whole first. Then a shell that still faces inwards is a
/// cavity if the nearest facet around it, seen from one of its corners, shows its back; else it is turned.
pub(super) fn turn_outwards(
    vertices: &[[f32; 3]],
    triangles: &mut [[u32; 3]],
    twins: &mut [u32],
    shell_of: &[u32],
    shell_count: usize,
) -> usize {
    let mut shells = measure(vertices, triangles, shell_of, shell_count);
    let mut turn = vec![false; shell_count];
    if shells.iter().map(|s| s.volume_mm3).sum::<f64>() < 0.0 && shells.iter().any(Shell::is_inside_out) {
        turn.fill(true);
        shells.iter_mut().for_each(|s| s.volume_mm3 = -s.volume_mm3);
    }
    // From the largest box to the smallest, so that the shells around one are settled before it.
    let mut inward: Vec<usize> = (0..shell_count).filter(|&s| shells[s].is_inside_out()).collect();
    inward.sort_by(|&a, &b| shells[b].box_mm3().total_cmp(&shells[a].box_mm3()).then(a.cmp(&b)));
    let mut surface = None;
    for &inner in &inward {
        let enclosed = (0..shell_count).any(|s| s != inner && shells[s].encloses(&shells[inner]));
        let is_cavity = enclosed && {
            let surface = surface.get_or_insert_with(|| Surface::new(vertices, triangles, shell_of));
            surface.shows_back_to(inner as u32, &turn)
        };
        turn[inner] ^= !is_cavity;
    }
    turn_facets(triangles, twins, |t| turn[shell_of[t] as usize])
}

/// Turns facets; partners of half-edges must turn together.
pub(super) fn turn_facets(
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

/// All facets in a hierarchy for ray casts.
struct Surface<'a> {
    mesh: Option<TriMesh>,
    shell_of: &'a [u32],
}

impl<'a> Surface<'a> {
    fn new(vertices: &[[f32; 3]], triangles: &[[u32; 3]], shell_of: &'a [u32]) -> Self {
        let points = vertices.iter().map(|&p| Vector::from(p)).collect();
        Self { mesh: TriMesh::new(points, triangles.to_vec()).ok(), shell_of }
    }

    /// Whether the nearest facets of other shells, seen from a corner of this one, show their backs: two of three
    /// rays decide, so that one that grazes an edge does not.
    fn shows_back_to(&self, shell: u32, turn: &[bool]) -> bool {
        let Some((mesh, first)) = self.mesh.as_ref().zip(self.shell_of.iter().position(|&s| s == shell))
        else {
            return false;
        };
        let origin = mesh.triangle(first as u32).a;
        let directions = [[0.36, 0.48, 0.8], [-0.6, 0.64, 0.48], [0.48, -0.36, -0.8]].map(Vector::from);
        let backs = directions.into_iter().filter(|&direction| {
            let ray = Ray::new(origin, direction);
            let hit = mesh.bvh().find_best(
                f32::MAX,
                |node, nearest| node.cast_ray(&ray, nearest),
                |t, nearest| {
                    let other = self.shell_of[t as usize] != shell;
                    other.then(|| mesh.triangle(t).cast_local_ray(&ray, nearest, false)).flatten()
                },
            );
            hit.is_some_and(|(t, _)| {
                let along = mesh.triangle(t).scaled_normal().dot(direction) > 0.0;
                along != turn[self.shell_of[t as usize] as usize]
            })
        });
        backs.count() >= 2
    }
}

fn measure(vertices: &[[f32; 3]], triangles: &[[u32; 3]], shell_of: &[u32], count: usize) -> Vec<Shell> {
    let mut shells = vec![Shell::NOTHING; count];
    for (triangle, &shell) in triangles.iter().zip(shell_of) {
        let shell = &mut shells[shell as usize];
        for &v in triangle {
            for axis in 0..3 {
                shell.min[axis] = shell.min[axis].min(vertices[v as usize][axis]);
                shell.max[axis] = shell.max[axis].max(vertices[v as usize][axis]);
            }
        }
    }
    for (triangle, &shell) in triangles.iter().zip(shell_of) {
        let shell = &mut shells[shell as usize];
        let middle: [f64; 3] = std::array::from_fn(|i| f64::from(shell.min[i] + shell.max[i]) / 2.0);
        let corners = triangle.map(|v| vertices[v as usize].map(f64::from));
        let (volume, area) = facet_measures(corners, middle);
        shell.volume_mm3 += volume;
        shell.area_mm2 += area;
    }
    shells
}
