//! Order statistics.

use std::borrow::Borrow;

/// Quantile `q`, 0 to 1, of the finite values, linearly interpolated (R. Hyndman and Y. Fan, The American
/// Statistician 50 (1996) 361, definition 7); NaN without finite values.
///
/// ```
/// use vibro_record::quantile;
/// assert_eq!(quantile([4.0, 1.0, 3.0], 1.0), 4.0);
/// assert_eq!(quantile([4.0, 1.0, f64::NAN, 2.0], 0.25), 1.5);
/// ```
pub fn quantile(values: impl IntoIterator<Item = impl Borrow<f64>>, q: f64) -> f64 {
    let mut finite: Vec<f64> = values.into_iter().map(|v| *v.borrow()).filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return f64::NAN;
    }
    let place = q.clamp(0.0, 1.0) * (finite.len() - 1) as f64;
    let (_, &mut low, above) = finite.select_nth_unstable_by(place as usize, f64::total_cmp);
    let next = above.iter().copied().filter(|_| place.fract() > 0.0).min_by(f64::total_cmp);
    next.map_or(low, |next| low + place.fract() * (next - low))
}

/// Median of the finite values; for an even number the mean of the middle two; NaN without finite values.
///
/// ```
/// assert_eq!(vibro_record::median([4.0, 1.0, 3.0, 2.0]), 2.5);
/// assert!(vibro_record::median([0.0; 0]).is_nan());
/// ```
pub fn median(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    quantile(values, 0.5)
}

/// Upper median: always one of the values, for an even number the higher of the middle two; NaN for no
/// values. It is found without a copy, and leaves the values in another order.
///
/// ```
/// assert_eq!(vibro_record::upper_median(&mut [4.0, 1.0, 3.0, 2.0]), 3.0);
/// assert!(vibro_record::upper_median(&mut []).is_nan());
/// ```
pub fn upper_median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
