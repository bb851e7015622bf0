//! `diagnose`: where the gap between a simulator and a real robot lies, and what causes it.

use clap::Parser;
use datasets::{Part, ReadOptions, Recording, read};
use diagnose::diagnosis::diagnose;
use diagnose::error::DiagnoseError;
use diagnose::model::NominalModel;
use diagnose::objective::Settings;
use physics::robot::Robot;
use std::path::PathBuf;
use std::process::ExitCode;

/// Diagnose the gap between a simulator's torque and a real robot's.
#[derive(Parser)]
struct Arguments {
    /// The simulator's model: a URDF or a built-in name.
    #[arg(long)]
    robot: String,
    /// Recording on which effects are fitted.
    #[arg(long)]
    data: PathBuf,
    /// Recording on which every figure is measured.
    #[arg(long)]
    heldout: PathBuf,
    /// Write the report as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), DiagnoseError> {
    let robot = Robot::load(&arguments.robot)?;
    let options = |part| if arguments.robot == "kr300" { ReadOptions::kr300(part) } else { ReadOptions::for_robot(robot.dof()) };
    let data: Recording = read(&arguments.data, &options(Part::Train))?;
    let heldout = read(&arguments.heldout, &options(Part::Test))?;
    let model = NominalModel { robot: robot.clone() };
    let outcome = diagnose(&model, &data, &heldout, Settings::default())?;
    if std::env::var_os("DIAG").is_some() {
        for (k, s) in outcome.findings.accepted.iter().map(|a| &a.tried).chain([&outcome.findings.rest]).enumerate() {
            println!("cause {k}");
            let mut seen = vec![];
            for t in s.iter() {
                let c = &outcome.findings.candidates[t.candidate];
                if seen.contains(&(c.effect, c.joints.clone(), c.driver)) {
                    continue;
                }
                seen.push((c.effect, c.joints.clone(), c.driver));
                if seen.len() > 8 {
                    break;
                }
                println!(
                    "   {:28} j{:?} d{:?} gain {:8.1} shape {:?} gamma {:?}",
                    c.effect.name(),
                    if c.joints.len() > 1 { vec![] } else { c.joints.clone() },
                    c.driver,
                    t.gain,
                    c.shape.iter().map(|s| format!("{} {:.4}", s.0, s.1)).collect::<Vec<_>>(),
                    t.gamma.iter().take(3).map(|g| format!("{g:.4}")).collect::<Vec<_>>()
                );
            }
        }
        for l in &outcome.left {
            println!("{l:?} structured {:.4}", l.structured());
        }
        for s in &outcome.diagnosis.ladder {
            println!("{:24} {:.4} {:?}", s.step, s.all.mean_nrmse, s.all.nrmse.iter().flatten().map(|v| format!("{v:.4}")).collect::<Vec<_>>());
        }
    }
    println!("{}", outcome.diagnosis.verdict.name());
    for c in &outcome.diagnosis.causes {
        println!("{} {:?} share {:.3} closes {:.3}", c.effect.name(), c.joints, c.share_of_gap, c.gap_closed);
    }
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&outcome.diagnosis).expect("numbers and strings");
        std::fs::write(path, text).map_err(|error| DiagnoseError::Write { path: path.display().to_string(), error })?;
    }
    Ok(())
}
