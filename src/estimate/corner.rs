//! How fast a machine starts, stops, and takes the corner between two moves.

use geometry::real;

use super::{Firmware, Machine};

/// What the corners at both ends of a move depend on.
#[derive(Clone, Copy, Debug)]
pub(super) struct CornerMove {
    /// Displacement of X, Y, Z and E per millimetre in space; of moves of E alone, per millimetre of E.
    pub unit: [f64; 4],
    /// Of unit length with E as a fourth direction, where the machine's rules ask for it.
    pub direction: [f64; 4],
    pub length_mm: f64,
    pub in_space: bool,
    /// Speed and acceleration of the move, every limit observed.
    pub speed: f64,
    pub acceleration: f64,
    /// The acceleration before axes' limits.
    pub asked_acceleration: f64,
    /// Speed at which it may begin or end at rest.
    pub rest_speed: f64,
}

impl CornerMove {
    fn moves_in_plane(&self) -> bool {
        self.unit[0] != 0.0 || self.unit[1] != 0.0
    }

    fn prints(&self) -> bool {
        self.unit[3] > 0.0 && self.moves_in_plane()
    }
}

/// A vector of unit length; of no length where it has none.
fn normal(v: [f64; 4]) -> [f64; 4] {
    let scale = v.iter().map(|c| c * c).sum::<f64>().sqrt().max(f64::MIN_POSITIVE).recip();
    v.map(|c| c * scale)
}

impl Machine {
    /// The [direction](CornerMove::direction) of a move.
    pub(super) fn direction(&self, delta: [f64; 4], unit: [f64; 4]) -> [f64; 4] {
        // Of the displacement, which is known before the unit is.
        if self.firmware == Firmware::Marlin { normal(delta) } else { unit }
    }

    /// Speed and acceleration that the axes allow a move of this direction.
    pub(super) fn limited(&self, unit: &[f64; 4], in_space: bool, speed: f64, asked: f64) -> (f64, f64) {
        let klipper = self.firmware == Firmware::Klipper;
        let (mut speed, mut acceleration) = (speed, asked);
        let mut first = 0;
        let mut last = 4;
        if klipper {
            // X and Y have one limit together; E is held back only where it goes alone or backwards.
            first = 2;
            last = if unit[3] < 0.0 || (unit[0] == 0.0 && unit[1] == 0.0) { 4 } else { 3 };
            if in_space {
                speed = speed.min(self.max_speed[0]);
            }
        }
        let is_within = |axis: usize| {
            let share = unit[axis].abs();
            speed * share <= self.max_speed[axis] && acceleration * share <= self.max_acceleration[axis]
        };
        if (first..last).all(is_within) {
            return (speed, acceleration);
        }
        let limits = self.max_speed[first..last].iter().zip(&self.max_acceleration[first..last]);
        for (part, (&max_speed, &max_acceleration)) in unit[first..last].iter().zip(limits) {
            let share = part.abs();
            if speed * share > max_speed {
                speed = max_speed / share;
            }
            if acceleration * share > max_acceleration {
                acceleration = max_acceleration / share;
            }
        }
        (speed, acceleration)
    }

    /// Speed at which a move may begin from rest and end in it: with classic jerk, not zero.
    pub(super) fn rest_speed(&self, unit: &[f64; 4], speed: f64) -> f64 {
        match self.firmware {
            Firmware::MarlinClassic => self.jerk_speed(unit, speed),
            _ => 0.0,
        }
    }

    /// The largest speed, up to `speed`, at which no axis steps by more than its jerk if shares of the speed
    /// step by `step`.
    fn jerk_speed(&self, step: &[f64; 4], speed: f64) -> f64 {
        step.iter().zip(self.jerk).fold(speed, |speed, (step, jerk)| {
            if speed * step.abs() > jerk { jerk / step.abs() } else { speed }
        })
    }

    /// The square of the speed at which the corner between two moves can be taken.
    pub(super) fn corner_v2(&self, before: &CornerMove, now: &CornerMove) -> f64 {
        let slower = before.speed.min(now.speed);
        let v2 = slower * slower;
        match self.firmware {
            Firmware::Klipper => v2.min(self.klipper_v2(before, now, v2)),
            Firmware::Marlin => self.junction_v2(before, now, v2),
            Firmware::MarlinClassic => self.classic_speed(before, now).powi(2),
            Firmware::RepRapFirmware => {
                let alike =
                    before.prints() == now.prints() && before.moves_in_plane() == now.moves_in_plane();
                if alike || self.jerk_everywhere {
                    let step = [0, 1, 2, 3].map(|i| now.unit[i] - before.unit[i]);
                    self.jerk_speed(&step, slower).powi(2)
                } else {
                    0.0
                }
            }
        }
    }

    /// Klipper: the arc that leaves the corner by a fixed distance, taken at the acceleration in force, which
    /// must not begin before the middle of either move; and a step of the extruder. Moves of the extruder alone are
    /// begun and ended at rest. <https://www.klipper3d.org/Kinematics.html>
    fn klipper_v2(&self, before: &CornerMove, now: &CornerMove, v2: f64) -> f64 {
        if !(before.in_space && now.in_space) {
            return 0.0;
        }
        let mut v2 = v2;
        let (a, b) = (&before.unit, &now.unit);
        let e_step = (b[3] - a[3]).abs();
        let step = self.extruder_corner_velocity;
        if e_step * e_step * v2 > step * step {
            v2 = (step / e_step).powi(2);
        }
        let straightness = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        // Half the angle between the two moves seen from the corner: 90° when straight on, 0 when turning back.
        let sine = (0.5 * (1.0 + straightness)).max(0.0).sqrt();
        let cosine = (0.5 * (1.0 - straightness)).max(0.0).sqrt();
        if cosine < 1e-4 {
            return v2;
        }
        let tangent = 0.5 * sine / cosine;
        let reach = |at: &CornerMove| {
            let share = at.acceleration / at.asked_acceleration;
            (sine / (1.0 - sine) * share * self.corner_acceleration_mm())
                .min(tangent * at.length_mm * at.acceleration)
        };
        v2.min(reach(before)).min(reach(now))
    }

    /// Marlin's junction deviation (S. K. Jeon, "Improving Grbl: Cornering Algorithm", 2011), with the extruder as
    /// a fourth direction and the acceleration that the axes allow across the corner. Short moves of a smooth curve
    /// are also held to the circle that they are part of. At most `limit_v2`.
    fn junction_v2(&self, before: &CornerMove, now: &CornerMove, limit_v2: f64) -> f64 {
        let (a, b) = (before.direction, now.direction);
        let straightness = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        if straightness < -0.999_999 {
            return 0.0;
        }
        let straightness = straightness.min(0.999_999);
        let across = [0, 1, 2, 3].map(|i| b[i] - a[i]);
        let mut acceleration = now.acceleration;
        // Squares tell whether an axis' share is too much for it, without a root; nearly always that is all.
        let turn2 = across.iter().map(|part| part * part).sum::<f64>();
        let limits = across.iter().zip(self.max_acceleration);
        if limits.into_iter().any(|(part, max)| (acceleration * part).powi(2) > max * max * turn2) {
            for (share, max) in normal(across).into_iter().zip(self.max_acceleration) {
                if acceleration * share.abs() > max {
                    acceleration = max / share.abs();
                }
            }
        }
        let sine2 = 0.5 * (1.0 + straightness);
        let arc_v2 = acceleration * self.junction_deviation_mm;
        let v2 = if sine2 * (limit_v2 + arc_v2).powi(2) >= limit_v2 * limit_v2 {
            limit_v2
        } else {
            let sine = sine2.sqrt();
            arc_v2 * sine / (1.0 - sine)
        };
        // A curve: it turns by less than 45° each time.
        if now.length_mm < 1.0 && straightness > std::f64::consts::FRAC_1_SQRT_2 {
            // An angle up to 45° is at most 1.0262 times its chord. Nearly always that is enough to know.
            let chord2 = 2.0 * (1.0 - straightness);
            let reach = now.length_mm * acceleration;
            if reach * reach < v2 * v2 * (1.03 * 1.03 * chord2) {
                return v2.min(reach / real::acos(straightness));
            }
        }
        v2
    }

    /// Marlin's classic jerk: an axis that continues in its direction may step by its jerk, one that turns round
    /// may go to or from rest at it.
    fn classic_speed(&self, before: &CornerMove, now: &CornerMove) -> f64 {
        let slower = before.speed.min(now.speed);
        let mut factor = 1.0;
        for axis in 0..4 {
            let (exit, entry) = (before.unit[axis] * slower * factor, now.unit[axis] * slower * factor);
            let turns = exit * entry < 0.0;
            let step = if turns { exit.abs().max(entry.abs()) } else { (exit - entry).abs() };
            if step > self.jerk[axis] {
                factor *= self.jerk[axis] / step;
            }
        }
        let corner = slower * factor;
        // Where both moves may stop dead from a higher speed, they do.
        if before.rest_speed > 0.99 * corner && now.rest_speed > 0.99 * corner {
            now.rest_speed.min(slower)
        } else {
            corner
        }
    }
}
