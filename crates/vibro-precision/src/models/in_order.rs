//! What a method tells of a motion beside what is true of it, one by one in their order.

/// Both lists as far as they go along with each other: places of those that are alike.
pub type Pairs = Vec<[usize; 2]>;

/// Pairs of `truth` and `told`, each in its order, that are `alike`; nothing that `counts` is left over in either. What does not count may be in a
/// pair or not.
///
/// # Errors
/// The places in both lists behind which no such pairs are left.
pub fn in_order<T>(
    truth: &[T],
    told: &[T],
    counts: impl Fn(&T) -> bool,
    alike: impl Fn(&T, &T) -> bool,
) -> Result<Pairs, [usize; 2]> {
    // What cannot stand beside anything that counts needs no pair.
    let kept = |own: &[T], others: &[T]| -> Vec<usize> {
        let wanted = |x: &T| counts(x) || others.iter().any(|y| counts(y) && alike(x, y));
        (0..own.len()).filter(|&i| wanted(&own[i])).collect()
    };
    let (rows, columns) = (kept(truth, told), kept(told, truth));
    let width = columns.len() + 1;
    // How each place is reached: from a pair, or by leaving one out.
    let mut reached = vec![None; (rows.len() + 1) * width];
    reached[0] = Some([0, 0]);
    let mut furthest = [0, 0];
    for i in 0..=rows.len() {
        for j in 0..width {
            if reached[i * width + j].is_none() {
                continue;
            }
            furthest = furthest.max([i, j]);
            let (a, b) = (rows.get(i).map(|&i| &truth[i]), columns.get(j).map(|&j| &told[j]));
            let steps = [
                (a.zip(b).is_some_and(|(a, b)| alike(a, b)), [1, 1]),
                (a.is_some_and(|a| !counts(a)), [1, 0]),
                (b.is_some_and(|b| !counts(b)), [0, 1]),
            ];
            for (_, [down, right]) in steps.into_iter().filter(|s| s.0) {
                reached[(i + down) * width + j + right].get_or_insert([down, right]);
            }
        }
    }
    let (mut i, mut j) = (rows.len(), columns.len());
    if reached[i * width + j].is_none() {
        let place = |kept: &[usize], i: usize, all: usize| kept.get(i).copied().unwrap_or(all);
        return Err([place(&rows, furthest[0], truth.len()), place(&columns, furthest[1], told.len())]);
    }
    let mut pairs = Vec::new();
    while let Some([down, right]) = reached[i * width + j].filter(|_| i + j > 0) {
        (i, j) = (i - down, j - right);
        if down + right == 2 {
            pairs.push([rows[i], columns[j]]);
        }
    }
    pairs.reverse();
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use vibro_math::Noise;

    /// Every way to pair what is left of two lists, tried one after another.
    fn possible(truth: &[(f64, bool)], told: &[(f64, bool)]) -> bool {
        match (truth, told) {
            ([], rest) | (rest, []) => rest.iter().all(|x| !x.1),
            ([a, truth_left @ ..], [b, told_left @ ..]) => {
                ((a.0 - b.0).abs() <= 1.0 && possible(truth_left, told_left))
                    || (!a.1 && possible(truth_left, told))
                    || (!b.1 && possible(truth, told_left))
            }
        }
    }

    #[test]
    fn pairs_are_found_just_where_trying_all_ways_finds_them() {
        let mut noise = Noise::new(41);
        let mut found = [0, 0];
        for _ in 0..3000 {
            let mut list = |n: usize| {
                let mut all: Vec<_> =
                    (0..n).map(|_| (noise.between(0.0, 6.0), noise.uniform() < 0.6)).collect();
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                all
            };
            let (truth, told) = (list(4), list(5));
            let pairs = in_order(&truth, &told, |x| x.1, |a, b| (a.0 - b.0).abs() <= 1.0);
            assert_eq!(pairs.is_ok(), possible(&truth, &told), "{truth:?} {told:?}");
            found[usize::from(pairs.is_ok())] += 1;
            let Ok(pairs) = pairs else { continue };
            assert!(pairs.windows(2).all(|w| w[0][0] < w[1][0] && w[0][1] < w[1][1]));
            assert!(pairs.iter().all(|&[i, j]| (truth[i].0 - told[j].0).abs() <= 1.0));
            let all_told = |list: &[(f64, bool)], side: usize| {
                (0..list.len()).all(|i| !list[i].1 || pairs.iter().any(|p| p[side] == i))
            };
            assert!(all_told(&truth, 0) && all_told(&told, 1));
        }
        assert!(found.iter().all(|n| *n > 300), "{found:?}");
    }

    #[test]
    fn one_that_is_told_serves_one_that_is_true() {
        let alike = |a: &f64, b: &f64| (a - b).abs() <= 1.0;
        let all = |_: &f64| true;
        assert_eq!(in_order(&[1.0, 1.5], &[1.2], all, alike), Err([1, 1]));
        assert_eq!(in_order(&[1.0], &[0.9, 1.2], all, alike), Err([1, 1]));
        assert_eq!(in_order(&[1.0, 5.0], &[1.2, f64::NAN], all, alike), Err([1, 1]));
        assert_eq!(in_order(&[1.0, 5.0], &[1.2, 5.1], all, alike), Ok(vec![[0, 0], [1, 1]]));
    }
}
