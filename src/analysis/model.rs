//! The model of a rig: figures and tables of its orbits, motions, sweeps, maps, and of the choice of a model.

pub mod figures;
pub mod tables;
