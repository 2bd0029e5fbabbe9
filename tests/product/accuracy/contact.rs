//! Drill impacts beside which the velocity is not a parabola: ringing, a contact that is too long, a slow
//! instrument.

use super::draws::Draws;
use super::noise::Noise;
use super::score::Score;
use vibroimpact::measure::Estimate;
use vibroimpact::measure::drill::{AngleOrigin, Beam, Drill, DrillOptions, Edge, Slices, drill};
use vibroimpact::record::Fact;

const RATE: f64 = 51_200.0;
const TURNS: usize = 40;
const CASES: u64 = 200;
const BEFORE: f64 = 6.0;
const AFTER: f64 = -1.0;

/// Disturbance of a velocity that rises from −1 to 6 m/s and falls back in an impact at phase 0.6. The rise
/// is a straight line minus the square of a sine, which brings the mass back.
#[derive(Clone, Copy)]
enum Spoilt {
    /// Only the noise of 0.02 m/s, with this correlation from sample to sample.
    Noise(f64),
    /// Ringing after the impact: frequency in Hz, amplitude in m/s, time constant in s.
    Rings(f64, f64, f64),
    /// Duration of the contact in s, as a moving average over it.
    Lasts(f64),
    /// A first-order low-pass with this corner frequency in Hz.
    Slow(f64),
}

fn case(spoilt: Spoilt, seed: u64) -> Drill {
    let mut noise = Noise::new(seed);
    let mut edges = vec![0.01 + 0.001 * noise.uniform()];
    for k in 0..TURNS {
        edges.push(edges[k] + (1.0 + 0.003 * noise.normal()) / 50.0);
    }
    let speeds: Vec<[f64; 2]> =
        (0..TURNS + 2).map(|_| [BEFORE + 0.03 * noise.normal(), AFTER + 0.03 * noise.normal()]).collect();
    let count = ((edges[TURNS] + 0.01) * RATE) as usize;
    let mut turn = 0;
    let mut velocity: Vec<f64> = (0..count)
        .map(|i| {
            let t = i as f64 / RATE;
            while turn + 2 < edges.len() && t >= edges[turn + 1] {
                turn += 1;
            }
            let period = edges[turn + 1] - edges[turn];
            let phase = (t - edges[turn]) / period;
            let behind = (phase - 0.6).rem_euclid(1.0);
            // Velocities after the last impact and before the next.
            let last = turn + usize::from(phase >= 0.6);
            let (after, before) = (speeds[last][1], speeds[last + 1][0]);
            let ring = match spoilt {
                Spoilt::Rings(frequency, speed, decay) => {
                    let s = behind * period;
                    speed * (-s / decay).exp() * (std::f64::consts::TAU * frequency * s).cos()
                }
                _ => 0.0,
            };
            let back = (after + before) * (std::f64::consts::PI * behind).sin().powi(2);
            after + (before - after) * behind - back + ring
        })
        .collect();
    match spoilt {
        Spoilt::Lasts(time) => {
            let n = (time * RATE) as usize | 1;
            let wide = |i: usize| &velocity[i.saturating_sub(n / 2)..(i + n / 2 + 1).min(count)];
            velocity = (0..count).map(|i| wide(i).iter().sum::<f64>() / wide(i).len() as f64).collect();
        }
        Spoilt::Slow(corner) => {
            let part = 1.0 - (-std::f64::consts::TAU * corner / RATE).exp();
            let mut y = velocity[0];
            for v in &mut velocity {
                y += part * (*v - y);
                *v = y;
            }
        }
        _ => {}
    }
    let rho = if let Spoilt::Noise(rho) = spoilt { rho } else { 0.0 };
    let mut x = noise.normal();
    for v in &mut velocity {
        x = rho * x + (1.0 - rho * rho).sqrt() * noise.normal();
        *v += 0.02 * x;
    }
    let rise = |samples: f64| 0.5 + 0.5 * (samples / 3.0).tanh();
    let mut turn = 0;
    let pulse: Vec<f64> = (0..count)
        .map(|i| {
            let t = i as f64 / RATE;
            while turn + 1 < edges.len() && t >= edges[turn] + 0.01 {
                turn += 1;
            }
            let near = (t - edges[turn]) * RATE;
            5.0 * (rise(near) - rise(near - 100.0)) + 0.01 * noise.normal()
        })
        .collect();
    let mut options = DrillOptions::new(1.0, Beam::new(0.0, AngleOrigin::Axis).unwrap(), 1, Edge::Rising);
    options.mass = Some(0.14);
    drill(&Slices { rate: RATE, channels: vec![&velocity, &pulse] }, &options, None).unwrap()
}

/// Sides of the impacts, `before` or `after`, on which the parabola does not fit.
fn lacking(found: &Drill) -> Vec<&str> {
    let sides = found.findings.iter().filter(|f| f.code == "drill-lack-of-fit");
    sides
        .filter_map(|f| if let Some(Fact::Name(side)) = f.fact("side") { Some(side.as_str()) } else { None })
        .collect()
}

fn parabolas_in_noise_keep_their_intervals(draws: Draws) {
    for rho in [0.0, 0.7] {
        let mut scores = [(); 3].map(|()| Score::default());
        for seed in 1..=draws.of(CASES) {
            let found = case(Spoilt::Noise(rho), seed);
            let all = [found.before, found.after, found.restitution].map(Option::unwrap);
            // Restitution is the quotient of the mean velocities.
            for ((score, estimate), truth) in
                scores.iter_mut().zip(&all).zip([BEFORE, AFTER, -AFTER / BEFORE])
            {
                score.own(estimate, truth);
            }
        }
        for (score, name) in scores.iter().zip(["before", "after", "restitution"]) {
            score.mostly(draws, &format!("{name}, noise of rho {rho}"));
        }
    }
}

fn what_is_no_parabola_has_its_bias_in_the_uncertainty_and_a_finding(draws: Draws) {
    // Ringing of 2 to 5 kHz (the parabola is fitted over 0.5 ms) and of 0.1 to 2 m/s; the velocity jumps by
    // 7 m/s, and the noise is 0.02 m/s.
    let rings = [
        (3000.0, 0.3, 3e-4),
        (3000.0, 0.5, 5e-4),
        (3000.0, 2.0, 5e-4),
        (2000.0, 1.0, 1e-3),
        (5000.0, 0.1, 3e-4),
    ];
    let (behind, both): (&[&str], &[&str]) = (&["after"], &["before", "after"]);
    let mut spoilt: Vec<(Spoilt, &[&str])> =
        rings.into_iter().map(|(f, v, tau)| (Spoilt::Rings(f, v, tau), behind)).collect();
    // Contacts of 0.3 and 0.4 ms where 0.2 ms is assumed. The low-pass at 5 kHz still lags by 0.2 % of the
    // jump 0.2 ms after the impact.
    spoilt.extend([(Spoilt::Lasts(3e-4), both), (Spoilt::Lasts(4e-4), both)]);
    spoilt.push((Spoilt::Slow(5000.0), behind));
    let mut score = Score::default();
    for (number, (spoilt, sides)) in spoilt.into_iter().enumerate() {
        for seed in 1..=draws.of(CASES / 4) {
            let found = case(spoilt, 1000 * number as u64 + seed);
            let (before, after) = (found.before.as_ref().unwrap(), found.after.as_ref().unwrap());
            assert_eq!(lacking(&found), sides, "case {number}, seed {seed}");
            // The stated bias is that of the smoothest curve that explains the residuals. Ringing biases the
            // velocity by as much, seldom by more.
            let within = |e: &Estimate, truth: f64| (e.value - truth).abs() < 2.0 * e.std.unwrap();
            assert!(within(after, AFTER), "case {number}: {after:?}");
            assert!(sides == behind || within(before, BEFORE), "case {number}: {before:?}");
            assert!(found.restitution.is_none_or(|r| within(&r, -AFTER / BEFORE)), "case {number}");
            let given = 0.5 * 0.14 * (BEFORE * BEFORE - AFTER * AFTER);
            assert!(within(found.energy_given.as_ref().unwrap(), given), "case {number}");
            assert_eq!(found.phase.unwrap().std, None);
            if sides == behind {
                score.own(before, BEFORE);
            }
        }
    }
    // Ringing after the impact does not affect the velocity before it.
    score.covers(draws, "before, with rings behind");
}

#[test]
fn a_contact_too_long_to_be_found_names_what_allows_it() {
    let found = case(Spoilt::Lasts(6e-4), 1);
    assert!(
        found.impacts.is_empty() && found.findings.iter().any(|f| f.code == "drill-no-impact"),
        "{:?}",
        found.findings
    );
}

/// 4 cases of each kind, run with every test.
mod few {
    use super::Draws;

    #[test]
    fn parabolas_in_noise_keep_their_intervals() {
        super::parabolas_in_noise_keep_their_intervals(Draws::Few);
    }

    #[test]
    fn what_is_no_parabola_has_its_bias_in_the_uncertainty_and_a_finding() {
        super::what_is_no_parabola_has_its_bias_in_the_uncertainty_and_a_finding(Draws::Few);
    }
}

/// All cases, run with `--ignored`.
mod all {
    use super::Draws;

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn parabolas_in_noise_keep_their_intervals() {
        super::parabolas_in_noise_keep_their_intervals(Draws::All);
    }

    #[test]
    #[ignore = "Monte Carlo: cargo test --release -- --ignored"]
    fn what_is_no_parabola_has_its_bias_in_the_uncertainty_and_a_finding() {
        super::what_is_no_parabola_has_its_bias_in_the_uncertainty_and_a_finding(Draws::All);
    }
}
