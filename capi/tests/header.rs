//! The header in the repository against the Rust types that it is written from.

use std::path::Path;

fn written() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("settings");
    let files = ["code", "load", "handle", "torque", "dynamics", "guard"];
    let builder = files.iter().fold(
        cbindgen::Builder::new().with_config(config),
        |builder, file| builder.with_src(root.join(format!("src/{file}.rs"))),
    );
    let bindings = builder.generate().expect("a header");
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).expect("text");
    // The duties of a caller stand in docs/embedding.md once, not at every function.
    let mut kept: Vec<&str> = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        if line.trim() == "# Safety" {
            kept.pop();
            while lines.peek().is_some_and(|l| l.trim() != "*/") {
                lines.next();
            }
        } else {
            kept.push(line);
        }
    }
    kept.join("\n") + "\n"
}

const HEADER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/include/residyn.h");

#[test]
fn the_header_is_what_the_types_say() {
    let stored = std::fs::read_to_string(HEADER).expect("the header");
    assert!(
        stored == written(),
        "include/residyn.h is not what src/ says: cargo test -p residyn-capi --test header -- --ignored"
    );
}

#[test]
#[ignore = "writes the header"]
fn write() {
    std::fs::write(HEADER, written()).expect("a header");
}
