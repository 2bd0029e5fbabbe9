//! Data set 164: the unit system of a file.

use super::delimiter::is_delimiter;
use super::stream::Stream;
use crate::number;
use vibro_record::Result;
use vibro_record::units::Dimension;

/// Factors by which numbers of the file must be divided to be SI; one each where the file does not say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct System {
    /// Whether the file says so.
    pub stated: bool,
    length: f64,
    force: f64,
    temperature: f64,
}

impl Default for System {
    fn default() -> System {
        System { stated: false, length: 1.0, force: 1.0, temperature: 1.0 }
    }
}

impl System {
    /// Reads the lines of data set 164 up to its delimiter. `None` where its second line does not hold three positive
    /// factors, format `3D25.17`.
    pub fn read(stream: &mut Stream) -> Result<Option<System>> {
        let mut factors = Vec::new();
        for line in 0..2 {
            if !stream.next_line()? {
                return Ok(None);
            }
            if is_delimiter(stream.text()) {
                stream.hold();
                return Ok(None);
            }
            if line == 1 {
                factors = numbers(stream.text());
            }
        }
        let sane = |f: &f64| *f > 0.0 && f.is_finite();
        Ok(match factors[..] {
            [length, force, temperature, ..] if factors[..3].iter().all(sane) => {
                Some(System { stated: true, length, force, temperature })
            }
            _ => None,
        })
    }

    /// SI units in one unit of the file, for a quantity of this dimension. Mass is force times time squared over length,
    /// and time is in seconds in every system.
    pub fn factor(&self, dimension: Dimension) -> f64 {
        let [m, kg, _, _, kelvin, _] = dimension.0.map(|doubled| f64::from(doubled) / 2.0);
        self.length.powf(kg - m) * self.force.powf(-kg) * self.temperature.powf(-kelvin)
    }

    /// SI units in one unit of length^a force^b temperature^c.
    pub(crate) fn factor_of(&self, [length, force, temperature]: [i64; 3]) -> f64 {
        let power = |base: f64, exponent: i64| base.powf(-(exponent as f64));
        power(self.length, length) * power(self.force, force) * power(self.temperature, temperature)
    }
}

/// Numbers of a line, which may touch.
fn numbers(line: &[u8]) -> Vec<f64> {
    let mut rest = line.trim_ascii();
    let mut all = Vec::new();
    while let Some((value, used)) = number::prefix(rest, b'.') {
        all.push(value);
        rest = rest[used..].trim_ascii_start();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Source;
    use vibro_record::units::Unit;

    fn system(text: &str) -> Option<System> {
        let source = Source::memory("x.unv", text.as_bytes().to_vec()).unwrap();
        System::read(&mut Stream::open(&source).unwrap()).unwrap()
    }

    #[test]
    fn inch_and_pound_force() {
        let system = system(
            "         7Inch (pound f)               2\n  3.93700787401574814D+01  2.24808943099710489D-01  1.80000000000000000D+00\n  4.59670000000000000D+02\n",
        )
        .unwrap();
        // One inch is 0.0254 m by definition; the pound force of the file is the exact one to ten digits.
        for (file, si) in [
            ("m/s²", 0.0254),
            ("N", 4.448_221_615),
            ("(m/s²)/N", 0.0254 / 4.448_221_615),
            ("Pa", 4.448_221_615 / 0.0254f64.powi(2)),
            ("kg", 4.448_221_615 / 0.0254),
            ("K", 1.0 / 1.8),
            ("s", 1.0),
        ] {
            let factor = system.factor(Unit::parse(file).unwrap().dimension().unwrap());
            assert!((factor / si - 1.0).abs() < 1e-9, "{file}: {factor} against {si}");
        }
        assert!((system.factor_of([1, 1, 0]) / (0.0254 * 4.448_221_615) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn senseless_factors_are_no_system() {
        for text in
            ["", "1 SI\n", "1 SI\n1.0 1.0\n", "1 SI\n0.0 1.0 1.0\n", "1 SI\n-1.0 1.0 1.0\n", "1 SI\n    -1\n"]
        {
            if !text.is_empty() {
                assert_eq!(system(text), None, "{text:?}");
            }
        }
    }
}
