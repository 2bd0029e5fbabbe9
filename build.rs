//! Takes the page `vibro.html`, which `crates/vibro-app/build.sh` makes, into the command: the file that the
//! variable `VIBRO_APP` names. Without it the command is built without the page.

use std::path::Path;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-env-changed=VIBRO_APP");
    println!("cargo::rerun-if-changed=build.rs");
    let to = Path::new(&env::var_os("OUT_DIR").expect("cargo names a folder")).join("vibro.html");
    let page = env::var_os("VIBRO_APP").filter(|path| !path.is_empty());
    match page {
        Some(path) => {
            println!("cargo::rerun-if-changed={}", Path::new(&path).display());
            fs::copy(&path, to)
                .unwrap_or_else(|e| panic!("VIBRO_APP names {}: {e}", Path::new(&path).display()));
        }
        None => fs::write(to, "").expect("cargo's folder can be written"),
    }
}
