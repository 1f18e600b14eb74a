//! What limits a machine.

use crate::profile::{Flavor, Settings};
use crate::units::Mm;

/// Limits of a machine, in millimetres and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Top speed of X, Y, Z and E.
    pub max_speed: [f64; 4],
    /// Largest acceleration of X, Y, Z and E.
    pub max_acceleration: [f64; 4],
    /// Acceleration in force until the moves say otherwise.
    pub acceleration: f64,
    /// Speed at which a right-angled corner is taken.
    pub square_corner_velocity: f64,
    /// Step that the extruder's speed may make at a corner.
    pub extruder_corner_velocity: f64,
    /// Least share of a move to cruise (Klipper's `minimum_cruise_ratio`): short zigzags are taken more slowly.
    pub min_cruise_ratio: f64,
    /// Cross-section of the strand, which turns volumes into E.
    pub filament_area_mm2: f64,
}

impl Machine {
    /// The machine of the settings.
    pub fn new(settings: &Settings) -> Self {
        let machine = &settings.machine;
        let Mm(diameter) = settings.filament.diameter;
        Self {
            max_speed: machine.max_speed.map(|v| v.0),
            max_acceleration: machine.max_acceleration.map(|a| a.0),
            acceleration: machine.max_acceleration[0].0,
            square_corner_velocity: machine.square_corner_velocity.0,
            // Klipper's default; Marlin's E jerk of 5 mm/s hardly ever matters either.
            extruder_corner_velocity: 1.0,
            // Klipper's default; the others have no such rule.
            min_cruise_ratio: if settings.printer.flavor == Flavor::Klipper { 0.5 } else { 0.0 },
            filament_area_mm2: std::f64::consts::PI / 4.0 * diameter * diameter,
        }
    }
}
