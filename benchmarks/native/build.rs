//! Passes the settings of the build to the program, which prints them with its figures.

use std::env;
use std::process::Command;

fn main() {
    let compiler = env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let said = Command::new(compiler).arg("--version").output();
    let said = said.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let version = said.unwrap_or_default().split(' ').nth(1).unwrap_or("unknown").to_owned();
    println!("cargo::rustc-env=RUST_VERSION={version}");
    // The crate around Box2D leaves its assertions on unless these flags say otherwise.
    let flags = env::var("CFLAGS").unwrap_or_default();
    println!("cargo::rustc-env=C_FLAGS={flags}");
    println!("cargo::rerun-if-env-changed=CFLAGS");
    println!("cargo::rerun-if-changed=build.rs");
}
