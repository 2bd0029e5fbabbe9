//! The signals, and how instruments print numbers.

use vibro_math::Noise;

/// Number of values of a channel.
pub const N: usize = 128;
/// Sampling interval in s.
pub const DX: f64 = 5e-4;

/// Value `i` of a channel. Channel 0: a pulse near value 20 on a cosine; 1: a sine on a drift; 2: a decay
/// that changes sign.
pub fn value(channel: usize, i: usize) -> f64 {
    let x = i as f64;
    match channel {
        0 => 2.5 * (-((x - 20.0) / 3.0).powi(2)).exp() - 0.75 * (0.3 * x).cos(),
        1 => -1.2 * (0.45 * x).sin() + 0.02 * x,
        _ => 3.4 * (-0.05 * x).exp() * (0.8 * x).cos(),
    }
}

/// Instant `i` in s of an axis that begins at `start`.
pub fn at(start: f64, i: usize) -> f64 {
    start + DX * i as f64
}

/// Instant `i` in s as a telephone or a logger stamps it: off by up to 2 µs.
pub fn stamped(start: f64, i: usize) -> f64 {
    at(start, i) + Noise::new(i as u64 + 1).between(-2e-6, 2e-6)
}

/// `%.{digits}f`.
pub fn fixed(value: f64, digits: usize) -> String {
    format!("{value:.digits$}")
}

/// `%.{digits}E` with a sign and this number of digits in the exponent.
pub fn sci(value: f64, digits: usize, exponent: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, power) = text.split_once('e').expect("an exponent");
    let power: i32 = power.parse().expect("a whole exponent");
    let sign = if power < 0 { '-' } else { '+' };
    format!("{mantissa}E{sign}{:0exponent$}", power.abs())
}

/// A number with a decimal comma instead of the point.
pub fn comma(text: &str) -> String {
    text.replace('.', ",")
}

/// A header, then one row for each value.
pub fn table(head: &str, row: impl Fn(usize) -> String) -> Vec<u8> {
    with_end(head, "\n", row)
}

/// As [`table`], with another line end.
pub fn with_end(head: &str, end: &str, row: impl Fn(usize) -> String) -> Vec<u8> {
    let mut text = head.replace('\n', end);
    for i in 0..N {
        text.push_str(&row(i));
        text.push_str(end);
    }
    text.into_bytes()
}

/// A time of day, `i` steps and `second` seconds after `hour` o'clock, with `digits` decimals of a second.
pub fn clock(hour: usize, second: f64, i: usize, digits: usize) -> String {
    let seconds = second + DX * i as f64;
    let (minutes, rest) = ((seconds / 60.0).floor(), seconds % 60.0);
    let width = digits + 3;
    format!("{:02}:{:02}:{rest:0width$.digits$}", (hour + minutes as usize / 60) % 24, minutes as usize % 60)
}
