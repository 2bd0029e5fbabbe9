//! Estimators against truths: how near they come to the Cramér–Rao bound, and how often the truth lies in their intervals.

mod random;
mod sine;
mod transfer;
