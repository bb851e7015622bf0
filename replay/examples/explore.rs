use ndarray::{Array2, Axis, s};
use physics::robot::Robot;
use replay::arm::{Arm, Integral, Servo};
use replay::command::{Command, Interpolation};
use replay::fit::{Free, Noise, errors, fit, noise};
use replay::parameter::{Kind, Parameter};
use replay::simulate::Track;
use std::path::Path;

fn tracks(rec: &datasets::Recording, block: f64, n: usize) -> Vec<Track> {
    let mut out = Vec::new();
    for t in rec.trajectories.iter() {
        let trajectory = t.label.bytes().map(usize::from).sum::<usize>()
            + rec.len()
            + rec.source.bytes().map(usize::from).sum::<usize>();
        let r = t.range.clone();
        let time = &rec.time[r.clone()];
        let total = time[time.len() - 1] - time[0];
        let count = (total / block).floor().max(1.0) as usize;
        for b in 0..count {
            let a = r.start + (r.len() * b) / count;
            let e = r.start + (r.len() * (b + 1)) / count;
            let time: Vec<f64> = rec.time[a..e].to_vec();
            let q = rec.q.slice(s![a..e, ..n]).to_owned();
            let cmd = |table: &Array2<f64>| -> Vec<Command> {
                (0..n)
                    .map(|j| {
                        Command::new(
                            &rec.time[r.clone()],
                            table.slice(s![r.clone(), j]).to_vec(),
                            Interpolation::Hold,
                        )
                    })
                    .collect()
            };
            let start_velocity = (0..n)
                .map(|j| rec.qd.as_ref().map_or(0.0, |qd| qd[(a, j)]))
                .collect();
            out.push(Track {
                trajectory,
                time,
                q,
                start_velocity,
                commands: cmd(rec.q_ref.as_ref().unwrap()),
                rates: rec.qd_ref.as_ref().map(|t| cmd(t)),
            });
        }
    }
    out
}

fn score(arm: &Arm, rec: &datasets::Recording) -> (Vec<f64>, f64) {
    let n = arm.dof();
    let (mut s, mut t) = (vec![0.0; n], vec![0.0; n]);
    for track in tracks(rec, 1e9, n) {
        let e = errors(arm, &track).unwrap();
        for (i, v) in e.iter().enumerate() {
            s[i % n] += v * v;
        }
    }
    let qr = rec.q_ref.as_ref().unwrap();
    for r in 0..rec.len() {
        for j in 0..n {
            t[j] += (qr[(r, j)] - rec.q[(r, j)]).powi(2);
        }
    }
    let u: Vec<f64> = s.iter().zip(&t).map(|(s, t)| (s / t).sqrt()).collect();
    let m = u.iter().sum::<f64>() / n as f64;
    (u, m)
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let data = "../shared/data";
    let which = args[1].as_str();
    let opts: Vec<&str> = args[2].split(',').collect();
    let names = |s: &str| -> Vec<String> { s.split(' ').map(String::from).collect() };
    let (robot, fitnames, tests, n) = if which == "so101" {
        let j = names("shoulder_pan shoulder_lift elbow_flex wrist_flex wrist_roll");
        (
            Robot::load(&format!("{data}/so101/so101.xml"), &j)
                .unwrap()
                .0,
            args[3]
                .split(',')
                .map(|f| format!("so101/{f}.parquet"))
                .collect::<Vec<_>>(),
            [
                "multisine",
                "prbs_excitation",
                "friction_gravity",
                "chirp_sweep",
                "fast_transitions",
                "step_response",
                "large_amplitude",
                "hold_under_gravity",
            ]
            .iter()
            .map(|f| format!("so101/{f}.parquet"))
            .collect::<Vec<_>>(),
            5,
        )
    } else {
        (
            Robot::load(&format!("{data}/z1/z1.xml"), &[]).unwrap().0,
            vec!["z1/train.parquet".into()],
            vec!["z1/train.parquet".to_string(), "z1/test.parquet".into()],
            7,
        )
    };
    let read = |f: &String| {
        datasets::read(
            Path::new(&format!("{data}/{f}")),
            &datasets::ReadOptions {
                dof: Some(n),
                ..Default::default()
            },
        )
        .unwrap()
    };
    let has = |o: &str| opts.contains(&o);
    let z1 = which == "z1";
    let servos: Vec<Servo> = (0..n)
        .map(|i| Servo {
            kp: if z1 {
                [80., 120., 120., 80., 80., 80., 80.][i]
            } else {
                998.22
            },
            kd: if z1 { 2.5 } else { 2.731 },
            ki: 0.0,
            integral: Integral::None,
            back_emf: 0.0,
            drive_limit: f64::INFINITY,
            limit: if z1 { f64::INFINITY } else { 3.35 },
            dead_band: 0.0,
            delay: 0.0,
            lag: 0.0,
            acceleration: f64::INFINITY,
            offset: 0.0,
        })
        .collect();
    let mut arm = Arm::new(robot, servos);
    println!("{:?}", arm.robot.notes());
    for t in &tests {
        let (u, m) = score(&arm, &read(t));
        println!("given {t}: {m:.3} {u:.2?}");
    }
    let mut free = Vec::new();
    let mut push =
        |arm: &mut Arm, kind: Kind, joint: usize, start: Option<f64>, prior: Option<(f64, f64)>| {
            let parameter = Parameter::new(kind, joint);
            if let Some(v) = start {
                arm.set(&[(parameter, v)]).unwrap();
            }
            free.push(Free { parameter, prior });
        };
    for j in 0..n {
        if has("kp") {
            push(&mut arm, Kind::Gain, j, (!z1).then_some(20.0), None);
        }
        if has("kd") {
            push(&mut arm, Kind::ServoDamping, j, None, None);
        } else if !z1 {
            arm.set(&[(Parameter::new(Kind::ServoDamping, j), 0.0)])
                .unwrap();
        }
        if has("damping") {
            push(&mut arm, Kind::Damping, j, None, None);
        }
        if has("coulomb") {
            push(&mut arm, Kind::Coulomb, j, None, None);
        }
        if has("armature") {
            push(&mut arm, Kind::Armature, j, None, None);
        }
        if has("offset") {
            push(&mut arm, Kind::Offset, j, None, None);
        }
        if has("zero") {
            push(&mut arm, Kind::Zero, j, None, Some((0.0, 0.1)));
        }
        if has("sat") {
            push(&mut arm, Kind::DriveLimit, j, Some(3.0), None);
        }
        if has("load") {
            push(&mut arm, Kind::Load, j, Some(0.05), None);
        }
        if has("stribeck") {
            push(&mut arm, Kind::Stribeck, j, Some(0.02), None);
        }
        if has("vs") {
            push(
                &mut arm,
                Kind::StribeckVelocity,
                j,
                None,
                Some(((0.1f64).ln(), 1.0)),
            );
        }
        if has("dead") {
            push(&mut arm, Kind::DeadBand, j, Some(0.003), None);
        }
        if has("lag") {
            push(&mut arm, Kind::Lag, j, Some(0.01), None);
        }
        if has("acc") {
            push(&mut arm, Kind::Acceleration, j, Some(60.0), None);
        }
        if has("a39") {
            arm.set(&[(Parameter::new(Kind::Acceleration, j), 38.96)])
                .unwrap();
        }
        if has("a45") {
            arm.set(&[(Parameter::new(Kind::Acceleration, j), 45.0)])
                .unwrap();
        }
        if has("delays") {
            push(&mut arm, Kind::Delay, j, Some(0.005), None);
        }
    }
    if has("delay") {
        push(&mut arm, Kind::CommonDelay, 0, Some(0.005), None);
    }
    if has("gc") {
        push(&mut arm, Kind::GravityCompensation, 0, Some(0.5), None);
    }
    if has("scale") {
        for j in 0..n {
            push(&mut arm, Kind::LinkScale, j, None, Some((0.0, 0.1)));
        }
    }
    if has("payload") {
        push(&mut arm, Kind::Payload(0), 0, Some(0.05), None);
        for k in 1..4 {
            push(&mut arm, Kind::Payload(k), 0, Some(0.001), None);
        }
    }
    let _ = Axis(0);
    let mut blocks = Vec::new();
    let every: usize = args.get(4).map_or(1, |s| s.parse().unwrap());
    for f in &fitnames {
        blocks.extend(tracks(&read(f), 15.0, n).into_iter().step_by(every));
    }
    let floors = vec![1e-7; n];
    let mut ns: Vec<Noise> = floors
        .iter()
        .map(|&floor| Noise {
            floor,
            correlation: 20.0,
        })
        .collect();
    let t0 = std::time::Instant::now();
    for round in 0..2 {
        let f = fit(&arm, &free, &blocks, &ns).unwrap();
        println!(
            "round {round}: {} it, objective {:.1}, {:?}",
            f.iterations,
            f.objective,
            t0.elapsed()
        );
        arm = f.arm.clone();
        ns = noise(&arm, &blocks, &floors).unwrap();
    }
    println!(
        "{:?}",
        ns.iter().map(|n| n.correlation.round()).collect::<Vec<_>>()
    );
    let mut kinds: Vec<Kind> = free.iter().map(|f| f.parameter.kind).collect();
    kinds.dedup();
    kinds.sort();
    kinds.dedup();
    for k in kinds {
        println!(
            "{k:?}: {:.4?}",
            free.iter()
                .filter(|f| f.parameter.kind == k)
                .map(|f| arm.get(f.parameter))
                .collect::<Vec<_>>()
        );
    }
    if let Some(f) = args.get(5) {
        let rec = read(&format!("so101/{f}.parquet"));
        let track = &tracks(&rec, 1e9, n)[0];
        let e = errors(&arm, track).unwrap();
        let mut text = String::new();
        for r in 0..rec.len() {
            text += &format!("{}", rec.time[r] - rec.time[0]);
            for j in 0..n {
                text += &format!(",{}", rec.q[(r, j)] + e[r * n + j]);
            }
            text += "\n";
        }
        std::fs::write("/tmp/w/sim.csv", text).unwrap();
    }
    for t in &tests {
        let (u, m) = score(&arm, &read(t));
        println!("fit {t}: {m:.3} {u:.2?}");
    }
}
