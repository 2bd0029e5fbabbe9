//! Runge–Kutta scheme of order 5(4) of Dormand and Prince.

use super::{Scheme, TERMS, combine};

/// Six stages and the derivative at the end of the step, which is the first stage of the next step: first
/// same as last (FSAL).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DormandPrince;

/// Weights of the error estimate: those of order 5 minus those of order 4.
pub(super) const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Weights of each stage in the dense output, for the powers 1 to 4 of the time since the start of the step
/// divided by its duration (Shampine 1986).
pub(super) const DENSE: [[f64; 4]; 7] = [
    [
        1.0,
        -8_048_581_381.0 / 2_820_520_608.0,
        8_663_915_743.0 / 2_820_520_608.0,
        -12_715_105_075.0 / 11_282_082_432.0,
    ],
    [0.0; 4],
    [
        0.0,
        131_558_114_200.0 / 32_700_410_799.0,
        -68_118_460_800.0 / 10_900_136_933.0,
        87_487_479_700.0 / 32_700_410_799.0,
    ],
    [
        0.0,
        -1_754_552_775.0 / 470_086_768.0,
        14_199_869_525.0 / 1_410_260_304.0,
        -10_690_763_975.0 / 1_880_347_072.0,
    ],
    [
        0.0,
        127_303_824_393.0 / 49_829_197_408.0,
        -318_862_633_887.0 / 49_829_197_408.0,
        701_980_252_875.0 / 199_316_789_632.0,
    ],
    [0.0, -282_668_133.0 / 205_662_961.0, 2_019_193_451.0 / 616_988_883.0, -1_453_857_185.0 / 822_651_844.0],
    [0.0, 40_617_522.0 / 29_380_423.0, -110_615_467.0 / 29_380_423.0, 69_997_945.0 / 29_380_423.0],
];

impl Scheme for DormandPrince {
    // Butcher tableau: the times of the stages, and for each stage the weights of the earlier ones.
    const NODES: &'static [f64] = &[0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
    const ROWS: &'static [&'static [f64]] = &[
        &[0.2],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    ];
    const END_STAGE: usize = 6;
    const STEP_SIZE_EXPONENT: f64 = 1.0 / 5.0;

    // Root mean square over the components.
    fn error<const N: usize>(rates: &[[f64; N]], step: f64, tolerated: &[f64; N]) -> f64 {
        let error = combine(rates, &ERROR);
        error.iter().zip(tolerated).map(|(e, t)| (step * e / t).powi(2)).sum::<f64>().sqrt()
            / (N as f64).sqrt()
    }

    fn dense<const N: usize>(
        rates: &[[f64; N]],
        step: f64,
        start: &[f64; N],
        _end: &[f64; N],
    ) -> [[f64; N]; TERMS] {
        let mut terms = [[0.0; N]; TERMS];
        terms[0] = *start;
        for power in 0..4 {
            let weights: [f64; 7] = std::array::from_fn(|i| DENSE[i][power]);
            terms[power + 1] = combine(rates, &weights).map(|sum| step * sum);
        }
        terms
    }
}
