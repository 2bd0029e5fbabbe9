//! Trains of bounces in which scatter of R rules the first flights and noise of the onsets the last.

use super::draws::Draws;
use super::noise::Noise;
use super::restitution::{outliers, train};
use vibroimpact::measure::restitution::{Measured, restitution};

const CASES: u64 = 600;

/// Cases of which the intervals hold R, and cases in which a flight was left out. `from` is the first seed.
fn held(
    draws: Draws,
    from: u64,
    r: f64,
    flights: usize,
    per_bounce: f64,
    timing: f64,
    stated: bool,
) -> (usize, usize) {
    let (mut inside, mut named) = (0, 0);
    for seed in 0..draws.of(CASES) {
        let mut one = train(&mut Noise::new(from + seed), r, flights, per_bounce, timing);
        one.onset_std = one.onset_std.filter(|_| stated);
        let found =
            restitution(&Measured { trains: vec![one], contact_time: Some(0.0), ..Measured::default() })
                .unwrap();
        named += usize::from(outliers(&found) > 0);
        let std = found.restitution.std.unwrap();
        inside += usize::from((found.restitution.value - r).abs() < draws.reach() * std);
    }
    (inside, named)
}

fn scatter_of_the_first_flights_is_covered_beside_noise_of_the_last(draws: Draws) {
    let cases = [
        (0.62, 6, 0.005, 1e-4),
        (0.62, 6, 0.01, 3e-4),
        (0.62, 8, 0.005, 1e-4),
        (0.62, 8, 0.005, 3e-4),
        (0.62, 10, 0.003, 3e-4),
        (0.62, 10, 0.005, 3e-4),
        (0.62, 12, 0.01, 1e-4),
        (0.8, 12, 0.003, 1e-4),
        (0.8, 12, 0.005, 5e-4),
    ];
    for (k, (r, flights, per_bounce, timing)) in cases.into_iter().enumerate() {
        for stated in [true, false] {
            let from = 160_000 + CASES * k as u64;
            let (inside, named) = held(draws, from, r, flights, per_bounce, timing, stated);
            let coverage = inside as f64 / draws.of(CASES) as f64;
            println!(
                "bounces, R {r} ± {per_bounce}, onsets {timing:e} s{}, {flights} flights: {CASES} cases, seeds {from}.., 95 % coverage {:.1} %, {named} with a flight left out",
                if stated { "" } else { " (not stated)" },
                100.0 * coverage
            );
            // Where the noise of the first ratio, √6 σ over 0.2 s, is as large as the scatter of R, flights
            // do not show how small that is: it errs to the safe side. 600 cases scatter the
            // coverage by 0.9 %.
            let most = if 6f64.sqrt() * timing / 0.2 > 0.5 * per_bounce { 1.0 } else { 0.98 };
            assert!(
                draws.part(0.92..=most).contains(&coverage),
                "{per_bounce} {timing} {flights} {stated}: {coverage}"
            );
        }
    }
}

/// The short flights scatter the more, without being wrong.
#[test]
fn noise_of_the_onsets_makes_no_outliers() {
    for (r, flights, timing) in [(0.62, 10, 3e-4), (0.62, 8, 3e-4), (0.8, 12, 5e-4)] {
        let (_, named) = held(Draws::All, 170_000, r, flights, 0.0, timing, true);
        println!(
            "bounces, R {r}, onsets {timing:e} s, {flights} flights: {CASES} cases, seeds 170000.., a flight left out in {named}"
        );
        // The quantile leaves out 0.1 % of flights, both sides together: 1.2 % of trains of twelve.
        // Neighbouring flights share their onsets, and where they are not much longer than the noise
        // their logarithms are not normal: three times that.
        assert!(named as f64 <= 0.036 * CASES as f64, "{r} {flights}: {named}");
    }
}

/// Few draws: no truth lies far outside.
mod few {
    use super::Draws;

    #[test]
    fn scatter_of_the_first_flights_is_covered_beside_noise_of_the_last() {
        super::scatter_of_the_first_flights_is_covered_beside_noise_of_the_last(Draws::Few);
    }
}

/// All draws: the statistic.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn scatter_of_the_first_flights_is_covered_beside_noise_of_the_last() {
        super::scatter_of_the_first_flights_is_covered_beside_noise_of_the_last(Draws::All);
    }
}
