//! The C and the C++ example, compiled against an installed libresidyn, under AddressSanitizer and UndefinedBehaviorSanitizer: the
//! torque of `eval`. The plug-ins for ROS 2 against stand-ins.

use feedforward::clock::LONGEST_PAUSE;
use signal::Motion;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tests::program::run;

/// A motion with the torque that is expected, as the examples read it; before each trajectory a reset on the training's clock, or a
/// pause where the one before is near.
pub fn rows(motion: &Motion, expected: &[Vec<f64>]) -> String {
    let mut text = String::new();
    let mut last = None;
    for segment in &motion.segments {
        let start = motion.time[segment.start];
        let mut before = match last.map(|end| start - end) {
            Some(pause) if pause <= LONGEST_PAUSE => (2, pause),
            _ => (1, start),
        };
        last = Some(motion.time[segment.end - 1]);
        for row in segment.clone() {
            let (what, value) = std::mem::take(&mut before);
            let _ = write!(text, "{what} {value:e}");
            let tables = [&motion.q, &motion.qd, &motion.qdd];
            for value in tables.iter().flat_map(|t| t.row(row)).chain(&expected[row]) {
                let _ = write!(text, " {value:e}");
            }
            text.push('\n');
        }
    }
    text
}

/// Installs libresidyn, compiles both examples in every way that this machine has, and runs them on `model`.
pub fn follow(model: &Path, period: f64, rows: &str, folder: &Path) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let prefix = folder.join("installed");
    let test = std::env::current_exe().expect("a running test has a path");
    let built = test.ancestors().nth(2).expect("target/release");
    let mut install = Command::new("python3");
    install.arg(root.join("capi/install.py")).arg("--build");
    run(install.arg(built).arg("--prefix").arg(&prefix)).succeeded();
    let motion = folder.join("motion.txt");
    std::fs::write(&motion, rows).expect("a motion");
    let mut programs = vec![
        compiled(
            &root,
            &prefix,
            "gcc",
            &["-std=c11", "-Wpedantic"],
            "c",
            folder,
        ),
        compiled(&root, &prefix, "g++", &["-std=c++17"], "cpp", folder),
        compiled(&root, &prefix, "g++", &["-std=c++20"], "cpp", folder),
    ];
    match by_cmake(&root, &prefix, folder) {
        Some(more) => programs.extend(more),
        None => eprintln!("no cmake (pip install cmake): find_package(residyn) is not tried"),
    }
    fit_for_real_time(&root, &prefix, model, folder);
    under_ros2_control(&root, &prefix, model, folder);
    for program in programs {
        let mut command = Command::new(&program);
        command.arg(model).arg(period.to_string()).arg(&motion);
        let ended = run(&mut command);
        ended.succeeded();
        eprintln!("{}: {}", program.display(), ended.out.trim());
        assert!(ended.err.is_empty(), "{}", ended.err);
        // What is no model is an error with words, not an end without.
        let mut command = Command::new(&program);
        let ended = run(command.arg(folder).arg("0").arg(&motion));
        assert!(
            ended.status == 2 && ended.err.contains("model.json"),
            "{}",
            ended.err
        );
    }
}

/// No allocation, page fault, wait or system call in twenty seconds of a loop at 1 kHz, by the example that counts them;
/// `docs/real-time.md` tells of a million ticks.
fn fit_for_real_time(root: &Path, prefix: &Path, model: &Path, folder: &Path) {
    let program = folder.join("rt_proof");
    let mut command = Command::new("gcc");
    command.args(["-std=gnu11", "-Wall", "-Wextra", "-Werror", "-O2"]);
    command.arg(root.join("capi/examples/rt_proof.c"));
    command.arg(format!("-I{}", prefix.join("include").display()));
    let lib = prefix.join("lib");
    command.arg(format!("-L{}", lib.display()));
    command.args(["-lresidyn", "-lm", "-o"]).arg(&program);
    command.arg(format!("-Wl,-rpath,{}", lib.display()));
    run(&mut command).succeeded();
    let ended = run(Command::new(&program).arg(model).args(["0.001", "20000"]));
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
    eprint!("{}", ended.out);
}

/// The controller and the solver of `integrations/ros2_control` against stand-ins of ROS 2, each run by its test on `model`.
fn under_ros2_control(root: &Path, prefix: &Path, model: &Path, folder: &Path) {
    let package = root.join("integrations/ros2_control");
    let lib = prefix.join("lib");
    let ran = |source: &str, test: &str, more: &[String]| {
        let program = folder.join(test);
        let mut command = Command::new("g++");
        command.args(["-std=c++17", "-Wall", "-Wextra", "-Werror", "-O1"]);
        for one in [format!("src/{source}.cpp"), format!("test/{test}.cpp")] {
            command.arg(package.join(one));
        }
        for include in ["include", "test/stand_in"] {
            command.arg(format!("-I{}", package.join(include).display()));
        }
        command.arg(format!("-I{}", prefix.join("include").display()));
        command.args(more).arg(format!("-L{}", lib.display()));
        command.args(["-lresidyn", "-o"]).arg(&program);
        command.arg(format!("-Wl,-rpath,{}", lib.display()));
        run(&mut command).succeeded();
        let ended = run(Command::new(&program).arg(model));
        assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
        eprint!("{test}: {}", ended.out);
    };
    ran("feedforward_controller", "test_controller", &[]);
    match eigen() {
        Some(include) => ran(
            "inverse_dynamics",
            "test_solver",
            &["-isystem".to_owned(), include],
        ),
        None => eprintln!("no Eigen (pip install cmeel-eigen): the solver is not compiled"),
    }
}

/// Eigen's headers, from its wheel.
fn eigen() -> Option<String> {
    let python = std::env::var_os("RESIDYN_PYTHON")?;
    let asked = "import importlib.metadata as m; f = m.distribution('cmeel-eigen'); print(f.locate_file('cmeel.prefix/include/eigen3'))";
    let output = Command::new(python).args(["-c", asked]).output().ok()?;
    let path = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    Path::new(&path)
        .join("Eigen/Core")
        .is_file()
        .then_some(path)
}

/// An example, compiled with what pkg-config says, where there is one.
fn compiled(
    root: &Path,
    prefix: &Path,
    compiler: &str,
    dialect: &[&str],
    ending: &str,
    folder: &Path,
) -> PathBuf {
    let program = folder.join(format!("follow_{ending}{}", dialect[0]));
    let lib = prefix.join("lib");
    let mut asked = Command::new("pkg-config");
    asked.args(["--cflags", "--libs", "residyn"]);
    let flags: Vec<String> = match asked.env("PKG_CONFIG_PATH", lib.join("pkgconfig")).output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            assert!(
                output.status.success(),
                "{}",
                String::from_utf8_lossy(&output.stderr)
            );
            said.split_whitespace().map(str::to_owned).collect()
        }
        Err(_) => vec![
            format!("-I{}", prefix.join("include").display()),
            format!("-L{}", lib.display()),
            "-lresidyn".to_owned(),
        ],
    };
    let mut command = Command::new(compiler);
    command
        .args(dialect)
        .args(["-Wall", "-Wextra", "-Werror", "-O1", "-g"]);
    command.args(["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]);
    command.arg(root.join(format!("capi/examples/follow.{ending}")));
    command.args(flags).arg("-lm").arg("-o").arg(&program);
    command.arg(format!("-Wl,-rpath,{}", lib.display()));
    run(&mut command).succeeded();
    program
}

/// Both examples by `find_package`; none without cmake.
fn by_cmake(root: &Path, prefix: &Path, folder: &Path) -> Option<[PathBuf; 2]> {
    let beside = std::env::var_os("RESIDYN_PYTHON").map(PathBuf::from);
    let wheel = beside.and_then(|python| Some(python.parent()?.join("cmake")));
    let cmake = wheel
        .filter(|path| path.is_file())
        .unwrap_or_else(|| "cmake".into());
    Command::new(&cmake).arg("--version").output().ok()?;
    let build = folder.join("cmake");
    let mut configure = Command::new(&cmake);
    configure
        .arg("-S")
        .arg(root.join("capi/examples"))
        .arg("-B")
        .arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    run(&mut configure).succeeded();
    run(Command::new(&cmake).arg("--build").arg(&build)).succeeded();
    Some(["follow_c", "follow_cpp"].map(|name| build.join(name)))
}
