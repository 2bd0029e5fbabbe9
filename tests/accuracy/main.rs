//! Estimators against their bounds: spread, bias and coverage over random cases with a known truth. What was reached is printed
//! (`cargo test --test accuracy -- --nocapture`).

mod impacts;
mod noise;
mod restitution;
