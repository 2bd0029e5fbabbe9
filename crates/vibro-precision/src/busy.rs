//! A machine that does other work while methods are timed.

use super::Scene;

/// Upper over lower quartile of a time beyond which the runs were not alike.
const UNLIKE: f64 = 1.5;
/// Part of the times that may be so by chance.
const FEW: f64 = 0.1;

/// A sentence, where the times of many methods changed from run to run: short answers fit between what else the machine does, long ones do
/// not, and charts rank them by that.
pub fn busy(scenes: &[Scene]) -> Option<String> {
    let methods = scenes.iter().flat_map(|scene| &scene.methods);
    restless(&methods.filter_map(|m| m.time_spread).collect::<Vec<_>>())
}

fn restless(quartiles: &[[f64; 2]]) -> Option<String> {
    let unlike = quartiles.iter().filter(|[low, high]| *high > UNLIKE * low).count();
    (unlike as f64 > FEW * quartiles.len() as f64).then(|| {
        format!(
            "{unlike} of {} times changed by more than half from run to run: the machine was busy with something else, and neither times nor fronts are \
             to be trusted. Run it again when nothing else runs.",
            quartiles.len()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_restless_times_of_ten_are_said_and_one_is_not() {
        let mut times = [[1.0, 1.4]; 10];
        assert_eq!(restless(&[]), None);
        times[3] = [1.0, 90.0];
        assert_eq!(restless(&times), None);
        times[7] = [2.0, 3.1];
        assert!(restless(&times).is_some_and(|said| said.starts_with("2 of 10 times")));
    }
}
