//! What the machine can do.

use crate::options::section;
use crate::units::{Mm, MmPerS, MmPerS2, Ratio};

section! {
    /// `[machine]`: limits that the time estimate and the ordering's time cost use, and that `gcode.limits` states.
    MachineSettings {
        /// Top speed of X, Y, Z and E.
        max_speed: [MmPerS; 4] = [MmPerS(300.0), MmPerS(300.0), MmPerS(15.0), MmPerS(80.0)]; 0.1..=5000.0,
        /// Largest acceleration of X, Y, Z and E.
        max_acceleration: [MmPerS2; 4] = [MmPerS2(3000.0), MmPerS2(3000.0), MmPerS2(100.0), MmPerS2(800.0)]; 1.0..=100000.0,
        /// Acceleration of printing moves that `gcode.limits` states (M204); 0: none.
        print_acceleration: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// The same of retractions.
        retract_acceleration: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// The same of travel.
        travel_acceleration: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Least speed of printing and of travel that `gcode.limits` states (Marlin).
        min_speed: [MmPerS; 2] = [MmPerS(0.0), MmPerS(0.0)]; 0.0..=1000.0,
        /// Speed at which a 90° corner is taken (Klipper).
        square_corner_velocity: MmPerS = MmPerS(5.0); 0.0..=100.0,
        /// Step that the extruder's speed may make at a corner (Klipper's `instantaneous_corner_velocity`).
        extruder_corner_velocity: MmPerS = MmPerS(1.0); 0.0..=100.0,
        /// Minimum share of a move to cruise (Klipper).
        min_cruise_ratio: Ratio = Ratio(0.5); 0.0..=0.99,
        /// Junction deviation (Marlin); 0: the one that takes a 90° corner at `square_corner_velocity`.
        junction_deviation: Mm = Mm(0.0); 0.0..=1.0,
        /// Step that the speed of X, Y, Z and E may make (RepRapFirmware, classic jerk).
        jerk: [MmPerS; 4] = [MmPerS(10.0), MmPerS(10.0), MmPerS(0.4), MmPerS(5.0)]; 0.01..=1000.0,
    }
}
