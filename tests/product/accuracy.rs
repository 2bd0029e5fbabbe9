//! Estimators against known truths: how close they come to the Cramér–Rao bound, and how often their
//! intervals hold the truth. Random cases with fixed seeds: four in the quick tests, all of them with
//! `cargo test --release -- --ignored`; `--nocapture` prints the figures.

mod bounces;
mod contact;
mod draws;
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
mod stroke;
mod transfer;
