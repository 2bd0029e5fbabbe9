//! A key of a plan that can be changed.

use super::instrument::Instrument;

/// A key, and how it is multiplied by a factor.
pub struct Knob<G> {
    /// The key in words.
    pub key: &'static str,
    /// The change that is proposed, in words.
    pub change: &'static str,
    /// Its factor.
    pub better: f64,
    /// Multiplies the key by a factor; whether the plan has it.
    turn: fn(&mut Instrument, &mut G, f64) -> bool,
}

impl<G> Clone for Knob<G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G> Copy for Knob<G> {}

impl<G: Clone> Knob<G> {
    /// A key that `turn` multiplies by a factor.
    pub const fn new(
        key: &'static str,
        change: &'static str,
        better: f64,
        turn: fn(&mut Instrument, &mut G, f64) -> bool,
    ) -> Knob<G> {
        Knob { key, change, better, turn }
    }

    /// Instrument and guess with the key multiplied by `factor`; `None` where the plan does not have it.
    pub fn turned(&self, instrument: &Instrument, guess: &G, factor: f64) -> Option<(Instrument, G)> {
        let (mut instrument, mut guess) = (instrument.clone(), guess.clone());
        (self.turn)(&mut instrument, &mut guess, factor).then_some((instrument, guess))
    }
}
