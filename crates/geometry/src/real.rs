//! Functions of real numbers that are equal to the last bit on every machine, which those of the platform are not.
//!
//! Angles are radians. Sources: the C library musl, by the crate `libm`.

/// The greater of two numbers; the second one where the first is none (NaN).
///
/// Where `max` of the standard library is a call, as in WebAssembly, this is an instruction or two.
#[inline]
pub fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The lesser of two numbers; the second one where the first is none (NaN). See [`greater`].
#[inline]
pub fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The sine.
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// The cosine.
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Sine and cosine.
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// The tangent.
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// The angle in [0, π] with this cosine.
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// The angle in [−π/2, π/2] with this tangent.
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// The angle in (−π, π] of the direction (x, y).
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// x to the power y.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// 2 to the power x.
pub fn exp2(x: f64) -> f64 {
    libm::exp2(x)
}

/// The natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// The cube root.
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// The length of the vector (x, y), whose square must be a number of its type.
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// As [`hypot`], in single precision.
pub fn hypot_f32(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_along_an_axis_are_exact() {
        for x in [0.0, 0.1, 1.0 / 3.0, 123.456, 1e7] {
            assert_eq!((hypot(x, 0.0), hypot(0.0, -x)), (x, x));
        }
        assert_eq!(hypot(3.0, 4.0), 5.0);
    }

    #[test]
    fn values_are_those_of_every_machine_to_the_last_bit() {
        let (sine, cosine) = sin_cos(1e3);
        assert_eq!((sine, cosine), (sin(1e3), cos(1e3)));
        let found = [sin(1e3), cos(1e3), tan(0.7), acos(0.3), atan(2.0), atan2(1.0, -3.0), pow(0.3, 0.7)];
        let bits: Vec<u64> =
            found.iter().chain(&[exp2(0.3), ln(0.7), cbrt(2.0)]).map(|x| x.to_bits()).collect();
        assert_eq!(bits, BITS);
    }

    const BITS: [u64; 10] = [
        0x3fea_75cc_150a_206b,
        0x3fe1_ff02_6793_f1bc,
        0x3fea_f406_c2fc_78ae,
        0x3ff4_41f5_ecbe_ef59,
        0x3ff1_b6e1_92eb_be44,
        0x4006_8f09_5fdf_593c,
        0x3fdb_8d80_9c61_5f41,
        0x3ff3_b2c4_7bff_8329,
        0xbfd6_d3c3_24e1_3f50,
        0x3ff4_28a2_f98d_728b,
    ];
}
