//! The command `vibro`.

fn main() {}
