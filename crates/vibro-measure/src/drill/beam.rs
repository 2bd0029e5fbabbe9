//! The laser beam and the line of motion.

use vibro_record::{Error, Result};

/// From where the angle of the beam is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum From {
    /// From the normal to the motion: 90° is a beam along the motion.
    Normal,
    /// From the axis of the motion: 0° is a beam along the motion.
    Axis,
}

/// A beam that sees v cos α of a velocity v, α the angle between beam and motion.
///
/// ```
/// use vibro_measure::drill::{Beam, From};
/// assert!((Beam::new(30.0, From::Normal)?.factor() - 2.0).abs() < 1e-12);
/// assert!((Beam::new(30.0, From::Axis)?.factor() - 1.1547).abs() < 1e-4);
/// # Ok::<(), vibro_record::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Angle between beam and motion in rad.
    alpha: f64,
}

/// Cosine of 89°: nearer to square a tenth of a degree changes the velocity by a tenth.
const SQUARE: f64 = 0.0175;

impl Beam {
    /// A beam at `degrees`, counted `from` the normal or from the axis of the motion.
    ///
    /// # Errors
    /// If the angle is not between 0° and 90°, or the beam stands square to the motion and sees nothing of it.
    pub fn new(degrees: f64, from: From) -> Result<Beam> {
        if !(0.0..=90.0).contains(&degrees) {
            return Err(
                Error::usage(format!("a beam angle of {degrees}°"), "0° to 90°").setting("beam_angle")
            );
        }
        let alpha = match from {
            From::Axis => degrees,
            From::Normal => 90.0 - degrees,
        }
        .to_radians();
        if alpha.cos() < SQUARE {
            return Err(Error::refused(format!(
                "a beam at {degrees}° is square to the motion: it sees no velocity"
            ))
            .hint("check whether the angle counts from the normal or from the axis of the motion")
            .setting("from"));
        }
        Ok(Beam { alpha })
    }

    /// What the velocity along the beam is multiplied by: 1/cos α.
    pub fn factor(self) -> f64 {
        1.0 / self.alpha.cos()
    }

    /// Relative change of the velocity a degree of error in the angle makes: tan α · π/180.
    pub(crate) fn per_degree(self) -> f64 {
        self.alpha.tan() * 1f64.to_radians()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_of_one_beam_agree() {
        for degrees in [0.0, 12.5, 45.0, 80.0] {
            let (a, b) =
                (Beam::new(degrees, From::Axis).unwrap(), Beam::new(90.0 - degrees, From::Normal).unwrap());
            // One rounding in the angle, amplified by tan 80° = 6.
            assert!((a.factor() / b.factor() - 1.0).abs() < 1e-14);
        }
        // 3 % a degree where the factor is 2.
        assert!((Beam::new(30.0, From::Normal).unwrap().per_degree() - 0.0302).abs() < 1e-4);
    }

    #[test]
    fn a_square_beam_is_refused_and_an_impossible_angle_is_wrong_usage() {
        assert_eq!(Beam::new(90.0, From::Axis).unwrap_err().exit_code(), 1);
        assert_eq!(Beam::new(0.0, From::Normal).unwrap_err().exit_code(), 1);
        for bad in [-1.0, 91.0, f64::NAN] {
            assert_eq!(Beam::new(bad, From::Axis).unwrap_err().exit_code(), 2);
        }
    }
}
