//! The machine that moves are planned for.

use crate::profile::{Flavor, Settings};

/// Whose rules a machine plans by.
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

impl From<Flavor> for Firmware {
    fn from(flavor: Flavor) -> Self {
        match flavor {
            Flavor::Marlin => Self::Marlin,
            Flavor::Klipper => Self::Klipper,
            Flavor::RepRapFirmware => Self::RepRapFirmware,
        }
    }
}

/// What G10 and G11 do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirmwareRetraction {
    /// Filament pulled back, millimetres.
    pub length_mm: f64,
    /// Pushed forward beyond that.
    pub extra_mm: f64,
    /// Speed of pulling back, mm/s.
    pub speed: f64,
    /// Speed of pushing forward, mm/s.
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
    /// What G10 and G11 do.
    pub retraction: FirmwareRetraction,
    /// Cross-section of the strand, which turns volumes into E.
    pub filament_area_mm2: f64,
}

impl Machine {
    /// The machine of the settings, under the firmware that they are for.
    pub fn new(settings: &Settings) -> Self {
        Self::under(settings.printer.flavor.into(), settings)
    }

    /// The machine of the settings under any firmware.
    pub fn under(firmware: Firmware, settings: &Settings) -> Self {
        let (machine, retract) = (&settings.machine, &settings.retract);
        let mut made = Self {
            firmware,
            max_speed: machine.max_speed.map(|v| v.0),
            max_acceleration: machine.max_acceleration.map(|a| a.0),
            acceleration: machine.max_acceleration[0].0,
            square_corner_velocity: machine.square_corner_velocity.0,
            extruder_corner_velocity: machine.extruder_corner_velocity.0,
            min_cruise_ratio: machine.min_cruise_ratio.0,
            junction_deviation_mm: machine.junction_deviation.0,
            jerk: machine.jerk.map(|v| v.0),
            jerk_everywhere: false,
            retraction: FirmwareRetraction {
                length_mm: retract.length.0,
                extra_mm: retract.extra.0.max(0.0),
                speed: retract.speed.0,
                unretract_speed: retract.unretract_speed.0,
            },
            filament_area_mm2: settings.filament.area_mm2(),
        };
        if made.junction_deviation_mm <= 0.0 {
            let usual = Some(settings.acceleration.default.0).filter(|a| *a > 0.0);
            made.junction_deviation_mm =
                made.corner_acceleration_mm() / usual.unwrap_or(made.acceleration).min(made.acceleration);
        }
        made
    }

    /// Junction deviation × acceleration of a machine with this square corner velocity.
    pub(super) fn corner_acceleration_mm(&self) -> f64 {
        self.square_corner_velocity * self.square_corner_velocity * (std::f64::consts::SQRT_2 - 1.0)
    }
}
