//! The generated law against the terms that the control loop steps through.

use super::law::{Law, Piece};
use super::{Code, MUJOCO};
use physics::effects::{
    Coupling, Dahl, Drift, EarlySign, FrictionShape, Harmonic, LaggedSign, LoadFriction, Phase,
    Polynomial, PositionFriction, Sample, Sliding, Stop, Term, TermBank, WarmUp,
};
use std::process::Command;

/// Speed over which the simulator's own friction turns round, rad/s: far below every speed of the motion.
const SOFTNESS: f64 = 0.01;

const STEP: f64 = 0.01;

/// Runs the laws along the motion of `motion.json` and prints the torque of joint 0, a line for each law.
const RUN: &str = "
import importlib, json, sys
import numpy as np
motion = json.load(open('motion.json'))
for k in range(int(sys.argv[1])):
    m = importlib.import_module(f'law_{k}')
    own = [int(name[1:]) for name in m.JOINTS]
    z, last, out = np.zeros(m.MEMORY), None, []
    for row in motion:
        q, qd, qdd, load = (np.array(row[name])[own] for name in ('q', 'qd', 'qdd', 'load'))
        dq = 0.0 * q if last is None else q - last
        level, torque, z = m.law(q, dq, qd, qdd, load, row['dt'], row['clock'], z)
        last = q
        out.append((level * np.sign(qd) + torque)[own.index(0)])
    print(json.dumps(out))
";

fn terms() -> Vec<Term> {
    let harmonic = |order, phase| Harmonic { order, phase };
    let coulomb = FrictionShape::Sliding(Sliding::SoftCoulomb { velocity: SOFTNESS });
    let dahl = FrictionShape::Dahl(Dahl { stiffness: 40.0 });
    let soft = Sliding::SoftStribeck {
        velocity: 0.4,
        exponent: 1.5,
        softness: SOFTNESS,
    };
    vec![
        Term::Offset,
        Term::RotorInertia,
        Term::Sliding(Sliding::Viscous),
        Term::Sliding(Sliding::AsymmetricViscous),
        Term::Sliding(Sliding::Coulomb),
        Term::Sliding(Sliding::SoftCoulomb { velocity: 0.3 }),
        Term::Sliding(Sliding::AsymmetricCoulomb { velocity: SOFTNESS }),
        Term::Sliding(Sliding::Degressive { velocity: 0.5 }),
        Term::Sliding(Sliding::Stribeck { velocity: 0.4 }),
        Term::Sliding(soft),
        Term::Sliding(Sliding::Power { exponent: 0.6 }),
        Term::EarlySign(EarlySign {
            velocity: SOFTNESS,
            lead: 0.01,
        }),
        Term::Stop(Stop { width: 0.02 }),
        Term::Dahl(Dahl { stiffness: 40.0 }),
        Term::DahlRate(Dahl { stiffness: 40.0 }),
        Term::LaggedSign(LaggedSign {
            time_constant: 0.1,
            standstill: 3e-4,
        }),
        Term::Load(LoadFriction::linear(coulomb)),
        Term::Load(LoadFriction {
            friction: dahl,
            exponent: 1.4,
        }),
        Term::Position(PositionFriction {
            harmonic: harmonic(1.0, Phase::Sin),
            friction: coulomb,
        }),
        Term::Position(PositionFriction {
            harmonic: harmonic(3.0, Phase::Cos),
            friction: dahl,
        }),
        Term::Polynomial(Polynomial {
            degree: 3,
            middle: 0.2,
            half: 0.5,
        }),
        Term::Harmonic(harmonic(24.0, Phase::Cos)),
        Term::Coupling(Coupling::Friction {
            driver: 1,
            shape: Sliding::Viscous,
        }),
        Term::Coupling(Coupling::Inertia { driver: 1 }),
        Term::Coupling(Coupling::Spring {
            driver: 1,
            middle: 0.1,
        }),
        Term::Coupling(Coupling::Relative {
            driver: 1,
            ratio: 0.5,
            velocity: 0.2,
        }),
        Term::WarmUp(WarmUp {
            term: Box::new(Term::Sliding(Sliding::Viscous)),
            time_constant: 2.0,
            start: 4.0,
            neutral: 0.5,
        }),
        Term::Drift(Drift {
            term: Box::new(Term::Sliding(Sliding::SoftCoulomb { velocity: SOFTNESS })),
            start: 4.0,
            span: 3.0,
            neutral: 0.5,
        }),
    ]
}

/// Two joints that turn round every fifth of a second, joint 0 never slow.
fn motion() -> Vec<serde_json::Value> {
    let mut q = [0.1, -0.3];
    let row = |k: usize| {
        let t = k as f64 * STEP;
        let way = if (k / 20).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        let qd = [way * (0.6 + 0.3 * (3.0 * t).sin()), 0.7 * (5.0 * t).cos()];
        for (q, qd) in q.iter_mut().zip(qd) {
            *q += STEP * qd;
        }
        let (qdd, load) = (
            [2.0 * (7.0 * t).sin(), (4.0 * t).cos()],
            [12.0 * (2.0 * t).sin(), 3.0],
        );
        serde_json::json!({"q": q, "qd": qd, "qdd": qdd, "load": load, "dt": STEP, "clock": 5.0 + t})
    };
    (0..300).map(row).collect()
}

/// Column of a term on joint 0 along the motion.
fn column(term: &Term, motion: &[serde_json::Value]) -> Vec<f64> {
    let mut bank = TermBank::new(0, vec![term.clone()]);
    let of = |row: &serde_json::Value, name: &str| -> Vec<f64> {
        serde_json::from_value(row[name].clone()).unwrap()
    };
    let step = |row: &serde_json::Value| {
        let mut out = [0.0];
        let sample = Sample {
            clock: row["clock"].as_f64(),
            dt: STEP,
            q: &of(row, "q"),
            qd: &of(row, "qd"),
            qdd: &of(row, "qdd"),
            load: &of(row, "load"),
        };
        bank.step(&sample, &mut out);
        out[0]
    };
    motion.iter().map(step).collect()
}

/// Every term, alone: what Python computes of the generated text is what the control loop adds, to rounding. Where friction turns
/// round with its own joint the law gives its level, and the simulator the sign.
#[test]
fn the_law_is_what_the_control_loop_adds() {
    let Some(python) = std::env::var_os("RESIDYN_PYTHON") else {
        println!("skipped: RESIDYN_PYTHON names no interpreter with numpy");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let names = ["j0".to_owned(), "j1".to_owned()];
    let terms = terms();
    for (k, term) in terms.iter().enumerate() {
        let piece = Piece {
            joint: 0,
            effect: "tried",
            size: 1.7,
            term: term.clone(),
        };
        let law = Law::new(&[piece], &[SOFTNESS; 2], &names);
        let joints: Vec<String> = law.joints.iter().map(|&j| names[j].clone()).collect();
        let code = Code {
            softness: vec![SOFTNESS; joints.len()],
            level: vec![true; joints.len()],
            held: Vec::new(),
            beyond: Vec::new(),
            joints,
            law,
        };
        let text = code.law_text("numpy");
        assert!(code.text(MUJOCO, "m", "d.xml").contains(&text));
        std::fs::write(folder.path().join(format!("law_{k}.py")), text).unwrap();
    }
    let motion = motion();
    std::fs::write(
        folder.path().join("motion.json"),
        serde_json::to_vec(&motion).unwrap(),
    )
    .unwrap();
    let run = Command::new(python)
        .args(["-c", RUN, &terms.len().to_string()])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    let lines = String::from_utf8(run.stdout).unwrap();
    assert_eq!(lines.lines().count(), terms.len());
    for (term, line) in terms.iter().zip(lines.lines()) {
        let computed: Vec<f64> = serde_json::from_str(line).unwrap();
        let expected = column(term, &motion);
        let largest = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!(largest > 0.01, "{} shows nothing", term.label());
        for (k, (own, reference)) in computed.iter().zip(&expected).enumerate() {
            let off = (own - 1.7 * reference).abs();
            assert!(
                off < 1e-9 * largest,
                "{} at sample {k}: {own} instead of {}",
                term.label(),
                1.7 * reference
            );
        }
    }
}

#[test]
fn names_are_literals_of_python() {
    let odd = "a\"b\\c\td\u{85}é";
    assert_eq!(super::string(odd), "\"a\\\"b\\\\c\\x09d\\x85é\"");
    let program = format!(
        "import sys; sys.stdout.buffer.write({}.encode())",
        super::string(odd)
    );
    let python = std::env::var_os("RESIDYN_PYTHON").unwrap_or_else(|| "python3".into());
    match Command::new(python).args(["-c", &program]).output() {
        Ok(done) => assert_eq!(done.stdout, odd.as_bytes()),
        Err(_) => println!("no Python: nobody has read the literal"),
    }
}
