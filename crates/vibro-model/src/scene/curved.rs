//! Stiffness of a Hertz contact from radii and elastic constants of both bodies.

use super::ContactKeys;
use crate::least::{NumberRange, number};
use vibro_record::Error;

/// Example of all keys of the bodies.
const STEEL: &str =
    "a steel ball on a steel plane: radius = [0.02, inf], modulus = [210e9, 210e9], poisson = [0.3, 0.3]";

/// Stiffness k = (4/3) E* √R in N/m^{3/2} of F = kδ^{3/2}, with 1/R = 1/R₁ + 1/R₂ and
/// 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ (Johnson 1985, 4.23).
fn stiffness(radius: [f64; 2], [e1, e2]: [f64; 2], [nu1, nu2]: [f64; 2]) -> f64 {
    let yielding = (1.0 - nu1 * nu1) / e1 + (1.0 - nu2 * nu2) / e2;
    4.0 / (3.0 * yielding) * relative(radius).sqrt()
}

/// Radius R of both bodies in m, with 1/R = 1/R₁ + 1/R₂.
fn relative([r1, r2]: [f64; 2]) -> f64 {
    1.0 / (1.0 / r1 + 1.0 / r2)
}

impl ContactKeys {
    /// Radius R in m with 1/R = 1/R₁ + 1/R₂, where the radii of both bodies are stated.
    pub fn relative_radius(&self) -> Option<f64> {
        self.radius.map(relative)
    }

    /// The keys, with stiffness and exponent of a Hertz contact where the bodies are stated.
    ///
    /// # Errors
    /// The key that is impossible or missing, or that is stated beside the bodies.
    pub fn resolved(self) -> Result<ContactKeys, (&'static str, Error)> {
        let ContactKeys { radius, modulus, poisson, .. } = self;
        let stated = [("radius", radius), ("modulus", modulus), ("poisson", poisson)];
        let Some((first, _)) = stated.iter().find(|(_, pair)| pair.is_some()) else { return Ok(self) };
        let (Some(radius), Some(modulus), Some(poisson)) = (radius, modulus, poisson) else {
            let missing = stated.iter().find(|(_, pair)| pair.is_none()).map_or("", |(key, _)| key);
            let found = format!("contact.{first} without contact.{missing}");
            let expected = "radius in m, modulus in Pa and poisson, each with a value for both bodies";
            return Err((first, Error::usage(found, expected).hint(STEEL)));
        };
        let beside = [("stiffness", self.stiffness), ("exponent", self.exponent)];
        if let Some((key, _)) = beside.iter().find(|(_, value)| value.is_some()) {
            let found = format!("contact.{key} beside contact.radius, which determines it");
            return Err((key, Error::usage(found, "one of them")));
        }
        let curved = radius.into_iter().filter(|r| *r != f64::INFINITY).map(|r| ("radius", r, "m"));
        for (key, value, unit) in curved.chain(modulus.map(|e| ("modulus", e, "Pa"))) {
            number(&format!("contact.{key}"), value, unit, NumberRange::AboveZero).map_err(|e| (key, e))?;
        }
        if let Some(ratio) = poisson.iter().find(|ratio| !(**ratio > -1.0 && **ratio <= 0.5)) {
            let error = Error::usage(format!("contact.poisson is {ratio}"), "a value above -1, at most 0.5");
            return Err(("poisson", error));
        }
        if radius == [f64::INFINITY; 2] {
            let flat = "contact.radius: both bodies are flat";
            return Err(("radius", Error::usage(flat, "a finite radius of one of them")));
        }
        let stiffness = Some(stiffness(radius, modulus, poisson));
        Ok(ContactKeys { stiffness, exponent: Some(1.5), ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use vibro_record::Result;

    const ELASTIC: &str = "modulus = [210e9, 210e9]\npoisson = [0.3, 0.3]\n";

    fn stated(radius: &str, elastic: &str) -> Result<ContactKeys> {
        let text = format!("[contact]\nradius = {radius}\n{elastic}");
        Scene::from_toml(&text).map(|scene| scene.contact.unwrap_or_default())
    }

    /// Sphere of 10 mm on a plane, steel: E* = 210 GPa/(2 · 0.91) = 1.153846e11 Pa, k = 4/3 E* √0.01 m.
    /// Two equal spheres have half the radius, a rigid body leaves the compliance of the other one.
    #[test]
    fn stiffness_of_known_contacts() {
        let plane = stated("[0.01, inf]", ELASTIC).unwrap();
        let expected = 4.0 / 3.0 * 210e9 / 1.82 * 0.1;
        assert!((plane.stiffness.unwrap() / expected - 1.0).abs() < 1e-14, "{plane:?}");
        assert_eq!(plane.exponent, Some(1.5));
        let spheres = stated("[0.01, 0.01]", ELASTIC).unwrap().stiffness.unwrap();
        assert!((spheres / expected - 0.5_f64.sqrt()).abs() < 1e-14, "{spheres}");
        let rigid = stated("[0.01, inf]", "modulus = [210e9, 1e30]\npoisson = [0.3, 0]").unwrap();
        // 1e30 Pa beside 2.1e11 Pa.
        assert!((rigid.stiffness.unwrap() / expected - 2.0).abs() < 1e-14);
    }

    #[test]
    fn impossible_bodies_point_at_their_line() {
        for (radius, elastic, line, words) in [
            ("[0.01, inf]", "modulus = [210e9, 210e9]", 2, "contact.radius without contact.poisson"),
            ("[inf, inf]", ELASTIC, 2, "both bodies are flat"),
            ("[0.01, -0.02]", ELASTIC, 2, "contact.radius is -0.02 m"),
            ("[0.01, nan]", ELASTIC, 2, "contact.radius is NaN m"),
            ("[0.01, 1]", "modulus = [0, 1]\npoisson = [0, 0]", 3, "contact.modulus is 0 Pa"),
            ("[0.01, 1]", "modulus = [1, 1]\npoisson = [0, 0.6]", 4, "contact.poisson is 0.6"),
            ("[0.01, 1]", "modulus = [1, 1]\npoisson = [-1, -1]", 4, "contact.poisson is -1"),
            ("[0.01, inf]", &format!("{ELASTIC}stiffness = 1e9"), 5, "stiffness beside contact.radius"),
            ("[0.01, inf]", &format!("{ELASTIC}exponent = 1.5"), 5, "exponent beside contact.radius"),
            ("[0.01]", ELASTIC, 2, "radius"),
            ("0.01", ELASTIC, 2, "radius"),
        ] {
            let error = stated(radius, elastic).unwrap_err().to_string();
            assert!(error.contains(&format!("line {line}")) && error.contains(words), "{radius}: {error}");
        }
    }
}
