//! `simulate`
fn main() {
    let n: u64 = std::env::args().nth(1).and_then(|x| x.parse().ok()).unwrap_or(8);
    for i in 0..n {
        let spec = simulate::cases::draw(i, 5);
        match simulate::cases::generate(&spec, 5) {
            Ok(c) => {
                let t = &c.truth;
                let e: Vec<String> = t.effects.iter().map(|e| format!("{}/{} {:?} share {:.3} after {:.3} level {:.4}", e.effect, e.mechanism, e.joints, e.share, e.share_after_reidentification, e.level)).collect();
                println!("{i} {} {} att {} {:.1}s cut {} given {:.3} wo {:.3} with {:.3} floor {:.3} | {}", t.kind, t.robot, t.seed[2], t.seconds, t.oracle.cutoff_hz, t.oracle.mean_nrmse.as_given, t.oracle.mean_nrmse.without_effect, t.oracle.mean_nrmse.with_effect, t.oracle.mean_nrmse.noise_floor, e.join("; "));
                println!("      with {:?}\n      floor {:?}", t.oracle.nrmse.with_effect.iter().map(|x| (x*1e3).round()/1e3).collect::<Vec<_>>(), t.oracle.nrmse.noise_floor.iter().map(|x| (x*1e3).round()/1e3).collect::<Vec<_>>());
                let qd = c.train.qd.as_ref().unwrap();
                println!("      still {:?} effect {:?}", (0..t.joints).map(|j| (qd.column(j).iter().filter(|v| v.abs() < 0.01).count() * 100 / qd.nrows())).collect::<Vec<_>>(), t.effect_rms.iter().zip(&t.torque_rms).map(|(e, t)| (e / t * 1e4).round() / 1e4).collect::<Vec<_>>());
            }
            Err(e) => println!("{i} {:?} {e}", spec.kind),
        }
    }
}
