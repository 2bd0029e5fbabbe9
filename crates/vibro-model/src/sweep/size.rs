//! Size of an excitation, as a sweep of the force changes it.

use crate::Excitation;

/// Force of a sine or pulse in N, of several sines that of the first; impulse in N s.
pub fn size(excitation: &Excitation) -> f64 {
    match excitation {
        Excitation::Sine(sine) => sine.force,
        Excitation::Pulse(pulses) => pulses.force,
        Excitation::Impulse(impulses) => impulses.impulse,
        Excitation::Sines(sines) => sines.parts.first().map_or(f64::NAN, |p| p.force),
    }
}

/// The same excitation of another size; the ratios of several sines stay.
pub fn at_size(excitation: &Excitation, value: f64) -> Excitation {
    let mut changed = excitation.clone();
    match &mut changed {
        Excitation::Sine(sine) => sine.force = value,
        Excitation::Pulse(pulses) => pulses.force = value,
        Excitation::Impulse(impulses) => impulses.impulse = value,
        Excitation::Sines(sines) => {
            let ratio = value / size(excitation);
            sines.parts.iter_mut().for_each(|p| p.force *= ratio);
        }
    }
    changed
}
