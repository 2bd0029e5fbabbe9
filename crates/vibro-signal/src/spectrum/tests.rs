use super::*;
use crate::segment::Segments;
use crate::welch::Welch;
use std::f64::consts::TAU;
use vibro_record::Traces;

const N: usize = 240;
const RATE: f64 = 480.0;

/// A mean, a cosine on line 30 with phase, and an alternation at half the sampling rate.
fn trace() -> Trace {
    let values = (0..N)
        .map(|i| {
            let nyquist = if i % 2 == 0 { 0.25 } else { -0.25 };
            0.5 + 3.0 * (TAU * 30.0 * i as f64 / N as f64 + 0.7).cos() + nyquist
        })
        .collect();
    Trace { meta: Meta::new("x", Unit::parse("m/s").unwrap()), axis: Axis::time(0.0, 1.0 / RATE, N), values }
}

#[test]
fn every_scaling_gives_the_sine_its_closed_form() {
    // Mean, cosine and alternation: the outer two have a single line, not two of half the height.
    for window in Window::ALL {
        let density = RATE / N as f64 * window.enbw();
        for (scaling, expected) in [
            (Scaling::Peak, [0.5, 3.0, 0.25]),
            (Scaling::Rms, [0.5, 3.0 / 2f64.sqrt(), 0.25]),
            (Scaling::Power, [0.25, 4.5, 0.0625]),
            (Scaling::Psd, [0.25 / density, 4.5 / density, 0.0625 / density]),
        ] {
            let spectrum = plain(&trace(), window, scaling, false).unwrap();
            assert!((spectrum.enbw.unwrap() - window.enbw()).abs() < 1e-12);
            for (k, expected) in [0, 30, N / 2].into_iter().zip(expected) {
                let found = spectrum.values.magnitude(k);
                // A sum of N products.
                assert!(
                    (found / expected - 1.0).abs() < N as f64 * 1e-15,
                    "{window:?} {scaling:?} {k}: {found}"
                );
            }
        }
    }
    let Values::Complex(lines) = plain(&trace(), Window::Hann, Scaling::Peak, false).unwrap().values else {
        panic!()
    };
    assert!((lines[30].arg() - 0.7).abs() < 1e-13);
}

/// Parseval: the area under the density is the mean square, exactly so without a window.
#[test]
fn density_holds_the_power() {
    for n in [N, N - 1] {
        let values: Vec<f64> = (0..n).map(|i| ((i * i * 7 + 3 * i) % 101) as f64 / 50.0).collect();
        let square = values.iter().map(|v| v * v).sum::<f64>() / n as f64;
        let trace = Trace { meta: trace().meta, axis: Axis::time(0.0, 1.0 / RATE, n), values };
        let spectrum = plain(&trace, Window::Rectangular, Scaling::Psd, false).unwrap();
        let area: f64 = spectrum.values.magnitudes().iter().sum::<f64>() * RATE / n as f64;
        assert!((area / square - 1.0).abs() < 1e-13, "{n}: {area} {square}");
    }
}

#[test]
fn one_segment_is_the_plain_spectrum() {
    for scaling in [Scaling::Peak, Scaling::Rms, Scaling::Power, Scaling::Psd] {
        let welch = Welch { segments: Segments::new(N, 0.5).unwrap(), window: Window::Hann, detrend: true };
        let mut traces = Traces::from_memory(vec![trace()]).unwrap();
        let averages = welch.average(&mut traces, false, |_| ()).unwrap();
        let mean = averaged(&averages, 0, &trace().meta, Window::Hann, scaling).unwrap();
        let whole = plain(&trace(), Window::Hann, scaling, true).unwrap();
        assert!(mean.values.magnitude(0).is_nan() && whole.values.magnitude(0).is_nan());
        for k in 1..=N / 2 {
            assert!((mean.values.magnitude(k) - whole.values.magnitude(k)).abs() < 1e-14, "{scaling:?} {k}");
        }
        assert_eq!((mean.axis, mean.meta.unit), (whole.axis, whole.meta.unit));
    }
}

#[test]
fn units_follow_the_scaling() {
    let symbol =
        |text: &str, scaling| unit(&Unit::parse_or_opaque(text), scaling).unwrap().symbol().to_owned();
    assert_eq!(symbol("m/s", Scaling::Peak), "m/s");
    assert_eq!(symbol("m/s", Scaling::Power), "(m/s)²");
    assert_eq!(symbol("m", Scaling::Psd), "m²/Hz");
    assert_eq!(symbol("FS", Scaling::Psd), "FS²/Hz");
    let psd = unit(&Unit::parse("m/s").unwrap(), Scaling::Psd).unwrap();
    assert!(psd.is_known() && psd.factor() == 1.0);
}

#[test]
fn what_has_no_spectrum_is_refused() {
    let error = |change: fn(&mut Trace)| {
        let mut trace = trace();
        change(&mut trace);
        plain(&trace, Window::Hann, Scaling::Peak, false).unwrap_err().to_string()
    };
    assert!(error(|t| t.values[7] = f64::NAN).contains("sample 7"));
    assert!(error(|t| t.values.fill(2.5)).contains("constant at 2.5"));
    assert!(error(|t| t.axis = Axis::index(N)).contains("sampling rate"));
    assert!(error(|t| t.values.truncate(5)).contains("5 samples"));
    assert!(plain(&trace(), Window::Hann, Scaling::Energy, false).is_err());
}
