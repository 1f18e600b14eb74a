//! Quantities with their units, used at the seams between stages.
//!
//! Only the operators that make sense exist: a length plus a length, a length times a number, a length
//! over a speed. Kernels unwrap the value (`.0`) and carry the unit in the variable's name (`length_mm`).

use serde::{Deserialize, Serialize};

macro_rules! quantity {
    ($(#[$doc:meta] $name:ident $symbol:literal;)*) => {$(
        #[$doc]
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl std::ops::Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self { Self(self.0 + other.0) }
        }
        impl std::ops::Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self { Self(self.0 - other.0) }
        }
        impl std::ops::AddAssign for $name {
            fn add_assign(&mut self, other: Self) { self.0 += other.0; }
        }
        impl std::ops::Mul<f64> for $name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self { Self(self.0 * factor) }
        }
        impl std::ops::Div<f64> for $name {
            type Output = Self;
            fn div(self, divisor: f64) -> Self { Self(self.0 / divisor) }
        }
        impl std::ops::Div for $name {
            type Output = f64;
            fn div(self, other: Self) -> f64 { self.0 / other.0 }
        }
        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.0.fmt(f)?;
                f.write_str($symbol)
            }
        }
    )*};
}

quantity! {
    /// A length in millimetres.
    Mm " mm";
    /// A speed in millimetres per second.
    MmPerS " mm/s";
    /// An acceleration in millimetres per second squared.
    MmPerS2 " mm/s²";
    /// A volume in cubic millimetres.
    Mm3 " mm³";
    /// A flow in cubic millimetres per second.
    Mm3PerS " mm³/s";
    /// A duration in seconds.
    Seconds " s";
    /// A temperature in degrees Celsius.
    Celsius " °C";
}

/// A share between 0 and 1; profiles write `0.2` or `"20%"`.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Ratio(pub f64);

impl Serialize for Ratio {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

impl<'de> Deserialize<'de> for Ratio {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Share(f64),
            Percent(String),
        }
        match Written::deserialize(deserializer)? {
            Written::Share(share) => Ok(Self(share)),
            Written::Percent(text) => text
                .strip_suffix('%')
                .and_then(|number| number.trim().parse::<f64>().ok())
                .map(|percent| Self(percent / 100.0))
                .ok_or_else(|| {
                    serde::de::Error::custom(format!("`{text}` is neither a number nor a percentage"))
                }),
        }
    }
}

impl std::ops::Div<MmPerS> for Mm {
    type Output = Seconds;
    fn div(self, speed: MmPerS) -> Seconds {
        Seconds(self.0 / speed.0)
    }
}
