//! What firmwares say differently; all else is common.

mod dialect;
mod klipper;
mod marlin;
mod marlin_legacy;
mod reprapfirmware;

use crate::gcode::options::Flavor;

pub(super) use dialect::{Dialect, Purpose, line};

/// The dialect of a flavour.
pub(super) fn dialect(flavor: Flavor) -> &'static dyn Dialect {
    match flavor {
        Flavor::Marlin => &marlin::Marlin,
        Flavor::MarlinLegacy => &marlin_legacy::MarlinLegacy,
        Flavor::Klipper => &klipper::Klipper,
        Flavor::RepRapFirmware => &reprapfirmware::RepRapFirmware,
    }
}
