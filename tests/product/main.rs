//! The product from outside: the library's public face, the command line, the examples.

mod accuracy;
mod cli;
mod clocks;
mod contributing;
mod doubts;
mod drill;
mod drill_limits;
mod example_campaign;
mod example_drop_test;
mod failure_map;
mod found;
mod impacts_reference;
mod layers;
mod links;
mod model_reference;
mod others_files;
mod read;
mod real_files;
mod report;
mod sweep_reference;
mod write_uff;
