//! Speed against accuracy: figures and tables of scenes and of borders.

pub mod figures;
pub mod tables;
