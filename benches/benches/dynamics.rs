//! Rigid-body dynamics of a six-joint arm against Pinocchio's C++ in the same run:
//!
//! ```text
//! PYTHON=python3 benches/peers/build.sh && cargo bench -p residyn-benches --bench dynamics
//! ```

use benches::{Peer, quiet, target_dir};
use criterion::Criterion;
use physics::dynamics::*;
use physics::robot::Robot;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Duration;

const GROUP: &str = "dynamics";
const ALGORITHMS: [&str; 4] = [
    "inverse_dynamics",
    "mass_matrix",
    "forward_dynamics",
    "regressor",
];

fn main() {
    let robot = Robot::builtin("ur5").expect("built in");
    let mut criterion = Criterion::default()
        .without_plots()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    let mut group = criterion.benchmark_group(GROUP);
    let mut workspace = Workspace::new(&robot);
    let line = |a: f64, b: f64| std::array::from_fn::<f64, 6, _>(|i| a + (b - a) * i as f64 / 5.0);
    let (mut q, qd, qdd) = (line(0.1, 1.3), line(-1.0, 1.0), line(2.0, -3.0));
    let (mut vector, mut matrix, mut y) = ([0.0; 6], [0.0; 36], [0.0; 360]);
    let mut peer = Peer::start(&target_dir().join("peers/pinocchio"), &setup(&robot));
    for name in ALGORITHMS {
        group.bench_function(name, |b| {
            b.iter(|| {
                q[0] += 1e-9;
                match name {
                    "inverse_dynamics" => {
                        inverse_dynamics(
                            &robot,
                            &mut workspace,
                            black_box(&q),
                            &qd,
                            &qdd,
                            &mut vector,
                        );
                    }
                    "mass_matrix" => {
                        mass_matrix(&robot, &mut workspace, black_box(&q), &mut matrix)
                    }
                    "forward_dynamics" => forward_dynamics(
                        &robot,
                        &mut workspace,
                        black_box(&q),
                        &qd,
                        &qdd,
                        &[],
                        &mut vector,
                    ),
                    _ => regressor(&robot, &mut workspace, black_box(&q), &qd, &qdd, &mut y),
                }
                black_box((&vector, &matrix, &y));
            });
        });
        if let Some(peer) = &mut peer {
            group.bench_function(format!("{name}_pinocchio"), |b| {
                b.iter_custom(|iterations| peer.time(name, iterations));
            });
        }
    }
    group.finish();

    println!(
        "\n{:<18}{:>10}{:>16}{:>8}",
        "first decile", "here", "Pinocchio C++", "ratio"
    );
    for name in ALGORITHMS {
        let Some(ours) = quiet(GROUP, name) else {
            continue;
        };
        match quiet(GROUP, &format!("{name}_pinocchio")).filter(|_| peer.is_some()) {
            Some(theirs) => println!(
                "{name:<18}{ours:>7.0} ns{theirs:>13.0} ns{:>8.2}",
                ours / theirs
            ),
            None => println!("{name:<18}{ours:>7.0} ns{:>16}{:>8}", "-", "-"),
        }
    }
}

/// The robot as the peer reads it. Valid for axes along z, as the built-in arms have them.
fn setup(robot: &Robot) -> String {
    let g = robot.gravity();
    let mut text = format!("{}\n{} {} {}\n", robot.dof(), g.x, g.y, g.z);
    for joint in robot.joints() {
        // nalgebra iterates by columns.
        let placement = joint.rotation.transpose();
        let numbers = placement.iter().chain(&joint.translation).copied();
        for value in numbers.chain(joint.link.inertia.parameters()) {
            let _ = write!(text, "{value} ");
        }
        text.push('\n');
    }
    text
}
