//! Whether a stored abscissa is even, in one pass and without keeping its values.

/// How many digits an abscissa value carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// Six, format E13.5.
    Text,
    /// Binary single precision.
    Single,
    /// Binary double precision.
    Double,
}

/// Spacing of abscissa values x₀, x₁, …, each of which may be off by half a unit in its last digit.
///
/// Value i allows the steps (xᵢ − x₀ ± slack)/i. They are even where one step, (xₙ₋₁ − x₀)/(n − 1), is allowed by all.
#[derive(Debug, Clone)]
pub struct Spacing {
    digits: Digits,
    n: usize,
    first: f64,
    last: f64,
    least: f64,
    most: f64,
    slack: f64,
    decade: f64,
}

impl Spacing {
    /// No values yet.
    pub fn new(digits: Digits) -> Spacing {
        Spacing {
            digits,
            n: 0,
            first: 0.0,
            last: 0.0,
            least: f64::NEG_INFINITY,
            most: f64::INFINITY,
            slack: 0.0,
            decade: 1.0,
        }
    }

    /// Takes the next value.
    pub fn push(&mut self, value: f64) {
        if self.n == 0 {
            self.first = value;
        } else {
            // Three times the rounding of one value: of this one, the first and the last.
            let slack = 3.0 * self.rounding(value.abs().max(self.first.abs()));
            self.slack = self.slack.max(slack);
            self.least = self.least.max((value - self.first - slack) / self.n as f64);
            self.most = self.most.min((value - self.first + slack) / self.n as f64);
        }
        self.last = value;
        self.n += 1;
    }

    /// Half a unit in the last digit.
    fn rounding(&mut self, magnitude: f64) -> f64 {
        match self.digits {
            Digits::Single => magnitude * f64::from(f32::EPSILON / 2.0),
            Digits::Double => magnitude * f64::EPSILON / 2.0,
            Digits::Text => {
                let within = self.decade <= magnitude && magnitude < 10.0 * self.decade;
                if !within && magnitude > 0.0 {
                    self.decade = 10f64.powf(magnitude.log10().floor());
                }
                self.decade * 0.5e-5
            }
        }
    }

    /// First value; 0 for none.
    pub fn first(&self) -> f64 {
        self.first
    }

    /// The step, where it is even and positive.
    pub fn step(&self) -> Option<f64> {
        if self.n < 2 {
            return None;
        }
        let step = (self.last - self.first) / (self.n - 1) as f64;
        (step > 0.0 && (self.least..=self.most).contains(&step)).then_some(step)
    }

    /// Whether the digits are too few to see a value that is missing between even ones: it moves one of the others by
    /// half a step or more from the mean line.
    pub(crate) fn is_coarse(&self, step: f64) -> bool {
        2.0 * self.slack >= step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(digits: Digits, values: &[f64]) -> Option<f64> {
        let mut spacing = Spacing::new(digits);
        for value in values {
            spacing.push(*value);
        }
        spacing.step()
    }

    #[test]
    fn six_digits_of_an_even_time_are_even() {
        let dt = 1.0 / 4096.0;
        let printed: Vec<f64> =
            (0..5000).map(|i| format!("{:.5e}", f64::from(i) * dt).parse().unwrap()).collect();
        // The last value is below 10, so rounded by half a unit of 1e-5 at most, spread over 4999 steps.
        assert!((step(Digits::Text, &printed).unwrap() - dt).abs() <= 0.5e-5 / 4999.0);
    }

    #[test]
    fn single_precision_of_an_even_time_is_even() {
        let dt = 1.0 / 44_100.0;
        let stored: Vec<f64> = (0..5000).map(|i| f64::from((f64::from(i) * dt) as f32)).collect();
        assert!((step(Digits::Single, &stored).unwrap() / dt - 1.0).abs() < 1e-7);
        assert_eq!(step(Digits::Double, &stored), None);
    }

    #[test]
    fn a_lost_value_is_seen_or_cannot_be() {
        for (n, dt, coarse) in
            [(1000, 1e-3, false), (1000, 1e-2, false), (5000, 1e-3, false), (60_000, 2e-4, true)]
        {
            for lost in [1, n / 3, n / 2, n - 2] {
                let mut spacing = Spacing::new(Digits::Text);
                for i in (0..n).filter(|i| *i != lost) {
                    spacing.push(format!("{:.5e}", f64::from(i) * dt).parse().unwrap());
                }
                assert_eq!(spacing.is_coarse(dt), coarse);
                assert!(coarse || spacing.step().is_none(), "{n} values of step {dt}, {lost} lost");
            }
        }
    }

    #[test]
    fn a_gap_or_a_fall_is_uneven() {
        assert_eq!(step(Digits::Text, &[0.0, 0.1, 0.2, 0.4, 0.5]), None);
        assert_eq!(step(Digits::Text, &[0.0, -0.1, -0.2]), None);
        assert_eq!(step(Digits::Text, &[1.0, 1.0]), None);
        assert_eq!(step(Digits::Text, &[1.0]), None);
        assert_eq!(step(Digits::Text, &[]), None);
        assert_eq!(step(Digits::Text, &[0.0, 1.0, f64::NAN, 3.0]), Some(1.0));
    }
}
