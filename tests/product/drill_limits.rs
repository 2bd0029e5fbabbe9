//! `drill` with impossible options and records: it returns an error and does not panic.

use vibroimpact::measure::drill::{AngleOrigin, Beam, DrillOptions, Edge, Slices, Smoothing, drill};

#[test]
fn no_option_of_the_library_ends_in_a_panic() {
    let velocity: Vec<f64> = (0..6000).map(|i| 5.0 * (0.03 * f64::from(i) + 0.4).fract()).collect();
    let pulse: Vec<f64> = (0..6000).map(|i| f64::from(u8::from(i % 209 < 20))).collect();
    let plain = || DrillOptions::new(1.0, Beam::new(0.0, AngleOrigin::Axis).unwrap(), 1, Edge::Rising);
    let numbers = [f64::MIN_POSITIVE, 1e-300, 1e-9, 1e9, 1e300, f64::MAX, f64::INFINITY, f64::NAN, -1.0, 0.0];
    let channels = || vec![velocity.as_slice(), pulse.as_slice()];
    for x in numbers {
        let mut all: Vec<DrillOptions> = (0..11).map(|_| plain()).collect();
        all[0].contact = x;
        all[1].fit = x;
        all[2].longest_dropout = x;
        all[3].smoothing = Smoothing::LowPass(x);
        all[4].smoothing = Smoothing::Exponential(x);
        all[5].level = Some(x);
        all[6].sensitivity = x;
        (all[7].mass, all[7].struck_mass) = (Some(x), Some(x));
        all[8].margin = x;
        all[9].hours = Some(x);
        all[10].instrument = Some(x);
        for (number, options) in all.iter().enumerate() {
            let record = Slices { rate: 1e4, channels: channels() };
            let found = drill(&record, options, None);
            // A level, a sensitivity and a margin may be negative. Every other option is a duration, a mass
            // or a frequency, and a day has no more than 24 hours.
            let possible = x.is_finite()
                && match number {
                    5 | 8 => true,
                    6 => x != 0.0,
                    9 => x > 0.0 && x <= 24.0,
                    _ => x > 0.0,
                };
            assert!(possible || found.is_err(), "{x} as option {number}");
        }
        let record = Slices { rate: x, channels: channels() };
        let found = drill(&record, &plain(), None);
        assert!(found.is_err() || x.is_finite() && x > 0.0, "a rate of {x} Hz");
    }
    for pulses in [0, 2, usize::MAX - 1, usize::MAX] {
        let options = DrillOptions { pulses_per_turn: pulses, ..plain() };
        let record = Slices { rate: 1e4, channels: channels() };
        let found = drill(&record, &options, None);
        assert_eq!(found.is_ok(), pulses == 2);
    }
    for channels in [vec![], vec![velocity.as_slice()], vec![&[], &[]], vec![&[1.0], &[2.0]]] {
        let record = Slices { rate: 1e4, channels };
        assert!(drill(&record, &plain(), None).is_err());
    }
}
