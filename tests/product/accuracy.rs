//! Estimators against truths: how near they come to the Cramér–Rao bound, and how often the truth lies in
//! their intervals. Random cases with fixed seeds: a few in the quick tests, all in those that `cargo test
//! --release -- --ignored` runs; `--nocapture` shows the figures.

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
mod transfer;
