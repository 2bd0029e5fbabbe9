//! Records to files, one file a format.

pub mod uff58;
