use datasets::{ReadOptions, read};
use diagnose::*;
use ndarray::Array2;
use physics::robot::Robot;
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let t0 = std::time::Instant::now();
    let robot = Robot::load(&format!("{dir}/robot.urdf")).unwrap();
    let rec = read(format!("{dir}/train.parquet").as_ref(), &ReadOptions::for_robot(robot.dof())).unwrap();
    let tau = rec.tau.clone().unwrap();
    let frame = frame::Frame::new(&rec, tau);
    let scale = frame.scale(&[]);
    let scene = scene::Scene::new(&robot, &frame.motion, &scale).with_tangents();
    let cands = candidates::catalogue(&scene);
    let dict = dictionary::Dictionary::new(robot.dof(), &cands);
    let gap = &frame.tau - &scene.predicted();
    let mut y = Array2::zeros((frame.len(), robot.dof()));
    for j in 0..robot.dof() { y.column_mut(j).assign(&frame.thin(&gap.column(j).to_vec())); }
    let mut w = Array2::ones(y.dim());
    for j in 0..robot.dof() { let v = frame.thin(&frame.motion.qd.column(j).mapv(f64::abs).to_vec()); for i in 0..y.nrows() { if v[i] < 0.008 { w[[i,j]] = 0.1 } } }
    let folds: Vec<_> = frame.rows.iter().map(|r| vec![r.clone()]).collect();
    println!("{} candidates {} columns {:?}", cands.len(), dict.len(), t0.elapsed());
    let grams = dict.grams(&scene, &frame, &y, &w, &folds);
    println!("grams {:?}", t0.elapsed());
    let settings = objective::Settings::default();
    let obj = objective::Objective::new(&grams, &scale, &settings);
    let search = select::Search { objective: &obj, candidates: &cands, members: &dict.members, base: obj.base(&robot) };
    let f = search.fit(&[]);
    let nr = |e: &[f64]| -> Vec<String> { e.iter().zip(&grams.total).zip(&scale.torque).map(|((e,g),t)| format!("{:.4}", (e.max(0.0)/g.samples).sqrt()/t)).collect() };
    println!("given {:?}", nr(&grams.total.iter().map(|g| g.yy).collect::<Vec<_>>()));
    println!("tight {:?} J {:.1} pen {:.1}", nr(&f.error()), obj.of_fit(&f,0), f.penalty());
    let sel = search.run(|_, t| t.gain > 10.0, 5);
    println!("select {:?}", t0.elapsed());
    for (k, s) in sel.steps.iter().chain([&sel.rest]).enumerate() {
        println!("step {k}");
        let mut seen = vec![];
        for t in s.iter() {
            let c = &cands[t.candidate];
            if seen.contains(&(c.effect, c.joints.clone(), c.driver)) { continue }
            seen.push((c.effect, c.joints.clone(), c.driver));
            if seen.len() > 7 { break }
            println!("   {:28} j{:?} d{:?} gain {:8.1} shape {:?} gamma {:?} err {:?}", c.effect.name(), if c.joints.len()>1 {vec![]} else {c.joints.clone()}, c.driver, t.gain, c.shape.iter().map(|s| format!("{} {:.4}",s.0,s.1)).collect::<Vec<_>>(), t.gamma.iter().take(3).collect::<Vec<_>>(), nr(&t.error));
        }
    }
    println!("final {:?} pen {:.1}", nr(&sel.fit.error()), sel.fit.penalty());
}
