//! Order by number, and order statistics.

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

/// Sorts `items` by a number of each, the smallest first. Items of equal numbers keep their order; 0 comes
/// behind -0, NaN at the end.
///
/// The numbers are sorted apart from the items: this is one sort for all types of items, where `sort_by` is
/// built anew for each.
///
/// ```
/// let mut masses = [("striker", 0.14), ("bit", 0.08)];
/// vibro_record::sort_by_number(&mut masses, |mass| mass.1);
/// assert_eq!(masses[0].0, "bit");
/// ```
pub fn sort_by_number<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let mut order = order(items.iter().map(number).collect());
    for to in 0..items.len() {
        // An item before `to` is in its place, and what stood there has been swapped to where `order` tells.
        let mut from = order[to];
        while from < to {
            from = order[from];
        }
        order[to] = from;
        items.swap(to, from);
    }
}

/// The places of `numbers` in ascending order.
fn order(numbers: Vec<f64>) -> Vec<usize> {
    let mut placed: Vec<(f64, usize)> = numbers.into_iter().zip(0..).collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    placed.into_iter().map(|(_, place)| place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_sorted_as_by_the_standard_library() {
        // Two hundred numbers in steps of 1 to 37 round a circle, the small steps with many equal numbers.
        for step in 1_usize..38 {
            let numbers = (0..200).map(|i| (i * step % 37) as f64 / 2.0 - 7.0);
            let mut items: Vec<(f64, usize)> = numbers.zip(0..).collect();
            let mut expected = items.clone();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            sort_by_number(&mut items, |item| item.0);
            assert_eq!(items, expected);
        }
    }

    #[test]
    fn not_a_number_comes_last_and_a_negative_zero_first() {
        let mut items = [f64::NAN, 1.0, 0.0, -0.0, f64::NEG_INFINITY];
        sort_by_number(&mut items, |item| *item);
        assert_eq!(format!("{items:?}"), "[-inf, -0.0, 0.0, 1.0, NaN]");
    }
}
