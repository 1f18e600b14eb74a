//! The machine that moves are planned for.

/// The firmware whose planner a machine follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Firmware {
    /// Klipper: square corner velocity, minimum cruise ratio, stops around moves of the extruder alone.
    Klipper,
    /// Marlin 2 with junction deviation, S-curve acceleration off.
    Marlin,
    /// Marlin 2 with classic jerk, as many slicers estimate.
    MarlinClassic,
    /// RepRapFirmware 3: jerk (M566), stops between printing and travel (jerk policy 0).
    RepRapFirmware,
}

impl Firmware {
    /// Every firmware with its name on the command line.
    pub const ALL: [(&'static str, Self); 4] = [
        ("klipper", Self::Klipper),
        ("marlin", Self::Marlin),
        ("marlin-classic", Self::MarlinClassic),
        ("reprapfirmware", Self::RepRapFirmware),
    ];

    /// The firmware of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, firmware)| *firmware)
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

/// The amounts and speeds of G10 and G11.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirmwareRetraction {
    /// Filament retracted, millimetres.
    pub length_mm: f64,
    /// Pushed forward beyond that.
    pub extra_mm: f64,
    /// Speed of retraction, mm/s.
    pub speed: f64,
    /// Speed of unretraction, mm/s.
    pub unretract_speed: f64,
}

/// Limits of a machine, in millimetres and seconds. Each firmware uses those that it knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Whose rules hold.
    pub firmware: Firmware,
    /// Top speed of X, Y, Z and E. Klipper's limit for X and Y together is that of X.
    pub max_speed: [f64; 4],
    /// Largest acceleration of X, Y, Z and E. Klipper knows Z's and E's only.
    pub max_acceleration: [f64; 4],
    /// Acceleration in force until the moves say otherwise.
    pub acceleration: f64,
    /// Klipper: speed at which a right-angled corner is taken.
    pub square_corner_velocity: f64,
    /// Klipper: step that the extruder's speed may make at a corner.
    pub extruder_corner_velocity: f64,
    /// Klipper: least share of a move to cruise: short zigzags are taken more slowly.
    pub min_cruise_ratio: f64,
    /// Marlin: how far the arc that a corner's speed is computed from leaves the corner.
    pub junction_deviation_mm: f64,
    /// Classic jerk and RepRapFirmware: step that the speed of X, Y, Z and E may make.
    pub jerk: [f64; 4],
    /// RepRapFirmware: jerk also between printing and travel (`M566 P1`).
    pub jerk_everywhere: bool,
    /// The amounts and speeds of G10 and G11.
    pub retraction: FirmwareRetraction,
    /// How long a change of tool takes where the file does not say it, or whatever it says; and how quickly a nozzle is heated,
    /// °C/s, where it does not.
    pub change_s: f64,
    /// See `change_s`.
    pub change_is_fixed: bool,
    /// See `change_s`.
    pub heating_rate: f64,
    /// Cross-section of the filament, which turns volumes into E.
    pub filament_area_mm2: f64,
}

impl Machine {
    /// Junction deviation × acceleration of a machine with this square corner velocity.
    pub(crate) fn corner_acceleration_mm(&self) -> f64 {
        self.square_corner_velocity * self.square_corner_velocity * (std::f64::consts::SQRT_2 - 1.0)
    }
}
