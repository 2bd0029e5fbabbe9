//! The command `vibro`: see [`vibroimpact::cli`].

fn main() -> std::process::ExitCode {
    vibroimpact::cli::main(std::env::args_os()).into()
}
