//! Order of things by a number of each.

/// Sorts `items` by a number of each, the smallest first. Items of equal numbers keep their order; 0 comes behind
/// -0, NaN at the end.
///
/// The numbers are sorted apart from the items: this is one sort for all types of items, where `sort_by` is built
/// anew for each.
///
/// ```
/// let mut masses = [("striker", 0.14), ("bit", 0.08)];
/// vibro_math::sort_by_number(&mut masses, |mass| mass.1);
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
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn items_are_sorted_as_by_the_standard_library(
            numbers in prop::collection::vec(
                prop_oneof![-3i32..4, any::<i32>()].prop_map(|n| f64::from(n) / 2.0), 0..200)
        ) {
            let mut items: Vec<(f64, usize)> = numbers.into_iter().zip(0..).collect();
            let mut expected = items.clone();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            sort_by_number(&mut items, |item| item.0);
            prop_assert_eq!(items, expected);
        }
    }

    #[test]
    fn not_a_number_comes_last_and_a_negative_zero_first() {
        let mut items = [f64::NAN, 1.0, 0.0, -0.0, f64::NEG_INFINITY];
        sort_by_number(&mut items, |item| *item);
        assert_eq!(format!("{items:?}"), "[-inf, -0.0, 0.0, 1.0, NaN]");
    }
}
