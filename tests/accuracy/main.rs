//! How good the estimates are: against the bound of Cramér and Rao, and whether 95 % intervals hold the truth in 95 % of cases.
//! Each case has its own seed, and each test prints what it reached.

mod modal;
mod noise;
mod pulse;
mod score;
