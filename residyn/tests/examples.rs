//! Every example runs to its end: each checks what it shows.

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn examples_run() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    // target/release/deps/examples-HASH; examples lie beside deps, built with this test.
    let test = std::env::current_exe().expect("a running test has a path");
    let built = test
        .ancestors()
        .nth(2)
        .expect("two folders up")
        .join("examples");
    let mut names: Vec<String> = std::fs::read_dir(sources)
        .expect("the examples are there")
        .map(|entry| entry.expect("readable").path())
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    assert_eq!(names.len(), 11, "{names:?}");
    let elsewhere = tempfile::tempdir().expect("a folder for temporary files");
    let run = |name: &String| {
        let done = Command::new(built.join(name))
            .current_dir(&elsewhere)
            .output()
            .unwrap_or_else(|e| {
                panic!("{name}: {e}; `cargo test` builds it, with `--test examples` alone `cargo build --examples` has to")
            });
        let (out, err) = (
            String::from_utf8_lossy(&done.stdout),
            String::from_utf8_lossy(&done.stderr),
        );
        println!("\n== {name}\n{out}");
        assert!(done.status.success(), "{name}: {out}\n{err}");
        assert!(!out.is_empty(), "{name} prints what it shows");
    };
    // Two at a time: most use one core.
    let (next, names) = (AtomicUsize::new(0), &names);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
                    run(name);
                }
            });
        }
    });
    let left = std::fs::read_dir(&elsewhere).expect("readable").count();
    assert_eq!(left, 0, "an example leaves nothing behind");
}
