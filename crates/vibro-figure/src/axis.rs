//! Axes: the specification by the caller, and the axis with limits once the data are known.

use crate::{Ticks, ticks};
use serde::{Deserialize, Serialize};
use vibro_record::units::notation::{self, engineering, labelled, scaled_unit};

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Logarithmic; a negative value is not drawn, zero lies below every limit.
    Log,
    /// Level in dB: the data are amplitudes, drawn as 20 lg(|value|/reference).
    Db {
        /// Amplitude of 0 dB, in the unit of the data.
        reference: f64,
    },
}

impl Scale {
    /// The value on the scale: itself, its log₁₀ or its level in dB.
    pub(super) fn of(self, value: f64) -> f64 {
        match self {
            Scale::Linear => value,
            Scale::Log => value.log10(),
            Scale::Db { reference } => vibro_record::units::decibel(value, reference),
        }
    }

    /// As [`Scale::of`], for the lower end of a band: on a logarithmic or level scale a negative end counts
    /// as zero.
    pub(super) fn of_low(self, value: f64) -> f64 {
        self.of(if value < 0.0 && self != Scale::Linear { 0.0 } else { value })
    }
}

/// Specification of an axis: label, unit, scale and optional limits.
///
/// Data are given in SI units; a linear axis finds its own prefix, so that displacements of 0.002 m are drawn
/// as 2 with the label `Displacement (mm)`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct AxisSpec {
    /// Quantity, e.g. `Displacement amplitude`.
    pub label: String,
    /// Unit of the data, e.g. `m`; empty or `1` for ratios.
    pub unit: String,
    /// Layout.
    pub scale: Scale,
    /// Lower and upper limit in the unit of the data (in dB on a level axis). An end that is not finite is
    /// found from the data.
    pub limits: Option<(f64, f64)>,
}

impl AxisSpec {
    /// Linear axis with limits from the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> AxisSpec {
        AxisSpec { label: label.into(), unit: unit.into(), ..AxisSpec::default() }
    }

    /// Frequency in Hz.
    pub fn frequency() -> AxisSpec {
        AxisSpec::new("Frequency", "Hz")
    }

    /// Logarithmic.
    pub fn log(self) -> AxisSpec {
        AxisSpec { scale: Scale::Log, ..self }
    }

    /// Level in dB against an amplitude in the unit of the data.
    pub fn db(self, reference: f64) -> AxisSpec {
        AxisSpec { scale: Scale::Db { reference }, ..self }
    }

    /// Limits in the unit of the data (in dB on a level axis); an end that is not finite is found from the
    /// data.
    pub fn limits(self, low: f64, high: f64) -> AxisSpec {
        AxisSpec { limits: Some((low, high)), ..self }
    }
}

/// Range of the data on an axis' scale, from which its limits are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    lo: f64,
    hi: f64,
}

impl Extent {
    /// The empty range.
    pub(super) const NONE: Extent = Extent { lo: f64::INFINITY, hi: f64::NEG_INFINITY };

    /// Range of these values on a scale.
    pub(super) fn of(scale: Scale, values: impl IntoIterator<Item = f64>) -> Extent {
        let mut extent = Extent::NONE;
        extent.include(values.into_iter().map(|v| scale.of(v)));
        extent
    }

    /// Widens the range by values on the scale. Ignores values that are not finite, or beyond 1e300, where a
    /// difference of two could overflow.
    pub(super) fn include(&mut self, values: impl IntoIterator<Item = f64>) {
        for u in values.into_iter().filter(|u| u.abs() <= 1e300) {
            self.lo = self.lo.min(u);
            self.hi = self.hi.max(u);
        }
    }

    /// Smallest range that contains both.
    pub(super) fn joined(self, other: Extent) -> Extent {
        Extent { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Whether it contains no value.
    pub(super) fn is_empty(self) -> bool {
        self.lo > self.hi
    }
}

/// Space between the data and the ends of the axis, as a fraction of the data's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Room {
    /// None: the axis ends with the data.
    Tight,
    /// 3 % at both ends, so that markers are not cut.
    Margin,
    /// None. The axis starts at zero, or at 60 dB below the largest value on a level axis.
    /// For a waterfall: below 60 dB, the noise of a hundred stacked spectra would hide the lines.
    Floor,
    /// This fraction above the data and 6 % below. A linear axis instead ends at zero if the value nearest to
    /// zero is at most 0.4 of the one furthest from it.
    Above(f64),
}

/// An axis with its limits.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub lo: f64,
    pub hi: f64,
    pub title: String,
    pub scale: Scale,
    pub power: i32,
    degrees: bool,
}

/// Range in dB of a level axis with limits from the data: lower levels are noise or an exact zero.
const LEVEL_RANGE: f64 = 100.0;

impl Axis {
    /// Axis with limits, as specified or from the data; `None` if a limit is not specified and there are no
    /// data.
    pub(super) fn new(spec: &AxisSpec, data: Extent, room: Room) -> Option<Axis> {
        let given = |end: f64| {
            let u = if spec.scale == Scale::Log { end.log10() } else { end };
            (u.abs() <= 1e300).then_some(u)
        };
        let (low, high) = spec.limits.map_or((None, None), |(a, b)| (given(a), given(b)));
        let found = (!data.is_empty()).then(|| with_room(spec.scale, data, room));
        let (a, b) = (low.or(found.map(|f| f.0))?, high.or(found.map(|f| f.1))?);
        let (lo, hi) = widened(spec.scale, a.min(b), a.max(b));
        let degrees = spec.unit == "°";
        let (power, unit) = match spec.scale {
            Scale::Db { reference } => (0, level_unit(&spec.unit, reference)),
            Scale::Linear if !degrees => {
                let power = engineering(lo.abs().max(hi.abs()));
                (power, scaled_unit(&spec.unit, power))
            }
            _ => (0, spec.unit.clone()),
        };
        Some(Axis { lo, hi, title: labelled(&spec.label, &unit), scale: spec.scale, power, degrees })
    }

    /// Two linear axes of one unit with the same span and power of ten.
    pub(super) fn alike((x, y): (Axis, Axis), (of_x, of_y): (&AxisSpec, &AxisSpec)) -> (Axis, Axis) {
        let half = (x.hi - x.lo).max(y.hi - y.lo) / 2.0;
        let ends = |axis: &Axis| {
            let middle = f64::midpoint(axis.lo, axis.hi);
            (middle - half, middle + half)
        };
        let ((left, right), (low, high)) = (ends(&x), ends(&y));
        let power = engineering([left, right, low, high].into_iter().map(f64::abs).fold(0.0, f64::max));
        let title = |spec: &AxisSpec| labelled(&spec.label, &scaled_unit(&spec.unit, power));
        let across = Axis { lo: left, hi: right, power, title: title(of_x), ..x };
        (across, Axis { lo: low, hi: high, power, title: title(of_y), ..y })
    }

    /// Position of a value: 0 at the lower limit, 1 at the upper one; NaN where the scale has no such value.
    /// Positions far outside are clamped to ±1e4, so that lines can be cut at the frame.
    pub(super) fn at(&self, value: f64) -> f64 {
        self.at_scaled(self.scale.of(value))
    }

    /// As [`Axis::at`], for a value on the scale already, such as a tick.
    pub(super) fn at_scaled(&self, u: f64) -> f64 {
        // Halved before the subtraction, so that no difference overflows.
        ((u / 2.0 - self.lo / 2.0) / (self.hi / 2.0 - self.lo / 2.0)).clamp(-1e4, 1e4)
    }

    /// As [`Axis::at`], for the lower end of a band: on a logarithmic axis a negative end lies below every
    /// limit.
    pub(super) fn at_low(&self, value: f64) -> f64 {
        self.at_scaled(self.scale.of_low(value))
    }

    /// Ticks; a linear axis has at most `most` that are labelled.
    pub(super) fn ticks(&self, most: usize) -> Ticks {
        match self.scale {
            Scale::Log => ticks::logarithmic(self.lo, self.hi, most),
            _ => ticks::linear(self.lo, self.hi, most, self.power, self.degrees),
        }
    }
}

/// Limits from the data, with the room beyond them.
fn with_room(scale: Scale, data: Extent, room: Room) -> (f64, f64) {
    let Extent { mut lo, hi } = data;
    if matches!(scale, Scale::Db { .. }) {
        lo = lo.max(hi - if room == Room::Floor { 60.0 } else { LEVEL_RANGE });
    }
    let (linear, span) = (scale == Scale::Linear, hi - lo);
    match room {
        Room::Floor if linear => (lo.min(0.0), hi),
        Room::Tight | Room::Floor => (lo, hi),
        Room::Margin => (lo - 0.03 * span, hi + 0.03 * span),
        Room::Above(part) => {
            let low = if linear && lo >= 0.0 && lo <= 0.4 * hi { 0.0 } else { lo - 0.06 * span };
            let high = if linear && hi <= 0.0 && hi >= 0.4 * lo { 0.0 } else { hi + part * span };
            (low, high)
        }
    }
}

/// Limits far enough apart to be drawn, also where all data are equal.
fn widened(scale: Scale, lo: f64, hi: f64) -> (f64, f64) {
    // On a logarithmic axis the limits are exponents: powers of ten beyond ±290 might underflow or overflow.
    let furthest = if scale == Scale::Log { 290.0 } else { 1e300 };
    let (lo, hi) = (lo.clamp(-furthest, furthest), hi.clamp(-furthest, furthest));
    let size = lo.abs().max(hi.abs());
    if hi - lo > 1e-11 * size && hi - lo > 1e-280 {
        return (lo, hi);
    }
    let middle = lo / 2.0 + hi / 2.0;
    let half = match scale {
        Scale::Linear if size > 1e-270 => 0.1 * size,
        Scale::Linear => 1.0,
        Scale::Log => 0.5,
        Scale::Db { .. } => 10f64.max(0.1 * size),
    };
    (middle - half, middle + half)
}

/// Unit of a level axis, such as `dB re 1 µm/s`.
fn level_unit(unit: &str, reference: f64) -> String {
    if unit.is_empty() || unit == "1" {
        return "dB".to_owned();
    }
    format!("dB re {}", notation::reference(reference, unit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn extent(values: &[f64]) -> Extent {
        let mut extent = Extent::NONE;
        extent.include(values.iter().copied());
        extent
    }

    #[test]
    fn small_displacements_are_drawn_in_millimetres() {
        let axis = Axis::new(&AxisSpec::new("Displacement", "m"), extent(&[0.0, 0.0021]), Room::Above(0.06))
            .unwrap();
        assert_eq!(axis.title, "Displacement (mm)");
        let labels: Vec<_> = axis.ticks(6).major.into_iter().map(|t| t.label).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0", "1.5", "2.0"]);
    }

    #[test]
    fn axes_that_are_alike_have_one_span_and_one_unit() {
        let (of_x, of_y) = (AxisSpec::new("Real part", "m/N"), AxisSpec::new("Imaginary part", "m/N"));
        let axis = |spec, data: &[f64]| Axis::new(spec, extent(data), Room::Tight).unwrap();
        let axes = (axis(&of_x, &[-6e-4, 6e-4]), axis(&of_y, &[-1.6e-3, 0.0]));
        let (x, y) = Axis::alike(axes, (&of_x, &of_y));
        let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(
            near(x.lo, -8e-4) && near(x.hi, 8e-4) && near(y.lo, -1.6e-3) && near(y.hi, 0.0),
            "{x:?} {y:?}"
        );
        assert_eq!((x.title.as_str(), y.title.as_str()), ("Real part (mm/N)", "Imaginary part (mm/N)"));
        assert_eq!(x.power, y.power);
    }

    #[test]
    fn levels_name_their_reference_and_end_above_the_zeros() {
        let spec = AxisSpec::new("Velocity", "m/s").db(1e-6);
        let levels = [0.0, 1e-30, 0.1].map(|v| spec.scale.of(v));
        let axis = Axis::new(&spec, extent(&levels), Room::Tight).unwrap();
        assert_eq!(axis.title, "Velocity (dB re 1 µm/s)");
        assert!((axis.hi - 100.0).abs() < 1e-9 && axis.lo.abs() < 1e-9);
        assert!(axis.at(0.0) < 0.0);
        assert_eq!(level_unit("m", 2.5e-5), "dB re 25 µm");
        assert_eq!(level_unit("1", 1.0), "dB");
    }

    #[test]
    fn an_end_that_is_not_given_comes_from_the_data() {
        let spec = AxisSpec::new("x", "1").limits(2.0, f64::INFINITY);
        let axis = Axis::new(&spec, extent(&[0.0, 8.0]), Room::Tight).unwrap();
        assert_eq!((axis.lo, axis.hi), (2.0, 8.0));
        let below = Axis::new(&spec, extent(&[0.0, 1.0]), Room::Tight).unwrap();
        assert!(below.lo < below.hi);
        assert_eq!(Axis::new(&spec, Extent::NONE, Room::Tight), None);
        let reversed =
            Axis::new(&AxisSpec::new("x", "1").limits(5.0, -5.0), Extent::NONE, Room::Tight).unwrap();
        assert_eq!((reversed.lo, reversed.hi), (-5.0, 5.0));
    }

    #[test]
    fn the_lower_limit_is_zero_only_where_the_data_come_near() {
        let spec = AxisSpec::new("x", "1");
        assert_eq!(Axis::new(&spec, extent(&[1.0, 9.0]), Room::Above(0.06)).unwrap().lo, 0.0);
        assert!(Axis::new(&spec, extent(&[8.0, 9.0]), Room::Above(0.06)).unwrap().lo > 7.9);
        assert_eq!(Axis::new(&spec, extent(&[-9.0, -1.0]), Room::Above(0.06)).unwrap().hi, 0.0);
    }

    proptest! {
        /// No data and no scale may panic, or give limits that cannot be drawn.
        #[test]
        fn every_axis_can_be_drawn(
            values in prop::collection::vec(prop_oneof![
                any::<f64>(), Just(0.0), Just(1e300), Just(-1e300), Just(f64::NAN), Just(5.0), Just(1e-310),
            ], 0..6),
            limits in prop::option::of((any::<f64>(), any::<f64>())),
            scale in prop_oneof![Just(Scale::Linear), Just(Scale::Log), Just(Scale::Db { reference: 1e-6 })],
        ) {
            let spec = AxisSpec { scale, limits, ..AxisSpec::new("x", "m") };
            let data = extent(&values.iter().map(|v| scale.of(*v)).collect::<Vec<_>>());
            if let Some(axis) = Axis::new(&spec, data, Room::Above(0.06)) {
                prop_assert!(axis.lo < axis.hi && axis.lo.is_finite() && axis.hi.is_finite(), "{axis:?}");
                let ticks = axis.ticks(6);
                prop_assert!((2..=10).contains(&ticks.major.len()), "{axis:?} {ticks:?}");
                for tick in &ticks.major {
                    prop_assert!((-1e-9..=1.0 + 1e-9).contains(&axis.at_scaled(tick.at)), "{axis:?} {tick:?}");
                }
                let placed = |v: &f64| axis.at(*v).is_nan() || axis.at(*v).is_finite();
                prop_assert!(values.iter().all(placed));
            }
        }
    }
}
