//! Arcs as the firmware moves along them: in chords.

use geometry::real;

/// Length of a chord of an arc, millimetres, as firmware makes them.
const CHORD_MM: f64 = 1.0;

/// The ends of an arc's chords, the last at `to`, and how many they are.
pub(crate) fn chords(
    at: [f64; 2],
    to: [f64; 2],
    center: [f64; 2],
    clockwise: bool,
) -> (f64, impl Iterator<Item = [f64; 2]>) {
    let (u, v) = ([at[0] - center[0], at[1] - center[1]], [to[0] - center[0], to[1] - center[1]]);
    let turn = real::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    let sweep = if clockwise { -turn } else { turn }.rem_euclid(std::f64::consts::TAU);
    let count = (sweep * real::hypot(u[0], u[1]) / CHORD_MM).ceil().clamp(1.0, 1e5);
    let signed = if clockwise { -sweep } else { sweep };
    let between = (1..count as u32).map(move |chord| {
        let (sine, cosine) = real::sin_cos(signed * f64::from(chord) / count);
        [center[0] + u[0] * cosine - u[1] * sine, center[1] + u[0] * sine + u[1] * cosine]
    });
    (count, between.chain([to]))
}
