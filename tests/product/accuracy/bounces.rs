//! Trains of bounces: the scatter of R dominates the first flights, the noise of the onsets the last.

use super::draws::Draws;
use super::noise::Noise;
use super::restitution::{outliers, train};
use vibroimpact::measure::restitution::{Measured, restitution};

const CASES: u64 = 600;

/// Number of cases whose interval holds R, and number of cases in which a flight is left out. `from` is the
/// first seed, `per_bounce` the scatter of R, and `timing` the noise of the onsets in s, which the analysis
/// knows if `stated`.
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
            // The first ratio of flights has a noise of √6 σ over 0.2 s. Where this exceeds half the scatter
            // of R, the flights cannot show how small the scatter is, and intervals are too wide. The
            // coverage of 600 cases scatters by 0.9 %.
            let most = if 6f64.sqrt() * timing / 0.2 > 0.5 * per_bounce { 1.0 } else { 0.98 };
            assert!(
                draws.part(0.92..=most).contains(&coverage),
                "{per_bounce} {timing} {flights} {stated}: {coverage}"
            );
        }
    }
}

/// Short flights scatter more without being outliers.
#[test]
fn noise_of_the_onsets_makes_no_outliers() {
    for (r, flights, timing) in [(0.62, 10, 3e-4), (0.62, 8, 3e-4), (0.8, 12, 5e-4)] {
        let (_, named) = held(Draws::All, 170_000, r, flights, 0.0, timing, true);
        println!(
            "bounces, R {r}, onsets {timing:e} s, {flights} flights: {CASES} cases, seeds 170000.., a flight left out in {named}"
        );
        // Of all flights 0.1 % lie beyond the quantile (both sides): 1.2 % of trains of twelve. Neighbouring
        // flights share an onset, and the logarithm of a flight not much longer than the noise is not
        // normal. Three times that is allowed.
        assert!(named as f64 <= 0.036 * CASES as f64, "{r} {flights}: {named}");
    }
}

/// 4 cases of each kind, run with every test.
mod few {
    use super::Draws;

    #[test]
    fn scatter_of_the_first_flights_is_covered_beside_noise_of_the_last() {
        super::scatter_of_the_first_flights_is_covered_beside_noise_of_the_last(Draws::Few);
    }
}

/// All cases, run with `--ignored`.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn scatter_of_the_first_flights_is_covered_beside_noise_of_the_last() {
        super::scatter_of_the_first_flights_is_covered_beside_noise_of_the_last(Draws::All);
    }
}
