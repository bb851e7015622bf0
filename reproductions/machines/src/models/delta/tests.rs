use super::*;

const SHAPE: Shape = Shape {
    offset: 0.155,
    arm: 0.235,
    forearm: 0.8,
};

const Q: [f64; 3] = [0.2, 0.7, -0.3];
const QD: [f64; 3] = [1.3, -2.1, 0.8];
const QDD: [f64; 3] = [-4.0, 9.0, 15.0];

fn plate(q: [f64; 3]) -> Vector3<f64> {
    SHAPE.pose(q).expect("within reach").plate
}

/// All forearms keep their length, and the way back from the plate gives the angles.
#[test]
fn forward_and_inverse_kinematics_agree() {
    for q in [Q, [0.0; 3], [1.2, -0.5, 0.4]] {
        let x = plate(q);
        assert!(x.z < -0.4);
        let back = SHAPE.angles(x).expect("within reach");
        for i in 0..3 {
            assert!((back[i] - q[i]).abs() < 1e-12, "{back:?} {q:?}");
        }
    }
    let short = Shape {
        forearm: 0.2,
        ..SHAPE
    };
    assert!(short.pose([0.0; 3]).is_none());
    assert!(SHAPE.angles(Vector3::new(0.0, 0.0, -2.0)).is_none());
}

/// Straight down at equal angles, by hand.
#[test]
fn the_plate_hangs_below_the_middle() {
    let q: f64 = 0.3;
    let across = SHAPE.offset + SHAPE.arm * q.cos();
    let z = -SHAPE.arm * q.sin() - (SHAPE.forearm.powi(2) - across.powi(2)).sqrt();
    assert!((plate([q; 3]) - Vector3::new(0.0, 0.0, z)).norm() < 1e-14);
}

/// Velocity and acceleration against differences of the position along q(t) = Q + QD t + QDD t²/2.
#[test]
fn derivatives_are_those_of_the_position() {
    let at = |t: f64| {
        plate(std::array::from_fn(|i| {
            Q[i] + QD[i] * t + 0.5 * QDD[i] * t * t
        }))
    };
    let h = 1e-4;
    let velocity = (at(h) - at(-h)) / (2.0 * h);
    let acceleration = (at(h) - at(0.0) * 2.0 + at(-h)) / (h * h);
    let moving = SHAPE.pose(Q).expect("within reach").moving(QD, QDD);
    assert!((moving.velocity - velocity).norm() < 1e-6 * velocity.norm());
    assert!((moving.acceleration - acceleration).norm() < 1e-5 * acceleration.norm());
}

/// Torque from the rows is d/dt ∂T/∂q̇ − ∂T/∂q + ∂V/∂q of energies, all by differences: column by column.
#[test]
fn rows_are_the_derivatives_of_energies() {
    let model = Delta::new(SHAPE, 3, 2);
    let mut rows = [0.0; 15];
    model.rows(&Q, &QD, &QDD, &mut rows).expect("within reach");
    let elbows =
        |q: [f64; 3]| -> [Vector3<f64>; 3] { std::array::from_fn(|i| SHAPE.elbow(i, q[i])) };
    // Kinetic energy of each parameter's unit, from displacements over a short time.
    let kinetic = |column: usize, q: [f64; 3], qd: [f64; 3]| -> f64 {
        let t = 1e-5;
        let shifted = |s: f64| -> [f64; 3] { std::array::from_fn(|i| q[i] + s * qd[i] * t) };
        let x = (plate(shifted(1.0)) - plate(shifted(-1.0))) / (2.0 * t);
        let (e1, e0) = (elbows(shifted(1.0)), elbows(shifted(-1.0)));
        let e: [Vector3<f64>; 3] = std::array::from_fn(|i| (e1[i] - e0[i]) / (2.0 * t));
        match column {
            0 => 0.5 * qd.iter().map(|v| v * v).sum::<f64>(),
            2 => 0.5 * x.norm_squared(),
            4 => e.iter().map(|e| e.dot(&x)).sum::<f64>() / 6.0,
            _ => 0.0,
        }
    };
    let potential = |column: usize, q: [f64; 3]| match column {
        1 => -q.iter().map(|q| q.sin()).sum::<f64>(),
        3 => GRAVITY * plate(q).z,
        _ => 0.0,
    };
    let step = |v: [f64; 3], i: usize, h: f64| -> [f64; 3] {
        std::array::from_fn(|k| if k == i { v[k] + h } else { v[k] })
    };
    let h = 1e-3;
    for column in 0..5 {
        for i in 0..3 {
            let momentum = |t: f64| {
                let q = std::array::from_fn(|k| Q[k] + QD[k] * t + 0.5 * QDD[k] * t * t);
                let qd = std::array::from_fn(|k| QD[k] + QDD[k] * t);
                let more = kinetic(column, q, step(qd, i, h));
                (more - kinetic(column, q, step(qd, i, -h))) / (2.0 * h)
            };
            let slope =
                |f: &dyn Fn([f64; 3]) -> f64| (f(step(Q, i, h)) - f(step(Q, i, -h))) / (2.0 * h);
            let expected = (momentum(h) - momentum(-h)) / (2.0 * h)
                - slope(&|q| kinetic(column, q, QD))
                + slope(&|q| potential(column, q));
            let found = rows[i * 5 + column];
            assert!(
                (found - expected).abs() < 1e-3 * expected.abs().max(0.1),
                "column {column}, arm {i}: {found} {expected}"
            );
        }
    }
}
