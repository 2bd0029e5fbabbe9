//! Sine and cosine together, without a branch, fast enough for the inner loop of a root search.
//!
//! A multiple of π/2 is subtracted from the argument, with π/2 as a sum of two doubles (W. J. Cody and W.
//! Waite, *Software Manual for the Elementary Functions*, 1980). The remainder lies within ±π/4. There the
//! polynomials of fdlibm (`k_sin.c` and `k_cos.c`, Sun Microsystems, 1993) err by less than 2⁻⁵⁸. With
//! rounding the absolute error of sine and cosine is below 2ε/3 = 1.5e-16.

/// 2/π: quarter turns per radian.
const PER_QUARTER: f64 = std::f64::consts::FRAC_2_PI;
/// The first 33 bits of π/2: its products with whole numbers below 2²⁰ are exact.
const QUARTER: f64 = 1.570_796_326_734_125_6;
/// π/2 minus [`QUARTER`].
const QUARTER_REST: f64 = 6.077_100_506_506_192e-11;
/// Magnitude of an argument from which on the system's functions are used: their reduction stays accurate.
const FAR: f64 = 1e6;
/// 1.5·2⁵²: adding it to a number below 2⁵¹ and subtracting it again rounds to the nearest whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// sin x and cos x.
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() < FAR { reduced(x) } else { x.sin_cos() }
}

/// sin x and cos x for |x| below [`FAR`].
#[inline]
fn reduced(x: f64) -> (f64, f64) {
    let shifted = x * PER_QUARTER + ROUND;
    let n = shifted - ROUND;
    let left = x - n * QUARTER;
    let rest = n * QUARTER_REST;
    let y = left - rest;
    let tail = (left - y) - rest;
    let z = y * y;
    // Both polynomials in pairs of terms, which a processor computes in parallel.
    let z2 = z * z;
    let high = (8.333_333_333_322_49e-3 + z * -1.984_126_982_985_795e-4)
        + z2 * ((2.755_731_370_707_006_8e-6 + z * -2.505_076_025_340_686_3e-8)
            + z2 * 1.589_690_995_211_55e-10);
    let v = z * y;
    let sin = y - ((z * (0.5 * tail - v * high) - tail) - v * -1.666_666_666_666_663_2e-1);
    let low = z
        * ((4.166_666_666_666_66e-2 + z * -1.388_888_888_887_411e-3)
            + z2 * ((2.480_158_728_947_673e-5 + z * -2.755_731_435_139_066_3e-7)
                + z2 * (2.087_572_321_298_175e-9 + z * -1.135_964_755_778_819_5e-11)));
    let half = 0.5 * z;
    let w = 1.0 - half;
    let cos = w + (((1.0 - w) - half) + (z * low - y * tail));
    // The last two bits of the whole number give the quadrant; values are swapped and signs set without a
    // branch.
    let quarter = shifted.to_bits();
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let swap = (sin ^ cos) & 0_u64.wrapping_sub(quarter & 1);
    let sign = |negative: u64| (negative & 2) << 62;
    (f64::from_bits(sin ^ swap ^ sign(quarter)), f64::from_bits(cos ^ swap ^ sign(quarter.wrapping_add(1))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    #[test]
    fn it_is_the_systems_sine_and_cosine() {
        // The system's values are accurate to one of their ulps, these to 2ε/3: together below 1.5ε.
        let check = |x: f64| {
            let (sin, cos) = sin_cos(x);
            let (s, c) = x.sin_cos();
            assert!((sin - s).abs() <= 1.5 * f64::EPSILON, "{x}: {sin} {s}");
            assert!((cos - c).abs() <= 1.5 * f64::EPSILON, "{x}: {cos} {c}");
        };
        for i in -200_000_i32..200_000 {
            check(f64::from(i) * 1e-4);
            check(f64::from(i) * 4.999);
        }
        for x in [0.0, -0.0, 1e-300, FRAC_PI_4, -FRAC_PI_2, 999_999.9, 1e7, -3e15] {
            check(x);
        }
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for x in [f64::NAN, f64::INFINITY] {
            let (sin, cos) = sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
