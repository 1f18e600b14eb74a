//! Corners that need not be sharp, drawn so that the machine need not slow down for them as much.
//!
//! Firmwares take a corner the slower the more it turns, a curve in many small turns nearly as fast as its
//! radius allows. So the turns of infill are rounded, and curves get back the vertices that slicing took.

use super::simplify::Piece;
use crate::toolpath::Role;
use crate::units::MmPerS;
use geometry::real;
use geometry::{cross, distance_mm};

/// Largest angle at a vertex, in rad × mm/s over mm/s: at 50 mm/s and a square corner velocity of 5 mm/s, 0.22 rad.
/// By Klipper's rule a corner of 1.8 in these units costs no speed at all, and a little more hardly any time.
const GENTLE: f64 = 2.2;

/// Finer turns take more vertices than they are worth …
const FINEST_RAD: f64 = 0.1;
/// … and coarser ones can be seen.
const COARSEST_RAD: f64 = 0.25;

/// Turns below this angle are fast enough for a bead that is drawn at a speed, on a machine with this square corner
/// velocity.
pub(super) fn gentle_rad(speed: MmPerS, square_corner_velocity: MmPerS) -> f64 {
    let rad = GENTLE * square_corner_velocity.0 / speed.0.max(f64::MIN_POSITIVE);
    rad.clamp(FINEST_RAD, COARSEST_RAD)
}

/// Curves of outer walls turn by no more than this at a vertex, however slow they are: they are seen, and the walls behind them,
/// which are faster, are as fine.
const SEEN_RAD: f64 = 0.17;

/// The turn that curves of a role have at each vertex, where corners may turn by `gentle_rad`.
pub(super) fn curve_rad(role: Role, gentle_rad: f64) -> f64 {
    if role == Role::ExternalPerimeter { real::lesser(gentle_rad, SEEN_RAD) } else { gentle_rad }
}

/// No piece is made shorter than this, in acute corners of inner walls than the other.
const SHORTEST_MM: f64 = 0.05;
const SHORTEST_ACUTE_MM: f64 = 0.04;

/// Corners that turn by more than this are sharp.
const SHARP_RAD: f64 = 1.0;

/// So far may an arc leave a blunt corner: as far as slicing simplifies the curves that such corners mostly are.
const BLUNT_MM: f64 = 0.0125;

/// Sharp corners of inner walls and solid infill are rounded up to this turn, so far as a share of the bead's width.
/// The bead is wider on the arc by what that is shorter, and fills the corner in the bead beside it better than a sharp turn.
/// Corners of 60° are among them.
const SHARP_WIDTHS: f64 = 0.11;
const SHARPEST_RAD: f64 = 2.1;

/// Corners of inner walls turn by up to this. Those that turn by more than [`SHARPEST_RAD`] are acute and get an arc of the same radius as
/// one that turns by that: the bead covers itself within them as much as its outside leaves open.
const ACUTEST_RAD: f64 = 2.47;

/// Which corners are rounded, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rounding {
    /// Corners that turn by less or by more than this are left as they are.
    least_rad: f64,
    most_rad: f64,
    /// So far may an arc leave its corner, blunt or sharp.
    blunt_mm: f64,
    sharp_mm: f64,
    /// Whether there are acute corners that are no rounder than sharp ones.
    has_acute: bool,
    /// An arc turns by about this at each vertex.
    step_rad: f64,
    /// Half of the bead's width where what its round outside leaves open in a corner is filled, else 0.
    filled_mm: f64,
}

impl Rounding {
    /// The rounding of a role's beads. Turns of sparse infill may leave their corner by little more than its lines
    /// reach into the wall, those of inner walls and solid infill by less. Sharp corners of other beads are kept.
    pub fn of(role: Role, width_mm: f64, gentle_rad: f64) -> Self {
        let blunt = Self {
            least_rad: gentle_rad,
            most_rad: SHARP_RAD,
            blunt_mm: BLUNT_MM,
            sharp_mm: 0.0,
            has_acute: false,
            step_rad: gentle_rad,
            filled_mm: 0.0,
        };
        match role {
            Role::InternalInfill | Role::Support => {
                let mm = 0.25 * width_mm;
                Self { most_rad: 3.0, blunt_mm: mm, sharp_mm: mm, step_rad: 0.3, ..blunt }
            }
            Role::Perimeter | Role::SolidInfill | Role::TopSolidInfill => {
                let (sharp_mm, filled_mm) = (SHARP_WIDTHS * width_mm, 0.5 * width_mm);
                let has_acute = role == Role::Perimeter;
                let most_rad = if has_acute { ACUTEST_RAD } else { SHARPEST_RAD };
                Self { most_rad, sharp_mm, has_acute, filled_mm, ..blunt }
            }
            _ => blunt,
        }
    }

    fn deviation_mm(&self, turn_rad: f64) -> f64 {
        match turn_rad {
            ..=SHARP_RAD => self.blunt_mm,
            SHARPEST_RAD.. if self.has_acute => self.sharp_mm * (1.0 / real::cos(0.5 * turn_rad) - 1.0),
            _ => self.sharp_mm,
        }
    }

    /// No piece of an arc is made shorter.
    fn shortest_mm(&self, turn_rad: f64) -> f64 {
        if turn_rad > SHARPEST_RAD && self.has_acute { SHORTEST_ACUTE_MM } else { SHORTEST_MM }
    }

    /// Length of the bead that holds as much as the round outside of a sharp corner leaves open.
    fn open_mm(&self, turn_rad: f64) -> f64 {
        let half = 0.5 * turn_rad;
        let is_open = turn_rad > SHARP_RAD && turn_rad <= SHARPEST_RAD;
        if is_open { 0.5 * self.filled_mm * (real::tan(half) - half) } else { 0.0 }
    }
}

/// A curve is refined where its arc leaves the chord by at most this …
const BULGE_MM: f64 = 0.016;

/// … and where it turns by less than this at a vertex: otherwise there is a corner.
const CORNER_RAD: f64 = 0.6;

/// A direction, and the length.
fn direction(a: [f64; 2], b: [f64; 2]) -> ([f64; 2], f64) {
    let length_mm = distance_mm(a, b);
    let per_mm = 1.0 / length_mm.max(f64::MIN_POSITIVE);
    ([(b[0] - a[0]) * per_mm, (b[1] - a[1]) * per_mm], length_mm)
}

/// The angle from one direction to another, counter-clockwise positive.
fn turn_rad(u: [f64; 2], v: [f64; 2]) -> f64 {
    real::atan2(cross(u, v), dot(u, v))
}

fn dot(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

/// Rounds the corners of a bead that begins at `from`: an arc that leaves the corner by at most the deviation and
/// begins no further off than the middle of either piece. Each piece keeps its volume; what the corner would have held
/// is spread over its arc, with what its outside would leave open.
pub(super) fn round_corners(from: [f64; 2], pieces: &[Piece], rounding: &Rounding, out: &mut Vec<Piece>) {
    let mut at = from;
    // What is left of the present piece, its beginning having gone into a corner.
    let Some(mut left) = pieces.first().copied() else { return };
    for (i, next) in pieces.iter().enumerate().skip(1) {
        let corner = pieces[i - 1].to;
        let before = if i == 1 { from } else { pieces[i - 2].to };
        let ((u, u_mm), (v, v_mm)) = (direction(before, corner), direction(corner, next.to));
        // Most turns are gentle, which shows without knowing the angle.
        let gentle = dot(u, v) > 0.0 && cross(u, v).abs() < rounding.least_rad * dot(u, v);
        let turn = if gentle { 0.0 } else { turn_rad(u, v) };
        if !(rounding.least_rad..=rounding.most_rad).contains(&turn.abs()) {
            out.push(left);
            (at, left) = (corner, *next);
            continue;
        }
        let half = 0.5 * turn.abs();
        let by_deviation_mm =
            rounding.deviation_mm(turn.abs()) * real::sin(half) / (1.0 - real::cos(half)).max(1e-9);
        let tangent_mm = by_deviation_mm.min(0.5 * u_mm).min(0.5 * v_mm);
        let radius_mm = tangent_mm / real::tan(half);
        let most_steps = (radius_mm * turn.abs() / rounding.shortest_mm(turn.abs())).floor();
        let steps = (turn.abs() / rounding.step_rad).ceil().min(most_steps);
        if steps < 2.0 {
            out.push(left);
            (at, left) = (corner, *next);
            continue;
        }
        let begin = [corner[0] - u[0] * tangent_mm, corner[1] - u[1] * tangent_mm];
        let (from_u_mm3, from_v_mm3) =
            (pieces[i - 1].volume_mm3 * tangent_mm / u_mm, next.volume_mm3 * tangent_mm / v_mm);
        if distance_mm(at, begin) > 1e-6 {
            out.push(Piece { to: begin, volume_mm3: left.volume_mm3 - from_u_mm3, ..left });
        }
        let left_of = [-u[1] * turn.signum(), u[0] * turn.signum()];
        let center = [begin[0] + left_of[0] * radius_mm, begin[1] + left_of[1] * radius_mm];
        let chord_mm = 2.0 * radius_mm * real::sin(0.5 * turn.abs() / steps);
        // Between short pieces other corners are near, which fill it, too.
        let share = real::lesser(2.0 * tangent_mm / by_deviation_mm, 1.0);
        let open_mm3 = next.area_mm2 * rounding.open_mm(turn.abs()) * share;
        let volume_mm3 = (from_u_mm3 + from_v_mm3 + open_mm3) / steps;
        for step in 1..=steps as u32 {
            let (sine, cosine) = real::sin_cos(turn * f64::from(step) / steps);
            let r = [begin[0] - center[0], begin[1] - center[1]];
            at = [center[0] + r[0] * cosine - r[1] * sine, center[1] + r[0] * sine + r[1] * cosine];
            out.push(Piece { to: at, volume_mm3, area_mm2: volume_mm3 / chord_mm });
        }
        left = Piece { volume_mm3: next.volume_mm3 - from_v_mm3, ..*next };
    }
    if distance_mm(at, left.to) > 1e-6 {
        out.push(left);
    }
}

/// Cuts the pieces of curves so that they turn by little at each vertex: the vertices added lie on the curve that goes
/// through the others halfway between the directions before and after (a cubic; of a circle's chords, the circle),
/// at most [`BULGE_MM`] beside the piece. They turn by `most_rad` at most then, if the pieces need not become too short for that.
/// Each piece keeps its volume.
pub(super) fn refine_curves(from: [f64; 2], pieces: &[Piece], most_rad: f64, out: &mut Vec<Piece>) {
    let mut a = from;
    let mut turn_before = 0.0_f64;
    for (i, piece) in pieces.iter().enumerate() {
        let (along, length_mm) = direction(a, piece.to);
        let turn_after = match pieces.get(i + 1) {
            Some(next) => {
                Some(turn_rad(along, direction(piece.to, next.to).0)).filter(|t| t.abs() < CORNER_RAD)
            }
            None => None,
        };
        let turn_after = turn_after.unwrap_or(0.0);
        // Slopes against the piece at its start and end.
        let (start, end): (f64, f64) = (-0.5 * turn_before, 0.5 * turn_after);
        let bulge_mm = length_mm * (start.abs() + end.abs()) / 8.0;
        let steps = ((start.abs() + end.abs()) / most_rad).ceil().min((length_mm / SHORTEST_MM).floor());
        if steps < 2.0 || bulge_mm > BULGE_MM {
            out.push(*piece);
        } else {
            for step in 1..steps as u32 {
                let share = f64::from(step) / steps;
                let rest = 1.0 - share;
                let (x, y) = (length_mm * share, length_mm * share * rest * (start * rest - end * share));
                let to = [a[0] + along[0] * x - along[1] * y, a[1] + along[1] * x + along[0] * y];
                out.push(Piece { to, volume_mm3: piece.volume_mm3 / steps, ..*piece });
            }
            out.push(Piece { volume_mm3: piece.volume_mm3 / steps, ..*piece });
        }
        (a, turn_before) = (piece.to, turn_after);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pieces(points: &[[f64; 2]]) -> Vec<Piece> {
        let piece =
            |w: &[[f64; 2]]| Piece { to: w[1], volume_mm3: 0.08 * distance_mm(w[0], w[1]), area_mm2: 0.08 };
        points.windows(2).map(piece).collect()
    }

    fn sharpest(from: [f64; 2], pieces: &[Piece]) -> f64 {
        let points: Vec<[f64; 2]> = std::iter::once(from).chain(pieces.iter().map(|p| p.to)).collect();
        let turn = |w: &[[f64; 2]]| turn_rad(direction(w[0], w[1]).0, direction(w[1], w[2]).0).abs();
        points.windows(3).map(turn).fold(0.0, f64::max)
    }

    #[test]
    fn walls_keep_their_sharp_corners_and_lose_a_hundredth_at_blunt_ones() {
        let wall = Rounding::of(Role::ExternalPerimeter, 0.45, 0.15);
        let points = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [8.0, 10.0]];
        let mut out = Vec::new();
        round_corners(points[0], &pieces(&points), &wall, &mut out);
        assert!(out.iter().any(|p| p.to == points[1]), "{out:?}");
        assert!(out.iter().all(|p| p.to != points[2]), "{out:?}");
        // The chords cut off a little more than the arc.
        let middle = |w: &[Piece]| [0, 1].map(|i| 0.5 * (w[0].to[i] + w[1].to[i]));
        let off_mm = out.windows(2).map(|w| distance_mm(middle(w), points[2])).fold(f64::INFINITY, f64::min);
        assert!(off_mm < 0.015 && off_mm > 0.0, "{off_mm}");
    }

    #[test]
    fn sharp_corners_of_inner_walls_are_rounded_by_a_tenth_of_their_width() {
        let inner = Rounding::of(Role::Perimeter, 0.45, 0.22);
        let points = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [5.5, 0.0]];
        let mut out = Vec::new();
        round_corners(points[0], &pieces(&points), &inner, &mut out);
        let off_mm = out.iter().map(|p| distance_mm(p.to, points[1])).fold(f64::INFINITY, f64::min);
        assert!((0.04..0.07).contains(&off_mm), "{off_mm}");
        let acute = [[0.0, 0.0], [5.0, 0.0], [1.0, 3.4]];
        let mut rounded = Vec::new();
        round_corners(acute[0], &pieces(&acute), &inner, &mut rounded);
        assert!(sharpest(acute[0], &rounded) < 1.3, "{rounded:?}");
        assert!(out.iter().any(|p| p.to == points[2]), "an acute tip stays: {out:?}");
        // A round outside leaves (1 - π/4) of a square of half the width open.
        let held_mm3 = out.iter().map(|p| p.volume_mm3).sum::<f64>();
        let drawn_mm3 = pieces(&points).iter().map(|p| p.volume_mm3).sum::<f64>();
        let open_mm3 = (1.0 - std::f64::consts::FRAC_PI_4) * 0.225 * 0.225 * 0.08 / 0.45;
        assert!((held_mm3 - drawn_mm3 - open_mm3).abs() < 1e-9, "{}", held_mm3 - drawn_mm3);
        let widest_mm2 = out.iter().map(|p| p.area_mm2).fold(0.0, f64::max);
        assert!((0.105..0.125).contains(&widest_mm2), "the arc holds what the corner would: {widest_mm2}");
    }

    #[test]
    fn the_slower_a_bead_the_more_may_its_vertices_turn() {
        let at = |speed| gentle_rad(MmPerS(speed), MmPerS(5.0));
        assert_eq!([0.0, 20.0, 50.0, 100.0, 300.0].map(at), [0.25, 0.25, 0.22, 0.11, 0.1]);
    }

    #[test]
    fn curves_that_are_seen_are_fine_even_if_they_are_slow() {
        assert_eq!(curve_rad(Role::ExternalPerimeter, 0.25), SEEN_RAD);
        assert_eq!(curve_rad(Role::ExternalPerimeter, 0.1), 0.1);
        assert_eq!(curve_rad(Role::Perimeter, 0.25), 0.25);
    }

    #[test]
    fn the_turn_of_a_zigzag_becomes_a_half_circle() {
        let points = [[0.0, 0.0], [9.0, 0.0], [9.0, 0.41], [0.0, 0.41]];
        let mut out = Vec::new();
        round_corners(points[0], &pieces(&points), &Rounding::of(Role::InternalInfill, 0.45, 0.15), &mut out);
        assert!(sharpest(points[0], &out) < 0.4, "{out:?}");
        assert!(out.iter().all(|p| distance_mm(p.to, [9.0, 0.0]) > 0.08));
        assert!((out.iter().map(|p| p.volume_mm3).sum::<f64>() - 0.08 * 18.41).abs() < 1e-9);
        assert_eq!(out.last().map(|p| p.to), Some(points[3]));
    }

    #[test]
    fn a_coarse_circle_gets_finer_and_rounder_and_a_hexagon_does_not() {
        let ring = |count: u32, radius_mm: f64| -> Vec<[f64; 2]> {
            let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
            (0..=count).map(|k| [radius_mm * angle(k).cos(), radius_mm * angle(k).sin()]).collect()
        };
        let (circle, hexagon) = (ring(20, 1.0), ring(6, 5.0));
        let mut out = Vec::new();
        refine_curves(circle[0], &pieces(&circle), 0.1, &mut out);
        // The first and the last piece have a neighbour on one side only.
        let inner = &out[4..out.len() - 4];
        assert!(
            inner.len() >= 55 && inner.iter().all(|p| (distance_mm(p.to, [0.0, 0.0]) - 1.0).abs() < 0.001)
        );
        assert!(out.windows(2).all(|p| distance_mm(p[0].to, p[1].to) > 0.05));
        out.clear();
        refine_curves(hexagon[0], &pieces(&hexagon), 0.1, &mut out);
        assert_eq!(out, pieces(&hexagon));
    }

    proptest! {
        #[test]
        fn volume_and_ends_stay_whatever_the_path(
            steps in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 1..40),
        ) {
            let mut at = [0.0, 0.0];
            let mut points = vec![at];
            points.extend(steps.iter().map(|s| { at = [at[0] + s.0, at[1] + s.1]; at }));
            let plain = pieces(&points);
            let volume: f64 = plain.iter().map(|p| p.volume_mm3).sum();
            let (mut fine, mut round) = (Vec::new(), Vec::new());
            refine_curves(points[0], &plain, 0.1, &mut fine);
            round_corners(points[0], &plain, &Rounding::of(Role::InternalInfill, 0.45, 0.15), &mut round);
            let mut blunt = Vec::new();
            round_corners(points[0], &plain, &Rounding::of(Role::ExternalPerimeter, 0.45, 0.15), &mut blunt);
            let mut sharp = Vec::new();
            round_corners(points[0], &plain, &Rounding::of(Role::SolidInfill, 0.45, 0.15), &mut sharp);
            // At most so much is open beside each corner of inner walls and solid infill.
            let open = 0.08 * 0.1125 * (real::tan(1.05) - 1.05) * plain.len() as f64;
            for (out, more) in [(fine, 0.0), (round, 0.0), (blunt, 0.0), (sharp, open)] {
                let held = out.iter().map(|p| p.volume_mm3).sum::<f64>();
                prop_assert!((volume - 1e-9..volume + more + 1e-9).contains(&held));
                prop_assert!(out.iter().all(|p| p.volume_mm3 >= -1e-12 && p.area_mm2.is_finite()));
                prop_assert_eq!(out.last().map(|p| p.to), Some(at));
            }
        }
    }
}
