//! Estimators against truths: how near they come to the Cramér–Rao bound, and how often the truth lies in their intervals.
//! Many random cases with fixed seeds; run with `--nocapture` to see the figures.

mod bounces;
mod contact;
mod drill;
mod exposure;
mod impacts;
mod modal;
mod noise;
mod pulse;
mod restitution;
mod ringing;
mod rivals;
mod score;
mod sine;
mod spectrum;
mod transfer;
