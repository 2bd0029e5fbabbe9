//! How close estimates come to a known truth, and whether their uncertainties are true: many random cases with fixed seeds.
//! Run with `--nocapture` to see the figures.

mod drill;
