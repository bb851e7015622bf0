use datasets::*;
use model::{identification::*, session::*};
fn main() {
    let t0 = std::time::Instant::now();
    let moving = std::env::args().nth(1).as_deref() == Some("mov");
    let robot = physics::robot::Robot::load("../shared/data/kr300/robot.urdf").unwrap();
    let tr = read(
        "../shared/data/kr300/train.parquet".as_ref(),
        &ReadOptions::kr300(Part::Train),
    )
    .unwrap();
    let te = read(
        "../shared/data/kr300/test.parquet".as_ref(),
        &ReadOptions::kr300(Part::Test),
    )
    .unwrap();
    let p: Vec<_> = [&tr, &te]
        .iter()
        .map(|r| prepare(r, &PrepareOptions::default()).unwrap())
        .collect();
    println!("prepared {:?} {:?}", t0.elapsed(), p[0].report);
    let reps: Vec<(usize, usize)> = (0..66).filter(|i| i % 6 < 3).map(|i| (i, i + 3)).collect();
    let s = Session::new(p, &[]);
    println!("{:?}", s.clock_known);
    let target = Target::new(vec![tr.tau.as_ref().unwrap()], &[66], &[reps], 6);
    let id = identify(
        &robot,
        &s,
        &target,
        &IdentifyOptions {
            moving_only: moving,
            select: std::env::args().nth(2).is_none(),
            ..Default::default()
        },
    )
    .unwrap();
    println!("identified {:?}", t0.elapsed());
    println!("{:?}", id.residual_std);
    let load = s.load(
        &robot
            .with_parameters(&id.base.standard_from(&id.load_base))
            .unwrap(),
    );
    let rigid = robot
        .with_parameters(
            &id.base
                .standard_from(&id.estimate.parameters[..id.base.len()]),
        )
        .unwrap();
    let rt = rigid_torque(&rigid, &s.parts[1].at_samples);
    let tau = te.tau.as_ref().unwrap();
    let off = id.term_offsets();
    let mut all = vec![];
    let mut mv = vec![];
    for j in 0..6 {
        let c = &s.columns(j, &id.terms[j], &load, &[])[1];
        let th = ndarray::Array1::from(
            id.estimate.parameters[off[j]..off[j] + id.terms[j].len()].to_vec(),
        );
        let e = &tau.column(j) - &rt.column(j) - &c.dot(&th);
        let sd = tau.column(j).std(0.0);
        let a = (e.mapv(|x| x * x).mean().unwrap()).sqrt() / sd;
        let m: Vec<f64> = e
            .iter()
            .zip(s.parts[1].at_samples.qd.column(j))
            .filter(|(_, v)| v.abs() > 0.01)
            .map(|(e, _)| e * e)
            .collect();
        let m = (m.iter().sum::<f64>() / m.len() as f64).sqrt() / sd;
        println!(
            "{j} {a:.4} {m:.4} {:?}",
            id.terms[j].iter().map(|t| t.label()).collect::<Vec<_>>()
        );
        all.push(a);
        mv.push(m);
    }
    println!(
        "all {:.4} moving {:.4} {:?}",
        all.iter().sum::<f64>() / 6.,
        mv.iter().sum::<f64>() / 6.,
        t0.elapsed()
    );
}
